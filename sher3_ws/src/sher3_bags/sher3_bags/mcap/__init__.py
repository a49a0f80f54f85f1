"""Bags as files: MCAP with the layout and metadata of rosbag2."""
