"""Sealed cases from a truth plant, their scores, and baselines scored on the same cases."""
