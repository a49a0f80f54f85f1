"""Rigid bodies in a tree: what a joint carries, the forces that a motion needs, and the URDF they are read from."""
