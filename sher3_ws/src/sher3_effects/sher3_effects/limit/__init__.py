"""Limits inside the drive."""
