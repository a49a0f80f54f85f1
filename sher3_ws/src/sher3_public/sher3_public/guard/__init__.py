"""A guard: what a new answer has that an older one of the same robot had not."""
