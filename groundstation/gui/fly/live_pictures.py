"""The flight as it is drawn a few times a second: in 3-D, on the map, and as a time line of its photos."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QHelpEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QFrame, QScrollArea, QSizePolicy, QToolTip, QWidget

from groundstation.gui.fly.live_aircraft import ActiveFlight
from groundstation.gui.map.map_view import MapView
from groundstation.gui.shared_view import SharedView, SharedViewPage
from groundstation.gui.view3d.aircraft_shape import aircraft_drawables, paint_aircraft, shown_span_m
from groundstation.gui.view3d.drawables import ON_TOP, Drawable, Label, Layer, frusta, joined, polyline
from groundstation.gui.view3d.paint import ColourScale, flat
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.fly.events import LiveView, PhotoCounted, ViewState
from groundstation.services.fly.readouts import flies_mission
from groundstation.services.map.web_mercator import world_from_geodetic
from groundstation.services.units import UnitSystem, length_unit
from groundstation.vehicle.state import Motion, VehicleState
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Angles, Origin, Vec3
from planning.plan import Camera, Viewpoint, ViewpointArrays

# A time line of the sortie's photos: planned, next, taken with the error of its place, or missing.

CELL_PX, ROW_PX = 30, 34
"""Wanted size of a cell; they get half as wide before the strip takes another row."""

LEAST_CELL_PX = 15.0
SIGNS = {
    ViewState.TO_COME: "\u00b7",
    ViewState.NEXT: "\u25b6",
    ViewState.TAKEN: "\u2713",
    ViewState.OFF: "!",
    ViewState.MISSING: "\u2717",
}
"""No state is told by colour alone."""


class PhotoStrip(QWidget):
    """Shows the views of a sortie in the order of flight; a click goes to one.

    Signals
    -------
    picked(str)
        Identifier of a view.
    reached(int)
        Number of the view that comes next, or that the keyboard is at.
    resized()
        It takes another number of rows.
    """

    picked = Signal(str)
    reached = Signal(int)
    resized = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._states: tuple[tuple[str, ViewState], ...] = ()
        self._photos: dict[str, PhotoCounted] = {}
        self._units = UnitSystem.METRIC
        self._focused = 0
        self.setAccessibleName(self.tr("Photos of the sortie"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def set_states(self, states: tuple[tuple[str, ViewState], ...]) -> None:
        """Show how each view stands."""
        if states != self._states:
            had, self._states = len(self._states), states
            if had != len(states):
                self._focused = 0
                self._make_room()
            self.update()
            following = next((i for i, (_, state) in enumerate(states) if state is ViewState.NEXT), None)
            if following is not None:
                self.reached.emit(following)

    def set_photos(self, photos: dict[str, PhotoCounted]) -> None:
        """Photos by the view that they are of."""
        self._photos = photos
        self.update()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units

    def states(self) -> tuple[tuple[str, ViewState], ...]:
        """What is shown."""
        return self._states

    def cell(self, number: int) -> QRectF:
        """Where a view is drawn, counted from 0."""
        columns, width = self._columns()
        row, column = divmod(number, columns)
        return QRectF(column * width, row * ROW_PX, width, ROW_PX)

    def words(self, number: int) -> str:
        """What is known of a view's photo."""
        view_id, state = self._states[number]
        state_text = {
            ViewState.TO_COME: self.tr("still to come"),
            ViewState.NEXT: self.tr("next"),
            ViewState.TAKEN: self.tr("taken"),
            ViewState.OFF: self.tr("taken, but not where it was planned"),
            ViewState.MISSING: self.tr("passed without a photo"),
        }[state]
        text = self.tr("{0}: {1}").format(view_id, state_text)
        photo = self._photos.get(view_id)
        if photo is not None and photo.position_error_m is not None:
            text += "\n" + self.tr("place off by {0}").format(length_unit(self._units).text(photo.position_error_m))
            if photo.heading_error_deg is not None:
                text += "\n" + self.tr("heading off by {0:.1f} deg").format(photo.heading_error_deg)
            if photo.gimbal_pitch_error_deg is not None:
                text += "\n" + self.tr("pitch off by {0:.1f} deg").format(photo.gimbal_pitch_error_deg)
            text += "\n" + self.tr("new sections: {0}").format(photo.n_new)
        return text

    def sizeHint(self) -> QSize:  # noqa: N802
        """Room for all rows."""
        columns, _ = self._columns()
        rows = max(1, math.ceil(len(self._states) / columns))
        return QSize(400, rows * ROW_PX + 2)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """As high as its rows."""
        return QSize(100, self.sizeHint().height())

    def resizeEvent(self, event: object) -> None:  # noqa: N802
        """Another width takes other rows."""
        super().resizeEvent(event)  # type: ignore[arg-type]
        self._make_room()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Paint the cells."""
        painter, look = QPainter(self), colours()
        for number, (_, state) in enumerate(self._states):
            box = self.cell(number).adjusted(1, 1, -1, -1)
            colour = state_colour(state, look)
            is_filled = state is not ViewState.TO_COME
            painter.setPen(QPen(QColor(look.line if state is ViewState.TO_COME else colour.name()), 1))
            painter.setBrush(colour if is_filled else QColor(look.base))
            painter.drawRect(box)
            painter.setPen(QColor(look.base if is_filled else look.muted))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, SIGNS[state])
            if self.hasFocus() and number == self._focused:
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.setPen(QPen(QColor(look.text), 3))
                painter.drawRect(box)
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Go to a view."""
        number = self._number_at(event.position().x(), event.position().y())
        if number is not None:
            self._focused = number
            self.update()
            self.picked.emit(self._states[number][0])

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Left and right go along, Return goes to the view."""
        step = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(Qt.Key(event.key()))
        if step is not None and self._states:
            self._focused = min(max(self._focused + step, 0), len(self._states) - 1)
            self.update()
            self.reached.emit(self._focused)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space) and self._states:
            self.picked.emit(self._states[self._focused][0])
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Say what is known of the view under the pointer."""
        if isinstance(event, QHelpEvent):
            number = self._number_at(event.pos().x(), event.pos().y())
            QToolTip.showText(event.globalPos(), "" if number is None else self.words(number), self)
            return True
        return super().event(event)

    def _make_room(self) -> None:
        self.updateGeometry()
        self.resized.emit()

    def _columns(self) -> tuple[int, float]:
        n, width = max(1, len(self._states)), max(1.0, float(self.width()))
        rows = math.ceil(n * LEAST_CELL_PX / width)
        columns = math.ceil(n / rows)
        return columns, min(float(CELL_PX), width / columns)

    def _number_at(self, x: float, y: float) -> int | None:
        columns, cell = self._columns()
        column, row = int(x // cell), int(y // ROW_PX)
        number = row * columns + column
        return number if 0 <= column < columns and 0 <= number < len(self._states) else None


class ScrolledStrip(QScrollArea):
    """A strip in as much room as there is, one row at least; what is reached is in sight."""

    def __init__(self, strip: PhotoStrip, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._strip, self._at = strip, 0
        self.setWidget(strip)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        strip.resized.connect(self._make_room)
        strip.reached.connect(self._show)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Room for all rows."""
        return self._strip.sizeHint()

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """One row."""
        return QSize(100, ROW_PX + 2)

    def _make_room(self) -> None:
        self.updateGeometry()
        self._show(self._at)

    def _show(self, number: int) -> None:
        self._at = number
        middle = self._strip.cell(number).center()
        self.ensureVisible(int(middle.x()), int(middle.y()), 0, ROW_PX // 2)


def state_colour(state: ViewState, look: Colours) -> QColor:
    """Colour of a view's state, in the strip, in the 3-D view and on the map."""
    return QColor(
        {
            ViewState.TO_COME: look.muted,
            ViewState.NEXT: look.accent,
            ViewState.TAKEN: look.ok,
            ViewState.OFF: look.warning,
            ViewState.MISSING: look.error,
        }[state]
    )


# The aircraft, its track and the state of each view, over the shared map.

Array = NDArray[np.float64]

AIRCRAFT_PX, MAP_DOT_PX = 17.0, 5.0


@dataclass(frozen=True, slots=True, eq=False)
class OnMap:
    """Another aircraft: its name, its track in the map's plane, shape (n, 2), and its heading."""

    name: str
    track: Array
    heading_rad: float


class LiveMap(QWidget):
    """Lies over a map, lets the pointer through, and moves with it."""

    def __init__(self, map_view: MapView) -> None:
        super().__init__(map_view)
        self._map = map_view
        self._track = np.zeros((0, 2))
        self._views: tuple[tuple[Array, ViewState], ...] = ()
        self._next: NDArray[np.float64] = np.zeros((0, 2))
        self._heading_rad = 0.0
        self._camera_rad: float | None = None
        self._name = ""
        self._others: tuple[OnMap, ...] = ()
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setGeometry(map_view.rect())
        map_view.installEventFilter(self)
        self.lower()
        self.show()

    def set_aircraft(
        self,
        origin: Origin,
        track_enu_m: Array,
        heading_rad: float,
        camera_rad: float | None = None,
        next_enu_m: Array | None = None,
    ) -> None:
        """Show a track, shape (n, 3), whose last point is where the aircraft is, and where it flies next, shape (3,).

        `camera_rad` is the heading of its camera, None where nobody tells.
        """
        self._track, self._heading_rad, self._camera_rad = _world(origin, track_enu_m), heading_rad, camera_rad
        self._next = _world(origin, np.zeros((0, 3)) if next_enu_m is None else next_enu_m[None])
        self.update()

    def set_others(self, origin: Origin, name: str, others: Sequence[tuple[str, Array, float]]) -> None:
        """Show the others that fly at once: name, track, shape (n, 3), and heading; `name` is that of the first one."""
        self._name = name
        self._others = tuple(OnMap(each, _world(origin, track), heading) for each, track, heading in others)
        self.update()

    def set_views(self, origin: Origin, views: tuple[tuple[tuple[float, float, float], ViewState], ...]) -> None:
        """Show how the views of the sortie stand."""
        places = _world(origin, np.array([place for place, _ in views], np.float64).reshape(-1, 3))
        self._views = tuple((place, state) for place, (_, state) in zip(places, views, strict=True))
        self.update()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Be as large as the map."""
        if event.type() == QEvent.Type.Resize:
            self.setGeometry(self._map.rect())
        return False

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Paint over what the map shows."""
        painter, look, viewport = QPainter(self), colours(), self._map.viewport()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for place, state in self._views:
            x, y = viewport.screen(place[None])[0]
            radius = 2.0 * MAP_DOT_PX if state is ViewState.NEXT else MAP_DOT_PX
            painter.setPen(QPen(QColor(look.base), 1))
            painter.setBrush(state_colour(state, look))
            painter.drawEllipse(QPointF(x, y), radius, radius)
        for other in self._others:
            if len(other.track):
                along = [QPointF(x, y) for x, y in viewport.screen(other.track).tolist()]
                painter.setPen(QPen(QColor(look.muted), 2))
                painter.drawPolyline(QPolygonF(along))
                paint_aircraft(painter, along[-1], other.heading_rad, None, AIRCRAFT_PX, look)
                _paint_name(painter, along[-1], other.name, look)
        if len(self._track):
            points = [QPointF(x, y) for x, y in viewport.screen(self._track).tolist()]
            painter.setPen(QPen(QColor(look.accent), 3))
            painter.drawPolyline(QPolygonF(points))
            for x, y in viewport.screen(self._next).tolist():
                for colour, width in ((look.base, 6), (look.text, 3)):
                    painter.setPen(QPen(QColor(colour), width, Qt.PenStyle.DashLine))
                    painter.drawLine(points[-1], QPointF(x, y))
            paint_aircraft(painter, points[-1], self._heading_rad, self._camera_rad, AIRCRAFT_PX, look)
            _paint_name(painter, points[-1], self._name, look)
        painter.end()


def _paint_name(painter: QPainter, at: QPointF, name: str, look: Colours) -> None:
    """A name on a plate above an aircraft."""
    if not name:
        return
    metrics = painter.fontMetrics()
    wide, high = metrics.horizontalAdvance(name) + 10, metrics.height() + 4
    plate = QRectF(at.x() - wide / 2.0, at.y() - 2.0 * AIRCRAFT_PX - high, wide, high)
    painter.fillRect(plate, QColor(look.base))
    painter.setPen(QColor(look.text))
    painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, name)


def _world(origin: Origin, points_enu_m: Array) -> Array:
    """Points of the map's plane, shape (n, 2)."""
    if len(points_enu_m) == 0:
        return np.zeros((0, 2))
    lat_deg, lon_deg, _ = geodetic_from_enu(origin, points_enu_m)
    return np.asarray(world_from_geodetic(lat_deg, lon_deg))


# The aircraft, its track, its picture and the state of each view, drawn into the shared 3-D view.

LEVEL = Angles(0.0, 0.0, 0.0)

TRACK_PX, NEXT_PX, PICTURE_PX, FOOTPRINT_PX = 4.0, 3.0, 1.0, 3.0
DOT_PX = {
    ViewState.TO_COME: 5.0,
    ViewState.NEXT: 16.0,
    ViewState.TAKEN: 10.0,
    ViewState.OFF: 12.0,
    ViewState.MISSING: 14.0,
}
NAMES = ("live-track", "live-next", "live-aircraft", "live-picture", "live-footprint", "live-views")


@dataclass(frozen=True, slots=True, eq=False)
class OtherInScene:
    """Another aircraft: its name, where it is and how it lies, where its camera points, and its track, shape (n, 3)."""

    name: str
    motion: Motion
    attitude: Angles
    camera: Angles | None
    track_enu_m: Array


class LiveScene:
    """Draws onto a 3-D view until it is cleared."""

    def __init__(self, scene: SceneView) -> None:
        self._scene = scene
        self._drawn_states: tuple[tuple[str, ViewState], ...] | None = None
        self._n_others = 0

    def draw_others(self, name: str, own: Motion | None, others: Sequence[OtherInScene]) -> None:
        """The others that fly at once, each with its track and its name; `name` is that of the first one."""
        canvas, look = self._scene.canvas(), colours()
        labels = [] if own is None or not name else [_label(name, own.position_enu_m, look.accent)]
        for number, other in enumerate(others):
            place = np.array(other.motion.position_enu_m)
            span_m = shown_span_m(self._scene.metres_per_px(place))
            drawn = aircraft_drawables(place, other.attitude, other.camera, span_m, look)
            canvas.draw(f"live-other-{number}", [*_track(other.track_enu_m, look.muted), *drawn])
            labels.append(_label(other.name, other.motion.position_enu_m, look.muted))
        for number in range(len(others), self._n_others):
            canvas.draw(f"live-other-{number}", ())
        self._n_others = len(others)
        self._scene.set_live_labels(labels)

    def draw_views(self, states: tuple[tuple[str, ViewState], ...], by_id: dict[str, Viewpoint]) -> None:
        """A dot on each view of the sortie, by its state."""
        if states == self._drawn_states:
            return
        self._drawn_states = states
        look, parts = colours(), []
        for wanted in ViewState:
            places = [
                by_id[view_id].position_enu_m for view_id, state in states if state is wanted and view_id in by_id
            ]
            if places:
                points = np.array(places, np.float64)
                dots = np.arange(len(points))[:, None]
                colour = flat(state_colour(wanted, look).name(), len(points))
                # Where to look next is seen through walls, all else where it is.
                shift = ON_TOP if wanted is ViewState.NEXT else 0.0
                parts.append(Drawable(points, dots, colour, width_px=DOT_PX[wanted], depth_shift=shift))
        self._scene.canvas().draw("live-views", parts)

    def draw_aircraft(
        self,
        state: VehicleState,
        track_enu_m: NDArray[np.float64],
        camera: Camera,
        facade_m: float | None,
        next_enu_m: NDArray[np.float64] | None = None,
    ) -> None:
        """Where it is, was and flies next, and what its camera sees: a pyramid, and its border on the site."""
        canvas, look = self._scene.canvas(), colours()
        self._scene.set_watched(True)
        canvas.draw("live-track", _track(track_enu_m, look.accent))
        if state.motion is None:
            return
        place = np.array(state.motion.value.position_enu_m)
        attitude = LEVEL if state.attitude is None else state.attitude.value
        pointing = state.camera
        span_m = shown_span_m(self._scene.metres_per_px(place))
        towards = None if pointing is None else pointing.value
        canvas.draw("live-aircraft", aircraft_drawables(place, attitude, towards, span_m, look))
        canvas.draw("live-next", () if next_enu_m is None else _leg(place, next_enu_m, look))
        if pointing is None or facade_m is None:
            canvas.draw("live-picture", ())
            canvas.draw("live-footprint", ())
            return
        view = ViewpointArrays(
            place[None], np.array([pointing.value.heading_rad]), np.array([pointing.value.pitch_rad])
        )
        points, cells = frusta(view, camera, max(1.0, facade_m))
        canvas.draw("live-picture", [Drawable(points, cells, flat(look.accent, len(cells)), width_px=PICTURE_PX)])
        pieces = self._scene.photo_border(view, 0, camera)
        canvas.draw("live-footprint", _lines(pieces, look))

    def clear(self) -> None:
        """Take everything away."""
        self._drawn_states = None
        self._scene.set_watched(False)
        self.draw_others("", None, ())
        for name in NAMES:
            self._scene.canvas().draw(name, ())


def _label(name: str, place_enu_m: Vec3, colour: str) -> Label:
    return Label(name, place_enu_m, Layer.LABELS, colour)


def _track(track_enu_m: NDArray[np.float64], colour: str) -> list[Drawable]:
    points, cells = polyline(track_enu_m)
    if len(cells) == 0:
        return []
    return [Drawable(points, cells, flat(colour, len(cells)), width_px=TRACK_PX)]


def _lines(pieces: list[NDArray[np.float64]], look: Colours) -> list[Drawable]:
    if not pieces:
        return []
    points, cells = joined([polyline(piece) for piece in pieces])
    return [Drawable(points, cells, flat(look.accent, len(cells)), width_px=FOOTPRINT_PX)]


def _leg(start_enu_m: Array, end_enu_m: Array, look: Colours) -> list[Drawable]:
    """The way to the next photo, seen through walls."""
    points, cells = polyline(np.stack([start_enu_m, end_enu_m]))
    return [Drawable(points, cells, flat(look.text, 1), width_px=NEXT_PX, depth_shift=ON_TOP)]


DRAW_EVERY_MS = 250
"""A frame takes some 36 ms where the processor draws: four in a second leave the rest of it to everything else."""

MAX_TRACK_POINTS = 4000
"""Older points are thinned out: more are no finer on any screen."""


class LivePictures(QObject):
    """Draws the active flight while it is shown.

    Signals
    -------
    drawn()
        It was time to draw: what lies over the view is painted in the same turn, for the window is put together once.
    """

    drawn = Signal()

    def __init__(self, shared_view: SharedView, parent: QObject) -> None:
        super().__init__(parent)
        self._shared_view = shared_view
        self._flight: ActiveFlight | None = None
        self._number: int | None = None
        self._others: tuple[tuple[int, ActiveFlight], ...] = ()
        self._n_other_photos = 0
        self._scene: LiveScene | None = None
        self._map: LiveMap | None = None
        self._is_shown = False
        self._is_stale = self._has_photo = False
        self._timer = QTimer(self, interval=DRAW_EVERY_MS)
        self._timer.timeout.connect(self.draw)
        self._timer.timeout.connect(self.drawn)

    def set_flight(self, flight: ActiveFlight | None) -> None:
        """Show another flight, or none."""
        if self._is_shown and flight is not self._flight:
            self._clear()
        self._flight, self._is_stale, self._has_photo = flight, True, flight is not None and flight.counted is not None

    def set_others(self, number: int | None, others: tuple[tuple[int, ActiveFlight], ...]) -> None:
        """Show these beside the flight, whose aircraft has a number among them; None where it is alone."""
        if number is not None or self._number is not None:
            n_photos = sum(len(flight.photos) for _, flight in others)
            self._has_photo |= n_photos != self._n_other_photos
            self._number, self._others, self._n_other_photos, self._is_stale = number, others, n_photos, True

    def show(self, flight: ActiveFlight | None) -> None:
        """Draw, and go on drawing."""
        self._is_shown = True
        self.set_flight(flight)
        self._shared_view.with_scene(self._scene_is_there)
        self._timer.start()
        self.draw()

    def hide(self) -> None:
        """Take everything away, and draw no more."""
        self._is_shown = False
        self._timer.stop()
        self._clear()

    def take_view(self, _view: LiveView) -> None:
        """There is something new to draw."""
        self._is_stale = True

    def take_photo(self, _counted: PhotoCounted) -> None:
        """There is new coverage to paint."""
        self._is_stale = self._has_photo = True

    def draw(self) -> None:
        """Bring what is seen up to date, where anything changed."""
        shown = [(self._number, self._flight), *self._others]
        heard = [(number, flight) for number, flight in shown if flight is not None and flight.view is not None]
        if not self._is_shown or not self._is_stale or not heard:
            return
        self._is_stale = False
        # Where the selected aircraft is not connected, the first of the others is drawn in full.
        first, *others = heard
        if self._shared_view.page() is SharedViewPage.MAP:
            self._draw_map(first, others)
        elif self._shared_view.page() is SharedViewPage.SCENE and self._scene is not None:
            self._draw_scene(self._scene, first, others)

    def _scene_is_there(self, scene: SceneView) -> None:
        if self._scene is None:
            self._scene = LiveScene(scene)
        self._is_stale = True

    def _draw_scene(self, scene: LiveScene, first: Numbered, others: Sequence[Numbered]) -> None:
        number, flight = first
        plan, view = flight.sortie.case.plan, flight.view
        assert view is not None
        states = _states([first, *others])
        scene.draw_views(states, {viewpoint.id: viewpoint for viewpoint in plan.viewpoints})
        following = _next_place(flight, view)
        scene.draw_aircraft(view.state, _thinned(flight), plan.camera, view.readouts.facade_m, following)
        own = None if view.state.motion is None else view.state.motion.value
        scene.draw_others(self._name(number), own, tuple(self._beside(others)))
        counted = max(_counted(flight, others), key=lambda each: each.covered, default=None)
        if self._has_photo and counted is not None:
            self._has_photo = False
            self._paint_coverage(flight, counted)

    def _name(self, number: int | None) -> str:
        return "" if number is None else self.tr("Aircraft {0}").format(number)

    def _beside(self, others: Sequence[Numbered]) -> Iterator[OtherInScene]:
        for number, flight in others:
            state = None if flight.view is None else flight.view.state
            if state is not None and state.motion is not None:
                attitude = LEVEL if state.attitude is None else state.attitude.value
                camera = None if state.camera is None else state.camera.value
                yield OtherInScene(self._name(number), state.motion.value, attitude, camera, _thinned(flight))

    def _paint_coverage(self, flight: ActiveFlight, counted: PhotoCounted) -> None:
        view = self._shared_view.scene()
        site = flight.sortie.case.site_model.site
        if view is None or counted.counts.shape[0] != site.n_panels:
            return
        planned = flight.sortie.case.measures.counts > 0
        n_planned = planned.sum(axis=1)
        share = np.full(len(n_planned), np.nan)
        np.divide(100.0 * ((counted.counts > 0) & planned).sum(axis=1), n_planned, out=share, where=n_planned > 0)
        view.set_panel_values(ColourScale(self.tr("Flown of what is planned"), "%", 0.0, 100.0), share)

    def _draw_map(self, first: Numbered, beside: Sequence[Numbered]) -> None:
        number, flight = first
        view = flight.view
        assert view is not None
        map_view = self._shared_view.findChild(MapView)
        if map_view is None:
            return
        if self._map is None:
            self._map = LiveMap(map_view)
        origin = flight.sortie.case.site_model.site.origin
        by_id = {viewpoint.id: viewpoint.position_enu_m for viewpoint in flight.sortie.case.plan.viewpoints}
        states = _states([first, *beside])
        self._map.set_views(origin, tuple((by_id[view_id], state) for view_id, state in states if view_id in by_id))
        heading = 0.0 if view.state.attitude is None else view.state.attitude.value.heading_rad
        camera = None if view.state.camera is None else view.state.camera.value.heading_rad
        self._map.set_aircraft(origin, _thinned(flight), heading, camera, _next_place(flight, view))
        others = [(other.name, other.track_enu_m, other.attitude.heading_rad) for other in self._beside(beside)]
        self._map.set_others(origin, self._name(number), others)
        self._map.show()

    def _clear(self) -> None:
        if self._scene is not None:
            self._scene.clear()
        scene = self._shared_view.scene()
        if scene is not None:
            scene.set_panel_values(None)
        if self._map is not None:
            self._map.hide()


Numbered = tuple[int | None, ActiveFlight]
"""A flight with the number of its aircraft; None where one flies alone."""


def _states(flights: Sequence[Numbered]) -> tuple[tuple[str, ViewState], ...]:
    """How the views of all sorties that are flown now stand."""
    views = (flight.view for _, flight in flights)
    return tuple(itertools.chain.from_iterable(view.view_states for view in views if view is not None))


def _counted(flight: ActiveFlight, others: Sequence[Numbered]) -> list[PhotoCounted]:
    """What the flights counted last; those of one plan count together, so the largest is the latest."""
    plan = flight.sortie.case.plan
    flights = [flight, *(each for _, each in others if each.sortie.case.plan is plan)]
    return [each.counted for each in flights if each.counted is not None]


def _next_place(flight: ActiveFlight, view: LiveView) -> NDArray[np.float64] | None:
    """Where the next photo is taken, shape (3,), while the aircraft flies its mission; None else."""
    following = next((view_id for view_id, state in view.view_states if state is ViewState.NEXT), None)
    if following is None or not view.state.is_armed or not flies_mission(view.state):
        return None
    found = next((each for each in flight.sortie.case.plan.viewpoints if each.id == following), None)
    return None if found is None else np.array(found.position_enu_m)


def _thinned(flight: ActiveFlight) -> NDArray[np.float64]:
    """The track, shape (n, 3), of so many points as can be drawn quickly; the last one is always in it."""
    track = flight.track_enu_m
    step = max(1, -(-len(track) // MAX_TRACK_POINTS))
    return np.array([*track[:-1:step], *track[-1:]], np.float64).reshape(-1, 3)
