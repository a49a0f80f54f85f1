"""MJCF as MuJoCo reads it: bodies, losses, drives."""
