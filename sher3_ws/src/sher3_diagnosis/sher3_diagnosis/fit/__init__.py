"""Least squares over terms in whitened residuals: what every fit of the diagnosis is made of."""
