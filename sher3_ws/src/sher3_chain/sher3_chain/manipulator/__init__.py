"""A serial arm in motion: several joints move at once, and its own model gives the force that each of them needs."""
