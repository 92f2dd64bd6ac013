"""PLY files for viewers: Gaussians in the columns, the order and the axes that other programs expect.

`reconstruction.splats.ply` writes models in our own axes and with what only we can render; these are for showing.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.exports.component_parts import Ellipsoids, check_scene
from reconstruction.exports.compression import LEAST_SEEN, Compressed
from reconstruction.exports.gaussian_blocks import (
    Axes,
    are_discs,
    blocks_of,
    expect_some,
    is_antialiased,
    log_scales,
    n_gaussians,
)
from reconstruction.objects.gs_scene import GsScene
from reconstruction.splats.ply import (
    MEAN_COLOUR,
    NORMAL,
    PANEL,
    PLACE,
    ROTATION,
    SIZES,
    Kind,
    render_mode,
    write_blocks,
)
from reconstruction.splats.rasterising.raster_types import FLAT

MOST_SHARE = 1.0 - 1e-7
"""Opacity of 1 has no logit."""

LEAST_SHARE = 1e-7


def write_ply(
    scene: GsScene,
    path: Path,
    kind: Kind = "3dgs",
    axes: Axes = "y-down",
    degree: int = 3,
    least_opacity: float = LEAST_SEEN,
    monitor: Monitor = QUIET,
) -> Compressed:
    """Write the components of a scene that are here, whole or not at all.

    Parameters
    ----------
    kind
        `2dgs` for viewers that know discs, `3dgs` for all others: there discs are as thin as makes no difference.
    degree
        Of colours by direction, 0 to 3.
    least_opacity
        Gaussians below are left out.

    Raises
    ------
    InputError
        There is nothing to see, numbers are not finite, or the file cannot be written; the scene has ellipsoids, and
        `kind` is `2dgs`.
    """
    if not 0 <= degree <= 3:
        raise ValueError(f"degree: expected 0 to 3, got {degree}")
    if kind == "2dgs" and not are_discs(scene):
        raise InputError(
            say("not written: the model has ellipsoids, which are no discs; write them as a usual PLY file", place=path)
        )
    check_scene(scene, path)
    n = 0
    for block in blocks_of(scene, "enu", least_opacity, monitor, say("counting Gaussians")):
        n += len(block)
    expect_some(n, path)
    row = _row_type(kind, degree)
    blocks = blocks_of(scene, axes, least_opacity, monitor, say("writing Gaussians"))
    write_blocks(path, n, row, _comments(scene, kind, axes), _tables(blocks, row, kind, degree))
    return Compressed(path, path.stat().st_size, n, n_gaussians(scene) - n, 0, 0.0)


def _row_type(kind: Kind, degree: int) -> np.dtype[Any]:
    sizes = SIZES[:FLAT] if kind == "2dgs" else SIZES
    names = (*PLACE, *NORMAL, *MEAN_COLOUR, *_rest(degree), "opacity", *sizes, *ROTATION)
    # Programs that skip columns without a look at their type take all to be float.
    return np.dtype([(name, "<f4") for name in (*names, PANEL)])


def _rest(degree: int) -> tuple[str, ...]:
    return tuple(f"f_rest_{i}" for i in range(3 * ((degree + 1) ** 2 - 1)))


def _tables(blocks: Iterator[Ellipsoids], row: np.dtype[Any], kind: Kind, degree: int) -> Iterator[NDArray[Any]]:
    sizes = SIZES[:FLAT] if kind == "2dgs" else SIZES
    for block in blocks:
        shares = np.clip(block.opacities.astype(np.float64), LEAST_SHARE, MOST_SHARE)
        rest = block.sh[:, 1 : (degree + 1) ** 2]
        # All of red, then of green, then of blue.
        by_colour = rest.transpose(0, 2, 1).reshape(len(block), 3 * rest.shape[1])
        columns = {
            PLACE: block.means_m,
            NORMAL: np.zeros((len(block), 3), np.float32),
            MEAN_COLOUR: block.sh[:, 0],
            _rest(degree): by_colour,
            sizes: log_scales(block),
            ROTATION: block.quats,
        }
        table = np.zeros(len(block), row)
        for names, values in columns.items():
            for number, name in enumerate(names):
                table[name] = values[:, number]
        table["opacity"] = np.log(shares / (1.0 - shares))
        table[PANEL] = block.panels
        yield table


def _comments(scene: GsScene, kind: Kind, axes: Axes) -> list[str]:
    mode = render_mode("2dgs" if kind == "2dgs" else "mip" if is_antialiased(scene) else "")
    lines = [*mode, f"site: {' '.join(scene.name.split())}", f"axes: {axes}"]
    lines += ["origin of the places in the site's east, north, up, metres: " + _numbers(scene.origin_enu_m)]
    if scene.origin is not None:
        origin = scene.origin
        place = (origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m)
        lines += ["site origin, WGS 84 lat lon ellipsoid height: " + _numbers(place)]
    return lines


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
