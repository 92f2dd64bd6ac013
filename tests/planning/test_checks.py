"""Pre-flight rules: each kept by a plan and broken alone by the same plan edited by hand; limits; all at once."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import OperationCancelled
from planning.base.findings import Finding, Severity, is_flyable
from planning.checks import RULES, check_plan
from planning.parameters import Constraints, FlightRules, GreedyParameters
from planning.plan import Plan, Sortie, Viewpoint, usual_gsd_m
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.records import Airspace, NoFlyZone, Obstacle, SiteModel
from tests.planning.plan_cases import kiosk, seen_by_contract

HOME = (0.0, -30.0, 0.0)
A, B = (0.0, -12.0, 12.0), (8.0, -14.0, 10.0)


@functools.cache
def site() -> SiteModel:
    return replace(kiosk(), sha256="0" * 64)


@functools.cache
def plan() -> Plan:
    """Two photos from one sortie, with every number right."""
    request = PlanRequest(n_views=6, constraints=Constraints(min_distance_m=5.0), greedy=GreedyParameters(400, False))
    real = plan_flight(site(), request).plan
    viewpoints = (Viewpoint("v0000", A, 0.0, -20.0), Viewpoint("v0001", B, -30.0, -10.0))
    above_home = (0.0, -30.0, 12.0)
    path = (HOME, above_home, A, B, above_home, HOME)
    length = float(np.linalg.norm(np.diff(np.array(path), axis=0), axis=1).sum())
    n_covered = len(seen_by_contract(site(), real.camera, viewpoints, 30.0, occlusion=True))
    coverage = replace(real.coverage, covered=n_covered)
    sortie = Sortie(("v0000", "v0001"), path, length, 70.0)
    return replace(real, viewpoints=viewpoints, sorties=(sortie,), coverage=coverage)


def with_path(*path: tuple[float, float, float]) -> Plan:
    length = float(np.linalg.norm(np.diff(np.array(path), axis=0), axis=1).sum())
    return replace(plan(), sorties=(replace(plan().sorties[0], path_enu_m=path, length_m=length),))


def moved(index: int, **changes: object) -> Plan:
    """A viewpoint changed, and the vertex that stands for it."""
    viewpoints = list(plan().viewpoints)
    viewpoints[index] = replace(viewpoints[index], **changes)
    path = list(plan().sorties[0].path_enu_m)
    path[2 + index] = viewpoints[index].position_enu_m
    edited = with_path(*path)
    return replace(edited, viewpoints=tuple(viewpoints))


def problems(findings: tuple[Finding, ...]) -> dict[str, Finding]:
    """What is not OK, by code, but for durations and coverage, which any move changes."""
    return {f.code: f for f in findings if f.severity is not Severity.OK}


def broken(edited: Plan, site_model: SiteModel | None = None) -> set[str]:
    side_effects = {"duration", "length", "coverage"}
    return set(problems(check_plan(edited, site() if site_model is None else site_model))) - side_effects


def finding(edited: Plan, code: str, text: str = "", site_model: SiteModel | None = None) -> Finding:
    """The one finding with this code whose message holds `text`."""
    found = check_plan(edited, site() if site_model is None else site_model)
    return next(f for f in found if f.code == code and text in f.message)


@pytest.mark.slow
def test_a_good_plan_keeps_every_rule_and_every_measured_value_is_stated() -> None:
    findings = check_plan(plan(), site())
    assert {f.severity for f in findings} == {Severity.OK}
    assert is_flyable(findings)
    codes = {f.code for f in findings}
    assert codes == {
        *("airspace", "low-flight", "distance", "leg-distance", "no-fly", "altitude", "leg-spacing"),
        *("site", "sorties", "gimbal", "heading", "waypoints", "wind", "endurance", "duration", "length"),
        *("photo-interval", "settle", "gsd", "sharpness", "duplicates", "coverage", "return-height"),
        *("camera", "motion-blur", "rolling-shutter", "depth-of-field", "mirror-focus"),
    }
    for f in findings:
        if f.value is not None and f.code not in ("site", "sorties"):
            assert np.isfinite(f.value)


@pytest.mark.long
def test_low_viewpoints_and_paths_are_errors_beside_the_column_above_home() -> None:
    low = finding(moved(0, position_enu_m=(0.0, -12.0, 4.2)), "low-flight")
    assert (low.severity, low.value, low.limit) == (Severity.ERROR, pytest.approx(4.2), 5.0)
    assert low.message.startswith("lowest height above the ground beside the take-off column: 4.2 m, at least 5 m;")
    assert "sortie 1" in low.place
    dipping = with_path(HOME, (0.0, -30.0, 12.0), A, (0.0, -20.0, 4.9), B, (0.0, -30.0, 12.0), HOME)
    assert finding(dipping, "low-flight").value == pytest.approx(4.9)
    assert finding(plan(), "low-flight").severity is Severity.OK, "the column above home does not count"
    lonely = replace(moved(0, position_enu_m=(0.0, -12.0, 4.2)), sorties=())
    assert finding(lonely, "low-flight").place == plan().viewpoints[0].id


@pytest.mark.long
def test_the_lowest_height_is_the_plan_s_or_the_site_s_or_the_usual_and_a_lower_one_is_a_warning() -> None:
    low = moved(0, position_enu_m=(0.0, -12.0, 4.2))
    old = replace(low, constraints=replace(low.constraints, min_height_above_ground_m=None))
    assert finding(old, "low-flight").limit == 5.0
    airspace = replace(site().site.airspace, min_height_above_ground_m=4.0)
    other = replace(site(), site=replace(site().site, airspace=airspace))
    assert finding(old, "low-flight", site_model=other).severity is Severity.OK
    assert finding(old, "low-flight-allowed", site_model=other).severity is Severity.WARNING
    own = replace(low, constraints=replace(low.constraints, min_height_above_ground_m=3.5))
    assert finding(own, "low-flight").limit == 3.5
    allowed = finding(own, "low-flight-allowed")
    assert (allowed.severity, allowed.value, allowed.limit) == (Severity.WARNING, 3.5, 5.0)
    assert "down to 3.5 m above the ground" in allowed.message
    higher = replace(plan(), constraints=replace(plan().constraints, min_height_above_ground_m=30.0))
    assert finding(higher, "low-flight").severity is Severity.ERROR
    assert "low-flight-allowed" not in {f.code for f in check_plan(plan(), site())}


@pytest.mark.long
def test_viewpoint_in_the_wall_is_told_with_its_depth() -> None:
    edited = moved(1, position_enu_m=(0.0, 3.0, 5.0))
    assert broken(edited) == {"distance", "leg-distance"}
    distance = finding(edited, "distance")
    assert distance.severity is Severity.ERROR
    assert (distance.place, distance.limit, distance.unit) == ("v0001", 5.0, "m")
    assert distance.value == pytest.approx(-3.0)
    assert finding(edited, "leg-distance").value == -1.0


@pytest.mark.parametrize(("gap_m", "kept"), [(-0.001, False), (-0.00005, True), (0.0, True), (0.001, True)])
def test_distance_of_viewpoints_is_judged_at_the_limit_but_for_the_rounding_of_files(gap_m: float, kept: bool) -> None:
    edited = moved(0, position_enu_m=(0.0, -5.0 - gap_m, 6.0))
    assert ("distance" not in broken(edited)) is kept
    assert ("leg-distance" not in broken(edited)) is kept
    assert finding(edited, "distance").value == pytest.approx(5.0 + gap_m, abs=1e-9)
    assert finding(edited, "leg-distance").value == pytest.approx(5.0 + gap_m, abs=1e-9)


def test_leg_through_the_building_is_told_with_sortie_and_leg() -> None:
    behind = (0.0, 20.0, 8.0)
    edited = with_path(HOME, (0.0, -30.0, 12.0), A, B, (20.0, 20.0, 12.0), behind, (0.0, -30.0, 5.0), HOME)
    assert broken(edited) == {"leg-distance"}
    leg = finding(edited, "leg-distance")
    assert (leg.place, leg.value, leg.limit) == ("sortie 1, leg 6", 0.0, 5.0)
    assert leg.severity is Severity.ERROR


def test_without_any_distance_to_keep_a_leg_through_the_building_is_still_refused() -> None:
    through = replace(
        with_path(
            HOME, (0.0, -30.0, 4.0), A, B, (0.0, -15.0, 4.0), (0.0, 15.0, 4.0), (30.0, 15.0, 4.0), *_home_again()
        ),
        constraints=replace(plan().constraints, min_distance_m=0.0),
    )
    assert finding(through, "leg-distance").severity is Severity.ERROR
    along = replace(plan(), constraints=through.constraints)
    assert broken(along) == set()


def _home_again() -> tuple[tuple[float, float, float], ...]:
    return ((30.0, -30.0, 4.0), (0.0, -30.0, 4.0), HOME)


@pytest.mark.parametrize(("x", "kept"), [(-20.0, False), (-20.0001, False), (-19.999, True)])
def test_path_that_touches_a_no_fly_volume_is_refused(x: float, kept: bool) -> None:
    edited = with_path(HOME, (0.0, -30.0, 12.0), A, B, (x, -25.0, 12.0), (0.0, -30.0, 12.0), HOME)
    assert broken(edited) == (set() if kept else {"no-fly"})
    found = finding(edited, "no-fly")
    assert found.limit == 0.0
    assert found.place.startswith("sortie 1, leg")
    if kept:
        assert found.value == pytest.approx(0.001, abs=1e-9)


def test_path_wholly_inside_a_no_fly_volume_is_refused_and_a_site_without_any_says_so() -> None:
    zone = NoFlyZone("all", ((-39.0, -39.0), (39.0, -39.0), (39.0, 39.0), (-39.0, 39.0)), -5.0, 60.0)
    inside = replace(site(), site=replace(site().site, airspace=replace(site().site.airspace, no_fly=(zone,))))
    found = finding(plan(), "no-fly", site_model=inside)
    assert (found.severity, found.value) == (Severity.ERROR, -1.0)
    free = replace(site(), site=replace(site().site, airspace=replace(site().site.airspace, no_fly=())))
    assert finding(plan(), "no-fly", site_model=free).message == "the site has no no-fly volumes"


@pytest.mark.parametrize(
    ("position", "value"),
    [((0.0, -12.0, 2.999), 0.001), ((0.0, -12.0, 40.5), 0.5), ((41.0, -39.0, 12.0), 1.0), ((0.0, -43.0, 12.0), 3.0)],
)
def test_viewpoint_outside_the_airspace_is_told_by_how_much(position: tuple[float, float, float], value: float) -> None:
    edited = moved(0, position_enu_m=position)
    assert broken(edited) - {"low-flight"} == {"airspace"}
    for subject in ("viewpoints outside", "paths outside"):
        found = finding(edited, "airspace", subject)
        assert found.severity is Severity.ERROR
        assert found.value == pytest.approx(value)
        assert found.place in ("v0000", "sortie 1")


def test_only_the_column_above_home_may_lie_below_the_airspace() -> None:
    beside = with_path(HOME, (0.0, -30.0, 12.0), A, B, (0.2, -30.0, 3.0), (0.2, -30.0, 1.0), HOME)
    assert finding(beside, "airspace", "paths").value == pytest.approx(3.0), "the last leg comes down to the ground"
    sunk = with_path(HOME, (0.0, -30.0, -4.0), (0.0, -30.0, 12.0), A, B, (0.0, -30.0, 12.0), HOME)
    found = finding(sunk, "airspace", "paths")
    assert (found.severity, found.value) == (Severity.ERROR, 4.0)
    on_a_roof = kiosk(home_enu_m=(0.0, -30.0, 8.0))
    high = with_path((0.0, -30.0, 8.0), (0.0, -30.0, 12.0), A, B, (0.0, -30.0, 5.0), (0.0, -30.0, 8.0))
    assert finding(high, "airspace", "paths", on_a_roof).severity is Severity.OK


@pytest.mark.parametrize(("top_m", "kept"), [(120.0, True), (120.2, False)])
def test_height_above_ground_that_needs_a_permit_is_a_warning(top_m: float, kept: bool) -> None:
    tall = kiosk(airspace=Airspace((-40.0, -40.0, 3.0), (40.0, 40.0, 200.0), ground_z_m=-2.0))
    tall = replace(tall, sha256="0" * 64)
    top = (0.0, -30.0, top_m - 2.0)
    edited = with_path(HOME, top, A, B, (0.0, -30.0, 12.0), HOME)
    assert broken(edited, tall) == (set() if kept else {"altitude"})
    found = finding(edited, "altitude", site_model=tall)
    assert (found.value, found.limit) == (pytest.approx(top_m), 120.0)
    assert found.severity is (Severity.OK if kept else Severity.WARNING)


@pytest.mark.parametrize(("spacing_m", "kept"), [(0.501, True), (0.499, False), (0.0, True)])
def test_waypoints_closer_than_firmware_likes_are_a_warning_but_at_one_place_they_are_fine(
    spacing_m: float, kept: bool
) -> None:
    edited = moved(1, position_enu_m=(A[0] + spacing_m, *A[1:]))
    assert broken(edited) == (set() if kept else {"leg-spacing"})
    if spacing_m:
        assert finding(edited, "leg-spacing", "shortest").value == pytest.approx(spacing_m)


@pytest.mark.parametrize(
    ("length_m", "severity"), [(1990.0, Severity.OK), (2010.0, Severity.WARNING), (5010.0, Severity.ERROR)]
)
def test_legs_too_long_for_autopilots_are_told(length_m: float, severity: Severity) -> None:
    wide = kiosk(airspace=Airspace((-40.0, -9000.0, 3.0), (40.0, 40.0, 40.0), ground_z_m=0.0))
    wide = replace(wide, sha256="0" * 64)
    far = (0.0, -30.0 - length_m, 12.0)
    edited = with_path(HOME, (0.0, -30.0, 12.0), A, B, (0.0, -30.0, 12.0), far, (0.0, -30.0, 12.0), HOME)
    found = finding(edited, "leg-spacing", "longest", wide)
    assert found.severity is severity
    assert found.value == pytest.approx(length_m)


def test_plan_of_another_site_is_refused_and_a_changed_file_is_a_warning() -> None:
    changed = replace(plan(), site_sha256="1" * 64)
    assert finding(changed, "site").severity is Severity.WARNING
    other = replace(changed, site="court")
    found = finding(other, "site")
    assert found.severity is Severity.ERROR
    assert "made for site 'court', this is 'kiosk'" in found.message
    renamed = replace(plan(), site="old name")
    assert finding(renamed, "site").severity is Severity.OK, "the very same file"
    without = replace(plan(), site_sha256="")
    assert finding(without, "site").severity is Severity.OK
    assert "does not say" in finding(without, "site").message
    assert finding(replace(without, site="court"), "site").severity is Severity.ERROR


@pytest.mark.parametrize(
    ("ids", "n_wrong"), [(("v0000",), 1), (("v0000", "v0001", "v0001"), 1), ((), 2), (("v0001", "v0000"), 0)]
)
def test_viewpoints_in_no_or_several_sorties_or_out_of_order_are_refused(ids: tuple[str, ...], n_wrong: int) -> None:
    edited = replace(plan(), sorties=(replace(plan().sorties[0], viewpoint_ids=ids),))
    assert broken(edited) == ({"sorties"} if n_wrong else set()) | ({"path"} if ids == ("v0001", "v0000") else set())
    found = finding(edited, "sorties" if n_wrong else "path")
    assert found.severity is Severity.ERROR
    if n_wrong:
        assert found.value == n_wrong
        assert f"{n_wrong} viewpoints are not in exactly one sortie" in found.message


def test_viewpoint_in_two_sorties_is_refused() -> None:
    edited = replace(plan(), sorties=(plan().sorties[0], replace(plan().sorties[0], viewpoint_ids=("v0001",))))
    assert broken(edited) == {"sorties"}
    assert finding(edited, "sorties").place == "v0001"


def test_plan_without_sorties_or_with_paths_that_do_not_begin_and_end_at_home_is_refused() -> None:
    assert "no sorties" in finding(replace(plan(), sorties=()), "sorties", "no sorties").message
    short = replace(plan(), sorties=(replace(plan().sorties[0], path_enu_m=(HOME,)),))
    assert "has 1 points" in finding(short, "path").message
    elsewhere = with_path((0.0, -28.0, 6.0), A, B, (3.0, -30.0, 6.0))
    starts, ends = (finding(elsewhere, "path", verb) for verb in ("starts", "ends"))
    assert starts.value == pytest.approx(np.sqrt(40.0))
    assert ends.value == pytest.approx(np.sqrt(45.0))
    assert broken(elsewhere) == {"path"}


def test_path_that_passes_beside_a_viewpoint_is_refused() -> None:
    edited = with_path(HOME, (0.0, -30.0, 12.0), (A[0], A[1] - 0.01, A[2]), B, (0.0, -30.0, 12.0), HOME)
    assert broken(edited) == {"path"}
    near = with_path(HOME, (0.0, -30.0, 12.0), (A[0], A[1] - 0.0005, A[2]), B, (0.0, -30.0, 12.0), HOME)
    assert broken(near) == set()


@pytest.mark.parametrize(("pitch_deg", "kept"), [(35.0, True), (35.01, False), (-90.0, True), (-90.01, False)])
def test_gimbal_keeps_its_range(pitch_deg: float, kept: bool) -> None:
    edited = moved(0, gimbal_pitch_deg=pitch_deg)
    assert broken(edited) == (set() if kept else {"gimbal"})
    found = finding(edited, "gimbal", "highest" if pitch_deg > 0.0 else "lowest")
    assert (found.value, found.limit, found.place) == (pitch_deg, 35.0 if pitch_deg > 0.0 else -90.0, "v0000")


@pytest.mark.parametrize(("heading_deg", "kept"), [(180.0, True), (-179.999, True), (-180.0, False), (270.0, False)])
def test_headings_are_as_mission_files_want_them(heading_deg: float, kept: bool) -> None:
    edited = moved(0, heading_deg=heading_deg)
    assert broken(edited) == (set() if kept else {"heading"})


@pytest.mark.parametrize(("limit", "kept"), [(4, True), (3, False)])
def test_more_waypoints_than_the_aircraft_takes_are_refused(limit: int, kept: bool) -> None:
    edited = replace(plan(), aircraft=replace(plan().aircraft, max_waypoints=limit))
    assert broken(edited) == (set() if kept else {"waypoints"})
    assert (finding(edited, "waypoints").value, finding(edited, "waypoints").limit) == (4.0, float(limit))


def flown_s() -> float:
    """What the duration rule measures for the good plan."""
    endurance = finding(plan(), "endurance")
    assert endurance.value is not None
    return endurance.value


@pytest.mark.parametrize(("spare_s", "kept"), [(0.02, True), (-0.05, False)])
def test_endurance_keeps_its_reserve(spare_s: float, kept: bool) -> None:
    rules = replace(plan().rules, battery_reserve=1.0 - (flown_s() + spare_s) / plan().aircraft.endurance_s)
    edited = replace(plan(), rules=rules)
    assert ("endurance" not in broken(edited)) is kept
    found = finding(edited, "endurance")
    assert found.limit == pytest.approx(flown_s() + spare_s)
    assert found.place == "sortie 1"


def test_endurance_believes_the_longer_of_the_stated_and_the_measured_duration() -> None:
    long = replace(plan(), sorties=(replace(plan().sorties[0], duration_s=1900.0),))
    assert broken(long) == {"endurance"}
    assert finding(long, "endurance").value == 1900.0
    short = replace(plan(), sorties=(replace(plan().sorties[0], duration_s=1.0),))
    assert finding(short, "endurance").value == pytest.approx(finding(short, "duration").limit, rel=0.2)
    assert finding(short, "duration").severity is Severity.WARNING


@pytest.mark.parametrize(("factor", "kept"), [(1.0, True), (1.009, True), (1.011, False), (0.9, False)])
def test_stated_lengths_are_right_within_a_hundredth(factor: float, kept: bool) -> None:
    length = plan().sorties[0].length_m
    edited = replace(plan(), sorties=(replace(plan().sorties[0], length_m=length * factor),))
    found = finding(edited, "length")
    assert found.severity is (Severity.OK if kept else Severity.WARNING)
    assert found.value == pytest.approx(abs(factor - 1.0) * length, abs=1e-9)


@pytest.mark.parametrize(("wind_m_s", "kept"), [(11.9, True), (12.0, False)])
def test_wind_beyond_the_aircraft_is_an_error_and_what_else_can_be_checked_is(wind_m_s: float, kept: bool) -> None:
    edited = replace(plan(), rules=replace(plan().rules, wind_m_s=wind_m_s))
    assert broken(edited) - {"endurance"} == (set() if kept else {"wind"})
    assert (finding(edited, "wind").value, finding(edited, "wind").limit) == (wind_m_s, 12.0)
    slow = replace(plan(), aircraft=replace(plan().aircraft, max_speed_m_s=5.0), rules=FlightRules(wind_m_s=6.0))
    assert "makes no headway" in finding(slow, "wind").message


def one_place(settle_s: float, photo_s: float, heading_deg: float) -> Plan:
    """Both photos from the same place, a small turn apart."""
    edited = moved(1, position_enu_m=A, heading_deg=heading_deg, gimbal_pitch_deg=-20.0)
    return replace(edited, rules=FlightRules(settle_s=settle_s, photo_s=photo_s))


@pytest.mark.parametrize(("photo_s", "kept"), [(0.51, True), (0.49, False)])
def test_photos_faster_than_the_camera_are_refused(photo_s: float, kept: bool) -> None:
    # 12 degrees at 60 deg/s are 0.2 s; the camera wants 0.7 s.
    edited = one_place(0.0, photo_s, 12.0)
    assert ("photo-interval" not in broken(edited)) is kept
    found = finding(edited, "photo-interval")
    assert found.value == pytest.approx(0.2 + photo_s)
    assert (found.limit, found.place) == (0.7, "sortie 1, v0001")


def test_photos_apart_have_the_time_of_the_leg_between_them() -> None:
    edited = replace(plan(), rules=FlightRules(settle_s=0.0, photo_s=0.0))
    assert "photo-interval" not in broken(edited)
    value = finding(edited, "photo-interval").value
    assert value is not None
    assert value > 2.0
    path = (HOME, (0.0, -30.0, 12.0), A, (0.0, -30.0, 12.0), HOME)
    alone = replace(plan(), viewpoints=plan().viewpoints[:1], sorties=(Sortie(("v0000",), path, 80.0, 70.0),))
    assert "photo-interval" not in {f.code for f in check_plan(alone, site())}, "one photo has no interval"


@pytest.mark.parametrize(("settle_s", "kept"), [(1.0, True), (0.9, False)])
def test_little_time_to_settle_is_a_warning(settle_s: float, kept: bool) -> None:
    found = finding(replace(plan(), rules=replace(plan().rules, settle_s=settle_s)), "settle")
    assert found.severity is (Severity.OK if kept else Severity.WARNING)
    assert (found.value, found.limit) == (settle_s, 1.0)


@pytest.mark.parametrize(("allowed", "kept"), [(1.001, True), (0.999, False)])
def test_photos_too_coarse_to_count_are_a_warning(allowed: float, kept: bool) -> None:
    centroids = [np.mean(panel.corners_enu_m, axis=0) for panel in site().site.panels]
    seen = seen_by_contract(site(), plan().camera, plan().viewpoints[1:], 30.0, occlusion=True)
    nearest = min(float(np.linalg.norm(centroids[j] - B)) for j, _ in seen)
    edited = replace(plan(), constraints=replace(plan().constraints, max_distance_m=allowed * nearest))
    assert ("gsd" not in broken(edited)) is kept
    found = finding(edited, "gsd")
    assert found.severity is (Severity.OK if kept else Severity.WARNING)
    assert found.place == "v0001"
    assert found.value == pytest.approx(1e3 * plan().camera.gsd_m(nearest))
    assert found.limit == pytest.approx(allowed * found.value)


def best_gsd_mm(viewpoints: tuple[Viewpoint, ...]) -> dict[tuple[int, int], float]:
    """Pixel of the nearest view of each covered section, by the contract."""
    centroids = [np.mean(panel.corners_enu_m, axis=0) for panel in site().site.panels]
    best: dict[tuple[int, int], float] = {}
    for viewpoint in viewpoints:
        for panel, section in seen_by_contract(site(), plan().camera, (viewpoint,), 30.0, occlusion=True):
            away_m = float(np.linalg.norm(centroids[panel] - np.array(viewpoint.position_enu_m)))
            best[panel, section] = min(best.get((panel, section), math.inf), 1e3 * plan().camera.gsd_m(away_m))
    return best


def test_sections_seen_too_coarsely_are_counted_and_the_coarsest_is_named() -> None:
    best = best_gsd_mm(plan().viewpoints)
    coarsest = max(best.values())
    for wanted in (0.999 * min(best.values()), float(np.median(list(best.values()))) * 1.0001, 1.001 * coarsest):
        n_coarse = sum(gsd > wanted for gsd in best.values())
        found = finding(with_wanted(wanted), "sharpness")
        assert found.value == n_coarse
        assert found.severity is (Severity.WARNING if n_coarse else Severity.OK)
        assert f"larger than {wanted:.1f} mm: {n_coarse} of {len(best)} covered" in found.message
        assert f"coarsest with {coarsest:.1f} mm" in found.message
        worst = {site().site.panels[panel].id for (panel, _), gsd in best.items() if gsd > coarsest - 1e-9}
        assert found.place in worst
    any_pixel = check_plan(with_wanted(0.0), site())
    assert "sharpness" not in {found.code for found in any_pixel}


def with_wanted(gsd_mm: float) -> Plan:
    return replace(plan(), constraints=replace(plan().constraints, wanted_gsd_mm=gsd_mm))


def test_plans_that_do_not_say_which_pixel_they_want_are_held_to_the_usual_one() -> None:
    limit_mm = 1e3 * usual_gsd_m(plan().camera, plan().constraints.min_distance_m)
    old = replace(plan(), constraints=replace(plan().constraints, wanted_gsd_mm=None))
    assert finding(old, "sharpness") == finding(with_wanted(limit_mm), "sharpness")


def test_repeated_photos_are_a_warning() -> None:
    edited = moved(1, position_enu_m=A, heading_deg=0.0, gimbal_pitch_deg=-20.0)
    assert broken(edited) == {"duplicates"}
    assert finding(edited, "duplicates").value == 1.0


def test_wrong_coverage_numbers_are_a_warning_and_no_coverage_an_error() -> None:
    right = plan().coverage
    for wrong in (replace(right, covered=right.covered + 1), replace(right, total=right.total + 36)):
        found = finding(replace(plan(), coverage=wrong), "coverage")
        assert found.severity is Severity.WARNING
        assert f"{right.covered} of {right.total} sections are covered" in found.message
    away = replace(plan(), viewpoints=tuple(replace(v, heading_deg=180.0) for v in plan().viewpoints))
    nothing = finding(away, "coverage", "no panel")
    assert (nothing.severity, nothing.value) == (Severity.ERROR, 0.0)


def test_occlusion_left_to_the_scene_is_decided_by_it() -> None:
    auto = replace(plan(), constraints=replace(plan().constraints, occlusion="auto"))
    assert finding(auto, "coverage").message == finding(plan(), "coverage").message


def test_all_findings_come_at_once() -> None:
    edited = replace(
        moved(1, position_enu_m=(0.0, 3.0, 41.0), gimbal_pitch_deg=60.0, heading_deg=-180.0),
        site="court",
        site_sha256="1" * 64,
        aircraft=replace(plan().aircraft, max_waypoints=2, endurance_s=60.0),
        rules=replace(plan().rules, settle_s=0.0),
    )
    edited = replace(edited, sorties=(*edited.sorties, Sortie(("v0000",), (), 0.0, 0.0)))
    expected = {"airspace", "gimbal", "heading", "site", "waypoints", "endurance", "settle", "sorties", "path"}
    assert expected <= broken(edited)
    assert not is_flyable(check_plan(edited, site()))


def test_plan_on_a_site_whose_home_cannot_be_used_is_measured_all_the_same() -> None:
    inside = kiosk(home_enu_m=(0.0, 4.0, 0.0))
    assert {"path", "airspace"} <= broken(plan(), inside)


def test_plan_without_viewpoints_is_refused_without_failing() -> None:
    empty = replace(plan(), viewpoints=(), sorties=())
    assert {"sorties"} <= broken(empty)
    assert "coverage" in problems(check_plan(empty, site()))


def test_new_obstacle_is_found() -> None:
    crane = Obstacle("crane", box_enu_m=((2.0, -14.0, 0.0), (5.0, -12.5, 30.0)))
    found = finding(plan(), "leg-distance", site_model=kiosk(obstacles=(crane,)))
    assert found.severity is Severity.ERROR
    assert found.place == "sortie 1, leg 3"


def test_every_rule_reports_progress_and_can_be_cancelled() -> None:
    reports: list[float] = []

    class Listening:
        def __init__(self, fail: Callable[[], None] | None = None) -> None:
            self.fail = fail

        def report(self, stage: str, done: float, total: float) -> None:
            reports.append(done)
            if self.fail is not None:
                self.fail()

    check_plan(plan(), site(), Listening())
    assert reports == [0, *range(len(RULES))]

    def cancel() -> None:
        raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        check_plan(plan(), site(), Listening(cancel))
