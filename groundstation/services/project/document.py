"""The document: everything that is open in the window at one moment, as one frozen value.

Edits make a new document; the history keeps the old ones, which is what undo needs. Documents share whatever did not
change, so that hundreds of them cost little more than one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from planning.plan import Plan, Sortie, Viewpoint
from planning.request import PlanRequest
from planning.site.records import SiteModel
from planning.site.zones.keep_out import near_zones
from reconstruction.panels.solving.accuracy import FoundFacades


class ItemKind(StrEnum):
    """Kinds of things on a site or in a plan that a user can point at."""

    BUILDING = "building"
    FACADE = "facade"
    PANEL = "panel"
    OBSTACLE = "obstacle"
    NO_FLY = "no-fly"
    ZONE = "geo-zone"
    ZONE_FILE = "zone-file"
    AIRSPACE = "airspace"
    HOME = "home"
    RALLY = "rally"
    VIEWPOINT = "viewpoint"
    SORTIE = "sortie"
    LEG = "leg"


@dataclass(frozen=True, slots=True)
class Item:
    """One thing that is pointed at, by its kind and the identifier it has in the site or plan file.

    Geo-zones are named by file and zone ("zones.json/CTR7"), sorties by their number from 1 ("2"), legs by sortie and
    leg, both from 1 ("2/5"); building, airspace and home have no identifier.
    """

    kind: ItemKind
    id: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class PlanEntry:
    """One plan of a project.

    Parameters
    ----------
    id
        Unique in the project; also the stem of its file.
    title
        As the user knows it.
    request
        What was asked for, so that it can be planned again; None for plans that came from files.
    bound_for_views
        See `planning.planner.Planned`.
    """

    id: str
    title: str
    plan: Plan
    request: PlanRequest | None = None
    bound_for_views: float | None = None

    def viewpoint(self, viewpoint_id: str) -> Viewpoint | None:
        """A viewpoint of the plan by its identifier."""
        return next((found for found in self.plan.viewpoints if found.id == viewpoint_id), None)


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """A site, the plans made for it, which of them is worked on, and what the next one is wanted to be.

    Parameters
    ----------
    current_plan_id
        Identifier of the plan that is shown; empty for none.
    request
        What the plan form says.
    site_source
        File that the site was read from; None where it comes from none, as after an import.
    found_facades
        How good the panels are that were found in photos; None where none were.
    """

    site: SiteModel | None = None
    plans: tuple[PlanEntry, ...] = ()
    current_plan_id: str = ""
    request: PlanRequest = PlanRequest()
    site_source: Path | None = None
    found_facades: FoundFacades | None = None

    def __post_init__(self) -> None:
        ids = [entry.id for entry in self.plans]
        if len(set(ids)) != len(ids):
            raise ValueError(f"plans: expected unique ids, got {ids}")
        if self.current_plan_id and self.current_plan_id not in ids:
            raise ValueError(f"current_plan_id: there is no plan '{self.current_plan_id}'")

    @property
    def current(self) -> PlanEntry | None:
        """The plan that is shown."""
        return self.entry(self.current_plan_id)

    def entry(self, plan_id: str) -> PlanEntry | None:
        """A plan by its identifier."""
        return next((found for found in self.plans if found.id == plan_id), None)

    def with_plan(self, entry: PlanEntry) -> Document:
        """With a plan added, or put in the place of the one with its identifier; it becomes the current one."""
        known = self.entry(entry.id)
        plans = (
            (*self.plans, entry) if known is None else tuple(entry if old.id == entry.id else old for old in self.plans)
        )
        return replace(self, plans=plans, current_plan_id=entry.id)

    def without_plan(self, plan_id: str) -> Document:
        """Without one plan; the last of the others becomes current where it was."""
        plans = tuple(entry for entry in self.plans if entry.id != plan_id)
        current = self.current_plan_id
        if current == plan_id:
            current = plans[-1].id if plans else ""
        return replace(self, plans=plans, current_plan_id=current)

    def free_plan_id(self) -> str:
        """Identifier for a new plan: plan-1, plan-2 and so on, higher than all that there are."""
        used_ids = {entry.id for entry in self.plans}
        return first_free(lambda number: f"plan-{number}", used_ids)


def has_content_of(one: SiteModel | None, other: SiteModel | None) -> bool:
    """Whether two sites are the same in all that files hold, by being the same objects: one may have another time."""
    if one is None or other is None or one is other:
        return one is other
    return one.site is other.site and one.building is other.building and one.obstacles is other.obstacles


def exists(document: Document, item: Item) -> bool:
    """Whether a document has the thing that an item names."""
    model, entry = document.site, document.current
    match item.kind:
        case ItemKind.VIEWPOINT:
            return entry is not None and entry.viewpoint(item.id) is not None
        case ItemKind.SORTIE:
            return entry is not None and _sortie(entry.plan, item.id) is not None
        case ItemKind.LEG:
            number, _, leg = item.id.partition("/")
            sortie = None if entry is None else _sortie(entry.plan, number)
            return sortie is not None and leg.isdecimal() and 1 <= int(leg) < len(sortie.path_enu_m)
        case ItemKind.PANEL:
            return model is not None and any(panel.id == item.id for panel in model.site.panels)
        case ItemKind.FACADE:
            return model is not None and any(facade.id == item.id for facade in model.site.facades)
        case ItemKind.OBSTACLE:
            return model is not None and any(obstacle.id == item.id for obstacle in model.site.obstacles)
        case ItemKind.NO_FLY:
            return model is not None and any(zone.id == item.id for zone in model.site.airspace.no_fly)
        case ItemKind.ZONE:
            return model is not None and any(near.key == item.id for near in near_zones(model))
        case ItemKind.ZONE_FILE:
            return model is not None and any(source.file == item.id for source in model.site.zones)
        case ItemKind.RALLY:
            return model is not None and any(point.id == item.id for point in model.site.rally_points)
        case ItemKind.BUILDING | ItemKind.AIRSPACE | ItemKind.HOME:
            return model is not None


def _sortie(plan: Plan, number: str) -> Sortie | None:
    index = int(number) - 1 if number.isdecimal() else -1
    return plan.sorties[index] if 0 <= index < len(plan.sorties) else None


def first_free(name: Callable[[int], str], used: set[str]) -> str:
    """The first of `name(1)`, `name(2)` and so on that is not taken."""
    number = 1
    while name(number) in used:
        number += 1
    return name(number)
