"""One verdict on a plan: what the day, the place and the aircraft add to the rules of planning."""

import math
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.mission.readiness import (
    FlightDay,
    Readiness,
    charge_at,
    dazzled_views,
    preflight,
    readiness_findings,
    readiness_of,
    sun_direction_enu,
)
from groundstation.services.site.edits import HeightReference, set_origin
from planning.base.findings import Finding, Severity
from planning.checks.case import Case
from planning.geo.frames import camera_axes
from planning.plan import Viewpoint
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.top_up import METHOD as TOP_UP
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
    assert not of("coverage-far", readiness_findings(Case.of(replace(few, method=TOP_UP), model)))
    all_of_it = replace(plan, coverage=replace(plan.coverage, reachable_upper_bound=plan.coverage.covered))
    assert not of("coverage-far", readiness_findings(Case.of(all_of_it, model)))


def test_a_place_that_may_be_just_the_city_is_told_until_somebody_says_it():
    model, plan = planned()
    city = replace(model, site=replace(model.site, place_from="ifc-site"))
    (found,) = of("place", preflight(plan, city).findings)
    assert "often just the city" in found.message
    said = set_origin(city, 22.0, 114.0, 10.0, HeightReference.ELLIPSOID)
    assert not of("place", preflight(plan, said).findings)


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


def aimed(name, place, direction):
    """A view from a place along a direction."""
    d = np.array(direction) / np.linalg.norm(direction)
    return Viewpoint(
        name, tuple(map(float, place)), math.degrees(math.atan2(d[0], d[1])), math.degrees(math.asin(d[2]))
    )


def panel_of(model):
    """Centre and outward normal of a panel."""
    corners = np.array(model.site.panels[0].corners_enu_m)
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    return corners.mean(axis=0), normal / np.linalg.norm(normal)


def sunny_time(model, normal):
    """A time at which the sun stands low, in front of a panel."""
    origin = model.site.origin
    for hours in range(24 * 365):
        at = datetime(2026, 1, 1, tzinfo=UTC) + timedelta(hours=hours)
        sun = np.array(sun_direction_enu(origin.lat_deg, origin.lon_deg, at))
        if 0.05 < sun[2] < 0.25 and sun @ normal > 0.5:
            return at, sun
    raise AssertionError("the panel never looks into the sun")


def test_a_view_into_the_sun_and_one_into_its_mirror_image_are_found_and_others_are_not():
    model, _ = planned()
    centre, normal = panel_of(model)
    at, sun = sunny_time(model, normal)
    mirror_ray = sun - 2.0 * (sun @ normal) * normal
    place = centre - 12.0 * mirror_ray
    views = (
        aimed("into-the-sun", place, sun),
        aimed("into-the-mirror", place, mirror_ray),
        aimed("away", place, np.cross(sun, mirror_ray) + np.array([0.0, 0.0, 0.01])),
    )
    found = dazzled_views(with_views(*views), at)
    assert found.direct == ("into-the-sun",)
    assert "into-the-mirror" in found.mirrored
    assert "away" not in (*found.direct, *found.mirrored)
    assert not dazzled_views(with_views(*views, obstacles=planned()[0].site.obstacles), at).mirrored, (
        "the tree shades it"
    )
    # A metre beside the pane there is no glass to mirror it.
    corners = np.array(model.site.facades[0].panels[0].corners_enu_m)
    aside = aimed(
        "beside", place + 40.0 * (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0]), mirror_ray
    )
    assert not dazzled_views(with_views(aside), at).mirrored


def slow_mirrored(case, views, sun):
    """Views whose picture shows the sun in a pane, by reflecting many rays through each picture one by one."""
    camera, found = case.plan.camera, set()
    corners = np.array([panel.corners_enu_m for panel in case.site_model.site.panels])
    for view in views:
        forward, right, up = (
            axis.reshape(3) for axis in camera_axes(math.radians(view.heading_deg), math.radians(view.gimbal_pitch_deg))
        )
        for quad in corners:
            normal = np.cross(quad[2] - quad[0], quad[3] - quad[1])
            normal = normal / np.linalg.norm(normal)
            # The sun's mirror image lies as far behind the pane as the sun before it.
            image = np.array(view.position_enu_m) + 1e9 * sun
            image = image - 2.0 * ((image - quad[0]) @ normal) * normal
            ray = image - np.array(view.position_enu_m)
            ray = ray / np.linalg.norm(ray)
            depth = ray @ forward
            if depth <= 0.0 or sun @ normal <= 0.0:
                continue
            if abs(ray @ right) > camera.sensor_width_mm / (2 * camera.focal_length_mm) * depth:
                continue
            if abs(ray @ up) > camera.sensor_height_mm / (2 * camera.focal_length_mm) * depth:
                continue
            ahead = ((quad[0] - view.position_enu_m) @ normal) / (ray @ normal)
            if ahead <= 0.0:
                continue
            point = np.array(view.position_enu_m) + ahead * ray
            if all(np.cross(quad[(k + 1) % 4] - quad[k], point - quad[k]) @ normal >= -1e-6 for k in range(4)):
                found.add(view.id)
    return found


@pytest.mark.slow
@settings(max_examples=20)
@given(st.integers(0, 8759), st.integers(0, 2**32 - 1))
def test_mirrored_suns_are_those_of_a_slow_reference(hour, seed):
    model, _ = planned()
    origin = model.site.origin
    at = datetime(2026, 1, 1, tzinfo=UTC) + timedelta(hours=hour)
    sun = np.array(sun_direction_enu(origin.lat_deg, origin.lon_deg, at))
    rng = np.random.default_rng(seed)
    centre, normal = panel_of(model)
    views = []
    for n in range(12):
        place = centre + rng.uniform(6, 20) * (normal + 0.6 * rng.standard_normal(3))
        views.append(aimed(f"v{n}", place, centre + rng.uniform(-3, 3, 3) - place))
    scene = with_views(*views)
    found = set(dazzled_views(scene, at).mirrored)
    expected = slow_mirrored(scene, views, sun) if sun[2] > 0.0 else set()
    # The reference knows no shadows: what it finds besides must lie in one.
    assert found <= expected
    assert found == expected or sun[2] < 0.9


def test_without_a_time_the_sun_is_said_not_to_be_looked_at_and_at_night_that_it_is_down():
    (unknown,) = of("sun", readiness_findings(case()))
    assert (unknown.severity, "no time is planned" in unknown.message) == (Severity.NOTE, True)
    (night,) = of("sun", readiness_findings(case(), FlightDay(NOON + timedelta(hours=12))))
    assert (night.severity, "below the horizon" in night.message) == (Severity.WARNING, True)


def test_a_dazzled_flight_is_told_with_a_better_time_of_the_day():
    model, _ = planned()
    centre, normal = panel_of(model)
    at, sun = sunny_time(model, normal)
    ray = sun - 2.0 * (sun @ normal) * normal
    view = aimed("v0", centre - 12.0 * ray, ray)
    found = of("sun-mirrored", readiness_findings(with_views(view), FlightDay(at)))
    assert [finding.value for finding in found] == [1.0]
    assert "it would be 0" in found[0].message


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
