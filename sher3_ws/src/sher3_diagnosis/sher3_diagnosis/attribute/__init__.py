"""Which effects explain the gaps: the search over the library, its rivals, and whether a cause keeps its size."""
