"""Removing and renaming what a user points at on a site; see `site_edits`."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import (
    check_new_name,
    index_of,
    obstacle_ids,
    rally_ids,
    with_rally_points,
    with_site,
    with_zones,
)
from groundstation.services.site.panel_edits import with_facades
from planning.base.messages import say
from planning.site.records import Facade, NoFlyZone, Obstacle, Panel, RallyPoint, Site, SiteModel

Named = TypeVar("Named", Obstacle, NoFlyZone, Panel, RallyPoint)

REMOVABLE = frozenset({ItemKind.OBSTACLE, ItemKind.NO_FLY, ItemKind.FACADE, ItemKind.PANEL, ItemKind.RALLY})
"""Kinds of things that have a name of their own and that a site can do without."""


def remove_item(model: SiteModel, item: Item) -> SiteModel:
    """Without a facade, panel, obstacle, no-fly zone or rally point.

    Raises
    ------
    InputError
        The site would be left without panels and building.
    ValueError
        The site has no such thing, or it is of a kind that cannot be removed.
    """
    site = model.site
    match item.kind:
        case ItemKind.OBSTACLE:
            index = index_of(obstacle_ids(model), item.id, "obstacle")
            obstacles = site.obstacles[:index] + site.obstacles[index + 1 :]
            return with_site(
                model, replace(site, obstacles=obstacles), model.obstacles[:index] + model.obstacles[index + 1 :]
            )
        case ItemKind.NO_FLY:
            index = index_of((zone.id for zone in site.airspace.no_fly), item.id, say("no-fly zone"))
            return with_zones(model, site.airspace.no_fly[:index] + site.airspace.no_fly[index + 1 :])
        case ItemKind.FACADE:
            index = index_of((facade.id for facade in site.facades), item.id, "facade")
            return with_facades(model, site.facades[:index] + site.facades[index + 1 :])
        case ItemKind.PANEL:
            index = _facade_of(site, item.id)
            rest = tuple(panel for panel in site.facades[index].panels if panel.id != item.id)
            facade = (replace(site.facades[index], panels=rest),) if rest else ()
            return with_facades(model, site.facades[:index] + facade + site.facades[index + 1 :])
        case ItemKind.RALLY:
            index = index_of(rally_ids(model), item.id, say("rally point"))
            return with_rally_points(model, site.rally_points[:index] + site.rally_points[index + 1 :])
        case _:
            raise ValueError(f"a site always has its {item.kind}")


def rename_item(model: SiteModel, item: Item, name: str) -> SiteModel:
    """With another name for what has one; panels called after their facade follow it.

    Raises
    ------
    InputError
        The name is empty or taken.
    ValueError
        The site has no such thing, or it is of a kind that has no name.
    """
    name, site = name.strip(), model.site
    if name == item.id:
        return model
    match item.kind:
        case ItemKind.OBSTACLE:
            check_new_name(name, obstacle_ids(model), "obstacle")
            return with_site(model, replace(site, obstacles=_renamed(site.obstacles, item.id, name, "obstacle")))
        case ItemKind.NO_FLY:
            check_new_name(name, (zone.id for zone in site.airspace.no_fly), say("no-fly zone"))
            return with_zones(model, _renamed(site.airspace.no_fly, item.id, name, say("no-fly zone")))
        case ItemKind.FACADE:
            check_new_name(name, (facade.id for facade in site.facades), "facade")
            index = index_of((facade.id for facade in site.facades), item.id, "facade")
            facade = Facade(name, tuple(_following(panel, item.id, name) for panel in site.facades[index].panels))
            return with_facades(model, (*site.facades[:index], facade, *site.facades[index + 1 :]))
        case ItemKind.PANEL:
            check_new_name(name, (panel.id for panel in site.panels), "panel")
            index = _facade_of(site, item.id)
            panels = _renamed(site.facades[index].panels, item.id, name, "panel")
            facade = replace(site.facades[index], panels=panels)
            return with_facades(model, (*site.facades[:index], facade, *site.facades[index + 1 :]))
        case ItemKind.RALLY:
            check_new_name(name, rally_ids(model), say("rally point"))
            return with_rally_points(model, _renamed(site.rally_points, item.id, name, say("rally point")))
        case _:
            raise ValueError(f"the {item.kind} of a site has no name")


def _renamed(things: tuple[Named, ...], old: str, new: str, kind: str) -> tuple[Named, ...]:
    index = index_of((thing.id for thing in things), old, kind)
    return things[:index] + (replace(things[index], id=new),) + things[index + 1 :]  # noqa: RUF005  (mypy)


def _following(panel: Panel, old: str, new: str) -> Panel:
    """The panel with its facade's new name, where it bears the old one."""
    rest = panel.id.removeprefix(f"{old}-")
    return panel if rest == panel.id else replace(panel, id=f"{new}-{rest}")


def _facade_of(site: Site, panel_id: str) -> int:
    for index, facade in enumerate(site.facades):
        if any(panel.id == panel_id for panel in facade.panels):
            return index
    raise ValueError(f"there is no panel '{panel_id}' on this site")
