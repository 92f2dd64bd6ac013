"""Top-ups and resumed sorties from flights: whose flight it is, what its photos show, and what is left."""

from __future__ import annotations

import functools
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.plan.top_up import FlownPlan, flown_plan, resume_flight, top_up_flight, top_up_summary
from missions.flight.flight_file import Flight, flight_of
from missions.flight.matching import PhotoRef, match_flight, taken_poses
from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, InputError, MissionError
from planning.base.findings import Finding, Severity
from planning.geo.frames import Origin
from planning.parameters import FlightRules
from planning.plan import Plan, Viewpoint
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.top_up import Target, TopUpRequest
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import NEAR, QUICK

SOON = TopUpRequest(time_budget_s=0.2)


@functools.cache
def site() -> SiteModel:
    return replace(kiosk(), sha256="s" * 64)


@functools.cache
def prepared() -> Prepared:
    return prepare(site(), profile("m3e").camera, NEAR, max_cells=50)


@functools.cache
def planned() -> Plan:
    """Two sorties of about ten views."""
    request = PlanRequest(
        n_views=20, constraints=NEAR, greedy=QUICK, rules=FlightRules(battery_reserve=0.92), time_budget_s=600.0
    )
    plan = plan_flight(site(), request, prepared=prepared()).plan
    assert len(plan.sorties) == 2
    return plan


def photo(index: int, view: Viewpoint, **changes: object) -> TakenPhoto:
    taken = TakenPhoto(index, 4.0 * index, view.position_enu_m, view.heading_deg, view.gimbal_pitch_deg)
    return replace(taken, **changes)  # type: ignore[arg-type]


def record(number: int, photos: Sequence[TakenPhoto]) -> FlightRecord:
    """A record with a track through its photos."""
    n = len(photos)
    empty = np.full(n, np.nan)
    times_s = np.arange(n, dtype=np.float64)
    positions = np.array([taken.position_enu_m for taken in photos], np.float64).reshape(-1, 3)
    track = Track(4.0 * times_s, positions, np.full((n, 3), np.nan), empty, empty, empty, empty)
    return FlightRecord(number, "test", track, tuple(photos))


def flight(taken: Sequence[Collection[int]], plan: Plan | None = None, **changes: object) -> Flight:
    """A flight that took the views with these numbers of each sortie."""
    plan = planned() if plan is None else plan
    by_id = {view.id: view for view in plan.viewpoints}
    records = []
    for number, (views, sortie) in enumerate(zip(taken, plan.sorties, strict=False), 1):
        chosen = [by_id[sortie.viewpoint_ids[view]] for view in sorted(views)]
        records.append(record(number, [photo(i, view, **changes) for i, view in enumerate(chosen)]))
    return flight_of(plan, site(), tuple(records))


def sizes() -> tuple[int, int]:
    first, second = planned().sorties
    return len(first.viewpoint_ids), len(second.viewpoint_ids)


def opened(taken: Sequence[Collection[int]]) -> FlownPlan:
    return flown_plan(flight(taken), planned(), site())


def codes(findings: Sequence[Finding]) -> set[str]:
    return {finding.code for finding in findings if finding.severity is not Severity.OK}


@pytest.mark.slow
def test_the_views_without_a_photo_are_closed() -> None:
    first, second = sizes()
    flown = opened([range(first - 3), range(2, second)])
    assert len(flown.photographed) == first + second - 5
    found, findings = top_up_flight(flown, SOON, prepared())
    assert found.plan is not None
    assert 0 < found.wanted == found.closed
    assert findings == ()
    summary = top_up_summary(found, findings)
    assert summary["covered_together"] >= planned().coverage.covered
    assert summary["left_open"] == {"unreachable": 0, "battery": 0, "spacing": 0}


@pytest.mark.slow
def test_a_complete_flight_leaves_nothing_to_do() -> None:
    first, second = sizes()
    found, findings = top_up_flight(opened([range(first), range(second)]), SOON, prepared())
    assert (found.plan, findings) == (None, ())
    assert top_up_summary(found, findings)["views"] == 0


@pytest.mark.slow
def test_without_any_record_everything_is_missing() -> None:
    found, _ = top_up_flight(opened([]), replace(SOON, n_batteries=3, time_budget_s=0.5), prepared())
    assert found.wanted == found.promised


@pytest.mark.slow
def test_what_the_battery_leaves_open_is_a_warning_with_its_number() -> None:
    charge = 0.92 + 100.0 / planned().aircraft.endurance_s
    found, findings = top_up_flight(opened([]), replace(SOON, battery=charge, time_budget_s=0.4), prepared())
    (finding,) = findings
    assert (finding.code, finding.severity) == ("left-open-battery", Severity.WARNING)
    assert finding.value == len(found.missing) > 0
    assert "change the battery" in finding.message


@pytest.mark.slow
def test_everything_reachable_can_be_asked_for() -> None:
    first, second = sizes()
    flown = opened([range(first), range(second)])
    found, _ = top_up_flight(flown, replace(SOON, target=Target.REACHABLE), prepared())
    assert found.together > planned().coverage.covered


@pytest.mark.long
def test_a_flight_of_another_plan_is_refused_by_its_checksum() -> None:
    other = replace(planned(), seed=7)
    with pytest.raises(InputError, match="flight of another plan: its plan has another checksum; name the plan file"):
        flown_plan(flight([[0, 1]]), other, site())


@pytest.mark.long
def test_a_flight_without_checksum_is_refused_where_no_photo_is_near_a_view() -> None:
    away = replace(flight([[0, 1]], position_enu_m=(500.0, 0.0, 20.0)), plan_sha256="")
    with pytest.raises(InputError, match="none of its 2 photos was taken near a view"):
        flown_plan(away, planned(), site())
    near = replace(flight([[0, 1]]), plan_sha256="")
    assert len(flown_plan(near, planned(), site()).photographed) == 2


@pytest.mark.long
def test_a_flight_at_another_place_is_refused() -> None:
    elsewhere = replace(flight([[0]]), origin=Origin(1.0, 2.0, 3.0))
    with pytest.raises(InputError, match="do not have the same name and origin; name"):
        flown_plan(elsewhere, planned(), site())


def test_a_site_that_changed_is_a_warning() -> None:
    now = replace(site(), sha256="t" * 64)
    assert codes(flown_plan(flight([[0]]), planned(), now).findings) == {"site-changed"}


def test_photos_without_angles_have_those_of_their_views_and_others_are_counted() -> None:
    unaimed = flight([[0, 1, 2]], heading_deg=None, gimbal_pitch_deg=None)
    stray = photo(9, planned().viewpoints[0], position_enu_m=(30.0, 30.0, 30.0), heading_deg=None)
    more = replace(unaimed, sorties=(replace(unaimed.sorties[0], photos=(*unaimed.sorties[0].photos, stray)),))
    flown = flown_plan(more, planned(), site())
    assert codes(flown.findings) == {"photo-direction"}
    poses = taken_poses(planned(), more.sorties, match_flight(planned(), more.sorties))
    by_id = {view.id: view for view in planned().viewpoints}
    expected = [by_id[identifier].heading_deg for identifier in planned().sorties[0].viewpoint_ids[:3]]
    assert [pose.heading_deg for pose in poses.values()] == pytest.approx(expected)
    assert PhotoRef(0, 3) not in poses


def test_photos_that_belong_to_no_view_count_for_what_they_show() -> None:
    first, second = sizes()
    whole = opened([range(first), range(second)])
    extra = photo(90, planned().viewpoints[0], position_enu_m=(0.0, -20.0, 15.0), heading_deg=0.0, gimbal_pitch_deg=0.0)
    base = flight([range(first - 1), range(second)])
    more = replace(base, sorties=(replace(base.sorties[0], photos=(*base.sorties[0].photos, extra)), base.sorties[1]))
    assert len(flown_plan(more, planned(), site()).poses) == len(whole.poses)


def test_the_sortie_that_was_interrupted_last_is_resumed() -> None:
    first, second = sizes()
    flown = opened([range(first), range(1)])
    assert flown.unfinished_sorties() == (2,)
    rest = resume_flight(flown, prepared=prepared())
    assert rest.plan.sorties[0].viewpoint_ids == planned().sorties[1].viewpoint_ids[1:]
    both = opened([range(first - 1), range(second - 1)])
    assert both.unfinished_sorties() == (2, 1)
    assert resume_flight(both, 1, prepared=prepared()).mission.number == 1


def test_there_must_be_something_to_resume() -> None:
    first, _ = sizes()
    whole = opened([range(first)])
    with pytest.raises(InputError, match="no sortie of this plan was interrupted"):
        resume_flight(whole, prepared=prepared())
    with pytest.raises(MissionError, match="sortie 1 is complete"):
        resume_flight(whole, 1, prepared=prepared())
    with pytest.raises(InputError, match="sortie: expected 1 to 2, got 3"):
        resume_flight(whole, 3, prepared=prepared())


def test_a_battery_that_does_not_last_for_the_rest_is_refused_with_both_times() -> None:
    flown = opened([[0]])
    with pytest.raises(InfeasibleError, match=r"takes \d+ s, but a battery at 93% allows 25 s above the reserve"):
        resume_flight(flown, battery=0.93, prepared=prepared())
    assert resume_flight(flown, battery=1.0, prepared=prepared()).plan.sorties
