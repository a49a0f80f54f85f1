"""What simpler methods answer on the same residuals."""
