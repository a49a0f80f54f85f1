"""The compiled plant: one control period of an axis and of the whole robot, with every effect at zero or at work."""
