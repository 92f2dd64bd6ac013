"""Camera settings in mission files: written and read back, foreign ones read and told, the rest left to the pilot."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from missions.dji.read import read_dji
from missions.formats.camera_steps import camera_steps
from missions.formats.options import ExportOptions
from missions.formats.registry import encode, read_missions, write_files
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.check import check_items
from missions.mavlink.items import MavlinkFile, MissionItem, mission_items
from missions.mavlink.read import read_mavlink
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import NOTHING_SAID, ReadCamera, ReadMission
from planning.aircraft.camera_use import controls_of
from planning.base.findings import Severity
from planning.parameters import CameraSettings
from planning.plan import Plan
from tests.missions.plans import example_plan

ABOVE = HeightReference.ABOVE_TAKEOFF
FOCUSES = ("auto", "lock", "infinity", "distance")
MANUAL = CameraSettings("manual", 1 / 500, 5.6, 200)


def with_settings(plan: Plan, **changes: object) -> Plan:
    focus = {"focus_distance_m": 12.5} if changes.get("focus") == "distance" else {}
    return replace(plan, camera_settings=replace(plan.camera_settings, **changes, **focus))  # type: ignore[arg-type]


def obedient(plan: Plan) -> Plan:
    """The same plan with a camera that takes what MAVLink items tell it."""
    controls = controls_of(plan)
    assert controls is not None
    return replace(plan, camera_controls=replace(controls, mavlink=("focus", "exposure")))


def exported(plan: Plan, file_format: FileFormat, folder: Path, **options: object) -> tuple[ReadMission, ...]:
    """A plan written and read back."""
    encoded = encode(plan, None, None, file_format, ExportOptions(**options))  # type: ignore[arg-type]
    ending = {FileFormat.DJI_KMZ: ".kmz", FileFormat.MAVLINK_PLAN: ".plan"}.get(file_format, ".waypoints")
    paths = write_files(encoded, folder / f"mission{ending}")
    return tuple(mission for path in paths for mission in read_missions(path))


def funcs(path: Path) -> list[list[str]]:
    """Actions at each waypoint that has any, by name, of the first wayline."""
    from missions.dji.wpml import load_parts

    waypoints = load_parts(path).waylines.folders[0].waypoints
    return [[a.func for a in group.actions] for waypoint in waypoints for group in waypoint.groups]


class TestDji:
    @pytest.mark.parametrize("focus", ["auto", "lock", "infinity"])
    def test_the_focus_comes_back_as_it_was_written(self, focus: str, tmp_path: Path) -> None:
        plan = with_settings(example_plan(), focus=focus)
        for mission in exported(plan, FileFormat.DJI_KMZ, tmp_path):
            assert mission.camera == ReadCamera(focus=focus)  # type: ignore[arg-type]
            assert mission.camera.over(CameraSettings()) == plan.camera_settings

    def test_a_focus_that_is_held_is_set_at_the_first_photo_of_each_sortie_and_never_again(
        self, tmp_path: Path
    ) -> None:
        exported(example_plan(), FileFormat.DJI_KMZ, tmp_path)
        for name in ("mission.kmz", "mission-2.kmz"):
            first, *others = funcs(tmp_path / name)
            assert first.index("focus") < first.index("setFocusType") < first.index("hover") < first.index("takePhoto")
            assert all("focus" not in each and "setFocusType" not in each for each in others)

    def test_infinity_is_set_as_flighthub_sets_it_on_a_facade(self, tmp_path: Path, shared_data: Path) -> None:
        exported(with_settings(example_plan(), focus="infinity"), FileFormat.DJI_KMZ, tmp_path)
        own = funcs(tmp_path / "mission.kmz")[0]
        assert own.index("setFocusType") + 1 == own.index("focus")
        (theirs,) = read_dji(shared_data / "missions" / "geoyee_m3d_curtainwall_slope_mapping2d.kmz")
        assert theirs.camera == ReadCamera(focus="infinity")
        told = [found.message for found in theirs.findings if found.code == "camera"]
        assert told == ["its camera: focus at infinity"]

    def test_a_distance_is_no_part_of_the_format_so_it_is_told_and_left_to_the_pilot(self, tmp_path: Path) -> None:
        plan = with_settings(example_plan(), focus="distance")
        mission = exported(plan, FileFormat.DJI_KMZ, tmp_path)[0]
        assert mission.camera == NOTHING_SAID
        assert any("set by hand before the flight" in found.message for found in mission.findings)
        assert "manual focus (MF) on something 12.5 m away" in camera_steps(plan).by_hand
        assert all("focus" not in each for each in funcs(tmp_path / "mission.kmz"))

    def test_aircraft_without_focus_actions_have_the_focus_mode_of_the_template(self, tmp_path: Path) -> None:
        mission = exported(example_plan("m350_p1"), FileFormat.DJI_KMZ, tmp_path)[0]
        assert mission.camera == ReadCamera(focus="lock")
        with zipfile.ZipFile(tmp_path / "mission.kmz") as archive:
            assert b"<wpml:focusMode>firstPoint<" in archive.read("wpmz/template.kml")
        m30 = exported(example_plan("m30"), FileFormat.DJI_KMZ, tmp_path)[0]
        assert m30.camera == NOTHING_SAID, "DJI documents the focus mode for the M300 and M350 alone"

    def test_foreign_missions_say_how_they_focus_and_what_is_not_taken_over(self, shared_data: Path) -> None:
        (m3t,) = read_dji(shared_data / "missions" / "geoyee_m3t_waypoint.kmz")
        assert m3t.camera == ReadCamera(focus="auto"), "photos that aim themselves focus themselves"
        (m4td,) = read_dji(shared_data / "missions" / "tum_m4td_fh2_waypoint_rotateyaw_photo")
        assert m4td.camera.focus == "auto"

    def test_everything_but_the_focus_is_left_to_the_pilot_in_the_order_of_the_menus(self) -> None:
        steps = camera_steps(replace(example_plan(), camera_settings=MANUAL))
        assert steps.by_mission == ("automatic focus before the first photo, then locked",)
        assert steps.by_hand == (
            *("exposure mode M", "ISO 200", "shutter time 1/500 s", "aperture f/5.6", "white balance manual, 5500 K"),
            "mechanical shutter on",
        )
        encoded = encode(replace(example_plan(), camera_settings=MANUAL), None, None, FileFormat.DJI_KMZ)
        (note,) = [found for found in encoded.findings if found.code == "camera-by-hand"]
        assert note.severity is Severity.NOTE
        assert "exposure mode M; ISO 200; shutter time 1/500 s" in note.message

    @pytest.mark.parametrize(
        ("settings", "mode"),
        [
            (CameraSettings(), "exposure mode A (aperture priority)"),
            (CameraSettings(shutter_s=1 / 500, aperture=5.6), "exposure mode M"),
        ],
    )
    def test_the_mode_of_exposure_is_the_one_that_holds_what_is_stated(
        self, settings: CameraSettings, mode: str
    ) -> None:
        plan = replace(example_plan(), camera_settings=settings)
        assert camera_steps(plan).by_hand[0] == mode
        fixed = replace(example_plan("m3t"), camera_settings=replace(settings, aperture=None))
        expected = "exposure mode P (automatic)" if settings.shutter_s is None else "exposure mode S (shutter priority)"
        assert camera_steps(fixed).by_hand[0] == expected


def items_of(plan: Plan, autopilot: Autopilot) -> tuple[MissionItem, ...]:
    return mission_items(missions_from_plan(plan)[0], autopilot, ABOVE)


class TestMavlink:
    @pytest.mark.parametrize("autopilot", list(Autopilot))
    def test_a_camera_that_takes_nothing_from_items_gets_nothing(self, autopilot: Autopilot) -> None:
        plan = replace(example_plan("ardupilot"), camera_settings=MANUAL)
        assert not {202, 530, 532} & {item.command for item in items_of(plan, autopilot)}
        assert "exposure mode M" in camera_steps(plan, FileFormat.MAVLINK_PLAN, autopilot).by_hand

    @pytest.mark.parametrize("file_format", [FileFormat.MAVLINK_PLAN, FileFormat.MAVLINK_WPL])
    @pytest.mark.parametrize("focus", FOCUSES)
    @pytest.mark.parametrize("autopilot", list(Autopilot))
    def test_focus_and_exposure_come_back_as_they_were_written(
        self, autopilot: Autopilot, focus: str, file_format: FileFormat, tmp_path: Path
    ) -> None:
        plan = with_settings(replace(obedient(example_plan("ardupilot")), camera_settings=MANUAL), focus=focus)
        mission = exported(plan, file_format, tmp_path, autopilot=autopilot)[0]
        wanted = plan.camera_settings
        expected = NOTHING_SAID
        if autopilot is Autopilot.ARDUPILOT:
            expected = ReadCamera("manual", wanted.shutter_s, wanted.aperture, wanted.iso)
        if autopilot is Autopilot.PX4 or focus != "distance":
            expected = replace(expected, focus=wanted.focus, focus_distance_m=wanted.focus_distance_m)
        assert mission.camera == expected
        assert not [f for f in mission.findings if f.code == "camera" and f.severity is not Severity.NOTE]
        steps = camera_steps(plan, file_format, autopilot)
        assert len(steps.by_mission) == 4 * (autopilot is Autopilot.ARDUPILOT) + (expected.focus is not None)
        if autopilot is Autopilot.ARDUPILOT and focus == "distance":
            assert "manual focus (MF) on something 12.5 m away" in steps.by_hand

    def test_the_photos_stay_where_they_were_and_neither_autopilot_objects(self, tmp_path: Path) -> None:
        for autopilot in Autopilot:
            plain = example_plan("ardupilot")
            told = replace(obedient(plain), camera_settings=MANUAL)
            before = exported(plain, FileFormat.MAVLINK_PLAN, tmp_path, autopilot=autopilot)[0]
            after = exported(told, FileFormat.MAVLINK_PLAN, tmp_path, autopilot=autopilot)[0]
            photos = [[(w.lat_deg, w.lon_deg, w.photos) for w in each.waypoints] for each in (before, after)]
            assert photos[0] == photos[1]
            items = items_of(told, autopilot)
            home = missions_from_plan(told)[0].takeoff
            objections = check_items(MavlinkFile(items, home, autopilot), autopilot)
            assert [f for f in objections if f.severity is not Severity.NOTE] == []

    def test_an_exposure_that_the_item_cannot_hold_is_left_to_the_pilot(self) -> None:
        long = replace(obedient(example_plan("ardupilot")), camera_settings=replace(MANUAL, shutter_s=0.7))
        assert 202 not in {item.command for item in items_of(long, Autopilot.ARDUPILOT)}
        assert "shutter time 0.7 s" in camera_steps(long, FileFormat.MAVLINK_WPL, Autopilot.ARDUPILOT).by_hand

    def read(self, *items: MissionItem) -> ReadMission:
        place = MissionItem(16, 3, (1.0, 0.0, 0.0, 0.0, 22.33, 114.26, 30.0))
        return read_mavlink(Path("foreign.plan"), MavlinkFile((*items, place), None), FileFormat.MAVLINK_PLAN)

    @pytest.mark.parametrize(
        ("command", "params", "camera", "text"),
        [
            (202, (4, 500, 56, 200), ReadCamera("manual", 1 / 500, 5.6, 200), "its camera: 1/500 s, f/5.6, ISO 200"),
            (202, (3, 250, 8, 0), ReadCamera(None, 1 / 250, 8.0), "its camera: 1/250 s, f/8"),
            (202, (0, 0, 0, 0), NOTHING_SAID, "says nothing that is understood"),
            (202, (4, float("nan"), float("inf"), -5), NOTHING_SAID, "says nothing that is understood"),
            (530, (0, 1, 0, 0), NOTHING_SAID, "it sets the camera to video"),
            (531, (2, 50, 0, 0), NOTHING_SAID, "it zooms"),
            (532, (3, 8.5, 0, 0), ReadCamera(focus="distance", focus_distance_m=8.5), "its camera: focus at 8.5 m"),
            (532, (3, float("nan"), 0, 0), NOTHING_SAID, "a focus of type 3 with nan is not taken over"),
            (532, (2, 40, 0, 0), NOTHING_SAID, "a focus of type 2 with 40 is not taken over"),
            (532, (4, 0, 0, 0), ReadCamera(focus="lock"), "automatic focus before the first photo, then locked"),
        ],
    )
    def test_what_foreign_missions_tell_the_camera_is_read_and_told(
        self, command: int, params: tuple[float, ...], camera: ReadCamera, text: str
    ) -> None:
        p1, p2, p3, p4 = map(float, params)
        mission = self.read(MissionItem(command, 2, (p1, p2, p3, p4, 0.0, 0.0, 0.0)))
        assert mission.camera == camera
        (told,) = [found for found in mission.findings if found.code == "camera"]
        assert text in told.message

    def test_the_usual_settings_stay_where_a_file_says_half(self) -> None:
        usual = CameraSettings()
        assert ReadCamera("manual", 1 / 500).over(usual) == replace(usual, shutter_s=1 / 500)
        assert ReadCamera(focus="distance").over(usual) == usual
        at = replace(usual, focus="distance", focus_distance_m=9.0)
        assert ReadCamera(focus="infinity").over(at) == replace(usual, focus="infinity")
