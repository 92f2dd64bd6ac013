"""Panes as mirrors for shaders: what these need to render the model's Eq. 19, besides splats and panes.

That is the radiance grid, environment map or network as half floats, how panes lean and are bowed, and what splats on
panes are made of: their own colour c, R and F0. The window's pictures by a graphics card and web pages share it. A
browser without WebGPU leaves all of it aside and shows colours with mirrored light baked in.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.radiance_grid import DENSITY_SCALE, FAR_TIMES, OPAQUE, RadianceGrid, edged
from reconstruction.light.reflection_mlp import ReflectionMlp
from reconstruction.splats.ply import ODD
from reconstruction.training.model.joint_model import SceneModel

Array = NDArray[np.float32]

LARGEST_HALF = 65_504.0


@dataclass(frozen=True, slots=True, eq=False)
class PaneMirrors:
    """What panes mirror, and what splats on them are made of.

    Parameters
    ----------
    numbers
        As `Light` in `mirrored.wgsl` has them; metres in the model's frame, all else rescaled.
    rays
        Through each pixel, along each side of it.
    tilts, bows
        Of the model's panels, radians, shape (m, 2).
    cells
        Density and square roots of light, shape (nz, ny, nx, 4), float16; empty beside light of another kind.
    skips
        Cells that a ray may leap, shape (nz - 1, ny - 1, nx - 1), uint8.
    far
        Square roots of light by direction with a rim of one pixel, shape (side + 2, side + 2, 4), float16; or an
        environment map's pictures, shapes (h, 2 h, 4), finer ones first, whose sum is logits of light.
    network
        None but for a network.
    sh, reflectivity, f0
        Of all splats, in the model's order: coefficients as `Ellipsoids` has them, shape (n, 16, 3), R, shape (n,), and
        F0, shape (n, 3).
    """

    numbers: dict[str, float | list[float]]
    rays: int
    tilts: Array
    bows: Array
    cells: NDArray[np.float16]
    skips: NDArray[np.uint8]
    far: tuple[NDArray[np.float16], ...]
    network: PackedNetwork | None
    sh: Array
    reflectivity: Array
    f0: Array

    def described(self, panels: Sequence[int]) -> dict[str, Any]:
        """For the page, as JSON has it; `panels` are the model's numbers of the page's panes."""
        return {
            "numbers": self.numbers,
            "rays": self.rays,
            "counts": list(self.cells.shape[2::-1]),
            "far": list(self.far[0].shape[1::-1]),
            "far_levels": len(self.far),
            "network": None if self.network is None else self.network.described(),
            "tilts": _told(self.tilts[list(panels)]),
            "bows": _told(self.bows[list(panels)]),
        }

    def light_numbers(self) -> NDArray[np.float32]:
        """`Light` of `mirrored.wgsl`."""
        numbers = np.concatenate([np.atleast_1d(self.numbers[name]) for name in OF_UNIFORM])
        return np.pad(numbers.astype(np.float32), (0, -len(numbers) % 4))

    def pane_numbers(self, corners_m: NDArray[np.float64]) -> Array:
        """The `Pane`s of `mirrored.wgsl`, shape (m, 4, 4); corners in the model's frame, shape (m, 4, 3)."""
        normals = np.cross(corners_m[:, 2] - corners_m[:, 0], corners_m[:, 3] - corners_m[:, 1])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        edges = [corners_m[:, i] - corners_m[:, 0] for i in (1, 3)]
        over = [edge / (edge**2).sum(axis=1, keepdims=True) for edge in edges]
        columns = zip((corners_m[:, 0], normals, *over), (*self.tilts.T, *self.bows.T), strict=True)
        return np.stack([np.column_stack(each) for each in columns], axis=1).astype(np.float32)

    def blocks(self) -> tuple[bytes, ...]:
        """`cells`, `skips`, `far`, and the network's words if there is one, compressed by zlib.

        Of half floats all first bytes come first, then all second ones: as neighbours are alike, that is half of it.
        """
        far = np.concatenate([picture.reshape(-1, 4) for picture in self.far])
        parts = [_in_planes(self.cells.reshape(-1, 4)), self.skips.tobytes(), _in_planes(far)]
        if self.network is not None:
            parts.append(self.network.words.astype("<u4").tobytes())
        return tuple(zlib.compress(part, COMPRESSION) for part in parts)


COMPRESSION = 6
"""Of zlib: 9 takes five times as long for 0.4 % of the bytes."""


def _in_planes(texels: NDArray[np.float16]) -> bytes:
    return texels.astype("<f2").view(np.uint8).T.tobytes()


OF_PAGE = {"tilts", "bows", "moves"}
"""What is learned of panes and photos that the page has a use for, or that is for learning alone."""

OF_LIGHT: dict[type[torch.nn.Module], set[str]] = {
    RadianceGrid: {"cells", "far"},
    EnvironmentMap: {"levels", "mean"},
    ReflectionMlp: {"hidden", "last"},
}
"""Models of light that shaders compute, and what is learned of each: one that has more has light of another kind."""

KINDS = {RadianceGrid: 0.0, EnvironmentMap: 1.0, ReflectionMlp: 2.0}
"""As `mirrored.wgsl` has them."""

OF_UNIFORM = (
    *("middle", "half_side", "inner", "cell", "over", "outer", "turn", "reach", "unit", "far_side", "far_times"),
    *("density_scale", "opaque", "kind"),
)

MOST_UNITS = 1024
"""Features and units of a layer, whose values for four rays fill the 16 KiB of shared memory that all cards have."""

LANES = 256
"""Of a workgroup, each for two units: also what all cards have."""


@dataclass(frozen=True, slots=True, eq=False)
class PackedNetwork:
    """A Reflection MLP as `network.wgsl` reads it.

    Parameters
    ----------
    numbers
        `Network`: width, layers, orders of position and direction, which layer is given features again, and whether
        those of the position are, and those of the direction; quads of rays that are asked about together.
    words
        Pairs of weights, half floats, by layer and by what goes in; biases and the last layer, floats; shape (k,).
    """

    numbers: tuple[int, ...]
    words: NDArray[np.uint32]

    @property
    def rays_a_group(self) -> int:
        """Of a workgroup."""
        return 4 * self.numbers[-1]

    def described(self) -> dict[str, Any]:
        """For the page, as JSON has it."""
        return {"numbers": [*self.numbers], "n_words": len(self.words)}


def packed_network(network: ReflectionMlp) -> PackedNetwork | None:
    """None where it is too wide for the shared memory of graphics cards."""
    shape, width = network.shape, network.shape.width + network.shape.width % 2
    n_values = width + 6 * (shape.position_order + shape.direction_order)
    quads = min(LANES // (width // 2), MOST_UNITS // n_values)
    if quads == 0:
        return None
    words: list[NDArray[np.uint32]] = []
    for number, layer in enumerate(network.hidden):
        assert isinstance(layer, torch.nn.Linear)
        rows = layer.weight.detach().cpu().numpy().T
        if number:
            # A unit that stays 0 makes the width even.
            rows = np.insert(rows, [shape.width] * (width - shape.width), 0.0, axis=0)
        rows = np.pad(rows, ((0, 0), (0, width - shape.width))).clip(-LARGEST_HALF, LARGEST_HALF)
        biases = np.pad(layer.bias.detach().cpu().numpy(), (0, width - shape.width))
        words += [np.ascontiguousarray(rows, np.float16).view(np.uint32).ravel(), _words(biases)]
    last = np.pad(network.last.weight.detach().cpu().numpy(), ((0, 0), (0, width - shape.width)))
    words += [_words(last), _words(network.last.bias.detach().cpu().numpy())]
    orders = shape.position_order, shape.direction_order
    numbers = (width, shape.layers, *orders, shape.fusion_layer, int(shape.skip), int(shape.staged), quads)
    return PackedNetwork(numbers, np.concatenate(words))


def _words(values: NDArray[Any]) -> NDArray[np.uint32]:
    return np.ascontiguousarray(values, np.float32).view(np.uint32).ravel()


@torch.no_grad()
def mirrors_of(model: SceneModel) -> PaneMirrors | None:
    """Of a model whose panels' planes mirror a radiance grid, an environment map or a network; None of others."""
    if model.light is None or model.geometry != "panels":
        return None
    glass, found = model.light, model.light.light
    learned = {name.removeprefix("light.").split(".")[0] for name, _ in glass.named_parameters()}
    if learned - OF_PAGE != OF_LIGHT.get(type(found)):
        return None
    bows = np.zeros((len(model.corners_m), 2), np.float32) if glass.bows is None else glass.bows.cpu().numpy()
    numbers: dict[str, float | list[float]] = {
        "middle": (model.planes.middle_enu_m - model.origin_enu_m).tolist(),
        "half_side": model.planes.half_side_m,
        "far_times": FAR_TIMES,
        "density_scale": DENSITY_SCALE,
        "opaque": OPAQUE,
        "kind": KINDS[type(found)],
    }
    light: tuple[NDArray[np.float16], NDArray[np.uint8], tuple[NDArray[np.float16], ...]]
    network = packed_network(found) if isinstance(found, ReflectionMlp) else None
    if isinstance(found, RadianceGrid):
        numbers |= _grid_numbers(found)
        light = _halves(found.cells), found.skips, (_texels(edged(found.far)),)
    else:
        if isinstance(found, ReflectionMlp) and network is None:
            return None
        numbers |= NO_GRID
        pictures = _pictures(found) if isinstance(found, EnvironmentMap) else (np.zeros((1, 1, 4), np.float16),)
        light = np.zeros((2, 2, 2, 4), np.float16), np.zeros((1, 1, 1), np.uint8), pictures
    splats = model.splats
    return PaneMirrors(
        numbers,
        math.isqrt(glass.rays),
        glass.true_tilts().cpu().numpy(),
        bows,
        *light,
        network,
        splats.sh.cpu().numpy() * ODD[:, None],
        torch.sigmoid(splats.reflectivity_logits).cpu().numpy(),
        torch.sigmoid(splats.f0_logits).cpu().numpy(),
    )


NO_GRID: dict[str, float | list[float]] = {
    "inner": [0.0, 0.0, 0.0],
    "cell": 1.0,
    "over": [1.0, 1.0, 1.0],
    "outer": 1.0,
    "turn": [1.0, 0.0],
    "reach": 1.0,
    "unit": 1.0,
    "far_side": 1.0,
}


def _grid_numbers(grid: RadianceGrid) -> dict[str, float | list[float]]:
    x, y, z, over_x, over_y, over_z, outer, cell = grid.numbers.tolist()
    heading = grid.box.heading_rad
    return {
        "inner": [x, y, z],
        "cell": cell,
        "over": [over_x, over_y, over_z],
        "outer": outer,
        "turn": [math.cos(heading), math.sin(heading)],
        "reach": grid.box.reach,
        "unit": grid.unit,
        "far_side": len(grid.far),
    }


def _pictures(environment: EnvironmentMap) -> tuple[NDArray[np.float16], ...]:
    """The finest first; what light is on average is in the coarsest."""
    levels = [level.reshape(math.isqrt(len(level) // 2), -1, 3) for level in environment.levels]
    levels[0] = levels[0] + environment.mean
    return tuple(_texels(level) for level in reversed(levels))


def _texels(colours: torch.Tensor) -> NDArray[np.float16]:
    """Of four numbers, the last of which is nothing."""
    return _halves(torch.nn.functional.pad(colours, (0, 1)))


def _halves(values: torch.Tensor) -> NDArray[np.float16]:
    return values.clamp(-LARGEST_HALF, LARGEST_HALF).cpu().numpy().astype(np.float16)


def _told(values: Array) -> list[list[float]]:
    return [[round(float(value), 8) for value in row] for row in values]
