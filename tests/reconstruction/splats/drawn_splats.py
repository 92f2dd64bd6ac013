"""Splats to draw in tests: random ones before a camera, some of them where they must not be seen, and a plane."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import torch
from torch import Tensor

from reconstruction.splats.rasterising.raster_types import Raster, RasterSettings
from reconstruction.splats.rasterising.rasteriser import USUAL, Backend, rasterise
from reconstruction.splats.rasterising.views import View


@dataclass(frozen=True)
class MadeSplats:
    """What `rasterise` takes, float64."""

    means: Tensor
    quats: Tensor
    scales: Tensor
    opacities: Tensor
    features: Tensor

    @property
    def tensors(self) -> tuple[Tensor, ...]:
        return self.means, self.quats, self.scales, self.opacities, self.features

    def picked(self, which: Tensor) -> MadeSplats:
        return MadeSplats(*(t[which] for t in self.tensors))

    def changed(self, **values: Tensor) -> MadeSplats:
        return replace(self, **values)


@dataclass(frozen=True)
class Drawn:
    raster: Raster
    gradients: tuple[Tensor, ...]


def turned_view(width_px: int = 40, height_px: int = 28, focal_px: float = 34.0) -> View:
    """A camera off the origin that is turned about all axes; its principal point is far from the middle."""
    rotation = torch.linalg.qr(torch.randn(3, 3, generator=seeded(7), dtype=torch.float64))[0]
    rotation = rotation * torch.linalg.det(rotation)
    matrix = torch.eye(4, dtype=torch.float64)
    matrix[:3, :3], matrix[:3, 3] = rotation, torch.tensor([0.3, -0.2, 0.5])
    return View(width_px, height_px, focal_px, 1.1 * focal_px, 0.35 * width_px, 0.7 * height_px, matrix)


def seeded(seed: int) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def random_splats(n: int, view: View, seed: int = 0, channels: int = 5) -> MadeSplats:
    """Of a tenth of the picture's width and less, in it and around it; every tenth behind the camera."""
    g = seeded(seed)

    def uniform(*shape: int) -> Tensor:
        return torch.rand(*shape, generator=g, dtype=torch.float64)

    z = 2.0 + 4.0 * uniform(n)
    x = (view.width_px * (1.4 * uniform(n) - 0.2) - view.cx_px) / view.fx_px * z
    y = (view.height_px * (1.4 * uniform(n) - 0.2) - view.cy_px) / view.fy_px * z
    places = torch.stack([x, y, z], dim=1)
    places[9::10] *= -1.0
    rotation, shift = view.cam_from_world[:3, :3], view.cam_from_world[:3, 3]
    opacities = 0.02 + 0.97 * uniform(n)
    opacities[5::13] = 0.002
    return rounded(
        MadeSplats(
            (places - shift) @ rotation,
            3.0 * torch.randn(n, 4, generator=g, dtype=torch.float64),
            torch.exp(-2.6 + 0.6 * torch.randn(n, 2, generator=g, dtype=torch.float64)),
            opacities,
            torch.randn(n, channels, generator=g, dtype=torch.float64),
        )
    )


def random_ellipsoids(n: int, view: View, seed: int = 0, channels: int = 5) -> MadeSplats:
    """The same places with a third size."""
    splats = random_splats(n, view, seed, channels)
    third = torch.exp(-2.6 + 0.9 * torch.randn(n, 1, generator=seeded(seed + 1000), dtype=torch.float64))
    return rounded(splats.changed(scales=torch.cat([splats.scales, third], dim=1)))


def rounded(splats: MadeSplats) -> MadeSplats:
    """To what float32 can hold, so that both precisions draw the same splats."""
    return MadeSplats(*(t.to(torch.float32).to(torch.float64) for t in splats.tensors))


def draw(
    splats: MadeSplats,
    view: View,
    backend: Backend,
    *,
    labels: Tensor | None = None,
    settings: RasterSettings = USUAL,
    seed: int | None = 1,
) -> Drawn:
    """Draw, and take random weights of all that can be differentiated back; float64 for `torch`, float32 for others."""
    dtype = torch.float64 if backend == "torch" else torch.float32
    inputs = [t.detach().to(dtype).clone().requires_grad_() for t in splats.tensors]
    offsets = torch.zeros(len(splats.means), 2, dtype=dtype, requires_grad=True)
    raster = rasterise(*inputs, view, screen_offsets=offsets, labels=labels, settings=settings, backend=backend)
    if seed is None:
        return Drawn(_without_gradients(raster), ())
    g = seeded(seed)
    total = torch.zeros((), dtype=dtype)
    for values in (raster.features, raster.alphas, raster.depths):
        total = total + (values * torch.randn(values.shape, generator=g).to(dtype)).sum()
    if total.requires_grad:
        total.backward()
    gradients = tuple(torch.zeros_like(t) if t.grad is None else t.grad for t in (*inputs, offsets))
    return Drawn(_without_gradients(raster), gradients)


def both(splats: MadeSplats, settings: RasterSettings = USUAL) -> Drawn:
    """Draw with both rasterisers, which must agree and give numbers; the compiled one's comes back."""
    view = level_view()
    truth = draw(rounded(splats), view, "torch", settings=settings)
    found = draw(rounded(splats), view, "numba", settings=settings)
    for name in ("features", "alphas", "depths", "weights"):
        values = getattr(found.raster, name)
        assert values.isfinite().all(), name
        torch.testing.assert_close(values.double(), getattr(truth.raster, name), atol=2e-5, rtol=1e-4)
    for gradient, true_gradient in zip(found.gradients, truth.gradients, strict=True):
        assert gradient.isfinite().all()
        assert relative_error(gradient, true_gradient) < 2e-3
    return found


def _without_gradients(raster: Raster) -> Raster:
    values = {field.name: getattr(raster, field.name) for field in fields(raster)}
    return Raster(**{name: None if value is None else value.detach() for name, value in values.items()})


def relative_error(found: Tensor, truth: Tensor) -> float:
    """|found - truth| / |truth|, and no more than what is next to nothing where the truth is."""
    found, truth = found.detach().to(truth.dtype), truth.detach()
    return float((found - truth).norm()) / max(float(truth.norm()), 1e-6)


def level_view(width_px: int = 32, height_px: int = 24, focal_px: float = 30.0) -> View:
    """A camera at the origin along z, whose axis meets the middle of pixel (width / 2, height / 2)."""
    return View(
        width_px, height_px, focal_px, focal_px, width_px / 2 + 0.5, height_px / 2 + 0.5,
        torch.eye(4, dtype=torch.float64),
    )  # fmt: skip


def one_splat(
    *,
    depth_m: float = 4.0,
    tilt_deg: float = 0.0,
    scale_m: tuple[float, ...] = (0.3, 0.3),
    opacity: float = 0.8,
    x_m: float = 0.0,
    y_m: float = 0.0,
) -> MadeSplats:
    """A splat before `level_view`, turned about the vertical; an ellipsoid, where it has three sizes."""
    half = torch.deg2rad(torch.tensor(tilt_deg, dtype=torch.float64)) / 2.0
    zero = torch.zeros((), dtype=torch.float64)
    return MadeSplats(
        torch.tensor([[x_m, y_m, depth_m]], dtype=torch.float64),
        torch.stack([half.cos(), zero, half.sin(), zero])[None],
        torch.tensor([scale_m], dtype=torch.float64),
        torch.tensor([opacity], dtype=torch.float64),
        torch.tensor([[1.0, 0.5]], dtype=torch.float64),
    )


def together(*splats: MadeSplats) -> MadeSplats:
    return MadeSplats(*(torch.cat(parts) for parts in zip(*(s.tensors for s in splats), strict=True)))


def tilted_plane(view: View, tilt_deg: float, sigma_m: float, depth_m: float = 8.0) -> tuple[MadeSplats, Tensor]:
    """Splats all over a plane turned about the vertical, and the depths of the plane, shape (h, w)."""
    one = one_splat(tilt_deg=tilt_deg, scale_m=(sigma_m, sigma_m), opacity=0.7)
    tilt = torch.deg2rad(torch.tensor(tilt_deg, dtype=torch.float64))
    reach, step = 0.75 * depth_m, 1.2 * sigma_m
    a, b = torch.meshgrid(
        torch.arange(-4.0 * reach, 4.0 * reach, step, dtype=torch.float64),
        torch.arange(-reach, reach, step, dtype=torch.float64),
        indexing="ij",
    )
    means = torch.stack([a * tilt.cos(), b, depth_m - a * tilt.sin()], dim=-1).reshape(-1, 3)
    x = (torch.arange(view.width_px, dtype=torch.float64) + 0.5 - view.cx_px) / view.fx_px
    depths = (depth_m / (1.0 + x * tilt.tan())).expand(view.height_px, -1)
    n = len(means)
    splats = MadeSplats(means, *(t.expand(n, *t.shape[1:]) for t in one.tensors[1:]))
    return rounded(splats), depths
