"""Edits of a site's glass: a grid of panels on the building, a facade turned round; see `site_edits`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from groundstation.services.project.document import first_free
from groundstation.services.site.edits import index_of, input_checked, with_site
from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Vec3
from planning.site.bundled import Rectangle
from planning.site.importing.facades import facade_name
from planning.site.importing.options import ImportOptions
from planning.site.importing.panel_grid import panels_on_building
from planning.site.records import Facade, Panel, Site, SiteModel


class AddedGrid(NamedTuple):
    """A site with one facade more, the facade's name, and what is worth knowing about its panels."""

    model: SiteModel
    facade_id: str
    notes: tuple[str, ...]


def add_panel_grid(
    model: SiteModel,
    rectangle_enu_m: Rectangle,
    n_rows: int,
    n_columns: int,
    gap_m: float = 0.0,
    tolerance_m: float = ImportOptions().grid_tolerance_m,
) -> AddedGrid:
    """With one facade more, of equal panels in a rectangle on the building.

    Parameters
    ----------
    rectangle_enu_m
        Lower left, lower right and upper left corner as seen from outside.
    gap_m
        Width of the mullions between neighbouring panels.
    tolerance_m
        Largest distance of the panels from the building.

    Raises
    ------
    PanelGridError
        As `planning.site.importing.panel_grid.panels_on_building`.
    InputError
        A panel would be no panel, such as one too far away.
    """
    found = panels_on_building(np.array(rectangle_enu_m), (n_rows, n_columns), gap_m, model.building, tolerance_m)
    name = _free_facade_name(model.site)
    with input_checked():
        panels = tuple(
            Panel(f"{name}-{number:04d}", (_corner(a), _corner(b), _corner(c), _corner(d)))
            for number, (a, b, c, d) in enumerate(found.corners.tolist())
        )
        site = replace(model.site, facades=(*model.site.facades, Facade(name, panels)))
    return AddedGrid(with_site(model, site), name, found.notes)


def _corner(point: Sequence[float]) -> Vec3:
    """A corner rounded to 0.1 mm, as in imported sites."""
    x, y, z = (round(value, 4) for value in point)
    return x, y, z


def _free_facade_name(site: Site) -> str:
    """The first letter that neither a facade nor the panels of a renamed one use."""
    taken = {facade.id for facade in site.facades} | {panel.id.rpartition("-")[0] for panel in site.panels}
    return first_free(lambda number: facade_name(number - 1), taken)


def with_facades(model: SiteModel, facades: Iterable[Facade]) -> SiteModel:
    """With other facades.

    Raises
    ------
    InputError
        No panel is left, and there is no building on which others could be found.
    """
    kept = tuple(facades)
    if model.site.building_mesh is None and not any(facade.panels for facade in kept):
        raise InputError(
            say("panels: a site without a building needs at least one panel; add the new ones first, then remove these")
        )
    with input_checked():
        site = replace(model.site, facades=kept)
    return with_site(model, site)


def flip_facade(model: SiteModel, facade_id: str) -> SiteModel:
    """With a facade that looks the other way; each panel still begins at its lower left corner seen from outside."""

    def flipped(panel: Panel) -> Panel:
        a, b, c, d = panel.corners_enu_m
        return replace(panel, corners_enu_m=(b, a, d, c))

    index = index_of((facade.id for facade in model.site.facades), facade_id, "facade")
    facades = list(model.site.facades)
    facades[index] = replace(facades[index], panels=tuple(flipped(panel) for panel in facades[index].panels))
    return with_facades(model, facades)
