"""A recorded command against the law that its description states: how it is read, what is left, what explains it."""
