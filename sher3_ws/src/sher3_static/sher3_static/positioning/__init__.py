"""Tables without a clock: positioning tests of an axis (ISO 230-2) and circles of two axes (ISO 230-4)."""
