"""Many runs over one scene, and what they add up to: play, comparisons of methods."""
