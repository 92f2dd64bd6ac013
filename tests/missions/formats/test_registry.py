"""Round trips of every format, and what writing and reading promise about files."""

from __future__ import annotations

import math
import re
import tempfile
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from missions.formats.encode import takeoff_check
from missions.formats.options import ExportOptions
from missions.formats.registry import encode, read_missions, sortie_path
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import GeoPoint, ReadMission, altitude_amsl_m
from missions.mission.to_plan import viewpoints_and_sorties
from planning.base.errors import InputError, MissionError
from planning.base.findings import Finding, Severity
from planning.geo.geoid import undulation_m
from planning.geo.mesh import box_mesh, empty_mesh
from planning.motion.timing import photo_vertices
from planning.plan import Plan, Sortie, Viewpoint
from planning.routing.rally import CLEARANCE_M
from planning.site.records import Airspace, Facade, NoFlyZone, Obstacle, Panel, Site, SiteModel
from tests.missions.plans import HOME, HONG_KONG, example_plan, export, plans

FIXED = ExportOptions(clock=lambda: 1_700_000_000.0)
SUFFIX = {
    FileFormat.DJI_KMZ: ".kmz",
    FileFormat.MAVLINK_PLAN: ".plan",
    FileFormat.MAVLINK_WPL: ".waypoints",
    FileFormat.KML: ".kml",
    FileFormat.CSV: ".csv",
}
WAYS = [
    (FileFormat.DJI_KMZ, FIXED),
    (FileFormat.DJI_KMZ, replace(FIXED, height_reference=HeightReference.ELLIPSOID)),
    (FileFormat.DJI_KMZ, replace(FIXED, height_reference=HeightReference.AMSL)),
    *[
        (file_format, replace(FIXED, autopilot=autopilot, height_reference=reference))
        for file_format in (FileFormat.MAVLINK_PLAN, FileFormat.MAVLINK_WPL)
        for autopilot in Autopilot
        for reference in (HeightReference.ABOVE_TAKEOFF, HeightReference.AMSL)
    ],
    (FileFormat.KML, FIXED),
    (FileFormat.CSV, FIXED),
]
IDS = [f"{f.value}-{o.autopilot or ''}-{o.height_reference.value}" for f, o in WAYS]


def there_and_back(plan: Plan, file_format: FileFormat, options: ExportOptions) -> list[ReadMission]:
    with tempfile.TemporaryDirectory() as folder:
        paths = export(plan, None, None, file_format, Path(folder) / f"m{SUFFIX[file_format]}", options)
        return [mission for path in paths for mission in read_missions(path)]


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize(("file_format", "options"), WAYS, ids=IDS)
@given(plan=plans())
@settings(max_examples=8)
def test_round_trip_keeps_views_to_1_cm_and_a_tenth_of_a_degree(
    plan: Plan, file_format: FileFormat, options: ExportOptions
) -> None:
    assert plan.origin is not None
    assert plan.home_enu_m is not None
    missions = there_and_back(plan, file_format, options)
    parts = viewpoints_and_sorties(missions, plan.origin, plan.home_enu_m, plan.rules)
    order = [identifier for sortie in plan.sorties for identifier in sortie.viewpoint_ids]
    before = {view.id: view for view in plan.viewpoints}
    assert len(parts.viewpoints) == len(order)
    for identifier, after in zip(order, parts.viewpoints, strict=True):
        view = before[identifier]
        assert math.dist(after.position_enu_m, view.position_enu_m) < 0.01
        assert abs((after.heading_deg - view.heading_deg + 180.0) % 360.0 - 180.0) < 0.1
        assert abs(after.gimbal_pitch_deg - view.gimbal_pitch_deg) < 0.1
    # A .waypoints file has no room for ids.
    if file_format is not FileFormat.MAVLINK_WPL:
        assert [view.id for view in parts.viewpoints] == order
    if file_format is not FileFormat.CSV:  # which has no path
        for sortie, again in zip(plan.sorties, parts.sorties, strict=True):
            np.testing.assert_allclose(np.array(again.path_enu_m), waypoints_of(sortie, before), atol=0.01)
            assert len(photo_vertices(again, {v.id: v for v in parts.viewpoints})) == len(again.viewpoint_ids)


def waypoints_of(sortie: Sortie, by_id: dict[str, Viewpoint]) -> np.ndarray:
    """Vertices that a file keeps: of those at one place each with a photo, or else one."""
    photos = set(photo_vertices(sortie, by_id).tolist())
    kept: list[int] = []
    for vertex, point in enumerate(sortie.path_enu_m):
        if kept and math.dist(point, sortie.path_enu_m[kept[-1]]) <= 2e-3:
            if vertex not in photos:
                continue
            if kept[-1] not in photos:
                kept.pop()
        kept.append(vertex)
    return np.array(sortie.path_enu_m)[kept]


@pytest.mark.slow
@given(plan=plans())
@settings(max_examples=10)
def test_one_point_is_the_same_point_in_all_formats(plan: Plan) -> None:
    """Heights above take-off, above sea level and above the ellipsoid agree through EGM96."""
    home_m = missions_from_plan(plan)[0].takeoff.height_ellipsoid_m
    heights = []
    for file_format, options in WAYS:
        points = [w for m in there_and_back(plan, file_format, options) for w in m.waypoints if w.photos]
        heights.append(
            [
                w.height_ellipsoid_m if w.height_above_takeoff_m is None else w.height_above_takeoff_m + home_m
                for w in points
            ]
        )
    for other in heights[1:]:
        assert other == pytest.approx(heights[0], abs=0.002)


def test_sea_level_is_the_geoid_and_not_the_ellipsoid() -> None:
    """MAVLink's absolute altitude at Hong Kong is 2.4 m above what the ellipsoid would give."""
    plan = example_plan()
    options = replace(FIXED, height_reference=HeightReference.AMSL)
    encoded = encode(plan, None, None, FileFormat.MAVLINK_WPL, options)
    altitudes = [
        float(line.split("\t")[10]) for line in encoded.contents[0].decode().splitlines()[1:] if "\t16\t" in line
    ]
    mission = missions_from_plan(plan)[0]
    wanted = [altitude_amsl_m(mission.takeoff), *(altitude_amsl_m(w.position) for w in mission.waypoints)]
    assert altitudes == pytest.approx(wanted, abs=1e-3)
    first = mission.waypoints[0].position
    undulation = float(undulation_m(first.lat_deg, first.lon_deg))
    assert abs(undulation) > 1.0
    assert altitudes[1] == pytest.approx(first.height_ellipsoid_m - undulation, abs=1e-3)


class TestFiles:
    def test_first_sortie_has_the_given_name_and_the_others_their_number(self, tmp_path: Path) -> None:
        paths = export(example_plan(), None, None, FileFormat.DJI_KMZ, tmp_path / "a.b.kmz", FIXED)
        assert [path.name for path in paths] == ["a.b.kmz", "a.b-2.kmz"]
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a.b-2.kmz", "a.b.kmz"]
        assert sortie_path(Path("m"), 3) == Path("m-3")

    @pytest.mark.parametrize("file_format", [FileFormat.KML, FileFormat.CSV])
    def test_formats_for_looking_hold_all_sorties_in_one_file(self, tmp_path: Path, file_format: FileFormat) -> None:
        path = tmp_path / f"m{SUFFIX[file_format]}"
        assert export(example_plan(), None, None, file_format, path, FIXED) == (path,)
        assert [mission.n_photos for mission in read_missions(path)] == [6, 4]

    @pytest.mark.parametrize(("file_format", "options"), WAYS, ids=IDS)
    def test_same_plan_and_time_give_the_same_bytes(self, file_format: FileFormat, options: ExportOptions) -> None:
        first, second = (encode(example_plan(), None, None, file_format, options) for _ in range(2))
        assert first.contents == second.contents

    def test_nothing_is_left_where_a_later_file_cannot_be_written(self, tmp_path: Path) -> None:
        (tmp_path / "m-2.kmz").mkdir()
        with pytest.raises(InputError, match=r"m-2\.kmz: cannot be written"):
            export(example_plan(), None, None, FileFormat.DJI_KMZ, tmp_path / "m.kmz", FIXED)
        assert [path.name for path in tmp_path.iterdir()] == ["m-2.kmz"]

    def test_missing_folder_is_named(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="cannot be written"):
            export(example_plan(), None, None, FileFormat.CSV, tmp_path / "no" / "m.csv", FIXED)

    def test_content_decides_and_not_the_name(self, tmp_path: Path) -> None:
        for file_format in FileFormat:
            path = tmp_path / f"{file_format.value}.txt"
            export(example_plan(), None, None, file_format, path, FIXED)
            assert {mission.format for mission in read_missions(path)} == {file_format}

    @pytest.mark.parametrize("content", [b"", b"\x00\x01\x02", b"hello", b"[1, 2]", b"a,b,c\n1,2,3\n"])
    def test_unknown_content_says_what_is_known(self, tmp_path: Path, content: bytes) -> None:
        path = tmp_path / "m.kmz"
        path.write_bytes(content)
        with pytest.raises(InputError, match="no mission file that is known; expected a DJI KMZ"):
            read_missions(path)

    def test_our_own_plan_is_not_a_mission(self, tmp_path: Path) -> None:
        from planning.plan import write_plan

        write_plan(tmp_path / "plan.json", example_plan())
        with pytest.raises(InputError, match="a Reflight plan already"):
            read_missions(tmp_path / "plan.json")


class TestRefusals:
    def test_mavlink_has_no_heights_above_the_ellipsoid(self, tmp_path: Path) -> None:
        options = replace(FIXED, height_reference=HeightReference.ELLIPSOID)
        with pytest.raises(MissionError, match="no heights above the ellipsoid; expected above-takeoff or amsl"):
            export(example_plan(), None, None, FileFormat.MAVLINK_PLAN, tmp_path / "m.plan", options)

    def test_dji_needs_an_aircraft_of_dji(self, tmp_path: Path) -> None:
        with pytest.raises(MissionError, match="the plan has the profile 'px4'; expected one of m30, m350_p1, m3e"):
            export(example_plan("px4"), None, None, FileFormat.DJI_KMZ, tmp_path / "m.kmz", FIXED)
        assert list(tmp_path.iterdir()) == []

    def test_more_items_than_ardupilot_keeps_are_refused_with_the_number(self, tmp_path: Path) -> None:
        from tests.missions.plans import make_plan, ring

        plan = make_plan([(ring(130), {})])
        with pytest.raises(MissionError, match="the mission has 656 items, ArduPilot keeps 650"):
            export(plan, None, None, FileFormat.MAVLINK_PLAN, tmp_path / "m.plan", FIXED)
        px4 = replace(FIXED, autopilot=Autopilot.PX4)
        assert len(export(plan, None, None, FileFormat.MAVLINK_PLAN, tmp_path / "m.plan", px4)) == 1


def test_mavlink_files_follow_the_profiles_autopilot_and_else_ardupilot() -> None:
    def is_px4(plan: Plan, options: ExportOptions = FIXED) -> bool:
        return b'"firmwareType": 12' in encode(plan, None, None, FileFormat.MAVLINK_PLAN, options).contents[0]

    assert not is_px4(example_plan())
    assert not is_px4(example_plan("ardupilot"))
    assert is_px4(example_plan("px4"))
    assert is_px4(example_plan(), replace(FIXED, autopilot=Autopilot.PX4))


def site_model(tower_top_m: float = 45.0, facade_top_m: float = 30.0) -> SiteModel:
    corners = ((-5.0, -10.0, 0.0), (5.0, -10.0, 0.0), (5.0, -10.0, facade_top_m), (-5.0, -10.0, facade_top_m))
    zones = (NoFlyZone("road", ((60.0, 60.0), (70.0, 60.0), (70.0, 70.0), (60.0, 70.0)), 0.0, 100.0),)
    airspace = Airspace((-100.0, -100.0, 5.0), (100.0, 100.0, 100.0), 0.0, zones)
    tower = ((50.0, 50.0, 0.0), (52.0, 52.0, tower_top_m))
    site = Site(
        "office", HONG_KONG, (Facade("A", (Panel("A-0", corners),)),), airspace, HOME,
        obstacles=(Obstacle("tower", box_enu_m=tower),),
    )  # fmt: skip
    return SiteModel(site, empty_mesh(), (box_mesh(np.array(tower[0]), np.array(tower[1])),))


class TestReturnHeight:
    def height(self, options: ExportOptions) -> float:
        import io
        import zipfile

        content = encode(example_plan(), None, None, FileFormat.DJI_KMZ, options).contents[0]
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            text = archive.read("wpmz/waylines.wpml").decode()
        found = re.search("<wpml:globalRTHHeight>([^<]+)<", text)
        assert found is not None
        return float(found[1])

    def findings(self, options: ExportOptions) -> tuple[Finding, ...]:
        return encode(example_plan(), None, None, FileFormat.DJI_KMZ, options).findings

    def test_aircraft_return_above_everything_on_the_site(self) -> None:
        assert self.height(replace(FIXED, site=site_model())) == math.ceil(45.0 - HOME[2] + CLEARANCE_M)
        assert self.height(replace(FIXED, site=site_model(80.0))) == math.ceil(80.0 - HOME[2] + CLEARANCE_M)

    def test_pilots_height_is_taken_where_it_clears_the_site_and_refused_where_not(self, tmp_path: Path) -> None:
        assert self.height(replace(FIXED, site=site_model(), rth_height_m=70.0)) == 70.0
        low = replace(FIXED, site=site_model(), rth_height_m=40.0)
        with pytest.raises(MissionError, match="return height is below the highest point"):
            export(example_plan(), None, None, FileFormat.DJI_KMZ, tmp_path / "m.kmz", low)

    @pytest.mark.parametrize("height_m", [5.0, 19.9, 1500.1])
    @pytest.mark.parametrize("has_site", [True, False])
    def test_a_return_height_that_remote_controllers_do_not_take_is_refused(
        self, tmp_path: Path, height_m: float, has_site: bool
    ) -> None:
        options = replace(FIXED, site=site_model(3.0, 3.0) if has_site else None, rth_height_m=height_m)
        expected = f"expected 20 to 1500 m above take-off, got {height_m:g} m"
        with pytest.raises(MissionError, match=expected):
            export(example_plan(), None, None, FileFormat.DJI_KMZ, tmp_path / "m.kmz", options)

    def test_where_less_would_clear_everything_the_height_that_is_flown_is_told_with_its_reason(self) -> None:
        low = site_model(3.0, 3.0)
        options = replace(FIXED, site=low)
        assert self.height(options) == 20.0
        found = [f for f in self.findings(options) if f.code == "return-height"]
        assert [(f.severity, f.value) for f in found] == [(Severity.NOTE, 20.0)]
        assert re.search(r"returns 20 m above take-off, where 1\d m would do: .* no less", found[0].message)
        ceiling_z_m = HOME[2] + 15.0
        airspace = replace(low.site.airspace, max_enu_m=(100.0, 100.0, ceiling_z_m))
        options = replace(FIXED, site=replace(low, site=replace(low.site, airspace=airspace)))
        assert self.height(options) == 20.0
        found = [f for f in self.findings(options) if f.code == "return-height"]
        assert [(f.severity, f.limit) for f in found] == [(Severity.WARNING, 15.0)]
        assert "the airspace ends at 15.0 m" in found[0].message

    @pytest.mark.parametrize("top_m", [45.0, 80.04, 120.0])
    def test_the_refusal_of_a_low_return_height_names_the_lowest_that_is_taken(
        self, tmp_path: Path, top_m: float
    ) -> None:
        low = replace(FIXED, site=site_model(top_m), rth_height_m=21.0)
        with pytest.raises(MissionError, match="got 21 m") as refused:
            export(example_plan(), None, None, FileFormat.DJI_KMZ, tmp_path / "m.kmz", low)
        found = re.search(r"expected ([\d.]+) m or more above take-off.* and ([\d.]+) m keep 10 m", str(refused.value))
        assert found is not None
        least_m, clear_m = float(found[1]), float(found[2])
        path = tmp_path / "m.kmz"
        is_inside = least_m <= low.site.site.airspace.max_enu_m[2] - HOME[2]
        with nullcontext() if is_inside else pytest.raises(MissionError, match="above the airspace"):
            export(example_plan(), None, None, FileFormat.DJI_KMZ, path, replace(low, rth_height_m=least_m))
        with pytest.raises(MissionError, match="return height"):
            export(example_plan(), None, None, FileFormat.DJI_KMZ, path, replace(low, rth_height_m=least_m - 0.11))
        ceiling_m = low.site.site.airspace.max_enu_m[2] - HOME[2]
        wanted_m = math.ceil(clear_m)
        assert self.height(replace(low, rth_height_m=None)) == min(wanted_m, ceiling_m)

    def test_without_the_site_a_warning_says_that_only_the_path_is_cleared(self) -> None:
        findings = encode(example_plan(), None, None, FileFormat.DJI_KMZ, FIXED).findings
        found = [(f.code, f.severity) for f in findings if f.code != "camera-by-hand"]
        assert found == [("return-height", Severity.WARNING)]
        with_site = encode(example_plan(), None, None, FileFormat.DJI_KMZ, replace(FIXED, site=site_model()))
        notes = {("takeoff-check", Severity.NOTE), ("camera-by-hand", Severity.NOTE)}
        assert {(f.code, f.severity) for f in with_site.findings} == notes

    def test_each_sortie_says_what_is_seen_at_its_first_waypoint(self) -> None:
        """Heights count from take-off, and an aircraft does not know how high that lies."""
        plan, site = example_plan(), site_model().site
        panels = [corner[2] for panel in site.panels for corner in panel.corners_enu_m]
        for number, sortie in enumerate(plan.sorties, 1):
            check = takeoff_check(plan, site, number)
            assert check is not None
            first_z_m = sortie.path_enu_m[1][2]
            assert check.above_takeoff_m == pytest.approx(first_z_m - HOME[2])
            assert abs(check.above_edge_m) == pytest.approx(min(abs(first_z_m - z) for z in panels))
            edge_z_m = max(panels) if check.is_upper_edge else min(panels)
            assert check.above_edge_m == pytest.approx(first_z_m - edge_z_m)
            assert f"stops {check.above_takeoff_m:.1f} m above take-off" in str(check)
            assert f"edge of facade '{site.facades[0].id}'" in str(check)


def test_no_fly_zones_of_the_site_become_fences(tmp_path: Path) -> None:
    from missions.mavlink.plan_json import read_plan_json

    path = tmp_path / "m.plan"
    export(example_plan(), None, None, FileFormat.MAVLINK_PLAN, path, replace(FIXED, site=site_model()))
    (fence,) = read_plan_json(path).fences
    assert len(fence) == 4


def test_plan_without_origin_is_written_with_that_of_the_site(tmp_path: Path) -> None:
    plan = replace(example_plan(), origin=None, home_enu_m=None)
    with pytest.raises(InputError, match="--site SITE"):
        export(plan, None, None, FileFormat.CSV, tmp_path / "m.csv", FIXED)
    export(plan, HONG_KONG, HOME, FileFormat.CSV, tmp_path / "m.csv", FIXED)
    first = read_missions(tmp_path / "m.csv")[0].waypoints[0]
    assert first.height_ellipsoid_m is not None
    assert altitude_amsl_m(GeoPoint(first.lat_deg, first.lon_deg, first.height_ellipsoid_m)) > 0.0
