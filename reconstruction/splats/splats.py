"""Splats: Gaussian discs with what the paper adds to them, as the parameters of a model (paper 3.3.2).

Methods that the paper is compared with have ellipsoids in their place, which have a third size, or further attributes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import torch
from torch import Tensor, nn

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.light.shading import BASE_REFLECTANCE, REFLECTIVITY
from reconstruction.splats.ellipsoid_axes import shortest_axes
from reconstruction.splats.harmonic_colour import N_HARMONICS, flat_harmonics, seen_light
from reconstruction.splats.rasterising.disc_features import LEAST_SQUARE, disc_features
from reconstruction.splats.rasterising.raster_types import FLAT, SOLID

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
        return self.features_twin(view_position, colours)

    def features_twin(self, view_position: Tensor, colours: Tensor) -> Tensor:
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
