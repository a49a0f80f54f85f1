"""The commands of `sher3 gap`: they stand above the machines, their diagnosis and the sealed challenge.

Whatever is slow to import is imported in the body of the command that needs it, so that help is quick.
"""
