"""The surroundings as one picture of all directions: what panes mirror where near and far cannot be told apart."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, run_chunks
from reconstruction.scenes.light.ambient import Ambient, Gather
from reconstruction.scenes.light.geometry import Geometry
from reconstruction.scenes.light.shading import MattLight, SkyLight, look_up
from reconstruction.scenes.record import Layer, Panes, Scene

Array = NDArray[np.float64]

ROWS = 1024
"""Of the picture, unless told otherwise: 0.18 degrees a pixel, as in a wide photo of 512 pixels' width; two million
rays, once."""

ROWS_AT_ONCE = 32


def facade_middle_enu_m(scene: Scene) -> Array:
    """Where the picture is taken: the mean of all panes' corners, shape (3,)."""
    return np.asarray(scene.panes.corners_enu_m.reshape(-1, 3).mean(axis=0))


class Environment:
    """Everything but the building, seen from the facade's middle; the sky in between stays exact.

    Parameters
    ----------
    shadows
        What keeps the sun away, the building with it; None for no shadows.
    rows
        Of the picture, which is twice as wide.
    gather
        As in `Ambient`; None for light of open sky.
    """

    def __init__(
        self, scene: Scene, sky: SkyLight, shadows: Geometry | None, rows: int, gather: Gather | None = None
    ) -> None:
        self._sky = sky
        around = tuple(body for body in scene.bodies if body.layer is not Layer.BUILDING)
        self._geometry = Geometry(replace(scene, bodies=around, panes=_no_panes()))
        ambient = None if gather is None else Ambient(self._geometry, gather)
        self._matt = MattLight(around, self._geometry, sky, shadows, ambient)
        self._middle = facade_middle_enu_m(scene)
        self._rows = rows
        strips = run_chunks(self._strip, chunks(rows, ROWS_AT_ONCE))
        self._picture = np.concatenate(strips).reshape(rows, 2 * rows, 4)

    def seen(self, directions_enu: Array) -> Array:
        """Light from unit directions, shape (n, 3)."""
        found = look_up(self._picture, directions_enu)
        return np.asarray(found[:, :3] + (1.0 - found[:, 3:]) * self._sky.seen(directions_enu))

    def _strip(self, start: int, stop: int) -> NDArray[np.float32]:
        """Light of bodies, and the share of each pixel that they cover, shape (pixels of these rows, 4)."""
        elevation = math.pi * (0.5 - (np.arange(start, stop) + 0.5) / self._rows)
        heading = math.pi * (np.arange(2 * self._rows) + 0.5) / self._rows
        elevation, heading = (a.ravel() for a in np.meshgrid(elevation, heading, indexing="ij"))
        level = np.cos(elevation)
        directions = np.column_stack([level * np.sin(heading), level * np.cos(heading), np.sin(elevation)])
        met = self._geometry.meet(np.broadcast_to(self._middle, directions.shape), directions)
        is_body = met.bodies >= 0
        light = np.zeros((len(directions), 4), np.float32)
        light[:, 3] = is_body
        normals = met.normals_enu[is_body]
        light[is_body, :3] = self._matt.light(
            met.bodies[is_body],
            met.triangles[is_body],
            met.points_enu_m[is_body],
            normals,
            np.abs(np.einsum("nk,nk->n", normals, directions[is_body])),
            math.pi / self._rows * met.distance_m[is_body],
        )
        return light


def _no_panes() -> Panes:
    none, two = np.zeros((0, 3)), np.zeros((0, 2))
    return Panes(np.zeros((0, 4, 3)), two, two, np.zeros(0, np.int64), none)
