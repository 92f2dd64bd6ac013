"""The coarse model: photos of a first flight to poses, sparse points, walls and roofs, in a frame of the site."""
