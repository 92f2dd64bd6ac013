"""Which effects a plan on this site calls for, before it is planned and after."""

from __future__ import annotations

from dataclasses import dataclass

from planning.effects import Decision, Wish, decide
from planning.errors import InfeasibleError
from planning.plan import Plan
from planning.prepare import decide_occlusion
from planning.progress import QUIET, Monitor
from planning.request import PlanRequest
from planning.site import SiteModel
from planning.sortie_timing import sortie_flight_path
from planning.space import unchecked_space
from planning.speed_profile import CornerSpeed
from planning.timing import motion_limits


@dataclass(frozen=True, slots=True)
class EffectChoice:
    """An effect as the scene has it, and what the user wished.

    Parameters
    ----------
    wish
        None for effects that the user cannot overrule here.
    """

    decision: Decision
    wish: Wish | None


def planning_effects(
    site_model: SiteModel, request: PlanRequest, plan: Plan | None = None, monitor: Monitor = QUIET
) -> tuple[EffectChoice, ...]:
    """All effects of planning: those that shape the plan, and with a plan those that its check looks at."""
    monitor.report("looking at the scene", 0, 2)
    constraints = request.constraints
    wishes: dict[str, Wish] = {"auto": "auto", "on": "on", "off": "off"}
    wish = wishes[constraints.occlusion]
    space = unchecked_space(site_model, constraints.min_distance_m)
    found = [EffectChoice(decide_occlusion(site_model, space, wish, request.seed), wish)]
    monitor.report("looking at the scene", 1, 2)
    if plan is not None:
        corners = corner_speed(plan)
        found += [] if corners is None else [EffectChoice(corners, None)]
    return tuple(found)


def corner_speed(plan: Plan) -> Decision | None:
    """Whether flying through corners matters for the durations of a plan, judged on the sortie where it does most.

    None where no sortie can be timed: there are none, they miss a viewpoint, or the wind is too strong.
    """
    try:
        limits = motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError:
        return None
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    decisions = []
    for sortie in plan.sorties:
        timed = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules, stop_at_corners=False)
        if timed is not None:
            decisions.append(decide(CornerSpeed(), (timed[0], limits)))
    return max(decisions, key=lambda decision: decision.size, default=None)
