"""The rasteriser for graphics cards of any maker: WGSL kernels by WebGPU, behind torch's autograd. float32.

Tensors stay in main memory; what a picture needs is written to the card, and what comes back is read from it. Splats
are projected and sorted by depth; pairs of splats and bins of the picture are listed in that order and sorted by bin,
which keeps it. Then groups of lanes blend patches of the bins, and go back the same way. Where a picture needs more
than a buffer or table of the card holds, it is drawn window by window; where there are more channels than lanes can
keep, some at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from planning.base.messages import say
from reconstruction.gpu.device import Commands, Device, DeviceFailed, Piece, open_device, rounded_up, uniform
from reconstruction.gpu.shaders import Constant
from reconstruction.gpu.sorting import groups_of, run_sums, sort
from reconstruction.splats.rasterising.gsplat_backend import heaviest_labels
from reconstruction.splats.rasterising.projection import LEAST_NORM, slope_limits
from reconstruction.splats.rasterising.raster_types import NO_DOT, SOLID, Raster, RasterSettings, steepest
from reconstruction.splats.rasterising.torch_reference import LEAST_AREA_PX2, LIMITS_WIDENED, MOST_CHANGE
from reconstruction.splats.rasterising.views import View

Floats = NDArray[np.float32]
Parts = list[tuple[int, int]]
"""Of splats: first number and count of each."""

MOST_QUADS = 5
"""Of channels that lanes keep at once: a row of sums has eight quads, three of which are of geometry."""
ROW_QUADS = 8
GRADIENT_QUADS_AT = 4
"""Of a row of sums, where gradients of parameters take the place of what they come from."""
GEOMETRY_QUADS = 6
PARAMETER_QUADS = 4
BIN_PX = 16
PATCH_COLUMNS, LANE_ROWS = 8, 4
"""Pixels of a patch in a row, and below each other in a lane."""

WINDOW_BYTES = 32
"""Of the struct View, behind what it says of the picture."""

KEY_BITS = 28
"""Of a depth's bits less those of the nearest: all from there to 2^32 times as far have one of their own."""
LEAST_THROUGH = 1e-30
"""That a pixel has left before it ends: further back float32 has no numbers."""

MOST_SUMS = 1 << 21
"""Rows of sums in a table, 128 bytes each: a picture that needs more is drawn in windows."""

CONSTANTS: dict[str, Constant] = {
    "TEXELS_A_ROW": 8192,
    "GEOMETRY_QUADS": GEOMETRY_QUADS,
    "NOT_DRAWN": (1 << KEY_BITS) - 1,
    "PI": math.pi,
    "WIDEST_PX": 1e30,
    "FAR_PX": 1e30,
    "NOTHING": -1.0,
    "LARGEST_OUTLINE_PX": 1e4,
    "ROUNDING": 1e-5,
    "SLACK_PX": 1e-3,
    "SLACK": 0.01,
    "GRADIENTS": GRADIENT_QUADS_AT,
    "LIMITS_WIDENED": LIMITS_WIDENED,
    "MOST_CHANGE": MOST_CHANGE,
    "EDGE_ON_JACOBIAN": 1e6,
    "LEAST_NORM": LEAST_NORM,
    "LEAST_FACING": 1e-15,
    "SMALLEST": 1e-30,
    "BIN": BIN_PX,
    "PATCH_COLUMNS": PATCH_COLUMNS,
    "PIXELS": tuple(range(LANE_ROWS)),
    "EIGHT": tuple(range(ROW_QUADS)),
    "FOUR": tuple(range(PARAMETER_QUADS)),
}


def constants_for(device: Device, settings: RasterSettings, solid: bool) -> dict[str, Constant]:
    """What all kernels of a picture are compiled with."""
    rows = device.group // PATCH_COLUMNS * LANE_ROWS
    across, down = BIN_PX // PATCH_COLUMNS, BIN_PX // rows
    return CONSTANTS | {
        "SOLID": int(solid),
        "ANTIALIASED": int(settings.antialiased),
        "DETERMINISTIC": int(settings.deterministic),
        "SUBGROUPS": int(device.has_subgroups),
        "GROUP": device.group,
        "STEPS": tuple(1 << bit for bit in range(device.group.bit_length() - 1)),
        "WIDE_STEPS": tuple(1 << bit for bit in range(3, device.group.bit_length() - 1)),
        "PATCH_ROWS": rows,
        "ACROSS": across,
        "DOWN": down,
        "PATCHES": across * down,
    }


@dataclass(frozen=True, slots=True)
class Bins:
    """A window of a picture's bins."""

    column: int
    row: int
    n_columns: int
    n_rows: int

    def halves(self) -> tuple[Bins, Bins]:
        """Both, above each other or, of a single row, side by side."""
        if self.n_rows > 1:
            upper = self.n_rows // 2
            return (
                Bins(self.column, self.row, self.n_columns, upper),
                Bins(self.column, self.row + upper, self.n_columns, self.n_rows - upper),
            )
        left = self.n_columns // 2
        return (
            Bins(self.column, self.row, left, 1),
            Bins(self.column + left, self.row, self.n_columns - left, 1),
        )

    @property
    def n(self) -> int:
        """Bins in all."""
        return self.n_columns * self.n_rows

    def pixels(self, view: View) -> tuple[slice, slice]:
        """Rows and columns of a picture that it covers."""
        top, left = BIN_PX * self.row, BIN_PX * self.column
        bottom, right = top + BIN_PX * self.n_rows, left + BIN_PX * self.n_columns
        return slice(top, min(bottom, view.height_px)), slice(left, min(right, view.width_px))


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """Lists of a window, and what its pixels came to.

    Parameters
    ----------
    numbers, starts
        Pairs, sorted by bin, and where each bin's begin.
    firsts
        Where each splat's patches begin, nearest splat first.
    n_patches
        In all.
    """

    bins: Bins
    pairs: Piece
    numbers: Piece
    starts: Piece
    firsts: Piece
    states: Piece
    n_patches: int


class Drawing:
    """One picture of splats on a card: its lists, from the way there to the way back.

    Parameters
    ----------
    parameters
        A table of `PARAMETER_QUADS` for each of the `n` splats, see project.wgsl.
    solid
        Whether they are ellipsoids.
    """

    def __init__(
        self, device: Device, view: View, settings: RasterSettings, parameters: Piece, n: int, solid: bool
    ) -> None:
        self.device, self.view, self.settings = device, view, settings
        self.n, self.parameters = n, parameters
        self.constants = constants_for(device, settings, solid)
        self._uniform = view_uniform(view, settings, self.n, solid)
        self.windows: list[Window] = []
        commands = device.commands()
        self.geometry = device.table(GEOMETRY_QUADS * self.n)
        keys, order = device.buffer(4 * self.n), device.buffer(4 * self.n)
        self.radii = device.buffer(4 * self.n)
        commands.run(
            "project", self.constants, groups_of(self.n), self.uniform(),
            self.parameters, self.geometry, keys, order, self.radii,
        )  # fmt: skip
        self.keys, self.order = sort(commands, device, keys, order, self.n, KEY_BITS)
        whole = Bins(0, 0, rounded_up(view.width_px, BIN_PX), rounded_up(view.height_px, BIN_PX))
        todo = [whole]
        while todo:
            bins = todo.pop()
            firsts, pairs = device.buffer(4 * (self.n + 1)), device.buffer(4 * (self.n + 1))
            commands.run(
                "count_bins", self.constants, groups_of(self.n), self.uniform(bins),
                self.geometry, self.order, self.keys, pairs, firsts,
            )  # fmt: skip
            run_sums(commands, device, pairs, self.n)
            run_sums(commands, device, firsts, self.n)
            totals = device.buffer(8)
            commands.run("ends", {}, 1, uniform(self.n, 0), pairs, firsts, totals)
            n_pairs, n_patches = commands.read((totals, 8))[0].view(np.uint32).tolist()
            if self._fits(bins, n_pairs, n_patches):
                self.windows.append(self._listed(commands, bins, pairs, firsts, n_pairs, n_patches))
            elif bins.n > 1:
                todo += reversed(bins.halves())
            else:
                raise DeviceFailed(
                    say(
                        "{} splats lie over one another in {} pixels, more than the graphics card holds; compute "
                        "on the processor instead",
                        n_pairs,
                        BIN_PX * BIN_PX,
                    )
                )
        commands.submit()

    def uniform(self, bins: Bins | None = None, part: tuple[int, int] = (0, 0)) -> bytes:
        """What kernels know of the picture, and of a window or a part of the splats."""
        window = (0, 0, 0, 0) if bins is None else (bins.column, bins.row, bins.n_columns, bins.n_rows)
        return self._uniform + uniform(*window, *part, 0, 0)

    def _fits(self, bins: Bins, n_pairs: int, n_patches: int) -> bool:
        rows, columns = bins.pixels(self.view)
        n_pixels = (rows.stop - rows.start) * (columns.stop - columns.start)
        most = self.device.most_bytes
        in_buffers = max(4 * n_pairs, 16 * ROW_QUADS * n_patches, 16 * MOST_QUADS * n_pixels) <= most
        return in_buffers and n_pairs <= self.device.most_texels and n_patches <= MOST_SUMS

    def _listed(
        self, commands: Commands, bins: Bins, first_pairs: Piece, firsts: Piece, n_pairs: int, n_patches: int
    ) -> Window:
        device = self.device
        pairs = device.table(n_pairs, "rgba32uint")
        of_bins, numbers = device.buffer(4 * n_pairs), device.buffer(4 * n_pairs)
        commands.run(
            "list_bins", self.constants, groups_of(self.n), self.uniform(bins),
            self.geometry, self.order, self.keys, first_pairs, firsts, pairs, of_bins, numbers,
        )  # fmt: skip
        of_bins, numbers = sort(commands, device, of_bins, numbers, n_pairs, (bins.n - 1).bit_length())
        starts = device.buffer(4 * (bins.n + 1))
        commands.run("find_bins", {}, groups_of(n_pairs + 1), uniform(n_pairs, bins.n), of_bins, starts)
        rows, columns = bins.pixels(self.view)
        n_pixels = (rows.stop - rows.start) * (columns.stop - columns.start)
        return Window(bins, pairs, numbers, starts, firsts, device.buffer(16 * n_pixels), n_patches)

    def blended(self, features: Floats) -> tuple[Floats, Floats, Floats]:
        """Pictures of channels, shape (n, c), of alpha and depth, and the splats' weights."""
        device, view = self.device, self.view
        shape = view.height_px, view.width_px
        picture = np.empty((*shape, features.shape[1]), np.float32)
        states = np.empty((*shape, 4), np.float32)
        totals = device.buffer(4 * self.n)
        commands = device.commands()
        commands.clear(totals, 4 * self.n)
        for first, table, n_quads in self._tables(features):
            for window in self.windows:
                rows, columns = window.bins.pixels(view)
                size = rows.stop - rows.start, columns.stop - columns.start
                n_bytes = 16 * size[0] * size[1]
                channels = self.blend(commands, window, table, n_quads, totals if first == 0 else None)
                found, state = commands.read((channels, n_quads * n_bytes), (window.states, n_bytes))
                part = found.view(np.float32).reshape(*size, 4 * n_quads)
                picture[rows, columns, first : first + 4 * n_quads] = part[..., : features.shape[1] - first]
                states[rows, columns] = state.view(np.float32).reshape(*size, 4)
        weights_of_splats = commands.read((totals, 4 * self.n))[0].view(np.float32)
        return picture, states, weights_of_splats

    def blend(self, commands: Commands, window: Window, table: Piece, n_quads: int, totals: Piece | None) -> Piece:
        """Channels of a window's pixels, `n_quads` each; splats' weights in it are added to `totals`, shape (n,)."""
        device, constants = self.device, self.constants | quads(n_quads)
        rows, columns = window.bins.pixels(self.view)
        n_pixels = (rows.stop - rows.start) * (columns.stop - columns.start)
        channels, weights = device.buffer(16 * n_quads * n_pixels), device.buffer(4 * window.n_patches)
        commands.clear(weights, 4 * window.n_patches)
        commands.run(
            "blend", constants, window.bins.n * int_of(constants, "PATCHES"), self.uniform(window.bins),
            self.geometry, table, window.pairs, window.numbers, window.starts, channels, window.states, weights,
        )  # fmt: skip
        if totals is not None:
            commands.run(
                "add_weights", constants, groups_of(self.n), self.uniform(),
                self.order, window.firsts, weights, totals,
            )  # fmt: skip
        return channels

    def radii_px(self) -> Floats:
        """Half the larger side of the box that each splat can touch; 0 where it is not drawn."""
        return self.device.read((self.radii, 4 * self.n))[0].view(np.float32)

    def _tables(self, features: Floats) -> Iterator[tuple[int, Piece, int]]:
        """Channels in parts: the first one's number, their table, and its quads for each splat."""
        for first in range(0, features.shape[1], 4 * MOST_QUADS):
            part = features[:, first : first + 4 * MOST_QUADS]
            n_quads = rounded_up(part.shape[1], 4)
            table = self.device.table(n_quads * self.n)
            self.device.write_table(table, _padded(part, 4 * n_quads).reshape(-1, 4))
            yield first, table, n_quads

    def gradients(
        self, features: Floats, of_picture: Floats, of_alphas: Floats, of_depths: Floats
    ) -> tuple[Floats, Floats]:
        """Of the parameters, shape (n, 16), and of the channels, shape (n, c), from those of the pictures."""
        device, view = self.device, self.view
        parts = parts_of(self.n, device.most_bytes // (16 * ROW_QUADS))
        found = np.zeros((self.n, 4 * PARAMETER_QUADS), np.float32)
        of_features = np.empty(features.shape, np.float32)
        # Geometry is moved by all channels, so their parts add up.
        for first, table, n_quads in self._tables(features):
            commands = device.commands()
            totals = self.no_sums(commands, parts)
            for window in self.windows:
                rows, columns = window.bins.pixels(view)
                wanted = np.zeros((rows.stop - rows.start, columns.stop - columns.start, 4 * n_quads + 4), np.float32)
                n_here = min(4 * n_quads, features.shape[1] - first)
                wanted[..., :n_here] = of_picture[rows, columns, first : first + n_here]
                if first == 0:
                    wanted[..., -4], wanted[..., -3] = of_alphas[rows, columns], of_depths[rows, columns]
                pixels = device.table(wanted.size // 4)
                device.write_table(pixels, wanted.reshape(-1, 4))
                self.blend_back(commands, window, table, n_quads, pixels, parts, totals)
            for (start, count), piece in zip(parts, totals, strict=True):
                of_part = self.project_back(commands, (start, count), piece)
                sums, own = commands.read((piece, 16 * ROW_QUADS * count), (of_part, 16 * PARAMETER_QUADS * count))
                rows_of = sums.view(np.float32).reshape(count, 4 * ROW_QUADS)
                of_features[start : start + count, first : first + 4 * n_quads] = rows_of[:, :n_here]
                found[start : start + count] += own.view(np.float32).reshape(count, 4 * PARAMETER_QUADS)
        return found, of_features

    def no_sums(self, commands: Commands, parts: Parts) -> list[Piece]:
        """Rows of `ROW_QUADS` for each splat, parts one after the other, filled with zeros."""
        totals = [self.device.buffer(16 * ROW_QUADS * count) for _, count in parts]
        for piece, (_, count) in zip(totals, parts, strict=True):
            commands.clear(piece, 16 * ROW_QUADS * count)
        return totals

    def project_back(
        self, commands: Commands, part: tuple[int, int], totals: Piece, *, in_place: bool = False
    ) -> Piece:
        """Gradients of a part's parameters, `PARAMETER_QUADS` each, from what was added up for them.

        Parameters
        ----------
        in_place
            They take the place of the last quads of the sums, and what comes back is `totals`: for `GRADIENT_QUADS_AT`
            quads of channels at most.
        """
        own = [] if in_place else [self.device.buffer(16 * PARAMETER_QUADS * part[1])]
        commands.run(
            "project_back", self.constants | {"IN_PLACE": int(in_place)}, groups_of(part[1]), self.uniform(part=part),
            self.parameters, self.radii, totals, *own,
        )  # fmt: skip
        return totals if in_place else own[0]

    def blend_back(
        self,
        commands: Commands,
        window: Window,
        table: Piece,
        n_quads: int,
        pixels: Piece,
        parts: Parts,
        totals: list[Piece],
    ) -> None:
        """Add to the totals of all parts what a window gives.

        Parameters
        ----------
        pixels
            A table of its pixels: gradients of their `n_quads` of channels, and one quad of alpha and depth.
        """
        constants = self.constants | quads(n_quads)
        shared = self.geometry, table, window.pairs, window.numbers, window.starts, window.states, pixels
        n_groups = window.bins.n * int_of(constants, "PATCHES")
        if self.settings.deterministic:
            rows = self.device.buffer(16 * ROW_QUADS * window.n_patches)
            sums = self.device.table(ROW_QUADS * window.n_patches)
            commands.run("blend_back", constants, n_groups, self.uniform(window.bins), *shared, rows)
            commands.copy_to_table(rows, sums, ROW_QUADS * window.n_patches)
        for part, piece in zip(parts, totals, strict=True):
            if self.settings.deterministic:
                commands.run(
                    "add_sums", constants, groups_of(self.n), self.uniform(part=part),
                    self.order, window.firsts, sums, piece,
                )  # fmt: skip
            else:
                commands.run("blend_back", constants, n_groups, self.uniform(window.bins, part), *shared, piece)
        if len(self.windows) > 1:
            # What is held until then would be held for all windows at once.
            commands.submit()


def parts_of(n: int, most: int) -> Parts:
    """First number and count of parts of at most `most` that make up `n`."""
    return [(start, min(most, n - start)) for start in range(0, n, most)]


def quads(n: int) -> dict[str, Constant]:
    """Constants of kernels for so many quads of channels."""
    return {"N_QUADS": n, "QUADS": tuple(range(n))}


def int_of(constants: dict[str, Constant], name: str) -> int:
    """A constant that is a whole number."""
    value = constants[name]
    if not isinstance(value, int):
        raise TypeError(f"{name}: expected a whole number, got {value}")
    return value


def _padded(values: Floats, width: int) -> Floats:
    """With columns of 0 behind the others."""
    if values.shape[1] == width:
        return np.ascontiguousarray(values)
    wide = np.zeros((len(values), width), np.float32)
    wide[:, : values.shape[1]] = values
    return wide


def view_uniform(view: View, settings: RasterSettings, n: int, solid: bool) -> bytes:
    """The struct View of view.wgsl, up to the window."""
    matrix = view.cam_from_world.numpy()
    rotation = matrix[:3, :3]
    place = -rotation.T @ matrix[:3, 3]
    near = place.astype(np.float32).astype(np.float64)
    rows = [number for row in rotation for number in (*row, 0.0)]
    left, right, top, bottom = slope_limits(view)
    focal_px, has_blur = min(view.fx_px, view.fy_px), solid or settings.antialiased
    low_pass2 = NO_DOT if solid else settings.over_low_pass2
    numbers = [
        *rows, *near, 0.0, *(place - near), 0.0,
        view.fx_px, view.fy_px, view.cx_px, view.cy_px,
        left, right, top, bottom,
        settings.near_m, settings.min_alpha, settings.max_alpha, max(settings.min_transmittance, LEAST_THROUGH),
        low_pass2, 0.0 if has_blur else settings.low_pass_px, settings.blur_px, settings.least_depth_change(focal_px),
        settings.reach, steepest(focal_px), settings.faintest, LEAST_AREA_PX2,
    ]  # fmt: skip
    return uniform(*(float(number) for number in numbers)) + uniform(view.width_px, view.height_px, n, 0)


class _Rasterise(torch.autograd.Function):
    """Means, quats, scales, opacities, features and offsets to features, alphas, depths, weights and radii."""

    @staticmethod
    def forward(
        ctx: Any, device: Device, view: View, settings: RasterSettings, holder: Any, *inputs: Tensor
    ) -> tuple[Tensor, ...]:
        ctx.set_materialize_grads(False)
        means, quats, scales, opacities, features, offsets = (np.ascontiguousarray(t.detach().numpy()) for t in inputs)
        n, solid = len(means), scales.shape[1] == SOLID
        shape = view.height_px, view.width_px
        if n == 0:
            out = [np.zeros((*shape, features.shape[1])), np.zeros(shape), np.zeros(shape), np.zeros(0), np.zeros(0)]
            found = [torch.from_numpy(each.astype(np.float32)) for each in out]
            ctx.kept = None
        else:
            with device.errors_said():
                parameters = _parameters(device, means, quats, scales, opacities, offsets)
                drawing = Drawing(device, view, settings, parameters, n, solid)
                picture, states, weights = drawing.blended(features)
                radii = drawing.radii_px()
            ctx.kept = drawing
            holder.append(drawing)
            pictures = picture, np.ascontiguousarray(states[..., 0]), np.ascontiguousarray(states[..., 1])
            found = [torch.from_numpy(each) for each in (*pictures, weights.copy(), radii.copy())]
        ctx.save_for_backward(*inputs)
        ctx.mark_non_differentiable(*found[3:])
        return tuple(found)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *wanted: Any) -> Any:
        inputs, drawing = ctx.saved_tensors, ctx.kept
        if drawing is None:
            return (None, None, None, None, *(torch.zeros_like(t) for t in inputs))
        features = np.ascontiguousarray(inputs[4].detach().numpy())
        shape = drawing.view.height_px, drawing.view.width_px
        of_picture = _gradient(wanted[0], (*shape, features.shape[1]))
        of_alphas, of_depths = (_gradient(each, shape) for each in wanted[1:3])
        with drawing.device.errors_said():
            found, of_features = drawing.gradients(features, of_picture, of_alphas, of_depths)
        n_scales = inputs[2].shape[1]
        parts = (
            found[:, 0:3], found[:, 4:8], found[:, 8 : 8 + n_scales], found[:, 3], of_features,
            found[: len(inputs[5]), 12:14],
        )  # fmt: skip
        return (None, None, None, None, *(torch.from_numpy(np.ascontiguousarray(each)) for each in parts))


def check_number(n: int, most: int) -> None:
    """Raise `DeviceFailed` where there are more splats than a card's buffers or tables hold."""
    if n > most:
        raise DeviceFailed(
            say("{} splats are more than the {} that graphics cards are given; compute on the processor instead",
                n, most)
        )  # fmt: skip


def _parameters(device: Device, means: Floats, quats: Floats, scales: Floats, opacities: Floats, offsets: Any) -> Piece:
    """Of splats, on the card."""
    n = len(means)
    check_number(n, device.most_texels // GEOMETRY_QUADS)
    values = np.zeros((n, 4 * PARAMETER_QUADS), np.float32)
    values[:, 0:3], values[:, 3], values[:, 4:8], values[:, 8 : 8 + scales.shape[1]] = means, opacities, quats, scales
    if len(offsets):
        values[:, 12:14] = offsets
    found = device.table(PARAMETER_QUADS * n)
    device.write_table(found, values.reshape(-1, 4))
    return found


class SplatsOnCard:
    """Splats that stay on a card from picture to picture, for looking at them: nothing is learned.

    Parameters
    ----------
    means, quats_wxyz, scales, opacities
        As `rasterise` takes them; one splat or more.
    """

    def __init__(self, device: Device, means: Tensor, quats_wxyz: Tensor, scales: Tensor, opacities: Tensor) -> None:
        given = means, quats_wxyz, scales, opacities
        a, b, c, d = (np.ascontiguousarray(each.detach().numpy()) for each in given)
        self.device, self.n, self._is_solid = device, len(means), scales.shape[1] == SOLID
        self.parameters = _parameters(device, a, b, c, d, ())

    def blended(
        self, view: View, settings: RasterSettings, table: Piece, n_quads: int
    ) -> Iterator[tuple[Bins, Piece, Piece]]:
        """Window by window of a picture what its pixels come to, each to be used before the next is asked for.

        Parameters
        ----------
        table
            Channels of the splats, so many quads of each.

        Returns
        -------
        Iterator
            Windows, their pixels' blended channels (quads, as the splats have them), and their states: alpha, sum of
            weighted depths, what shines through.
        """
        drawing = Drawing(self.device, view, settings, self.parameters, self.n, self._is_solid)
        for window in drawing.windows:
            commands = self.device.commands()
            channels = drawing.blend(commands, window, table, n_quads, None)
            commands.submit()
            yield window.bins, channels, window.states


def _gradient(wanted: Tensor | None, shape: tuple[int, ...]) -> Floats:
    if wanted is None:
        return np.zeros(shape, np.float32)
    return np.ascontiguousarray(wanted.detach().numpy())


def rasterise_wgpu(
    means: Tensor,
    quats_wxyz: Tensor,
    scales: Tensor,
    opacities: Tensor,
    features: Tensor,
    view: View,
    screen_offsets: Tensor | None,
    labels: Tensor | None,
    settings: RasterSettings,
    device: Device | None = None,
) -> Raster:
    """See `rasteriser.rasterise`; all float32 in main memory.

    Labels take one more pass for every 32 different ones.

    Parameters
    ----------
    device
        By default the first card there is.

    Raises
    ------
    ReconstructionError
        There is no card, it fails, or it has too little memory.
    """
    opened = device or open_device()
    offsets = means.new_zeros((0, 2)) if screen_offsets is None else screen_offsets
    drawings: list[Drawing] = []
    apply: Callable[..., tuple[Tensor, ...]] = _Rasterise.apply
    picture, alphas, depths, weights, radii = apply(
        opened, view, settings, drawings, means, quats_wxyz, scales, opacities, features, offsets
    )

    def again(values: Tensor) -> Tensor:
        with opened.errors_said():
            return torch.from_numpy(drawings[0].blended(np.ascontiguousarray(values.numpy()))[0])

    found = None
    if labels is not None:
        nothing = torch.full(alphas.shape, -1, dtype=torch.int32)
        found = heaviest_labels(again, labels) if drawings else nothing
    return Raster(picture, alphas, depths, found, weights, radii)
