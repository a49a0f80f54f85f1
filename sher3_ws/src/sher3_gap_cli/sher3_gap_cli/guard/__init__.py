"""`sher3 gap check`: logs compared with a baseline."""
