"""The bench-top tests on the running graph."""
