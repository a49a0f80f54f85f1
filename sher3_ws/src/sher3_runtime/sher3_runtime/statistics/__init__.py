"""How punctual a process is, and what it is measured against."""
