"""Two simulators, or two versions of one, told the same: where they part, and by which setting or effect."""
