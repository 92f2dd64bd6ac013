"""Photos prepared for reconstruction (paper 3.3.1): panels drawn into every photo, masks, refined mesh, normal maps."""
