"""The runs that measure the matrix: in stepped time, in wall time, and healthy ones."""
