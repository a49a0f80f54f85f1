"""Tables of readings under known conditions: positioning tests, force sensors, load cells, poses of an arm."""
