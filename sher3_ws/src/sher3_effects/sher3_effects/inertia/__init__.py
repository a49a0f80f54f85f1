"""Masses and weights that the model does not know."""
