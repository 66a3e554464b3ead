"""Many runs over one scene."""
