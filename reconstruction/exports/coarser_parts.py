"""Parts of a component with fewer Gaussians, each in the place of some that lie together: for pictures from afar."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from reconstruction.objects.gs_scene import GsComponent, GsGaussian
from reconstruction.splatting.merged_splats import splats_of_detail
from reconstruction.splatting.splats import NO_PANEL, Splats

NO_PLACE = -1
"""Of merged Gaussians, which are not in the model."""


@dataclass(frozen=True, slots=True, eq=False)
class CoarserPart:
    """Of a component.

    Parameters
    ----------
    side_m
        Of the cubes in which Gaussians were merged: what is finer is lost.
    """

    component: GsComponent
    side_m: float


def coarser_part(parts: Sequence[GsComponent], at_most: int) -> CoarserPart | None:
    """Parts of one component in one, with its Gaussians merged until `at_most` are left; panels stay apart.

    None where so few would not do: panels that are too many, or too few Gaussians to begin with.

    Parameters
    ----------
    parts
        One at least; none has an element of another.
    """
    elements = [element for part in parts for element in part.elements]
    tables = [part.gaussians.values for part in parts]
    values = {name: torch.from_numpy(np.concatenate([table[name] for table in tables])) for name in tables[0]}
    owners = np.full(sum(len(part.gaussians) for part in parts), NO_PANEL, np.int64)
    stops = np.cumsum([element.n_gaussians for element in elements], dtype=np.int64)
    if elements:
        # Facades have no Gaussians but those of elements.
        owners[:] = np.repeat(np.arange(len(elements)), np.diff(stops, prepend=0))
    detail = splats_of_detail(Splats(values, torch.from_numpy(owners)))
    found = detail.tree.finest_cut(at_most)
    if found is None:
        return None
    rows, side_m = found
    owners = detail.all.panels.numpy()[rows]
    order = np.argsort(owners, kind="stable")
    merged = detail.all.some(torch.from_numpy(rows[order]))
    stops = np.searchsorted(owners[order], np.arange(len(elements)), side="right").tolist()
    starts = [0, *stops[:-1]] if stops else []
    table = {name: merged.get_parameter(name).detach().numpy() for name in values}
    component = GsComponent(
        parts[0].global_id,
        parts[0].name,
        parts[0].kind,
        tuple(
            replace(element, start=start, stop=stop)
            for element, start, stop in zip(elements, starts, stops, strict=True)
        ),
        GsGaussian(table, np.full(len(merged), NO_PLACE, np.int32)),
    )
    return CoarserPart(component, side_m)
