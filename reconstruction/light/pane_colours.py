"""Colours of panes from what is behind them and what they mirror, with gradients, in one go on a processor."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch import Tensor

from reconstruction.light import pane_colour_kernels as kernels


def pane_colours(
    diffuse: Tensor, light: Tensor, cosines: Tensor, reflectivity: Tensor, base: Tensor, corner_loss: Tensor,
    panels: Tensor, factors: Tensor, off_axis: Tensor,
) -> Tensor:  # fmt: skip
    """Colours as photos have them, sRGB, shape (n, 3), float32, on a processor (paper Eqs. 19 and 21).

    Gradients flow through the first six.

    Parameters
    ----------
    diffuse, light, cosines
        c and the mirrored light, linear, shape (n, 3), and cosines of the angles of incidence, shape (n,), float32.
    reflectivity, base
        Logits of R and F0 of each pane, shapes (m, 1) and (m, 3).
    corner_loss
        Share of light lost in a picture's corners, shape ().
    panels, factors, off_axis
        Panes' numbers, factors of linear light, and squared distances from the principal point, 1 in a picture's
        corners, shape (n,).
    """
    found: Tensor = _Colours.apply(  # type: ignore[no-untyped-call]
        diffuse, light, cosines, reflectivity, base, corner_loss, panels, factors, off_axis
    )
    return found


class _Colours(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, diffuse: Tensor, light: Tensor, cosines: Tensor, reflectivity: Tensor, base: Tensor,
        corner_loss: Tensor, panels: Tensor, factors: Tensor, off_axis: Tensor,
    ) -> Tensor:  # fmt: skip
        shares = torch.sigmoid(reflectivity.detach().double())[:, 0], torch.sigmoid(base.detach().double())
        values = (diffuse, light, cosines, panels.long(), factors.double(), off_axis.double(), *shares)
        fixed: Any = (*(np.ascontiguousarray(value.detach().numpy()) for value in values), float(corner_loss))
        found, slopes = np.empty((2, len(panels), 3), np.float32)
        colours: Any = kernels.colours
        colours(*fixed, found, slopes)
        ctx.fixed, ctx.slopes = fixed, slopes
        return torch.from_numpy(found)

    @staticmethod
    def backward(ctx: Any, by_colours: Tensor) -> tuple[Tensor | None, ...]:
        fixed: Any = ctx.fixed
        mirrored, base = fixed[6], fixed[7]
        written = [np.empty_like(value) for value in fixed[:3]]
        by_mirrored, by_base = np.zeros_like(mirrored), np.zeros_like(base)
        colours_back: Any = kernels.colours_back
        by_corner_loss = colours_back(
            *fixed, ctx.slopes, np.ascontiguousarray(by_colours.numpy()), *written, by_mirrored, by_base
        )
        by_logits = (by_mirrored * mirrored * (1.0 - mirrored))[:, None], by_base * base * (1.0 - base)
        return (
            *map(torch.from_numpy, written), *(torch.from_numpy(part).float() for part in by_logits),
            torch.tensor(by_corner_loss, dtype=torch.float32), None, None, None,
        )  # fmt: skip
