"""What a joint is, in which units it is told, under which conditions it was recorded, and how a file becomes a run."""
