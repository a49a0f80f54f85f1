"""Scores of verdicts against labels: one row per case, then rates, the outcome of a challenge and its tables."""
