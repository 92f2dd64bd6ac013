"""How brightly each photo was exposed: gains that are learned beside the model, or fitted to views that are scored.

A model and the gains of all its photos can grow against each other without any picture changing, and splats then take
on a cast that the gains take away again. So the mean of the logarithms stays what it was at the start, by a projection
after each step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import torch
from scipy.spatial.transform import Rotation
from torch import Tensor, nn

from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.light.glass_light import GlassLight

# Corrections of photos' poses that were found out while light was learned alone, put into the photos.

Move = tuple[float, float, float, float, float, float]
"""Metres along ENU, and a rotation vector, radians, ENU."""


@torch.no_grad()
def learned_moves(light: GlassLight | None, n_photos: int) -> tuple[Move, ...]:
    """Of each photo learned from, as the rays were moved by them; none where poses were not learned.

    What all photos have in common is taken away: surroundings move and turn with it.
    """
    if light is None or light.moves is None or len(light.moves) != n_photos:
        return ()
    moves = (light.moves - light.moves.mean(dim=0)).double().cpu()
    return tuple(tuple(row) for row in moves.tolist())


def moved(photos: Sequence[PosedPhoto], moves: Sequence[Move]) -> tuple[PosedPhoto, ...]:
    """Photos where their corrections put them; as they are where there are none."""
    if not moves:
        return tuple(photos)
    return tuple(_moved(photo, move) for photo, move in zip(photos, moves, strict=True))


def _moved(photo: PosedPhoto, move: Move) -> PosedPhoto:
    turn = Rotation.from_rotvec(move[3:]).as_matrix()
    pose = Pose(photo.pose.position_enu_m + np.array(move[:3]), photo.pose.cam_from_enu @ turn.T)
    return replace(photo, pose=pose)


HeldOutGain = Literal["none", "fitted"]
"""Exposure of a view that was not learned from: what is known of it and nothing else, the fair score and the default;
or fitted to the photo that is scored, which shows what is left where exposure alone was wrong."""

DARKEST, BRIGHTEST = 4.0 / 255.0, 250.0 / 255.0
"""sRGB values of photos that tell a gain: darker ones are noise, and brighter ones are clipped."""

LEAST_VALUES = 100
"""That a gain is fitted to."""


class Exposures(nn.Module):
    """Factors on the linear light of each photo.

    Parameters
    ----------
    known
        Gains to start from, one for each photo, more than 0: what the folder tells, else 1.
    channels
        1: a gain for all of red, green and blue. 3: one for each, which takes up white balance, too.
    """

    def __init__(self, known: Sequence[float], channels: Literal[1, 3] = 1) -> None:
        super().__init__()
        if not known or not all(math.isfinite(gain) and gain > 0.0 for gain in known):
            raise ValueError("known: expected a gain above 0 for each of at least one photo")
        if channels not in (1, 3):
            raise ValueError(f"channels: expected 1 or 3, got {channels}")
        logarithms = torch.tensor(known, dtype=torch.float64).log()[:, None].repeat(1, channels)
        self.log_gains = nn.Parameter(logarithms.float())
        self.log_mean: Tensor
        self.register_buffer("log_mean", logarithms.mean(dim=0))

    def forward(self, number: int) -> Tensor:
        """Gain of a photo, shape (1,) or (3,)."""
        return self.log_gains[number].exp()

    @torch.no_grad()
    def project(self) -> None:
        """Give the logarithms their first mean back; to be called after each step."""
        drift = self.log_gains.mean(dim=0, dtype=torch.float64) - self.log_mean
        self.log_gains.sub_(drift.to(self.log_gains))


@torch.no_grad()
def fitted_gain(light: Tensor, truth: Tensor, display: Tensor, channels: Literal[1, 3] = 1) -> Tensor:
    """Gain that brings rendered light closest to a photo's, by least squares in linear light; shape (1,) or (3,).

    The closed form g = sum(f t) / sum(f f) over values f of the rendering and t of the photo, of those that are neither
    clipped nor next to black in the photo. 1 where fewer than `LEAST_VALUES` are left, or nothing was rendered.

    Parameters
    ----------
    light, truth
        Linear light as rendered, and of the photo, shape (n, 3).
    display
        The photo's sRGB values, 0 to 1, shape (n, 3).
    """
    if light.shape != truth.shape or light.shape != display.shape or light.ndim != 2 or light.shape[1] != 3:
        raise ValueError(f"expected three of shape (n, 3), got {[*light.shape]}, {[*truth.shape]}, {[*display.shape]}")
    told = (display > DARKEST) & (display < BRIGHTEST) & torch.isfinite(light)
    found = torch.where(told, light, 0.0).double()
    products, squares, counts = found * truth.double(), found * found, told.double()
    sums = torch.stack([part.sum(dim=0) for part in (products, squares, counts)])
    if channels == 1:
        sums = sums.sum(dim=1, keepdim=True)
    gain = sums[0] / sums[1].clamp(min=1e-12)
    is_told = (sums[2] >= LEAST_VALUES) & (sums[1] > 1e-12) & (gain > 0.0)
    return torch.where(is_told, gain, 1.0).to(light)
