"""`python -m sher3_cli`: the same as `sher3`."""

from sher3_cli.root import main

main()
