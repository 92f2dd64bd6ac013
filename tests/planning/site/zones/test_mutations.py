"""Damaged files of every format: refused with an `InputError`, or read; where one zone is damaged it is never clear."""

import copy
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.site.zones.keep_out import near_zones, site_zones
from planning.site.zones.local import prisms
from planning.site.zones.reading import zones_of
from planning.site.zones.records import Restriction, ZoneFile
from tests.planning.site.zones.zone_files import (
    AIRSPACE,
    ORIGIN,
    aixm,
    aixm_ring,
    ed269,
    ed269_feature,
    ed269_volume,
    ed318,
    geojson,
    kml,
    lon_lat,
    openair,
    openair_ring,
    polygon,
    square,
    with_zones,
)

RING = square(0.0, 0.0, 80.0)
CIRCLE = {"type": "Circle", "center": lon_lat([(500.0, 0.0)])[0], "radius": 550.0}
TIMES = [
    {
        "permanent": "NO",
        "startDateTime": "2026-01-01T00:00:00Z",
        "schedule": [{"day": ["MON", "SUN"], "startTime": "06:00Z", "endTime": "20:00Z"}],
    }
]
FILES = {
    "ed269": ed269(ed269_feature(ed269_volume(polygon(RING)))),
    "ed269-circle": ed269(ed269_feature(ed269_volume(CIRCLE), applicability=TIMES)),
    "ed318": ed318(polygon(RING), limitedApplicability=[{k: v for k, v in TIMES[0].items() if k != "permanent"}]),
    "ed318-circle": ed318(
        {"type": "Point", "coordinates": CIRCLE["center"], "extent": {"subType": "Circle", "radius": 550.0}}
    ),
    "geojson": geojson(polygon(RING)),
    "kml": kml(RING),
    "aixm": aixm(aixm_ring(RING)),
    "openair": openair(*openair_ring(RING)),
    "openair-arc": openair(f"V X={openair_ring(RING)[0][3:]}", "DA 0.2,0,359", "DC 0.3", "AA NONE/2027-01-01T00:00Z"),
}


def violates_or_asks(content: bytes) -> bool:
    """Whether a flight above home, at the middle of the zone, is told anything but that all is clear."""
    try:
        zones_of(content, Path("zones.json"))
    except InputError:
        return True
    model = with_zones(content)
    return any(
        near.open_places or (near.is_kept and any(_holds_home(each) for each in near.local.volumes))
        for near in near_zones(model)
    )


def _holds_home(volume):
    return volume.area.covers(shapely.Point(0.0, -30.0)) and volume.floor_m < 10.0 < volume.ceiling_m


@pytest.mark.parametrize("name", FILES)
def test_the_files_themselves_are_in_the_way(name):
    zones = list(near_zones(with_zones(FILES[name])))
    assert zones
    assert all(near.is_kept and prisms(near.local, AIRSPACE) for near in zones)


@pytest.mark.long
@pytest.mark.parametrize("name", FILES)
@given(data=st.data())
def test_a_file_with_other_bytes_is_read_or_refused_and_no_longer_the_one_that_was_added(name, data):
    content = bytearray(FILES[name])
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        match data.draw(st.sampled_from(["change", "cut", "repeat", "end"])):
            case "change":
                content[at] = data.draw(st.integers(0, 255))
            case "cut":
                del content[at : at + data.draw(st.integers(1, 200))]
            case "repeat":
                content[at:at] = content[at : at + data.draw(st.integers(1, 60))]
            case _:
                del content[at:]
        if not content:
            break
    damaged = bytes(content)
    try:
        found = zones_of(damaged, Path("zones.json"))
    except InputError:
        pass
    else:
        assert found.zones
    list(near_zones(with_zones(damaged)))
    if damaged != FILES[name]:
        added = with_zones(FILES[name]).site.zones[0]
        assert site_zones(added, damaged).problem


JUNK = st.one_of(
    st.none(), st.booleans(), st.text(max_size=5), st.just([]), st.just({}), st.just([None]), st.just({"a": 1}),
    st.sampled_from([10**18, -1e30, "YES!", "x" * 100, [[[]]], [{}], "FL100"]),
)  # fmt: skip


def places(value, path=()):
    """Paths to all values within a JSON value, but for single numbers of a position and names of no effect."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in ("name", "message", "title", "country", "identifier", "reason", "zoneAuthority", "metadata"):
                yield (*path, key)
                yield from places(inner, (*path, key))
    elif isinstance(value, list) and not (value and isinstance(value[0], int | float)):
        for index, inner in enumerate(value):
            yield (*path, index)
            yield from places(inner, (*path, index))


@pytest.mark.parametrize("name", ["ed269", "ed269-circle", "ed318", "ed318-circle", "geojson"])
@given(data=st.data())
def test_no_value_of_json_can_be_lost_or_spoilt_so_that_a_zone_is_clear(name, data):
    content = json.loads(FILES[name])
    path = data.draw(st.sampled_from(list(places(content))))
    whole = copy.deepcopy(content)
    parent = whole
    for step in path[:-1]:
        parent = parent[step]
    if data.draw(st.booleans()) and not (isinstance(parent, list) and "coordinates" in path):
        del parent[path[-1]]
    else:
        parent[path[-1]] = data.draw(JUNK)
    assert violates_or_asks(json.dumps(whole).encode()), (path, whole)


@pytest.mark.parametrize("name", ["openair", "openair-arc"])
@given(data=st.data())
def test_no_line_of_openair_can_be_lost_or_spoilt_so_that_a_zone_is_clear(name, data):
    lines = FILES[name].decode().splitlines()
    at = data.draw(st.integers(0, len(lines) - 1))
    is_place = lines[at].startswith(("DP", "DC", "DA", "V"))
    junk = data.draw(st.text("ABCDEFGHIKLMNOPQRSTUVWXYZ0123456789:., ", min_size=1, max_size=12))
    lines[at] = f"{lines[at][:2]} {junk}" if is_place or data.draw(st.booleans()) else junk
    assert violates_or_asks("\n".join(lines).encode()), lines


@pytest.mark.parametrize("name", ["kml", "aixm"])
@given(data=st.data())
def test_no_element_of_xml_can_be_lost_or_spoilt_so_that_a_zone_is_clear(name, data):
    root = ElementTree.fromstring(FILES[name])
    inside = [(parent, child) for parent in root.iter() for child in parent]
    parent, child = data.draw(st.sampled_from(inside))
    if data.draw(st.booleans()):
        parent.remove(child)
    elif data.draw(st.booleans()):
        child.tag = child.tag + data.draw(st.sampled_from(["X", "_", "2"]))
    elif "coordinates" not in child.tag and "posList" not in child.tag:
        child.text = data.draw(st.sampled_from(["", "?", "NIL", "1e999", "-", "x" * 99]))
    else:
        words = child.text.split()
        words[data.draw(st.integers(0, len(words) - 1))] = data.draw(st.sampled_from(["?", "nan", "1e999", "999", ""]))
        child.text = " ".join(words)
    assert violates_or_asks(ElementTree.tostring(root)), ElementTree.tostring(root)


def test_a_restriction_is_lost_by_the_word_that_says_so_alone():
    feature = ed269_feature(ed269_volume(polygon(RING)), restriction="NO_RESTRICTION")
    (near,) = near_zones(with_zones(ed269(feature)))
    assert near.local.zone.restriction is Restriction.NONE
    assert not near.is_kept
    assert ZoneFile("a", "b", "2026-11-28").permitted == {}
    assert ORIGIN.lat_deg == 47.0
