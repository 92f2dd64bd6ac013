"""A sortie before it is flown live: its plan measured once, its orders made, and what the pilot chose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from groundstation.services.fly.flying import check_site
from groundstation.services.mission.readiness import errors_of
from groundstation.services.plan.effects import EffectChoice
from groundstation.vehicle.orders import SortieOrders, sortie_orders
from groundstation.vehicle.preflight import PreflightCheck, warnings_of
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from missions.simulator.build import decide_effects
from missions.simulator.conditions import Conditions
from missions.simulator.scene import flight_scene
from planning.base.effects import EffectSetting
from planning.base.errors import MissionError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.checks.case import Case
from planning.insight.flight_profile import LowFlight
from planning.plan import Plan
from planning.site.records import Site, SiteModel
from planning.site.zones.keep_out import at_time

READY_S = 3600.0
"""A sortie that is ready may wait for its start, and for batteries between flights."""


@dataclass(frozen=True, slots=True, eq=False)
class LiveSortie:
    """A sortie ready to be flown: its plan measured, and its orders."""

    case: Case
    orders: SortieOrders

    @property
    def viewpoint_ids(self) -> tuple[str, ...]:
        """Its views in the order of flight."""
        return self.case.plan.sorties[self.orders.number - 1].viewpoint_ids


def is_same_place(one: Site, other: Site) -> bool:
    """Whether what belongs to one site, such as a track or coverage, can be shown on the other."""
    return one.origin == other.origin and one.n_panels == other.n_panels


def prepare_sortie(
    plan: Plan,
    site_model: SiteModel,
    number: int,
    known: Case | None = None,
    raised_m: float = 0.0,
    monitor: Monitor = QUIET,
    now: datetime | None = None,
) -> LiveSortie:
    """A sortie of a plan, counted from 1, ready to be flown.

    Parameters
    ----------
    known
        The case of the same plan, where it was measured already.
    raised_m
        How much lower than planned the aircraft takes off.
    now
        Geo-zones count that apply from now on until an hour after the plan could be flown; None: the clock's time.

    Raises
    ------
    InputError, MissionError
        The plan is for another site, breaks a pre-flight rule, or cannot be flown as it stands.
    """
    monitor.report(say("preparing the flight"), 0, 2)
    check_site(plan, site_model)
    site_model = at_time(site_model, now or datetime.now(UTC), plan.duration_s + READY_S)
    missions = missions_from_plan(plan, site_model.site.origin, site_model.site.home_enu_m)
    is_known = known is not None and known.plan is plan and known.site_model is site_model
    case = known if is_known and known is not None else Case.of(plan, site_model)
    errors = errors_of(case, monitor)
    if errors:
        first = errors[0].message
        raise MissionError(
            say("the plan breaks {} pre-flight rules, such as: {}; correct it before it is flown", len(errors), first)
        )
    monitor.report(say("preparing the flight"), 1, 2)
    return LiveSortie(case, sortie_orders(plan, site_model, missions[number - 1], raised_m))


@dataclass(frozen=True, slots=True)
class TakeOff:
    """What a pilot should know before a sortie starts.

    Parameters
    ----------
    highest_m
        Above the place of take-off.
    least_distance_m
        That the plan keeps to panels, building and obstacles.
    duration_s, planned_s
        How long the autopilot takes, and how long the plan reckons with.
    autopilot
        Who flies it.
    battery
        Part of a full battery that it uses.
    low
        How low it flies outside of the column above home; None where it does not leave it.
    warnings
        Of the list before take-off, which the pilot confirms by starting.
    """

    n_photos: int
    highest_m: float
    length_m: float
    duration_s: float
    planned_s: float
    autopilot: Autopilot | None
    least_distance_m: float
    battery: float
    low: LowFlight | None
    warnings: tuple[str, ...] = ()


def take_off_of(sortie: LiveSortie, autopilot: Autopilot | None, checks: Sequence[PreflightCheck] = ()) -> TakeOff:
    """What will happen when a sortie starts on this autopilot."""
    plan, orders = sortie.case.plan, sortie.orders
    flown = plan.sorties[orders.number - 1]
    top_m = max((point[2] for point in flown.path_enu_m), default=orders.home_enu_m[2])
    return TakeOff(
        n_photos=len(flown.viewpoint_ids),
        highest_m=top_m - orders.home_enu_m[2],
        length_m=flown.length_m,
        duration_s=orders.duration_s(autopilot),
        planned_s=flown.duration_s,
        autopilot=autopilot,
        least_distance_m=plan.constraints.min_distance_m,
        battery=orders.duration_s(autopilot) / plan.aircraft.endurance_s,
        low=orders.low,
        warnings=tuple(check.text for check in warnings_of(checks)),
    )


def simulation_effects(
    plan: Plan,
    site_model: SiteModel,
    number: int,
    conditions: Conditions,
    settings: Mapping[str, EffectSetting],
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[EffectChoice, ...]:
    """What the simulation of a sortie, counted from 1, takes into account, and why; in a process of its own, too."""
    scene = flight_scene(plan, site_model, conditions, plan.sorties[number - 1])
    return tuple(
        EffectChoice(decision, settings.get(decision.effect, "auto")) for decision in decide_effects(scene, settings)
    )
