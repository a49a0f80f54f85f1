"""`python -m sher3_bringup`: the same as `sher3`."""

from .cli import main

main()
