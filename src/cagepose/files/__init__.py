"""Scene files in; scenes and results out. The only floor that knows millimetres, degrees, YAML and JSON."""
