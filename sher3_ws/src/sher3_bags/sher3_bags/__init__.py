"""Record, read, write, replay and analyse bags of the SHER 3.0."""
