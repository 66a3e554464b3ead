"""Independent oracles over seeded families of scenes: `make audit`."""
