"""A few thousand rays of a flight's photos, from which effects tell how large they would be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.light.geometry import Geometry, RayHits
from reconstruction.scenes.light.pane_surfaces import PaneSurfaces, mirrored
from reconstruction.scenes.light.shading import SkyLight, facade_middle_enu_m
from reconstruction.scenes.light.tracing import Switches, Tracer, layer_mask
from reconstruction.scenes.photos.camera_model import USUAL_CAMERA_MODEL, CameraModel, Moment
from reconstruction.scenes.photos.lens_effects import DARKEST, MIDDLE_GREY, grey_levels
from reconstruction.scenes.record import Layer, Scene

Array = NDArray[np.float64]

N_PHOTOS = 12
RAYS_ALONG = 36
"""Photos asked, spread over the flight, and rays along the longer side of each."""

QUANTILE = 0.95
"""Displacements are as large as this share of the rays on glass does not exceed."""


@dataclass(frozen=True, slots=True, eq=False)
class Mirrored:
    """What n rays see in panes, as if these were flat.

    Parameters
    ----------
    focal_px
        Of their photos, shape (n,).
    directions_enu
        Of the rays, unit, shape (n, 3).
    hits, after
        Meetings of the rays with panes, and of the mirrored rays with what comes then.
    sight_m, path_m
        Lengths from camera to pane and from there on, inf to the sky, each shape (n,).
    cosines
        Of the angle of incidence, shape (n,).
    tilts_rad
        Angles by which the panes are tilted, shape (n,).
    parallax_rad
        Angle between where a thing is mirrored and where a picture taken from the facade's middle shows it, shape (n,);
        0 for the sky and for the building itself.
    is_around
        Whether something is mirrored that is neither, shape (n,).
    """

    focal_px: Array
    directions_enu: Array
    hits: RayHits
    after: RayHits
    sight_m: Array
    path_m: Array
    cosines: Array
    tilts_rad: Array
    parallax_rad: Array
    is_around: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.sight_m)

    @property
    def is_sky(self) -> NDArray[np.bool_]:
        """Shape (n,)."""
        return ~np.isfinite(self.path_m)


@dataclass(frozen=True, slots=True)
class SurroundingsLight:
    """What light from around changes.

    Parameters
    ----------
    change_grey
        In the pictures, root mean square.
    share
        Of an open sky's light that reaches the places seen, on average.
    n_places
        That light was gathered for.
    """

    change_grey: float
    share: float
    n_places: int


class Probe:
    """Rays spread over the photos of a flight.

    Parameters
    ----------
    moments
        Of each photo; without any, all are taken hovering.
    """

    def __init__(
        self,
        scene: Scene,
        photos: Sequence[PosedPhoto],
        camera_model: CameraModel = USUAL_CAMERA_MODEL,
        moments: Sequence[Moment] = (),
    ) -> None:
        self.scene, self.photos = scene, tuple(photos)
        self.camera_model, self.moments = camera_model, tuple(moments) or (Moment(),) * len(self.photos)
        self.geometry = Geometry(scene)
        chosen = np.unique(np.linspace(0, len(photos) - 1, min(N_PHOTOS, len(photos))).round().astype(int))
        rays = [spread(photos[k]) for k in chosen]
        self._origins, self._directions = (np.concatenate([r[i] for r in rays]) for i in (0, 1))
        self._focal_px = np.concatenate([np.full(len(r[0]), r[2]) for r in rays])
        axes = [np.broadcast_to(photos[k].pose.cam_from_enu[2], r[1].shape) for k, r in zip(chosen, rays, strict=True)]
        self._along_axis = np.einsum("nk,nk->n", np.concatenate(axes), self._directions)
        self.hits = self.geometry.meet(self._origins, self._directions)
        """What the rays met first."""
        self.mirrored = self._follow()
        light = self._light(Switches())
        self.exposure = MIDDLE_GREY / max(float(light.mean()), DARKEST)
        """Factor that brings the pictures to middle grey."""
        self.lights = tuple(np.split(light, np.cumsum([len(r[0]) for r in rays])[:-1]))
        """Of each photo's rays, shape (n, 3)."""
        self._grey = grey_levels(self.exposure * light)

    @property
    def n_pixels(self) -> int:
        """Of all photos of the flight."""
        return sum(p.intrinsics.width_px * p.intrinsics.height_px for p in self.photos)

    @property
    def glass_share(self) -> float:
        """Of the pictures' area."""
        return len(self.mirrored) / max(len(self._origins), 1)

    @property
    def depths_m(self) -> Array:
        """Of what the rays met first, along the optical axis, inf for the sky, shape (n,)."""
        return np.asarray(self.hits.distance_m * self._along_axis)

    @property
    def focal_px(self) -> Array:
        """Of the photos that the rays belong to, shape (n,)."""
        return np.asarray(self._focal_px)

    @property
    def is_pane(self) -> NDArray[np.bool_]:
        """Whether the rays met panes, shape (n,)."""
        return np.asarray(self.hits.panes >= 0)

    def change_without(self, switches: Switches) -> float:
        """Root mean square, in grey levels, of what switching off changes in the pictures; without the sun's disc."""
        change = grey_levels(self.exposure * self._light(switches)) - self._grey
        return float(np.sqrt((change**2).mean()))

    def surroundings_light(self) -> SurroundingsLight:
        """Light from around as it reaches places, against that of open sky and even ground."""
        tracer = Tracer(self.scene, Switches(sun_glare=False), self.geometry)
        change = grey_levels(self.exposure * self._traced(tracer)) - self._grey
        seen = self.hits.at(self.hits.bodies >= 0)
        assert tracer.ambient is not None
        reaches = tracer.ambient.on(seen.points_enu_m, seen.normals_enu, seen.triangles).sum()
        is_open = SkyLight(self.scene.sky).on(seen.normals_enu).sum()
        share = float(reaches / is_open) if is_open > 0.0 else 1.0
        return SurroundingsLight(float(np.sqrt((change**2).mean())), share, tracer.ambient.n_places)

    def displacement_px(self, angles_rad: Array) -> float:
        """Of mirror images that move by angles, shape (number of mirrored rays,); 0 where no glass is seen."""
        return float(np.quantile(self.mirrored.focal_px * angles_rad, QUANTILE)) if len(angles_rad) else 0.0

    def hidden_share(self) -> float:
        """Of the rays to the facade, those that something near stands before."""
        is_near, is_facade = (layer_mask(self.scene, layer) for layer in (Layer.NEAR, Layer.BUILDING))
        behind = self.geometry.beyond(self.hits, self._directions, is_near, is_facade)
        n_hidden = (behind.triangles != self.hits.triangles).sum()
        n_facade = (is_facade[behind.bodies] & (behind.triangles >= 0)).sum()
        return float(n_hidden / max(n_facade, 1))

    def bent_rad(self) -> Array:
        """Angles between what bowed panes mirror and where flat ones would show it, for all rays that meet panes."""
        seen, frames = self.mirrored, self.geometry.pane_frames
        surfaces = PaneSurfaces(self.scene.panes, frames, tilt=False)
        hits, normals = surfaces.meet(seen.hits, seen.directions_enu)
        flat, which = hits.normals_enu, hits.panes
        out = mirrored(seen.directions_enu, normals)
        depths = np.maximum(-surfaces.heights_m(hits.points_enu_m, which, flat), 0.0)
        starts, _ = self.geometry.leaving(hits.points_enu_m, out, flat, depths)
        after = self.geometry.meet(starts, out)
        off_plane = np.einsum("nk,nk->n", after.points_enu_m - frames.middles_enu_m[which], flat)
        origins = seen.hits.points_enu_m - seen.sight_m[:, None] * seen.directions_enu
        image = after.points_enu_m - 2.0 * off_plane[:, None] * flat - origins
        image = np.where(np.isfinite(after.distance_m)[:, None], image, mirrored(out, flat))
        return _angles(seen.directions_enu, image)

    def _light(self, switches: Switches) -> Array:
        # Rays spread out miss the sun, or meet it as if it filled their part of the picture. What reaches a place from
        # around takes longer than all else here, and changes other effects little.
        alone = replace(switches, sun_glare=False, sky_occlusion=False)
        return self._traced(Tracer(self.scene, alone, self.geometry))

    def _traced(self, tracer: Tracer) -> Array:
        found = tracer.trace(self._origins, self._directions, 1.0 / float(self._focal_px.mean()))
        return found.diffuse + found.reflection

    def _follow(self) -> Mirrored:
        rows = self.hits.panes >= 0
        hits = self.hits.at(rows)
        directions, flat = self._directions[rows], hits.normals_enu
        out = mirrored(directions, flat)
        starts, ahead = self.geometry.leaving(hits.points_enu_m, out, flat)
        after = self.geometry.meet(starts, out)
        path = ahead + after.distance_m
        _, tilted = PaneSurfaces(self.scene.panes, self.geometry.pane_frames, bow=False).meet(hits, directions)
        # The last entry is that of body -1: sky or panes.
        around = np.array([*(body.layer is not Layer.BUILDING for body in self.scene.bodies), False])
        is_around = around[after.bodies]
        middle = facade_middle_enu_m(self.scene) if len(path) else np.zeros(3)
        parallax = np.where(is_around, _angles(out, after.points_enu_m - middle), 0.0)
        cosines = np.abs(np.einsum("nk,nk->n", directions, flat))
        tilts = _angles(tilted, flat)
        return Mirrored(
            self._focal_px[rows], directions, hits, after, hits.distance_m, path, cosines, tilts, parallax, is_around
        )


def _angles(a: Array, b: Array) -> Array:
    """Between vectors, shape (n, 3) each, by sine and cosine, which is exact for small angles."""
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("nk,nk->n", a, b)))


def spread(photo: PosedPhoto) -> tuple[Array, Array, float]:
    """Origins and directions, each shape (n, 3), of rays spread over a photo, and its focal length in pixels."""
    lens = photo.intrinsics
    step = max(lens.width_px, lens.height_px) / RAYS_ALONG
    x = (np.arange(max(1, round(lens.width_px / step))) + 0.5) * step
    y = (np.arange(max(1, round(lens.height_px / step))) + 0.5) * step
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    origins, directions = photo.rays(places)
    return origins, directions, math.sqrt(lens.fx_px * lens.fy_px)


# What effects have in common: how large is large enough, and what simulating costs.

TOLERANCE_PX = 0.5
"""Half a pixel: less than what neighbouring pixels blur into each other."""

TOLERANCE_GREY = 0.5
"""Half a grey level: what rounding to whole ones changes at most; 54 dB."""

RAYS_PER_PIXEL = 4.0
"""On average over a picture: one, and nine more where detail calls for them (a third of the bundled scenes' pixels)."""

SECONDS_PER_RAY, SECONDS_PER_SHADOW, SECONDS_PER_ANGLE = 7e-7, 2.5e-7, 5e-8
"""Of one core: for a ray cast and shaded, for one that asks for the sun or shades alone, and for arithmetic on one;
measured on `planar` and `court`, where 0.8 million rays with their mirror images take 1.2 s."""

NO_GLASS = say("no photo shows glass")


def cost_s(probe: Probe, share: float, seconds_per_ray: float) -> float:
    """Of something done for a share of all rays of the flight."""
    return probe.n_pixels * RAYS_PER_PIXEL * share * seconds_per_ray


def percent(mask: NDArray[np.bool_]) -> str:
    """Share of a mask that is set, as text."""
    return f"{100.0 * float(mask.mean()):.0f} %"
