"""`sher3 gap check`: logs held against what they said when they were good."""
