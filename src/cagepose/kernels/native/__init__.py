"""How Python calls kernels."""
