"""The things a scene is made of: frozen, checked once, SI inside."""
