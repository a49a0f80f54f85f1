"""How far the gap shrinks with its causes, and how sure their numbers are."""
