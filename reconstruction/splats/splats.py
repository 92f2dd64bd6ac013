"""Splats: Gaussian discs with what the paper adds to them, as the parameters of a model (paper 3.3.2).

Methods that the paper is compared with have ellipsoids in their place, which have a third size, or further attributes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from planning.base.errors import InputError
from planning.base.jit import chunks, inline, kernel, run_chunks
from planning.base.messages import say
from reconstruction.light.shading import BASE_REFLECTANCE, REFLECTIVITY
from reconstruction.splats.harmonic_colour import N_HARMONICS, flat_harmonics, seen_light
from reconstruction.splats.rasterising.projection import rotations
from reconstruction.splats.rasterising.raster_types import FLAT, SOLID

# Which way ellipsoids lie: their shortest axes, and the discs that they are nearest to.

LAST = torch.tensor([[0.5, 0.5, 0.5, 0.5], [0.5, -0.5, -0.5, -0.5], [1.0, 0.0, 0.0, 0.0]])
"""Turns (w, x, y, z) after which the first, second or third axis is the third, and the others come in their order."""


def thinnest_axes(quats_wxyz: Tensor, sizes: Tensor) -> Tensor:
    """Unit axes along which ellipsoids are thinnest, shape (n, 3), as the rotations have them.

    Parameters
    ----------
    quats_wxyz, sizes
        Shapes (n, 4) of any length, and (n, 3), or their logarithms; of equal ones the first counts.
    """
    shortest = sizes.detach().argmin(dim=-1)
    return rotations(quats_wxyz).gather(-1, shortest[:, None, None].expand(-1, 3, 1))[..., 0]


def shortest_axes(means: Tensor, quats_wxyz: Tensor, log_scales: Tensor, view_position: Tensor) -> Tensor:
    """Unit normals of ellipsoids, shape (n, 3): their shortest axes (GaussianShader, Jiang et al., 2024), to a camera.

    Differentiable in the quaternions; which axis is shortest and which way it points has no gradient. Of equally short
    ones it is the first.

    Parameters
    ----------
    means, quats_wxyz, log_scales
        Shapes (n, 3), (n, 4) of any length, and (n, 3).
    view_position
        The camera's, shape (3,).
    """
    axes = thinnest_axes(quats_wxyz, log_scales)
    away = (axes.detach() * (means.detach() - view_position.detach().to(means))).sum(dim=-1)
    return torch.where((away > 0.0)[:, None], -axes, axes)


def flattened(quats_wxyz: Tensor, log_scales: Tensor) -> tuple[Tensor, Tensor]:
    """Discs in the place of ellipsoids, shapes (n, 4) and (n, 2): without the shortest axis, which is the normal."""
    shortest = log_scales.detach().argmin(dim=-1)
    w, x, y, z = quats_wxyz.unbind(dim=-1)
    a, b, c, d = LAST.to(quats_wxyz)[shortest].unbind(dim=-1)
    quats = torch.stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ],
        dim=-1,
    )
    others = torch.stack([(shortest + 1) % 3, (shortest + 2) % 3], dim=-1)
    return quats, log_scales.gather(-1, others)


# What discs add to a picture besides their colour, seen from a place, with gradients, in one go on a processor.
#
# In plain torch (`Splats.features_reference`) each of a dozen steps goes through all splats again, which takes twice as
# long
# and longer (`python -m tests.benchmarks --only modelling-parts`).

Floats = NDArray[np.float32]
Panels = NDArray[np.int32]

N_COLUMNS = 11

AT_ONCE = 16_384
"""Splats of one piece of work."""

LEAST_SQUARE = 1e-12
"""Squared length of a quaternion below which it is no rotation; then nothing is turned, and it has no gradient."""


def disc_features(
    colours: Tensor,
    means: Tensor,
    quats: Tensor,
    reflectivity_logits: Tensor,
    f0_logits: Tensor,
    panels: Tensor,
    position: Tensor,
) -> Tensor:
    """`Splats.features` of discs, shape (n, 11), float32, on a processor; gradients flow through the first five.

    Parameters
    ----------
    colours, means, f0_logits
        Shape (n, 3).
    quats
        w, x, y, z of any length, shape (n, 4).
    reflectivity_logits, panels
        Shape (n,); panels below 0 mirror nothing.
    position
        Of the camera, shape (3,); it gets no gradient.
    """
    found = _Features.apply(colours, means, quats, reflectivity_logits, f0_logits, panels, position.detach())  # type: ignore[no-untyped-call]
    return cast(Tensor, found)


class _Features(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *inputs: Tensor) -> Tensor:
        ctx.save_for_backward(*inputs[1:])
        arrays = _arrays(inputs)
        out = np.empty((len(arrays[0]), N_COLUMNS), np.float32)
        fill: Any = _fill
        run_chunks(lambda start, stop: fill(*arrays, start, stop, out), chunks(len(out), AT_ONCE))
        return torch.from_numpy(out)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> tuple[Tensor | None, ...]:
        means, quats, reflectivity, f0, panels, eye = _arrays(ctx.saved_tensors)
        gradient = np.ascontiguousarray(gradients[0].numpy())
        found = [np.empty_like(part) for part in (means, quats, reflectivity, f0)]

        def work(start: int, stop: int) -> None:
            _fill_back(means, quats, reflectivity, f0, panels, eye, gradient, start, stop, *found)

        run_chunks(work, chunks(len(gradient), AT_ONCE))
        return gradients[0][:, :3], *map(torch.from_numpy, found), None, None


def _arrays(inputs: tuple[Tensor, ...]) -> Any:
    *values, panels, position = inputs
    floats = [np.ascontiguousarray(value.detach().numpy()) for value in values]
    return *floats, np.ascontiguousarray(panels.to(torch.int32).numpy()), position.double().numpy()


@inline
def _share(logit: Any) -> Any:
    return np.float32(1.0) / (np.float32(1.0) + np.exp(-logit))


@inline
def _normal(w: Any, x: Any, y: Any, z: Any) -> Any:
    """Third column of a quaternion's rotation, and 1 / its squared length; (0, 0, 1) and 0 where it says nothing."""
    square = w * w + x * x + y * y + z * z
    if not square > LEAST_SQUARE:
        return 0.0, 0.0, 1.0, 0.0
    over = 1.0 / square
    return 2.0 * over * (x * z + w * y), 2.0 * over * (y * z - w * x), over * (w * w - x * x - y * y + z * z), over


@inline
def _facing(means: Any, quats: Any, eye: Any, i: Any) -> Any:
    """From the camera to the middle, the normal turned to it, by which sign, and quaternion with 1 / squared length."""
    px, py, pz = means[i, 0] - eye[0], means[i, 1] - eye[1], means[i, 2] - eye[2]
    w, x, y, z = np.float64(quats[i, 0]), np.float64(quats[i, 1]), np.float64(quats[i, 2]), np.float64(quats[i, 3])
    nx, ny, nz, over = _normal(w, x, y, z)
    sign = -1.0 if nx * px + ny * py + nz * pz > 0.0 else 1.0
    return (px, py, pz), (sign * nx, sign * ny, sign * nz), sign, (w, x, y, z, over)


@kernel
def _fill(
    colours: Floats,
    means: Floats,
    quats: Floats,
    reflectivity: Floats,
    f0: Floats,
    panels: Panels,
    eye: NDArray[np.float64],
    start: int,
    stop: int,
    out: Floats,
) -> None:
    for i in range(start, stop):
        (px, py, pz), (nx, ny, nz), _, _ = _facing(means, quats, eye, i)
        out[i, 0], out[i, 1], out[i, 2] = colours[i, 0], colours[i, 1], colours[i, 2]
        out[i, 3] = _share(reflectivity[i]) if panels[i] >= 0 else np.float32(0.0)
        out[i, 4], out[i, 5], out[i, 6] = _share(f0[i, 0]), _share(f0[i, 1]), _share(f0[i, 2])
        out[i, 7], out[i, 8], out[i, 9] = nx, ny, nz
        out[i, 10] = nx * px + ny * py + nz * pz


@kernel
def _fill_back(
    means: Floats,
    quats: Floats,
    reflectivity: Floats,
    f0: Floats,
    panels: Panels,
    eye: NDArray[np.float64],
    gradient: Floats,
    start: int,
    stop: int,
    of_means: Floats,
    of_quats: Floats,
    of_reflectivity: Floats,
    of_f0: Floats,
) -> None:
    for i in range(start, stop):
        (px, py, pz), (nx, ny, nz), sign, (w, x, y, z, over) = _facing(means, quats, eye, i)
        of_reflectivity[i] = np.float32(0.0)
        if panels[i] >= 0:
            share = _share(reflectivity[i])
            of_reflectivity[i] = gradient[i, 3] * share * (np.float32(1.0) - share)
        for k in range(3):
            share = _share(f0[i, k])
            of_f0[i, k] = gradient[i, 4 + k] * share * (np.float32(1.0) - share)
        by_offset = np.float64(gradient[i, 10])
        of_means[i, 0], of_means[i, 1], of_means[i, 2] = by_offset * nx, by_offset * ny, by_offset * nz
        if over == 0.0:
            of_quats[i, 0] = of_quats[i, 1] = of_quats[i, 2] = of_quats[i, 3] = np.float32(0.0)
            continue
        gx, gy, gz = gradient[i, 7] + by_offset * px, gradient[i, 8] + by_offset * py, gradient[i, 9] + by_offset * pz
        # The normal is sign * t / square, t and the square being quadratic in the quaternion.
        along, twice = gx * nx + gy * ny + gz * nz, 2.0 * over
        gx, gy, gz = sign * gx, sign * gy, sign * gz
        of_quats[i, 0] = twice * (gx * y - gy * x + gz * w - along * w)
        of_quats[i, 1] = twice * (gx * z - gy * w - gz * x - along * x)
        of_quats[i, 2] = twice * (gx * w + gy * z - gz * y - along * y)
        of_quats[i, 3] = twice * (gx * x + gy * y + gz * z - along * z)


SHAPES: dict[str, tuple[int, ...]] = {
    "means": (3,),
    "quats": (4,),
    "log_scales": (2,),
    "opacity_logits": (),
    "sh": (N_HARMONICS, 3),
    "reflectivity_logits": (),
    "f0_logits": (3,),
}
"""What is learned, and its shape for one splat. Ellipsoids have three `log_scales`; other names may join."""

FEATURES = {"colour": slice(0, 3), "reflectivity": slice(3, 4), "f0": slice(4, 7), "normal": slice(7, 10)} | {
    "offset": slice(10, 11)
}
"""Columns of `Splats.features`."""

NO_PANEL = -1
"""Panel of splats that are not glass."""

LEAST_SHARE, MOST_SHARE = 1e-4, 1.0 - 1e-4
"""Shares are kept off 0 and 1, where logits have no end."""


class Splats(nn.Module):
    """n surfels, or ellipsoids.

    Parameters
    ----------
    values
        All of `SHAPES` by name, each with n rows, float32 (or float64 in tests):

        - `means`: middles, metres, in the model's frame (ENU less the model's origin).
        - `quats`: w, x, y, z, of any length but zero: columns of the rotation are t_u, t_v and the normal (Eq. 12).
        - `log_scales`: ln s_u, ln s_v, metres; of ellipsoids ln s_w, along the normal, too.
        - `opacity_logits`, `reflectivity_logits`, `f0_logits`: alpha, r and f_0 before the sigmoid.
        - `sh`: display colour by direction (`harmonic_colour`).

        Others are attributes of a method's shading; they are kept, and densified, with the rest.
    panels
        Shape (n,): which panel, from 0, or `NO_PANEL`. Only glass reflects: r is 0 elsewhere.
    """

    means: nn.Parameter
    quats: nn.Parameter
    log_scales: nn.Parameter
    opacity_logits: nn.Parameter
    sh: nn.Parameter
    reflectivity_logits: nn.Parameter
    f0_logits: nn.Parameter
    panels: Tensor

    def __init__(self, values: Mapping[str, Tensor], panels: Tensor) -> None:
        super().__init__()
        for name, shape in expected_shapes(values).items():
            if values[name].shape != (len(panels), *shape):
                raise ValueError(f"{name}: expected shape {(len(panels), *shape)}, got {tuple(values[name].shape)}")
            self.register_parameter(name, nn.Parameter(values[name].detach().clone().contiguous()))
        self.names = (*SHAPES, *(name for name in values if name not in SHAPES))
        self.register_buffer("panels", panels.detach().to(torch.int32).clone())

    @classmethod
    def of(
        cls,
        means: Tensor,
        quats: Tensor,
        scales: Tensor,
        opacities: Tensor,
        colours: Tensor,
        panels: Tensor | None = None,
        reflectivity: float = REFLECTIVITY,
        f0: float = BASE_REFLECTANCE,
    ) -> Splats:
        """Splats that look alike from all sides.

        Parameters
        ----------
        means, quats, scales, opacities
            Shapes (n, 3), (n, 4), (n, 2) above 0 in metres, and (n,), 0 to 1.
        colours
            Display values (sRGB), shape (n, 3), 0 to 1.
        """
        n = len(means)
        values = {
            "means": means,
            "quats": quats,
            "log_scales": torch.log(scales),
            "opacity_logits": logit(opacities),
            "sh": flat_harmonics(colours),
            "reflectivity_logits": torch.full((n,), math.log(reflectivity / (1.0 - reflectivity))).to(means),
            "f0_logits": torch.full((n, 3), math.log(f0 / (1.0 - f0))).to(means),
        }
        return cls(values, torch.full((n,), NO_PANEL) if panels is None else panels)

    def __len__(self) -> int:
        return len(self.means)

    @property
    def is_flat(self) -> bool:
        """Whether they are discs, and no ellipsoids."""
        return self.log_scales.shape[1] == FLAT

    @property
    def scales(self) -> Tensor:
        """Standard deviations along the columns of the rotations, metres, shape (n, 2), or (n, 3) of ellipsoids."""
        return torch.exp(self.log_scales)

    @property
    def opacities(self) -> Tensor:
        """Shape (n,), 0 to 1."""
        return torch.sigmoid(self.opacity_logits)

    @property
    def reflectivity(self) -> Tensor:
        """Shape (n,), 0 to 1; 0 where it is not glass."""
        return torch.sigmoid(self.reflectivity_logits) * (self.panels >= 0)

    @property
    def f0(self) -> Tensor:
        """Reflectance at normal incidence, shape (n, 3), 0 to 1."""
        return torch.sigmoid(self.f0_logits)

    def some(self, rows: Tensor) -> Splats:
        """A copy of some of them, by their numbers or by a mask, shape (n,)."""
        if rows.dtype == torch.bool:
            rows = rows.nonzero()[:, 0]
        # A third of the time of plain indexing: whole rows, by all threads.
        values = {name: self.get_parameter(name).detach().index_select(0, rows) for name in self.names}
        return Splats(values, self.panels.index_select(0, rows))

    def attribute(self, name: str) -> Tensor:
        """What a method's shading has beside `SHAPES`, as it is learned."""
        return self.get_parameter(name)

    def normals(self, view_position: Tensor) -> Tensor:
        """Unit normals, shape (n, 3), turned to a camera at `view_position`, shape (3,)."""
        return self._facing(view_position)[0]

    def colours(self, view_position: Tensor, degree: int = 3) -> Tensor:
        """Linear light that goes from the splats to a camera, shape (n, 3), 0 or more.

        Parameters
        ----------
        degree
            Of the harmonics that are used, 0 to 3.
        """
        return seen_light(self.means, self.sh, view_position, degree)

    def features(self, view_position: Tensor, degree: int = 3, colours: Tensor | None = None) -> Tensor:
        """What is blended into the pictures (Eqs. 15 to 18), shape (n, 11), columns as `FEATURES` says.

        The last one is the offset n . p of the splat's plane, p from the camera: rays of direction d meet a blended
        plane at offset / (n . d). Which panel a pixel shows is no feature: numbers of panels cannot be mixed.

        Parameters
        ----------
        colours
            Shape (n, 3), in the place of those by harmonics.
        """
        colours = self.colours(view_position, degree) if colours is None else colours
        if self.is_flat and self.means.device.type == "cpu" and self.means.dtype == torch.float32:
            return disc_features(
                colours, self.means, self.quats, self.reflectivity_logits, self.f0_logits, self.panels, view_position
            )
        return self.features_reference(view_position, colours)

    def features_reference(self, view_position: Tensor, colours: Tensor) -> Tensor:
        """What `features` says, in plain torch, of any type on any device, of ellipsoids, too."""
        normals, offsets = self._facing(view_position)
        parts = (colours, self.reflectivity[:, None], self.f0, normals, offsets[:, None])
        return torch.cat(parts, dim=1)

    def _facing(self, view_position: Tensor) -> tuple[Tensor, Tensor]:
        """Normals turned to the camera, and their planes' offsets from it, which are 0 or less."""
        from_camera = self.means - view_position.detach().to(self.means)
        if not self.is_flat:
            normals = shortest_axes(self.means, self.quats, self.log_scales, view_position)
            return normals, (normals * from_camera).sum(dim=-1)
        normals = normals_of(self.quats)
        offsets = (normals * from_camera).sum(dim=-1)
        signs = torch.where(offsets.detach() > 0.0, -1.0, 1.0).to(normals)
        return normals * signs[:, None], offsets * signs


def normals_of(quats: Tensor) -> Tensor:
    """Third column of the rotations of quaternions (w, x, y, z) of any length, shape (n, 3), unit.

    Of those as good as zero it is (0, 0, 1), with no gradient.
    """
    w, x, y, z = quats.unbind(dim=-1)
    square = w * w + x * x + y * y + z * z
    is_turned = square > LEAST_SQUARE
    safe = torch.where(is_turned, square, torch.ones_like(square))
    turned = torch.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z], dim=-1)
    up = torch.zeros_like(turned)
    up[:, 2] = 1.0
    return torch.where(is_turned[:, None], turned / safe[:, None], up)


def logit(shares: Tensor) -> Tensor:
    """Inverse of the sigmoid, of shares that are kept a little off 0 and 1."""
    return torch.logit(shares.clamp(LEAST_SHARE, MOST_SHARE))


def splats_to_tensors(splats: Splats) -> dict[str, Tensor]:
    """Everything that splats are, by name, for a safetensors file."""
    return {name: value.detach().cpu().contiguous() for name, value in splats.state_dict().items()}


def splats_from_tensors(tensors: Mapping[str, Tensor], place: str) -> Splats:
    """What `splats_to_tensors` gave, the same bits.

    Parameters
    ----------
    place
        Where they are from, for messages.

    Raises
    ------
    InputError
        One is missing, has another shape or type, or numbers that are not finite.
    """
    n = len(tensors["means"]) if "means" in tensors and tensors["means"].ndim else 0
    for name in (*SHAPES, "panels"):
        if name not in tensors:
            raise InputError(say("has no '{}' of splats; it is damaged, or of another program", name, place=place))
    parameters = {name: value for name, value in tensors.items() if name != "panels"}
    for name, shape in (expected_shapes(parameters) | {"panels": ()}).items():
        found = tensors[name]
        if tuple(found.shape) != (n, *shape):
            raise InputError(
                say("expected shape {}, found {}", (n, *shape), tuple(found.shape), place=f"{place}: {name}")
            )
        if found.dtype != (torch.int32 if name == "panels" else torch.float32):
            raise InputError(say("expected float32 (panels: int32), found {}", found.dtype, place=f"{place}: {name}"))
        if not bool(torch.isfinite(found).all()):
            raise InputError(say("holds numbers that are not finite; train again", place=f"{place}: {name}"))
    if bool((tensors["panels"] < NO_PANEL).any()):
        raise InputError(
            say("panels: expected numbers from {} on, found {}", NO_PANEL, int(tensors["panels"].min()), place=place)
        )
    return Splats(parameters, tensors["panels"])


def expected_shapes(values: Mapping[str, Tensor]) -> dict[str, tuple[int, ...]]:
    """Shapes that parameters should have for one splat: of `SHAPES`, or three sizes; all others' are their own."""
    shapes = {name: tuple(value.shape[1:]) for name, value in values.items()} | SHAPES
    sizes = values["log_scales"].shape
    return shapes | {"log_scales": (SOLID,)} if sizes[1:] == (SOLID,) else shapes
