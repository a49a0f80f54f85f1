"""Several nodes in one process: samples as objects, one callback of a node at a time, waits that hold up nobody."""
