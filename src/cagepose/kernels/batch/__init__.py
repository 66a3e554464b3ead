"""Many runs of one scene, without Python between them."""
