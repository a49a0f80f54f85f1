"""What the terminal says of a running robot: each change of state, each refusal, and a status line."""
