"""The running robot in a browser: samples, page and loop of `sher3 view` without a bag."""
