"""What every search for the causes of a joint keeps to: what is possible, away from reversals, under conditions."""
