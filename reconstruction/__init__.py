"""From photos to panels, to the Gaussian model, and to its objects and their records."""
