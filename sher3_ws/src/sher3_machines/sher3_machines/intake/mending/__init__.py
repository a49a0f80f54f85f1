"""Small faults of a record, mended and said: its stamps, its readings, its holes, its signs."""
