"""Plans that carry their proof: how it is made, and the independent verifier that is shipped beside missions."""
