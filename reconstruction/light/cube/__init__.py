"""Environment maps on cubes, as methods of others use them."""
