"""Splats that stay in a graphics card's memory while they are learned: what is drawn of them, and steps of Adam.

What a step would bring over, 112 bytes of each splat to the card and 192 back, is what it would wait for. Here nothing
of a splat crosses but when somebody looks at the model, when it is saved, and when splats are added or taken away: 768
bytes each. What only a picture needs is there for those splats that it can touch: they are found first, and listed one
behind the other. The formulas are those of `Splats.features`, of the fused Adam of torch, and of
`strategy.keep_within`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.optim import Optimizer

from reconstruction.gpu.device import Commands, Device, Piece, rounded_up, uniform
from reconstruction.gpu.shaders import Constant
from reconstruction.gpu.sorting import groups_of, run_sums
from reconstruction.light.harmonics import n_harmonics
from reconstruction.splats.densification.strategy import BOX_SIGMAS, BetweenChanges, Limits, SplatStatistics
from reconstruction.splats.harmonic_colour import NEAREST_M
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import (
    CONSTANTS,
    GEOMETRY_QUADS,
    GRADIENT_QUADS_AT,
    MOST_SUMS,
    PARAMETER_QUADS,
    ROW_QUADS,
    WINDOW_BYTES,
    Drawing,
    Parts,
    check_number,
    constants_for,
    parts_of,
    quads,
    view_uniform,
)
from reconstruction.splats.splats import LEAST_SQUARE, SHAPES, Splats

Floats = NDArray[np.float32]
Halves = NDArray[np.uint16]

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

MOST_OF_PART = 1 << 20
"""Splats whose memory is one piece: what goes there or comes back does so piece by piece."""

MOST_WHOLE = 1 << 20
"""Splats up to which Adam's moments are float32. Of more they have 16 bits, see moments.wgsl: 512 bytes are 256,
and models as good: 0.001 dB apart at most, of planar over three seeds and of pictures of splats."""

FIRST_SHIFT, SECOND_SHIFT = 14, 13
LEAST_BITS = 77 << 23
"""Bits of float32 that moments.wgsl leaves out, and those of its least number."""

BYTES_FOR_ALL = 192 << 20
"""Kernels, photos, light, and pieces of the pool that nobody takes."""

ROUNDED = 1.25
NUMBERS_A_SPLAT, NUMBERS_A_PAIR, QUADS_A_PIXEL = 10, 6, 24
"""Beside tables: radii, weights, keys and places and what they are sorted with; bins and numbers, alike; and states,
photos, light and gradients."""

LARGEST = 1e20
"""Sums of gradients beyond are no numbers, in effect."""

SEEN_FROM_BYTES = 3 * 16
"""Of the struct Learning, before its rates."""

SPLATS_A_THREAD = 32
"""Of kernels that add up over all splats."""

HOUSE: dict[str, Constant] = {
    "PI": math.pi,
    "TEXELS_A_ROW": CONSTANTS["TEXELS_A_ROW"],
    "FOUR": CONSTANTS["FOUR"],
    "NEAREST_M": NEAREST_M,
    "LEAST_SQUARE": LEAST_SQUARE,
    "LEAST_NORM": CONSTANTS["LEAST_NORM"],
    "GRADIENTS": GRADIENT_QUADS_AT,
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
class DrawnSplats:
    """Those splats that a picture can touch, in their order.

    Parameters
    ----------
    features
        The table of what is blended of them, `n_quads` each.
    places
        Of all splats: how many before each are among these; and their number.
    parts
        Of these: first number and count of each piece of totals.
    piece_of
        Of each part of all splats: the number of the piece that has its totals.
    """

    drawing: Drawing
    features: Piece
    places: Piece
    parts: Parts
    piece_of: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    start: int
    count: int
    learned: Piece
    first_moments: Piece
    second_moments: Piece
    seen: Piece


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
        self.is_half = self.n > MOST_WHOLE
        kind = {"SOLID": int(self.solid), "GLASS": int(with_glass), "HALF": int(self.is_half)}
        self.constants: dict[str, Constant] = {**HOUSE, **kind}
        group = optimiser.param_groups[0]
        self._betas, self._epsilon = group["betas"], group["eps"]
        self.n_steps = int(optimiser.state.get(splats.means, {}).get("step", 0))
        learned = {name: getattr(splats, name).detach() for name in PLACES}
        states = {name: optimiser.state.get(getattr(splats, name), {}) for name in PLACES}
        first, second = (
            {name: state[key] for name, state in states.items() if key in state} for key in ("exp_avg", "exp_avg_sq")
        )
        glass = (splats.panels >= 0).float().numpy()
        self._parts: list[_Part] = []
        check_number(self.n, device.most_bytes // 4 - 1)
        device.forget_idle()
        with device.errors_said():
            for start, count in parts_of(self.n, min(device.most_bytes // (16 * LEARNED_QUADS), MOST_OF_PART)):
                values = _packed(learned, start, count)
                values[:, GLASS] = glass[start : start + count]
                size, commands = values.nbytes // (2 if self.is_half else 1), device.commands()
                moments = [device.buffer(size, stays=True) for _ in range(2)]
                for piece, given, code in zip(moments, (first, second), (half_of_first, half_of_second), strict=True):
                    if given:
                        numbers = _packed(given, start, count)
                        self._lay_out(piece, code(numbers) if self.is_half else numbers)
                    else:
                        commands.clear(piece, size)
                own, seen = device.buffer(values.nbytes, stays=True), device.buffer(16 * count, stays=True)
                self._lay_out(own, values)
                self._parts.append(_Part(start, count, own, moments[0], moments[1], seen))
                # What is on its way to the card is held until then.
                commands.submit()
        self.forget_seen()

    def _lay_out(self, piece: Piece, values: Floats | Halves) -> None:
        """Write numbers of splats, quad by quad."""
        by_quad = values.reshape(len(values), LEARNED_QUADS, 4).transpose(1, 0, 2)
        self.device.write(piece, np.ascontiguousarray(by_quad))

    def drawing(self, view: View, settings: RasterSettings, degree: int) -> DrawnSplats:
        """Lists of a picture, and what is blended in it."""
        device = self.device
        places = device.buffer(4 * (self.n + 1))
        commands = device.commands()
        looking = view_uniform(view, settings, self.n, self.solid) + bytes(WINDOW_BYTES)
        for part in self._parts:
            commands.run(
                "find_seen", constants_for(device, settings, self.solid) | self.constants, groups_of(part.count),
                looking, self._seen_from(view, degree, part), part.learned, places,
            )  # fmt: skip
        run_sums(commands, device, places, self.n)
        n_ends, step = len(self._parts) + 1, self._parts[0].count if self._parts else 1
        ends = device.buffer(4 * n_ends)
        commands.run("part_ends", {}, groups_of(n_ends), uniform(self.n, step, n_ends, 0), places, ends)
        firsts = commands.read((ends, 4 * n_ends))[0].view(np.uint32).tolist()
        n = firsts[-1]
        check_number(n, device.most_texels // GEOMETRY_QUADS)
        parameters, features = device.table(PARAMETER_QUADS * n), device.table(self.n_quads * n)
        for part in self._parts:
            commands.run(
                "splat_features", self.constants | quads(self.n_quads), groups_of(part.count),
                self._seen_from(view, degree, part), part.learned, places, parameters, features,
            )  # fmt: skip
        commands.submit()
        parts, piece_of = _pieces(firsts, device.most_bytes // (16 * ROW_QUADS))
        drawing = Drawing(device, view, settings, parameters, n, self.solid)
        return DrawnSplats(drawing, features, places, parts, piece_of)

    def add_up(
        self, commands: Commands, drawn: DrawnSplats, degree: int, totals: list[Piece], sums: Piece,
        slots: dict[str, Constant], *, moves: bool,
    ) -> None:  # fmt: skip
        """Note gradients that are no numbers, and add up what moving the camera would change.

        Parameters
        ----------
        totals
            As for `learn`.
        slots
            Of `sums`: IS_BAD, and OF_MOVE of six numbers.
        moves
            Whether the latter is asked for.
        """
        bits = int(np.float32(LARGEST).view(np.uint32))
        constants = self.constants | quads(self.n_quads) | slots | {"LARGEST_BITS": bits, "MOVES": int(moves)}
        for part, piece in zip(self._parts, drawn.piece_of, strict=True):
            commands.run(
                "splat_sums", constants, groups_of(-(-part.count // SPLATS_A_THREAD)),
                self._seen_from(drawn.drawing.view, degree, part, drawn.parts[piece][0]), part.learned, drawn.places,
                totals[piece], sums,
            )  # fmt: skip

    def learn(self, drawn: DrawnSplats, degree: int, totals: list[Piece], weights: Piece, by: AdamStep) -> None:
        """Take a step of Adam, keep sizes within limits, and add up what densification asks.

        Parameters
        ----------
        totals
            Of each part of those drawn: sums over pixels by channel, and gradients of parameters in their place behind
            them, see `Drawing.project_back`.
        weights
            Of those drawn.
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
        view, radii = drawn.drawing.view, drawn.drawing.radii
        commands = self.device.commands()
        for part, piece in zip(self._parts, drawn.piece_of, strict=True):
            commands.run(
                "learn_splats", self.constants | gate, groups_of(part.count),
                self._seen_from(view, degree, part, drawn.parts[piece][0], by.seed)[:SEEN_FROM_BYTES] + numbers,
                part.learned, part.first_moments, part.second_moments, drawn.places, totals[piece], radii, weights,
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
            drawn = self.drawing(view, settings, 3)
            drawing, features = drawn.drawing, drawn.features
            commands, weights = self.device.commands(), self.device.buffer(4 * drawing.n)
            commands.clear(weights, 4 * drawing.n)
            totals = drawing.no_sums(commands, drawn.parts)
            for window in drawing.windows:
                drawing.blend(commands, window, features, self.n_quads, weights)
                rows, columns = window.bins.pixels(view)
                part = np.ascontiguousarray(pull[rows, columns]).reshape(-1, 4)
                pixels = self.device.table(len(part))
                self.device.write_table(pixels, part)
                drawing.blend_back(commands, window, features, self.n_quads, pixels, drawn.parts, totals)
            for of_part, piece in zip(drawn.parts, totals, strict=True):
                drawing.project_back(commands, of_part, piece, in_place=True)
            commands.submit()
            self.learn(drawn, 3, totals, weights, by)
            if self._parts:
                self.device.read((self._parts[0].seen, 16))

    def _seen_from(self, view: View, degree: int, part: _Part, first_row: int = 0, seed: int = 0) -> bytes:
        """The struct Learning of learned.wgsl, whose rates are 0."""
        eye = view.position_m.tolist()
        whole = uniform(*eye, 0.0, part.start, part.count, n_harmonics(degree), seed & 0xFFFFFFFF, first_row, 0, 0, 0)
        return whole + bytes(6 * 16)

    def bring(self, splats: Splats, optimiser: Optimizer | None = None) -> None:
        """Bring what was learned to main memory, and Adam's moments where there is an optimiser.

        Raises
        ------
        DeviceFailed
            The card fails.
        """
        names = ("learned",) if optimiser is None else ("learned", "first_moments", "second_moments")
        found = {name: [torch.empty_like(getattr(splats, name).data) for _ in names] for name in PLACES}
        whole = {"first_moments": first_of_half, "second_moments": second_of_half} if self.is_half else {}
        with self.device.errors_said():
            for part in self._parts:
                behind = part.start + part.count
                for number, kind in enumerate(names):
                    of_half = whole.get(kind)
                    n_bytes = 16 * LEARNED_QUADS * part.count // (1 if of_half is None else 2)
                    raw = self.device.read((getattr(part, kind), n_bytes))[0]
                    values = raw.view(np.float32) if of_half is None else of_half(raw.view(np.uint16))
                    by_splat = values.reshape(LEARNED_QUADS, part.count, 4).transpose(1, 0, 2)
                    columns = by_splat.reshape(part.count, 4 * LEARNED_QUADS)
                    for name, place in PLACES.items():
                        own = found[name][number][part.start : behind]
                        width = math.prod(own.shape[1:])
                        own.copy_(torch.from_numpy(columns[:, place][:, :width].copy()).reshape(own.shape))
        for name, values_of in found.items():
            parameter = getattr(splats, name)
            parameter.data.copy_(values_of[0])
            if optimiser is not None:
                state = optimiser.state[parameter]
                state["step"] = torch.tensor(float(self.n_steps))
                state["exp_avg"], state["exp_avg_sq"] = values_of[1:]

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


@dataclass(frozen=True, slots=True)
class PictureSize:
    """What a picture's lists hold.

    Parameters
    ----------
    n_splats
        That it can touch.
    n_patches
        Of all bins that these reach, together.
    n_pixels
        Of the picture.
    """

    n_splats: int
    n_patches: int
    n_pixels: int


def needed_bytes(n: int, size: PictureSize, *, is_software: bool, with_glass: bool = True) -> int:
    """Of a card's memory, at most, for steps with so many splats, `BYTES_FOR_ALL` included.

    What is learned of them is laid out as it must be; what only a picture needs, in pieces of the pool, which are
    larger by a quarter at most, or tables by half of a program's in the place of a card.
    """
    number, quad = 4, 16
    moments = 2 * (number if n <= MOST_WHOLE else number // 2)
    learned = 4 * LEARNED_QUADS * (number + moments) + quad + ROUNDED * number
    n_quads = GLASS_FEATURES if with_glass else OTHER_FEATURES
    in_tables = 2.0 if is_software else ROUNDED
    drawn = in_tables * quad * (PARAMETER_QUADS + GEOMETRY_QUADS + n_quads) + ROUNDED * quad * ROW_QUADS
    n_windows = rounded_up(size.n_patches, MOST_SUMS)
    drawn += ROUNDED * number * (NUMBERS_A_SPLAT + n_windows)
    # A patch has a pair to itself at worst. Rows of sums are there for one window at a time, and twice.
    patch = in_tables * quad + ROUNDED * number * NUMBERS_A_PAIR
    rows = min(size.n_patches, MOST_SUMS) * quad * ROW_QUADS * (in_tables + ROUNDED)
    pixel = ROUNDED * quad * (2 * n_quads + QUADS_A_PIXEL)
    in_all = learned * n + drawn * size.n_splats + patch * size.n_patches + rows + pixel * size.n_pixels
    return BYTES_FOR_ALL + math.ceil(in_all)


def fits_card(splats: Splats) -> bool:
    """Whether they have nothing but what kernels know of."""
    return splats.names == tuple(SHAPES) and splats.means.device.type == "cpu"


def _packed(values: dict[str, Tensor], start: int, count: int) -> Floats:
    """Of so many splats, shape (count, 64); 0 where nothing is given."""
    found = np.zeros((count, 4 * LEARNED_QUADS), np.float32)
    for name, tensor in values.items():
        part = tensor[start : start + count].reshape(count, -1).numpy()
        first = PLACES[name].start
        found[:, first : first + part.shape[1]] = part
    return found


def _pieces(firsts: list[int], most: int) -> tuple[Parts, tuple[int, ...]]:
    """Parts that lie behind each other, by where they begin and end, put together to pieces of at most so many.

    Returns
    -------
    Parts
        First number and count of each piece.
    tuple
        Of each part the number of its piece.
    """
    parts: Parts = []
    piece_of = []
    for first, behind in pairwise(firsts):
        if parts and behind - parts[-1][0] <= most:
            parts[-1] = parts[-1][0], behind - parts[-1][0]
        else:
            parts.append((first, behind - first))
        piece_of.append(len(parts) - 1)
    return parts, tuple(piece_of)


def half_of_first(values: Floats) -> Halves:
    """`first_code` of moments.wgsl."""
    bits = values.view(np.uint32)
    size = np.maximum((bits & 0x7FFFFFFF) + (1 << FIRST_SHIFT - 1), LEAST_BITS) - LEAST_BITS
    found: Halves = (np.minimum(size >> FIRST_SHIFT, 0x7FFF) | (bits >> 16 & 0x8000)).astype(np.uint16)
    return found


def first_of_half(codes: Halves) -> Floats:
    """`first_value` of moments.wgsl."""
    size = codes.astype(np.uint32) & 0x7FFF
    bits = np.where(size == 0, 0, (size << FIRST_SHIFT) + LEAST_BITS) | (codes.astype(np.uint32) & 0x8000) << 16
    found: Floats = bits.astype(np.uint32).view(np.float32)
    return found


def half_of_second(values: Floats) -> Halves:
    """`second_code` of moments.wgsl, rounded to the nearest."""
    bits = np.sqrt(values).view(np.uint32) + np.uint32(1 << SECOND_SHIFT - 1)
    size = (np.maximum(bits, LEAST_BITS) - LEAST_BITS) >> SECOND_SHIFT
    found: Halves = np.minimum(size, 0xFFFF).astype(np.uint16)
    return found


def second_of_half(codes: Halves) -> Floats:
    """`second_value` of moments.wgsl."""
    code = codes.astype(np.uint32)
    root: Floats = np.where(code == 0, 0, (code << SECOND_SHIFT) + LEAST_BITS).astype(np.uint32).view(np.float32)
    return root * root
