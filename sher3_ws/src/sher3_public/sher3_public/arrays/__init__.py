"""Arrays and a model made into the description of an arm: what is stated, what is guessed, what cannot be."""
