"""Readings of an axis that are wrong in themselves: dead, flat, at a level, or in another scale."""
