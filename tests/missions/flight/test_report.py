"""The flight report: what was flown against what was planned, rule by rule."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.flight.outcome import Ending, FlightReport, Reason
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track
from missions.flight.report import BESIDE_M, Limits, closest, lowest, report_case, report_text, report_to_json
from missions.flight.report_rules import ENDED_BADLY, ENDINGS, REASONS, nearest_in_time_m
from planning.base.findings import Finding, Severity
from planning.checks.case import Case
from planning.geo.frames import aim
from planning.parameters import Constraints
from planning.plan import Plan, Viewpoint
from planning.site.bundled import ORIGIN
from planning.site.records import SiteModel
from tests.missions.flight.flights import cut_at, flown_as_planned, moved, never_taken, with_durations, with_photos
from tests.missions.plans import make_plan
from tests.planning.plan_cases import dense_points, distances, kiosk, seen_by_contract, solid_triangles
from tests.planning.site.test_terrain import terrain

Records = tuple[FlightRecord, ...]


@functools.cache
def site() -> SiteModel:
    return replace(kiosk(), sha256="0" * 64)


@functools.cache
def plan() -> Plan:
    """Twelve views in front of the southern side."""
    views = []
    for i in range(12):
        position = (-11.0 + 2.0 * i, -9.0 - 1.3 * (i % 4), 5.0 + 2.0 * (i % 3))
        heading, pitch = aim(np.array([-4.0 + 0.7 * i, 0.0, 1.5 + 3.0 * (i % 3)]) - np.array(position))
        views.append(Viewpoint(f"v{i:04d}", position, float(np.degrees(heading)), float(np.degrees(pitch))))
    made = make_plan([(views, {})], ORIGIN, home=site().site.home_enu_m)
    constraints = Constraints(min_distance_m=5.0, occlusion="on")
    return with_durations(replace(made, site="kiosk", site_sha256=site().sha256, constraints=constraints))


@functools.cache
def case() -> Case:
    return Case.of(plan(), site())


@functools.cache
def flown() -> Records:
    return flown_as_planned(plan())


def n_seen(views: tuple[Viewpoint, ...]) -> int:
    """Sections that views cover, by the contract's words."""
    return len(seen_by_contract(site(), plan().camera, views, 30.0, occlusion=True))


def report(records: Records, limits: Limits | None = None) -> FlightReport:
    return report_case(case(), records, limits or Limits())


def problems(found: tuple[Finding, ...]) -> dict[str, Finding]:
    """Findings that are not OK, by code."""
    return {finding.code: finding for finding in found if finding.severity is not Severity.OK}


def photos(change: Callable[[tuple[TakenPhoto, ...]], tuple[TakenPhoto, ...]]) -> Records:
    """The flight with other photos in its first record."""
    return (with_photos(flown()[0], change), *flown()[1:])


def tracked(**changes: np.ndarray) -> Records:
    """The flight with other columns in its first track."""
    track = flown()[0].track
    columns = {name: getattr(track, name) for name in Track.__slots__}
    return (replace(flown()[0], track=Track(**{**columns, **changes})), *flown()[1:])


def n_samples() -> int:
    """Samples of the first track."""
    return len(flown()[0].track.time_s)


def lasting(times: float) -> FlightRecord:
    """The first record, so many times as long."""
    return replace(flown()[0], duration_s=times * (flown()[0].duration_s or 0.0))


def at(index: int, change: Callable[[TakenPhoto], TakenPhoto]) -> Records:
    """The flight with one photo changed."""
    return photos(lambda p: (*p[:index], change(p[index]), *p[index + 1 :]))


def test_a_flight_as_planned_breaks_no_rule() -> None:
    made = report(flown())
    assert problems(made.findings) == {}
    assert made.summary.covered == made.summary.covered_planned == n_seen(plan().viewpoints)
    assert (made.summary.n_taken, made.summary.n_photos) == (12, 12)
    assert made.summary.lost_panels == ()
    assert made.summary.duration_flown_s == pytest.approx(plan().duration_s - 30.0)
    assert {finding.code for finding in made.findings} >= {"position", "heading", "gimbal", "coverage", "distance"}
    for view in made.views:
        assert view.position_error_m == view.heading_error_deg == view.gimbal_pitch_error_deg == 0.0
        assert view.n_flown == view.n_planned
        assert view.blur_px == pytest.approx(0.0, abs=1e-9)


def test_coverage_is_that_of_the_poses_really_flown() -> None:
    records = photos(lambda taken: tuple(moved(p, (0.4, -1.0, 0.7), 6.0) for p in taken[2:]))
    views = [
        Viewpoint("p", photo.position_enu_m, photo.heading_deg or 0.0, photo.gimbal_pitch_deg or 0.0)
        for record in records
        for photo in record.photos
    ]
    expected = n_seen(tuple(views))
    summary = report(records).summary
    assert summary.covered == expected
    assert summary.covered < summary.covered_planned


@pytest.mark.parametrize(
    ("records", "code", "severity", "value"),
    [
        (lambda: (never_taken(flown()[0], 3),), "views-taken", Severity.ERROR, 11.0),
        (lambda: photos(lambda p: p[:3] + p[4:]), "views-taken", Severity.WARNING, 11.0),
        (lambda: photos(lambda p: p[:3] + p[5:]), "reports-lost", Severity.WARNING, 2.0),
        (lambda: at(2, lambda p: moved(p, (0.6, 0.0, 0.0))), "position", Severity.ERROR, 0.6),
        (lambda: at(2, lambda p: moved(p, (0.0, 0.0, 0.0), -3.5)), "heading", Severity.ERROR, 3.5),
        (lambda: at(2, lambda p: replace(p, gimbal_pitch_deg=p.gimbal_pitch_deg - 2.5)), "gimbal", Severity.ERROR, 2.5),
        (lambda: at(2, lambda p: replace(p, speed_m_s=30.0)), "blur", Severity.WARNING, None),
        (lambda: at(2, lambda p: replace(p, heading_deg=None)), "heading-unknown", Severity.WARNING, 1.0),
        (lambda: photos(lambda p: p[:6]), "coverage", Severity.ERROR, None),
        (lambda: photos(lambda p: (p[0], *p)), "photos-extra", Severity.NOTE, 1.0),
        (lambda: (lasting(1.2),), "duration", Severity.WARNING, 20.0),
        (lambda: tracked(battery=np.linspace(1.0, 0.2, n_samples())), "battery", Severity.WARNING, 20.0),
        (lambda: (replace(flown()[0], sortie=7),), "sortie-swapped", Severity.WARNING, None),
        (lambda: (), "no-flight", Severity.ERROR, None),
    ],
)  # fmt: skip
def test_what_breaks_a_limit_is_found(
    records: Callable[[], Records], code: str, severity: Severity, value: float | None
) -> None:
    found = problems(report(records()).findings)
    assert found[code].severity is severity
    if value is not None:
        assert found[code].value == pytest.approx(value)


def test_one_broken_limit_breaks_no_other() -> None:
    found = problems(report(at(2, lambda p: moved(p, (0.0, 0.0, 0.0), 3.5))).findings)
    assert set(found) <= {"heading", "coverage"}


def test_the_distance_kept_is_found_between_samples_of_the_track() -> None:
    triangles = solid_triangles(site())
    path = np.array([[-30.0, -20.0, 12.0], [30.0, -3.0, 6.0], [30.0, 30.0, 6.0]])
    track = sparse_track(path, np.array([0.0, 1.9, 3.8]))
    least = closest(case().space.solids, track)
    assert least is not None
    expected = distances(dense_points(path, 0.02), triangles).min()
    assert expected - 0.02 <= least[0] <= expected
    assert least[0] < distances(path, triangles).min() - 1.0
    assert least[1] == 0.0


def sparse_track(points: np.ndarray, time_s: np.ndarray) -> Track:
    """A track of positions only."""
    n = len(points)
    unknown = np.full(n, np.nan)
    return Track(time_s, points, np.full((n, 3), np.nan), unknown, unknown, unknown, unknown)


def test_no_straight_line_is_drawn_over_a_gap() -> None:
    through = np.array([[-30.0, 4.0, 5.0], [30.0, 4.0, 5.0]])
    least = closest(case().space.solids, sparse_track(through, np.array([0.0, 1.0])))
    assert least == (0.0, 0.0, (-30.0, 4.0, 5.0))
    over_gap = closest(case().space.solids, sparse_track(through, np.array([0.0, 60.0])))
    assert over_gap is not None
    assert over_gap[0] > 10.0


def test_inside_a_solid_the_distance_is_negative() -> None:
    least = closest(case().space.solids, sparse_track(np.array([[0.0, 4.0, 5.0]]), np.zeros(1)))
    assert least is not None
    assert least[0] == pytest.approx(-4.0)


def test_two_aircraft_that_cross_are_nearest_between_their_samples() -> None:
    """One flies east, the other north 8 m higher; each would be at the crossing 2 s after the other."""
    time_s = np.array([0.0, 20.0])
    east = sparse_track(np.array([[-50.0, 0.0, 10.0], [50.0, 0.0, 10.0]]), time_s)
    north = sparse_track(np.array([[0.0, -50.0, 18.0], [0.0, 50.0, 18.0]]), time_s)
    distance_m, at_s = nearest_in_time_m(east, north, 2.0) or (math.nan, math.nan)
    assert distance_m == pytest.approx(math.hypot(8.0, 10.0 / math.sqrt(2.0)))
    assert at_s == pytest.approx(11.0)
    assert nearest_in_time_m(east, north, 20.5) is None
    assert nearest_in_time_m(east, sparse_track(np.full((2, 3), np.nan), time_s), 0.0) is None


@given(st.integers(1, 9), st.integers(1, 9), st.floats(-30.0, 30.0), st.integers(0, 2**32 - 1))
def test_no_moment_of_two_tracks_is_nearer_than_the_nearest(n: int, m: int, later_s: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    one, other = (
        sparse_track(
            np.round(rng.normal(scale=30.0, size=(k, 3))), np.sort(rng.choice(30, k, replace=False)).astype(float)
        )
        for k in (n, m)
    )
    found = nearest_in_time_m(one, other, later_s)
    first, last = (end(one.time_s[pick], other.time_s[pick] + later_s) for end, pick in ((max, 0), (min, -1)))
    assert (found is None) == (first > last)
    if found is not None:
        moments_s = np.concatenate([np.linspace(first, last, 400), [found[1]]])
        gaps = [
            np.interp(moments_s, one.time_s, one.position_enu_m[:, axis])
            - np.interp(moments_s, other.time_s + later_s, other.position_enu_m[:, axis])
            for axis in range(3)
        ]
        sampled_m = np.linalg.norm(gaps, axis=0)
        assert found[0] <= sampled_m.min() + 1e-6


@pytest.mark.parametrize(("short_m", "severity"), [(0.3, Severity.WARNING), (0.8, Severity.ERROR)])
def test_too_close_by_more_than_positions_may_err_is_an_error(short_m: float, severity: Severity) -> None:
    before = flown()[0].track.position_enu_m
    strayed = before.copy()
    strayed[len(strayed) // 2] = (0.0, -(5.0 - short_m), 4.0)
    found = problems(report(tracked(position_enu_m=strayed)).findings)["distance"]
    assert found.severity is severity
    assert found.value is not None
    assert found.value == pytest.approx(5.0 - short_m, abs=0.01)


def test_blur_adds_speed_and_turning() -> None:
    track, photo = flown()[0].track, flown()[0].photos[4]
    turn_rad_s, speed_m_s, exposure_s = 0.3, 1.5, 0.004
    turning = track.gimbal_heading_rad + turn_rad_s * (track.time_s - photo.time_s)
    records = tracked(gimbal_heading_rad=turning)
    records = (with_photos(records[0], lambda p: tuple(replace(x, speed_m_s=speed_m_s) for x in p)), *records[1:])
    view = report(records, Limits(exposure_s=exposure_s)).views[4]
    sight = case().measures.seen[
        next((v.position_enu_m, v.heading_deg, v.gimbal_pitch_deg) for v in plan().viewpoints if v.id == view.view_id)
    ]
    camera = plan().camera
    moved_px = speed_m_s * exposure_s / camera.gsd_m(sight.nearest_m)
    turned_px = turn_rad_s * exposure_s / (camera.sensor_width_mm / camera.focal_length_mm / camera.image_width_px)
    assert view.blur_px == pytest.approx(moved_px + turned_px, rel=0.02)


def test_without_photos_everything_is_missing_and_nothing_is_covered() -> None:
    made = report(photos(lambda _: ()))
    assert made.summary.covered == 0
    assert {view.reason for view in made.views} == {Reason.NO_PHOTO}
    assert len(made.summary.lost_panels) > 0
    assert {"views-taken", "coverage", "panels-lost"} <= set(problems(made.findings))
    assert "0 of 12 views" in report_text(made)


def test_an_aborted_sortie_is_judged_by_neither_duration_nor_success() -> None:
    made = report((cut_at(flown()[0], flown()[0].photos[5].time_s + 0.5),))
    assert [view.reason for view in made.views] == [Reason.TAKEN] * 6 + [Reason.FLIGHT_ENDED] * 6
    assert "duration" not in {finding.code for finding in made.findings}
    assert made.summary.duration_flown_s is None
    assert problems(made.findings)["views-taken"].severity is Severity.ERROR


@pytest.mark.parametrize(
    ("events", "ending"),
    [
        ([("order", "returning home: done", 0.3), ("mode", "RTL", 1.0)], Ending.RETURN),
        ([("mode", "RTL", 1.0)], Ending.RETURN),
        ([("order", "landing here: done", 1.2), ("mode", "LAND", 1.0)], Ending.LAND),
        ([("text", "Battery 1 is critical 13.20V", 0.5), ("mode", "RTL", 1.0)], Ending.BATTERY),
        ([("text", "Battery Failsafe - Landing", 0.5), ("mode", "LAND", 1.0)], Ending.BATTERY),
        # The autopilot warned only, and the pilot returned later, or at once.
        ([("text", "Battery 1 is low 14.10V", -30.0), ("mode", "RTL", 1.0)], Ending.RETURN),
        ([("text", "Battery 1 is low 14.10V", 0.0), ("order", "", 0.5), ("mode", "RTL", 1.0)], Ending.RETURN),
        ([("text", "GCS Failsafe", 0.5), ("mode", "SMART_RTL", 1.0)], Ending.LINK),
        ([("text", "GCS Failsafe Cleared", 0.5), ("mode", "RTL", 1.0)], Ending.RETURN),
        ([("text", "Connection to ground station lost", 0.5), ("mode", "RTL", 1.0)], Ending.LINK),
        ([("text", "Radio Failsafe - RTL", 0.5), ("mode", "RTL", 1.0)], Ending.REMOTE),
        ([("text", "Fence breached", 0.5), ("mode", "RTL", 1.0)], Ending.FENCE),
        ([("mode", "BRAKE", 0.0), ("mode", "RTL", 9.0), ("mode", "LAND", 20.0)], Ending.RETURN),
        ([("mode", "RTL", 0.0), ("mode", "AUTO", 9.0)], Ending.UNKNOWN),
        ([("text", "Mission finished, returning", 0.5), ("mode", "RTL", 1.0)], Ending.UNKNOWN),
        ([("mode", "LOITER", 1.0)], Ending.HAND),
        ([], Ending.UNKNOWN),
    ],
)
def test_views_after_the_end_say_how_the_flight_was_broken_off(
    events: list[tuple[str, str, float]], ending: Ending
) -> None:
    end_s = flown()[0].photos[5].time_s + 0.5
    happened = [FlightEvent(0.0, "mode", "AUTO"), *(FlightEvent(end_s + t, code, text) for code, text, t in events)]
    made = report((replace(cut_at(flown()[0], end_s), events=tuple(happened)),))
    assert made.sorties[0].ending is ending
    told = problems(made.findings)["views-taken"].message
    assert told == f"6 of 12 views have no photo that is known of: 6 {ENDINGS[ending]}; plan a top-up flight for them"


def test_motors_that_stopped_in_the_air_are_why_views_were_not_reached() -> None:
    cut = cut_at(flown()[0], flown()[0].photos[5].time_s + 0.5)
    made = report((replace(cut, is_disarmed=True, events=(FlightEvent(0.0, "mode", "AUTO"),)),))
    assert made.sorties[0].ending is Ending.MOTORS
    assert "6 not reached because the motors stopped in the air" in problems(made.findings)["views-taken"].message


def test_every_reason_reads_on_after_its_number() -> None:
    """As in “2 views ...”: no sentence of its own begins there, and no comma or colon falls among those of the list."""
    for words in (*REASONS.values(), *ENDINGS.values()):
        assert words.split()[0] in {"in", "not", "reached,", "photographed", "photographed,", "where", "after"}, words
    assert set(ENDINGS) == set(Ending)
    assert set(REASONS) == set(Reason) - {Reason.TAKEN}


def test_one_view_without_a_photo_is_told_of_as_one() -> None:
    made = report(photos(lambda p: p[1:]))
    assert problems(made.findings)["views-taken"].message.startswith("1 of 12 views has no photo that is known of: 1 ")


@pytest.mark.parametrize(
    ("is_disarmed", "code", "reason", "words"),
    [
        (True, "motors-off", Reason.FLIGHT_ENDED, "the motors stopped"),
        (False, "ends-in-air", Reason.NOT_RECORDED, "take the autopilot's own log"),
        (None, "", Reason.FLIGHT_ENDED, ""),
    ],
)
def test_a_record_that_leaves_the_aircraft_in_the_air_says_so(
    is_disarmed: bool | None, code: str, reason: Reason, words: str
) -> None:
    """What came after the end of a record is not known: the flight did not end there."""
    record = replace(cut_at(flown()[0], flown()[0].photos[5].time_s + 0.5), is_disarmed=is_disarmed)
    made = report((record,))
    assert {view.reason for view in made.views[6:]} == {reason}
    found = {finding.code: finding for finding in made.findings if finding.code in ENDED_BADLY}
    assert set(found) == ({code} if code else set())
    if code:
        assert found[code].severity is Severity.ERROR
        assert words in found[code].message
        assert found[code].value == pytest.approx(record.track.position_enu_m[-1, 2], abs=0.01)


@pytest.mark.parametrize(("silent_s", "has_fallen"), [(0.5, True), (60.0, False)])
def test_motors_that_stopped_unheard_have_not_stopped_in_the_air(silent_s: float, has_fallen: bool) -> None:
    cut = cut_at(flown()[0], flown()[0].photos[5].time_s + 0.5)
    stopped = FlightEvent(float(cut.track.time_s[-1]) + silent_s, "disarmed", "")
    made = report((replace(cut, is_disarmed=True, events=(stopped,)),))
    assert any(finding.code == "motors-off" for finding in made.findings) is has_fallen


@pytest.mark.parametrize("is_disarmed", [True, False, None])
def test_a_flight_that_landed_did_not_end_in_the_air(is_disarmed: bool | None) -> None:
    made = report(tuple(replace(record, is_disarmed=is_disarmed) for record in flown()))
    assert not ENDED_BADLY & {finding.code for finding in made.findings}


@pytest.mark.parametrize(("left", "is_empty"), [(0.0, True), (0.01, True), (0.02, False), (0.3, False)])
def test_a_battery_flown_empty_is_an_error(left: float, is_empty: bool) -> None:
    falling = np.linspace(0.9, left, len(flown()[0].track.time_s))
    found = problems(report(tracked(battery=falling)).findings)
    assert ("battery-empty" in found) is is_empty
    assert "battery" in found or left >= case().plan.rules.battery_reserve


def test_a_camera_that_counts_by_two_lost_nothing() -> None:
    """It keeps two files of each photo."""

    def by_two(taken: tuple[TakenPhoto, ...]) -> tuple[TakenPhoto, ...]:
        return tuple(replace(photo, index=2 * photo.index, source="camera-feedback") for photo in taken)

    assert "reports-lost" not in problems(report(photos(by_two)).findings)
    gap = photos(lambda taken: by_two(tuple(photo for photo in taken if photo.index != 4)))
    assert "reports-lost" in problems(report(gap).findings)


def test_a_record_of_a_single_moment_at_time_zero_is_no_trouble() -> None:
    view = plan().viewpoints[0]
    photo = TakenPhoto(1, 0.0, view.position_enu_m, view.heading_deg, view.gimbal_pitch_deg)
    track = sparse_track(np.array([view.position_enu_m]), np.zeros(1))
    made = report((FlightRecord(0, "", track, (photo,)),))
    assert made.summary.n_taken == 1
    assert made.views[0].speed_m_s is None
    assert made.views[0].blur_px is None


def test_unknown_directions_are_taken_as_planned_and_the_report_says_so() -> None:
    made = report(photos(lambda p: tuple(replace(x, heading_deg=None, gimbal_pitch_deg=None) for x in p)))
    assert made.summary.covered == made.summary.covered_planned
    found = problems(made.findings)
    assert "as if they looked as planned" in found["heading-unknown"].message
    assert found["gimbal-unknown"].value == 12.0


def test_an_extra_photo_without_direction_covers_nothing() -> None:
    extra = TakenPhoto(99, 1.0, (0.0, -12.0, 5.0))
    made = report(photos(lambda p: (extra, *p[6:])))
    assert made.summary.covered == report(photos(lambda p: p[6:])).summary.covered


def test_the_report_is_json() -> None:
    made = report(photos(lambda p: p[1:]))
    content = json.loads(json.dumps(report_to_json(made), allow_nan=False))
    assert content["n_views"] == 12
    assert content["n_taken"] == 11
    assert len(content["views"]) == 12
    assert content["views"][0]["reason"] == "no-photo"


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 3.0), st.floats(0.0, 15.0), st.floats(0.0, 1.0))
def test_no_flight_however_bad_gives_nan_or_more_photos_than_there_are(
    seed: int, error_m: float, error_deg: float, kept: float
) -> None:
    rng = np.random.default_rng(seed)
    track = flown()[0].track
    columns = {name: getattr(track, name).copy() for name in Track.__slots__}
    for name in Track.__slots__[1:]:
        columns[name][rng.random(len(track.time_s)) > kept] = np.nan
    taken = tuple(
        replace(
            moved(photo, tuple(rng.normal(0.0, error_m, 3)), float(rng.normal(0.0, error_deg))),
            speed_m_s=None if rng.random() > kept else 0.1,
        )
        for photo in flown()[0].photos
        if rng.random() < kept
    )
    made = report((replace(flown()[0], track=Track(**columns), photos=taken),))
    json.dumps(report_to_json(made), allow_nan=False)
    used = [view.photo for view in made.views if view.reason is Reason.TAKEN]
    assert len(set(used)) == len(used) == made.summary.n_taken <= len(taken)
    assert made.summary.covered <= made.summary.total
    assert math.isfinite(sum(view.position_error_m or 0.0 for view in made.views))


def over(function: Callable[[np.ndarray, np.ndarray], np.ndarray], **facts: object) -> Case:
    """The plan's site on a terrain."""
    model = site()
    return Case.of(plan(), replace(model, site=replace(model.site, terrain=terrain(function, **facts))))


def test_the_lowest_flight_is_that_of_dense_samples_above_the_terrain() -> None:
    def bumps(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 2.0 * np.sin(x / 5.0) * np.cos(y / 7.0)

    case_, (record,) = over(bumps), flown()
    low = lowest(case_, record.track)
    assert low is not None
    assert low.height_m is not None
    track = record.track.position_enu_m
    t = np.linspace(0.0, 1.0, 50)[:, None, None]
    dense = (track[:-1] + t * (track[1:] - track[:-1])).reshape(-1, 3)
    home = np.array(site().site.home_enu_m)
    dense = dense[np.linalg.norm(dense[:, :2] - home[:2], axis=1) > BESIDE_M]
    heights = dense[:, 2] - case_.space.ground.terrain.upper.heights_m(dense)  # type: ignore[union-attr]
    assert low.height_m == pytest.approx(heights.min(), abs=0.05)
    assert low.unknown == 0.0
    level = lowest(case(), record.track)
    assert level is not None
    assert level.height_m == pytest.approx(dense[:, 2].min(), abs=1e-9)


def test_the_report_says_how_low_was_flown_above_what_and_judges_it() -> None:
    fine = report_case(case(), flown())
    (found,) = [finding for finding in fine.findings if finding.code == "height"]
    assert found.severity is Severity.OK
    assert "smallest height above level ground" in found.message
    assert fine.summary.least_height_m == fine.sorties[0].least_height_m == 5.0
    assert "down to 5.0 m above the ground" in str(report_text(fine))
    assert report_to_json(fine)["least_height_m"] == 5.0
    # A hill of 4 m on the way: 1 m above it is too low, whatever the height above take-off.
    low = report_case(over(lambda x, y: np.where(y < -7.0, 4.0, 0.0)), flown())
    (found,) = [finding for finding in low.findings if finding.code == "height"]
    assert found.severity is Severity.ERROR
    assert "smallest height above the terrain" in found.message
    assert found.value == pytest.approx(1.0, abs=0.01)
    # Less than records tell is no finding, and what barometers wander by is a warning.
    (record,) = flown()
    for sunk_m, severity in ((0.0005, Severity.OK), (0.02, Severity.WARNING)):
        places = record.track.position_enu_m - np.array([0.0, 0.0, sunk_m])
        sunk = report_case(case(), (replace(record, track=replace(record.track, position_enu_m=places)),))
        (found,) = [finding for finding in sunk.findings if finding.code == "height"]
        assert found.severity is severity
    near = report_case(over(lambda x, y: np.where(y < -7.0, 1.0, 0.0)), flown())
    (found,) = [finding for finding in near.findings if finding.code == "height"]
    assert found.severity is Severity.WARNING


def test_ground_that_is_not_known_is_told_and_never_counts_as_low_or_high() -> None:
    half = over(lambda x, y: np.where(x > 0.0, np.nan, 0.0))
    report = report_case(half, flown())
    (found,) = [finding for finding in report.findings if finding.code == "height-unknown"]
    assert found.severity is Severity.WARNING
    assert found.value is not None
    assert 20.0 < found.value < 80.0
    assert report.summary.least_height_m == pytest.approx(5.0)
    nothing = report_case(over(lambda x, y: np.nan * x), flown())
    assert nothing.summary.least_height_m is None
    (found,) = [finding for finding in nothing.findings if finding.code == "height-unknown"]
    assert found.value == 100.0
    assert [finding for finding in nothing.findings if finding.code == "height"] == []


def test_climbs_and_landings_beside_home_and_gaps_are_no_low_flight() -> None:
    (record,) = flown()
    track = record.track
    up = np.array(site().site.home_enu_m)
    still = replace(track, position_enu_m=np.tile(up, (len(track.time_s), 1)))
    assert lowest(case(), still) is None
    low = track.position_enu_m.copy()
    middle = len(low) // 2
    low[middle, 2] = 1.0
    dipped = lowest(case(), replace(track, position_enu_m=low))
    assert dipped is not None
    assert dipped.height_m == 1.0
    # The same sample between two gaps: nobody knows how it came there, so no leg leads to it.
    seconds = (
        track.time_s
        + np.where(np.arange(len(low)) >= middle, 10.0, 0.0)
        + np.where(np.arange(len(low)) > middle, 10.0, 0.0)
    )
    alone = lowest(case(), replace(track, position_enu_m=low, time_s=seconds))
    assert alone is not None
    assert alone.height_m == 5.0
