"""The recorded session of `sher3 demo`, and its verdict."""
