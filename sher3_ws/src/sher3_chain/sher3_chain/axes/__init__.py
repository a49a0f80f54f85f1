"""A chain of axes as a machine of the diagnosis: each axis is a part that is judged by itself."""
