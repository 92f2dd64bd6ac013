"""The camera preview: one photo as the camera will take it, or a sortie flown through at up to 20 times its speed."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QElapsedTimer, QEvent, QRect, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QImage, QResizeEvent, QShortcut, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSlider, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.camera_preview.flight import (
    CameraFlight,
    CameraPose,
    NearestPanel,
    SiteSight,
    camera_flight,
    covered_by_view,
    nearest_covered,
    site_sight,
)
from groundstation.gui.camera_preview.photo_box import Lines, PhotoBox, PhotoOverlay
from groundstation.gui.view3d.canvas import Canvas, image_array
from groundstation.gui.view3d.drawables import Drawable, Layer, outlines, quads
from groundstation.gui.view3d.orbit import Pinhole, photo_pinhole
from groundstation.gui.view3d.paint import flat, rgba, shaded
from groundstation.gui.view3d.site_scene import SiteScene, site_scene
from groundstation.gui.widgets.inputs import ChoiceBox, calm
from groundstation.gui.widgets.scrolling import scrolled
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.units import UnitSystem, length_unit, minutes_text, sampling_unit
from planning.base.errors import InfeasibleError
from planning.coverage.sections import PanelFrames
from planning.geo.frames import heading_difference_rad
from planning.plan import Camera, Plan, Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.site.records import SiteModel

# The figures on the camera preview: what the photo covers, and how it sees the nearest panel.


def figures(
    sight: SiteSight,
    panel_ids: tuple[str, ...],
    plan: Plan,
    view: Pinhole,
    covered: NDArray[np.bool_],
    place: str,
    units: UnitSystem,
) -> str:
    """What a view covers, `covered` of shape (m,), under what its `place` is called."""
    nearest = nearest_covered(sight, plan, view.eye_enu_m, covered)
    if nearest is None:
        return QCoreApplication.translate("CameraPreview", "{0}: covers no panel").format(place)
    return QCoreApplication.translate("CameraPreview", "{0}: covers {1} panels\n{2}").format(
        place, int(covered.sum()), _nearest_text(nearest, panel_ids[nearest.panel], view, units)
    )


def place_text(viewpoint: Viewpoint | None, pose: CameraPose | None) -> str:
    """Where a pose is, by the viewpoint that was photographed last."""
    if viewpoint is None:
        return QCoreApplication.translate("CameraPreview", "before the first photo")
    if pose is not None and _is_at(pose, viewpoint):
        return viewpoint.id
    return QCoreApplication.translate("CameraPreview", "on the way from {0}").format(viewpoint.id)


def _nearest_text(nearest: NearestPanel, panel_id: str, view: Pinhole, units: UnitSystem) -> str:
    length, sampling = length_unit(units), sampling_unit(units)
    width, height = (2.0 * half * nearest.distance_m for half in (view.half_width, view.half_height))
    return QCoreApplication.translate(
        "CameraPreview",
        "nearest panel {0}: {1} away, {2} per pixel, seen at {3:.0f}° from its normal\n"
        "picture at this distance: {4} x {5}",
    ).format(
        panel_id,
        length.text(nearest.distance_m),
        sampling.text(nearest.sampling_m),
        nearest.incidence_deg,
        length.text(width),
        length.text(height),
    )


def _is_at(pose: CameraPose, viewpoint: Viewpoint) -> bool:
    """Whether a pose is that of a viewpoint, to a centimetre and a tenth of a degree."""
    away_m = float(np.linalg.norm(pose.position_enu_m - np.array(viewpoint.position_enu_m)))
    turned = heading_difference_rad(pose.heading_rad, math.radians(viewpoint.heading_deg))
    tilted = pose.pitch_rad - math.radians(viewpoint.gimbal_pitch_deg)
    return away_m < 0.01 and max(abs(float(turned)), abs(tilted)) < math.radians(0.1)


# Outlines of panels as lines in a picture.

Array = NDArray[np.float64]

NEAREST_M = 0.05
"""Depth at which lines that run past the camera are cut off."""


def panel_lines(corners_enu_m: Array, view: Pinhole) -> Array:
    """Edges of panels, corners of shape (m, 4, 3), in a view: x and y of both ends, pixels, shape (n, 4).

    What is behind the camera is cut off; n is at most 4 m.
    """
    starts = corners_enu_m.reshape(-1, 3) - view.eye_enu_m
    ends = np.roll(corners_enu_m, -1, axis=1).reshape(-1, 3) - view.eye_enu_m
    depths = np.stack([starts @ view.forward, ends @ view.forward])
    is_before = (depths > NEAREST_M).any(axis=0)
    starts, ends, depths = starts[is_before], ends[is_before], depths[:, is_before]
    # Share of the way from start to end at which the depth is the nearest one.
    change = depths[1] - depths[0]
    cut = np.divide(NEAREST_M - depths[0], change, out=np.zeros_like(change), where=change != 0.0)[:, None]
    along = ends - starts
    first = np.where(depths[0][:, None] < NEAREST_M, starts + cut * along, starts)
    last = np.where(depths[1][:, None] < NEAREST_M, starts + cut * along, ends)
    pixels = [view.project(points + view.eye_enu_m)[0] for points in (first, last)]
    return np.concatenate(pixels, axis=1)


# A picture in the aspect ratio of the photo, as large as there is room for.


class PhotoFrame(QWidget):
    """Canvas and overlay in the middle, bars beside or above them.

    Signals
    -------
    fitted()
        The picture has another size.
    """

    fitted = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setMinimumSize(160, 120)
        self.canvas = Canvas(self)
        self.overlay = PhotoOverlay(self)
        self._aspect = 4.0 / 3.0

    def set_aspect(self, aspect: float) -> None:
        """Width / height of the photo."""
        if aspect != self._aspect:
            self._aspect = aspect
            self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the aspect ratio."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        width = min(self.width(), int(self.height() * self._aspect))
        height = max(1, round(width / self._aspect))
        place = QRect((self.width() - width) // 2, (self.height() - height) // 2, max(1, width), height)
        self.canvas.setGeometry(place)
        self.overlay.setGeometry(place)
        self.overlay.raise_()
        self.fitted.emit()


# What a photo is drawn from: building, obstacles, ground, and panels outlined where they are covered.

FACES_NEARER, OUTLINES_NEARER, COVERED_NEARER = 0.003, 0.004, 0.005
"""Parts of their distance by which panels, their outlines and those of covered ones come before the wall on which they
lie, 3 cm at 10 m. They are not moved off the wall, as in the 3-D view: at 10 m that would shift corners by pixels."""

COVERED_PX = 2.0
PANEL, PANEL_OUTLINE = "#8fa9bd", "#23415a"

BACKDROP = (Layer.GROUND, Layer.BUILDING, Layer.OBSTACLES, Layer.NO_FLY)


def panel_colours(frames: PanelFrames, covered: NDArray[np.bool_], look: Colours) -> NDArray[np.uint8]:
    """Colours of panels, shape (m, 4): grey-blue, or the colour of what is covered."""
    colours = flat(PANEL, len(frames))
    colours[covered] = rgba(look.covered)
    return shaded(colours, frames.normals)


def panel_faces(frames: PanelFrames, colours: NDArray[np.uint8]) -> Drawable:
    """All panels, with colours of shape (m, 4)."""
    return Drawable(*quads(frames.corners), colours, nearer=FACES_NEARER)


def panel_outlines(frames: PanelFrames) -> Drawable:
    """Thin outlines of all panels."""
    points, cells = outlines(frames.corners)
    return Drawable(points, cells, flat(PANEL_OUTLINE, len(cells)), nearer=OUTLINES_NEARER)


def covered_outlines(frames: PanelFrames, covered: NDArray[np.bool_], look: Colours) -> Drawable:
    """Thick, bright outlines of the covered panels."""
    points, cells = outlines(frames.corners[covered])
    return Drawable(points, cells, flat(look.open, len(cells)), width_px=COVERED_PX, nearer=COVERED_NEARER)


SPEEDS = (1, 2, 5, 10, 20)
FRAME_MS = 40
"""Time between frames of a flight, so that half of a slow processor is left for the rest of the window."""

FLASH_MS = 160
STEPS_PER_S = 10
"""Of the slider."""

SKY_LIGHT, SKY_DARK = "#dbe9f4", "#27323b"


class Shot(NamedTuple):
    """A photo that is to be seen as it will be: of what, by which camera, from where."""

    site: SiteModel
    camera: Camera
    pose: CameraPose


class CameraPreview(QWidget):
    """What the camera sees from a viewpoint, and on the way: drawn as lines, or as a photo that others render.

    Signals
    -------
    viewpointShown(str)
        A fly-through has come to this viewpoint.
    shotChanged()
        Another photo may be wanted than before, or none.
    """

    viewpointShown = Signal(str)  # noqa: N815  (Qt's own way of naming)
    shotChanged = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._scene: SiteScene | None = None
        self._sight: SiteSight | None = None
        self._plan: Plan | None = None
        self._viewpoint: Viewpoint | None = None
        self._panel_ids: tuple[str, ...] = ()
        self._covered: NDArray[np.bool_] = np.zeros(0, bool)
        self._flights: dict[int, CameraFlight | str] = {}
        self._pose: CameraPose | None = None
        self._time_s = 0.0
        self._units = UnitSystem.METRIC
        self.box = PhotoBox()
        self._is_seen = False
        self._picture: QImage | None = None
        self._pictured: NDArray[np.int64] = np.zeros(0, np.int64)
        self._frame = PhotoFrame(self)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._advance)
        self._clock = QElapsedTimer()
        self._flash = QTimer(self)
        self._flash.setSingleShot(True)
        self._flash.timeout.connect(lambda: self._frame.overlay.flash(False))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        above = QHBoxLayout()
        above.addWidget(self._frame, 1)
        # Its rows would make the window higher than small screens are.
        beside = scrolled(self.box)
        beside.setFixedWidth(self.box.width() + beside.verticalScrollBar().sizeHint().width())
        above.addWidget(beside)
        layout.addLayout(above, 1)
        layout.addLayout(self._controls())
        self._frame.fitted.connect(self._draw_pose)
        self.box.valueChanged.connect(lambda _is_photo: self._draw_pose())
        self.box.outlinesChanged.connect(self._draw_picture)
        self._dress()
        self._update_controls()

    def _controls(self) -> QHBoxLayout:
        self._sorties, self._play, self._speed = ChoiceBox(), QPushButton(self.tr("Play")), ChoiceBox()
        self._slider, self._clock_text = QSlider(Qt.Orientation.Horizontal), QLabel()
        calm(self._slider)
        self._play.setCheckable(True)
        space = QShortcut(Qt.Key.Key_Space, self, context=Qt.ShortcutContext.WidgetWithChildrenShortcut)
        space.activated.connect(self._play.toggle)
        self._play.setToolTip(self.tr("Fly through the sortie (space bar)"))
        self._sorties.setToolTip(self.tr("The sortie that is flown"))
        self._speed.setToolTip(self.tr("How many times faster than the flight"))
        for speed in SPEEDS:
            self._speed.addItem(self.tr("{0}x").format(speed), speed)
        self._speed.setCurrentIndex(SPEEDS.index(5))
        self._sorties.activated.connect(self._choose_sortie)
        self._play.toggled.connect(self._set_playing)
        self._slider.valueChanged.connect(self._slide)
        row = QHBoxLayout()
        for widget, stretch in ((self._sorties, 0), (self._play, 0), (self._slider, 1), (self._clock_text, 0)):
            row.addWidget(widget, stretch)
        row.addWidget(self._speed)
        return row

    # What is shown

    def set_view(
        self,
        site: SiteModel | None,
        plan: Plan | None,
        viewpoint_id: str = "",
        covered_panels: NDArray[np.bool_] | None = None,
    ) -> None:
        """Show a viewpoint of a plan; a flight that was playing stops.

        Parameters
        ----------
        viewpoint_id
            Empty, or of no viewpoint: the first of the plan.
        covered_panels
            Panels that this viewpoint covers, shape (m,); found from the plan's constraints where they are not given.
        """
        is_other = site is not (None if self._scene is None else self._scene.model)
        if is_other:
            self._scene = None if site is None else site_scene(site, colours())
            self._sight = None if site is None else site_sight(site)
            self._panel_ids = () if site is None else tuple(panel.id for panel in site.site.panels)
        if plan is not self._plan or is_other:
            self._plan, self._flights = plan, {}
            self._fill_sorties()
        self._play.setChecked(False)
        self._viewpoint = _viewpoint_of(plan, viewpoint_id)
        if is_other:
            self._draw_backdrop()
        if self._viewpoint is not None:
            self._show_viewpoint(self._viewpoint, covered_panels)
            self._find_on_flight(self._viewpoint.id)
        else:
            self._pose = None
            self._draw_pose()
        self._update_controls()

    def viewpoint_id(self) -> str:
        """The viewpoint that is shown, or was photographed last on the flight; empty for none."""
        return "" if self._viewpoint is None else self._viewpoint.id

    def covered_panels(self) -> NDArray[np.bool_]:
        """Panels that are shown as covered, shape (m,)."""
        return self._covered

    def set_units(self, units: UnitSystem) -> None:
        """Units of the figures on the picture."""
        self._units = units
        self._draw_pose()

    def pinhole(self) -> Pinhole | None:
        """The camera, with its picture as large as it is shown."""
        if self._pose is None or self._plan is None:
            return None
        position, heading, pitch = self._pose
        return photo_pinhole(position, heading, pitch, self._plan.camera, float(self._frame.canvas.width()))

    def shot(self) -> Shot | None:
        """The photo that is to be seen; None where lines are, nobody looks, or a flight plays."""
        if not (self.box.value() and self._is_seen) or self.is_playing():
            return None
        if self._pose is None or self._plan is None or self._scene is None:
            return None
        return Shot(self._scene.model, self._plan.camera, self._pose)

    def width_px(self) -> int:
        """Pixels of the screen that a photo is shown wide."""
        return int(self._frame.canvas.width() * self.devicePixelRatio())

    def show_picture(self, picture: QImage | None, panels: NDArray[np.int64]) -> None:
        """Show a rendered photo, with the numbers of the panels in it, shape (k,); None shows lines again."""
        self._picture, self._pictured = picture, panels
        self._draw_picture()

    def show_note(self, text: str) -> None:
        """Say something about the photo, in the picture."""
        self._frame.overlay.show_note(text)

    def note(self) -> str:
        """What is said about the photo."""
        return self._frame.overlay.note()

    def picture(self) -> NDArray[np.uint8]:
        """The lines without what is drawn over them, shape (height, width, 3)."""
        return self._frame.canvas.picture()

    def screenshot(self) -> NDArray[np.uint8]:
        """The whole widget, shape (height, width, 3)."""
        return image_array(self.grab().toImage())

    def canvas(self) -> Canvas:
        """What it is drawn on, for what measures it."""
        return self._frame.canvas

    def close_view(self) -> None:
        """Free the OpenGL context; call before the widget goes away."""
        self._timer.stop()
        self._flash.stop()
        self._frame.canvas.close()

    # The flight

    def play(self, speed: int = 5) -> None:
        """Fly through the chosen sortie from where the slider stands, or from the start when it is over."""
        self._speed.setCurrentIndex(SPEEDS.index(speed))
        self._play.setChecked(True)

    def pause(self) -> None:
        """Stop the flight where it is."""
        self._play.setChecked(False)

    def is_playing(self) -> bool:
        """Whether a flight is playing."""
        return self._timer.isActive()

    def time_s(self) -> float:
        """Time of the sortie that is shown, seconds."""
        return self._time_s

    def set_time(self, time_s: float) -> None:
        """Show the flight of the chosen sortie at a time, seconds."""
        flight = self._flight()
        if flight is None or self._plan is None:
            return
        before, self._time_s = self._time_s, min(max(0.0, time_s), flight.duration_s)
        taken = flight.photos_between(before, self._time_s)
        latest = flight.latest_photo(self._time_s)
        self._viewpoint = _viewpoint_of(self._plan, latest) if latest is not None else None
        self._pose = flight.pose_at(self._time_s)
        self._paint_panels(None)
        self._draw_pose()
        self._show_time(flight)
        if taken:
            self._frame.overlay.flash(True)
            self._flash.start(FLASH_MS)
            self.viewpointShown.emit(taken[-1])

    def advance(self, elapsed_s: float) -> None:
        """Let the flight go on as `elapsed_s` seconds on the clock make it; it ends with the sortie."""
        flight = self._flight()
        if flight is None:
            return
        self.set_time(self._time_s + elapsed_s * int(self._speed.currentData()))
        if self._time_s >= flight.duration_s:
            self._play.setChecked(False)

    # Qt

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Somebody looks."""
        super().showEvent(event)
        self._is_seen = True
        self.shotChanged.emit()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        """Nobody looks: stop the flight, render nothing."""
        super().hideEvent(event)
        self._is_seen = False
        self._play.setChecked(False)
        self.shotChanged.emit()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_clock_text"):
            if self._scene is not None:
                self._scene = site_scene(self._scene.model, colours())
            covered = self._covered
            self._dress()
            self._draw_backdrop()
            self._paint_panels(covered)
            self._draw_picture()

    # Drawing

    def _dress(self) -> None:
        self._frame.canvas.set_background_colour(SKY_DARK if colours().is_dark else SKY_LIGHT)

    def _draw_backdrop(self) -> None:
        """Everything that does not depend on the pose; no panel is covered yet."""
        canvas = self._frame.canvas
        for layer in BACKDROP:
            canvas.draw(layer, () if self._scene is None else self._scene.drawables[layer])
        panels: tuple[Drawable, ...] = ()
        lines: tuple[Drawable, ...] = ()
        self._covered = np.zeros(0, bool)
        if self._sight is not None:
            frames = self._sight.frames
            self._covered = np.zeros(len(frames), bool)
            panels = (panel_faces(frames, panel_colours(frames, self._covered, colours())),)
            lines = (panel_outlines(frames),)
        canvas.draw(Layer.PANELS, panels)
        canvas.draw("outlines", lines)
        canvas.draw("covered", ())

    def _show_viewpoint(self, viewpoint: Viewpoint, covered: NDArray[np.bool_] | None) -> None:
        views = viewpoint_arrays((viewpoint,))
        position, heading, pitch = views.positions_enu_m[0], float(views.heading_rad[0]), float(views.pitch_rad[0])
        self._pose = CameraPose(position, heading, pitch)
        self._paint_panels(covered)
        self._draw_pose()

    def _paint_panels(self, covered: NDArray[np.bool_] | None) -> None:
        """Outline all panels, and highlight those covered from the pose: given, or found by the plan's constraints."""
        if self._scene is None or self._sight is None:
            return
        if covered is None:
            covered = np.zeros(len(self._sight.frames), bool)
            if self._plan is not None and self._pose is not None:
                position, heading, pitch = self._pose
                view = ViewpointArrays(position[None], np.array([heading]), np.array([pitch]))
                covered = covered_by_view(self._sight, self._plan, view)
        if np.array_equal(covered, self._covered):
            return
        self._covered = covered
        frames, look, canvas = self._sight.frames, colours(), self._frame.canvas
        canvas.recolour(Layer.PANELS, panel_colours(frames, covered, look))
        canvas.draw("covered", [covered_outlines(frames, covered, look)])

    def _draw_pose(self) -> None:
        if self._plan is not None:
            self._frame.set_aspect(self._plan.camera.half_width / self._plan.camera.half_height)
        view = self.pinhole()
        if view is None:
            text = self.tr("No plan yet: make or open one, then choose a viewpoint.")
            self._frame.overlay.show_photo(None, text)
        else:
            self._frame.canvas.look_through(view)
            self._frame.overlay.show_photo(view, self._figures(view))
        self.shotChanged.emit()
        if self._picture is not None:
            self._draw_picture()

    def _draw_picture(self) -> None:
        """The rendered photo, with outlines of the panels in it where they are wanted."""
        view, sight, look = self.pinhole(), self._sight, colours()
        lines = []
        if self._picture is not None and view is not None and sight is not None and self.box.outlines.isChecked():
            is_covered = self._covered[self._pictured]
            for panels, colour, width in (
                (self._pictured[~is_covered], PANEL_OUTLINE, 1.0),
                (self._pictured[is_covered], look.open, COVERED_PX),
            ):
                lines.append(Lines(panel_lines(sight.frames.corners[panels], view), colour, width))
        self._frame.overlay.show_picture(self._picture, lines)

    def _figures(self, view: Pinhole) -> str:
        if self._sight is None or self._plan is None:
            return ""
        place = place_text(self._viewpoint, self._pose)
        texts = figures(self._sight, self._panel_ids, self._plan, view, self._covered, place, self._units)
        # Over a photo the rest would hide what it is looked at for.
        return texts.partition("\n")[0] if self.box.value() else texts

    # Playing

    def _fill_sorties(self) -> None:
        self._sorties.clear()
        for number in range(1, 1 + (0 if self._plan is None else len(self._plan.sorties))):
            self._sorties.addItem(self.tr("Sortie {0}").format(number))
        self._time_s = 0.0

    def _flight(self) -> CameraFlight | None:
        """The chosen sortie, timed when it is first wanted."""
        number = self._sorties.currentIndex()
        if self._plan is None or number < 0:
            return None
        if number not in self._flights:
            self._flights[number] = self._timed(self._plan, number)
        found = self._flights[number]
        return found if isinstance(found, CameraFlight) else None

    def _timed(self, plan: Plan, number: int) -> CameraFlight | str:
        """The sortie in time, or why it cannot be flown."""
        try:
            flight = camera_flight(plan, plan.sorties[number])
        except InfeasibleError as error:
            return translated(str(error), self._units)
        return flight if flight is not None else self.tr("The path of this sortie misses one of its viewpoints.")

    def _find_on_flight(self, viewpoint_id: str) -> None:
        """Put the slider to the moment of a photo."""
        if self._plan is None:
            return
        for number, sortie in enumerate(self._plan.sorties):
            if viewpoint_id in sortie.viewpoint_ids:
                self._sorties.setCurrentIndex(number)
                flight = self._flight()
                if flight is not None:
                    at = flight.profile.photo_ids.index(viewpoint_id)
                    self._time_s = float(flight.profile.photo_s[at])
                return

    def _choose_sortie(self) -> None:
        self._play.setChecked(False)
        self._time_s = 0.0
        self._update_controls()
        self.set_time(0.0)

    def _set_playing(self, is_playing: bool) -> None:
        self._play.setText(self.tr("Pause") if is_playing else self.tr("Play"))
        flight = self._flight()
        if not is_playing or flight is None:
            self._timer.stop()
            self.shotChanged.emit()
            return
        if self._time_s >= flight.duration_s:
            self._time_s = 0.0
        self._clock.start()
        self._timer.start(FRAME_MS)
        self.shotChanged.emit()

    def _advance(self) -> None:
        self.advance(self._clock.restart() / 1000.0)

    def _slide(self, value: int) -> None:
        self.set_time(value / STEPS_PER_S)

    def _update_controls(self) -> None:
        flight, number = self._flight(), self._sorties.currentIndex()
        for widget in (self._play, self._slider, self._speed):
            widget.setEnabled(flight is not None)
        self._sorties.setEnabled(self._sorties.count() > 1)
        reason = self._flights.get(number)
        self._slider.setToolTip(reason if isinstance(reason, str) else self.tr("Time of the sortie"))
        if flight is not None:
            self._show_time(flight)
        else:
            self._clock_text.setText(reason if isinstance(reason, str) else "")

    def _show_time(self, flight: CameraFlight) -> None:
        self._slider.blockSignals(True)
        self._slider.setRange(0, int(np.ceil(flight.duration_s * STEPS_PER_S)))
        self._slider.setValue(round(self._time_s * STEPS_PER_S))
        self._slider.blockSignals(False)
        self._clock_text.setText(
            self.tr("{0} of {1}").format(minutes_text(self._time_s), minutes_text(flight.duration_s))
        )


def _viewpoint_of(plan: Plan | None, viewpoint_id: str) -> Viewpoint | None:
    """A viewpoint by its identifier, else the first."""
    if plan is None or not plan.viewpoints:
        return None
    return next((found for found in plan.viewpoints if found.id == viewpoint_id), plan.viewpoints[0])
