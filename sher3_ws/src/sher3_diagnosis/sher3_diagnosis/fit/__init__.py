"""Least squares over terms in standardised residuals: what every fit of the diagnosis is made of."""
