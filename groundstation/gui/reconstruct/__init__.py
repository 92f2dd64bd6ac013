"""The Reconstruct tab: what is learned from which photos, and looking at the model while it learns."""
