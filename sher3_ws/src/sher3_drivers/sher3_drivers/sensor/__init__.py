"""The force sensor: its protocol, its back-ends, the health of its readings, and its node."""
