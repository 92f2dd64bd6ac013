from __future__ import annotations

from pathlib import Path

import pytest

from missions.formats.options import ExportOptions
from missions.formats.registry import encode, read_missions
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.wpl import read_wpl
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat
from planning.base.errors import MissionError
from tests.missions.plans import example_plan

HOME = "0\t1\t0\t16\t0\t0\t0\t0\t52.0\t5.0\t10.0\t1"
FLIGHT = "1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t20\t1\n2\t0\t3\t16\t0\t0\t0\t0\t52.001\t5.0\t25\t1"


def wpl_file(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "m.waypoints"
    path.write_bytes(text.encode())
    return path


def written(options: ExportOptions | None = None) -> str:
    encoded = encode(example_plan(), None, None, FileFormat.MAVLINK_WPL, options or ExportOptions())
    return encoded.contents[0].decode()


def test_lines_end_in_lf_and_have_twelve_columns_behind_home() -> None:
    text = written()
    assert "\r" not in text
    header, *lines, last = text.split("\n")
    assert (header, last) == ("QGC WPL 110", "")
    rows = [line.split("\t") for line in lines]
    assert {len(row) for row in rows} == {12}
    assert [row[0] for row in rows] == [str(i) for i in range(len(rows))]
    assert [row[1] for row in rows].count("1") == 1
    assert rows[0][1:4] == ["1", "0", "16"]


def test_positions_are_written_to_a_tenth_of_a_millimetre() -> None:
    mission = missions_from_plan(example_plan())[0]
    rows = [row.split("\t") for row in written().split("\n")[2:-1]]
    places = [tuple(map(float, row[8:11])) for row in rows if row[3] == "16"]
    for (lat, lon, above_m), waypoint in zip(places, mission.waypoints, strict=True):
        assert abs(lat - waypoint.position.lat_deg) <= 1e-9
        assert abs(lon - waypoint.position.lon_deg) <= 1e-9
        assert abs(above_m - mission.height_above_takeoff_m(waypoint.position)) <= 1e-4


def test_home_is_in_line_0_for_px4_too_because_qgroundcontrol_takes_it_for_that() -> None:
    assert written(ExportOptions(autopilot=Autopilot.PX4)).split("\n")[1].split("\t")[:4] == ["0", "1", "0", "16"]


def test_crlf_comments_blank_lines_and_a_byte_order_mark_are_read(tmp_path: Path) -> None:
    plain = read_wpl(wpl_file(tmp_path, f"QGC WPL 110\n{HOME}\n{FLIGHT}\n"))
    marked = f"\ufeffQGC WPL 110\n\n# made by hand\n{HOME}\n{FLIGHT}\n".replace("\n", "\r\n")
    assert read_wpl(wpl_file(tmp_path, marked)) == plain
    assert len(plain.items) == 2
    assert plain.home is not None


def test_home_of_mission_planner_that_was_never_set_is_no_place(tmp_path: Path) -> None:
    file = read_wpl(wpl_file(tmp_path, "QGC WPL 110\n0\t1\t0\t0\t0\t0\t0\t0\t0\t0\t0\t1\n" + FLIGHT))
    assert file.home is None
    assert [item.command for item in file.items] == [22, 16]


def test_version_120_has_no_home(tmp_path: Path) -> None:
    assert read_wpl(wpl_file(tmp_path, f"QGC WPL 120\n{HOME}\n{FLIGHT}")).home is None


class TestRealFiles:
    def test_item_0_of_mission_planner_is_home(self, shared_data: Path) -> None:
        (mission,) = read_missions(shared_data / "missions" / "qgc_test_MissionPlanner.waypoints")
        assert len(mission.waypoints) == 5
        assert mission.takeoff is not None
        assert (mission.takeoff.lat_deg, mission.takeoff.lon_deg) == (47.660459, -122.103167)
        assert mission.waypoints[0].height_above_takeoff_m == 100.0

    def test_file_that_begins_with_a_takeoff_has_no_home(self, shared_data: Path) -> None:
        (mission,) = read_missions(shared_data / "missions" / "mavsdk_mission_planner_sample.txt")
        assert mission.takeoff is None
        assert len(mission.waypoints) == 3
        assert mission.waypoints[0].height_ellipsoid_m == pytest.approx(15.0 + 47.3, abs=1.0)  # frame 5: sea level


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("QGC WPL 100\n", "expected 'QGC WPL 110' in the first line"),
        (f"QGC WPL 110\n{HOME}\n1\t0\t3\t16\t0", "line 3: expected 12 columns, found 5"),
        (
            f"QGC WPL 110\n{HOME}\n1\t0\t3\t16\t0\t0\t0\t0\t52,0\t5,0\t25\t1",
            "line 3: expected numbers with a decimal point",
        ),
        (
            f"QGC WPL 110\n{HOME}\n3\t0\t3\t16\t0\t0\t0\t0\t52.0\t5.0\t25\t1",
            "numbered from 0 in order, found 3 in place 1",
        ),
        (f"QGC WPL 110\n{HOME}\n", "no waypoint"),
        (f"QGC WPL 110\n{HOME}\n1\t0\t3\t16\t0\t0\t0\t0\t52.0\t5.0\tinf\t1", "not on the globe"),
    ],
)
def test_wrong_file_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(MissionError, match=message):
        read_missions(wpl_file(tmp_path, text))


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "m.waypoints"
    path.write_bytes(b"QGC WPL 110\n\xff\xfe\x00")
    with pytest.raises(MissionError, match="found other bytes at offset 12"):
        read_missions(path)


def test_a_home_that_cannot_be_is_told_and_not_used(tmp_path: Path) -> None:
    path = tmp_path / "m.waypoints"
    path.write_text(
        "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t152.0\t5.0\t10.0\t1\n1\t0\t3\t16\t0\t0\t0\t0\t52.0\t5.0\t25\t1"
    )
    file = read_wpl(path)
    assert file.home is None
    assert len(file.items) == 1
    assert "home position 152, 5, 10 m is not on the globe" in file.findings[0].message


def test_items_out_of_order_are_taken_by_their_numbers(tmp_path: Path) -> None:
    path = tmp_path / "m.waypoints"
    lines = [f"{k}\t0\t3\t16\t0\t0\t0\t0\t52.{k}\t5.0\t25\t1" for k in (0, 2, 1)]
    path.write_text("\n".join(["QGC WPL 110", *lines]))
    file = read_wpl(path)
    assert [item.params[4] for item in file.items] == [52.1, 52.2]
    assert "taken in the order of their numbers" in file.findings[0].message


def test_a_home_that_stands_elsewhere_than_in_line_0_is_told_since_vehicles_fly_to_it(tmp_path: Path) -> None:
    places = ["22\t0\t0\t0\t0\t47.0\t8.0\t30", "16\t0\t0\t0\t0\t47.001\t8.0\t30"]
    lines = [f"{number}\t0\t3\t{place}\t1" for number, place in enumerate(places)]
    home = "2\t1\t0\t16\t0\t0\t0\t0\t47.0\t8.0\t408\t1"
    path = tmp_path / "a.waypoints"
    for last, n_told in ((home, 1), (home.replace("\t1\t0\t16", "\t1\t3\t16"), 0)):
        path.write_text("\n".join(["QGC WPL 110", *lines, last]))
        told = [finding.message for finding in read_wpl(path).findings if finding.code == "home"]
        assert len(told) == n_told
        assert all("item 2 looks like home" in text and "408 m above sea level" in text for text in told)
