"""Where a gap is: gap over floor of every channel, and the regimes in which it lives."""
