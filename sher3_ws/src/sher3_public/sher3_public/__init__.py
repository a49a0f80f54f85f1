"""The diagnosis of a gap in one call, on arrays in memory; people import it as `sher3.gap`."""
