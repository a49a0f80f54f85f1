"""Two simulators, or versions of one, given the same commands: where they differ, and by which setting or effect."""
