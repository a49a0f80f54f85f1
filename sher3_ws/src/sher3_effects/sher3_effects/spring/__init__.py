"""Forces that follow the position: springs and cables."""
