"""Figures, tables and pictures of what the cameras saw."""
