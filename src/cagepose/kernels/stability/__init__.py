"""What a rest is worth: is it the only onset, is it stable, how much friction does it need?"""
