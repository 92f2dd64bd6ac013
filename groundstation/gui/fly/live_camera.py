"""What the camera sees now: the site drawn from the pose that the vehicle reports, beside the view of the flight."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QLabel, QWidget

from groundstation.gui.camera_preview.preview import (
    BACKDROP,
    SKY_DARK,
    SKY_LIGHT,
    panel_colours,
    panel_faces,
    panel_outlines,
)
from groundstation.gui.view3d.canvas import Canvas
from groundstation.gui.view3d.drawables import Layer
from groundstation.gui.view3d.orbit import photo_pinhole
from groundstation.gui.view3d.site_scene import site_scene
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.sortie import LiveSortie
from groundstation.vehicle.state import VehicleState
from planning.coverage.sections import panel_frames
from planning.plan import Camera
from planning.site.records import panel_corners

CAPTION_PX = 24
MOVED_M, TURNED_RAD = 0.05, math.radians(0.2)
"""A pose that differs by less is drawn as it was: 5 cm at 10 m are a pixel here."""

Pose = tuple[float, float, float, float, float]


class LiveCamera(QFrame):
    """A small picture of the site through the camera of the vehicle."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("What the camera sees"))
        self.setAutoFillBackground(True)
        self._camera: Camera | None = None
        self._sortie: LiveSortie | None = None
        self._canvas: Canvas | None = None
        self._drawn: LiveSortie | None = None
        self._pose: Pose | None = None
        self._caption = QLabel(self.tr("Camera, drawn"), self)
        self._caption.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._caption.setToolTip(
            self.tr("The site as the camera should see it, from the pose that the vehicle reports")
        )

    def set_sortie(self, sortie: LiveSortie | None) -> None:
        """The site that is seen, and the camera."""
        if sortie is not self._sortie:
            self._sortie, self._pose = sortie, None
            self._camera = None if sortie is None else sortie.case.plan.camera

    def has_site(self) -> bool:
        """Whether there is something to see."""
        return self._sortie is not None

    def height_for(self, width_px: int) -> int:
        """Height of a picture of this width, in the aspect ratio of the camera, and its caption."""
        camera = self._camera
        aspect = 4.0 / 3.0 if camera is None else camera.half_width / camera.half_height
        return round(width_px / aspect) + CAPTION_PX

    def pose(self) -> Pose | None:
        """Place, ENU metres, heading and pitch, radians, from which it was drawn last."""
        return self._pose

    def look(self, state: VehicleState) -> None:
        """Draw what is seen now; without a place or an attitude of the camera it stays as it is."""
        if self._camera is None or state.motion is None or state.camera is None:
            return
        pointing = state.camera.value
        pose = (*state.motion.value.position_enu_m, pointing.heading_rad, pointing.pitch_rad)
        if self._is_same(pose):
            return
        self._pose = pose
        canvas = self._made()
        eye = np.array(pose[:3])
        canvas.look_through(photo_pinhole(eye, pose[3], pose[4], self._camera, float(canvas.width())))

    def close_view(self) -> None:
        """Free the OpenGL context; call before the widget goes away."""
        if self._canvas is not None:
            self._canvas.close()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """The picture above, its caption below."""
        super().resizeEvent(event)
        self._lay_out()

    def _lay_out(self) -> None:
        picture = QRect(1, 1, self.width() - 2, max(1, self.height() - CAPTION_PX - 1))
        if self._canvas is not None:
            self._canvas.setGeometry(picture)
        self._caption.setGeometry(0, self.height() - CAPTION_PX, self.width(), CAPTION_PX)

    def _is_same(self, pose: Pose) -> bool:
        before = self._pose
        if before is None or self._drawn is not self._sortie:
            return False
        is_near = max(abs(a - b) for a, b in zip(pose[:3], before[:3], strict=True)) < MOVED_M
        return is_near and max(abs(a - b) for a, b in zip(pose[3:], before[3:], strict=True)) < TURNED_RAD

    def _made(self) -> Canvas:
        """The canvas, with the site in it; made when it is first looked at."""
        if self._canvas is None:
            self._canvas = Canvas(self)
            self._canvas.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            self._canvas.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            self._lay_out()
            self._canvas.show()
        if self._drawn is not self._sortie and self._sortie is not None:
            self._drawn = self._sortie
            canvas, model = self._canvas, self._sortie.case.site_model
            scene = site_scene(model, colours())
            canvas.set_background_colour(SKY_DARK if colours().is_dark else SKY_LIGHT)
            for layer in BACKDROP:
                canvas.draw(layer, scene.drawables[layer])
            frames = panel_frames(panel_corners(model.site))
            covered = np.zeros(len(frames), bool)
            canvas.draw(Layer.PANELS, (panel_faces(frames, panel_colours(frames, covered, colours())),))
            canvas.draw("outlines", (panel_outlines(frames),))
        return self._canvas
