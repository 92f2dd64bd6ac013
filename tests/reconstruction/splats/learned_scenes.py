"""Small scenes of splats, cameras around them, and a plain training."""

from __future__ import annotations

import math
from typing import Any

import torch
from torch import Tensor

from reconstruction.splats.densification.strategy import Change, Densification
from reconstruction.splats.rasterising.raster_types import Raster, RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import SHAPES, Splats

ONE_THREAD = RasterSettings(threads=1)

RATES = {"means": 4e-3, "quats": 1e-2, "log_scales": 2e-2, "opacity_logits": 5e-2, "sh": 2e-2}


def view_from(position: tuple[float, float, float], width: int = 48, height: int = 36, f_px: float = 50.0) -> View:
    """A camera that looks at the origin; z is up."""
    place = torch.tensor(position, dtype=torch.float64)
    forward = -place / place.norm()
    right = torch.linalg.cross(forward, torch.tensor([0.0, 0.0, 1.0], dtype=torch.float64))
    right = right / right.norm()
    rotation = torch.stack([right, torch.linalg.cross(forward, right), forward])
    matrix = torch.eye(4, dtype=torch.float64)
    matrix[:3, :3], matrix[:3, 3] = rotation, -rotation @ place
    return View(width, height, f_px, f_px, width / 2, height / 2, matrix)


def views_around(n: int = 6, distance_m: float = 4.0, **size: Any) -> list[View]:
    """Cameras on an arc in front (y < 0) of the plane y = 0."""
    angles = [math.radians(60.0 * (k / (n - 1) - 0.5)) for k in range(n)]
    return [
        view_from((distance_m * math.sin(a), -distance_m * math.cos(a), 0.6 * math.cos(5.0 * a)), **size)
        for a in angles
    ]


def facing(n: int) -> Tensor:
    """Quaternions of discs in the plane y = 0, normal -y: t_u = x, t_v = z."""
    return torch.tensor([math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0]).repeat(n, 1)


def random_splats(n: int, seed: int = 0, size_m: float = 0.12) -> Splats:
    """Discs of all kinds in a box of 2.4 m x 0.4 m x 1.8 m around the origin."""
    generator = torch.Generator().manual_seed(seed)

    def uniform(*shape: int, low: float = 0.0, high: float = 1.0) -> Tensor:
        return low + (high - low) * torch.rand(*shape, generator=generator)

    means = (uniform(n, 3) - 0.5) * torch.tensor([2.4, 0.4, 1.8])
    quats = facing(n) + 0.3 * torch.randn(n, 4, generator=generator)
    scales = size_m * uniform(n, 2, low=0.5, high=1.5)
    return Splats.of(means, quats, scales, uniform(n, low=0.5, high=0.95), uniform(n, 3, low=0.05, high=0.95))


def wall(columns: int, rows: int, colours: Tensor, opacity: float = 0.9, panels: Tensor | None = None) -> Splats:
    """An even grid of discs on 2.4 m x 1.8 m of the plane y = 0, row by row."""
    x = (torch.arange(columns) + 0.5) / columns * 2.4 - 1.2
    z = (torch.arange(rows) + 0.5) / rows * 1.8 - 0.9
    across, up = torch.meshgrid(x, z, indexing="xy")
    n = columns * rows
    means = torch.stack([across.flatten(), torch.zeros(n), up.flatten()], dim=1)
    scales = 0.6 * torch.tensor([2.4 / columns, 1.8 / rows]).repeat(n, 1)
    return Splats.of(means, facing(n), scales, torch.full((n,), opacity), colours, panels)


def solid(discs: Splats, share: float = 0.5) -> Splats:
    """Ellipsoids in the place of discs, so many times as thick as narrow."""
    values = {name: getattr(discs, name).detach() for name in SHAPES}
    thickness = values["log_scales"].min(dim=1, keepdim=True).values + math.log(share)
    return Splats(values | {"log_scales": torch.cat([values["log_scales"], thickness], dim=1)}, discs.panels)


def picture_of(splats: Splats, view: View, degree: int = 0, offsets: Tensor | None = None) -> Raster:
    """Raster of the splats' features."""
    features = splats.features(view.position_m, degree)
    shapes = splats.means, splats.quats, splats.scales, splats.opacities
    return rasterise(*shapes, features, view, screen_offsets=offsets, settings=ONE_THREAD)


def adam(splats: Splats) -> torch.optim.Adam:
    """One group for each parameter that these scenes learn."""
    groups = [{"params": [getattr(splats, name)], "lr": rate} for name, rate in RATES.items()]
    return torch.optim.Adam(groups, eps=1e-15, fused=True)


def error(splats: Splats, views: list[View], truths: list[Tensor]) -> float:
    """Mean absolute error of light."""
    found = truths_of(splats, views)
    return float(sum((a - b).abs().mean() for a, b in zip(found, truths, strict=True)) / len(views))


def truths_of(splats: Splats, views: list[View]) -> list[Tensor]:
    """Light of splats in all views."""
    with torch.no_grad():
        return [picture_of(splats, view).features[..., :3] for view in views]


def train(
    splats: Splats,
    views: list[View],
    truths: list[Tensor],
    steps: int,
    strategy: Densification | None = None,
    seed: int = 0,
    optimiser: torch.optim.Adam | None = None,
    first: int = 0,
) -> list[Change]:
    """Learn pictures one after the other; what the strategy changed in each step."""
    generator = torch.Generator().manual_seed(seed)
    optimiser = optimiser or adam(splats)
    changes = []
    for step in range(first, first + steps):
        view, truth = views[step % len(views)], truths[step % len(views)]
        offsets = torch.zeros(len(splats), 2, requires_grad=True)
        raster = picture_of(splats, view, 0, offsets)
        (raster.features[..., :3] - truth).abs().mean().backward()
        if strategy is not None:
            strategy.observe(raster, offsets.grad, view)
            strategy.before_step(step, splats, optimiser)
        optimiser.step()
        if strategy is not None:
            changes.append(strategy.after_step(step, splats, optimiser, generator))
        optimiser.zero_grad()
    return changes
