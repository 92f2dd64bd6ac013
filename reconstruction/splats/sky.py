"""Sky: light by direction behind everything, infinitely far away, so that it cannot drift in front of a camera."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.autograd.function import once_differentiable
from torch.nn import functional

from planning.base.jit import chunks, inline, kernel, run_chunks
from reconstruction.light.environment_map import place_of, turns_and_rows

Floats = NDArray[np.float32]

BRIGHTEST = 4.0
"""Linear light at most: 1 is as bright as a photo shows, and a photo may be exposed two stops below the others."""

EXPECTED = 0.5
"""Linear light that it starts from, as an overcast sky in a well exposed photo."""

COARSEST = 4
"""Rows of the coarsest picture."""

ROWS = 64
"""Of the finest picture, 2.8 degrees a pixel: skies change slowly, and what does not is not the sky."""

SEEN = 1.0 / 512.0
"""Share of a pixel's light from which on the sky behind is asked for: half a step of a display."""


class Sky(nn.Module):
    """A picture of all directions, of light 0 to `BRIGHTEST`, rows from the zenith to the nadir, columns clockwise.

    It is the sum of pictures each twice as fine as the one before: coarse ones fill in what no photo has seen. They are
    added up first, once for a photo, so that a pixel costs one lookup.

    Splats that stand for the sky come to rest in front of cameras that were not learned from (measured: unseen views
    fell from 24 to 14 dB while the others got better). Here there is nothing that could move.

    Parameters
    ----------
    rows
        Of the finest picture, which has twice as many columns: a power of 2, at least `COARSEST`.
    expected
        Light that it starts from.
    """

    def __init__(self, rows: int = ROWS, expected: float = EXPECTED) -> None:
        super().__init__()
        if rows < COARSEST or rows & (rows - 1):
            raise ValueError(f"rows: expected a power of 2 from {COARSEST} on, got {rows}")
        sides = [COARSEST << k for k in range((rows // COARSEST).bit_length())]
        self.levels = nn.ParameterList([nn.Parameter(torch.zeros(1, 3, side, 2 * side)) for side in sides])
        self.mean = nn.Parameter(torch.zeros(3))
        self.start_from(torch.full((3,), expected))

    def start_from(self, light: Tensor) -> None:
        """Let it be one colour: linear light, shape (3,), of a photo's sky for example."""
        with torch.no_grad():
            share = (light / BRIGHTEST).clamp(1e-3, 1.0 - 1e-3)
            self.mean.copy_(torch.log(share) - torch.log1p(-share))
            for level in self.levels:
                level.zero_()

    def picture(self) -> Tensor:
        """Linear light of all directions, shape (rows, 2 rows, 3)."""
        logits = self.mean[None, :, None, None] + self.levels[0]
        for level in list(self.levels)[1:]:
            logits = _twice_as_fine(logits) + level
        return BRIGHTEST * torch.sigmoid(logits)[0].permute(1, 2, 0)

    def forward(self, directions: Tensor) -> Tensor:
        """Linear light, shape (n, 3), from unit directions, shape (n, 3), axes of the world."""
        return _behind(self.picture(), directions, torch.zeros(len(directions), device=directions.device))

    def behind(self, directions: Tensor, alphas: Tensor) -> Tensor:
        """Light that reaches the camera from behind splats, (1 - alpha) L, shape (h, w, 3).

        It is 0, and has no gradient, where no more than `SEEN` of a pixel is left for it.

        Parameters
        ----------
        directions
            Unit, shape (h, w, 3).
        alphas
            What the splats cover, shape (h, w).
        """
        return _behind(self.picture(), directions.reshape(-1, 3), alphas.reshape(-1)).reshape(*alphas.shape, 3)


def _twice_as_fine(picture: Tensor) -> Tensor:
    """Shape (1, 3, h, w) to (1, 3, 2 h, 2 w), linear in between, round without a seam, ending at the poles."""
    round_about = functional.pad(picture, (1, 1, 0, 0), mode="circular")
    padded = functional.pad(round_about, (0, 0, 1, 1), mode="replicate")
    return functional.interpolate(padded, scale_factor=2, mode="bilinear", align_corners=False)[..., 2:-2, 2:-2]


def _behind(picture: Tensor, directions: Tensor, alphas: Tensor) -> Tensor:
    if picture.device.type == "cpu" and picture.dtype == directions.dtype == alphas.dtype == torch.float32:
        return cast(Tensor, _Behind.apply(picture, directions, alphas))  # type: ignore[no-untyped-call]
    return behind_reference(picture, directions, alphas)


def behind_reference(picture: Tensor, directions: Tensor, alphas: Tensor) -> Tensor:
    """(1 - alpha) L in plain torch, of any type on any device, shape (n, 3).

    Parameters
    ----------
    picture, directions, alphas
        Shapes (h, 2 h, 3), (n, 3) and (n,).
    """
    height, width = picture.shape[:2]
    turns, rows = turns_and_rows(directions.detach())
    x, y = turns * width + (0.5 * width - 0.5), (rows * height - 0.5).clamp(0.0, height - 1.0)
    left, top = torch.floor(x), torch.floor(y).clamp(max=height - 2.0)
    a, b = (x - left)[:, None], (y - top)[:, None]
    column, row = left.long() % width, top.long()
    beside = (column + 1) % width
    upper = torch.lerp(picture[row, column], picture[row, beside], a)
    lower = torch.lerp(picture[row + 1, column], picture[row + 1, beside], a)
    shares = 1.0 - alphas
    return torch.where(shares > SEEN, shares, 0.0)[:, None] * torch.lerp(upper, lower, b)


PARTS = 8
"""In which pixels are worked on threads, each with a picture of its own for the gradients: always as many, so that sums
are the same bits for any number of threads."""


class _Behind(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, picture: Tensor, directions: Tensor, alphas: Tensor) -> Tensor:
        ctx.save_for_backward(picture, alphas)
        known, out = (_array(picture), _array(directions), _array(alphas)), torch.empty(len(alphas), 3)
        ctx.places = np.empty((len(alphas), 2), np.float32)

        def look_up(start: int, stop: int) -> None:
            _look_up(*known, start, stop, ctx.places, out.numpy())

        run_chunks(look_up, _parts(len(alphas)))
        return out

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Any) -> tuple[Tensor, None, Tensor]:
        picture, alphas = ctx.saved_tensors
        of_alphas, known = np.zeros(alphas.shape, np.float32), (_array(picture), ctx.places, _array(alphas))
        gradient = _array(gradients[0])

        def give_back(start: int, stop: int) -> Floats:
            of_picture = np.zeros(picture.shape, np.float32)
            _give_back(*known, gradient, start, stop, of_picture, of_alphas)
            return of_picture

        of_picture = np.add.reduce(run_chunks(give_back, _parts(len(alphas))))
        return torch.from_numpy(of_picture), None, torch.from_numpy(of_alphas)


def _parts(n: int) -> list[tuple[int, int]]:
    return chunks(n, max(-(-n // PARTS), 1)) or [(0, 0)]


def _array(tensor: Tensor) -> Floats:
    return np.asarray(tensor.detach().contiguous().numpy())


HALF, ZERO, ONE, SEEN_32 = np.float32(0.5), np.float32(0.0), np.float32(1.0), np.float32(SEEN)


@inline
def _texels_around(turns: Any, rows: Any, height: Any) -> Any:
    """Rows and columns of the four texels around a place, and the shares of the right and the lower ones."""
    width = 2 * height
    x = turns * np.float32(width) + np.float32(0.5 * width - 0.5)
    y = min(max(rows * np.float32(height) - HALF, ZERO), np.float32(height - 1))
    left, top = np.floor(x), min(np.floor(y), np.float32(height - 2))
    column, row = int(left), int(top)
    column = column + width if column < 0 else column
    return row, column, column + 1 if column + 1 < width else 0, x - left, y - top


@kernel
def _look_up(picture: Any, directions: Any, alphas: Any, start: int, stop: int, places: Any, out: Any) -> None:
    """Light behind some pixels; places only of those that show it."""
    for i in range(start, stop):
        share = ONE - alphas[i]
        if share <= SEEN_32:
            out[i, 0] = out[i, 1] = out[i, 2] = ZERO
            continue
        places[i, 0], places[i, 1] = place_of(directions, i)
        row, column, beside, a, b = _texels_around(places[i, 0], places[i, 1], picture.shape[0])
        for c in range(3):
            upper = picture[row, column, c] + a * (picture[row, beside, c] - picture[row, column, c])
            lower = picture[row + 1, column, c] + a * (picture[row + 1, beside, c] - picture[row + 1, column, c])
            out[i, c] = share * (upper + b * (lower - upper))


@kernel
def _give_back(
    picture: Any, places: Any, alphas: Any, gradient: Any, start: int, stop: int, of_picture: Any, of_alphas: Any
) -> None:
    for i in range(start, stop):
        share = ONE - alphas[i]
        if share <= SEEN_32:
            continue
        row, column, beside, a, b = _texels_around(places[i, 0], places[i, 1], picture.shape[0])
        total = ZERO
        for c in range(3):
            upper = picture[row, column, c] + a * (picture[row, beside, c] - picture[row, column, c])
            lower = picture[row + 1, column, c] + a * (picture[row + 1, beside, c] - picture[row + 1, column, c])
            total += gradient[i, c] * (upper + b * (lower - upper))
            scaled = share * gradient[i, c]
            of_picture[row, column, c] += (ONE - a) * (ONE - b) * scaled
            of_picture[row, beside, c] += a * (ONE - b) * scaled
            of_picture[row + 1, column, c] += (ONE - a) * b * scaled
            of_picture[row + 1, beside, c] += a * b * scaled
        of_alphas[i] = -total
