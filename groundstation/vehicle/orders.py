"""What is to be flown: one sortie as each autopilot is told it, and what the vehicle needs for it."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from groundstation.vehicle.duration import items_duration_s
from groundstation.vehicle.surroundings import Surroundings
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import FencePolygon, fence_items, fence_polygons, rally_items, rally_points
from missions.mavlink.items import MissionItem, Polygon, mission_items
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.mission.export_choices import HeightReference
from missions.mission.model import GeoPoint, Mission
from planning.base.errors import InfeasibleError, MissionError
from planning.base.findings import Finding
from planning.base.messages import say
from planning.geo.frames import Vec3
from planning.insight.flight_profile import LowFlight, low_flight
from planning.plan import Plan
from planning.routing.rally import return_height
from planning.site.free_space import TAKEOFF_CLIMB_M, unchecked_space
from planning.site.ground import ground_of
from planning.site.records import Site, SiteModel
from planning.site.zones.keep_out import no_fly_volumes


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
        Polygons to stay out of by autopilot, as their vehicles have room for different numbers of corners.
    unfenced
        What the fence of each autopilot cannot say, or says more coarsely.
    rally
        Places to return to where they are nearer than home.
    return_height_m
        Above take-off: clears everything on the site, wherever the aircraft returns from.
    surroundings
        By autopilot, as photos are triggered by other items.
    battery_needed
        Part of a full battery that the sortie takes by the plan, reserve included.
    autopilot_s
        How long each autopilot takes for its items, with the time on the ground that the plan adds, seconds; none for
        one that cannot fly them in the wind that the plan expects.
    low
        How low it flies outside of the column above home; None where it does not leave it.
    raised_m
        How much lower than the site's home the aircraft takes off: its heights above take-off are as much larger.
    """

    site: Site
    number: int
    mission: Mission
    items: Mapping[Autopilot, tuple[MissionItem, ...]]
    fences: Mapping[Autopilot, tuple[Polygon, ...]]
    surroundings: Mapping[Autopilot, Surroundings]
    battery_needed: float
    rally: tuple[GeoPoint, ...] = ()
    return_height_m: float = 0.0
    raised_m: float = 0.0
    low: LowFlight | None = None
    autopilot_s: Mapping[Autopilot, float] = field(default_factory=dict)
    unfenced: Mapping[Autopilot, tuple[Finding, ...]] = field(default_factory=dict)

    def duration_s(self, autopilot: Autopilot | None) -> float:
        """How long the sortie takes, with the time on the ground: as planned, or longer where the autopilot is slower.

        A plan reckons with how its own aircraft flies.
        """
        planned_s = self.mission.duration_s
        return planned_s if autopilot is None else max(planned_s, self.autopilot_s.get(autopilot, planned_s))

    def battery_needed_by(self, autopilot: Autopilot | None) -> float:
        """Part of a full battery that the sortie takes with an autopilot, reserve included."""
        longer_s = self.duration_s(autopilot) - self.mission.duration_s
        return self.battery_needed + longer_s / self.mission.aircraft.endurance_s

    @property
    def home(self) -> GeoPoint:
        """Planned place of take-off."""
        return self.mission.takeoff

    @property
    def home_enu_m(self) -> Vec3:
        """The same in the site's frame."""
        x, y, z = self.site.home_enu_m
        return (x, y, z - self.raised_m)


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


def sortie_orders(plan: Plan, site_model: SiteModel, mission: Mission, raised_m: float = 0.0) -> SortieOrders:
    """Orders for one of a plan's missions (`missions.mission.build`).

    Parameters
    ----------
    raised_m
        Of `SortieOrders`: the aircraft flies the same places in space, from a take-off that is lower, or higher where
        this is negative.

    Raises
    ------
    MissionError
        The aircraft stands so high that it would begin without a climb.
    """
    mission = _raised(mission, raised_m)
    items = {autopilot: mission_items(mission, autopilot, HeightReference.ABOVE_TAKEOFF) for autopilot in Autopilot}
    surroundings = {}
    for autopilot, of_autopilot in items.items():
        numbered = enumerate(of_autopilot, first_seq(autopilot))
        trigger_seqs = {item.viewpoint_id: seq for seq, item in numbered if item.viewpoint_id}
        surroundings[autopilot] = Surroundings.of_sortie(site_model, plan, mission.number, trigger_seqs)
    rally = rally_points(site_model.site)
    volumes, ground_z_m = no_fly_volumes(site_model), site_model.site.airspace.ground_z_m
    fences, unfenced = {}, {}
    for autopilot in Autopilot:
        fences[autopilot], unfenced[autopilot] = fence_polygons(mission, volumes, autopilot, ground_z_m, rally)
    needed = plan.rules.battery_reserve + mission.duration_s / plan.aircraft.endurance_s
    site = site_model.site
    space = unchecked_space(site_model, plan.constraints.min_distance_m)
    orders = SortieOrders(
        site=site,
        number=mission.number,
        mission=mission,
        items=items,
        fences=fences,
        surroundings=surroundings,
        battery_needed=needed,
        rally=rally,
        unfenced=unfenced,
        return_height_m=return_height(space).above_home_m + raised_m,
        raised_m=raised_m,
        low=low_flight(plan, plan.sorties[mission.number - 1], site.home_enu_m, ground_of(site)),
    )
    autopilot_s = {}
    for autopilot in Autopilot:
        with contextlib.suppress(InfeasibleError):
            autopilot_s[autopilot] = items_duration_s(orders, autopilot) + plan.rules.takeoff_landing_s
    return replace(orders, autopilot_s=autopilot_s)


def _raised(mission: Mission, raised_m: float) -> Mission:
    home = mission.takeoff
    lowered = replace(home, height_ellipsoid_m=home.height_ellipsoid_m - raised_m)
    ends = (mission.waypoints[0], mission.waypoints[-1]) if mission.waypoints else ()
    climb_m = min((end.position.height_ellipsoid_m - lowered.height_ellipsoid_m for end in ends), default=math.inf)
    if climb_m < TAKEOFF_CLIMB_M:
        raise MissionError(
            say(
                "the flight would begin {:.1f} m above take-off, at least {:g} m are needed; plan it from where "
                "the aircraft stands",
                climb_m,
                TAKEOFF_CLIMB_M,
            )
        )
    return replace(mission, takeoff=lowered)
