"""What the camera sees now: its video, or the site drawn from the pose that the vehicle reports."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from PySide6.QtCore import QRect, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QImage, QMouseEvent, QPixmap, QResizeEvent
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QWidget

from groundstation.gui.application.translate import translated
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
from groundstation.services.fly.video import VideoStream
from groundstation.services.fly.video_offer import OfferedVideo
from groundstation.services.units import UnitSystem
from groundstation.vehicle.state import VehicleState
from planning.coverage.sections import panel_frames
from planning.plan import Camera
from planning.site.records import SiteModel, panel_corners

CAPTION_PX, CAPTION_TEXT_PX = 24, 15
VIDEO_MS = 90
"""Between pictures of the video, a little less than that in which they come."""

VIDEO_PX = 480
"""Width in which pictures of the video come: that of the large picture."""

MOVED_M, TURNED_RAD = 0.05, math.radians(0.2)
"""A pose that differs by less is drawn as it was: 5 cm at 10 m are a pixel here."""

Pose = tuple[float, float, float, float, float]


class LiveCamera(QFrame):
    """A small picture: the camera's video where it comes, else the site through the camera. A click makes it large.

    Signals
    -------
    sizeToggled()
        It wants to be large, or small again.
    videoAccepted(str)
        The pilot wants to see the stream that the camera offers.
    """

    videoAccepted = Signal(str)  # noqa: N815
    sizeToggled = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("What the camera sees"))
        self.setAutoFillBackground(True)
        self._camera: Camera | None = None
        self._sortie: LiveSortie | None = None
        self._canvas: Canvas | None = None
        self._drawn: LiveSortie | None = None
        self._parts: Iterator[Layer] | None = None
        self._awaited: VehicleState | None = None
        self._make_soon = QTimer(self, interval=0)
        self._make_soon.timeout.connect(self._make_part)
        self._pose: Pose | None = None
        self._stream: VideoStream | None = None
        self._url = ""
        self._n_shown = 0
        self._timer = QTimer(self, interval=VIDEO_MS)
        self._timer.timeout.connect(self.show_video)
        self._film = QLabel(self)
        self._film.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._film.setStyleSheet("background: black;")
        self._film.hide()
        self._caption = QLabel(self.tr("Camera, drawn"), self)
        self._caption.setAlignment(Qt.AlignmentFlag.AlignCenter)
        font = self._caption.font()
        font.setPixelSize(CAPTION_TEXT_PX)
        self._caption.setFont(font)
        self._offered = ""
        self.offer = QPushButton(self.tr("Show the camera's video"), self)
        self.offer.clicked.connect(lambda: self.videoAccepted.emit(self._offered))
        self.offer.hide()
        self._caption.setToolTip(
            self.tr("The site as the camera should see it, from the pose that the vehicle reports")
        )

    def set_sortie(self, sortie: LiveSortie | None) -> None:
        """The site that is seen, and the camera."""
        if sortie is not self._sortie:
            self._sortie, self._pose = sortie, None
            self._camera = None if sortie is None else sortie.case.plan.camera

    def set_video(self, url: str) -> None:
        """Show a stream from now on; empty for none."""
        if url != self._url:
            self._stop_video()
            self._url = url

    def offer_video(self, offered: OfferedVideo | None) -> None:
        """Offer what the camera tells of, where nothing was chosen."""
        self._offered = "" if offered is None or self._url else offered.url
        self.offer.setVisible(bool(self._offered))
        if self._offered:
            self.offer.setToolTip(self._offered)
            self.offer.raise_()
            self._lay_out()

    def has_site(self) -> bool:
        """Whether there is something to see."""
        return self._sortie is not None or bool(self._url)

    def shows_video(self) -> bool:
        """Whether a picture of the camera itself is shown."""
        return not self._film.isHidden()

    def caption(self) -> str:
        """What is said to be seen."""
        return self._caption.text()

    def show_video(self) -> None:
        """Show the latest picture of the stream, or why there is none; the stream is opened when it is first seen."""
        if not self._url:
            self._say_video(None, self.tr("Camera, drawn"))
            return
        if self._stream is None:
            self._stream = VideoStream(self._url, VIDEO_PX)
            self._timer.start()
        found, problem = self._stream.latest(), self._stream.problem()
        if found is None:
            self._say_video(None, self.tr("Drawn: no video") if problem else self.tr("Drawn: video awaited"), problem)
        elif found.number != self._n_shown or self._film.isHidden():
            self._n_shown = found.number
            rows = np.ascontiguousarray(found.picture)
            image = QImage(rows.data, rows.shape[1], rows.shape[0], 3 * rows.shape[1], QImage.Format.Format_RGB888)
            size, ratio = self._film.size(), Qt.AspectRatioMode.KeepAspectRatio
            self._film.setPixmap(QPixmap.fromImage(image).scaled(size, ratio))
            self._say_video(image, self.tr("Camera, video"))

    def _say_video(self, image: QImage | None, caption: str, problem: str = "") -> None:
        self._film.setVisible(image is not None)
        if image is not None:
            self._film.raise_()
        if self._caption.text() != caption:
            self._caption.setText(caption)
        self._caption.setToolTip(translated(problem, UnitSystem.METRIC) if problem else "")

    def _stop_video(self) -> None:
        self._timer.stop()
        if self._stream is not None:
            self._stream.close()
            self._stream = None
        self._n_shown = 0
        self._film.hide()

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
        canvas = self._made()
        if canvas is None:
            self._awaited = state
            return
        self._pose = pose
        eye = np.array(pose[:3])
        canvas.look_through(photo_pinhole(eye, pose[3], pose[4], self._camera, float(canvas.width())))

    def close_view(self) -> None:
        """Free the OpenGL context, end the video; call before the widget goes away."""
        self._stop_video()
        self._make_soon.stop()
        self._url = ""
        if self._canvas is not None:
            self._canvas.close()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        """What nobody sees is not decoded."""
        self._stop_video()
        super().hideEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Become large, or small again."""
        self.sizeToggled.emit()
        event.accept()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """The picture above, its caption below."""
        super().resizeEvent(event)
        self._lay_out()

    def _lay_out(self) -> None:
        picture = QRect(1, 1, self.width() - 2, max(1, self.height() - CAPTION_PX - 1))
        self._film.setGeometry(picture)
        size = self.offer.sizeHint()
        width = min(size.width(), picture.width())
        self.offer.setGeometry(
            (picture.width() - width) // 2, picture.bottom() - size.height() - 4, width, size.height()
        )
        self._pose = None
        if self._canvas is not None:
            self._canvas.setGeometry(picture)
        self._caption.setGeometry(0, self.height() - CAPTION_PX, self.width(), CAPTION_PX)

    def _is_same(self, pose: Pose) -> bool:
        before = self._pose
        if before is None or self._drawn is not self._sortie:
            return False
        is_near = max(abs(a - b) for a, b in zip(pose[:3], before[:3], strict=True)) < MOVED_M
        return is_near and max(abs(a - b) for a, b in zip(pose[3:], before[3:], strict=True)) < TURNED_RAD

    def _made(self) -> Canvas | None:
        """The canvas, with the site in it; None while it is made, each part in a turn of its own.

        All of it at once, while the vehicle reports for the first time, held the window for more than a tenth of a
        second.
        """
        if self._drawn is not self._sortie and self._sortie is not None:
            self._drawn = self._sortie
            self._parts = self._make_parts(self._sortie.case.site_model)
            self._make_soon.start()
        return self._canvas if self._parts is None else None

    def _make_part(self) -> None:
        if self._parts is not None and next(self._parts, None) is None:
            self._parts = None
            self._make_soon.stop()
            if self._awaited is not None:
                self.look(self._awaited)
                self._awaited = None

    def _make_parts(self, model: SiteModel) -> Iterator[Layer]:
        """Make the canvas where there is none, and draw a site in it; yields the layer that comes next."""
        if self._canvas is None:
            self._canvas = Canvas(self)
            self._canvas.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            self._canvas.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            self._lay_out()
            yield Layer.GROUND
            self._canvas.show()
            self._canvas.stackUnder(self._film)
            yield Layer.GROUND
        canvas, scene = self._canvas, site_scene(model, colours())
        canvas.set_background_colour(SKY_DARK if colours().is_dark else SKY_LIGHT)
        for layer in BACKDROP:
            yield layer
            canvas.draw(layer, scene.drawables[layer])
        yield Layer.PANELS
        frames = panel_frames(panel_corners(model.site))
        covered = np.zeros(len(frames), bool)
        canvas.draw(Layer.PANELS, (panel_faces(frames, panel_colours(frames, covered, colours())),))
        canvas.draw("outlines", (panel_outlines(frames),))
