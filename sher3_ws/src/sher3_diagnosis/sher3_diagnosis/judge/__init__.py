"""The answer: places, causes, what is left, and the status that follows from them."""
