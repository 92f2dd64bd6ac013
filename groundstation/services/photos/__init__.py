"""Use cases of photos: what they are worth, the panels found in them, their poses, and the data set made of them."""
