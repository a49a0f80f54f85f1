"""A joint: its description and units, the conditions under which it was recorded, and how a file becomes a run."""
