"""The window: the only package that imports PySide6."""

from groundstation.gui.application.errors import make_errors_objects

make_errors_objects()
