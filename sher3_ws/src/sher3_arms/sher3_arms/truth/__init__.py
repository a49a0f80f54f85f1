"""What knows the truth: models, faults and the engine. Nothing here reaches the diagnosis."""
