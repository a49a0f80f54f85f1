"""A description drafted from data: what the columns are, from their names, their numbers and their units."""
