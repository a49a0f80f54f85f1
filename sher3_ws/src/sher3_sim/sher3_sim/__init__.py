"""Plant of the SHER 3.0 with a door for unmodelled effects."""
