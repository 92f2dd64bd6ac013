"""A few thousand rays of a flight's photos, from which effects tell how large they would be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.cameras import PosedPhoto
from reconstruction.scenes.environment import facade_middle_enu_m
from reconstruction.scenes.geometry import Geometry, Meeting
from reconstruction.scenes.lens_effects import DARKEST, MIDDLE_GREY, grey_levels
from reconstruction.scenes.optics import mirrored
from reconstruction.scenes.record import Layer, Scene
from reconstruction.scenes.tracing import Switches, Tracer

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
    met, after
        Meetings of the rays with panes, and of the mirrored rays with what comes then.
    sight_m, path_m
        Lengths from camera to pane and from there on, inf to the sky, each shape (n,).
    cosines
        Of the angle of incidence, shape (n,).
    tilts_rad
        Angles between the panes' real and flat normals, shape (n,).
    parallax_rad
        Angle between where a thing is mirrored and where a picture taken from the facade's middle shows it, shape (n,);
        0 for the sky and for the building itself.
    is_around
        Whether something is mirrored that is neither, shape (n,).
    """

    focal_px: Array
    met: Meeting
    after: Meeting
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


class Probe:
    """Rays spread over the photos of a flight."""

    def __init__(self, scene: Scene, photos: Sequence[PosedPhoto]) -> None:
        self.scene, self.photos = scene, tuple(photos)
        self._geometry = Geometry(scene)
        chosen = np.unique(np.linspace(0, len(photos) - 1, min(N_PHOTOS, len(photos))).round().astype(int))
        rays = [_spread(photos[k]) for k in chosen]
        self._origins, self._directions = (np.concatenate([r[i] for r in rays]) for i in (0, 1))
        self._focal_px = np.concatenate([np.full(len(r[0]), r[2]) for r in rays])
        self.mirrored = self._follow()
        light = self._light(Switches())
        self._exposure = MIDDLE_GREY / max(float(light.mean()), DARKEST)
        self._grey = grey_levels(self._exposure * light)

    @property
    def n_pixels(self) -> int:
        """Of all photos of the flight."""
        return sum(p.intrinsics.width_px * p.intrinsics.height_px for p in self.photos)

    @property
    def glass_share(self) -> float:
        """Of the pictures' area."""
        return len(self.mirrored) / max(len(self._origins), 1)

    def change_without(self, switches: Switches) -> float:
        """Root mean square, in grey levels, of what switching off changes in the pictures."""
        change = grey_levels(self._exposure * self._light(switches)) - self._grey
        return float(np.sqrt((change**2).mean()))

    def displacement_px(self, angles_rad: Array) -> float:
        """Of mirror images that move by angles, shape (number of mirrored rays,); 0 where no glass is seen."""
        return float(np.quantile(self.mirrored.focal_px * angles_rad, QUANTILE)) if len(angles_rad) else 0.0

    def _light(self, switches: Switches) -> Array:
        found = Tracer(self.scene, switches, self._geometry).trace(
            self._origins, self._directions, 1.0 / float(self._focal_px.mean())
        )
        return found.diffuse + found.reflection

    def _follow(self) -> Mirrored:
        met = self._geometry.meet(self._origins, self._directions)
        rows = met.panes >= 0
        met = Meeting(*(getattr(met, name)[rows] for name in Meeting.__slots__))
        directions, flat = self._directions[rows], met.normals_enu
        out = mirrored(directions, flat)
        starts, ahead = self._geometry.leaving(met.points_enu_m, out, flat)
        after = self._geometry.meet(starts, out)
        path = ahead + after.distance_m
        tilted = Tracer(self.scene, Switches(), self._geometry).mirror_normals(met, np.ones(len(path), np.bool_))
        # The last entry is that of body -1: sky or panes.
        around = np.array([*(body.layer is not Layer.BUILDING for body in self.scene.bodies), False])
        is_around = around[after.bodies]
        middle = facade_middle_enu_m(self.scene) if len(path) else np.zeros(3)
        parallax = np.where(is_around, _angles(out, after.points_enu_m - middle), 0.0)
        cosines = np.abs(np.einsum("nk,nk->n", directions, flat))
        return Mirrored(
            self._focal_px[rows], met, after, met.distance_m, path, cosines, _angles(tilted, flat), parallax, is_around
        )


def _angles(a: Array, b: Array) -> Array:
    """Between vectors, shape (n, 3) each, by sine and cosine, which is exact for small angles."""
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("nk,nk->n", a, b)))


def _spread(photo: PosedPhoto) -> tuple[Array, Array, float]:
    """Origins and directions, each shape (n, 3), of rays spread over a photo, and its focal length in pixels."""
    lens = photo.intrinsics
    step = max(lens.width_px, lens.height_px) / RAYS_ALONG
    x = (np.arange(max(1, round(lens.width_px / step))) + 0.5) * step
    y = (np.arange(max(1, round(lens.height_px / step))) + 0.5) * step
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    origins, directions = photo.rays(places)
    return origins, directions, math.sqrt(lens.fx_px * lens.fy_px)
