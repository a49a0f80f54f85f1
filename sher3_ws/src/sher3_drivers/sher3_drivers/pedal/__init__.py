"""The foot pedal: its back-ends and its node."""
