"""What is to be flown: one sortie as each autopilot is told it, and what the vehicle needs for it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from groundstation.vehicle.surroundings import Surroundings
from missions.encode import CLEARANCE_M
from missions.mavlink.areas import FencePolygon, fence_items, rally_items, rally_points
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import fence_polygons
from missions.mavlink.items import MissionItem, Polygon, mission_items
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.model import GeoPoint, HeightReference, Mission
from planning.frames import Vec3
from planning.plan import Plan
from planning.rally import clear_height_z_m
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
    rally
        Places to return to where they are nearer than home.
    return_height_m
        Above take-off: clears everything on the site, wherever the aircraft returns from.
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
    rally: tuple[GeoPoint, ...] = ()
    return_height_m: float = 0.0

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


def rally_messages(orders: SortieOrders, autopilot: Autopilot) -> tuple[MissionItemInt, ...]:
    """Items of the rally points; none where there are none."""
    return to_wire(rally_items(orders.rally, orders.home), autopilot, MissionType.RALLY)


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
    site, highest_z_m = site_model.site, max(z for _, _, z in plan.sorties[mission.number - 1].path_enu_m)
    clear_z_m = clear_height_z_m(site_model, max(CLEARANCE_M, plan.constraints.min_distance_m))
    return SortieOrders(
        site=site,
        number=mission.number,
        mission=mission,
        items=items,
        fences=fences,
        surroundings=surroundings,
        battery_needed=needed,
        rally=rally_points(site),
        return_height_m=math.ceil(max(highest_z_m, clear_z_m) - site.home_enu_m[2]),
    )
