"""Tools of the 3-D view, as state machines without Qt: they take pointers and keys, and give previews and results.

All tools follow one pattern. A click (pressed and let go at one place) or a drag that starts at something the tool
holds is given to the tool; every other drag turns the view. Results are plain values in ENU metres; what is done with
them, and whether they are allowed, is decided elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.orbit import Pinhole
from groundstation.gui.view3d.picking import VIEWPOINT_PX, Hit
from planning.geo.frames import Vec3, camera_axes

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Pointer:
    """Where the pointer is, in the picture and in the scene.

    Parameters
    ----------
    ray
        Unit vector from the eye, shape (3,), ENU.
    hit
        Surface under the pointer.
    ground_enu_m
        Where the ray meets the level of the ground, shape (3,).
    shift
        Whether the Shift key is held.
    """

    view: Pinhole
    x_px: float
    y_px: float
    ray: Array
    hit: Hit | None = None
    ground_enu_m: Array | None = None
    shift: bool = False


class Key(Enum):
    """Keys that tools know."""

    CONFIRM = auto()
    BACK = auto()
    """Takes the last click back."""
    LEFT = auto()
    RIGHT = auto()
    UP = auto()
    DOWN = auto()
    NEARER = auto()
    FARTHER = auto()


class Hint(Enum):
    """What the user is asked to do next; the view words it."""

    CLICK_POINT = auto()
    CLICK_LOWER_LEFT = auto()
    CLICK_LOWER_RIGHT = auto()
    CLICK_UPPER_LEFT = auto()
    CLICK_CORNER = auto()
    CLICK_MORE_CORNERS = auto()
    POLYGON_CROSSES = auto()
    CLICK_OPPOSITE_CORNER = auto()
    CLICK_HEIGHT = auto()
    CLICK_HOME = auto()
    CLICK_RALLY = auto()
    DRAG_VIEWPOINT = auto()
    NOTHING_THERE = auto()


@dataclass(frozen=True, slots=True, eq=False)
class Preview:
    """What a tool wants drawn: polylines, shape (k, 3) each, dots, whether it would be refused, and lengths to tell."""

    lines: tuple[Array, ...] = ()
    dots: tuple[Array, ...] = ()
    is_refused: bool = False
    lengths_m: tuple[float, ...] = ()


class Tool(Protocol):
    """A tool in use.

    Methods return the result when the tool has ended with one, else None; `value` is what the result would be now, for
    those who want to follow, None while there is none.
    """

    @property
    def hint(self) -> Hint:
        """What is to be done next."""

    @property
    def preview(self) -> Preview:
        """What is to be drawn."""

    @property
    def value(self) -> object | None:
        """Result as it would be now."""

    def grabs(self, pointer: Pointer) -> bool:
        """Whether a drag that starts here is the tool's and not the view's."""

    def move(self, pointer: Pointer) -> object | None:
        """The pointer moved, or is dragged after `grabs` said yes."""

    def release(self, pointer: Pointer) -> object | None:
        """A drag of the tool's ended."""

    def click(self, pointer: Pointer) -> object | None:
        """Pressed and let go at one place."""

    def press_key(self, key: Key, is_fine: bool) -> object | None:
        """A key; `is_fine` with Shift."""


class ClickTool:
    """What tools that only take clicks have in common."""

    def grabs(self, pointer: Pointer) -> bool:
        """Every drag turns the view."""
        return False

    def release(self, pointer: Pointer) -> object | None:
        """No drag is the tool's."""
        return None

    def press_key(self, key: Key, is_fine: bool) -> object | None:
        """No key means anything."""
        return None


@dataclass(frozen=True, slots=True)
class PickedPoint:
    """A point on a surface, or on the ground where no surface was; the normal is then up."""

    point_enu_m: Vec3
    normal: Vec3
    item_id: str


class PointTool(ClickTool):
    """Pick one point: a click ends it."""

    def __init__(self) -> None:
        self._value: PickedPoint | None = None
        self._is_missed = False

    @property
    def hint(self) -> Hint:
        """Asks for the click."""
        return Hint.NOTHING_THERE if self._is_missed else Hint.CLICK_POINT

    @property
    def preview(self) -> Preview:
        """A dot at the point."""
        return Preview() if self._value is None else Preview(dots=(np.array(self._value.point_enu_m),))

    @property
    def value(self) -> PickedPoint | None:
        """The point under the pointer."""
        return self._value

    def move(self, pointer: Pointer) -> None:
        """Follow the pointer."""
        self._is_missed = False
        if pointer.hit is not None:
            hit = pointer.hit
            self._value = PickedPoint(vec3(hit.point_enu_m), vec3(hit.normal), hit.item.id)
        elif pointer.ground_enu_m is not None:
            self._value = PickedPoint(vec3(pointer.ground_enu_m), (0.0, 0.0, 1.0), "")
        else:
            self._value = None

    def click(self, pointer: Pointer) -> PickedPoint | None:
        """The point under the pointer; None in the sky."""
        self.move(pointer)
        self._is_missed = self._value is None
        return self._value


@dataclass(frozen=True, slots=True)
class PickedHome:
    """Where the aircraft takes off and lands."""

    point_enu_m: Vec3


class HomeTool(PointTool):
    """Pick home: on the ground, or on a surface that is turned upwards, such as a roof."""

    @property
    def hint(self) -> Hint:
        """Asks for the click."""
        return Hint.NOTHING_THERE if self._is_missed else Hint.CLICK_HOME

    def move(self, pointer: Pointer) -> None:
        """Follow the pointer; walls are seen through to the ground."""
        hit = pointer.hit
        if hit is not None and hit.normal[2] < STANDING_NORMAL_Z:
            hit = None
        super().move(Pointer(pointer.view, pointer.x_px, pointer.y_px, pointer.ray, hit, pointer.ground_enu_m))

    def click(self, pointer: Pointer) -> PickedHome | None:  # type: ignore[override]
        """The place under the pointer."""
        point = super().click(pointer)
        return None if point is None else PickedHome(point.point_enu_m)


class RallyTool(HomeTool):
    """Pick a rally point, as home is picked."""

    @property
    def hint(self) -> Hint:
        """Asks for the click."""
        return Hint.NOTHING_THERE if self._is_missed else Hint.CLICK_RALLY


STANDING_NORMAL_Z = 0.9
"""A surface steeper than 25 degrees is no place to take off from."""


def vec3(point: Array) -> Vec3:
    """Plain numbers of a point, shape (3,), to a tenth of a millimetre."""
    x, y, z = (round(float(value), 4) + 0.0 for value in point)
    return x, y, z


# The tool that moves a viewpoint: by dragging in the plane of the picture, along its own line of sight, or by keys.

STEP_M, FINE_STEP_M = 1.0, 0.1
"""How far a key moves the viewpoint, without and with Shift."""

HANDLE_PX = 1.6 * VIEWPOINT_PX
"""How near to the viewpoint a drag must start: more than picking it takes, so that a finger gets hold of it."""


@dataclass(frozen=True, slots=True)
class MovedViewpoint:
    """Where a viewpoint shall be."""

    id: str
    position_enu_m: Vec3


class DragState(Enum):
    """Whether the viewpoint is held."""

    IDLE = auto()
    HELD = auto()


class ViewpointTool:
    """Move one viewpoint. The tool goes on until it is cancelled or replaced: every drag and key gives a result.

    =====  ======================  =====================================
    state  event                   then
    =====  ======================  =====================================
    IDLE   drag starts at the dot  HELD
    IDLE   arrows, NEARER, FARTHER  moved by a step: `MovedViewpoint`
    HELD   move                    follows in the plane of the picture; along its line of sight with Shift
    HELD   release                 IDLE, `MovedViewpoint`
    =====  ======================  =====================================
    """

    def __init__(self, viewpoint_id: str, position_enu_m: Vec3, heading_rad: float, pitch_rad: float) -> None:
        self.state = DragState.IDLE
        self._id = viewpoint_id
        self._position = np.array(position_enu_m, np.float64)
        self._forward, self._right, self._up = camera_axes(heading_rad, pitch_rad)
        self._start = self._position
        self._grip: tuple[float, float] = (0.0, 0.0)

    @property
    def hint(self) -> Hint:
        """Says how it is moved."""
        return Hint.DRAG_VIEWPOINT

    @property
    def value(self) -> MovedViewpoint:
        """Where it is now."""
        return MovedViewpoint(self._id, vec3(self._position))

    @property
    def preview(self) -> Preview:
        """Its dot, the way it came, and its three axes."""
        arms = tuple(np.stack([self._position, self._position + 2.0 * axis]) for axis in self._axes())
        moved_m = float(np.linalg.norm(self._position - self._start))
        lines = arms if self.state is DragState.IDLE else (np.stack([self._start, self._position]), *arms)
        return Preview(lines, (self._position,), lengths_m=(moved_m,) if moved_m > 0.0 else ())

    def grabs(self, pointer: Pointer) -> bool:
        """Take hold when the pointer is at the dot."""
        pixel, depth = pointer.view.project(self._position)
        is_near = depth > 0.0 and np.hypot(pixel[0] - pointer.x_px, pixel[1] - pointer.y_px) <= HANDLE_PX
        if is_near:
            self.state, self._start = DragState.HELD, self._position
            self._grip = (pointer.x_px, pointer.y_px)
        return bool(is_near)

    def move(self, pointer: Pointer) -> None:
        """Follow the pointer while held."""
        if self.state is not DragState.HELD:
            return
        view = pointer.view
        pixel, depth = view.project(self._start)
        dx, dy = pointer.x_px - self._grip[0], pointer.y_px - self._grip[1]
        if not pointer.shift:
            scale = view.metres_per_px(float(depth))
            self._position = self._start + scale * (dx * view.right - dy * view.up)
            return
        # Pixels that a metre along the line of sight takes on screen; head-on, upwards on screen means forwards.
        tip, _ = view.project(self._start + self._forward)
        along = tip - pixel
        length = float(np.linalg.norm(along))
        if not length > 0.5:
            along, length = (
                np.array([0.0, -1.0]) / view.metres_per_px(float(depth)),
                1.0 / view.metres_per_px(float(depth)),
            )
        self._position = self._start + float(np.array([dx, dy]) @ along) / length**2 * self._forward

    def release(self, pointer: Pointer) -> MovedViewpoint:
        """Let go: this is the result."""
        self.move(pointer)
        self.state, self._start = DragState.IDLE, self._position
        return self.value

    def click(self, pointer: Pointer) -> None:
        """Clicks beside it mean nothing."""

    def press_key(self, key: Key, is_fine: bool) -> MovedViewpoint | None:
        """Move by a step along its own axes; not while it is held."""
        directions = {
            Key.LEFT: -self._right,
            Key.RIGHT: self._right,
            Key.UP: self._up,
            Key.DOWN: -self._up,
            Key.NEARER: self._forward,
            Key.FARTHER: -self._forward,
        }
        if key not in directions or self.state is DragState.HELD:
            return None
        self._start = self._position = self._position + (FINE_STEP_M if is_fine else STEP_M) * directions[key]
        return self.value

    def cancel(self) -> None:
        """Put it back to where the drag began."""
        self.state, self._position = DragState.IDLE, self._start

    def _axes(self) -> tuple[Array, Array, Array]:
        return self._forward, self._right, self._up
