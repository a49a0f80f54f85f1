"""Faults of the plant of formulae, one file for each part of the robot they sit in."""
