"""What a report of an arm in motion shows: its efforts over time, its constants joint by joint."""
