"""Planned motion: a move to one goal as a timed curve of limited jerk, and the modes that follow it."""
