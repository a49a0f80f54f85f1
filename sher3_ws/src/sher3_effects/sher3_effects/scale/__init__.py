"""Ratios that are not what the model says."""
