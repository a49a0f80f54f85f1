"""From data files and a description to a case folder, for every kind of machine."""
