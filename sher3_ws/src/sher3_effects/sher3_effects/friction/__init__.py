"""Forces that oppose the motion of an axis."""
