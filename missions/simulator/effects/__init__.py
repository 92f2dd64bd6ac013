"""Effects of the simulated flight: each decides from the scene whether it is worth its cost."""
