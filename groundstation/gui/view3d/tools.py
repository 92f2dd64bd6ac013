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

from groundstation.gui.view3d.picking import Hit
from groundstation.gui.view3d.pinhole import Pinhole
from planning.geo.frames import Vec3

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
