"""Admittance law, motion modes, limits and supervisor of the SHER 3.0."""
