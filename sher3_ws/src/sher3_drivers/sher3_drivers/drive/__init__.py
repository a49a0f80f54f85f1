"""The motor driver: start, tick, commands, stops and recovery of the five drives, and its node."""
