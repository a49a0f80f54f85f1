"""Kinematics of the SHER 3.0: delta stage, tilt linkage, arm, differential inverse."""
