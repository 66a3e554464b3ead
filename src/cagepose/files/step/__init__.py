"""STEP files: what solids they hold."""
