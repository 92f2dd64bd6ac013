"""Rooms behind panes, met by rays that come through the glass: walls, lamps, furniture, and blinds before them.

A room is a box in its pane's frame, so the place where a ray meets it is arithmetic (J. van Dongen, Interior Mapping,
Computer Graphics International 2008), and no room takes a triangle. What sends light there is not worked out: each part
sends a share of the room's light.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.scenes.light.geometry import PaneFrames
from reconstruction.scenes.light.pane_surfaces import half_sides_m
from reconstruction.scenes.record import Interiors, Panes

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SIDE, FLOOR, CEILING = 0.85, 0.5, 0.95
"""Light of the room's sides, as shares of the back wall's."""

TOP, FLANK = 1.2, 0.8
"""Light of the upper face and the flanks of furniture, as shares of its front's."""

FADES_M = 8.0
"""Depth in which a room's light falls to 1 / e: daylight comes through the panes."""

LAMPS_EVERY_M, LAMP_M = 2.4, 0.6
"""Square lamps in the ceiling, and how far apart their middles are: a usual office's grid."""

BLIND_BEHIND_M, SLAT_M, SLAT_SHADE = 0.05, 0.05, 0.2
"""A blind's distance behind the pane; how far apart its slats are; and how much less light than where they are
brightest they send on average, and that again at least."""

LEAST_INWARDS = 1e-6
"""Cosine below which a ray through the glass counts as this slanting."""


class RoomLight:
    """Light that comes from the rooms of panes, before it passes the glass."""

    def __init__(self, interiors: Interiors, panes: Panes, frames: PaneFrames) -> None:
        self._rooms, self._mean = interiors, panes.rooms
        self._middles = frames.middles_enu_m
        self._axes = np.stack([frames.rights, frames.ups, -frames.normals])
        self._halves = half_sides_m(panes, frames)

    def light_from(
        self, points_enu_m: Array, directions_enu: Array, which: Index, flat: Array, widths_m: Array
    ) -> Array:
        """Light, shape (n, 3), that rays see behind panes; from inside the building, the room's mean.

        Parameters
        ----------
        points_enu_m, directions_enu, which, flat
            Where rays meet panes, unit directions, which panes, and their flat normals towards the rays' origins.
        widths_m
            Of the pixels' beams there, shape (n,).
        """
        light = self._mean[which]
        rows = np.flatnonzero(np.einsum("nk,nk->n", flat, self._axes[2, which]) < 0.0)
        rooms = self._rooms
        shares = room_shares(
            points_enu_m[rows], directions_enu[rows], which[rows], widths_m[rows], self._middles, self._axes,
            self._halves, rooms.rooms_m, rooms.furniture_m, rooms.lamps, rooms.blinds,
        )  # fmt: skip
        light[rows] = shares[:, :1] * rooms.lights[which[rows]] + shares[:, 1:] * rooms.blind_lights[which[rows]]
        return light


@kernel
def room_shares(
    points: Array, directions: Array, which: Index, widths: Array, middles: Array, axes: Array, halves: Array,
    rooms: Array, furniture: Array, lamps: Array, blinds: Array,
) -> Array:  # fmt: skip
    """What rays see, as shares of the rooms' lights and of the blinds' lights, shape (n, 2).

    `axes` are rights, ups and inward normals, shape (3, m, 3); `halves` the panes' half sides, shape (m, 2).
    """
    shares = np.zeros((len(points), 2))
    place, way = np.zeros(3), np.zeros(3)
    for i in range(len(points)):
        pane = which[i]
        for axis in range(3):
            place[axis] = way[axis] = 0.0
            for k in range(3):
                place[axis] += (points[i, k] - middles[pane, k]) * axes[axis, pane, k]
                way[axis] += directions[i, k] * axes[axis, pane, k]
        # On bowed glass a little before or behind the flat pane, where the room begins.
        place[2] = 0.0
        way[2] = max(way[2], LEAST_INWARDS)
        at_blind = place[1] + BLIND_BEHIND_M * way[1] / way[2]
        if blinds[pane] > 0.0 and at_blind >= halves[pane, 1] * (1.0 - 2.0 * min(blinds[pane], 1.0)):
            sharp = max(0.0, 1.0 - widths[i] / SLAT_M)
            shares[i, 1] = 1.0 - SLAT_SHADE * (1.0 - sharp * math.sin(2.0 * math.pi * at_blind / SLAT_M))
        else:
            shares[i, 0] = _room_share(place, way, rooms[pane], furniture[pane], lamps[pane])
    return shares


@kernel
def _room_share(place: Array, way: Array, room: Array, furniture: Array, lamps: float) -> float:
    """Light that a ray from the pane meets in its room, as a share of the back wall's at the window."""
    nearest, share, on_ceiling = room[4] / way[2], 1.0, False
    for axis in range(2):
        if way[axis] != 0.0:
            end = room[2 * axis + 1] if way[axis] > 0.0 else room[2 * axis]
            t = max((end - place[axis]) / way[axis], 0.0)
            if t < nearest:
                nearest, on_ceiling = t, axis == 1 and way[1] > 0.0
                share = SIDE if axis == 0 else (CEILING if way[1] > 0.0 else FLOOR)
    if on_ceiling and _is_lamp(place[0] + nearest * way[0] - room[0]) and _is_lamp(nearest * way[2]):
        share *= lamps
    for block in furniture:
        if block[2] <= 0.0:
            continue
        first, last, face = 0.0, nearest, -1
        for axis in range(3):
            low = block[0] if axis == 0 else (room[2] if axis == 1 else block[3])
            high = block[1] if axis == 0 else (room[2] + block[2] if axis == 1 else block[4])
            if way[axis] == 0.0:
                if not low <= place[axis] <= high:
                    last = -1.0
                continue
            one, other = (low - place[axis]) / way[axis], (high - place[axis]) / way[axis]
            if min(one, other) > first:
                first, face = min(one, other), axis
            last = min(last, max(one, other))
        if face >= 0 and first < last:
            nearest = first
            share = block[5] * (FLANK if face == 0 else (TOP if face == 1 else 1.0))
    return share * math.exp(-nearest * way[2] / FADES_M)


@kernel
def _is_lamp(along: float) -> bool:
    beside = along - LAMPS_EVERY_M * math.floor(along / LAMPS_EVERY_M)
    return abs(beside - 0.5 * LAMPS_EVERY_M) <= 0.5 * LAMP_M
