"""Which effects a plan on this site calls for, before it is planned and after."""

from __future__ import annotations

from dataclasses import dataclass

from planning.base.effects import Decision, EffectSetting, decide
from planning.base.errors import InfeasibleError
from planning.checks.camera import camera_effects
from planning.checks.case import Case
from planning.motion.speed_profile import CornerSpeed
from planning.motion.timing import motion_limits, sortie_flight_path
from planning.plan import Plan
from planning.request import PlanRequest
from planning.site.free_space import unchecked_space
from planning.site.records import SiteModel
from planning.viewpoints.prepare import decide_occlusion


@dataclass(frozen=True, slots=True)
class EffectChoice:
    """An effect as the scene has it, and what the user set.

    Parameters
    ----------
    setting
        None for effects that the user cannot overrule here.
    """

    decision: Decision
    setting: EffectSetting | None


@dataclass(frozen=True, slots=True, eq=False)
class SceneEffects:
    """Effects that shape the next plan, and the site and request they were decided for."""

    site_model: SiteModel
    request: PlanRequest
    choices: tuple[EffectChoice, ...]

    def hold_for(self, site_model: SiteModel, request: PlanRequest) -> bool:
        """Whether they would be the same for another site or request."""
        mine, others = self.request.constraints, request.constraints
        return (
            self.site_model is site_model
            and mine.min_distance_m == others.min_distance_m
            and mine.occlusion == others.occlusion
            and self.request.seed == request.seed
        )


def scene_effects(site_model: SiteModel, request: PlanRequest) -> SceneEffects:
    """What the scene calls for, measured on it; what the user set overrules the decision, not the measurement.

    A site without panels calls for nothing.
    """
    if site_model.site.n_panels == 0:
        return SceneEffects(site_model, request, ())
    constraints = request.constraints
    space = unchecked_space(site_model, constraints.min_distance_m)
    setting = constraints.occlusion
    occlusion = EffectChoice(decide_occlusion(site_model, space, setting, request.seed), setting)
    return SceneEffects(site_model, request, (occlusion,))


def plan_effects(plan: Plan, site_model: SiteModel | None = None) -> tuple[EffectChoice, ...]:
    """Effects that the check of a plan looks at; the user cannot overrule them.

    Parameters
    ----------
    site_model
        Its site, for what the camera does to photos of it; None: that is left out.
    """
    corners = corner_speed(plan)
    of_camera = () if site_model is None or site_model.site.n_panels == 0 else camera_effects(Case.of(plan, site_model))
    found = (*(() if corners is None else (corners,)), *of_camera)
    return tuple(EffectChoice(decision, None) for decision in found)


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
