"""A mechanism that is not as drawn."""
