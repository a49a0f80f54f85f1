"""The simulator beside the recordings: twins of runs, causes put into it, what is left of the gap, the tip."""
