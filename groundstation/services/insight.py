"""What a plan shows: coverage section by section, why the rest cannot be covered, and each sortie over way and time."""

from __future__ import annotations

from dataclasses import dataclass

from planning.errors import InfeasibleError
from planning.insight.clearance import RouteClearance, route_clearance
from planning.insight.flight_profile import FlightProfile, sortie_profile
from planning.insight.reasons import SectionReasons, section_reasons
from planning.insight.sections import PlanInsight, plan_insight
from planning.insight.things import Thing, things_of
from planning.plan import Plan
from planning.prepare import Prepared, prepare
from planning.progress import QUIET, Monitor
from planning.site import SiteModel
from planning.space import unchecked_space


@dataclass(frozen=True, slots=True, eq=False)
class RouteInsight:
    """The sorties of a plan, in order.

    Parameters
    ----------
    clearances
        Along each sortie.
    things
        Names of what clearances are measured to.
    profiles
        Each sortie over time; None where its path misses a viewpoint, or the aircraft cannot fly in the wind expected.
    """

    clearances: tuple[RouteClearance, ...]
    things: tuple[Thing, ...]
    profiles: tuple[FlightProfile | None, ...]


def insight(
    site_model: SiteModel,
    plan: Plan,
    prepared: Prepared | None = None,
    reasons: SectionReasons | None = None,
    monitor: Monitor = QUIET,
) -> PlanInsight:
    """Coverage of a plan, ready to be drawn.

    Parameters
    ----------
    prepared
        The site as it was prepared for the plan; prepared anew for the plan's camera and constraints where None.
    reasons
        Those of an earlier insight on the same prepared site, which saves finding them again.

    Raises
    ------
    InfeasibleError
        The site cannot be prepared: home cannot be used, or no allowed viewpoint sees anything.
    """
    if prepared is None:
        prepared = prepare(site_model, plan.camera, plan.constraints, monitor=monitor)
        reasons = None
    if reasons is None:
        reasons = section_reasons(site_model, prepared, monitor=monitor)
    return plan_insight(site_model, prepared, plan, reasons, monitor)


def route_insight(site_model: SiteModel, plan: Plan, monitor: Monitor = QUIET) -> RouteInsight:
    """Clearances and profiles of a plan's sorties, whether or not the plan may be flown."""
    space = unchecked_space(site_model, plan.constraints.min_distance_m)
    things = things_of(site_model, space)
    clearances, profiles = [], []
    for number, sortie in enumerate(plan.sorties):
        monitor.report("measuring along the route", number, len(plan.sorties))
        clearances.append(route_clearance(sortie, space, things))
        try:
            profiles.append(sortie_profile(plan, sortie))
        except InfeasibleError:  # no flying in this wind, as the checks say
            profiles.append(None)
    return RouteInsight(tuple(clearances), things.all, tuple(profiles))
