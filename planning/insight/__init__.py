"""What a plan shows: covered sections and why others cannot be, pixel sizes, clearance and motion on the way."""
