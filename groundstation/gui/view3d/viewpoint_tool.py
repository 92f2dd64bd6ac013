"""The tool that moves a viewpoint: by dragging in the plane of the picture, along its own line of sight, or by keys."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.picking import VIEWPOINT_PX
from groundstation.gui.view3d.tools import Hint, Key, Pointer, Preview, vec3
from planning.geo.frames import Vec3, camera_axes

Array = NDArray[np.float64]

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
