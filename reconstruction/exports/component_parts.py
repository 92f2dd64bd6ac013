"""Gaussians of a component in blocks, and what every format of other programs asks of a scene."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.objects.gs_scene import GsComponent, GsGaussian, GsScene
from reconstruction.splats.ply import ODD

# Gaussians as other programs know them: ellipsoids with an opacity and a colour by direction.
#
# No other program mirrors light in panels. What a panel shows has to be baked into its Gaussians' colours before
# (`reconstruction.exports.mesh`), or their own diffuse colour is all that is seen.

Array = NDArray[np.float32]

THICKNESS_M = 1e-6
"""Third size of a disc where there must be one, as 2DGS recommends."""

NO_PANEL = -1


@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoids:
    """n of them.

    Parameters
    ----------
    means_m
        ENU less the scene's `origin_enu_m`, shape (n, 3).
    quats
        w, x, y, z: unit, w >= 0, shape (n, 4). The columns of the rotation are the axes that `scales_m` measures.
    scales_m
        Standard deviations, shape (n, 3); the third is `THICKNESS_M` of discs.
    opacities
        0 to 1, shape (n,).
    sh
        Coefficients of display colours (sRGB values less 0.5), shape (n, 16, 3): those of real harmonics with the phase
        (-1)^m, as 3DGS files have them. Colour = 0.5 + sum of coefficient times harmonic of the direction from the
        camera to the mean. Fewer than 16 of a lower degree.
    panels
        Number of the panel that each lies on, int32, shape (n,); -1 for none.
    """

    means_m: Array
    quats: Array
    scales_m: Array
    opacities: Array
    sh: Array
    panels: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.panels)

    def chosen(self, rows: NDArray[np.int64] | NDArray[np.bool_] | slice) -> Ellipsoids:
        """Some of them."""
        return Ellipsoids(
            self.means_m[rows],
            self.quats[rows],
            self.scales_m[rows],
            self.opacities[rows],
            self.sh[rows],
            self.panels[rows],
        )


def ellipsoids_of(component: GsComponent, degree: int = 3) -> Ellipsoids:
    """Those of a component, in the order of its rows, with the harmonics of a degree."""
    panels = np.full(len(component.gaussians), NO_PANEL, np.int32)
    for element in component.elements:
        panels[element.start : element.stop] = element.panel
    return _ellipsoids(component.gaussians, panels, (degree + 1) ** 2)


def ellipsoids_of_all(components: Iterable[GsComponent], degree: int = 3) -> Ellipsoids:
    """Those of components, one after the other, with the harmonics of a degree."""
    parts = [ellipsoids_of(component, degree) for component in components]
    return Ellipsoids(
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("means_m", "quats", "scales_m", "opacities", "sh", "panels")
        )
    )


def _ellipsoids(gaussians: GsGaussian, panels: NDArray[np.int32], n_harmonics: int) -> Ellipsoids:
    values = gaussians.values
    scales = np.exp(values["log_scales"])
    if scales.shape[1] == 2:
        scales = np.column_stack([scales, np.full(len(scales), THICKNESS_M, np.float32)])
    return Ellipsoids(
        values["means"],
        unit_quaternions(values["quats"]),
        scales.astype(np.float32, copy=False),
        _sigmoid(values["opacity_logits"]),
        values["sh"][:, :n_harmonics] * ODD[:n_harmonics, None],
        panels,
    )


def unit_quaternions(quats: Array) -> Array:
    """Unit, with w >= 0, shape (n, 4); those as good as zero turn nothing."""
    # Squares of float32 would overflow or vanish where the length itself is good.
    found = quats.astype(np.float64)
    length = np.linalg.norm(found, axis=1, keepdims=True)
    is_turned = length > 1e-6
    found = np.where(is_turned, found / np.where(is_turned, length, 1.0), (1.0, 0.0, 0.0, 0.0))
    return np.where(found[:, :1] < 0.0, -found, found).astype(np.float32)


def _sigmoid(logits: Array) -> Array:
    small = np.exp(-np.abs(logits))
    return np.asarray(np.where(logits >= 0.0, 1.0, small) / (1.0 + small), np.float32)


AT_ONCE = 65_536
"""Gaussians of a block: 16 MB with harmonics of degree 3."""

LARGEST_LOG = 20.0
"""Of a size in metres: e^20 is further than the moon."""

CUT_OFF = 3.0
"""Standard deviations to which other programs draw a Gaussian."""


def check_scene(scene: GsScene, path: Path) -> None:
    """See to it that no number that is none gets into a file.

    Parameters
    ----------
    path
        That is to be written, for messages.

    Raises
    ------
    InputError
        A Gaussian, a corner or the origin is not finite, or a size cannot be.
    """
    if not all(map(math.isfinite, scene.origin_enu_m)):
        raise InputError(
            say("the scene's origin is not finite: {}; organise the model again", scene.origin_enu_m, place=path)
        )
    for component in scene.components:
        for name, value in component.gaussians.values.items():
            for start in range(0, len(value), AT_ONCE):
                block = value[start : start + AT_ONCE]
                is_good = np.isfinite(block).all() and (name != "log_scales" or block.max() <= LARGEST_LOG)
                if not is_good:
                    raise InputError(
                        say(
                            "component '{}': {}: holds numbers that are not finite or cannot be; train again",
                            component.name,
                            name,
                            place=path,
                        )
                    )
        for element in component.elements:
            if not np.isfinite(element.corners_enu_m).all():
                raise InputError(
                    say("panel '{}': its corners are not finite; import the site again", element.name, place=path)
                )


def part_of(component: GsComponent, start: int, stop: int) -> GsComponent:
    """A component of the rows from `start` to before `stop` alone, with those elements that have some of them."""
    elements = tuple(
        replace(element, start=max(element.start, start) - start, stop=min(element.stop, stop) - start)
        for element in component.elements
        if element.start < stop and element.stop > start
    )
    gaussians = component.gaussians.part(start, stop)
    return GsComponent(component.global_id, component.name, component.kind, elements, gaussians)


def ellipsoid_blocks(component: GsComponent, at_once: int = AT_ONCE) -> Iterator[tuple[int, Ellipsoids]]:
    """Its Gaussians in the order of its rows, each block with the row that it begins at."""
    n = len(component.gaussians)
    for start in range(0, n, at_once):
        yield start, ellipsoids_of(part_of(component, start, min(start + at_once, n)))


def element_numbers(component: GsComponent, start: int, stop: int) -> NDArray[np.int64]:
    """Which of the component's elements each row is of, from 0, shape (stop - start,)."""
    stops = np.array([element.stop for element in component.elements], np.int64)
    return np.searchsorted(stops, np.arange(start, stop), side="right")


def extents_m(ellipsoids: Ellipsoids) -> NDArray[np.float64]:
    """Half the size of the boxes that Gaussians are drawn in, shape (n, 3): along the axes of the frame."""
    w, x, y, z = ellipsoids.quats.astype(np.float64).T
    rotations = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    lengths = np.linalg.norm(rotations * ellipsoids.scales_m.T.astype(np.float64), axis=1)
    return np.asarray(CUT_OFF * lengths.T)


def light_of(display: NDArray[np.float32]) -> NDArray[np.float32]:
    """Linear light of display colours, 0 to 1 (IEC 61966-2-1)."""
    high = ((np.maximum(display, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(display <= 0.04045, display / 12.92, high).astype(np.float32)
