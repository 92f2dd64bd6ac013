"""Virtual scenes: what stands there, and what it is made of."""
