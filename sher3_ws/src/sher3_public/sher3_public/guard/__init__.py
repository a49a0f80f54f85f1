"""A guard: compares a new diagnosis of a robot with an older one."""
