"""One file for each target: how a constant of a joint is written there, and why another cannot be."""
