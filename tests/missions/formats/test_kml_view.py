from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from missions.formats.kml_view import SIGHT_M, kml_bytes, read_kml
from missions.mission.build import missions_from_plan
from missions.mission.model import Finish, altitude_amsl_m
from planning.base.errors import MissionError
from planning.geo.enu import enu_from_geodetic
from planning.geo.geoid import ellipsoid_from_amsl_m
from tests.missions.plans import HONG_KONG, example_plan

KML = "{http://www.opengis.net/kml/2.2}"


def folders() -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(kml_bytes(missions_from_plan(example_plan()))).iter(f"{KML}Folder"))


def points_enu_m(text: str) -> np.ndarray:
    lon, lat, altitude = np.array([[float(v) for v in part.split(",")] for part in text.split()]).T
    return enu_from_geodetic(HONG_KONG, lat, lon, ellipsoid_from_amsl_m(lat, lon, altitude))


def test_each_sortie_has_a_folder_with_its_path_in_absolute_altitudes() -> None:
    for folder, sortie in zip(folders(), example_plan().sorties, strict=True):
        line = folder.find(f".//{KML}LineString")
        assert line is not None
        assert line.findtext(f"{KML}altitudeMode") == "absolute"
        np.testing.assert_allclose(points_enu_m(line.findtext(f"{KML}coordinates", "")), sortie.path_enu_m, atol=0.001)


def test_each_photo_has_a_camera_that_shows_its_view() -> None:
    plan = example_plan()
    cameras = [camera for folder in folders() for camera in folder.iter(f"{KML}Camera")]
    mission = missions_from_plan(plan)[0]
    for camera, view in zip(cameras, plan.viewpoints, strict=True):
        heading, tilt = float(camera.findtext(f"{KML}heading", "")), float(camera.findtext(f"{KML}tilt", ""))
        assert heading == pytest.approx(view.heading_deg % 360.0, abs=0.001)
        assert tilt == pytest.approx(90.0 + view.gimbal_pitch_deg, abs=0.001)
    first = mission.waypoints[1].position
    assert float(cameras[0].findtext(f"{KML}altitude", "")) == pytest.approx(altitude_amsl_m(first), abs=0.001)


def test_line_of_sight_points_where_the_photo_looks() -> None:
    plan = example_plan()
    lines = [
        placemark.findtext(f"{KML}LineString/{KML}coordinates", "")
        for folder in folders()
        for placemark in folder.iter(f"{KML}Placemark")
        if placemark.findtext(f"{KML}styleUrl") == "#sight"
    ]
    for line, view in zip(lines, plan.viewpoints, strict=True):
        start, end = points_enu_m(line)
        h, p = math.radians(view.heading_deg), math.radians(view.gimbal_pitch_deg)
        forward = [math.cos(p) * math.sin(h), math.cos(p) * math.cos(h), math.sin(p)]
        np.testing.assert_allclose(end - start, SIGHT_M * np.array(forward), atol=0.002)


def test_kml_of_ours_comes_back_with_take_off_and_landing(tmp_path: Path) -> None:
    path = tmp_path / "m.kml"
    missions = missions_from_plan(example_plan())
    path.write_bytes(kml_bytes(missions))
    for found, mission in zip(read_kml(path), missions, strict=True):
        assert found.finish is Finish.LAND
        assert found.takeoff is not None
        assert found.takeoff.height_ellipsoid_m == pytest.approx(mission.takeoff.height_ellipsoid_m, abs=1e-3)
        assert len(found.waypoints) == len(mission.waypoints)


def test_names_are_escaped() -> None:
    from dataclasses import replace

    plan = replace(example_plan(), site='<A> & "B"')
    document = ElementTree.fromstring(kml_bytes(missions_from_plan(plan)))
    assert document.findtext(f"{KML}Document/{KML}name") == '<A> & "B"'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<kml", "not readable as XML"),
        (f'<kml xmlns="{KML[1:-1]}"><Placemark/></kml>', "KML of another program"),
        (
            f'<kml xmlns="{KML[1:-1]}"><Folder><ExtendedData><Data name="sortie"><value>1</value></Data></ExtendedData>'
            "</Folder></kml>",
            "damaged: a sortie lacks",
        ),
    ],
)
def test_other_kml_is_refused_with_the_reason(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "m.kml"
    path.write_text(text)
    with pytest.raises(MissionError, match=message):
        read_kml(path)
