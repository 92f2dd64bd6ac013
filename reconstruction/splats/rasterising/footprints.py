"""How much of its opacity a splat keeps where it is drawn larger than a camera sees it, in torch.

What is finer than a pixel is drawn about a pixel wide, by a blur of the picture. Were it as opaque as it is, a bar
would grow with its distance, and a model that was learned from near would be wrong from afar. So the opacity is
multiplied by the share that the splat has of what is drawn: |Sigma'|^(1/2) of its picture without blur over the same
with it (Yu et al., "Mip-Splatting", CVPR 2024), of discs as of ellipsoids.
"""

from __future__ import annotations

import torch
from torch import Tensor

from reconstruction.splats.rasterising.ellipsoid_projection import rows_of
from reconstruction.splats.rasterising.projection import areas_of, blurred_areas2, project
from reconstruction.splats.rasterising.raster_types import SOLID, RasterSettings
from reconstruction.splats.rasterising.views import View

SMALLEST = 1e-30
"""Of areas, px^2, whose roots have gradients."""


def shown_opacities(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, opacities: Tensor, view: View, settings: RasterSettings
) -> Tensor:
    """Opacities, shape (n,), that splats in front of the camera are drawn with; as they are if not `antialiased`.

    However small its share, a splat keeps `settings.faintest`: a surface of many still hides what is behind it then.

    Parameters
    ----------
    means, quats_wxyz, scales, opacities
        As `rasteriser.rasterise` takes them.
    """
    if not settings.antialiased:
        return opacities
    shown = opacities * footprint_shares(means, quats_wxyz, scales, view, settings)
    return torch.minimum(opacities, shown.clamp(min=settings.faintest))


def footprint_shares(means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View, settings: RasterSettings) -> Tensor:
    """Shares of what is drawn, shape (n,), 0 to 1, that are the splats' own."""
    if scales.shape[1] == SOLID:
        row_x, row_y = rows_of(means, quats_wxyz, scales, view)
        across = torch.linalg.cross(row_x, row_y).square().sum(dim=-1).clamp(min=SMALLEST**2)
        blur2 = settings.blur_px**2
        blurred = across + blur2 * (row_x.square().sum(dim=-1) + row_y.square().sum(dim=-1) + blur2)
        return torch.sqrt(across / blurred)
    jacobians = project(means, quats_wxyz, scales, view).jacobians_px
    return areas_of(jacobians).abs() / torch.sqrt(blurred_areas2(jacobians, settings.blur_px))
