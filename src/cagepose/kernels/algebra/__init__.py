"""Vectors, poses, small linear systems and programs, and the one table of tolerances: nothing here knows a contact."""
