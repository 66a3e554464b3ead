"""Benchmarks: cagepose beside its peers, how cost grows, and what the first run costs. `python -m bench`."""
