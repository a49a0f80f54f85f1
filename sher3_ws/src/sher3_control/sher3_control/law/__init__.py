"""The laws of control: the cooperative law with its parts, its live parameters and tare, and the host law.

Pure functions and small objects without ROS; time is an argument.
"""
