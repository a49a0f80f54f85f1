"""Errors with a period of the motor's revolution."""
