"""A run to look at: the model of a playback, the page that plays it offline, the live viewer, pictures and films."""
