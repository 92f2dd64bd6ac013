"""From photos to panels to the Gaussian model; the model itself is not built yet."""
