"""Parts that give way under a load, and ring."""
