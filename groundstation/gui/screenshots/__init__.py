"""Pictures of the real window in every tab and state."""
