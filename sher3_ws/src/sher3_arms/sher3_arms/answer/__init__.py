"""What answers: it sees records and the nominal model, and nothing of the truth."""
