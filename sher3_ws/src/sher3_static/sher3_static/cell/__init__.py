"""A load cell: readings under known forces along its one axis."""
