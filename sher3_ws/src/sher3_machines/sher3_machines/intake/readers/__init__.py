"""One file for each format of data: it becomes named arrays, and a file that cannot be read becomes a typed error."""
