"""What a run can be told, and its time limits."""
