"""One verdict on a plan: what the day, the place and the aircraft add to the rules of planning."""

import re
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.mission.readiness import (
    FlightDay,
    Readiness,
    charge_at,
    preflight,
    readiness_findings,
    readiness_of,
)
from groundstation.services.site.edits import HeightReference, set_origin
from planning.base.findings import Finding, Severity
from planning.checks.case import Case
from planning.geo.sun import sun_directions_enu
from planning.parameters import CameraSettings
from planning.plan import Viewpoint
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.top_up import METHOD as TOP_UP
from tests.planning.insight.sun_cases import aimed
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK

NOON = datetime(2026, 6, 21, 4, 20, tzinfo=UTC)
"""At the kiosk, in Hong Kong, the sun stands nearly overhead."""


@cache
def planned():
    model = kiosk()
    return model, plan_flight(model, PlanRequest(n_views=6, greedy=QUICK)).plan


@cache
def case() -> Case:
    model, plan = planned()
    return Case.of(plan, model)


def of(code, findings):
    return [finding for finding in findings if finding.code == code]


def with_views(*views: Viewpoint, **changes) -> Case:
    """A case of these views, on the kiosk without its tree, which would shade it."""
    plan = replace(planned()[1], viewpoints=views, sorties=())
    return Case.of(plan, kiosk(**{"obstacles": (), **changes}))


@pytest.mark.long
@pytest.mark.parametrize(
    ("shutter_s", "severity", "text"),
    [
        (1 / 800, Severity.OK, "EV 15.0"),
        (1 / 8, Severity.WARNING, "even in shade photos would be too bright"),
        (1 / 8000, Severity.WARNING, "stops too dark; open up, expose longer, or raise ISO"),
    ],
)
def test_a_manual_exposure_is_compared_with_the_light_of_the_day(shutter_s, severity, text):
    """Nearly overhead, the sun gives EV 15.2 or so: f/6.3 at ISO 100 wants 1/800 s."""
    settings = CameraSettings("manual", shutter_s, 6.3, 100)
    changed = case().with_plan(replace(case().plan, camera_settings=settings))
    (found,) = of("exposure", readiness_findings(changed, FlightDay(NOON)))
    assert found.severity is severity
    assert text in found.message
    assert of("exposure", readiness_findings(changed)) == [], "without a time nothing is known of the light"
    assert of("exposure", readiness_findings(changed, FlightDay(NOON + timedelta(hours=12)))) == []
    assert of("exposure", readiness_findings(case(), FlightDay(NOON))) == [], "the camera measures it"


# The verdict


@pytest.mark.parametrize(
    ("severities", "verdict"),
    [
        ([], Readiness.READY),
        ([Severity.OK, Severity.NOTE], Readiness.READY),
        ([Severity.OK, Severity.WARNING], Readiness.WITH_WARNINGS),
        ([Severity.WARNING, Severity.ERROR], Readiness.NOT_READY),
    ],
)
def test_the_verdict_is_as_bad_as_the_worst_finding(severities, verdict):
    assert readiness_of([Finding(severity, "x", "x") for severity in severities]) is verdict


@pytest.mark.slow
def test_a_plan_far_below_what_can_be_covered_is_told():
    model, plan = planned()
    bound = plan.coverage.reachable_upper_bound
    few = replace(plan, coverage=replace(plan.coverage, reachable_upper_bound=10 * bound, total=10 * bound))
    (found,) = of("coverage-far", readiness_findings(Case.of(few, model)))
    assert found.severity is Severity.WARNING
    assert found.value == pytest.approx(100.0 * plan.coverage.covered / (10 * bound), rel=0.05)
    last = plan.present_worth.batteries[-1]
    enough = replace(plan.worth, another=replace(last, psnr_db=last.psnr_db + 0.2))
    (found,) = of("coverage-far", readiness_findings(Case.of(replace(few, worth=enough), model)))
    assert found.severity is Severity.NOTE
    assert "0.2 dB better" in found.message
    assert not of("coverage-far", readiness_findings(Case.of(replace(few, method=TOP_UP), model)))
    all_of_it = replace(plan, coverage=replace(plan.coverage, reachable_upper_bound=plan.coverage.covered))
    assert not of("coverage-far", readiness_findings(Case.of(all_of_it, model)))


@pytest.mark.long
def test_a_place_that_may_be_just_the_city_is_told_until_somebody_says_it():
    model, plan = planned()
    city = replace(model, site=replace(model.site, place_from="ifc-site"))
    (found,) = of("place", preflight(plan, city).findings)
    assert "often just the city" in found.message
    said = set_origin(city, 22.0, 114.0, 10.0, HeightReference.ELLIPSOID)
    assert not of("place", preflight(plan, said).findings)


@pytest.mark.long
@pytest.mark.parametrize(("profile", "n_views", "is_told"), [("ardupilot", 400, True), ("m3e", 400, False)])
def test_sorties_that_an_autopilot_cannot_hold_are_told(profile, n_views, is_told):
    plan = planned()[1]
    ids = tuple(f"v{n}" for n in range(n_views))
    sorties = (replace(plan.sorties[0], viewpoint_ids=ids),)
    views = tuple(replace(plan.viewpoints[0], id=name) for name in ids)
    long = replace(case(), plan=replace(plan, profile=profile, sorties=sorties, viewpoints=views))
    from groundstation.services.mission.readiness import _items

    assert bool(list(_items(long))) is is_told


def test_glass_is_not_seen_by_obstacle_sensing_and_near_it_that_is_a_warning():
    (far,) = of("glass-sensing", readiness_findings(case()))
    assert far.severity is Severity.NOTE
    assert far.value == pytest.approx(min(case().measures.solid_gaps.legs_m.values()))
    gaps = case().measures.solid_gaps
    nearer = replace(gaps, legs_m={leg: distance_m - far.value + 4.0 for leg, distance_m in gaps.legs_m.items()})
    closer = replace(case(), measures=replace(case().measures, solid_gaps=nearer))
    (near,) = of("glass-sensing", readiness_findings(closer))
    assert (near.severity, "fly with RTK" in near.message) == (Severity.WARNING, True)
    assert near.value == pytest.approx(4.0)


# Sun


def into_the_mirror(model, at):
    """A view of a panel, from where it shows the sun at a time."""
    corners = np.array(model.site.panels[0].corners_enu_m)
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    normal /= np.linalg.norm(normal)
    origin = model.site.origin
    sun = sun_directions_enu(origin.lat_deg, origin.lon_deg, at, 0.0)
    ray = sun - 2.0 * (sun @ normal) * normal
    return aimed("v0", corners.mean(axis=0) - 12.0 * ray, ray), aimed("v1", corners.mean(axis=0) - 12.0 * ray, sun)


def test_without_a_time_the_sun_is_said_not_to_be_looked_at_and_at_night_that_it_is_down():
    (unknown,) = of("sun", readiness_findings(case()))
    assert (unknown.severity, "no time is planned" in unknown.message) == (Severity.NOTE, True)
    (night,) = of("sun", readiness_findings(case(), FlightDay(NOON + timedelta(hours=12))))
    assert (night.severity, "below the horizon" in night.message) == (Severity.WARNING, True)


def test_a_dazzled_flight_is_told_with_a_better_time_of_the_day():
    at = datetime(2026, 12, 21, 1, 0, tzinfo=UTC)
    mirrored, direct = into_the_mirror(planned()[0], at)
    found = readiness_findings(with_views(mirrored, direct), FlightDay(at))
    (glass,), (sun,) = of("sun-mirrored", found), of("sun-direct", found)
    assert (glass.value, glass.place, sun.value, sun.place) == (1.0, "v0", 1.0, "v1")
    assert "it would be 0" in glass.message
    better = re.search(r"take-off at (\d\d):(\d\d) it", glass.message)
    later = at.replace(hour=int(better[1]), minute=int(better[2]))
    assert [
        each.severity for each in of("sun", readiness_findings(with_views(mirrored, direct), FlightDay(later)))
    ] == [Severity.OK]


def test_a_flight_into_the_night_is_told():
    at = datetime(2026, 12, 21, 9, 43, tzinfo=UTC)
    (found,) = of("sun", readiness_findings(case(), FlightDay(at)))
    assert "sets before the last sortie has landed" in found.message


@pytest.mark.parametrize("at", [datetime(2026, 1, 1), "now"])
def test_a_time_without_a_zone_is_refused(at):
    with pytest.raises((ValueError, AttributeError)):
        FlightDay(at)


# Cold


@given(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0))
def test_charge_falls_with_the_temperature(one, other):
    low, high = sorted((one, other))
    assert 0.0 <= charge_at(low) <= charge_at(high) <= 1.0


@pytest.mark.parametrize(("temperature_c", "severity"), [(25.0, Severity.OK), (-30.0, Severity.WARNING)])
def test_cold_that_takes_the_reserve_is_told(temperature_c, severity):
    plan = planned()[1]
    usable_s = plan.aircraft.endurance_s * (1.0 - plan.rules.battery_reserve)
    long = replace(plan, sorties=(replace(plan.sorties[0], duration_s=0.8 * usable_s),))
    (found,) = of("cold", readiness_findings(replace(case(), plan=long), FlightDay(None, temperature_c)))
    assert found.severity is severity
    assert found.value == pytest.approx(0.8 * usable_s)


def test_half_of_the_charge_is_left_where_the_source_says():
    assert charge_at(-18.0) == pytest.approx(0.5)
    assert charge_at(27.0) == 1.0
