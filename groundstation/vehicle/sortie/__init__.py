"""One sortie over a link: what has to be on board, and every step from the first heartbeat to the landing."""
