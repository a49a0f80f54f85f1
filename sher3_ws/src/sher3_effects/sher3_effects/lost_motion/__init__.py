"""Motion that is lost when the direction or the load reverses."""
