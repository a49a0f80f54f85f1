"""The sher3 command."""
