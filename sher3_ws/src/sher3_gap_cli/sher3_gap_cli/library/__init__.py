"""`sher3 gap library`: the pages of the effects on the terminal."""
