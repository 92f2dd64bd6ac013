"""Splats that stay in a graphics card's memory while they are learned: what is drawn of them, and steps of Adam.

What a step would bring over, 112 bytes of each splat to the card and 192 back, is what it would wait for. Here nothing
of a splat crosses but when somebody looks at the model, when it is saved, and when splats are added or taken away: 768
bytes each. The formulas are those of `Splats.features`, of the fused Adam of torch, and of `strategy.keep_within`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.optim import Optimizer

from reconstruction.gpu.device import Commands, Device, Piece, uniform
from reconstruction.gpu.shaders import Constant
from reconstruction.gpu.sorting import groups_of
from reconstruction.light.harmonics import n_harmonics
from reconstruction.splats.densification.strategy import BOX_SIGMAS, BetweenChanges, Limits, SplatStatistics
from reconstruction.splats.harmonic_colour import NEAREST_M
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import (
    CONSTANTS,
    PARAMETER_QUADS,
    Drawing,
    Parts,
    check_number,
    parts_of,
    quads,
)
from reconstruction.splats.splats import LEAST_SQUARE, SHAPES, Splats

Floats = NDArray[np.float32]

LEARNED_QUADS = 16
"""Of a splat, see learned.wgsl."""

PLACES: dict[str, slice] = {
    "means": slice(0, 3),
    "opacity_logits": slice(3, 4),
    "quats": slice(4, 8),
    "log_scales": slice(8, 11),
    "reflectivity_logits": slice(11, 12),
    "f0_logits": slice(12, 15),
    "sh": slice(16, 64),
}
"""Of what is learned, among the numbers of a splat."""
GLASS = 15
RATED = ("means", "quats", "scales", "opacities", "colours", "reflectivity", "f0")
"""Groups of the optimiser that splats are in."""

GLASS_FEATURES, OTHER_FEATURES = 3, 2
"""Quads of channels: (1 - R) c, R, R F0 and the normal; or c and the normal."""

LARGEST = 1e20
"""Sums of gradients beyond are no numbers, in effect."""

MOVE_SLOTS = 6
SPLATS_A_THREAD = 32
"""Of kernels that add up over all splats."""

HOUSE: dict[str, Constant] = {
    "PI": math.pi,
    "TEXELS_A_ROW": CONSTANTS["TEXELS_A_ROW"],
    "FOUR": CONSTANTS["FOUR"],
    "NEAREST_M": NEAREST_M,
    "LEAST_SQUARE": LEAST_SQUARE,
    "LEAST_NORM": CONSTANTS["LEAST_NORM"],
}


@dataclass(frozen=True, slots=True)
class AdamStep:
    """What a step of Adam goes by.

    Parameters
    ----------
    rates
        Of the groups of the optimiser, by name; `details`, of harmonics above the first, is one more.
    glass_share
        Of places and rotations of splats on panels, of a step.
    gradients
        Factor of all gradients.
    screen
        Factor of those of screen positions, which are added up for densification; 0: nothing is added up.
    limits
        Of sizes.
    between
        What the strategy does in each step.
    seed
        Of its noise.
    """

    rates: dict[str, float]
    glass_share: float
    gradients: float
    screen: float
    limits: Limits
    between: BetweenChanges
    seed: int


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    start: int
    count: int
    learned: Piece
    first_moments: Piece
    second_moments: Piece
    seen: Piece

    @property
    def range(self) -> tuple[int, int]:
        return self.start, self.count


class CardSplats:
    """Splats in a card's memory, with Adam's moments.

    Parameters
    ----------
    splats, optimiser
        That they begin as.
    with_glass
        Whether the light of glass is blended as (1 - R) c, R and R F0.

    Raises
    ------
    DeviceFailed
        The card fails, or has too little memory.
    """

    def __init__(self, device: Device, splats: Splats, optimiser: Optimizer, with_glass: bool) -> None:
        self.device, self.n, self.solid = device, len(splats), not splats.is_flat
        self.n_quads = GLASS_FEATURES if with_glass else OTHER_FEATURES
        self.constants: dict[str, Constant] = {**HOUSE, "SOLID": int(self.solid), "GLASS": int(with_glass)}
        group = optimiser.param_groups[0]
        self._betas, self._epsilon = group["betas"], group["eps"]
        self.n_steps = int(optimiser.state.get(splats.means, {}).get("step", 0))
        glass = (splats.panels >= 0).float().numpy()
        learned = _packed({name: getattr(splats, name).detach() for name in PLACES}, self.n)
        learned[:, GLASS] = glass
        states = {name: optimiser.state.get(getattr(splats, name), {}) for name in PLACES}
        moments = [
            _packed({name: state[key] for name, state in states.items() if key in state}, self.n)
            for key in ("exp_avg", "exp_avg_sq")
        ]
        self._parts: list[_Part] = []
        check_number(device, self.n)
        with device.errors_said():
            for start, count in parts_of(self.n, device.most_bytes // (16 * LEARNED_QUADS)):
                own, first, second = (self._laid_out(values[start : start + count]) for values in (learned, *moments))
                self._parts.append(_Part(start, count, own, first, second, device.buffer(16 * count)))
        self.forget_seen()

    @property
    def parts(self) -> Parts:
        """First number and count of each."""
        return [part.range for part in self._parts]

    def _laid_out(self, values: Floats) -> Piece:
        quad_by_quad = values.reshape(len(values), LEARNED_QUADS, 4).transpose(1, 0, 2)
        piece = self.device.buffer(values.nbytes)
        self.device.write(piece, np.ascontiguousarray(quad_by_quad))
        return piece

    def drawing(self, view: View, settings: RasterSettings, degree: int) -> tuple[Drawing, Piece]:
        """Lists of a picture, and the table of what is blended in it, `n_quads` for each splat."""
        device = self.device
        parameters, features = device.table(PARAMETER_QUADS * self.n), device.table(self.n_quads * self.n)
        commands = device.commands()
        for part in self._parts:
            commands.run(
                "splat_features", self.constants | quads(self.n_quads), groups_of(part.count),
                self._seen_from(view, degree, part), part.learned, parameters, features,
            )  # fmt: skip
        commands.submit()
        return Drawing(device, view, settings, parameters, self.n, self.solid), features

    def add_up(
        self, commands: Commands, view: View, degree: int, totals: list[Piece], gradients: list[Piece], sums: Piece,
        slots: dict[str, Constant], *, moves: bool,
    ) -> None:  # fmt: skip
        """Note gradients that are no numbers, and add up what moving the camera would change.

        Parameters
        ----------
        slots
            Of `sums`: IS_BAD, and OF_MOVE of six numbers.
        moves
            Whether the latter is asked for.
        """
        bits = int(np.float32(LARGEST).view(np.uint32))
        constants = self.constants | quads(self.n_quads) | slots | {"LARGEST_BITS": bits, "MOVES": int(moves)}
        for part, piece, of_part in zip(self._parts, totals, gradients, strict=True):
            commands.run(
                "splat_sums", constants, groups_of(-(-part.count // SPLATS_A_THREAD)),
                self._seen_from(view, degree, part), part.learned, piece, of_part, sums,
            )  # fmt: skip

    def learn(
        self, drawing: Drawing, degree: int, totals: list[Piece], gradients: list[Piece], weights: Piece, by: AdamStep
    ) -> None:
        """Take a step of Adam, keep sizes within limits, and add up what densification asks.

        Parameters
        ----------
        totals, gradients
            Of each part: sums over pixels by channel, and gradients of parameters, see `Drawing`.
        weights
            Of the splats in the picture, shape (n,).
        """
        self.n_steps += 1
        beta1, beta2 = self._betas
        over1, over2 = 1.0 / (1.0 - beta1**self.n_steps), 1.0 / math.sqrt(1.0 - beta2**self.n_steps)
        rate = {name: value * over1 for name, value in by.rates.items()}
        limits, between = by.limits, by.between
        numbers = uniform(
            *(rate[name] for name in ("means", "quats", "scales", "opacities")),
            *(rate[name] for name in ("colours", "details", "reflectivity", "f0")),
            1.0 - beta1, beta2, 1.0 - beta2, over2,
            self._epsilon, by.glass_share, by.gradients, by.screen,
            math.log(limits.smallest_m), math.log(limits.largest_m), math.log(limits.stretched), between.noise,
            between.opacity_pull / by.gradients, between.size_pull / by.gradients, BOX_SIGMAS, float(by.screen > 0.0),
        )  # fmt: skip
        gate: dict[str, Constant] = {
            "GATE_AT": between.gate_at, "GATE_SLOPE": between.gate_slope, "LEAST_GATE": between.least_gate
        }  # fmt: skip
        commands = self.device.commands()
        for part, piece, of_part in zip(self._parts, totals, gradients, strict=True):
            commands.run(
                "learn_splats", self.constants | gate, groups_of(part.count),
                self._seen_from(drawing.view, degree, part, by.seed)[: 8 * 4] + numbers,
                part.learned, part.first_moments, part.second_moments, piece, of_part, drawing.radii, weights,
                part.seen,
            )  # fmt: skip
        commands.submit()

    def try_step(self, view: View, settings: RasterSettings, pull: Floats, by: AdamStep) -> None:
        """A step whose picture has given gradients, to its end, for who wants to know what it takes.

        Parameters
        ----------
        pull
            Gradients by pixel: of `n_quads` quads of channels, and one of alpha and depth.
        """
        with self.device.errors_said():
            drawing, features = self.drawing(view, settings, 3)
            commands, weights = self.device.commands(), self.device.buffer(4 * self.n)
            commands.clear(weights, 4 * self.n)
            totals = drawing.no_sums(commands, self.parts)
            for window in drawing.windows:
                drawing.blend(commands, window, features, self.n_quads, weights)
                rows, columns = window.bins.pixels(view)
                part = np.ascontiguousarray(pull[rows, columns]).reshape(-1, 4)
                pixels = self.device.table(len(part))
                self.device.write_table(pixels, part)
                drawing.blend_back(commands, window, features, self.n_quads, pixels, self.parts, totals)
            gradients = [
                drawing.project_back(commands, part, piece) for part, piece in zip(self.parts, totals, strict=True)
            ]
            commands.submit()
            self.learn(drawing, 3, totals, gradients, weights, by)
            self.device.read((self._parts[0].seen, 16))

    def _seen_from(self, view: View, degree: int, part: _Part, seed: int = 0) -> bytes:
        """The struct Learning of learned.wgsl, whose rates are 0."""
        eye = view.position_m.tolist()
        whole = uniform(*eye, 0.0, part.start, part.count, n_harmonics(degree), seed & 0xFFFFFFFF)
        return whole + bytes(6 * 16)

    def bring(self, splats: Splats, optimiser: Optimizer | None = None) -> None:
        """Bring what was learned to main memory, and Adam's moments where there is an optimiser.

        Raises
        ------
        DeviceFailed
            The card fails.
        """
        names = ("learned",) if optimiser is None else ("learned", "first_moments", "second_moments")
        found = [np.empty((self.n, 4 * LEARNED_QUADS), np.float32) for _ in names]
        with self.device.errors_said():
            for part in self._parts:
                read = self.device.read(*((getattr(part, name), 256 * part.count) for name in names))
                for values, raw in zip(found, read, strict=True):
                    by_quad = raw.view(np.float32).reshape(LEARNED_QUADS, part.count, 4)
                    values[part.start : part.start + part.count] = by_quad.transpose(1, 0, 2).reshape(part.count, -1)
        for name, place in PLACES.items():
            parameter = getattr(splats, name)
            parts = [_unpacked(values[:, place], name, parameter) for values in found]
            parameter.data.copy_(parts[0])
            if optimiser is not None:
                state = optimiser.state[parameter]
                state["step"] = torch.tensor(float(self.n_steps))
                state["exp_avg"], state["exp_avg_sq"] = parts[1:]

    def forget_seen(self) -> None:
        """Begin to add up anew what densification asks."""
        commands = self.device.commands()
        for part in self._parts:
            commands.clear(part.seen, 16 * part.count)
        with self.device.errors_said():
            commands.submit()

    def seen(self, eyes_m: Tensor) -> SplatStatistics:
        """What was added up, of pictures from `eyes_m`, shape (k, 3)."""
        with self.device.errors_said():
            read = [self.device.read((part.seen, 16 * part.count))[0] for part in self._parts]
        columns = np.concatenate([np.zeros(0, np.float32), *(raw.view(np.float32) for raw in read)]).reshape(-1, 4)
        pulls, views, weights, sigmas_px = torch.from_numpy(columns).T.contiguous()
        return SplatStatistics(pulls, views, weights, sigmas_px, eyes_m)


def fits_card(splats: Splats) -> bool:
    """Whether they have nothing but what kernels know of."""
    return splats.names == tuple(SHAPES) and splats.means.device.type == "cpu"


def _packed(values: dict[str, Tensor], n: int) -> Floats:
    """Shape (n, 64); 0 where nothing is given."""
    found = np.zeros((n, 4 * LEARNED_QUADS), np.float32)
    for name, tensor in values.items():
        part = tensor.reshape(n, -1).numpy()
        start = PLACES[name].start
        found[:, start : start + part.shape[1]] = part
    return found


def _unpacked(columns: Floats, name: str, like: Tensor) -> Tensor:
    width = math.prod(like.shape[1:])
    return torch.from_numpy(np.ascontiguousarray(columns[:, :width])).reshape(like.shape)
