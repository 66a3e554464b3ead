"""One scene in motion: a page, live or as one file, pictures and films."""
