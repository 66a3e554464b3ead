"""Bodies of the cage that are driven: the rests that a part goes through as they move."""
