"""From splats to pictures: the interface, its backends, and the reference implementation."""
