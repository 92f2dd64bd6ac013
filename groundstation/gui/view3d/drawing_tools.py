"""Tools that draw with several clicks: a rectangle on a wall, a polygon on the ground, a box."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.tools import ClickTool, Hint, Key, Pointer, Preview, vec3
from planning.geo.frames import Vec3

Array = NDArray[np.float64]

LEVEL_SLOPE = 0.05
"""Lower edges within 3 degrees of level are made level, unless Shift is held: nobody clicks to a pixel."""

STEEP = 0.9
"""Sine of the pitch from which a view counts as from above: 64 degrees."""

MIN_SIZE_M = 0.05
"""Shorter edges are a double click."""

SNAP_PX = 12.0
"""A click this near to the first corner closes a polygon."""


@dataclass(frozen=True, slots=True)
class PickedRectangle:
    """Three corners of a rectangle on a surface, as seen from outside."""

    lower_left_enu_m: Vec3
    lower_right_enu_m: Vec3
    upper_left_enu_m: Vec3


class RectangleState(Enum):
    """Which corner is next."""

    LOWER_LEFT = auto()
    LOWER_RIGHT = auto()
    UPPER_LEFT = auto()


class RectangleTool(ClickTool):
    """A rectangle on a surface with three clicks, shown with its grid of rows and columns.

    ============  ================  ===========================================
    state         event             next state
    ============  ================  ===========================================
    LOWER_LEFT    click on surface  LOWER_RIGHT
    LOWER_RIGHT   click             UPPER_LEFT; stays for an edge without length
    LOWER_RIGHT   BACK              LOWER_LEFT
    UPPER_LEFT    click             ends with `PickedRectangle`; stays for none
    UPPER_LEFT    BACK              LOWER_RIGHT
    ============  ================  ===========================================

    The first click gives the plane: the corner and the surface's normal there. The others are where the ray meets the
    surface, brought onto that plane, or meets the plane itself beside the surface.
    """

    def __init__(self, n_rows: int = 1, n_columns: int = 1) -> None:
        self.state = RectangleState.LOWER_LEFT
        self._missed = False
        self._corners: list[Array] = []
        self._normal = np.zeros(3)
        self._next: Array | None = None
        self.set_grid(n_rows, n_columns)

    def set_grid(self, n_rows: int, n_columns: int) -> None:
        """Rows and columns of the grid that is shown."""
        if n_rows < 1 or n_columns < 1:
            raise ValueError(f"expected at least one row and column, got {n_rows} x {n_columns}")
        self._n_rows, self._n_columns = n_rows, n_columns

    @property
    def hint(self) -> Hint:
        """Asks for the next corner."""
        if self._missed:
            return Hint.NOTHING_THERE
        return {
            RectangleState.LOWER_LEFT: Hint.CLICK_LOWER_LEFT,
            RectangleState.LOWER_RIGHT: Hint.CLICK_LOWER_RIGHT,
            RectangleState.UPPER_LEFT: Hint.CLICK_UPPER_LEFT,
        }[self.state]

    @property
    def value(self) -> PickedRectangle | None:
        """The rectangle, once the pointer gives its third corner a place."""
        if self.state is not RectangleState.UPPER_LEFT or self._next is None:
            return None
        low, right = self._corners
        if np.linalg.norm(self._next - low) < MIN_SIZE_M:
            return None
        return PickedRectangle(vec3(low), vec3(right), vec3(self._next))

    @property
    def preview(self) -> Preview:
        """The clicked corners, the lower edge, then the whole grid."""
        points = [*self._corners, *([] if self._next is None else [self._next])]
        lift = 0.08 * self._normal
        dots = tuple(point + lift for point in points)
        if len(points) < 2:
            return Preview(dots=dots)
        across = points[1] - points[0]
        if len(points) == 2:
            return Preview((np.stack(dots),), dots, lengths_m=(float(np.linalg.norm(across)),))
        along = points[2] - points[0]
        base, lines = points[0] + lift, []
        for u in np.linspace(0.0, 1.0, self._n_columns + 1):
            lines.append(np.stack([base + u * across, base + u * across + along]))
        for v in np.linspace(0.0, 1.0, self._n_rows + 1):
            lines.append(np.stack([base + v * along, base + v * along + across]))
        return Preview(tuple(lines), dots, lengths_m=(float(np.linalg.norm(across)), float(np.linalg.norm(along))))

    def move(self, pointer: Pointer) -> None:
        """Put the next corner under the pointer."""
        self._missed = False
        if self.state is RectangleState.LOWER_LEFT:
            self._next = None if pointer.hit is None else pointer.hit.point_enu_m
            self._normal = np.zeros(3) if pointer.hit is None else pointer.hit.normal
            return
        point = self._on_plane(pointer)
        if point is None:
            self._next = None
            return
        low = self._corners[0]
        if self.state is RectangleState.LOWER_RIGHT:
            rise = point[2] - low[2]
            level = point - [0.0, 0.0, rise]
            flat_m = float(np.linalg.norm(level - low))
            if not pointer.shift and abs(rise) < LEVEL_SLOPE * flat_m and abs(self._normal[2]) < LEVEL_SLOPE:
                point = level
        else:
            across = self._corners[1] - low
            point = point - (point - low) @ across / (across @ across) * across
        self._next = point

    def click(self, pointer: Pointer) -> PickedRectangle | None:
        """Fix the next corner."""
        self.move(pointer)
        self._missed = self._next is None
        if self._next is None:
            return None
        if self.state is RectangleState.LOWER_LEFT:
            self._corners = [self._next]
            self.state = RectangleState.LOWER_RIGHT
            self._next = None
        elif self.state is RectangleState.LOWER_RIGHT:
            if np.linalg.norm(self._next - self._corners[0]) >= MIN_SIZE_M:
                self._corners.append(self._next)
                self.state = RectangleState.UPPER_LEFT
                self._next = None
        else:
            return self.value
        return None

    def press_key(self, key: Key, is_fine: bool) -> None:
        """BACK takes the last corner back."""
        if key is Key.BACK and self._corners:
            self._corners.pop()
            self._next = None
            self.state = RectangleState.LOWER_RIGHT if self._corners else RectangleState.LOWER_LEFT

    def _on_plane(self, pointer: Pointer) -> Array | None:
        low, normal = self._corners[0], self._normal
        if pointer.hit is not None:
            point = pointer.hit.point_enu_m
            offset = float((point - low) @ normal)
            if abs(offset) < 1.0:
                return np.asarray(point - offset * normal)
        steep = float(pointer.ray @ normal)
        if abs(steep) < 1e-3:
            return None
        along = float((low - pointer.view.eye_enu_m) @ normal) / steep
        return np.asarray(pointer.view.eye_enu_m + along * pointer.ray) if along > 0.0 else None


@dataclass(frozen=True, slots=True)
class DrawnPolygon:
    """Corners of a simple polygon on the ground, in the order of the clicks."""

    corners_enu_m: tuple[tuple[float, float], ...]


class PolygonTool(ClickTool):
    """A polygon on the ground: click corners, end with Enter, a double click or a click on the first corner.

    =========  ==========================  ==============================================
    corners    event                       then
    =========  ==========================  ==============================================
    0, 1, 2    click                       one more; a side that crosses another is refused
    3 or more  click near first, CONFIRM   ends with `DrawnPolygon` if the last side crosses none
    any        BACK                        one less
    =========  ==========================  ==============================================
    """

    def __init__(self) -> None:
        self._corners: list[Array] = []
        self._next: Array | None = None
        self._missed = False
        self._is_refused = False

    @property
    def hint(self) -> Hint:
        """Asks for corners, and says why one is refused."""
        if self._missed:
            return Hint.NOTHING_THERE
        if self._is_refused:
            return Hint.POLYGON_CROSSES
        return Hint.CLICK_CORNER if len(self._corners) < 3 else Hint.CLICK_MORE_CORNERS

    @property
    def value(self) -> DrawnPolygon | None:
        """The polygon of the corners clicked so far, once there are three."""
        if len(self._corners) < 3 or not _is_simple(self._corners, is_closed=True):
            return None
        return DrawnPolygon(tuple((vec3(corner)[0], vec3(corner)[1]) for corner in self._corners))

    @property
    def preview(self) -> Preview:
        """Sides so far, the one to the pointer, and the one that would close it."""
        points = [*self._corners, *([] if self._next is None else [self._next])]
        lift = np.array([0.0, 0.0, 0.1])
        lines = () if len(points) < 2 else (np.stack([*points, points[0]]) + lift,)
        lengths = () if len(points) < 2 else (float(np.linalg.norm(points[-1] - points[-2])),)
        return Preview(lines, tuple(point + lift for point in points), self._is_refused, lengths)

    def move(self, pointer: Pointer) -> None:
        """Put the next corner under the pointer."""
        self._missed = False
        self._next = pointer.ground_enu_m
        self._is_refused = self._next is not None and not _is_simple([*self._corners, self._next], is_closed=False)

    def click(self, pointer: Pointer) -> DrawnPolygon | None:
        """Fix the next corner, or close the polygon at the first."""
        if len(self._corners) >= 3:
            first, _ = pointer.view.project(self._corners[0])
            if np.hypot(first[0] - pointer.x_px, first[1] - pointer.y_px) <= SNAP_PX:
                return self.press_key(Key.CONFIRM, False)
        self.move(pointer)
        self._missed = self._next is None
        corner, self._next = self._next, None
        if corner is None or self._is_refused:
            return None
        if not self._corners or np.linalg.norm(corner - self._corners[-1]) >= MIN_SIZE_M:
            self._corners.append(corner)
        return None

    def press_key(self, key: Key, is_fine: bool) -> DrawnPolygon | None:
        """CONFIRM ends, BACK takes the last corner back."""
        if key is Key.BACK and self._corners:
            self._corners.pop()
            self._is_refused = False
        if key is Key.CONFIRM:
            self._next = None
            self._is_refused = len(self._corners) >= 3 and self.value is None
            return self.value
        return None


def _is_simple(points: list[Array], *, is_closed: bool) -> bool:
    """Whether sides between points on the ground meet only at their common ends."""
    import shapely

    flat = [(float(point[0]), float(point[1])) for point in points]
    if len(flat) < 3:
        return True
    if is_closed:
        polygon = shapely.Polygon(flat)
        return bool(polygon.is_valid and polygon.area > MIN_SIZE_M**2)
    return bool(shapely.LineString(flat).is_simple)


@dataclass(frozen=True, slots=True)
class DrawnBox:
    """Lowest and highest corner of an axis-aligned box."""

    min_enu_m: Vec3
    max_enu_m: Vec3


class BoxState(Enum):
    """What the next click gives."""

    CORNER = auto()
    OPPOSITE = auto()
    HEIGHT = auto()


class BoxTool(ClickTool):
    """An axis-aligned box: two corners on the ground, then its height.

    ========  ======  ==============================================
    state     event   next state
    ========  ======  ==============================================
    CORNER    click   OPPOSITE
    OPPOSITE  click   HEIGHT; stays while the base has no area
    OPPOSITE  BACK    CORNER
    HEIGHT    click   ends with `DrawnBox`; stays while it has no height
    HEIGHT    BACK    OPPOSITE
    ========  ======  ==============================================
    """

    def __init__(self) -> None:
        self.state = BoxState.CORNER
        self._corners: list[Array] = []
        self._next: Array | None = None
        self._height_m = 0.0
        self._missed = False

    @property
    def hint(self) -> Hint:
        """Asks for the next click."""
        if self._missed:
            return Hint.NOTHING_THERE
        return {
            BoxState.CORNER: Hint.CLICK_CORNER,
            BoxState.OPPOSITE: Hint.CLICK_OPPOSITE_CORNER,
            BoxState.HEIGHT: Hint.CLICK_HEIGHT,
        }[self.state]

    @property
    def value(self) -> DrawnBox | None:
        """The box, once it has a height."""
        if self.state is not BoxState.HEIGHT or self._height_m < MIN_SIZE_M:
            return None
        low, high = np.minimum(*self._corners), np.maximum(*self._corners)
        return DrawnBox(vec3(low), vec3(high + np.array([0.0, 0.0, self._height_m])))

    @property
    def preview(self) -> Preview:
        """The base, then all edges."""
        points = [*self._corners, *([] if self._next is None else [self._next])]
        if len(points) < 2:
            return Preview(dots=tuple(points))
        low, high = np.minimum(*points), np.maximum(*points)
        ring = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]], [low[0], low[1]]])
        base = np.c_[ring, np.full(5, low[2] + 0.1)]
        top = base + np.array([0.0, 0.0, self._height_m])
        size_m = (float(high[0] - low[0]), float(high[1] - low[1]))
        if self.state is not BoxState.HEIGHT:
            return Preview((base,), tuple(points), lengths_m=size_m)
        posts = tuple(np.stack([base[i], top[i]]) for i in range(4))
        return Preview((base, top, *posts), (), lengths_m=(*size_m, self._height_m))

    def move(self, pointer: Pointer) -> None:
        """Put the next corner or the height under the pointer."""
        self._missed = False
        if self.state is BoxState.HEIGHT:
            self._height_m = max(0.0, _height_on_post(pointer, self._corners[1]))
        else:
            self._next = pointer.ground_enu_m

    def click(self, pointer: Pointer) -> DrawnBox | None:
        """Fix what the pointer shows."""
        self.move(pointer)
        if self.state is BoxState.HEIGHT:
            return self.value
        self._missed = self._next is None
        if self._next is None:
            return None
        if self.state is BoxState.CORNER:
            self._corners = [self._next]
            self.state = BoxState.OPPOSITE
        elif np.abs(self._next - self._corners[0])[:2].min() >= MIN_SIZE_M:
            self._corners.append(self._next)
            self.state = BoxState.HEIGHT
        self._next = None
        return None

    def press_key(self, key: Key, is_fine: bool) -> None:
        """BACK takes the last corner back."""
        if key is Key.BACK and self._corners:
            self._corners.pop()
            self._next, self._height_m = None, 0.0
            self.state = BoxState.OPPOSITE if self._corners else BoxState.CORNER


def _height_on_post(pointer: Pointer, foot_enu_m: Array) -> float:
    """Height above a foot at which the upright line through it is nearest to the pointer's ray, metres.

    From above, where that line is hardly to be seen, the height is how far the pointer moved up in the picture.
    """
    view = pointer.view
    if view.forward[2] < -STEEP:
        pixel, depth = view.project(foot_enu_m)
        return float(pixel[1] - pointer.y_px) * view.metres_per_px(float(depth))
    ray, to_foot = pointer.ray, foot_enu_m - pointer.view.eye_enu_m
    level = float(ray[0] ** 2 + ray[1] ** 2)
    if level < 1e-9:
        return 0.0
    along = float(ray[:2] @ to_foot[:2]) / level
    return float(along * ray[2] - to_foot[2])
