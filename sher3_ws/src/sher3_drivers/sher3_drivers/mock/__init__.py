"""The other end of the wire: mock drives driven by a plant, and both ends together in stepped time."""
