"""Records as CSV tables, there and back."""
