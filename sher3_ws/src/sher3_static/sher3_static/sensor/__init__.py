"""A force sensor by itself: readings under a load in known orientations."""
