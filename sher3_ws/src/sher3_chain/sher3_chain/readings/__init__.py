"""What was read of a joint: its signals, their noise, and channels that are dead, at a level or in another scale."""
