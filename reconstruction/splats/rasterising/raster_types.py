"""What a rasteriser is asked for and what it gives back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from planning.base.messages import say
from planning.base.parameters import Choice, check, parameter

FLAT_ENOUGH_RAD = math.radians(80.0)
"""Between line of sight and normal: so far even splats smaller than a pixel have the depth of their plane."""

FLAT, SOLID = 2, 3
"""Sizes of a disc and of an ellipsoid."""

FAINTEST = 2.0
"""Times `min_alpha`: below that itself, surfaces of small splats would vanish from afar."""

LEAST_ALPHA = 1e-4
"""Of `min_alpha`: as far as the compiled exponential reaches."""

NO_DOT = 1e30
"""1 / sigma^2 of a low-pass filter that never counts."""


@dataclass(frozen=True, slots=True)
class RasterSettings:
    """Settings that all rasterisers share.

    Parameters
    ----------
    low_pass_px
        Standard deviation of the smallest circle that a disc is drawn as where it is not antialiased, so that none
        falls between pixels; 2DGS (Huang et al., 2024, Eq. 11) has sqrt(1/2).
    blur_px
        Standard deviation of what ellipsoids, and discs that are antialiased, are blurred by in the picture; 3DGS
        (Kerbl et al., 2023) has sqrt(0.3).
    antialiased
        Whether discs are blurred and not drawn as a circle where they are smaller, and whether what the blur makes
        larger is as much more transparent; see `projection` and `shown_opacities`. In 2DGS and 3DGS it is not, and what
        is finer than a pixel grows with its distance; long and thin discs of 2DGS have gaps, too.
    near_m
        Splats whose middle is nearer than this, along the optical axis, are not drawn, and what is nearer of the others
        is cut off.
    min_alpha
        Below, a splat does not count in a pixel: half a step of an 8-bit picture. It also ends the splat, so that it
        cannot be 0.
    max_alpha
        No splat covers more: gradients contain 1 / (1 - alpha).
    min_transmittance
        A pixel takes no more splats once less than this shows through; the splat that goes below is still taken, so
        that this is all that can be missing.
    tile_px
        Side of the squares the picture is worked in; changes time, not the picture.
    threads
        How many to use; 0 stands for all cores. Changes time, not one bit of the result.
    on_gpu
        Whether a graphics card draws, by WebGPU, what lies in main memory: see `wgpu_backend`.
    deterministic
        Whether a graphics card adds gradients up in a fixed order, or by atomic additions in any: the processor always
        has one.
    """

    low_pass_px: float = parameter(math.sqrt(0.5), above=0.0)
    blur_px: float = parameter(math.sqrt(0.3), above=0.0)
    antialiased: bool = False
    near_m: float = parameter(0.1, above=0.0)
    min_alpha: float = parameter(1.0 / 255.0, least=LEAST_ALPHA, below=1.0)
    max_alpha: float = parameter(0.99, above=0.0, below=1.0)
    min_transmittance: float = parameter(1e-4, least=0.0, below=1.0)
    tile_px: int = parameter(16, choices=tuple(Choice(8 * n) for n in range(1, 9)))
    threads: int = parameter(0, least=0)
    on_gpu: bool = False
    deterministic: bool = True

    def __post_init__(self) -> None:
        check(self)
        if self.min_alpha >= self.max_alpha:
            raise ValueError(
                say("expected less than max_alpha, {:g}, got {:g}", self.max_alpha, self.min_alpha, place="min_alpha")
            )

    @property
    def faintest(self) -> float:
        """Opacity that antialiasing leaves at least, unless there was less before."""
        return FAINTEST * self.min_alpha

    @property
    def reach(self) -> float:
        """Standard deviations up to which an opaque splat counts."""
        return math.sqrt(-2.0 * math.log(self.min_alpha))

    @property
    def over_low_pass2(self) -> float:
        """1 / sigma^2 of discs' low-pass filter; so large where there is none that it never counts."""
        return NO_DOT if self.antialiased else 1.0 / self.low_pass_px**2

    def least_depth_change(self, focal_px: float) -> float:
        """Depth, as a share of that of its middle, by which any splat may differ from it; see `torch_reference`."""
        smallest_px = self.blur_px if self.antialiased else self.low_pass_px
        return smallest_px * self.reach * steepest(focal_px)


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """A picture of splats.

    With w_i the weight of splat i in a pixel, its alpha times what those in front of it let through:

    Parameters
    ----------
    features
        Sum of w_i f_i, shape (h, w, c); no background is added.
    alphas
        Sum of w_i, shape (h, w), 0 to 1.
    depths
        Sum of w_i z_i, shape (h, w), metres: z_i along the optical axis, of where the ray meets the splat; of an
        ellipsoid, of its middle. Divide by `alphas` for a depth.
    labels
        Of each pixel the label of the heaviest accumulated weight, shape (h, w), int32: the lowest of several equal
        ones, and -1 where there is no splat. None where no labels were given.
    weights
        Of each splat, w_i added up over all pixels, shape (n,). No gradient.
    radii_px
        Half the larger side of the box that each splat can touch, also outside the picture, shape (n,); 0 where it is
        not drawn. No gradient. (The torch rasteriser measures what it touches inside.)
    """

    features: Tensor
    alphas: Tensor
    depths: Tensor
    labels: Tensor | None
    weights: Tensor
    radii_px: Tensor

    @property
    def surface_depths_m(self) -> Tensor:
        """Depth along the optical axis of what covers a pixel, shape (h, w); infinite where that is under a half."""
        return torch.where(self.alphas > 0.5, self.depths / self.alphas.clamp(min=0.5), torch.inf)


def steepest(focal_px: float) -> float:
    """Change of the depth from pixel to pixel, as a share of it, of a plane that is just flat enough."""
    return math.tan(FLAT_ENOUGH_RAD) / focal_px
