"""The Model tab: a finished model, its panels and their records."""
