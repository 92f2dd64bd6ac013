"""The rest of a sortie that was interrupted, as a mission of its own.

What is left is known by the views that have a photo, never by the numbers of mission items: a mission that starts at
an item in the middle lacks what stood before it (speed, gimbal, camera settings). So the rest becomes a whole mission:
take-off, speed and camera set anew, a checked way from home to the first view that is missing, then the sortie as it
was planned without the views that are done, home and landing.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from missions.mission.build import missions_from_plan
from missions.mission.model import Mission
from planning.base.errors import InfeasibleError, MissionError
from planning.base.findings import Finding, Severity
from planning.base.progress import QUIET, Monitor
from planning.plan import Plan
from planning.revision.edits import delete, revise
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare


@dataclass(frozen=True, slots=True)
class Resumed:
    """What is left of a sortie.

    Parameters
    ----------
    plan
        Its only sortie is the rest; viewpoints keep their identifiers.
    mission
        The same, ready to be written in any format.
    findings
        Of all pre-flight rules (`planning.checks`); no errors.
    """

    plan: Plan
    mission: Mission
    findings: tuple[Finding, ...]


def resume_sortie(
    plan: Plan,
    site_model: SiteModel,
    number: int,
    taken: Collection[str],
    *,
    prepared: Prepared | None = None,
    monitor: Monitor = QUIET,
) -> Resumed:
    """The views of a sortie that have no photo yet, in the order in which they were planned.

    Parameters
    ----------
    site_model
        The site as it is now.
    number
        Of the sortie, from 1.
    taken
        Identifiers of the views that have a photo; those of other sorties do not matter.
    prepared
        The site as it was prepared for this plan.

    Raises
    ------
    ValueError
        There is no such sortie, or the site was prepared for another camera or other constraints.
    InfeasibleError
        Home cannot be used any more.
    MissionError
        Nothing is left, or the rest cannot be flown as it was planned; the message says why.
    """
    if not 1 <= number <= len(plan.sorties):
        raise ValueError(f"number: expected a sortie from 1 to {len(plan.sorties)}, got {number}")
    sortie = plan.sorties[number - 1]
    done = [identifier for identifier in sortie.viewpoint_ids if identifier in set(taken)]
    if len(done) == len(sortie.viewpoint_ids):
        raise MissionError.say(
            "sortie {} is complete: all {} views have a photo, so there is nothing to resume", number, len(done)
        )
    if prepared is None:
        prepared = _prepared(plan, site_model, monitor)
    locked = {view.id for view in plan.viewpoints if view.locked}
    views = tuple(replace(view, locked=False) for view in plan.viewpoints if view.id in set(sortie.viewpoint_ids))
    alone = replace(plan, viewpoints=views, sorties=(sortie,), history=())
    rest = delete(revise(alone, prepared), done)
    errors = [finding for finding in rest.findings if finding.severity is Severity.ERROR]
    if errors:
        place = f" ({errors[0].place})" if errors[0].place else ""
        raise MissionError.say(
            "the rest of sortie {} cannot be flown as it was planned{}: {}; plan a top-up instead, which "
            "finds its own views and ways",
            number,
            place,
            errors[0].message,
        )
    left = tuple(replace(view, locked=view.id in locked) for view in rest.plan.viewpoints)
    rest_plan = replace(
        rest.plan, viewpoints=left, site_sha256=site_model.sha256, home_enu_m=site_model.site.home_enu_m
    )
    mission = missions_from_plan(rest_plan, site_model.site.origin)[0]
    return Resumed(rest_plan, replace(mission, number=number, name=f"{plan.site}-{number}-rest"), rest.findings)


def _prepared(plan: Plan, site_model: SiteModel, monitor: Monitor) -> Prepared:
    """The site with all that ways need, without proofs of what can be seen."""
    try:
        return prepare(site_model, plan.camera, plan.constraints, seed=plan.seed, stop=lambda: True, monitor=monitor)
    except InfeasibleError as error:
        raise InfeasibleError.say("the sortie cannot be resumed on the site as it is now: {}", error) from error
