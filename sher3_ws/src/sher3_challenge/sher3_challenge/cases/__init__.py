"""Which cases are drawn, how hard their faults are set, how they are built, and how they are sealed."""
