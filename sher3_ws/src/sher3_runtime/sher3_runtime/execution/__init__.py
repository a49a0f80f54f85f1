"""How nodes run: in wall time by an executor and `spin`, and in one process and stepped time as a `Graph`."""
