"""Photos as they come from the card: cameras and poses with their uncertainty, quality, coverage really achieved."""
