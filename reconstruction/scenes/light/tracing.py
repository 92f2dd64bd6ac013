"""Light along rays through a scene: what they meet, and what panes mirror into them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.scenes.light.geometry import Geometry, RayHits
from reconstruction.scenes.light.interiors import RoomLight
from reconstruction.scenes.light.pane_surfaces import PaneSurfaces, mirrored, pane_light
from reconstruction.scenes.light.shading import (
    AMBIENT_BEAM_RAD,
    COARSE,
    Ambient,
    Environment,
    Gather,
    MattLight,
    SkyLight,
)
from reconstruction.scenes.parameters import ROWS
from reconstruction.scenes.record import Layer, Scene, Sky

Array = NDArray[np.float64]


# The sun as a disc that is seen: directly, and in panes.
#
# Its light is that of `Sky.sun` exactly: a disc of radiance L that covers the solid angle w of the sky lights a
# surface which faces it as a whole sky of radiance L w / pi, and such light is what `record` counts in.

RADIUS_RAD = math.radians(0.533 / 2.0)
"""Mean over the year (Astronomical Almanac: 0.524 to 0.542 degrees across)."""

LEAST_PIXELS = 1.0
"""Radius of a seen disc, in pixels: a smaller one is widened and dimmed, so that no ray misses it and its light stays.
"""

NARROWEST_RAD = 1e-9
"""Of a pixel."""


class Sun:
    """The disc of a sky's sun; there is none at and below the horizon."""

    def __init__(self, sky: Sky) -> None:
        self.direction_enu = sky.sun_direction_enu
        self._light = np.array(sky.sun, float)
        self.is_up = bool(self.direction_enu[2] > 0.0 and self._light.any())

    def radiance(self, radius_rad: float = RADIUS_RAD) -> Array:
        """Of a disc of this radius that sends the sun's light, shape (3,)."""
        return np.asarray(self._light / (2.0 * math.sin(0.5 * radius_rad)) ** 2)

    def light_from(self, directions_enu: Array, beams_rad: Array | float) -> Array:
        """Light of the disc in unit directions, shape (n, 3), for pixels `beams_rad` wide, shape (n,) or ().

        Its edge is as soft as a pixel is wide, so that few rays sum up to its light wherever they pass.
        """
        light = np.zeros_like(directions_enu)
        if not self.is_up:
            return light
        beams = np.clip(beams_rad, NARROWEST_RAD, 1.0)
        # Nearly all rays go elsewhere.
        farthest = 2.0 * (RADIUS_RAD + float(np.max(beams, initial=0.0)))
        rows = np.flatnonzero(directions_enu @ self.direction_enu >= math.cos(farthest))
        beams = np.broadcast_to(beams, len(light))[rows]
        away = directions_enu[rows] - self.direction_enu
        # Chords, whose squares measure areas on the sphere.
        chords = np.sqrt(np.einsum("nk,nk->n", away, away))
        radii = 2.0 * np.sin(0.5 * np.maximum(RADIUS_RAD, LEAST_PIXELS * beams))
        inner, outer = np.maximum(radii - 0.5 * beams, 0.0), radii + 0.5 * beams
        shares = np.clip((outer - chords) / (outer - inner), 0.0, 1.0) * (directions_enu[rows, 2] > 0.0)
        # A cone without its tip over a circle.
        areas = (inner * inner + inner * outer + outer * outer) / 3.0
        light[rows] = (shares / areas)[:, None] * self._light
        return light


Index = NDArray[np.int64]


# What the kinds of glass in a scene do to light at its panes.

STEEPEST_SHIFT = 0.02
"""Cosine below which the image in the second sheet is displaced no further; its share of the light vanishes there."""


class PaneGlass:
    """Glass of the panes of a scene.

    Parameters
    ----------
    fresnel
        Whether reflectance depends on the angle; otherwise it is that at normal incidence.
    doubling
        Whether the second sheet's image is displaced.
    """

    def __init__(self, scene: Scene, fresnel: bool, doubling: bool) -> None:
        self._kinds, self._glasses, self._fresnel = scene.panes.glass, scene.glasses, fresnel
        gaps = np.array([glass.gap_m if glass.sheets == 2 else 0.0 for glass in scene.glasses])
        self._gaps_m = doubling * gaps[scene.panes.glass]

    def shares(self, which: Index, cosines: Array) -> tuple[Array, Array, Array, Array]:
        """Reflected by the first sheet, by what is behind it, let through (each shape (n, 3)), and dirt, (n, 1)."""
        first, behind, through = (np.zeros((len(which), 3)) for _ in range(3))
        dirt = np.zeros((len(which), 1))
        kinds = self._kinds[which]
        for number, glass in enumerate(self._glasses):
            rows = kinds == number
            angle = cosines[rows] if self._fresnel else np.ones(1)
            first[rows], behind[rows], through[rows] = pane_light(angle, glass)
            dirt[rows] = glass.dirt
        return first, behind, through, dirt

    def second_image_shift(self, which: Index, directions: Array, flat: Array) -> Array | None:
        """How far light reflected by the second sheet leaves beside the first's, shape (n, 3), in the pane's plane.

        None where no image is displaced.
        """
        gap = self._gaps_m[which]
        if not gap.any():
            return None
        falling = np.einsum("nk,nk->n", directions, flat)
        along = directions - falling[:, None] * flat
        return np.asarray(2.0 * (gap / np.maximum(-falling, STEEPEST_SHIFT))[:, None] * along)


DUST_ALBEDO = 0.35
"""Of dry dust on panes: between soil (0.2) and light sand (0.45)."""

LEAST_RISE = 1e-6
"""Sine of the angle at which light leaves a flat pane whose tilt would mirror it into the facade."""

FLATTEST = 0.02
"""Least cosine counted for how much a bowed pane spreads rays that graze it."""


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
        Panes are tilted; otherwise parallel to their facade.
    doubling
        The second sheet's image is displaced; otherwise it lies on the first's.
    shadow
        Bodies and panes keep the sun away.
    curvature
        Panes are bowed; otherwise flat.
    interior
        Rooms are seen through panes; otherwise their mean light. Panes seen in panes show that alone.
    sun_glare
        The sun is seen, and mirrored.
    occlusion
        What is near hides the facade behind it; otherwise rays from the camera to the facade pass through.
    sky_occlusion
        Light from around is what a place sees of the sky and of what stands there; otherwise that of open sky and even
        ground.
    """

    near_field: bool = True
    fresnel: bool = True
    second_bounce: bool = True
    tilt: bool = True
    doubling: bool = True
    shadow: bool = True
    curvature: bool = True
    interior: bool = True
    sun_glare: bool = True
    occlusion: bool = True
    sky_occlusion: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Light:
    """What comes along n rays.

    Parameters
    ----------
    hits
        What the rays met first, bowed and tilted panes where they are; its normals are the flat panes'.
    normals_enu
        Unit, towards the ray's origin, with the panes' tilt and bow, shape (n, 3); 0 for sky.
    diffuse, reflection
        Linear light without mirror images, and that of mirror images alone, each shape (n, 3).
    """

    hits: RayHits
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
    ambient
        Light from around in the place of that of open sky, where `sky_occlusion` is off.
    """

    def __init__(
        self,
        scene: Scene,
        switches: Switches,
        geometry: Geometry | None = None,
        environment_rows: int = ROWS,
        ambient: Ambient | None = None,
    ) -> None:
        self.geometry = geometry or Geometry(scene)
        self._scene, self._switches = scene, switches
        self._sky = SkyLight(scene.sky)
        self._sun = Sun(scene.sky)
        self._shines = switches.sun_glare and self._sun.is_up
        shadows = self.geometry if switches.shadow else None
        gather = self._gather() if switches.sky_occlusion else None
        self.ambient = ambient if gather is None else Ambient(self.geometry, gather)
        """Light from around, where it is not that of open sky."""
        self._matt = MattLight(scene.bodies, self.geometry, self._sky, shadows, self.ambient)
        self._glass = PaneGlass(scene, switches.fresnel, switches.doubling)
        self.surfaces = PaneSurfaces(scene.panes, self.geometry.pane_frames, switches.tilt, switches.curvature)
        self._rooms: RoomLight | None = None
        if switches.interior and scene.interiors is not None:
            self._rooms = RoomLight(scene.interiors, scene.panes, self.geometry.pane_frames)
        self._is_near, self._is_facade = (layer_mask(scene, layer) for layer in (Layer.NEAR, Layer.BUILDING))
        self._around: tuple[Geometry, MattLight, SkyLight | Environment] = (self.geometry, self._matt, self._sky)
        """What panes mirror: what stands there, its light, and what is far behind it."""
        if not switches.near_field and len(scene.panes.corners_enu_m) > 0:
            building = replace(scene, bodies=tuple(body for body in scene.bodies if body.layer is Layer.BUILDING))
            walls = Geometry(building)
            ambient = None if gather is None else Ambient(walls, gather)
            matt = MattLight(building.bodies, walls, self._sky, shadows, ambient)
            self._around = walls, matt, Environment(scene, self._sky, shadows, environment_rows, gather)

    def _gather(self) -> Gather:
        """What surfaces get from around: light of what stands there, in the light that reaches it in its turn."""
        light_alone = Switches(
            second_bounce=False,
            tilt=False,
            curvature=False,
            doubling=False,
            interior=False,
            sun_glare=False,
            sky_occlusion=False,
        )
        in_open_sky = Tracer(self._scene, light_alone, self.geometry)
        coarse = Ambient(self.geometry, in_open_sky.from_around, COARSE)
        return Tracer(self._scene, light_alone, self.geometry, ambient=coarse).from_around

    def from_around(self, starts_enu_m: Array, directions_enu: Array) -> tuple[Array, NDArray[np.bool_]]:
        """As `Gather`, by rays as wide as light on a surface allows."""
        light = self.trace(starts_enu_m, directions_enu, AMBIENT_BEAM_RAD)
        triangles = light.hits.triangles
        wound = self.geometry.normals_enu[triangles]
        is_behind = (triangles >= 0) & (np.einsum("nk,nk->n", wound, directions_enu) > 0.0)
        return light.diffuse + light.reflection, is_behind

    def trace(self, origins_enu_m: Array, directions_enu: Array, beam_rad: float) -> Light:
        """Light along rays, shape (n, 3), unit directions, whose pixels are `beam_rad` wide."""
        hits = self.geometry.meet(origins_enu_m, directions_enu)
        if not self._switches.occlusion:
            hits = self.geometry.beyond(hits, directions_enu, self._is_near, self._is_facade)
        hits, normals = self.surfaces.meet(hits, directions_enu)
        diffuse, reflection = np.zeros_like(directions_enu), np.zeros_like(directions_enu)
        is_body, is_pane = hits.bodies >= 0, hits.panes >= 0
        diffuse[is_body] = _of_bodies(self._matt, hits, is_body, directions_enu, beam_rad * hits.distance_m)
        is_sky = ~(is_body | is_pane)
        diffuse[is_sky] = self._sky.light_from(directions_enu[is_sky])
        if self._shines:
            diffuse[is_sky] += self._sun.light_from(directions_enu[is_sky], beam_rad)
        if is_pane.any():
            bounces = 2 if self._switches.second_bounce else 1
            rooms = self._scene.panes.rooms[hits.panes[is_pane]]
            if self._rooms is not None:
                where = (
                    hits.points_enu_m[is_pane],
                    directions_enu[is_pane],
                    hits.panes[is_pane],
                    hits.normals_enu[is_pane],
                )
                rooms = self._rooms.light_from(*where, beam_rad * hits.distance_m[is_pane])
            diffuse[is_pane], reflection[is_pane] = self._of_panes(
                hits, is_pane, directions_enu, normals, rooms, hits.distance_m, beam_rad, bounces
            )
        return Light(hits, normals, diffuse, reflection)

    def _of_panes(
        self,
        hits: RayHits,
        rows: NDArray[np.bool_],
        directions_enu: Array,
        normals_enu: Array,
        rooms: Array,
        path_m: Array,
        beam_rad: float,
        bounces: int,
    ) -> tuple[Array, Array]:
        """Light without, and of, mirror images from panes, each shape (number of rows, 3).

        `path_m`, shape (n,), is what each ray has come already; `normals_enu`, shape (n, 3), the mirrors'; `rooms` the
        light from behind the panes, shape (number of rows, 3).
        """
        directions, normals, points = directions_enu[rows], normals_enu[rows], hits.points_enu_m[rows]
        which, flat, path = hits.panes[rows], hits.normals_enu[rows], path_m[rows]
        heights = self.surfaces.heights_m(points, which, flat)
        depths = np.maximum(-heights, 0.0)
        cosines = np.abs(np.einsum("nk,nk->n", directions, normals))
        first, behind, through, dirt = self._glass.shares(which, cosines)
        diffuse = (1.0 - dirt) * through * rooms
        dusty = np.flatnonzero(dirt)
        before = points[dusty] + depths[dusty, None] * flat[dusty]
        arriving = self._matt.arriving(before, flat[dusty], hits.triangles[rows][dusty])
        diffuse[dusty] += dirt[dusty] * DUST_ALBEDO * arriving
        if bounces == 0:
            return diffuse, np.zeros_like(diffuse)
        out = mirrored(directions, normals)
        # Glass that stands before its flat pane may mirror past it; other light would fall into the facade.
        _keep_outside(out, np.where(heights[:, None] > 0.0, normals, flat))
        spread = beam_rad * (1.0 + 2.0 * path * self.surfaces.sharpest_per_m[which] / np.maximum(cosines, FLATTEST))
        rest = out, flat, depths, path, beam_rad, spread, bounces - 1
        seen = self._mirrored(points, *rest)
        shift = self._glass.second_image_shift(which, directions, flat)
        if shift is None:
            reflection = (first + behind) * seen
        else:
            reflection = first * seen + behind * self._mirrored(points + shift, *rest)
        return diffuse, (1.0 - dirt) * reflection

    def _mirrored(
        self,
        points: Array,
        directions: Array,
        flat: Array,
        depths_m: Array,
        path_m: Array,
        beam_rad: float,
        sun_beam_rad: Array,
        bounces: int,
    ) -> Array:
        """Light, shape (n, 3), that comes to panes from where their mirrored rays go.

        `depths_m`, shape (n,), is how far the points lie behind the flat panes; `sun_beam_rad`, shape (n,), how wide a
        pixel is after the mirror, which matters to what is as small and bright as the sun.
        """
        geometry, matt, far = self._around
        starts, ahead = self.geometry.leaving(points, directions, flat, depths_m)
        hits, normals = self.surfaces.meet(geometry.meet(starts, directions), directions)
        path = path_m + ahead + hits.distance_m
        light = np.zeros_like(directions)
        is_body, is_pane = hits.bodies >= 0, hits.panes >= 0
        light[is_body] = _of_bodies(matt, hits, is_body, directions, beam_rad * path)
        is_sky = ~(is_body | is_pane)
        light[is_sky] = far.light_from(directions[is_sky])
        if self._shines:
            self._add_sun(light, np.flatnonzero(is_sky), starts, directions, flat, sun_beam_rad)
        if is_pane.any():
            rooms = self._scene.panes.rooms[hits.panes[is_pane]]
            light[is_pane] = sum(self._of_panes(hits, is_pane, directions, normals, rooms, path, beam_rad, bounces))
        return light

    def _add_sun(
        self, light: Array, rows: Index, starts: Array, directions: Array, flat: Array, beam_rad: Array
    ) -> None:
        """Add the sun to mirrored light, shape (n, 3), that comes from the sky, in place."""
        sun = self._sun.light_from(directions[rows], beam_rad[rows])
        bright = np.flatnonzero(sun.any(axis=1))
        if not self._switches.near_field and len(bright):
            # What is near was left out of the way of these rays.
            at = rows[bright]
            towards = self._sun.direction_enu
            bright = bright[self.geometry.is_lit(starts[at], flat[at], towards)]
        light[rows[bright]] += sun[bright]


def layer_mask(scene: Scene, layer: Layer) -> NDArray[np.bool_]:
    """Which bodies are of a layer; at last for panes and sky, which are of the building; shape (bodies + 1,)."""
    return np.array([*(body.layer is layer for body in scene.bodies), layer is Layer.BUILDING])


def _of_bodies(matt: MattLight, hits: RayHits, rows: NDArray[np.bool_], directions_enu: Array, width_m: Array) -> Array:
    normals = hits.normals_enu[rows]
    cosines = np.abs(np.einsum("nk,nk->n", normals, directions_enu[rows]))
    return matt.light(hits.bodies[rows], hits.triangles[rows], hits.points_enu_m[rows], normals, cosines, width_m[rows])


@kernel
def _keep_outside(directions: Array, flat: Array) -> None:
    """Lift unit directions that point behind planes with normals `flat` to `LEAST_RISE` above them, in place."""
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
