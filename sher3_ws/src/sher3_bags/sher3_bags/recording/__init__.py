"""From the ROS graph into a bag."""
