"""Many runs over one scene, and what they add up to: the paper's cases, its planar theory, ranges of misalignment."""
