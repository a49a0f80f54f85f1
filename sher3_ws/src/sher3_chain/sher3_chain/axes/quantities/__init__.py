"""Units of an axis, and what its quantities may be."""
