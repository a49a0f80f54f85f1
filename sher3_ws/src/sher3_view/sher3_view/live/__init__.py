"""The running robot in a browser: samples, page and loop of `sher3 view` without a bag."""

LOOPBACK = "127.0.0.1"
"""Address of what is served on this machine alone."""
