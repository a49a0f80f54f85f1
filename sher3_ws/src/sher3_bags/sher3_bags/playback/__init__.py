"""From a bag back onto the ROS graph."""
