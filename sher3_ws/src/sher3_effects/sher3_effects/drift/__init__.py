"""What follows the temperature of the robot."""
