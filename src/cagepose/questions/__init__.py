"""Questions that people ask of one scene in so many words, each answered by one function with its certainty."""
