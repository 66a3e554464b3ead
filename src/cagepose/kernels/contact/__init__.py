"""The contact problem at one pose: forces that balance a load, or the motion that begins."""
