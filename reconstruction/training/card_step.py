"""A step of the joint training on a graphics card: from splats in its memory to their gradients, losses included.

Photos go to the card, four bytes a pixel, with the light that panes mirror towards its pixels; what comes back are
sums: of losses, and the gradients of exposure, vignetting, the sky and the pose, and of mirrored light. While the card
draws, the processor finds out what is mirrored. The formulas are those of `SceneModel.forward` and `objective`; sums
are in whole numbers, so that the same step has the same bits in whatever order threads come to them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.optim import Optimizer

from reconstruction.base.out_of_memory import NotFinite
from reconstruction.gpu.device import Commands, Device, Piece, rounded_up, uniform
from reconstruction.gpu.shaders import Constant
from reconstruction.gpu.sorting import groups_of
from reconstruction.light.environment_map import LEVEL
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.light.radiance_grid_kernels import DENSITY_SCALE, OPAQUE
from reconstruction.light.ray_table import LEAST_COSINE
from reconstruction.light.ray_table import SHORTEST as SHORTEST_NORMAL
from reconstruction.light.shading import DARKEST
from reconstruction.metrics.image_metrics import C1, C2, WINDOW_PX, window_weights
from reconstruction.splats.card_splats import GLASS_FEATURES, AdamStep, CardSplats, DrawnSplats, fits_card
from reconstruction.splats.densification.strategy import BetweenChanges, Densification, Limits
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import CONSTANTS, Drawing, Window, int_of, quads
from reconstruction.splats.sky import SEEN
from reconstruction.training.config import LossWeights, Rates, TrainConfig
from reconstruction.training.losses import CLOSED, SHORTEST
from reconstruction.training.methods.shader import Shader
from reconstruction.training.model.joint_model import LEAST_REFLECTIVITY, MOST_LOST, SceneModel, panels_in_view
from reconstruction.training.photos.photo_stream import Sample
from reconstruction.training.photos.poses import moved_view

Floats = NDArray[np.float32]

SHOWN, FACADE = 1, 2
"""Bits beside a pixel's colour."""

NO_MIRROR = -1.0
"""In the place of the cosine of a pixel that mirrors nothing."""

BEYOND_M = 1e30
"""In the place of an infinite depth, which shaders have no word for."""

PIXELS_A_THREAD = 8
"""Of kernels that add up over all pixels."""

WORDS: dict[str, Constant] = {"IS_BAD": 0, "N_LARGE": 1, "N_KNOWN": 2, "N_MESH": 3}
SLOTS: dict[str, Constant] = {
    "ERRORS": 2, "LARGE": 3, "SIMILAR": 4, "OFF_NORMALS": 5, "OFF_MESH": 6, "OF_GAIN": 7, "OF_CORNER": 10,
    "OF_MOVE": 11, "SKY": 32,
}  # fmt: skip
"""Words of counts, and numbers of 64 bits behind them, of a picture's sums; the sky's are the last."""
FIXED_ONE = 2.0**32

RUN, TAPS = 4, 14
"""Sums over a window that a thread makes, and what goes into them."""

SIMILARITY: dict[str, Constant] = {
    **{f"W_{number}": float(weight) for number, weight in enumerate(window_weights()[: WINDOW_PX // 2 + 1])},
    "FOUR": tuple(range(RUN)),
    "TAPS": tuple(range(TAPS)),
    "C1": C1,
    "C2": C2,
}
PICTURE: dict[str, Constant] = {
    "TEXELS_A_ROW": CONSTANTS["TEXELS_A_ROW"],
    "BIN": CONSTANTS["BIN"],
    "PI": CONSTANTS["PI"],
    "DARKEST": DARKEST,
    "LEAST_LEVEL": LEVEL,
    "LEAST_REFLECTIVITY": LEAST_REFLECTIVITY,
    "SEEN": SEEN,
    "CLOSED": CLOSED,
    "BEYOND": BEYOND_M,
    "SHORTEST": SHORTEST,
}

GRID: dict[str, Constant] = {
    "BIN": CONSTANTS["BIN"],
    "TEXELS_A_ROW": CONSTANTS["TEXELS_A_ROW"],
    "LEAST_REFLECTIVITY": LEAST_REFLECTIVITY,
    "LEAST_COSINE": LEAST_COSINE,
    "SHORTEST_NORMAL": float(SHORTEST_NORMAL),
    "DENSITY_SCALE": float(DENSITY_SCALE),
    "OPAQUE": float(OPAQUE),
    "IS_BAD": 0,
}
LEARNED_OF_GRID = {"cells", "far"}
"""Of a radiance grid that kernels know of."""
CELLS_IN_A_WORD = 4
OF_CELL, OF_FAR, OF_PANE = 4, 3, 4
"""Gradients of a vertex, of a pixel of what is far away, and of a pane's tilts and bows."""


def fits_card_step(model: SceneModel, config: TrainConfig) -> bool:
    """Whether a card can make all of a step but mirrored light: of harmonics, and of panes whose planes are known."""
    return (
        fits_card(model.splats)
        and type(model.shader) is Shader
        and (model.light is None or model.geometry == "panels")
        and config.losses.normal_smoothness == 0.0
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Sums:
    """What a picture's kernels added up."""

    words: NDArray[np.uint32]
    numbers: NDArray[np.float64]

    @staticmethod
    def of(raw: NDArray[np.uint8]) -> _Sums:
        return _Sums(raw.view(np.uint32), raw.view("<i8").astype(np.float64) / FIXED_ONE)

    def count(self, name: str) -> int:
        return int(self.words[int_of(WORDS, name)])

    def some(self, name: str, n: int = 1) -> NDArray[np.float64]:
        start = int_of(SLOTS, name)
        return self.numbers[start : start + n]


@dataclass(frozen=True, slots=True, eq=False)
class CardGradients:
    """Of splats, in a card's memory: what a step of Adam is taken by, and the picture they are of.

    Parameters
    ----------
    n_pixels
        Of the picture; gradients are those of the loss times as many.
    looked_at
        SRGB values, shape (h, w, 3), and `Raster.surface_depths_m`, shape (h, w), of the picture; None where nobody
        asked.
    """

    drawn: DrawnSplats
    degree: int
    totals: list[Piece]
    weights: Piece
    n_pixels: int
    looked_at: tuple[Tensor, Tensor] | None = None


class CardStep:
    """Splats of a model in a card's memory, and steps of their training.

    Parameters
    ----------
    marches
        Whether the card marches mirrored rays through a radiance grid, too; None for where it is no program on the
        processor, which does that faster by itself.

    Raises
    ------
    DeviceFailed
        The card fails, or has too little memory.
    """

    def __init__(self, device: Device, model: SceneModel, optimiser: Optimizer, marches: bool | None = None) -> None:
        self._marches = not device.adapter.is_software if marches is None else marches
        self.device, self._model, self._optimiser = device, model, optimiser
        self.splats = CardSplats(device, model.splats, optimiser, model.light is not None)
        self._between: dict[int, BetweenChanges] = {}
        self._eyes: list[Tensor] = []
        self.n_since = 0

    def gradients(
        self,
        sample: Sample,
        gain: Tensor,
        move: Tensor | None,
        degree: int,
        settings: RasterSettings,
        weights: LossWeights,
        progress: float,
        generator: torch.Generator | None,
        more: Tensor | None = None,
        *,
        is_looked_at: bool = False,
    ) -> tuple[CardGradients, dict[str, float]]:
        """Of a photo: those of splats stay on the card, all others reach what `gain`, `move` and the model are of.

        Parameters
        ----------
        gain, move
            As for `SceneModel.forward`.
        weights, progress
            As for `objective`.
        more
            Added to the loss, with gradients of its own.
        is_looked_at
            Whether the picture is brought back, too.

        Raises
        ------
        NotFinite
            The loss or a gradient is no number.
        DeviceFailed
            The card fails, or has too little memory.
        """
        model, view = self._model, sample.view if move is None else moved_view(sample.view, move)
        splats, n_pixels = self.splats, sample.view.width_px * sample.view.height_px
        with self.device.errors_said():
            drawn = splats.drawing(view, settings, degree)
            drawing, features = drawn.drawing, drawn.features
            commands, of_splats = self.device.commands(), self.device.buffer(4 * drawing.n)
            commands.clear(of_splats, 4 * drawing.n)
            blended = [
                drawing.blend(commands, window, features, splats.n_quads, of_splats) for window in drawing.windows
            ]
            commands.submit()
        light = self._light(view, generator)
        sky = model.sky.picture()
        with self.device.errors_said():
            picture = _CardPicture(
                self.device, drawing, splats, sample, light, sky, model, gain, weights, progress, is_looked_at
            )
            commands = self.device.commands()
            for window, channels in zip(drawing.windows, blended, strict=True):
                if light is not None:
                    light.march(commands, drawing, window, channels, picture.mirrored)
                picture.light(commands, window, channels)
            picture.compare(commands)
            totals = drawing.no_sums(commands, drawn.parts)
            for window, channels in zip(drawing.windows, blended, strict=True):
                wanted = picture.back(commands, window, channels)
                if light is not None:
                    light.march_back(commands, drawing, window, channels, picture.mirrored)
                drawing.blend_back(commands, window, features, splats.n_quads, wanted, drawn.parts, totals)
            for part, piece in zip(drawn.parts, totals, strict=True):
                drawing.project_back(commands, part, piece, in_place=True)
            splats.add_up(commands, drawn, degree, totals, picture.sums, WORDS | SLOTS, moves=move is not None)
            of_light = () if light is None else light.asked(picture)
            raw_sums, *read = commands.read(picture.read_sums, *of_light, *picture.read_look)
            sums = _Sums.of(raw_sums)
        terms = picture.terms(sums)
        if not np.isfinite(sum(terms.values())):
            raise NotFinite("the loss is not a number")
        of_mirrored = [] if light is None else light.gradients(read[0], n_pixels)
        if sums.count("IS_BAD") or of_mirrored is None:
            raise NotFinite("a gradient is not a number")
        _give_back(model, gain, move, of_mirrored, sky, more, sums, n_pixels)
        looked_at = picture.look(read[-1]) if is_looked_at else None
        return CardGradients(drawn, degree, totals, of_splats, n_pixels, looked_at), terms

    def _light(self, view: View, generator: torch.Generator | None) -> _MirroredLight | _MarchedLight | None:
        """What is mirrored in a view: to be marched on the card, or found out here."""
        model = self._model
        if model.light is None:
            return None
        if self._marches and _MarchedLight.fits(self.device, model):
            return _MarchedLight(self.device, model, view, generator)
        return _MirroredLight.of(model, view, generator)

    def learn(self, found: CardGradients, rates: Rates, strategy: Densification, limits: Limits, seed: int, *,
              observed: float, jitters: bool) -> None:  # fmt: skip
        """Take a step of Adam on all splats.

        Parameters
        ----------
        rates
            For what of splats goes only a share of a step; rates themselves are the optimiser's.
        observed
            What gradients of screen positions are divided by before they are added up for densification; 0: they are
            not.
        jitters
            Whether the strategy's noise is part of this step.
        """
        by_name = {group["name"]: group["lr"] for group in self._optimiser.param_groups}
        by_name["details"] = by_name["colours"] * rates.colour_details
        between = self._between.setdefault(id(strategy), strategy.between_changes(self._model.splats))
        view = found.drawn.drawing.view
        screen = 0.0
        if observed:
            screen = view.width_px * view.height_px / (observed * found.n_pixels)
            self._eyes.append(view.position_m)
        if not jitters:
            between = BetweenChanges(between.opacity_pull, between.size_pull)
        by = AdamStep(by_name, rates.glass_geometry, 1.0 / found.n_pixels, screen, limits, between, seed)
        with self.device.errors_said():
            self.splats.learn(found.drawn, found.degree, found.totals, found.weights, by)
        self.n_since += 1

    def bring(self, *, moments: bool) -> None:
        """Bring what was learned since to the model's splats, and Adam's moments to the optimiser."""
        self.splats.bring(self._model.splats, self._optimiser if moments else None)
        if moments:
            self.n_since = 0

    def observed_by(self, strategy: Densification) -> None:
        """Hand what was added up for densification to a strategy."""
        if self._eyes:
            strategy.take_in(self.splats.seen(torch.stack(self._eyes)))
            self._eyes.clear()
            self.splats.forget_seen()


Gradients = list[tuple[Tensor, Tensor]]
"""Of what has a history, each with what it is of."""


@dataclass(frozen=True, slots=True, eq=False)
class _MirroredLight:
    """Light that panes mirror towards some pixels of a picture, found out by the processor.

    Parameters
    ----------
    width_px
        Of the picture.
    rows, columns
        Of the n pixels.
    light, cosines
        Shapes (n, 3) and (n,), with their history.
    """

    width_px: int
    rows: Tensor
    columns: Tensor
    light: Tensor
    cosines: Tensor

    @staticmethod
    def of(model: SceneModel, view: View, generator: torch.Generator | None) -> _MirroredLight:
        """All pixels whose pane is known: which of them glass covers, the card alone knows yet."""
        panels = torch.from_numpy(panels_in_view(view, model.corners_m))
        rows, columns = torch.nonzero(panels >= 0, as_tuple=True)
        light, cosines = model.mirrored_by_planes(view, rows, columns, panels[rows, columns], generator)
        return _MirroredLight(view.width_px, rows, columns, light, cosines)

    def written(self, device: Device, view: View) -> Piece:
        """Light and cosine by pixel."""
        found = np.full((view.height_px, view.width_px, 4), NO_MIRROR, np.float32)
        rows, columns = self.rows.numpy(), self.columns.numpy()
        found[rows, columns, :3], found[rows, columns, 3] = self.light.detach(), self.cosines.detach()
        return _written(device, found)

    def march(self, commands: Commands, drawing: Drawing, window: Window, channels: Piece, mirrored: Piece) -> None:
        """Nothing: it has been written."""

    def march_back(
        self, commands: Commands, drawing: Drawing, window: Window, channels: Piece, mirrored: Piece
    ) -> None:
        """Nothing: the processor does."""

    def asked(self, picture: _CardPicture) -> list[tuple[Piece, int]]:
        """What is to be read of the card for `gradients`."""
        return [(picture.mirrored, 16 * picture.n)]

    def gradients(self, raw: NDArray[np.uint8], n_pixels: int) -> Gradients | None:
        """Of light and cosines; None where they are no numbers."""
        by_pixel = torch.from_numpy(raw.view(np.float32).reshape(-1, 4) / np.float32(n_pixels))
        found = by_pixel[self.rows * self.width_px + self.columns]
        return [(self.light, found[:, :3]), (self.cosines, found[:, 3])]


class _MarchedLight:
    """Light that panes mirror from a radiance grid, marched on the card, forward and back."""

    def __init__(self, device: Device, model: SceneModel, view: View, generator: torch.Generator | None) -> None:
        glass = model.light
        assert glass is not None
        assert isinstance(glass.light, RadianceGrid)
        self.device, self.grid, grid = device, glass.light, glass.light
        self.tilts, self.bows = glass.true_tilts(), glass.bows
        panels = panels_in_view(view, model.corners_m)
        self.n_panes, self.n_pixels, self.n_rays = len(model.corners_m), panels.size, glass.rays
        self.pane_numbers = _written(device, (panels + 1).astype(np.uint32))
        eye = -view.cam_from_world[:3, :3].numpy().T @ view.cam_from_world[:3, 3].numpy()
        self.panes = _table(device, _pane_texels(model, eye, self.tilts, self.bows))
        self.times = _table(device, np.stack([grid.times, grid.steps], axis=1))
        self.cells = _table(device, grid.cells.detach().reshape(-1, 4).numpy())
        self.far = _table(device, grid.far.detach().reshape(-1, 3).numpy())
        skips = np.zeros(CELLS_IN_A_WORD * rounded_up(grid.skips.size, CELLS_IN_A_WORD), np.uint8)
        skips[: grid.skips.size] = grid.skips.ravel()
        self.skips = _written(device, skips.view(np.uint32))
        self.kept = device.buffer(16 * self.n_pixels * glass.rays)
        self.n_bytes = 8 * _n_slots(grid, self.n_panes)
        self.sums = device.buffer(self.n_bytes)
        z, y, x, _ = grid.cells.shape
        middle, over, outer, cell = grid.numbers[:3], grid.numbers[3:6], grid.numbers[6], grid.numbers[7]
        half_m, heading = model.planes.half_side_m, grid.box.heading_rad
        seed = 0 if generator is None else (generator.initial_seed() & 0xFFFFFFFF) | 1
        self._uniform = uniform(
            *((eye + model.origin_enu_m - model.planes.middle_enu_m) / half_m).tolist(), 1.0 / half_m,
            *middle.tolist(), float(cell), *over.tolist(), float(outer),
            float(np.cos(heading)), float(np.sin(heading)), float(grid.unit), float(not grid.training),
            x, y, z, len(grid.far), math.isqrt(glass.rays), len(grid.times), seed, OF_CELL * x * y * z,
        )  # fmt: skip
        self._is_cleared = False

    @staticmethod
    def fits(device: Device, model: SceneModel) -> bool:
        """Whether a model's light is of a kind that kernels know, in buffers that the card has."""
        grid = None if model.light is None else model.light.light
        if not isinstance(grid, RadianceGrid) or {name for name, _ in grid.named_parameters()} != LEARNED_OF_GRID:
            return False
        return 8 * _n_slots(grid, len(model.corners_m)) <= device.most_bytes

    def written(self, device: Device, view: View) -> Piece:
        """Room for light and cosine by pixel."""
        return device.buffer(16 * self.n_pixels)

    def march(self, commands: Commands, drawing: Drawing, window: Window, channels: Piece, mirrored: Piece) -> None:
        """Write what the pixels of a window that mirror see, where `channels` say that they do."""
        self._run("march", commands, drawing, window, channels, mirrored)

    def march_back(
        self, commands: Commands, drawing: Drawing, window: Window, channels: Piece, mirrored: Piece
    ) -> None:
        """Add up gradients from those of a window's light and cosines."""
        if not self._is_cleared:
            commands.clear(self.sums, self.n_bytes)
            self._is_cleared = True
        self._run("march_back", commands, drawing, window, channels, mirrored, self.sums)

    def _run(
        self, name: str, commands: Commands, drawing: Drawing, window: Window, channels: Piece, *others: Piece
    ) -> None:
        mirrored, *sums = others
        commands.run(
            name, GRID | quads(GLASS_FEATURES) | {"N_RAYS": self.n_rays}, groups_of(n_pixels_of(window, drawing.view)),
            drawing.uniform(window.bins), self._uniform, self.panes, self.times, self.cells, self.far, self.skips,
            self.pane_numbers, channels, mirrored, self.kept, *sums,
        )  # fmt: skip

    def asked(self, picture: _CardPicture) -> list[tuple[Piece, int]]:
        """What is to be read of the card for `gradients`."""
        return [(self.sums, self.n_bytes)]

    def gradients(self, raw: NDArray[np.uint8], n_pixels: int) -> Gradients | None:
        """Of cells, of what is far away, and of tilts and bows; None where they are no numbers."""
        if raw.view(np.uint32)[0]:
            return None
        numbers = (raw.view("<i8")[1:] * (1.0 / (FIXED_ONE * n_pixels))).astype(np.float32)
        ends = np.cumsum([self.grid.cells.numel(), self.grid.far.numel()])
        of_cells, of_far, of_panes = (torch.from_numpy(part) for part in np.split(numbers, ends))
        by_pane = of_panes.reshape(-1, 2, 2)
        found = [
            (self.grid.cells, of_cells.reshape(self.grid.cells.shape)),
            (self.grid.far, of_far.reshape(self.grid.far.shape)),
            (self.tilts, by_pane[:, 0]),
        ]
        return found if self.bows is None else [*found, (self.bows, by_pane[:, 1])]


def _n_slots(grid: RadianceGrid, n_panes: int) -> int:
    return 1 + grid.cells.numel() + grid.far.numel() + OF_PANE * n_panes


def _pane_texels(model: SceneModel, eye_m: NDArray[np.float64], tilts: Tensor, bows: Tensor | None) -> Floats:
    """Of each pane six texels, see radiance_grid.wgsl: differences to the camera are taken in float64."""
    assert model.light is not None
    corners, normals = model.corners_m, model.planes.normals_enu
    from_corner = eye_m - corners[:, 0]
    columns = [np.column_stack([normals, (from_corner * normals).sum(axis=1)])]
    for number in (1, 3):
        edge = corners[:, number] - corners[:, 0]
        over = edge / np.maximum((edge * edge).sum(axis=1, keepdims=True), 1e-20)
        columns.append(np.column_stack([over, (from_corner * over).sum(axis=1)]))
    leans, edges = tilts.detach().numpy(), model.light.edges.numpy()
    columns += [np.column_stack([edges[:, k], leans[:, k]]) for k in range(2)]
    own = np.zeros((len(corners), 2)) if bows is None else bows.detach().numpy()
    columns.append(np.pad(own, ((0, 0), (0, 2))))
    return np.stack(columns, axis=1).reshape(-1, 4).astype(np.float32)


class _CardPicture:
    """A picture's pixels on a card, from blended channels to losses and back."""

    def __init__(
        self,
        device: Device,
        drawing: Drawing,
        splats: CardSplats,
        sample: Sample,
        light: _MirroredLight | _MarchedLight | None,
        sky: Tensor,
        model: SceneModel,
        gain: Tensor,
        weights: LossWeights,
        progress: float,
        is_looked_at: bool,
    ) -> None:
        self.device, self.drawing, self.view = device, drawing, drawing.view
        self.n_quads, self.n_sky = splats.n_quads, sky.numel()
        view, with_glass = self.view, light is not None
        self.n = n = view.width_px * view.height_px
        self.weights, self.stage = weights, weights.stage(progress) if with_glass else None
        self.by_depth = weights.normal_consistency if progress >= weights.consistent_from else 0.0
        has_mesh = with_glass and weights.normal_prior > 0.0 and sample.normals is not None
        self.by_mesh = weights.normal_prior if has_mesh else 0.0
        self.constants = PICTURE | WORDS | SLOTS | quads(self.n_quads) | {"GLASS": int(with_glass)}
        self.constants |= {"MESH": int(has_mesh), "DEPTH": int(self.by_depth > 0.0), "LOOKED_AT": int(is_looked_at)}
        self._look = (device.buffer(16 * n),) if is_looked_at else ()
        self.truth = _written(device, packed_photo(sample))
        self.mirrored = device.buffer(16 * n) if light is None else light.written(device, view)
        self.reference = self.truth
        if has_mesh:
            assert sample.normals is not None
            self.reference = _written(device, np.pad(sample.normals.numpy(), ((0, 0), (0, 0), (0, 1))))
        self.sky = _table(device, sky.detach().reshape(-1, 3).numpy())
        self.found, self.bodies = device.table(n), device.table(n)
        self.of_found, self.of_bodies = device.buffer(16 * n), device.buffer(16 * n)
        self.n_sum_bytes = 8 * (int_of(SLOTS, "SKY") + self.n_sky)
        self.sums = device.buffer(self.n_sum_bytes)
        has_window = weights.dssim > 0.0 and min(view.width_px, view.height_px) >= WINDOW_PX
        self.dssim = weights.dssim if has_window else 0.0
        large = self.stage is not None and self.stage.weight > 0.0
        self._uniform = uniform(
            *gain.detach().expand(3).tolist(), float(model.corner_loss.detach()),
            model.corner_square, MOST_LOST, min(weights.white, 1.0), self.stage.threshold if self.stage else 0.0,
            (1.0 - self.dssim) / 3.0, self.stage.weight * n if self.stage else 0.0, 0.0, 0.0,
            view.width_px, view.height_px, sky.shape[0], int(large),
        )  # fmt: skip

    def _groups(self, n: int) -> int:
        return groups_of(-(-n // PIXELS_A_THREAD))

    def light(self, commands: Commands, window: Window, channels: Piece) -> None:
        """Light a window's pixels, and compare them with the photo."""
        if window is self.drawing.windows[0]:
            commands.clear(self.sums, self.n_sum_bytes)
        n_groups = self._groups(n_pixels_of(window, self.view))
        commands.run(
            "light_pixels", self.constants, n_groups, self.drawing.uniform(window.bins), self._uniform, self.sky,
            channels, window.states, self.truth, self.mirrored, self.found, self.bodies, self.sums, *self._look,
        )  # fmt: skip

    def compare(self, commands: Commands) -> None:
        """Losses that more than one pixel has a part in, with their gradients."""
        n, view = self.n, self.drawing.uniform()
        if self.dssim:
            similarity(
                commands, self.device, self.view.width_px, self.view.height_px, self.found, self.truth, self.of_found,
                self.sums, -self.dssim * n,
            )  # fmt: skip
        else:
            commands.clear(self.of_found, 16 * n)
        if not self.by_depth and not self.by_mesh:
            commands.clear(self.of_bodies, 16 * n)
            return
        commands.run(
            "compare_normals", self.constants, self._groups(n), view, self.found, self.bodies, self.truth,
            self.reference, self.sums,
        )  # fmt: skip
        commands.run(
            "normals_back", self.constants, groups_of(n), view, uniform(self.by_depth * n, self.by_mesh * n),
            self.found, self.bodies, self.truth, self.reference, self.sums, self.of_found, self.of_bodies,
        )  # fmt: skip

    def back(self, commands: Commands, window: Window, channels: Piece) -> Piece:
        """Gradients of a window's channels, alphas and depths, as `Drawing.blend_back` takes them."""
        n_pixels = n_pixels_of(window, self.view)
        wanted = self.device.table((self.n_quads + 1) * n_pixels)
        commands.run(
            "pixels_back", self.constants, self._groups(n_pixels), self.drawing.uniform(window.bins), self._uniform,
            self.sky, wanted, channels, self.truth, self.mirrored, self.found, self.of_found, self.of_bodies,
            self.sums,
        )  # fmt: skip
        return wanted

    @property
    def read_sums(self) -> tuple[Piece, int]:
        """What is to be read of the card for `_Sums`."""
        return self.sums, self.n_sum_bytes

    @property
    def read_look(self) -> list[tuple[Piece, int]]:
        """What is to be read of the card for `look`."""
        return [(piece, 16 * self.n) for piece in self._look]

    def look(self, raw: NDArray[np.uint8]) -> tuple[Tensor, Tensor]:
        """The picture's sRGB values, shape (h, w, 3), and depths of surfaces, shape (h, w)."""
        values = torch.from_numpy(raw.view(np.float32).reshape(self.view.height_px, self.view.width_px, 4))
        depths = values[..., 3]
        return values[..., :3], torch.where(depths < BEYOND_M, depths, torch.inf)

    def terms(self, sums: _Sums) -> dict[str, float]:
        """What each weighted term adds to the loss, as `objective` has it."""
        (errors,), (large,), (similar,) = (sums.some(name) for name in ("ERRORS", "LARGE", "SIMILAR"))
        colour = (1.0 - self.dssim) * errors / (3 * self.n)
        if self.dssim:
            colour += self.dssim * (1.0 - similar / n_values(self.view.width_px, self.view.height_px))
        found = {"colour": float(colour)}
        if self.by_depth:
            found["normal consistency"] = (
                self.by_depth * float(sums.some("OFF_NORMALS")[0]) / max(sums.count("N_KNOWN"), 1)
            )
        if self.by_mesh:
            found["normal prior"] = self.by_mesh * float(sums.some("OFF_MESH")[0]) / max(sums.count("N_MESH"), 1)
        if self.stage is not None and self.stage.weight > 0.0:
            found["high frequency"] = self.stage.weight * float(large) / (sums.count("N_LARGE") + 1e-6)
        return found


def n_pixels_of(window: Window, view: View) -> int:
    """Pixels of a picture that a window covers."""
    rows, columns = window.bins.pixels(view)
    return int((rows.stop - rows.start) * (columns.stop - columns.start))


def n_values(width: int, height: int) -> int:
    """Windows of D-SSIM in a picture of three colours, times these."""
    return int(3 * (width - WINDOW_PX + 1) * (height - WINDOW_PX + 1))


def similarity(
    commands: Commands, device: Device, width: int, height: int, found: Piece, truth: Piece, of_found: Piece,
    sums: Piece, factor: float,
) -> None:  # fmt: skip
    """Structural similarity of a picture to a photo, added up, and the gradient of its mean times `factor`.

    Parameters
    ----------
    found
        A table, a texel a pixel; sRGB values.
    truth
        A photo as `packed_photo` has it.
    of_found
        Written, four numbers a pixel, the fourth 0.
    sums
        Added to at the slot SIMILAR.
    """
    inner, rows = width - WINDOW_PX + 1, height - WINDOW_PX + 1
    sizes = uniform(width, height, inner, rows)
    constants = SIMILARITY | WORDS | SLOTS | {"TEXELS_A_ROW": CONSTANTS["TEXELS_A_ROW"]}
    moments, derivatives = device.table(5 * height * inner), device.table(3 * rows * inner)
    spread = device.table(3 * height * inner)
    in_row, in_column = groups_of(height * -(-inner // RUN)), groups_of(inner * -(-height // RUN))
    commands.run("similarity_rows", constants, in_row, sizes, found, truth, moments)
    commands.run("similarity", constants, in_column, sizes, moments, derivatives, sums)
    commands.run("similarity_columns", constants, in_column, sizes, derivatives, spread)
    commands.run(
        "similarity_back", constants, groups_of(height * -(-width // RUN)),
        sizes + uniform(factor / n_values(width, height)), spread, found, truth, of_found,
    )  # fmt: skip


def packed_photo(sample: Sample) -> NDArray[np.uint32]:
    """Red, green, blue, and what is known of a pixel, in four bytes, shape (h, w)."""
    shown = torch.ones_like(sample.facade) if sample.shown is None else sample.shown
    flags = SHOWN * shown.to(torch.uint8) + FACADE * (sample.facade & shown).to(torch.uint8)
    packed = torch.cat([sample.display, flags[..., None]], dim=2).contiguous().numpy()
    return packed.view("<u4")[..., 0]


def _written(device: Device, values: NDArray[np.float32] | NDArray[np.uint32]) -> Piece:
    piece = device.buffer(values.nbytes)
    device.write(piece, values)
    return piece


def _table(device: Device, values: Floats) -> Piece:
    """A table of rows of up to four numbers."""
    piece = device.table(len(values))
    device.write_table(piece, np.pad(values, ((0, 0), (0, 4 - values.shape[1]))))
    return piece


def _give_back(
    model: SceneModel,
    gain: Tensor,
    move: Tensor | None,
    of_mirrored: Gradients,
    sky: Tensor,
    more: Tensor | None,
    sums: _Sums,
    n_pixels: int,
) -> None:
    """Hand gradients on to what is not on the card."""
    of_gain = torch.from_numpy(sums.some("OF_GAIN", 3) / n_pixels).to(gain)
    of_sky = torch.from_numpy(sums.some("SKY", sky.numel()) / n_pixels).to(sky).reshape(sky.shape)
    of_corner = torch.tensor(float(sums.some("OF_CORNER")[0]) / n_pixels)
    pairs = [
        (gain, of_gain.sum().reshape(gain.shape) if gain.numel() == 1 else of_gain),
        (sky, of_sky),
        (model.corner_loss, of_corner),
    ]
    if move is not None:
        pairs.append((move, torch.from_numpy(sums.some("OF_MOVE", 6) / n_pixels).to(move)))
    pairs += of_mirrored
    if more is not None:
        pairs.append((more, torch.ones_like(more)))
    pairs = [(value, gradient) for value, gradient in pairs if value.requires_grad]
    torch.autograd.backward([value for value, _ in pairs], [gradient for _, gradient in pairs])
