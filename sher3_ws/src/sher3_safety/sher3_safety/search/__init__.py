"""A search for combinations of faults that move the tip far: drawn, tried in stepped time, and climbed from."""
