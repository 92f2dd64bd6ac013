"""A virtual screen: 3-D views need OpenGL, which Qt's "offscreen" platform does not have."""

from groundstation.gui.start import start_virtual_screen

__all__ = ["start_virtual_screen"]
