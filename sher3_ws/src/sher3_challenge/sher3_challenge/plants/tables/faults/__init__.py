"""Faults of the plant of sampled laws, one file for each part of the robot they sit in."""
