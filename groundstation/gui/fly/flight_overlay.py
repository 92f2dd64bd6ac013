"""What lies over the view while a vehicle is connected: figures, attitude, warnings and what the camera sees.

That is its video, or the site drawn from the pose that the vehicle reports.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from PySide6.QtCore import QMargins, QObject, QRect, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QImage, QMouseEvent, QPixmap, QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.camera_preview.preview import (
    BACKDROP,
    SKY_DARK,
    SKY_LIGHT,
    panel_colours,
    panel_faces,
    panel_outlines,
)
from groundstation.gui.fly.readouts_view import AttitudeView, FlightFigures
from groundstation.gui.shared_view import SharedView, SharedViewPage
from groundstation.gui.view3d.canvas import Canvas
from groundstation.gui.view3d.drawables import Layer
from groundstation.gui.view3d.orbit import photo_pinhole
from groundstation.gui.view3d.site_scene import site_scene
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.announce import AgedWarning, ordered_warnings
from groundstation.services.fly.events import LinkState, LiveView
from groundstation.services.fly.sortie import LiveSortie
from groundstation.services.fly.video import VideoStream
from groundstation.services.fly.video_offer import OfferedVideo
from groundstation.services.units import UnitSystem, minutes_text
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity
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


EDGE_PX = 6
SIDE_PX = 210
"""Width of attitude and camera picture."""

LARGE_SIDE_PX = 440
"""Of the camera picture once it was clicked."""

ATTITUDE_PX = 180
MAX_SHOWN = 3
"""Warnings; the rest are counted."""


class WarningBanner(QFrame):
    """The warnings that hold, in their colour, with how long they have; gone when they are over.

    Signals
    -------
    muteToggled(bool)
        Whether they are not spoken.
    """

    muteToggled = Signal(bool)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("Warnings"))
        self._units = UnitSystem.METRIC
        self._labels = [QLabel() for _ in range(MAX_SHOWN)]
        self._more = QLabel()
        self.mute = QPushButton(self.tr("Mute"))
        self.mute.setCheckable(True)
        self.mute.setToolTip(self.tr("Warnings are shown, and not spoken"))
        self.mute.toggled.connect(self.muteToggled)
        self.mute.hide()
        texts = self._texts = QVBoxLayout()
        texts.setSpacing(2)
        for label in (*self._labels, self._more):
            label.setWordWrap(True)
            label.setMargin(5)
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
            texts.addWidget(label)
        row = self._row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addLayout(texts, 1)
        row.addWidget(self.mute, 0, Qt.AlignmentFlag.AlignTop)
        self.set_warnings(())

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units

    def set_muted(self, *, is_muted: bool, has_voice: bool) -> None:
        """Show whether warnings are spoken; without a voice nothing is to be chosen."""
        blocker = QSignalBlocker(self.mute)
        self.mute.setChecked(is_muted)
        del blocker
        self.mute.setVisible(has_voice)

    def set_warnings(self, aged: Sequence[AgedWarning]) -> bool:
        """Show these warnings; returns whether another size is needed."""
        ages_s = {each.warning.code: each.age_s for each in aged}
        warnings = ordered_warnings([each.warning for each in aged])
        before = [(label.isHidden(), label.text()) for label in (*self._labels, self._more)]
        for number, label in enumerate(self._labels):
            label.setVisible(number < len(warnings))
            if number < len(warnings):
                self._fill(label, warnings[number], ages_s[warnings[number].code])
            else:
                label.setText("")
        n_more = len(warnings) - MAX_SHOWN
        self._more.setVisible(n_more > 0)
        self._more.setText(self.tr("{0} more in the list").format(n_more) if n_more > 0 else "")
        return before != [(label.isHidden(), label.text()) for label in (*self._labels, self._more)]

    def height_for(self, width_px: int) -> int:
        """Height that the shown lines need; a layout that is not seen yet would answer for the lines before."""
        beside = 0 if self.mute.isHidden() else self.mute.sizeHint().width() + self._row.spacing()
        shown = [label for label in (*self._labels, self._more) if not label.isHidden()]
        lines = sum(label.heightForWidth(max(1, width_px - beside)) for label in shown)
        lines += self._texts.spacing() * max(0, len(shown) - 1)
        return max(lines, 0 if self.mute.isHidden() else self.mute.sizeHint().height())

    def is_empty(self) -> bool:
        """Whether nothing is wrong."""
        return self._labels[0].isHidden()

    def text(self) -> str:
        """All that is shown, a line each."""
        return "\n".join(label.text() for label in (*self._labels, self._more) if not label.isHidden())

    def _fill(self, label: QLabel, warning: FlightWarning, age_s: float) -> None:
        look, words = colours(), translated(warning.text, self._units)
        is_error = warning.severity is Severity.ERROR
        title = self.tr("DANGER") if is_error else self.tr("Warning")
        text = self.tr("{0} ({1}): {2}").format(title, minutes_text(age_s), words)
        if label.text() != text:
            label.setText(text)
        style = f"background: {look.error if is_error else look.warning}; color: {look.base}; font-weight: bold;"
        if label.styleSheet() != style:
            label.setStyleSheet(style)


class FlightOverlay(QObject):
    """Lays it over a shared view, and keeps the view's own marks free of it."""

    def __init__(self, shared_view: SharedView, parent: QObject) -> None:
        super().__init__(parent)
        self._shared_view = shared_view
        self.figures, self.attitude = FlightFigures(shared_view), AttitudeView(shared_view)
        self.banner, self.camera = WarningBanner(shared_view), LiveCamera(shared_view)
        self._view: LiveView | None = None
        self._warnings: tuple[AgedWarning, ...] = ()
        self._is_shown = self._has_sides = self._is_stale = False
        self._is_large = False
        self._n_drawn = 0
        for widget in self._parts():
            widget.hide()
        self.camera.sizeToggled.connect(self.toggle_camera)
        shared_view.resized.connect(self._place)
        shared_view.pageShown.connect(lambda _page: self._place())

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self.figures.set_units(units)
        self.banner.set_units(units)

    def set_sortie(self, sortie: LiveSortie | None) -> None:
        """The sortie whose site the camera sees."""
        self.camera.set_sortie(sortie)

    def set_video(self, url: str) -> None:
        """The stream that the camera sends; empty for none."""
        self.camera.set_video(url)
        self._place()

    def toggle_camera(self) -> None:
        """Make the camera's picture large, or small again."""
        self._is_large = not self._is_large
        self._place()

    def set_view(self, view: LiveView | None) -> None:
        """The flight as it stands; drawn with the next `draw`."""
        self._view, self._is_stale = view, True

    def set_warnings(self, warnings: tuple[AgedWarning, ...]) -> None:
        """The warnings of all flights; drawn with the next `draw`."""
        self._warnings, self._is_stale = warnings, True

    def show(self, *, is_shown: bool, has_sides: bool = True) -> None:
        """Appear or go; without its sides there are warnings alone, for the lists have the figures, too."""
        if (is_shown, has_sides) != (self._is_shown, self._has_sides):
            self._is_shown, self._has_sides, self._is_stale = is_shown, has_sides, True
            self._place()
            self.draw()

    def draw(self) -> None:
        """Bring everything up to date; the camera's picture every second time, for it costs as much as the rest."""
        if not self._is_shown:
            return
        self._n_drawn += 1
        if self._is_stale:
            self._is_stale = False
            view = self._view
            wide = self.figures.sizeHint().width()
            self.figures.set_view(view)
            is_wider = self.figures.sizeHint().width() != wide
            state = None if view is None else view.state
            attitude = None if state is None or state.attitude is None else state.attitude.value
            pointing = None if state is None or state.camera is None else state.camera.value
            self.attitude.set_angles(attitude, pointing, is_old=view is not None and view.link is LinkState.LOST)
            if self.banner.set_warnings(self._warnings) or is_wider:
                self._place()
        if self.camera.isVisible():
            self.camera.show_video()
            is_due = self._n_drawn % 2 == 0 and self._view is not None and not self.camera.shows_video()
            if is_due and self._view is not None:
                self.camera.look(self._view.state)

    def close_view(self) -> None:
        """Free what the camera's picture holds."""
        self.camera.close_view()

    def _parts(self) -> tuple[QWidget, ...]:
        return self.figures, self.attitude, self.banner, self.camera

    def _place(self) -> None:
        """Put everything where it goes: figures at the left, attitude and camera at the right, warnings between."""
        room, is_over = self._shared_view.room(), self._is_shown
        # The camera preview has controls of its own at its edges.
        has_sides = is_over and self._has_sides and self._shared_view.page() is not SharedViewPage.CAMERA
        left = min(self.figures.sizeHint().width(), room.width() // 3)
        side = min(SIDE_PX, room.width() // 3)
        high = min(self.figures.sizeHint().height(), room.height() - 2 * EDGE_PX)
        self._put(self.figures, QRect(room.left() + EDGE_PX, room.top() + EDGE_PX, left, high), has_sides)
        x = room.right() - EDGE_PX - side
        upper = min(ATTITUDE_PX, room.height() // 2)
        self._put(self.attitude, QRect(x, room.top() + EDGE_PX, side, upper), has_sides)
        free = room.height() - upper - 3 * EDGE_PX
        wide = min(LARGE_SIDE_PX, room.width() // 2) if self._is_large else side
        while wide > side and self.camera.height_for(wide) > free:
            wide -= 10
        lower = self.camera.height_for(wide)
        at = QRect(room.right() - EDGE_PX - wide, room.bottom() - EDGE_PX - lower, wide, lower)
        self._put(self.camera, at, has_sides and lower <= free and self.camera.has_site())
        taken_left = left + EDGE_PX if has_sides else 0
        taken_right = side + EDGE_PX if has_sides else 0
        width = room.width() - taken_left - taken_right - 2 * EDGE_PX
        lines = self.banner.height_for(width)
        at = QRect(room.left() + taken_left + EDGE_PX, room.top() + EDGE_PX, width, lines)
        self._put(self.banner, at, is_over and not self.banner.is_empty())
        top = 0 if not has_sides or self.banner.isHidden() else at.height() + EDGE_PX
        self._shared_view.set_insets(QMargins(taken_left, top, taken_right, 0))

    def _put(self, widget: QWidget, at: QRect, is_shown: bool) -> None:
        if is_shown and at.width() > 0 and at.height() > 0:
            if widget.geometry() != at:
                widget.setGeometry(at)
            if widget.isHidden():
                widget.show()
                widget.raise_()
        elif not widget.isHidden():
            widget.hide()
