"""Motion that tells the constants of another machine apart: Fourier series within what it was seen to reach."""
