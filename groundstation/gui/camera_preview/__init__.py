"""What the camera will see: one viewpoint after another, or the whole flight. `CameraPreview` is the widget."""

from groundstation.gui.camera_preview.preview import CameraPreview

__all__ = ["CameraPreview"]
