"""The paper beside the program: its cases, its planar theory, and the report that compares both."""
