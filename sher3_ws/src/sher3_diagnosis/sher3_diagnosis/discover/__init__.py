"""Discovery: a sparse formula, with units, for a gap that no effect of the library explains."""
