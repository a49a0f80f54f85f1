"""The calibrated judgement: small logistic models whose coefficients stand in a data file with their provenance."""
