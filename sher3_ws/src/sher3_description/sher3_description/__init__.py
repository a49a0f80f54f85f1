"""Parameters, topic table and URDF of the SHER 3.0."""
