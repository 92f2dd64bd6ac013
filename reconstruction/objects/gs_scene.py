"""Objects of a Gaussian model (paper 3.4): scene, components, elements, Gaussians, and what rendering needs besides.

Facades have four layers (scene, component, element, Gaussians), the background has three. Gaussians of a component lie
in one table, those of its first element first, so that an element is a range of rows, and a facade or a panel can be
had without the rest. Nothing is lost: each row knows its place in the model, and `organise` puts the model together
again, bit by bit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import Origin, Vec3

Array = NDArray[Any]

Kind = Literal["facade", "background"]


@dataclass(frozen=True, slots=True, eq=False)
class GsGaussian:
    """Gaussian primitives: all of a component, or those of one element.

    Parameters
    ----------
    values
        What `Splats` has by name, n rows each, float32: `means` in metres, ENU less the scene's `origin_enu_m`, `quats`
        (w, x, y, z), `log_scales` (two, or three of ellipsoids), `opacity_logits`, `sh` (16, 3), `reflectivity_logits`,
        `f0_logits` (3,), and what a method's shading adds.
    places
        Row that each had in the model, shape (n,), int32.
    """

    values: Mapping[str, NDArray[np.float32]]
    places: NDArray[np.int32]

    def __post_init__(self) -> None:
        for name, value in self.values.items():
            if len(value) != len(self.places):
                raise ValueError(f"{name}: expected {len(self.places)} rows, got {len(value)}")

    def __len__(self) -> int:
        return len(self.places)

    def part(self, start: int, stop: int) -> GsGaussian:
        """Rows from `start` to before `stop`; no copy."""
        return GsGaussian({name: value[start:stop] for name, value in self.values.items()}, self.places[start:stop])


@dataclass(frozen=True, slots=True)
class GsElement:
    """A panel.

    Parameters
    ----------
    global_id
        IFC GlobalId, of the building model where the site came from one.
    name
        Of the panel in its site.
    panel
        Its number in the model, from 0: what maps of panels show.
    corners_enu_m
        Counter-clockwise seen from outside.
    start, stop
        Rows of its component's Gaussians.
    """

    global_id: str
    name: str
    panel: int
    corners_enu_m: tuple[Vec3, Vec3, Vec3, Vec3]
    start: int
    stop: int

    def __post_init__(self) -> None:
        if not 0 <= self.start <= self.stop:
            raise ValueError(f"start, stop: expected 0 <= start <= stop, got {self.start} and {self.stop}")
        if self.panel < 0:
            raise ValueError(f"panel: expected a number from 0 on, got {self.panel}")

    @property
    def n_gaussians(self) -> int:
        """How many it has."""
        return self.stop - self.start


@dataclass(frozen=True, slots=True, eq=False)
class GsComponent:
    """A facade with its panels, or the background, which has no elements.

    Parameters
    ----------
    gaussians
        Those of the elements first, in their order; a facade has no others.
    """

    global_id: str
    name: str
    kind: Kind
    elements: tuple[GsElement, ...]
    gaussians: GsGaussian

    def __post_init__(self) -> None:
        end = 0
        for element in self.elements:
            if element.start != end:
                raise ValueError(f"elements: '{element.name}' begins at row {element.start}, expected {end}")
            end = element.stop
        if self.kind == "facade" and end != len(self.gaussians):
            raise ValueError(f"gaussians: expected {end} rows, as the elements have, got {len(self.gaussians)}")
        if self.kind == "background" and self.elements:
            raise ValueError("elements: expected none of the background")


@dataclass(frozen=True, slots=True, eq=False)
class GsAuxiliary:
    """What rendering needs beside Gaussians: weights of a network, a grid of light, a sky.

    Parameters
    ----------
    name
        `sky`, `reflection`, `shading` or `camera`.
    tensors
        By their names in the model.
    """

    name: str
    tensors: Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class GsScene:
    """A model as objects, or as many of its components as were asked for.

    Parameters
    ----------
    name
        Of the site.
    origin
        Of the site's ENU frame on Earth, where it is known.
    origin_enu_m
        Of the means, in the site's frame.
    training
        How the model came about, as plain values: the content of `model.json`.
    n_gaussians
        Of all components, also of those that are not here.
    """

    global_id: str
    name: str
    origin: Origin | None
    origin_enu_m: Vec3
    components: tuple[GsComponent, ...]
    auxiliary: tuple[GsAuxiliary, ...]
    training: Mapping[str, Any]
    n_gaussians: int = field(default=0)

    @property
    def is_whole(self) -> bool:
        """Whether all components are here."""
        return sum(len(component.gaussians) for component in self.components) == self.n_gaussians

    @property
    def elements(self) -> Iterator[tuple[GsComponent, GsElement]]:
        """Of all components, with theirs."""
        return ((component, element) for component in self.components for element in component.elements)

    @cached_property
    def _by_global_id(self) -> Mapping[str, tuple[GsComponent, GsElement]]:
        return {element.global_id: (component, element) for component, element in self.elements}

    def element(self, global_id: str) -> tuple[GsComponent, GsElement]:
        """An element by its GlobalId, with its component; raises `KeyError`."""
        return self._by_global_id[global_id]
