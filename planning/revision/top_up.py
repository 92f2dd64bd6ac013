"""The top-up: the shortest flight that closes what a flight left open.

What was seen is decided by the poses of the photos that were really taken, not by the views that they were meant to be.
What is wanted is what the plan had promised and the flight did not deliver, or everything that can be seen.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.parameters import check, declared, like, parameter
from planning.base.progress import QUIET, Monitor, QualityPoint, Stop, TimeLimit, Trace, any_of, never
from planning.coverage.evaluate import coverage
from planning.coverage.model import exact_coverage
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.reachability import MAX_CELLS
from planning.motion.timing import usable_battery_s
from planning.parameters import PlanParameters
from planning.plan import HistoryPoint, Plan, Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.planner import plan_records
from planning.revision.closing_flights import Batteries, ClosingFlights, ClosingTask, closing_flights
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare, with_site_limits
from planning.viewpoints.problem import NONE_LOCKED, nothing_to_see

METHOD = "top-up"


class Target(StrEnum):
    """What a top-up is to show."""

    PROMISED = "promised"
    """The sections that the plan covers and the photos do not show."""
    REACHABLE = "reachable"
    """All sections that can be seen and that the photos do not show."""


class WhyMissing(StrEnum):
    """Why a section stays open."""

    UNREACHABLE = "unreachable"
    """No allowed place was found from which it can be seen now."""
    BATTERY = "battery"
    """It can be seen, but the batteries allowed do not last for it."""
    SPACING = "spacing"
    """It can be seen only from places closer together than aircraft accept, and others show more."""


NEGLIGIBLE_SHARE = 0.005
"""Part of the sections aimed at that is not worth a flight unasked: photos taken a little off their places lose as many
sections on the borders of hemispheres, and plans leave twice as many open by default."""

REACHABILITY_SHARE, DRAWING_S = 0.4, 0.3
"""Part of the time budget that finding out what can be reached may take, and what is kept for drawing the flight."""

CELLS = {Target.PROMISED: 600, Target.REACHABLE: MAX_CELLS}
"""Effort per section to find out whether it can be reached (`planning.coverage.reachability`). What was promised has
its views as witnesses. A tenth of the effort leaves 58 of 10080 sections of the office undecided, in half the time."""


@dataclass(frozen=True, slots=True)
class MissingSection:
    """A wanted section that stays open."""

    panel_id: str
    section: int
    why: WhyMissing


@dataclass(frozen=True, slots=True)
class TopUpRequest:
    """What is wanted of a top-up.

    Parameters
    ----------
    battery
        Charge of the battery on board, 0 to 1; None: it has been changed.
    n_batteries
        Full batteries that may be used as well, where the one on board does not suffice. None: none where `battery` is
        given, else as many as it takes.
    time_budget_s
        Wall time; the search ends earlier when it finds nothing more.
    """

    target: Target = Target.PROMISED
    battery: float | None = parameter(None, least=0.0, most=1.0, expected="a charge from 0 to 1")
    n_batteries: int | None = like(PlanParameters, "n_batteries", None, least=0)
    seed: int = like(PlanParameters, "seed", 0)
    time_budget_s: float = like(PlanParameters, "time_budget_s", 5.0)

    def __post_init__(self) -> None:
        check(self)
        if self.battery is None and self.n_batteries is not None:
            declared(PlanParameters)["n_batteries"].parameter.check("n_batteries", self.n_batteries)


@dataclass(frozen=True, slots=True)
class TopUp:
    """A top-up and what is known about it.

    Parameters
    ----------
    plan
        None where nothing is missing, or nothing of a negligible rest can be shown.
    promised, delivered
        Sections that the plan covers, and those of them that the photos show.
    on_board
        Whether the first sortie is for the battery on board; the others, and else all, need full ones.
    seen, together
        Sections that the photos show, and that they show together with the top-up.
    aimed
        Sections aimed at, whether the photos show them or not.
    wanted, closed
        Sections that the top-up was to show, and does show.
    bound
        No top-up within the batteries closes more, of those that were compared.
    missing
        The wanted sections that stay open, and why.
    shortest_s
        No single flight over the views that were compared closes as much and is shorter, take-off and landing
        included; None where the batteries do not allow all that can be seen.
    durations
        Duration of the shortest flight known after some time, take-off and landing included.
    seconds
        Wall time it took.
    """

    plan: Plan | None
    on_board: bool
    promised: int
    delivered: int
    seen: int
    together: int
    aimed: int
    wanted: int
    closed: int
    bound: int
    missing: tuple[MissingSection, ...]
    shortest_s: float | None
    durations: tuple[QualityPoint, ...]
    seconds: float
    prepared: Prepared = field(repr=False, compare=False)

    @property
    def is_negligible(self) -> bool:
        """Whether something is missing, and so little that a flight for it wants a decision."""
        return self.wanted > 0 and is_negligible(self.wanted, self.aimed)


def is_negligible(n_missing: int, n_aimed: int) -> bool:
    """Whether so few sections are missing of those aimed at that they are not worth a flight unasked."""
    return n_missing <= NEGLIGIBLE_SHARE * n_aimed


def top_up(
    site_model: SiteModel,
    plan: Plan,
    taken: ViewpointArrays,
    request: TopUpRequest = TopUpRequest(),
    *,
    prepared: Prepared | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> TopUp:
    """Plan the shortest flight that closes what photos left open; when `stop` asks for an end, the best so far.

    Parameters
    ----------
    site_model
        The site as it is now: no-fly volumes may have come since.
    plan
        What was to be flown; its aircraft, camera, constraints and rules hold for the top-up.
    taken
        Poses of the photos that were really taken, in any order.
    prepared
        The site as it was prepared for this plan.
    trace
        Gets the number of wanted sections that are closed.

    Raises
    ------
    ValueError
        The site was prepared for another camera or other constraints.
    InfeasibleError
        Nothing is to be seen from where flying is allowed; or nothing of what is missing can be shown, and it is more
        than a negligible rest: the message says whether the site or the battery is the reason.
    """
    started_s = time.perf_counter()
    trace = Trace() if trace is None else trace
    limit = TimeLimit(max(0.1, request.time_budget_s - DRAWING_S))
    preparing = any_of(stop, TimeLimit(REACHABILITY_SHARE * request.time_budget_s))
    prepared = _prepared(site_model, plan, prepared, CELLS[request.target], preparing, monitor)
    problem, planned = prepared.problem, viewpoint_arrays(plan.viewpoints)
    verdicts = problem.reachability.verdicts.reshape(-1)
    seen, promised = _shown(prepared, taken), _shown(prepared, planned)
    target = promised if request.target is Target.PROMISED else promised | (verdicts == REACHABLE)
    if not target.any():
        raise nothing_to_see()
    elements = np.flatnonzero(target & ~seen)
    durations, found, topped_up = Trace(trace.clock), None, None
    if len(elements):
        trace.record_bound(int(np.count_nonzero(verdicts[elements] != UNREACHABLE)))
        is_few = is_negligible(len(elements), int(target.sum()))
        batteries = _batteries(plan, request, is_few)
        wanted = ClosingTask(problem, plan.aircraft, plan.rules, elements, batteries.longest_s)
        found = closing_flights(
            wanted,
            planned,
            batteries,
            seed=request.seed,
            limit=limit,
            stop=stop,
            trace=trace,
            durations=durations,
            monitor=monitor,
        )
        if found.flights:
            topped_up = _plan(site_model, plan, prepared, found, request.seed, trace)
        elif not is_few:
            raise _nothing_closed(found, len(elements), request, batteries)
    views = NONE_LOCKED if topped_up is None else viewpoint_arrays(topped_up.viewpoints)
    together = seen | _shown(prepared, views)
    missing = () if found is None else _missing(prepared, elements[~together[elements]], found)
    on_ground_s = plan.rules.takeoff_landing_s
    return TopUp(
        plan=topped_up,
        on_board=found is not None and found.on_board,
        promised=int(promised.sum()),
        delivered=int((promised & seen).sum()),
        seen=int(seen.sum()),
        together=int(together.sum()),
        aimed=int(target.sum()),
        wanted=len(elements),
        closed=len(elements) - len(missing),
        bound=0 if found is None else found.bound,
        missing=missing,
        shortest_s=None if found is None or found.shortest_s is None else found.shortest_s + on_ground_s,
        durations=tuple(QualityPoint(point.t_s, point.value + on_ground_s) for point in durations.points),
        seconds=time.perf_counter() - started_s,
        prepared=prepared,
    )


def _prepared(
    site_model: SiteModel, plan: Plan, prepared: Prepared | None, n_cells: int, stop: Stop, monitor: Monitor
) -> Prepared:
    if prepared is None:
        return prepare(
            site_model,
            plan.camera,
            plan.constraints,
            max_cells=n_cells,
            seed=plan.seed,
            stop=stop,
            monitor=monitor,
        )
    wanted = with_site_limits(
        replace(plan.constraints, occlusion=prepared.constraints.occlusion), site_model, plan.camera
    )
    if plan.camera != prepared.problem.model.camera or wanted != prepared.constraints:
        raise ValueError(f"prepared: is for {prepared.constraints}, not for {plan.constraints} and {plan.camera.name}")
    return prepared


def _shown(prepared: Prepared, views: ViewpointArrays) -> NDArray[np.bool_]:
    """Whether any of the views shows each element, by the definition."""
    return np.asarray(exact_coverage(prepared.problem.model, views).reshape(-1) > 0)


def _batteries(plan: Plan, request: TopUpRequest, is_few: bool) -> Batteries:
    """What may be flown on; a negligible rest is planned on full ones where the one on board leaves nothing."""
    full_s = usable_battery_s(plan.aircraft, plan.rules)
    if request.battery is None:
        return Batteries(None, request.n_batteries, full_s)
    rules, n_full = plan.rules, request.n_batteries or 0
    left_s = plan.aircraft.endurance_s * (request.battery - rules.battery_reserve) - rules.takeoff_landing_s
    if left_s <= 0.0 and n_full == 0 and is_few:
        return Batteries(None, None, full_s)
    if left_s <= 0.0 and n_full == 0:
        raise InfeasibleError.say(
            "the battery is at {:.0%}; a reserve of {:.0%} and {:g} s for take-off and landing leave nothing "
            "to fly on; change the battery",
            request.battery,
            rules.battery_reserve,
            rules.takeoff_landing_s,
        )
    return Batteries(left_s, n_full, full_s)


def _nothing_closed(
    found: ClosingFlights, n_wanted: int, request: TopUpRequest, batteries: Batteries
) -> InfeasibleError:
    if len(found.in_sight) == 0:
        return InfeasibleError.say(
            "none of the {} missing sections can be seen from any allowed place that was found on the site "
            "as it is now; check its no-fly volumes and obstacles, or lower the minimum distance",
            n_wanted,
        )
    on_board = "" if request.battery is None else say(" of a battery at {:.0%}", request.battery)
    return InfeasibleError(
        say(
            "{} of the {} missing sections can be seen, but none within the {:.0f} s{} that are left above "
            "the reserve; move home closer",
            len(found.in_sight),
            n_wanted,
            batteries.longest_s,
            on_board,
        )
        if request.battery is None
        else say(
            "{} of the {} missing sections can be seen, but none within the {:.0f} s{} that are left above "
            "the reserve; change the battery",
            len(found.in_sight),
            n_wanted,
            batteries.longest_s,
            on_board,
        )
    )


def _plan(
    site_model: SiteModel, flown: Plan, prepared: Prepared, found: ClosingFlights, seed: int, trace: Trace
) -> Plan:
    viewpoints, sorties = plan_records(found.views, found.flights)
    names = _names(viewpoints, flown.viewpoints)
    viewpoints = tuple(replace(viewpoint, id=names[viewpoint.id]) for viewpoint in viewpoints)
    shows = coverage(prepared.problem.model, viewpoints, prepared.problem.reachability)
    return replace(
        flown,
        site=site_model.site.name,
        site_sha256=site_model.sha256,
        method=METHOD,
        seed=seed,
        constraints=prepared.constraints,
        viewpoints=viewpoints,
        sorties=tuple(replace(s, viewpoint_ids=tuple(names[i] for i in s.viewpoint_ids)) for s in sorties),
        coverage=shows,
        history=(HistoryPoint(round(trace.elapsed_s(), 4), shows.covered),),
        origin=site_model.site.origin,
        home_enu_m=site_model.site.home_enu_m,
    )


def _names(viewpoints: Sequence[Viewpoint], flown: Sequence[Viewpoint]) -> dict[str, str]:
    """New identifiers by old: those of the flown plan where a view is the same, further ones for the others."""
    known = {_pose(viewpoint): viewpoint.id for viewpoint in flown}
    used_ids = set(known.values())
    further = (name for number in itertools.count(len(flown)) if (name := f"v{number:04d}") not in used_ids)
    names: dict[str, str] = {}
    for viewpoint in viewpoints:
        same = known.get(_pose(viewpoint))
        names[viewpoint.id] = next(further) if same is None else same
    return names


def _pose(viewpoint: Viewpoint) -> tuple[float, ...]:
    return (*viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg)


def _missing(prepared: Prepared, left: NDArray[np.int64], found: ClosingFlights) -> tuple[MissingSection, ...]:
    panels, n_sections = prepared.site_model.site.panels, prepared.problem.model.grid.n_sections
    in_sight, in_reach = set(found.in_sight.tolist()), set(found.in_reach.tolist())
    missing = []
    for element in left.tolist():
        why = WhyMissing.UNREACHABLE
        if element in in_sight:
            is_limited = found.shortest_s is None or element not in in_reach
            why = WhyMissing.BATTERY if is_limited else WhyMissing.SPACING
        missing.append(MissingSection(panels[element // n_sections].id, element % n_sections, why))
    return tuple(missing)
