"""From photos to panels to the Gaussian model. This layer holds no code yet: planning and missions come first."""
