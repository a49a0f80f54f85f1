"""What the safety matrix breaks: its rows, in stepped time and by processes."""
