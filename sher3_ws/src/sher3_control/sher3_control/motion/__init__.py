"""Motion modes: who commands the robot, and which actuator velocities follow from it at each tick."""
