"""What the gap of a case is when one knows the truth, from the recorded topics and the nominal equations."""
