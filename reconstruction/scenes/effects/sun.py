"""The sun seen, and mirrored in panes: found by geometry, since half a degree slips between rays at random."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.jit import kernel
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.probe import TOLERANCE_GREY, Probe
from reconstruction.scenes.light.pane_surfaces import half_sides_m
from reconstruction.scenes.light.tracing import RADIUS_RAD, Sun, Switches, Tracer
from reconstruction.scenes.parameters import SUN_GLARE
from reconstruction.scenes.photos.lens_effects import MIDDLE_GREY, bloomed, grey_levels

Array = NDArray[np.float64]
Index = NDArray[np.int64]

STEPS, STEP = 12, 1e-4
"""Of Newton's method on a bowed pane, and of its differences, in half sides; the equations are nearly linear."""

ALIKE = 0.05
"""Normals of facades that differ by less look the same way."""

RAYS_ALONG = 11
"""Of a square around each image of the sun."""

PICTURE_PX = 96
"""Width of the picture that the lens's scatter is worked out in."""

SECONDS_PER_BLOOM = 1.5e-7
"""Of one core, for a pixel of a picture that shows the sun."""


@dataclass(frozen=True, slots=True)
class SunGlare:
    """The sun's disc and its mirror images, with the light that the lens scatters around them."""

    tolerance: float = TOLERANCE_GREY
    name = SUN_GLARE
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Root mean square over all photos of the flight."""
        sun = Sun(probe.scene.sky)
        if not sun.is_up:
            return Assessment(0.0, say("there is no sun"), 0.0)
        finder = _Finder(probe, sun)
        found = [finder.images(photo) for photo in probe.photos]
        changes = [_mean_square(p, images, probe.exposure) for p, images in zip(probe.photos, found, strict=True)]
        n_direct, n_mirrored = (sum(any(i.is_mirrored == way for i in images) for images in found) for way in (0, 1))
        n = len(probe.photos)
        reason = say("{} of {} photos see the sun, {} its mirror image", n_direct, n, n_mirrored)
        if not n_direct and not n_mirrored:
            reason = say("no photo sees the sun or its mirror image")
        sizes = [photo.intrinsics.width_px * photo.intrinsics.height_px for photo in probe.photos]
        bright = sum(size for size, images in zip(sizes, found, strict=True) if images)
        size = math.sqrt(np.average(changes, weights=sizes))
        return Assessment(size, reason, bright * SECONDS_PER_BLOOM)


@dataclass(frozen=True, slots=True, eq=False)
class _Image:
    """Of the sun in a photo: where, the pixels it covers, and their light together, shape (3,)."""

    pixel: Array
    is_mirrored: bool
    n_pixels: float
    light: Array


class _Finder:
    def __init__(self, probe: Probe, sun: Sun) -> None:
        panes, frames = probe.scene.panes, probe.geometry.pane_frames
        self._middles = frames.middles_enu_m
        self._axes = np.stack([frames.rights, frames.ups, frames.normals])
        self._shapes = np.stack([half_sides_m(panes, frames), panes.tilts_rad, panes.bows_per_m])
        self._with = Tracer(probe.scene, Switches(sky_occlusion=False), probe.geometry)
        self._without = Tracer(probe.scene, Switches(sky_occlusion=False, sun_glare=False), probe.geometry)
        direction = sun.direction_enu
        self._suns = [(direction, RADIUS_RAD), *self._mirrored_once(probe, direction)]
        """The sun and, where glass sees glass, its mirror images in facades; with how far around each panes show it."""

    def _mirrored_once(self, probe: Probe, sun: Array) -> Iterator[tuple[Array, float]]:
        """Directions of the sun as it is mirrored by all panes that look the same way, and their spread."""
        if not (probe.mirrored.after.panes >= 0).any():
            return
        halves, tilts, bows = self._shapes
        normals = self._axes[2]
        real = normals + np.einsum("mj,jmk->mk", tilts, self._axes[:2])
        kinds, which = np.unique(np.round(normals / ALIKE).astype(int), axis=0, return_inverse=True)
        for kind in range(len(kinds)):
            alike = which.ravel() == kind
            normal = normals[alike].mean(axis=0)
            normal /= np.linalg.norm(normal)
            turned = np.linalg.norm(real[alike] - normal, axis=1) + np.linalg.norm((bows * halves)[alike], axis=1)
            if sun @ normal > -float(turned.max()):
                yield sun - 2.0 * (sun @ normal) * normal, RADIUS_RAD + 2.0 * float(turned.max())

    def images(self, photo: PosedPhoto) -> list[_Image]:
        """All that a photo shows."""
        origin, lens = photo.pose.position_enu_m, photo.intrinsics
        places = [(self._suns[0][0], RADIUS_RAD, -1)]
        for sun, radius in self._suns:
            panes, directions = _mirrored_suns(origin, sun, radius, self._middles, self._axes, self._shapes)
            places += [(direction, radius, int(pane)) for pane, direction in zip(panes, directions, strict=True)]
        images = []
        for direction, radius, pane in places:
            pixel = lens.pixels(photo.pose.points_cam(origin + direction[None]))[0]
            reach = 2.0 * radius * max(lens.fx_px, lens.fy_px)
            # Not where it is behind the camera, which has no pixel.
            if ((pixel >= -reach) & (pixel <= np.array([lens.width_px, lens.height_px]) + reach)).all():
                image = self._image(photo, pixel, radius, pane)
                if image is not None:
                    images.append(image)
        return images

    def _image(self, photo: PosedPhoto, pixel: Array, radius_rad: float, pane: int) -> _Image | None:
        """What rays around it that meet this pane, or no pane, see of the sun; None where something hides it."""
        lens = photo.intrinsics
        f = math.sqrt(lens.fx_px * lens.fy_px)
        half = 1.3 * radius_rad * f
        steps = (np.arange(RAYS_ALONG) + 0.5) / RAYS_ALONG * 2.0 - 1.0
        places = pixel + half * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        places = places[((places >= 0.0) & (places <= [lens.width_px, lens.height_px])).all(axis=1)]
        origins, directions = photo.rays(places)
        step_px = 2.0 * half / RAYS_ALONG
        # As wide as it takes for one of these rays to meet the disc wherever it is.
        lights = [tracer.trace(origins, directions, 0.75 * step_px / f) for tracer in (self._with, self._without)]
        light = np.subtract(*(found.diffuse + found.reflection for found in lights))
        # Neighbours have images of their own.
        light[lights[0].hits.panes != pane] = 0.0
        is_sun = light.any(axis=1)
        if not is_sun.any():
            return None
        n_pixels = min(step_px**2 * float(is_sun.sum()), math.pi * (RADIUS_RAD * f) ** 2)
        return _Image(pixel, pane >= 0, n_pixels, step_px**2 * light.sum(axis=0))


def _mean_square(photo: PosedPhoto, images: list[_Image], exposure: float) -> float:
    """Of the change in grey levels over a grey photo with images of the sun."""
    if not images:
        return 0.0
    lens = photo.intrinsics
    scale = min(1.0, PICTURE_PX / lens.width_px)
    size = np.maximum(np.round(np.array([lens.width_px, lens.height_px]) * scale).astype(int), 1)
    grey = float(grey_levels(np.array(MIDDLE_GREY)))
    light = np.full((size[1], size[0], 3), MIDDLE_GREY)
    covered = np.zeros(light.shape[:2], np.bool_)
    for image in images:
        column, row = np.clip((image.pixel * scale).astype(int), 0, size - 1)
        light[row, column] += exposure * image.light * scale**2
        covered[row, column] = True
    change = grey_levels(bloomed(light)) - grey
    # The disc's own pixels are counted one by one: those here are coarse.
    spread = float((change[~covered] ** 2).mean(axis=1).sum()) / scale**2
    n_pixels = lens.width_px * lens.height_px
    area = min(sum(image.n_pixels for image in images), float(n_pixels))
    return (spread + area * (255.0 - grey) ** 2) / n_pixels


@kernel
def _mirrored_suns(
    origin: Array, sun: Array, radius_rad: float, middles: Array, axes: Array, shapes: Array
) -> tuple[Index, Array]:
    """Panes that show something around a direction to an eye, shape (k,), and directions to there, shape (k, 3).

    `axes` are rights, ups and normals, shape (3, m, 3); `shapes` half sides, tilts and bows, shape (3, m, 2).
    """
    which, found, n = np.empty(len(middles), np.int64), np.empty((len(middles), 3)), 0
    across = np.empty((2, 3))
    helper = np.array([0.0, 0.0, 1.0]) if abs(sun[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    across[0] = np.cross(sun, helper)
    across[0] /= math.sqrt((across[0] ** 2).sum())
    across[1] = np.cross(sun, across[0])
    place, moved, wrong, other = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    slopes, way, normal = np.zeros((2, 2)), np.zeros(3), np.zeros(3)
    for pane in range(len(middles)):
        away = before = reach = turned = 0.0
        for k in range(3):
            away += (origin[k] - middles[pane, k]) ** 2
            before += (origin[k] - middles[pane, k]) * axes[2, pane, k]
        if before <= 0.0:
            continue
        for k in range(2):
            reach += shapes[0, pane, k] ** 2
            turned += abs(shapes[2, pane, k]) * shapes[0, pane, k]
        place[:] = 0.0
        towards = _miss(origin, sun, middles, axes, shapes, pane, across, place, wrong, way, normal)
        # Over the pane, what is seen turns by no more than this; most panes show the sun nowhere.
        turn = radius_rad + 2.0 * turned + math.sqrt(reach / away)
        if turn < 0.5 and (towards <= 0.0 or math.hypot(wrong[0], wrong[1]) > 1.5 * turn):
            continue
        for _ in range(STEPS):
            for k in range(2):
                moved[:] = place
                moved[k] += STEP
                _miss(origin, sun, middles, axes, shapes, pane, across, moved, other, way, normal)
                slopes[0, k], slopes[1, k] = (other[0] - wrong[0]) / STEP, (other[1] - wrong[1]) / STEP
            area = slopes[0, 0] * slopes[1, 1] - slopes[0, 1] * slopes[1, 0]
            if area == 0.0:
                break
            place[0] -= (slopes[1, 1] * wrong[0] - slopes[0, 1] * wrong[1]) / area
            place[1] -= (slopes[0, 0] * wrong[1] - slopes[1, 0] * wrong[0]) / area
            for k in range(2):
                place[k] = min(max(place[k], -1.0), 1.0)
            towards = _miss(origin, sun, middles, axes, shapes, pane, across, place, wrong, way, normal)
        # On the pane's edge a part of the disc may still be seen.
        if towards > 0.0 and math.hypot(wrong[0], wrong[1]) <= 1.2 * radius_rad:
            which[n], found[n] = pane, way
            n += 1
    return which[:n], found[:n]


@kernel
def _miss(
    origin: Array, sun: Array, middles: Array, axes: Array, shapes: Array, pane: int, across: Array, place: Array,
    wrong: Array, way: Array, normal: Array,
) -> float:  # fmt: skip
    """Cosine between the sun and what an eye sees at a place on a pane, in half sides; -1 from behind the glass.

    Put into `wrong`, shape (2,), is by how much it sees past the sun; into `way` the direction to there, and into
    `normal` the glass's.
    """
    length, height = 1.0, 0.0
    normal[:] = axes[2, pane]
    for axis in range(2):
        half, tilt, bow = shapes[0, pane, axis], shapes[1, pane, axis], shapes[2, pane, axis]
        at = place[axis] * half
        slope = tilt + bow * at
        height += 0.5 * bow * (half - at) * (half + at) - tilt * at
        length += slope * slope
        for k in range(3):
            normal[k] += slope * axes[axis, pane, k]
    square = falling = towards = 0.0
    for k in range(3):
        normal[k] /= math.sqrt(length)
        way[k] = middles[pane, k] + height * axes[2, pane, k] - origin[k]
        for axis in range(2):
            way[k] += place[axis] * shapes[0, pane, axis] * axes[axis, pane, k]
        square += way[k] * way[k]
    for k in range(3):
        way[k] /= math.sqrt(square)
        falling += way[k] * normal[k]
    wrong[:] = 0.0
    for k in range(3):
        out = way[k] - 2.0 * falling * normal[k]
        towards += out * sun[k]
        for axis in range(2):
            wrong[axis] += out * across[axis, k]
    return towards if falling < 0.0 else -1.0


EFFECTS = (SunGlare(),)
