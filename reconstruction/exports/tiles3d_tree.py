"""How a component's Gaussians are shared among tiles: halves, by space, until each has few enough.

Panels stay whole. Tiles that are shared out have merged Gaussians of their own (`coarser_parts`): some of a building's
would look like one with holes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reconstruction.exports.component_parts import ellipsoid_blocks, extents_m
from reconstruction.objects.gs_scene import GsComponent, GsGaussian, GsScene

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Axis-aligned, ENU metres, shapes (3,)."""

    low: Array
    high: Array

    @property
    def diagonal_m(self) -> float:
        """From corner to corner."""
        return float(np.linalg.norm(self.high - self.low))

    def with_others(self, *others: Box) -> Box:
        """The smallest box around it and others."""
        boxes = (self, *others)
        return Box(np.min([box.low for box in boxes], axis=0), np.max([box.high for box in boxes], axis=0))


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """Gaussians that lie together: those of `part`, or those of two branches.

    Parameters
    ----------
    items
        Numbers of elements of a facade, or rows of the background, ascending.
    """

    items: NDArray[np.int64]
    halves: tuple[Branch, ...]


def branches_of(component: GsComponent, at_most: int) -> Branch:
    """A tree whose leaves have `at_most` Gaussians, or a single panel."""
    if component.kind == "facade":
        places = np.array([np.mean(element.corners_enu_m, axis=0) for element in component.elements]).reshape(-1, 3)
        weights = np.array([element.n_gaussians for element in component.elements], np.int64)
        items = np.flatnonzero(weights)
    else:
        places = component.gaussians.values["means"]
        weights = np.ones(len(places), np.int64)
        items = np.arange(len(places))
    return _branch(items, places, weights, at_most)


def _branch(items: NDArray[np.int64], places: NDArray[np.floating], weights: NDArray[np.int64], at_most: int) -> Branch:
    if len(items) < 2 or weights[items].sum() <= at_most:
        return Branch(items, ())
    within = places[items]
    axis = int(np.argmax(np.ptp(within, axis=0)))
    order = items[np.argsort(within[:, axis], kind="stable")]
    so_far = np.cumsum(weights[order])
    cut = int(np.clip(np.searchsorted(so_far, so_far[-1] / 2) + 1, 1, len(order) - 1))
    halves = (np.sort(order[:cut]), np.sort(order[cut:]))
    return Branch(items, tuple(_branch(half, places, weights, at_most) for half in halves))


def part_of_branch(component: GsComponent, branch: Branch) -> GsComponent:
    """A component of a branch's Gaussians alone: a copy."""
    if component.kind == "background":
        elements, rows = (), branch.items
    else:
        chosen = [component.elements[number] for number in branch.items]
        stops = np.cumsum([element.n_gaussians for element in chosen]).tolist()
        elements = tuple(
            replace(element, start=stop - element.n_gaussians, stop=stop)
            for element, stop in zip(chosen, stops, strict=True)
        )
        rows = np.concatenate([branch.items[:0], *(np.arange(element.start, element.stop) for element in chosen)])
    table = component.gaussians
    values = {name: value[rows] for name, value in table.values.items()}
    gaussians = GsGaussian(values, table.places[rows])
    return GsComponent(component.global_id, component.name, component.kind, elements, gaussians)


def box_of_gaussians(component: GsComponent, scene: GsScene) -> Box:
    """Around all that is drawn of a component's Gaussians, one at least."""
    origin = np.array(scene.origin_enu_m)
    boxes = list(_boxes(component))
    around = boxes[0].with_others(*boxes[1:])
    return Box(around.low + origin, around.high + origin)


def box_of_panels(component: GsComponent) -> Box:
    """Around the panels of a component, one at least."""
    corners = np.array([element.corners_enu_m for element in component.elements], np.float64).reshape(-1, 3)
    return Box(corners.min(axis=0), corners.max(axis=0))


def _boxes(component: GsComponent) -> Iterator[Box]:
    for _, block in ellipsoid_blocks(component):
        means, extents = block.means_m.astype(np.float64), extents_m(block)
        yield Box((means - extents).min(axis=0), (means + extents).max(axis=0))
