"""Aircraft and cameras: profiles with their sources."""
