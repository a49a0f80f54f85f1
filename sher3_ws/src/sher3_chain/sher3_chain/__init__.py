"""Machines that are a chain of joints: axes, each by itself, and serial arms in motion."""
