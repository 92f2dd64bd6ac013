"""What glass mirrors, learned from photos: models of reflected light, trained on the rays of glass pixels alone."""
