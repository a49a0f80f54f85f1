"""Floors of a chain: what nobody can foresee of a residual, and what repeats differ by."""
