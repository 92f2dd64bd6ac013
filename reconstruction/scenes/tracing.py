"""Light along rays through a scene: what they meet, and what panes mirror into them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel
from reconstruction.scenes.environment import ROWS, Environment
from reconstruction.scenes.geometry import Geometry, Meeting
from reconstruction.scenes.optics import mirrored, pane_light
from reconstruction.scenes.record import Layer, Scene
from reconstruction.scenes.shading import MattLight, SkyLight

Array = NDArray[np.float64]
Index = NDArray[np.int64]

DUST_ALBEDO = 0.35
"""Of dry dust on panes: between soil (0.2) and light sand (0.45)."""

LEAST_RISE = 1e-6
"""Sine of the angle at which light leaves a flat pane whose tilt would mirror it into the facade."""

STEEPEST_SHIFT = 0.02
"""Cosine below which the image in the second sheet is displaced no further; its share of the light vanishes there."""


@dataclass(frozen=True, slots=True)
class Switches:
    """Effects of light that are simulated.

    Parameters
    ----------
    near_field
        Panes mirror what stands around from where they are; otherwise what a picture of all directions shows, but for
        the building itself.
    fresnel
        Reflectance depends on the angle; otherwise it is that at normal incidence.
    second_bounce
        Panes seen in panes mirror once more; otherwise they show what is behind them.
    tilt
        Panes are tilted and bowed; otherwise flat in their facade.
    doubling
        The second sheet's image is displaced; otherwise it lies on the first's.
    shadow
        Bodies and panes keep the sun away.
    """

    near_field: bool = True
    fresnel: bool = True
    second_bounce: bool = True
    tilt: bool = True
    doubling: bool = True
    shadow: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Light:
    """What comes along n rays.

    Parameters
    ----------
    met
        What the rays met first; its normals are the flat panes'.
    normals_enu
        Unit, towards the ray's origin, with the panes' tilt and bow, shape (n, 3); 0 for sky.
    diffuse, reflection
        Linear light without mirror images, and that of mirror images alone, each shape (n, 3).
    """

    met: Meeting
    normals_enu: Array
    diffuse: Array
    reflection: Array


class Tracer:
    """A scene with its effects of light switched on or off.

    Parameters
    ----------
    geometry
        Of the scene, if it is at hand.
    environment_rows
        Of the picture of the surroundings, where that takes the near field's place.
    """

    def __init__(
        self, scene: Scene, switches: Switches, geometry: Geometry | None = None, environment_rows: int = ROWS
    ) -> None:
        self.geometry = geometry or Geometry(scene)
        self._scene, self._switches = scene, switches
        self._sky = SkyLight(scene.sky)
        shadows = self.geometry if switches.shadow else None
        self._matt = MattLight(scene.bodies, self.geometry, self._sky, shadows)
        self._around: tuple[Geometry, MattLight, SkyLight | Environment] = (self.geometry, self._matt, self._sky)
        """What panes mirror: what stands there, its light, and what is far behind it."""
        if not switches.near_field and len(scene.panes.corners_enu_m) > 0:
            building = replace(scene, bodies=tuple(body for body in scene.bodies if body.layer is Layer.BUILDING))
            walls = Geometry(building)
            matt = MattLight(building.bodies, walls, self._sky, shadows)
            self._around = walls, matt, Environment(scene, self._sky, shadows, environment_rows)

    def trace(self, origins_enu_m: Array, directions_enu: Array, beam_rad: float) -> Light:
        """Light along rays, shape (n, 3), unit directions, whose pixels are `beam_rad` wide."""
        met = self.geometry.meet(origins_enu_m, directions_enu)
        diffuse, reflection = np.zeros_like(directions_enu), np.zeros_like(directions_enu)
        is_body, is_pane = met.bodies >= 0, met.panes >= 0
        diffuse[is_body] = _of_bodies(self._matt, met, is_body, directions_enu, beam_rad * met.distance_m)
        is_sky = ~(is_body | is_pane)
        diffuse[is_sky] = self._sky.seen(directions_enu[is_sky])
        normals = met.normals_enu.copy()
        if is_pane.any():
            normals[is_pane] = self.mirror_normals(met, is_pane)
            bounces = 2 if self._switches.second_bounce else 1
            diffuse[is_pane], reflection[is_pane] = self._of_panes(
                met, is_pane, directions_enu, normals, met.distance_m, beam_rad, bounces
            )
        return Light(met, normals, diffuse, reflection)

    def mirror_normals(self, met: Meeting, rows: NDArray[np.bool_]) -> Array:
        """Unit normals of panes met, with tilt and bow, on the flat normals' side; shape (number of rows, 3)."""
        flat = met.normals_enu[rows]
        if not self._switches.tilt:
            return flat
        panes, frames = self._scene.panes, self.geometry.pane_frames
        return np.asarray(
            _mirror_normals(
                met.points_enu_m[rows],
                met.panes[rows],
                flat,
                frames.middles_enu_m,
                np.stack([frames.rights, frames.ups]),
                np.stack([panes.tilts_rad, panes.bows_per_m]),
            )
        )

    def _of_panes(
        self,
        met: Meeting,
        rows: NDArray[np.bool_],
        directions_enu: Array,
        normals_enu: Array,
        path_m: Array,
        beam_rad: float,
        bounces: int,
    ) -> tuple[Array, Array]:
        """Light without, and of, mirror images from panes, each shape (number of rows, 3).

        `path_m`, shape (n,), is what each ray has come already; `normals_enu`, shape (n, 3), the mirrors'.
        """
        directions, normals, points = directions_enu[rows], normals_enu[rows], met.points_enu_m[rows]
        which, flat = met.panes[rows], met.normals_enu[rows]
        cosines = np.abs(np.einsum("nk,nk->n", directions, normals))
        first, behind, through, dirt = self._shares(which, cosines)
        diffuse = (1.0 - dirt) * through * self._scene.panes.rooms[which]
        dusty = np.flatnonzero(dirt)
        diffuse[dusty] += dirt[dusty] * DUST_ALBEDO * self._matt.arriving(points[dusty], flat[dusty])
        if bounces == 0:
            return diffuse, np.zeros_like(diffuse)
        out = mirrored(directions, normals)
        _keep_outside(out, flat)
        seen = self._mirrored(points, out, flat, path_m[rows], beam_rad, bounces - 1)
        shift = self._second_image_shift(which, directions, flat) if self._switches.doubling else None
        if shift is None:
            reflection = (first + behind) * seen
        else:
            again = self._mirrored(points + shift, out, flat, path_m[rows], beam_rad, bounces - 1)
            reflection = first * seen + behind * again
        return diffuse, (1.0 - dirt) * reflection

    def _mirrored(
        self, points: Array, directions: Array, flat: Array, path_m: Array, beam_rad: float, bounces: int
    ) -> Array:
        """Light, shape (n, 3), that comes to panes from where their mirrored rays go."""
        geometry, matt, far = self._around
        starts, ahead = self.geometry.leaving(points, directions, flat)
        met = geometry.meet(starts, directions)
        path = path_m + ahead + met.distance_m
        light = np.zeros_like(directions)
        is_body, is_pane = met.bodies >= 0, met.panes >= 0
        light[is_body] = _of_bodies(matt, met, is_body, directions, beam_rad * path)
        is_sky = ~(is_body | is_pane)
        light[is_sky] = far.seen(directions[is_sky])
        if is_pane.any():
            normals = met.normals_enu.copy()
            normals[is_pane] = self.mirror_normals(met, is_pane)
            light[is_pane] = sum(self._of_panes(met, is_pane, directions, normals, path, beam_rad, bounces))
        return light

    def _shares(self, which: Index, cosines: Array) -> tuple[Array, Array, Array, Array]:
        """Reflected by the first sheet, by what is behind it, let through (each shape (n, 3)), and dirt, (n, 1)."""
        first, behind, through = (np.zeros((len(which), 3)) for _ in range(3))
        dirt = np.zeros((len(which), 1))
        kinds = self._scene.panes.glass[which]
        for number, glass in enumerate(self._scene.glasses):
            rows = kinds == number
            angle = cosines[rows] if self._switches.fresnel else np.ones(1)
            first[rows], behind[rows], through[rows] = pane_light(angle, glass)
            dirt[rows] = glass.dirt
        return first, behind, through, dirt

    def _second_image_shift(self, which: Index, directions: Array, flat: Array) -> Array | None:
        """How far light reflected by the second sheet leaves beside the first's, shape (n, 3), in the pane's plane."""
        gaps = np.array([glass.gap_m if glass.sheets == 2 else 0.0 for glass in self._scene.glasses])
        gap = gaps[self._scene.panes.glass[which]]
        if not gap.any():
            return None
        falling = np.einsum("nk,nk->n", directions, flat)
        along = directions - falling[:, None] * flat
        return np.asarray(2.0 * (gap / np.maximum(-falling, STEEPEST_SHIFT))[:, None] * along)


def _of_bodies(matt: MattLight, met: Meeting, rows: NDArray[np.bool_], directions_enu: Array, width_m: Array) -> Array:
    normals = met.normals_enu[rows]
    cosines = np.abs(np.einsum("nk,nk->n", normals, directions_enu[rows]))
    return matt.light(met.bodies[rows], met.triangles[rows], met.points_enu_m[rows], normals, cosines, width_m[rows])


@kernel
def _mirror_normals(
    points: Array, which: Index, flat: Array, middles: Array, axes: Array, tilts_and_bows: Array
) -> Array:
    """As `Panes` says, on the side of `flat`; `axes` are rights and ups, shape (2, m, 3)."""
    normals = np.empty_like(points)
    for i in range(len(points)):
        pane, square = which[i], 1.0
        # Seen from behind, the flat normal is turned round, and the slopes with it.
        facing = 0.0
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            facing += flat[i, k] * (axes[0, pane, a] * axes[1, pane, b] - axes[0, pane, b] * axes[1, pane, a])
        side = 1.0 if facing >= 0.0 else -1.0
        for k in range(3):
            normals[i, k] = flat[i, k]
        for axis in range(2):
            along = 0.0
            for k in range(3):
                along += (points[i, k] - middles[pane, k]) * axes[axis, pane, k]
            slope = side * (tilts_and_bows[0, pane, axis] + tilts_and_bows[1, pane, axis] * along)
            square += slope * slope
            for k in range(3):
                normals[i, k] += slope * axes[axis, pane, k]
        for k in range(3):
            normals[i, k] /= math.sqrt(square)
    return normals


@kernel
def _keep_outside(directions: Array, flat: Array) -> None:
    """Lift unit directions that point into the facade to `LEAST_RISE` above it, in place."""
    for i in range(len(directions)):
        rise = 0.0
        for k in range(3):
            rise += directions[i, k] * flat[i, k]
        if rise < LEAST_RISE:
            square = 0.0
            for k in range(3):
                directions[i, k] += (LEAST_RISE - rise) * flat[i, k]
                square += directions[i, k] * directions[i, k]
            for k in range(3):
                directions[i, k] /= math.sqrt(square)
