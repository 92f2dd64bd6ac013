"""How the number of splats follows the detail there is."""
