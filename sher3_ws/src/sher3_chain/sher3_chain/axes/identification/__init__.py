"""Constants of an axis found from noisy records: mass and friction, rest, fast laws and their order."""
