"""Gaussians of a scene in blocks, so that memory does not grow to twice the scene, and in an order that compresses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import Monitor
from reconstruction.exports.component_parts import Ellipsoids, ellipsoid_blocks
from reconstruction.light.harmonics import MAX_DEGREE, harmonics
from reconstruction.objects.gs_scene import GsScene
from reconstruction.splats.ply import ODD
from reconstruction.splats.rasterising.raster_types import FLAT, RasterSettings

# Gaussians in other axes than ours: every kind of file has its own idea of which way is up.
#
# Places and rotations turn by a rotation, and so does what is seen from where: colours by direction are harmonics,
# which
# a rotation mixes within each degree (Wigner's matrices).

Axes = Literal["enu", "y-up", "y-down"]
"""`enu`: x east, y north, z up, as everywhere here. `y-up`: x east, y up, z south (right, up, back), of SPZ, glTF and
OpenGL. `y-down`: x east, y down, z north (right, down, forward), of what training programs write: viewers of PLY and
SOG files turn them over."""

QUARTER_TURNS: dict[Axes, int] = {"enu": 0, "y-up": -1, "y-down": 1}
"""About the x axis, from ENU."""


def turned(ellipsoids: Ellipsoids, axes: Axes) -> Ellipsoids:
    """Gaussians in ENU, told in other axes."""
    return _turned(ellipsoids, QUARTER_TURNS[axes])


def rotation_about_x(quarters: int) -> NDArray[np.int64]:
    """Shape (3, 3)."""
    cos, sin = (1, 0, -1, 0)[quarters % 4], (0, 1, 0, -1)[quarters % 4]
    return np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def _turned(ellipsoids: Ellipsoids, quarters: int) -> Ellipsoids:
    if quarters == 0:
        return ellipsoids
    means = ellipsoids.means_m @ rotation_about_x(quarters).T.astype(np.float32)
    turns = harmonic_turns(quarters).astype(np.float32)
    return Ellipsoids(
        means,
        _turned_quaternions(ellipsoids.quats, quarters),
        ellipsoids.scales_m,
        ellipsoids.opacities,
        np.einsum("jk,nkc->njc", turns, ellipsoids.sh, optimize=True),
        ellipsoids.panels,
    )


def _turned_quaternions(quats: NDArray[np.float32], quarters: int) -> NDArray[np.float32]:
    """With w >= 0 again, as `Ellipsoids` has it."""
    cos, sin = math.cos(quarters * math.pi / 4.0), math.sin(quarters * math.pi / 4.0)
    w, x, y, z = quats.astype(np.float64).T
    found = np.stack([cos * w - sin * x, cos * x + sin * w, cos * y - sin * z, cos * z + sin * y], axis=1)
    return np.where(found[:, :1] < 0.0, -found, found).astype(np.float32)


@lru_cache(maxsize=4)
def harmonic_turns(quarters: int) -> NDArray[np.float64]:
    """What makes coefficients (16,) in ENU those in axes turned about x, shape (16, 16), orthogonal.

    Harmonics of a turned direction are a linear mix of those of the direction, each degree by itself; which, follows
    from more directions than there are harmonics, to 1e-14.
    """
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(64, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    before, after = _standard(directions), _standard(directions @ rotation_about_x(quarters).T)
    mixed: NDArray[np.float64] = np.zeros((16, 16))
    for degree in range(MAX_DEGREE + 1):
        own = slice(degree**2, (degree + 1) ** 2)
        mixed[own, own] = np.linalg.lstsq(before[:, own], after[:, own], rcond=None)[0].T
    mixed.flags.writeable = False
    return mixed


def _standard(directions: NDArray[Any]) -> NDArray[np.float64]:
    """Harmonics with the phase (-1)^m, shape (n, 16)."""
    return np.asarray(harmonics(torch.from_numpy(directions)).numpy() * ODD)


SMALLEST_M = 1e-30
"""A size of 0 has no logarithm."""

MORTON_BITS = 21

MOST_BLUR_PX = 10.0
"""Standard deviation; a tenth of it is usual."""


def blocks_of(scene: GsScene, axes: Axes, least_opacity: float, monitor: Monitor, stage: str) -> Iterator[Ellipsoids]:
    """Gaussians of all components that are here, those of an opacity of at least `least_opacity`, in other axes."""
    n, done = n_gaussians(scene), 0
    for component in scene.components:
        for start, found in ellipsoid_blocks(component):
            monitor.report(stage, done + start, n)
            is_seen = found.opacities >= least_opacity
            yield turned(found if is_seen.all() else found.chosen(is_seen), axes)
        done += len(component.gaussians)


def n_gaussians(scene: GsScene) -> int:
    """Of the components that are here."""
    return sum(len(component.gaussians) for component in scene.components)


def are_discs(scene: GsScene) -> bool:
    """Whether Gaussians have two sizes."""
    return all(component.gaussians.values["log_scales"].shape[1] == FLAT for component in scene.components)


def is_antialiased(scene: GsScene) -> bool:
    """Whether what is drawn larger than it is has to be as much more transparent, as when it was learned."""
    return raster_of(scene).antialiased


def raster_of(scene: GsScene) -> RasterSettings:
    """How splats are to be blurred: as when they were learned, and as usual where nothing or nonsense is said of it."""
    config, usual = scene.training.get("config"), RasterSettings()
    settings = config.get("raster") if isinstance(config, Mapping) else None
    if not isinstance(settings, Mapping) or settings.get("antialiased") is not True:
        return usual
    blur_px = settings.get("blur_px", usual.blur_px)
    is_sensible = isinstance(blur_px, float) and 0.0 < blur_px < MOST_BLUR_PX
    return replace(usual, antialiased=True, blur_px=blur_px if is_sensible else usual.blur_px)


def log_scales(ellipsoids: Ellipsoids) -> NDArray[np.float32]:
    """Natural logarithms of the sizes in metres, shape (n, 3)."""
    return np.log(np.maximum(ellipsoids.scales_m, np.float32(SMALLEST_M)))


def morton_order(means_m: NDArray[np.float32]) -> NDArray[np.int64]:
    """Rows of means, shape (n, 3), along a Z-shaped curve through space: neighbours in the file are alike."""
    low = means_m.min(axis=0).astype(np.float64)
    span = float((means_m.max(axis=0) - low).max())
    steps = (means_m - low) * (((1 << MORTON_BITS) - 1) / span if span > 0.0 else 0.0)
    codes = np.zeros(len(means_m), np.uint64)
    for axis in range(3):
        codes |= _spread(steps[:, axis].astype(np.uint64)) << np.uint64(axis)
    return np.argsort(codes, kind="stable")


def _spread(values: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Bits of 21-bit numbers, two zeros after each."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        values = (values | values << np.uint64(shift)) & np.uint64(mask)
    return values


def expect_some(n: int, path: Path) -> None:
    """Refuse to write a file that viewers take for a damaged one.

    Raises
    ------
    InputError
        There are no Gaussians.
    """
    if n == 0:
        raise InputError(
            say("not written: there is no Gaussian that could be seen; choose other components", place=path)
        )
