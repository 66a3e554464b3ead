"""Many runs of one scene with numbers that vary, and what they say. Needs the extra ``study``."""
