"""Floors of a chain: the innovation of a residual, and the difference between repeats of one motion."""
