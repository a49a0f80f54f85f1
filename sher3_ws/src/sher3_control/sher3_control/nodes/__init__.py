"""The three control nodes on the ROS graph; every decision is made in `law`, `motion` and `supervision`."""
