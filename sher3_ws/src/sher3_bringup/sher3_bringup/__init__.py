"""Entry script, process supervision and configuration of the SHER 3.0."""
