"""From the local frame to the globe and back: ENU, coordinate reference systems and the EGM96 geoid."""
