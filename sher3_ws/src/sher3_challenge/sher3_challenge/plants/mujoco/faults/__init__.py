"""What can be wrong with the plant: a file for each part of the robot, and one for what no catalogue names."""
