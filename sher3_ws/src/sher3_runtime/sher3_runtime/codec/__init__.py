"""Samples of the topics as CDR bytes and as message objects."""
