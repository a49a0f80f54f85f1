"""Small real-time runtime for rclpy nodes: clock grid, executor, CDR codecs."""
