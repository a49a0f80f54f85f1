"""What a recording shows of a fault, whether that is good enough, and the report of it."""
