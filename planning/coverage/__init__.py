"""Coverage of panel hemispheres: which view sees which panel from which direction (paper 3.2, Eq. 10)."""
