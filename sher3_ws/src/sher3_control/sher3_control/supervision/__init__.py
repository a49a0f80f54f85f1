"""The supervisor and its detectors: who may move, and which observation stops the robot."""
