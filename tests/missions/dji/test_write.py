"""The written KMZ, read by the standard library's own XML parser: a twin that shares no code with our reader."""

from __future__ import annotations

import io
import itertools
import math
import zipfile
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings

from missions.dji.write import DjiOptions, kmz_bytes
from missions.formats.options import ExportOptions
from missions.formats.registry import encode
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HIGHEST_RETURN_M, LOWEST_RETURN_M, FileFormat, HeightReference, LinkLoss
from missions.mission.model import Mission, altitude_amsl_m
from planning.base.errors import MissionError
from planning.parameters import Constraints, FlightRules
from planning.plan import Plan
from tests.missions.plans import example_plan, make_plan, plans, ring
from tests.planning.plan_cases import kiosk

KML = "{http://www.opengis.net/kml/2.2}"
WPML = "{http://www.dji.com/wpmz/1.0.6}"
OPTIONS = DjiOptions(rth_height_m=60.0, created_ms=1_700_000_000_000)


def parts(mission: Mission, options: DjiOptions = OPTIONS) -> tuple[ElementTree.Element, ElementTree.Element]:
    with zipfile.ZipFile(io.BytesIO(kmz_bytes(mission, options))) as archive:
        assert archive.namelist() == ["wpmz/template.kml", "wpmz/waylines.wpml"]
        template, waylines = (ElementTree.fromstring(archive.read(name)) for name in archive.namelist())
    return template, waylines


def names(element: ElementTree.Element) -> list[str]:
    return [child.tag.rpartition("}")[2] for child in element]


def text(element: ElementTree.Element, path: str) -> str:
    found = element.find("/".join(f"{WPML}{name}" for name in path.split("/")))
    assert found is not None, path
    return found.text or ""


def placemarks(part: ElementTree.Element) -> list[ElementTree.Element]:
    return list(part.iter(f"{KML}Placemark"))


def config(part: ElementTree.Element) -> ElementTree.Element:
    found = next(part.iter(f"{WPML}missionConfig"), None)
    assert found is not None
    return found


def actions(placemark: ElementTree.Element) -> list[tuple[str, dict[str, str]]]:
    return [
        (
            text(action, "actionActuatorFunc"),
            {p.tag.rpartition("}")[2]: p.text or "" for p in action.findall(f"{WPML}actionActuatorFuncParam/*")},
        )
        for action in placemark.iter(f"{WPML}action")
    ]


def test_elements_stand_in_the_order_of_djis_own_files() -> None:
    template, waylines = parts(missions_from_plan(example_plan())[0])
    head = "flyToWaylineMode finishAction exitOnRCLost executeRCLostAction takeOffSecurityHeight"
    tail = "globalTransitionalSpeed globalRTHHeight droneInfo waylineAvoidLimitAreaMode payloadInfo"
    assert names(config(waylines)) == f"{head} {tail}".split()
    assert names(config(template)) == f"{head} takeOffRefPoint takeOffRefPointAGLHeight {tail}".split()
    document = template.find(f"{KML}Document")
    assert document is not None
    assert names(document) == ["author", "createTime", "updateTime", "missionConfig", "Folder"]
    folder = next(waylines.iter(f"{KML}Folder"))
    assert names(folder)[:7] == [
        "templateId", "executeHeightMode", "waylineId", "distance", "duration", "autoFlightSpeed", "Placemark",
    ]  # fmt: skip
    with_view = placemarks(waylines)[1]
    assert names(with_view) == [
        "Point", "index", "executeHeight", "waypointSpeed", "waypointHeadingParam", "waypointTurnParam",
        "useStraightLine", "actionGroup", "waypointGimbalHeadingParam", "isRisky", "waypointWorkType",
    ]  # fmt: skip
    assert names(placemarks(template)[1]) == [
        "Point", "index", "ellipsoidHeight", "height", "waypointHeadingParam", "useGlobalHeight", "useGlobalSpeed",
        "useGlobalHeadingParam", "useGlobalTurnParam", "useStraightLine", "actionGroup", "isRisky",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("profile", "drone", "payload"),
    [
        ("m3e", "77-0", "66"),
        ("m3t", "77-1", "67"),
        ("m4e", "99-0", "88"),
        ("m30", "67-0", "52"),
        ("m350_p1", "89-0", "50"),
    ],
)
def test_each_profile_is_written_with_its_numbers(profile: str, drone: str, payload: str) -> None:
    for part in parts(missions_from_plan(example_plan(profile))[0]):
        numbers = (
            f"{text(config(part), 'droneInfo/droneEnumValue')}-{text(config(part), 'droneInfo/droneSubEnumValue')}"
        )
        assert numbers == drone
        assert text(config(part), "payloadInfo/payloadEnumValue") == payload


@pytest.mark.parametrize("profile", ["ardupilot", "px4", ""])
def test_aircraft_that_dji_does_not_make_is_refused_with_the_list(profile: str) -> None:
    (mission, *_) = missions_from_plan(example_plan())
    with pytest.raises(MissionError, match="expected one of m30, m350_p1, m3e, m3t, m4e"):
        kmz_bytes(replace(mission, profile=profile), OPTIONS)


@pytest.mark.slow
@given(plan=plans())
@settings(max_examples=30)
def test_every_photo_is_aimed_settled_and_taken_in_order(plan: Plan) -> None:
    for mission in missions_from_plan(plan):
        template, waylines = parts(mission)
        first = next(photo for waypoint in mission.waypoints for photo in waypoint.photos)
        for part in (template, waylines):
            found = placemarks(part)
            assert len(found) == len(mission.waypoints)
            for index, (placemark, waypoint) in enumerate(zip(found, mission.waypoints, strict=True)):
                assert text(placemark, "index") == str(index)
                left = actions(placemark)
                for photo in waypoint.photos:
                    (turn, turned), (tilt, tilted), *left = left
                    assert (turn, tilt) == ("rotateYaw", "gimbalRotate")
                    off_deg = float(turned["aircraftHeading"]) - photo.heading_deg
                    assert abs((off_deg + 180.0) % 360.0 - 180.0) <= 0.00501
                    assert -180.0 <= float(turned["aircraftHeading"]) <= 180.0
                    assert float(tilted["gimbalPitchRotateAngle"]) == pytest.approx(photo.gimbal_pitch_deg, abs=0.00501)
                    assert tilted["gimbalPitchRotateEnable"] == "1"
                    assert tilted["gimbalHeadingYawBase"] == "north"
                    assert tilted["gimbalYawRotateEnable"] == tilted["gimbalRollRotateEnable"] == "0"
                    until = [name for name, _ in left].index("takePhoto")
                    (done, shot), before, left = left[until], left[:until], left[until + 1 :]
                    # Focus is locked by default: it is found once, before the first photo.
                    focused = ["focus", "setFocusType"] if part is waylines and photo is first else []
                    assert [name for name, _ in before if name != "hover"] == ["zoom", *focused]
                    hovers = [float(hover["hoverTime"]) for name, hover in before if name == "hover"]
                    assert hovers == ([plan.rules.settle_s] if plan.rules.settle_s > 0 else [])
                    assert hovers == [] or before[-1][0] == "hover"
                    assert (done, shot["fileSuffix"]) == ("takePhoto", photo.viewpoint_id)
                assert left == []


def test_action_groups_and_actions_are_numbered_from_0_without_gaps() -> None:
    _, waylines = parts(missions_from_plan(example_plan())[0])
    groups = list(waylines.iter(f"{WPML}actionGroup"))
    assert [text(group, "actionGroupId") for group in groups] == [str(i) for i in range(6)]
    for group in groups:
        assert text(group, "actionGroupStartIndex") == text(group, "actionGroupEndIndex")
        ids = [text(action, "actionId") for action in group.findall(f"{WPML}action")]
        assert ids == [str(i) for i in range(len(ids))]


def test_two_photos_of_one_place_share_a_waypoint_and_a_group() -> None:
    views = ring(2)
    views[1] = replace(views[1], position_enu_m=views[0].position_enu_m)
    _, waylines = parts(missions_from_plan(make_plan([(views, {})]))[0])
    assert [len([n for n, _ in actions(p) if n == "takePhoto"]) for p in placemarks(waylines)] == [0, 2, 0]
    assert len(list(waylines.iter(f"{WPML}actionGroup"))) == 1


def test_legs_are_straight_and_every_waypoint_stops() -> None:
    _, waylines = parts(missions_from_plan(example_plan())[0])
    for placemark in placemarks(waylines):
        assert text(placemark, "waypointTurnParam/waypointTurnMode") == "toPointAndStopWithDiscontinuityCurvature"
        assert text(placemark, "useStraightLine") == "1"
        assert text(placemark, "waypointHeadingParam/waypointHeadingMode") == "fixed"


def test_turning_in_flight_reaches_each_view_with_its_heading() -> None:
    mission = missions_from_plan(example_plan(rules=FlightRules(turn_in_flight=True)))[0]
    _, waylines = parts(mission)
    wanted = None
    for placemark, waypoint in reversed(list(zip(placemarks(waylines), mission.waypoints, strict=True))):
        param = "waypointHeadingParam"
        assert text(placemark, f"{param}/waypointHeadingMode") == "smoothTransition"
        assert text(placemark, f"{param}/waypointHeadingAngleEnable") == "1"
        wanted = waypoint.photos[0].heading_deg if waypoint.photos else wanted
        if wanted is not None:
            assert float(text(placemark, f"{param}/waypointHeadingAngle")) == pytest.approx(wanted, abs=0.01)


@pytest.mark.parametrize("reference", list(HeightReference))
def test_heights_stand_in_the_reference_that_was_asked_for(reference: HeightReference) -> None:
    mission = missions_from_plan(example_plan())[0]
    template, waylines = parts(mission, replace(OPTIONS, height_reference=reference))
    is_relative = reference is HeightReference.ABOVE_TAKEOFF
    mode = next(waylines.iter(f"{WPML}executeHeightMode")).text
    assert mode == ("relativeToStartPoint" if is_relative else "WGS84")
    assert next(template.iter(f"{WPML}heightMode")).text == ("relativeToStartPoint" if is_relative else "EGM96")
    for flown, planned, waypoint in zip(placemarks(waylines), placemarks(template), mission.waypoints, strict=True):
        point = waypoint.position
        above_m = point.height_ellipsoid_m - mission.takeoff.height_ellipsoid_m
        executed = float(text(flown, "executeHeight"))
        assert executed == pytest.approx(above_m if is_relative else point.height_ellipsoid_m, abs=1e-4)
        assert float(text(planned, "ellipsoidHeight")) == executed
        height = above_m if is_relative else altitude_amsl_m(point)
        assert float(text(planned, "height")) == pytest.approx(height, abs=1e-4)


def test_aircraft_climbs_no_higher_than_the_first_waypoint_above_home() -> None:
    mission = missions_from_plan(example_plan())[0]
    _, waylines = parts(mission)
    climb_m = float(text(config(waylines), "takeOffSecurityHeight"))
    first_m = float(text(placemarks(waylines)[0], "executeHeight"))
    assert first_m - 0.1 <= climb_m <= first_m
    assert text(config(waylines), "flyToWaylineMode") == "safely"
    assert text(config(waylines), "finishAction") == "goHome"


@pytest.mark.parametrize("first_m", [2.0, 4.96, 5.002, 12.34])
@pytest.mark.parametrize("lowest_m", [5.0, 7.25, 3.0])
def test_aircraft_never_fly_sideways_below_the_lowest_flight(first_m: float, lowest_m: float) -> None:
    """The first waypoint stands `first_m` above home; the plan's lowest height, and the ground that the site knows."""
    plan = replace(
        make_plan([(ring(3), {})]), constraints=Constraints(min_height_above_ground_m=lowest_m), site="kiosk"
    )
    home, sortie = plan.home_enu_m, plan.sorties[0]
    assert home is not None
    top = (home[0], home[1], home[2] + first_m)
    low = replace(plan, sorties=(replace(sortie, path_enu_m=(home, top, *sortie.path_enu_m[2:-2], top, home)),))
    airspace = kiosk().site.airspace
    for site, least_m in (
        (None, lowest_m),
        (kiosk(home_enu_m=home, airspace=replace(airspace, ground_z_m=home[2] - 1.5)), lowest_m - 1.5),
    ):
        content = encode(low, None, None, FileFormat.DJI_KMZ, ExportOptions(site=site)).contents[0]
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            part = ElementTree.fromstring(archive.read("wpmz/waylines.wpml"))
        climb_m = float(text(config(part), "takeOffSecurityHeight"))
        assert climb_m >= least_m - 1e-9
        assert climb_m == pytest.approx(max(math.floor(first_m * 10.0) / 10.0, math.ceil(least_m * 10.0) / 10.0))


def test_return_height_is_written_as_it_was_chosen_and_none_that_remote_controllers_do_not_take() -> None:
    mission = missions_from_plan(example_plan())[0]
    assert text(config(parts(mission)[1]), "globalRTHHeight") == "60"
    for height_m in (LOWEST_RETURN_M, HIGHEST_RETURN_M):
        written = text(config(parts(mission, replace(OPTIONS, rth_height_m=height_m))[1]), "globalRTHHeight")
        assert float(written) == height_m
    for height_m in (LOWEST_RETURN_M - 0.1, HIGHEST_RETURN_M + 0.1, math.nan):
        with pytest.raises(ValueError, match="expected 20 to 1500 m"):
            replace(OPTIONS, rth_height_m=height_m)


def test_lost_link_continues_on_the_checked_path_unless_asked_otherwise() -> None:
    mission = missions_from_plan(example_plan())[0]
    stays = config(parts(mission)[1])
    assert (text(stays, "exitOnRCLost"), text(stays, "executeRCLostAction")) == ("goContinue", "goBack")
    leaves = config(parts(mission, replace(OPTIONS, link_loss=LinkLoss.GO_HOME))[1])
    assert text(leaves, "exitOnRCLost") == "executeLostAction"


def test_take_off_reference_has_latitude_first_and_coordinates_longitude_first() -> None:
    mission = missions_from_plan(example_plan())[0]
    template, waylines = parts(mission)
    lat, lon, height = map(float, text(config(template), "takeOffRefPoint").split(","))
    home = mission.takeoff
    assert (lat, lon, height) == pytest.approx((home.lat_deg, home.lon_deg, home.height_ellipsoid_m), abs=1e-6)
    coordinates = placemarks(waylines)[0].find(f"{KML}Point/{KML}coordinates")
    assert coordinates is not None
    lon, lat = map(float, (coordinates.text or "").split(","))
    assert (lat, lon) == pytest.approx((home.lat_deg, home.lon_deg), abs=1e-6)


def test_distance_is_the_length_of_the_waypoints_and_duration_the_plans_own() -> None:
    plan = example_plan()
    mission = missions_from_plan(plan)[0]
    _, waylines = parts(mission)
    path = plan.sorties[0].path_enu_m[1:-1]
    length_m = sum(math.dist(a, b) for a, b in itertools.pairwise(path))
    assert float(next(waylines.iter(f"{WPML}distance")).text or "") == pytest.approx(length_m, abs=0.01)
    assert float(next(waylines.iter(f"{WPML}duration")).text or "") == pytest.approx(
        plan.sorties[0].duration_s, abs=0.01
    )


def test_speed_is_limited_to_what_the_format_allows() -> None:
    mission = replace(missions_from_plan(example_plan())[0], speed_m_s=23.0)
    _, waylines = parts(mission)
    assert next(waylines.iter(f"{WPML}autoFlightSpeed")).text == "15"


def test_ids_that_no_file_name_can_hold_are_made_safe() -> None:
    views = [replace(view, id=f'v<{i}>/"&') for i, view in enumerate(ring(2))]
    _, waylines = parts(missions_from_plan(make_plan([(views, {})]))[0])
    suffixes = [
        params["fileSuffix"] for p in placemarks(waylines) for name, params in actions(p) if name == "takePhoto"
    ]
    assert suffixes == ["v_0____", "v_1____"]


def test_same_mission_and_time_give_the_same_bytes() -> None:
    mission = missions_from_plan(example_plan())[0]
    assert kmz_bytes(mission, OPTIONS) == kmz_bytes(mission, OPTIONS)
    assert kmz_bytes(mission, OPTIONS) != kmz_bytes(mission, replace(OPTIONS, created_ms=1))
