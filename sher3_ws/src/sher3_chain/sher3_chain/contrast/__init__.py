"""Runs of one machine under several conditions: what changed between them, with everything common held common."""
