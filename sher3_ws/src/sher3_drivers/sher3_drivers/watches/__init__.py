"""What stops the robot: each watch judges one kind of evidence and returns a trip with its numbers."""
