"""The simulated airframe: how it moves, and what it is made of."""
