"""How far a caged object can move, whether that is certain, and whether there is a way out."""
