"""The processes of a run: the nodes in each, their start, their supervision and their end."""
