"""Evidence of one cause or gap, in numbers that mean the same on every plant; the calibrated judgement reads these."""
