"""Each rule of the validator with a file that breaks it, made from one that breaks none."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from missions.dji.check import check_dji
from missions.dji.wpml import DjiParts, load_parts, parse_wpml, parts_of_kmz
from missions.dji.write import DjiOptions, kmz_bytes
from missions.mission.build import missions_from_plan
from planning.base.findings import Severity
from tests.missions.plans import example_plan

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE

FROM_DJI = (
    "djisdk_psdk_m3e_waypoint_v3_test.kmz",
    "djisdk_msdk_m30_waypointsample.kmz",
    "geoyee_m3t_waypoint.kmz",
    "geoyee_m3d_curtainwall_slope_mapping2d.kmz",
    "tum_m4td_fh2_waypoint_rotateyaw_photo",
    "traitlab_m3e_pilot2_Waypoint2_rtk",
)


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    import io
    import zipfile

    mission = missions_from_plan(example_plan())[0]
    with zipfile.ZipFile(io.BytesIO(kmz_bytes(mission, DjiOptions(60.0, 0)))) as archive:
        return {name.removeprefix("wpmz/"): archive.read(name).decode() for name in archive.namelist()}


def found_in(texts: dict[str, str]) -> set[tuple[str, Severity]]:
    waylines = parse_wpml(texts["waylines.wpml"].encode(), "waylines.wpml")
    template = parse_wpml(texts["template.kml"].encode(), "template.kml") if "template.kml" in texts else None
    return {(finding.code, finding.severity) for finding in check_dji(DjiParts(waylines, template))}


def test_what_we_write_has_nothing_to_complain_about() -> None:
    for profile in ("m3e", "m3t", "m4e", "m30", "m350_p1"):
        for mission in missions_from_plan(example_plan(profile)):
            assert check_dji(parts_of_kmz(kmz_bytes(mission, DjiOptions(60.0, 0)))) == ()


@pytest.mark.parametrize("name", FROM_DJI)
def test_files_of_djis_own_programs_have_no_error(shared_data: Path, name: str) -> None:
    findings = check_dji(load_parts(shared_data / "missions" / name))
    assert [finding for finding in findings if finding.severity is ERROR] == []


def test_file_edited_by_hand_has_the_known_errors(shared_data: Path) -> None:
    findings = check_dji(load_parts(shared_data / "missions" / "traitlab_m3t_edited_75wp"))
    errors = {finding.code for finding in findings if finding.severity is ERROR}
    assert {"coordinates", "action-group-id"} <= errors
    assert len([finding for finding in findings if finding.code == "coordinates"]) == 75


def swap(old: str, new: str, count: int = 1) -> Callable[[str], str]:
    """Replace the first `count` matches of a pattern; it must match."""

    def edit(text: str) -> str:
        edited, n = re.subn(old, new, text, count=count, flags=re.DOTALL)
        assert n, old
        return edited

    return edit


def tag(name: str, value: str, count: int = 1) -> Callable[[str], str]:
    return swap(rf"<wpml:{name}>[^<]*</wpml:{name}>", f"<wpml:{name}>{value}</wpml:{name}>", count)


def without(name: str) -> Callable[[str], str]:
    return swap(rf"\s*<wpml:{name}>.*?</wpml:{name}>", "")


def second_heads(mode: str) -> Callable[[str], str]:
    old = r"(<wpml:index>1</wpml:index>.*?)<wpml:waypointHeadingMode>fixed<"
    return swap(old, rf"\1<wpml:waypointHeadingMode>{mode}<")


def second_turns(damping: int) -> Callable[[str], str]:
    old = r"(<wpml:index>1</wpml:index>.*?)<wpml:waypointTurnMode>[^<]*<(.*?Dist>)0<"
    return swap(old, rf"\1<wpml:waypointTurnMode>coordinateTurn<\g<2>{damping}<")


ELSEWHERE = "<coordinates>114.2637,22.3369<"

RULES = [
    ("version", swap("1.0.6", "2.0.0"), "version", ERROR),
    ("latitude first", swap(r"<coordinates>([^,]+),([^<]+)<", r"<coordinates>\2,\1<"), "coordinates", ERROR),
    ("projected metres", swap(r"<coordinates>[^<]*<", "<coordinates>576966.6,5093317.1<"), "coordinates", ERROR),
    ("not a number", swap(r"<coordinates>[^<]*<", "<coordinates>nan,22.3<"), "coordinates", ERROR),
    ("zero island", swap(r"<coordinates>[^<]*<", "<coordinates>0,0<"), "coordinates", ERROR),
    ("no coordinates", swap(r"<coordinates>[^<]*<", "<coordinates><"), "coordinates", ERROR),
    ("garbled number", tag("executeHeight", "20 m"), "garbled", ERROR),
    ("no height", without("executeHeight"), "height", ERROR),
    ("infinite height", tag("executeHeight", "inf"), "height", ERROR),
    ("too high", tag("executeHeight", "1501"), "height", ERROR),
    ("too deep", tag("executeHeight", "-201"), "height", ERROR),
    ("above the law", tag("executeHeight", "121"), "height", WARNING),
    ("near the ground", tag("executeHeight", "1.5"), "height", WARNING),
    ("EGM96 in waylines", tag("executeHeightMode", "EGM96"), "height-mode", ERROR),
    ("too fast", tag("waypointSpeed", "15.1"), "speed", ERROR),
    ("standing still", tag("waypointSpeed", "-1"), "speed", ERROR),
    ("transitional speed", tag("globalTransitionalSpeed", "0"), "speed", ERROR),
    ("index gap", tag("index", "7"), "waypoint-index", ERROR),
    ("one waypoint", swap(r"</Placemark>.*</Placemark>", "</Placemark>"), "waypoint-count", WARNING),
    ("no waypoint", swap(r"<Placemark>.*</Placemark>", ""), "waypoint-count", ERROR),
    ("no wayline", swap(r"<Folder>.*</Folder>", ""), "waypoint-count", ERROR),
    ("leg of 6 km", swap(r"<coordinates>[^<]*<", "<coordinates>114.32,22.34<"), "spacing", ERROR),
    ("leg of 3 km", swap(r"<coordinates>[^<]*<", "<coordinates>114.293,22.337<"), "spacing", WARNING),
    ("heading mode", tag("waypointHeadingMode", "followWay"), "heading-mode", ERROR),
    ("heading range", tag("waypointHeadingAngle", "181"), "heading", ERROR),
    ("smooth, angle off", second_heads("smoothTransition"), "heading", WARNING),
    ("POI missing", second_heads("towardPOI"), "heading", ERROR),
    ("first one passed", tag("waypointTurnMode", "coordinateTurn"), "turn-mode", ERROR),
    ("turn mode", tag("waypointTurnMode", "stop"), "turn-mode", ERROR),
    ("damping missing", second_turns(0), "turn-damping", ERROR),
    ("damping too long", second_turns(90), "turn-damping", ERROR),
    ("corner cut", second_turns(2), "turn-mode", NOTE),
    ("damping ignored", tag("waypointTurnDampingDist", "0.2"), "turn-damping", NOTE),
    ("stale distance", tag("distance", "900"), "stale-distance", WARNING),
    ("beyond the battery", tag("duration", "9000"), "endurance", WARNING),
    ("group id twice", tag("actionGroupId", "1"), "action-group-id", ERROR),
    ("group unset", tag("actionGroupId", "65535"), "action-group", ERROR),
    ("group beyond the end", tag("actionGroupEndIndex", "99"), "action-group", ERROR),
    ("group backwards", tag("actionGroupEndIndex", "0"), "action-group", ERROR),
    ("group without index", without("actionGroupStartIndex"), "action-group", ERROR),
    ("group over two", tag("actionGroupEndIndex", "2"), "action-trigger", WARNING),
    ("trigger", tag("actionTriggerType", "onArrival"), "action-trigger", ERROR),
    ("timer without time", tag("actionTriggerType", "multipleTiming"), "action-trigger", ERROR),
    ("action id twice", tag("actionId", "1"), "action-id", ERROR),
    ("action id unset", tag("actionId", "65535"), "action-id", ERROR),
    ("action", tag("actionActuatorFunc", "dance"), "action-function", WARNING),
    ("camera position", swap(r"(gimbalRotateTime>0</wpml:gimbalRotateTime>\s*<wpml:payloadPositionIndex>)0", r"\g<1>1"),
     "payload-position", ERROR),
    ("lens as it is spelt", tag("payloadLensIndex", "visible"), "lens", ERROR),
    ("heading of an action", tag("aircraftHeading", "190"), "heading", ERROR),
    ("heading is no angle", tag("aircraftHeading", "north"), "heading", ERROR),
    ("no heading", without("aircraftHeading"), "heading", ERROR),
    ("pitch beyond the gimbal", tag("gimbalPitchRotateAngle", "36"), "gimbal-pitch", ERROR),
    ("pitch is no angle", tag("gimbalPitchRotateAngle", "nan"), "gimbal-pitch", ERROR),
    ("hover", tag("hoverTime", "0"), "hover", ERROR),
    ("zoom", tag("focalLength", "0"), "zoom", ERROR),
    ("slanted approach", tag("flyToWaylineMode", "pointToPoint"), "fly-to-wayline", WARNING),
    ("approach", tag("flyToWaylineMode", "fast"), "fly-to-wayline", ERROR),
    ("end through the building", tag("finishAction", "gotoFirstWaypoint"), "finish-action", WARNING),
    ("end", tag("finishAction", "rest"), "finish-action", ERROR),
    ("link loss", tag("exitOnRCLost", "panic"), "link-loss", ERROR),
    ("link loss action", swap("goContinue(.*?)goBack", r"executeLostAction\1dive"), "link-loss", ERROR),
    ("security height", tag("takeOffSecurityHeight", "1"), "security-height", ERROR),
    ("no security height", without("takeOffSecurityHeight"), "security-height", ERROR),
    ("no return height", without("globalRTHHeight"), "return-height", NOTE),
    ("no gimbal heading", without("waypointGimbalHeadingParam"), "gimbal-heading", NOTE),
    ("camera of another", tag("payloadEnumValue", "67"), "payload", ERROR),
    ("aircraft unknown", tag("droneEnumValue", "7"), "aircraft", WARNING),
    ("no aircraft", without("droneInfo"), "aircraft", ERROR),
    ("no camera", without("payloadInfo"), "aircraft", ERROR),
    ("other aircraft in the template", tag("droneSubEnumValue", "1"), "parts-disagree", ERROR),
    ("other place in the template", swap(r"<coordinates>[^<]*<", ELSEWHERE), "parts-disagree", ERROR),
    ("other heights in the template", tag("executeHeightMode", "WGS84"), "parts-disagree", WARNING),
]  # fmt: skip


@pytest.mark.few(12)
@pytest.mark.parametrize(("edit", "code", "severity"), [rule[1:] for rule in RULES], ids=[rule[0] for rule in RULES])
def test_rule_finds_what_breaks_it(
    texts: dict[str, str], edit: Callable[[str], str], code: str, severity: Severity
) -> None:
    assert found_in(texts) == set()
    assert (code, severity) in found_in({**texts, "waylines.wpml": edit(texts["waylines.wpml"])})


def test_short_leg_is_no_error_because_flighthub_flies_them(texts: dict[str, str]) -> None:
    copied = re.sub(
        r"(<coordinates>[^<]*</coordinates>)(.*?)<coordinates>[^<]*</coordinates>", r"\1\2\1", texts["waylines.wpml"],
        count=1, flags=re.DOTALL,
    )  # fmt: skip
    level = re.sub(
        r"(<wpml:executeHeight>)20(<.*?<wpml:executeHeight>)[^<]*<", r"\g<1>20\g<2>20.2<", copied, flags=re.DOTALL
    )
    assert ("spacing", WARNING) in found_in({**texts, "waylines.wpml": level})
    assert ("spacing", ERROR) not in found_in({**texts, "waylines.wpml": level})


def test_vertical_leg_that_follows_its_course_is_a_note(texts: dict[str, str]) -> None:
    follows = texts["waylines.wpml"].replace(">fixed<", ">followWayline<")
    assert "vertical-leg" not in {code for code, _ in found_in({**texts, "waylines.wpml": follows})}
    first = re.search(r"<coordinates>[^<]*</coordinates>", follows)
    assert first is not None
    upright = re.sub(r"<coordinates>[^<]*</coordinates>", first[0], follows)
    assert ("vertical-leg", NOTE) in found_in({**texts, "waylines.wpml": upright})


def test_missing_template_is_a_warning_because_some_programs_do_without(texts: dict[str, str]) -> None:
    assert found_in({"waylines.wpml": texts["waylines.wpml"]}) == {("no-template", WARNING)}


def test_take_off_reference_that_is_no_place_is_a_warning_and_not_used(texts: dict[str, str]) -> None:
    edited = {**texts, "template.kml": tag("takeOffRefPoint", "122.3,114.2,60")(texts["template.kml"])}
    assert found_in(edited) == {("takeoff-reference", WARNING)}


def test_repeated_action_ids_are_a_note_in_templates_only(texts: dict[str, str]) -> None:
    edited = {**texts, "template.kml": tag("actionId", "1")(texts["template.kml"])}
    assert found_in(edited) == {("action-id", NOTE)}


def test_group_ids_that_start_again_in_the_next_wayline_are_a_note(texts: dict[str, str]) -> None:
    folder = re.search(r"  <Folder>.*</Folder>\n", texts["waylines.wpml"], re.DOTALL)
    assert folder is not None
    twice = texts["waylines.wpml"].replace(folder[0], folder[0] * 2)
    assert found_in({**texts, "waylines.wpml": twice}) == {("action-group-id", NOTE)}


def test_many_waypoints_are_a_warning_for_dji_fly_only() -> None:
    mission = missions_from_plan(example_plan())[0]
    parts = parts_of_kmz(kmz_bytes(mission, DjiOptions(60.0, 0)))
    folder = parts.waylines.folders[0]
    many = replace(folder, waypoints=tuple(replace(folder.waypoints[0], index=i, groups=()) for i in range(100)))
    for drone, expected in (((68, 0), True), ((77, 0), False)):
        config = replace(parts.waylines.config, drone=drone)
        waylines = replace(parts.waylines, config=config, folders=(many,))
        codes = {(f.code, f.severity) for f in check_dji(DjiParts(waylines, None))}
        assert (("waypoint-count", WARNING) in codes) == expected


def test_findings_carry_the_measured_value_and_its_limit(texts: dict[str, str]) -> None:
    edited = tag("gimbalPitchRotateAngle", "36")(texts["waylines.wpml"])
    waylines = parse_wpml(edited.encode(), "waylines.wpml")
    (finding,) = [f for f in check_dji(DjiParts(waylines, None)) if f.code == "gimbal-pitch"]
    assert (finding.value, finding.limit, finding.unit) == (36.0, 35.0, "deg")
    assert "waypoint 1" in finding.place


def test_an_action_that_dji_does_not_document_says_what_becomes_of_it(texts: dict[str, str]) -> None:
    strange = {name: text.replace(">takePhoto<", ">sweepLaser<", 1) for name, text in texts.items()}
    parts = DjiParts(parse_wpml(strange["waylines.wpml"].encode(), "waylines.wpml"), None)
    found = next(each for each in check_dji(parts) if each.code == "action-function")
    assert "'sweepLaser' is no action that DJI documents: plans made of this mission go without it" in found.message
