"""What is to be flown: one sortie as each autopilot is told it, and what the vehicle needs for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from groundstation.vehicle.surroundings import Surroundings
from missions.mavlink.areas import FencePolygon, fence_items
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import fence_polygons
from missions.mavlink.items import MissionItem, Polygon, mission_items
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.model import GeoPoint, HeightReference, Mission
from planning.frames import Vec3
from planning.plan import Plan
from planning.site import Site, SiteModel


@dataclass(frozen=True, slots=True, eq=False)
class SortieOrders:
    """One sortie.

    Parameters
    ----------
    number
        In the plan, from 1.
    items
        Mission items by autopilot, home not among them.
    fences
        Polygons to stay out of.
    surroundings
        By autopilot, as photos are triggered by other items.
    battery_needed
        Part of a full battery that the sortie takes, reserve included.
    """

    site: Site
    number: int
    mission: Mission
    items: Mapping[Autopilot, tuple[MissionItem, ...]]
    fences: tuple[Polygon, ...]
    surroundings: Mapping[Autopilot, Surroundings]
    battery_needed: float

    @property
    def home(self) -> GeoPoint:
        """Planned place of take-off."""
        return self.mission.takeoff

    @property
    def home_enu_m(self) -> Vec3:
        """The same in the site's frame."""
        return self.site.home_enu_m


def first_seq(autopilot: Autopilot) -> int:
    """Number of a mission's first item on the vehicle: ArduPilot keeps home as item 0."""
    return 1 if autopilot is Autopilot.ARDUPILOT else 0


def fence_messages(fences: tuple[Polygon, ...], autopilot: Autopilot) -> tuple[MissionItemInt, ...]:
    """Items of a geofence of polygons to stay out of."""
    polygons = [FencePolygon(corners, is_inclusion=False) for corners in fences]
    return to_wire(fence_items(polygons), autopilot, MissionType.FENCE)


def sortie_orders(plan: Plan, site_model: SiteModel, mission: Mission) -> SortieOrders:
    """Orders for one of a plan's missions (`missions.build`)."""
    items = {autopilot: mission_items(mission, autopilot, HeightReference.ABOVE_TAKEOFF) for autopilot in Autopilot}
    surroundings = {}
    for autopilot, of_autopilot in items.items():
        numbered = enumerate(of_autopilot, first_seq(autopilot))
        trigger_seqs = {item.viewpoint_id: seq for seq, item in numbered if item.viewpoint_id}
        surroundings[autopilot] = Surroundings.of_sortie(site_model, plan, mission.number, trigger_seqs)
    fences, _ = fence_polygons(mission, site_model.site.airspace.no_fly)
    needed = plan.rules.battery_reserve + mission.duration_s / plan.aircraft.endurance_s
    return SortieOrders(site_model.site, mission.number, mission, items, fences, surroundings, needed)
