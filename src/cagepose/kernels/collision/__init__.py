"""Where boxes and cage points meet: gaps at a pose, and the first contact of a travel and a turn."""
