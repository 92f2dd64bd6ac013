from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from missions.formats.csv_table import COLUMNS, csv_bytes, read_csv
from missions.mission.build import missions_from_plan
from missions.mission.model import GeoPoint, altitude_amsl_m
from planning.base.errors import MissionError
from tests.missions.plans import example_plan


def rows() -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(csv_bytes(missions_from_plan(example_plan())).decode())))


def test_each_photo_has_a_row_in_the_order_of_flight() -> None:
    assert [(row["sortie"], row["sequence"]) for row in rows()] == [
        *[("1", str(i)) for i in range(1, 7)],
        *[("2", str(i)) for i in range(1, 5)],
    ]
    assert [row["viewpoint_id"] for row in rows()] == [f"v{i:04d}" for i in range(10)]


def test_each_height_stands_in_its_own_column_and_local_coordinates_are_the_plans() -> None:
    plan = example_plan()
    assert plan.home_enu_m is not None
    mission = missions_from_plan(plan)[0]
    for row, view in zip(rows(), plan.viewpoints, strict=True):
        point = GeoPoint(float(row["lat_deg"]), float(row["lon_deg"]), float(row["height_ellipsoid_m"]))
        assert float(row["altitude_amsl_m"]) == pytest.approx(altitude_amsl_m(point), abs=1e-3)
        above_m = point.height_ellipsoid_m - mission.takeoff.height_ellipsoid_m
        assert float(row["height_above_takeoff_m"]) == pytest.approx(above_m, abs=1e-3)
        local = tuple(float(row[name]) for name in ("east_m", "north_m", "up_m"))
        assert local == pytest.approx(view.position_enu_m, abs=1e-3)
        assert float(row["gimbal_pitch_deg"]) == pytest.approx(view.gimbal_pitch_deg, abs=1e-3)


def test_columns_may_stand_in_any_order_and_others_among_them(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text(
        "sortie,note,sequence,viewpoint_id,gimbal_pitch_deg,heading_deg,height_ellipsoid_m,lon_deg,lat_deg\n"
        "1,good light,1,a,-5,90,60,114.2,22.3\n"
    )
    (mission,) = read_csv(path)
    assert mission.waypoints[0].lat_deg == 22.3
    assert mission.waypoints[0].photos[0].gimbal_pitch_deg == -5.0


HEADER = ",".join(COLUMNS)
ROW = "1,1,a,22.3,114.2,60,58,20,90,-5,0,0,0"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADER, "no rows"),
        (HEADER.replace("lat_deg", "latitude") + "\n" + ROW, "expected the column lat_deg"),
        (HEADER + "\n" + ROW.replace("22.3", "22;3"), "line 2: no photo"),
        (HEADER + "\n" + ROW + "\n" + ROW.replace("22.3", "122.3"), "line 3: no photo .* on the globe"),
        (HEADER + "\n" + ROW.replace(",-5,", ",-500,"), "gimbal_pitch_deg: expected -180 to 90"),
        (HEADER + "\n" + ROW.replace(",60,", ",nan,"), "finite height"),
        (HEADER + "\n1,1,a", "line 2: no photo"),
        (HEADER + "\nx" + ROW, "line 2: no photo"),
        (HEADER + "\n" + "a" * 200_000, "line [12]: no table of photos"),
    ],
)
def test_wrong_table_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "m.csv"
    path.write_text(text)
    with pytest.raises(MissionError, match=message):
        read_csv(path)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_bytes(HEADER.encode() + b"\n\xff\xfe")
    with pytest.raises(MissionError, match="found other bytes"):
        read_csv(path)
