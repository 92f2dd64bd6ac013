"""Objects that records belong to, as the model names them, and those of a site that has no model yet."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from planning.base.errors import InputError
from planning.base.messages import about, say
from planning.geo.frames import Vec3
from planning.site.records import Panel, Site, check_point
from reconstruction.records.entries import check_global_id, global_id_of, is_global_id
from reconstruction.records.limits import check_choice, check_text

Layer = Literal["scene", "component", "element"]
LAYERS: tuple[Layer, ...] = ("scene", "component", "element")
Corners = tuple[Vec3, Vec3, Vec3, Vec3]

MAX_OBJECTS = 1_000_000


@dataclass(frozen=True, slots=True)
class ObjectRow:
    """One object of a model.

    Parameters
    ----------
    parent
        GlobalId of the object one layer up, or None.
    name
        Such as `A-0012`.
    corners_enu_m
        Of an element that is a pane, counter-clockwise from outside; else None.
    """

    global_id: str
    layer: Layer
    parent: str | None
    name: str
    corners_enu_m: Corners | None = None

    def __post_init__(self) -> None:
        check_global_id(self.global_id, "global_id")
        check_choice(self.layer, "layer", LAYERS)
        check_text(self.name, "name", required=True)
        if self.parent is not None:
            check_global_id(self.parent, "parent")
        if self.corners_enu_m is not None:
            if len(self.corners_enu_m) != 4 or any(len(corner) != 3 for corner in self.corners_enu_m):
                raise InputError(
                    say("expected four points of an element, '{}' has others", self.name, place="corners_enu_m")
                )
            try:
                for corner in self.corners_enu_m:
                    check_point(corner, "corners_enu_m")
            except ValueError as error:
                raise InputError(about(f"'{self.name}'", error)) from error

    @property
    def width_m(self) -> float | None:
        """Mean length of the edges c0 c1 and c3 c2; None without corners."""
        return self._mean_edge(((0, 1), (3, 2)))

    @property
    def height_m(self) -> float | None:
        """Mean length of the edges c0 c3 and c1 c2; None without corners."""
        return self._mean_edge(((0, 3), (1, 2)))

    def _mean_edge(self, edges: tuple[tuple[int, int], tuple[int, int]]) -> float | None:
        if self.corners_enu_m is None:
            return None
        corners = np.array(self.corners_enu_m)
        return float(np.mean([np.linalg.norm(corners[a] - corners[b]) for a, b in edges]))


def check_objects(rows: Iterable[ObjectRow]) -> tuple[ObjectRow, ...]:
    """Objects of one model, parents before their parts.

    Raises
    ------
    InputError
        A GlobalId occurs twice, or a parent is no object of the layer above.
    """
    by_layer = tuple(sorted(rows, key=lambda row: LAYERS.index(row.layer)))
    if len(by_layer) > MAX_OBJECTS:
        raise InputError(say("expected at most {} objects, got {}", MAX_OBJECTS, len(by_layer)))
    layers: dict[str, Layer] = {}
    for row in by_layer:
        if row.global_id in layers:
            raise InputError(say("'{}': another object has its GlobalId {} already", row.name, row.global_id))
        above = None if row.parent is None else layers.get(row.parent)
        if row.parent is not None and (above is None or LAYERS.index(above) + 1 != LAYERS.index(row.layer)):
            raise InputError(
                say("'{}': its parent {} is no object of the layer above '{}'", row.name, row.parent, row.layer)
            )
        layers[row.global_id] = row.layer
    return by_layer


def site_objects(site: Site) -> tuple[ObjectRow, ...]:
    """Objects of a site: itself, its facades, their panels.

    A panel that came from IFC keeps its GlobalId; one without, or whose source stands for several panels, has one that
    follows from the names of site and panel. They are those that a model of the site has (`objects.organise`).
    """
    counts = Counter(panel.source_id for panel in site.panels)
    shared = {source for source, count in counts.items() if count > 1}
    scene = global_id_of(site.name, "scene")
    rows = [ObjectRow(scene, "scene", None, site.name)]
    for facade in site.facades:
        component = global_id_of(site.name, f"component {facade.id}")
        rows.append(ObjectRow(component, "component", scene, facade.id))
        rows += [
            ObjectRow(_panel_id(site, panel, shared), "element", component, panel.id, panel.corners_enu_m)
            for panel in facade.panels
        ]
    return check_objects(rows)


def _panel_id(site: Site, panel: Panel, shared: set[str | None]) -> str:
    source = panel.source_id
    if source is not None and source not in shared and is_global_id(source):
        return source
    return global_id_of(site.name, f"panel {panel.id}")
