"""What the SHER adds to the report of its diagnosis: names, topics, and pictures of its exact stages and its tip."""
