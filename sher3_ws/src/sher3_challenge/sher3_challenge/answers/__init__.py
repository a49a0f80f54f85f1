"""The side that answers: it gets a case folder, never a label, and imports nothing that knows the truth."""
