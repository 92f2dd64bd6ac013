from __future__ import annotations

import math
import re
import zipfile
from pathlib import Path

import pytest

from missions.dji.read import Flight, read_dji
from missions.dji.wpml import Action, ActionGroup, Folder, WpmlWaypoint
from missions.dji.write import DjiOptions, kmz_bytes
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.mission.model import Finish, ReadMission, ReadPhoto, distance_m
from planning.base.errors import MissionError
from planning.base.findings import Severity
from tests.missions.plans import example_plan


def read_one(path: Path) -> ReadMission:
    (mission,) = read_dji(path)
    return mission


class TestRealFiles:
    def test_facade_route_of_flighthub_is_read_with_the_photos_of_its_time_lapse(self, shared_data: Path) -> None:
        """DJI's own facade mission: 20 m away, 3 m/s, a photo every 1.9 s, gimbal +5 deg, nose held at 0.72 deg."""
        mission = read_one(shared_data / "missions" / "geoyee_m3d_curtainwall_slope_mapping2d.kmz")
        photos = [(w, p) for w in mission.waypoints for p in w.photos]
        assert {(p.heading_deg, p.gimbal_pitch_deg) for _, p in photos} == {(0.717664889797475, 5.0)}
        along_m = 3.0 * 1.89960634708405
        assert len(photos) == 1 + math.floor(260.777954101562 / along_m)
        (first, _), (second, _) = photos[:2]
        assert distance_m(first.lat_deg, first.lon_deg, second.lat_deg, second.lon_deg) == pytest.approx(
            along_m, abs=0.01
        )
        assert mission.height_reference is HeightReference.ELLIPSOID
        assert mission.waypoints[0].height_ellipsoid_m == 118.77253064519
        assert mission.finish is Finish.RETURN
        assert mission.takeoff is not None
        assert mission.takeoff.height_ellipsoid_m == 16.129389

    def test_reference_pattern_of_flighthub_gives_its_photo(self, shared_data: Path) -> None:
        mission = read_one(shared_data / "missions" / "tum_m4td_fh2_waypoint_rotateyaw_photo")
        assert [w.photos for w in mission.waypoints] == [(ReadPhoto(-105.6, -58.9),)]
        assert mission.waypoints[0].height_ellipsoid_m == 561.276374117301

    def test_oriented_photos_say_all_their_angles(self, shared_data: Path) -> None:
        mission = read_one(shared_data / "missions" / "geoyee_m3t_waypoint.kmz")
        assert mission.n_photos == 16
        assert mission.waypoints[0].photos[:2] == (ReadPhoto(-113.059, -81.443), ReadPhoto(-80.367, -40.368))
        assert mission.height_reference is HeightReference.ABOVE_TAKEOFF
        assert mission.waypoints[0].height_above_takeoff_m == 54.346750023

    def test_pitch_stays_unknown_until_the_gimbal_is_told_one(self, shared_data: Path) -> None:
        mission = read_one(shared_data / "missions" / "djisdk_psdk_m3e_waypoint_v3_test.kmz")
        photos = {i: w.photos for i, w in enumerate(mission.waypoints) if w.photos}
        assert set(photos) == {0, 4}
        assert photos[0][0].gimbal_pitch_deg is None
        assert photos[4][0].gimbal_pitch_deg == 0.0
        assert mission.waypoints[0].height_above_takeoff_m == 100.0

    def test_oldest_namespace_is_read(self, shared_data: Path) -> None:
        mission = read_one(shared_data / "missions" / "djisdk_msdk_m30_waypointsample.kmz")
        assert (len(mission.waypoints), mission.n_photos) == (4, 0)

    def test_waylines_count_where_the_template_says_otherwise_and_it_is_said(self, shared_data: Path) -> None:
        mission = read_one(shared_data / "missions" / "traitlab_m3e_pilot2_Waypoint2_rtk")
        assert mission.height_reference is HeightReference.ELLIPSOID
        assert mission.waypoints[0].height_ellipsoid_m == 380.736267089844
        assert [f.severity for f in mission.findings if f.code == "parts-disagree"] == [Severity.WARNING]
        assert mission.takeoff is None  # its take-off reference point is 0,0: only the height was recorded

    def test_a_single_part_stands_for_its_folder(self, shared_data: Path) -> None:
        folder = shared_data / "missions" / "traitlab_m3e_pilot2_Waypoint2_rtk"
        assert read_one(folder / "waylines.wpml").waypoints == read_one(folder).waypoints

    def test_wrong_layout_is_refused_with_what_to_do(self, shared_data: Path) -> None:
        with pytest.raises(MissionError, match=r"at the top of the archive.*expected both in its folder wpmz"):
            read_dji(shared_data / "missions" / "NEG_tum_flat_root_no_wpmz_dir.kmz")

    def test_edited_file_is_refused_with_each_kind_of_error(self, shared_data: Path) -> None:
        with pytest.raises(MissionError, match=r"not on the globe.*75 times.*actionGroupId occurs twice"):
            read_dji(shared_data / "missions" / "traitlab_m3t_edited_75wp")

    def test_folder_without_waylines_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(MissionError, match=r"expected the waylines\.wpml"):
            read_dji(tmp_path)


def test_unpacked_file_of_ours_reads_as_the_packed_one(tmp_path: Path) -> None:
    import zipfile

    mission = missions_from_plan(example_plan())[0]
    packed = tmp_path / "m.kmz"
    packed.write_bytes(kmz_bytes(mission, DjiOptions(60.0, 0)))
    with zipfile.ZipFile(packed) as archive:
        archive.extractall(tmp_path / "unpacked")
    assert read_one(tmp_path / "unpacked").waypoints == read_one(packed).waypoints
    assert [p.viewpoint_id for w in read_one(packed).waypoints for p in w.photos] == [f"v{i:04d}" for i in range(6)]


def test_surface_following_is_refused_because_its_heights_are_not_in_the_file(tmp_path: Path) -> None:
    import io
    import zipfile

    mission = missions_from_plan(example_plan())[0]
    path = tmp_path / "m.kmz"
    with (
        zipfile.ZipFile(io.BytesIO(kmz_bytes(mission, DjiOptions(60.0, 0)))) as original,
        zipfile.ZipFile(path, "w") as edited,
    ):
        for name in original.namelist():
            edited.writestr(name, original.read(name).replace(b"relativeToStartPoint", b"realTimeFollowSurface"))
    with pytest.raises(MissionError, match="follows the ground"):
        read_dji(path)


# The heading modes, triggers and gimbal actions, each on a small wayline: 100 m north, then 100 m east.

PLACES = (
    (52.0, 5.0, 50.0),
    (52.0 + 100.0 / 111_267.0, 5.0, 50.0),
    (52.0 + 100.0 / 111_267.0, 5.0 + 100.0 / 68_680.0, 50.0),
)


def action(func: str, **params: object) -> Action:
    return Action(0, func, {name: str(value) for name, value in params.items()})


PHOTO = action("takePhoto")
PITCH = {"gimbalPitchRotateEnable": 1, "gimbalRotateMode": "absoluteAngle"}


def group(start: int, end: int, trigger: str, *actions: Action, param: float | None = None) -> ActionGroup:
    return ActionGroup(0, start, end, trigger, param, actions)


def waypoint(index: int, mode: str = "followWayline", *groups: ActionGroup, **changes: object) -> WpmlWaypoint:
    lat, lon, height = PLACES[index]
    values: dict[str, object] = {
        "index": index, "lon_deg": lon, "lat_deg": lat, "execute_height_m": height, "height_m": None,
        "ellipsoid_height_m": None, "speed_m_s": 5.0, "heading_mode": mode, "heading_angle_deg": None,
        "heading_angle_enable": False, "heading_path_mode": "", "poi_lat_lon_deg": None, "turn_mode": "",
        "turn_damping_m": 0.0, "use_straight_line": True, "gimbal_heading": True, "groups": groups,
    }  # fmt: skip
    return WpmlWaypoint(**{**values, **changes})  # type: ignore[arg-type]


def photos(*waypoints: WpmlWaypoint, start: tuple[Action, ...] = ()) -> list[tuple[float, ReadPhoto]]:
    """Photos with the distance flown north or east from the last waypoint passed, metres."""
    folder = Folder("", 0, "WGS84", 5.0, None, None, "", start, waypoints)
    found = []
    for point in Flight(folder, is_ours=False).points():
        from_start_m = distance_m(PLACES[0][0], PLACES[0][1], point.lat_deg, point.lon_deg)
        found += [(round(from_start_m, 1), photo) for photo in point.photos]
    return found


def heading_of_last(*waypoints: WpmlWaypoint) -> float | None:
    return photos(*waypoints)[-1][1].heading_deg


AT_2 = group(2, 2, "reachPoint", PHOTO)


def test_nose_follows_the_course_of_the_leg_flown() -> None:
    taken = photos(
        waypoint(0), waypoint(1, "followWayline", group(1, 1, "reachPoint", PHOTO)), waypoint(2, "fixed", AT_2)
    )
    assert [p.heading_deg for _, p in taken] == pytest.approx([0.0, 90.0], abs=0.01)


def test_fixed_keeps_the_yaw_that_the_actions_left() -> None:
    turn = group(1, 1, "reachPoint", action("rotateYaw", aircraftHeading=-33.5))
    assert heading_of_last(waypoint(0), waypoint(1, "fixed", turn), waypoint(2, "fixed", AT_2)) == -33.5


def test_smooth_transition_arrives_with_the_angle_of_the_waypoint() -> None:
    first, second = (waypoint(i, "smoothTransition", heading_angle_deg=10.0 + i) for i in (0, 1))
    assert heading_of_last(first, second, waypoint(2, "smoothTransition", AT_2, heading_angle_deg=170.0)) == 170.0


def test_smooth_transition_turns_the_short_way_on_the_leg() -> None:
    timed = group(1, 2, "multipleDistance", PHOTO, param=45.0)
    points = [
        waypoint(0, "smoothTransition", heading_angle_deg=170.0),
        waypoint(1, "smoothTransition", timed, heading_angle_deg=170.0),
        waypoint(2, "smoothTransition", heading_angle_deg=-170.0),
    ]
    headings = [p.heading_deg for _, p in photos(*points)]
    assert headings == pytest.approx([170.0, 179.0, -172.0], abs=0.2)


def test_poi_is_looked_at_from_everywhere() -> None:
    poi = (PLACES[0][0], PLACES[2][1])
    timed = group(0, 1, "multipleDistance", PHOTO, param=50.0)
    points = (waypoint(0, "towardPOI", timed, poi_lat_lon_deg=poi), waypoint(1, "fixed"), waypoint(2, "fixed"))
    headings = [p.heading_deg for _, p in photos(*points)]
    assert headings == pytest.approx([90.0, 90.0 + math.degrees(math.atan(0.5)), 135.0], abs=0.3)


def test_heading_that_the_pilot_steers_is_not_known() -> None:
    assert heading_of_last(waypoint(0), waypoint(1, "manually"), waypoint(2, "fixed", AT_2)) is None


def test_gimbal_turns_evenly_on_a_leg() -> None:
    even = group(1, 2, "betweenAdjacentPoints", action("gimbalEvenlyRotate", gimbalPitchRotateAngle=-40))
    timed = group(1, 2, "multipleDistance", PHOTO, param=45.0)
    begin = (action("gimbalRotate", gimbalPitchRotateAngle=0, **PITCH),)
    taken = photos(waypoint(0), waypoint(1, "fixed", even, timed), waypoint(2, "fixed"), start=begin)
    assert [p.gimbal_pitch_deg for _, p in taken] == pytest.approx([0.0, -18.0, -36.0], abs=0.3)


def test_relative_and_disabled_gimbal_turns() -> None:
    down = action("gimbalRotate", gimbalPitchRotateAngle=-30, **PITCH)
    further = action(
        "gimbalRotate", gimbalPitchRotateAngle=-10, gimbalPitchRotateEnable=1, gimbalRotateMode="relativeAngle"
    )
    idle = action("gimbalRotate", gimbalPitchRotateAngle=45, gimbalPitchRotateEnable=0)
    taken = photos(
        waypoint(0, "fixed", group(0, 0, "reachPoint", down, further, idle, PHOTO)), waypoint(1), waypoint(2)
    )
    assert taken[0][1].gimbal_pitch_deg == -40.0


@pytest.mark.parametrize(("base", "expected"), [("north", 30.0), ("aircraft", 130.0)])
def test_gimbal_yaw_counts_from_its_base(base: str, expected: float) -> None:
    turn = action("rotateYaw", aircraftHeading=100)
    pan = action("gimbalRotate", gimbalHeadingYawBase=base, gimbalYawRotateEnable=1, gimbalYawRotateAngle=30)
    taken = photos(waypoint(0, "fixed", group(0, 0, "reachPoint", turn, pan, PHOTO)), waypoint(1), waypoint(2))
    assert taken[0][1].heading_deg == pytest.approx(expected)


def test_photos_by_distance_and_by_time_run_on_over_waypoints_until_their_end() -> None:
    by_distance = group(0, 2, "multipleDistance", PHOTO, param=75.0)
    assert [at for at, _ in photos(waypoint(0, "fixed", by_distance), waypoint(1), waypoint(2))] == [0.0, 75.0, 111.8]
    by_time = group(0, 1, "multipleTiming", PHOTO, param=8.0)
    assert [at for at, _ in photos(waypoint(0, "fixed", by_time), waypoint(1), waypoint(2))] == [0.0, 40.0, 80.0]


def test_time_lapse_runs_from_start_to_stop() -> None:
    start = group(0, 0, "reachPoint", action("startTimeLapse", minShootInterval=10))
    stop = group(1, 1, "reachPoint", action("stopTimeLapse"))
    taken = photos(waypoint(0, "fixed", start), waypoint(1, "fixed", stop), waypoint(2))
    assert [at for at, _ in taken] == pytest.approx([0.0, 50.0, 100.0], abs=0.2)


def test_trigger_that_takes_no_photo_gives_none() -> None:
    timed = group(0, 2, "multipleTiming", action("gimbalRotate", gimbalPitchRotateAngle=5, **PITCH), param=2.0)
    assert photos(waypoint(0, "fixed", timed), waypoint(1), waypoint(2)) == []


# --- what an aircraft would refuse ---

WPMZ = "wpmz/waylines.wpml"

REFUSED = {
    "vertical legs": (r"<coordinates>[^<]*</coordinates>", "<coordinates>114.0,22.0</coordinates>", ""),
    "speed": (r"<wpml:(waypointSpeed|autoFlightSpeed)>[^<]*<", r"<wpml:\1>99<", "speed"),
    "no speed": (r"<wpml:(waypointSpeed|autoFlightSpeed)>[^<]*<", r"<wpml:\1>-1<", "speed"),
    "turn mode": (r"<wpml:waypointTurnMode>[^<]*<", "<wpml:waypointTurnMode>loop<", "turn-mode"),
    "heading mode": (r"<wpml:waypointHeadingMode>[^<]*<", "<wpml:waypointHeadingMode>spin<", "heading-mode"),
    "group ids": (r"<wpml:actionGroupId>[^<]*<", "<wpml:actionGroupId>0<", "group-id"),
    "pitch": (r"<wpml:gimbalPitchRotateAngle>[^<]*<", "<wpml:gimbalPitchRotateAngle>-900<", "gimbal"),
    "yaw": (r"<wpml:aircraftHeading>[^<]*<", "<wpml:aircraftHeading>nan<", "heading"),
    "indices": (r"<wpml:index>[^<]*<", "<wpml:index>7<", "waypoint-index"),
    "aircraft": (r"<wpml:droneEnumValue>[^<]*<", "<wpml:droneEnumValue>x<", "garbled"),
    "security height": (r"<wpml:takeOffSecurityHeight>[^<]*<", "<wpml:takeOffSecurityHeight>0<", "security-height"),
    "height": (r"<wpml:executeHeight>[^<]*<", "<wpml:executeHeight>5000<", "height"),
}
"""Changes to every element of a kind: what is looked for, what takes its place, and the code that tells it."""


def changed(folder: Path, real: Path, pattern: str, instead: str) -> Path:
    path = folder / "m.kmz"
    with zipfile.ZipFile(real) as original, zipfile.ZipFile(path, "w") as edited:
        for name in original.namelist():
            content = original.read(name)
            if name == WPMZ:
                content = re.sub(pattern, instead, content.decode()).encode()
            edited.writestr(name, content)
    return path


@pytest.mark.long
@pytest.mark.parametrize("name", ["djisdk_psdk_m3e_waypoint_v3_test.kmz", "geoyee_m3t_waypoint.kmz"])
@pytest.mark.parametrize("change", REFUSED)
def test_what_an_aircraft_would_refuse_is_read_and_told(
    shared_data: Path, tmp_path: Path, change: str, name: str
) -> None:
    pattern, instead, _ = REFUSED[change]
    real = shared_data / "missions" / name
    path = changed(tmp_path, real, pattern, instead)
    (mission,), (plain,) = read_dji(path), read_dji(real)
    assert not [finding for finding in mission.findings if finding.severity is Severity.ERROR]
    assert mission.n_photos >= plain.n_photos // 2
    told = [finding for finding in mission.findings if finding.message.startswith("the vehicle would refuse it: ")]
    if told:
        with pytest.raises(MissionError, match="aircraft would refuse this mission"):
            read_dji(path, strict=True)


def test_each_kind_of_refusal_is_told_in_one_of_the_files(shared_data: Path, tmp_path: Path) -> None:
    for pattern, instead, code in REFUSED.values():
        if not code:
            continue
        codes = set()
        for name in ("djisdk_psdk_m3e_waypoint_v3_test.kmz", "geoyee_m3t_waypoint.kmz"):
            for mission in read_dji(changed(tmp_path, shared_data / "missions" / name, pattern, instead)):
                codes |= {f.code for f in mission.findings if "would refuse" in f.message}
        assert any(code in found for found in codes), (code, codes)


@pytest.mark.parametrize(
    ("pattern", "instead", "said"),
    [
        (r"<coordinates>[^<]*</coordinates>", "<coordinates>500,22</coordinates>", "not on the globe"),
        (r"<coordinates>[^<]*</coordinates>", "", "no coordinates"),
        (r"<wpml:executeHeight>[^<]*<", "<wpml:executeHeight>high<", "no executeHeight"),
        (r"<wpml:executeHeightMode>[^<]*<", "<wpml:executeHeightMode>aboveGroundLevel<", "executeHeightMode is"),
        (r"(?s)<Placemark>.*</Placemark>", "", "no waypoints"),
    ],
)
def test_a_path_that_is_not_in_the_file_is_refused(
    shared_data: Path, tmp_path: Path, pattern: str, instead: str, said: str
) -> None:
    real = shared_data / "missions" / "djisdk_psdk_m3e_waypoint_v3_test.kmz"
    with pytest.raises(MissionError, match=said):
        read_dji(changed(tmp_path, real, pattern, instead))
