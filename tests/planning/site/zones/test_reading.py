"""Files of geo-zones: what is read of each format, what becomes a question, what is refused."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from planning.base.errors import InputError
from planning.site.zones.arcs import sagitta_m
from planning.site.zones.reading import zones_of
from planning.site.zones.records import Circle, Clock, Daylight, HeightAbove, Outline, Period, Restriction
from tests.planning.site.zones.zone_files import (
    aixm,
    aixm_ring,
    ed269,
    ed269_feature,
    ed269_volume,
    ed318,
    geojson,
    kml,
    openair,
    openair_ring,
    polygon,
    square,
)

RING = square(0.0, 0.0, 50.0)
FILE = Path("zones.json")


def only(content):
    """The only zone of a file."""
    (zone,) = zones_of(content, FILE).zones
    return zone


def test_ed269_says_who_what_why_where_and_when():
    schedule = [{"day": ["SAT", "SUN"], "startTime": "17:00:00.00Z", "endTime": "23:59+01:00"}]
    times = [{"permanent": "NO", "startDateTime": "2026-06-15T09:00:00.00Z", "schedule": schedule}]
    circle = {"type": "Circle", "center": [8.0, 47.0], "radius": 3000}
    parts = ed269_volume(polygon(RING, square(0.0, 0.0, 5.0))), ed269_volume(circle, 100, 1000, "AMSL")
    zone = only(ed269(ed269_feature(*parts, applicability=times, restriction="REQ_AUTHORISATION", otherReasonInfo="x")))
    assert (zone.id, zone.name, zone.country, zone.restriction) == ("Z1", "School", "CHE", Restriction.AUTHORISATION)
    assert zone.reasons == ("SENSITIVE", "x")
    assert zone.authorities[0].name == "Town"
    assert "town@example.org" in zone.authorities[0].contact
    low, high = zone.volumes
    assert isinstance(low.area, Outline)
    assert len(low.area.holes) == 1
    assert low.upper.value_m == 120.0
    assert low.upper.above is HeightAbove.GROUND
    assert high.area == Circle((8.0, 47.0), 3000.0)
    assert (high.lower.value_m, high.lower.above) == (100.0, HeightAbove.SEA_LEVEL)
    (period,) = zone.periods
    assert period.start == datetime(2026, 6, 15, 9, tzinfo=UTC)
    assert period.end is None
    assert period.schedule[0].days == {5, 6}
    assert period.schedule[0].end == Clock(timedelta(hours=23, minutes=59), timedelta(hours=1))
    assert not zone.questions
    assert not zone.place_questions


def test_ed269_lists_its_zones_under_either_name_and_may_quote_its_numbers():
    circle = {"type": "Circle", "center": [8.0, 47.0], "radius": "3000"}
    quoted = ed269_feature(ed269_volume(circle, "10", "120.5"))
    told = json.dumps({"formatVersion": "1.0.0", "createdAt": "2022-11-30T14:50:33Z", "UASZoneList": [quoted]})
    zone = only(told.encode())
    assert zone == only(ed269(ed269_feature(ed269_volume({**circle, "radius": 3000}, 10, 120.5))))
    assert zone.volumes[0].upper.value_m == 120.5
    assert not zone.questions
    assert not zone.place_questions


def test_ed318_has_layers_circles_languages_events_and_a_date():
    circle = {"type": "Point", "coordinates": [8.0, 47.0], "extent": {"subType": "Circle", "radius": 3500}}
    layer = {"upper": 500, "upperReference": "WGS84", "lower": 100, "lowerReference": "AMSL", "uom": "ft"}
    times = [{"schedule": [{"day": ["ANY"], "startEvent": "EECT", "endEvent": "BMCT"}]}]
    content = ed318(circle, layer, limitedApplicability=times, type="REQ_AUTHORIZATION")
    found = zones_of(content, FILE)
    assert found.format == "ED-318"
    assert found.publisher == "Authority"
    assert found.issued == datetime(2026, 11, 20, tzinfo=UTC)
    (zone,) = found.zones
    assert zone.name == "School"
    assert zone.restriction is Restriction.AUTHORISATION
    (volume,) = zone.volumes
    assert volume.area == Circle((8.0, 47.0), 3500.0)
    assert volume.upper.value_m == pytest.approx(152.4)
    assert volume.upper.above is HeightAbove.ELLIPSOID
    assert volume.lower.value_m == pytest.approx(30.48)
    assert zone.periods[0].schedule[0].start is Daylight.EVENING_TWILIGHT
    assert not zone.questions


def test_a_collection_of_ed318_has_a_volume_for_each_part_and_its_own_layer_where_they_have_none():
    parts = [polygon(RING), {"type": "MultiPolygon", "coordinates": [[RING], [square(300.0, 0.0, 10.0)]]}]
    layer = {"upper": 60, "upperReference": "AGL", "lower": 10, "lowerReference": "AGL"}
    zone = only(ed318({"type": "GeometryCollection", "geometries": parts}, layer))
    assert [(volume.lower.value_m, volume.upper.value_m) for volume in zone.volumes] == [(10.0, 60.0)] * 3


@pytest.mark.parametrize("content", [geojson(polygon(RING)), kml(RING)])
def test_files_that_say_only_where_count_as_unknown_and_ask(content):
    zone = only(content)
    assert zone.name == "School"
    assert zone.restriction is Restriction.UNKNOWN
    assert zone.questions
    (volume,) = zone.volumes
    assert volume.area.ring == tuple((lon, lat) for lon, lat in RING)


def test_openair_has_outlines_circles_arcs_heights_and_classes():
    content = openair(*openair_ring(RING), upper="FL65", lower="1000ft AMSL", kind="CTR")
    zone = only(content)
    assert zone.restriction is Restriction.AUTHORISATION
    assert zone.volumes[0].upper.above is HeightAbove.FLIGHT_LEVEL
    assert zone.volumes[0].upper.value_m == pytest.approx(6500 * 0.3048)
    assert zone.volumes[0].lower.value_m == pytest.approx(304.8)
    circle = only(openair("V X=47:00:00N 008:00:00E", "DC 2", kind="Q"))
    assert circle.volumes[0].area == Circle((8.0, 47.0), 3704.0)
    assert circle.restriction is Restriction.CONDITIONAL
    assert circle.questions
    arc = only(openair("V X=47:00.000N 008:00.000E", "DA 2, 270, 90", "DP 47:00:00N 008:00:00E"))
    outline = arc.volumes[0].area
    assert max(lat for _, lat in outline.ring) == pytest.approx(47.0 + 3704.0 / 111_180.0, abs=1e-4)
    assert outline.tolerance_m == pytest.approx(sagitta_m(3704.0, 180.0 / (len(outline.ring) - 2)))
    backwards = only(openair("V D=-", "V X=47:00.000N 008:00.000E", "DA 2, 270, 90"))
    assert min(lat for _, lat in backwards.volumes[0].area.ring) == pytest.approx(47.0 - 3704.0 / 111_180.0, abs=1e-4)


def test_aixm_has_latitude_first_types_limits_validity_circles_and_arcs():
    when = (
        "<gml:validTime><gml:TimePeriod><gml:beginPosition>2026-01-01T00:00:00Z</gml:beginPosition>"
        '<gml:endPosition indeterminatePosition="unknown"/></gml:TimePeriod></gml:validTime>'
    )
    upper = '<aixm:upperLimit uom="FL">65</aixm:upperLimit><aixm:upperLimitReference>STD</aixm:upperLimitReference>'
    zone = only(aixm(aixm_ring(RING), kind="CTR", upper=upper, more=when))
    assert (zone.id, zone.name, zone.restriction) == ("ZZ1", "School", Restriction.AUTHORISATION)
    assert zone.volumes[0].area.ring == tuple((lon, lat) for lon, lat in RING)
    assert zone.volumes[0].upper.above is HeightAbove.FLIGHT_LEVEL
    assert zone.periods == (Period(datetime(2026, 1, 1, tzinfo=UTC)),)
    assert not zone.questions
    assert not zone.place_questions
    middle = "<gml:pointProperty><gml:Point><gml:pos>47.0 8.0</gml:pos></gml:Point></gml:pointProperty>"
    radius = '<gml:radius uom="[nmi_i]">2</gml:radius>'
    circle = f'<gml:CircleByCenterPoint numArc="1">{middle}{radius}</gml:CircleByCenterPoint>'
    danger = only(aixm(circle, kind="D"))
    assert danger.volumes[0].area == Circle((8.0, 47.0), 3704.0)
    assert danger.restriction is Restriction.CONDITIONAL
    arc = (
        f'<gml:ArcByCenterPoint numArc="1">{middle}<gml:radius uom="KM">2</gml:radius><gml:startAngle uom="deg">0'
        '</gml:startAngle><gml:endAngle uom="deg">90</gml:endAngle></gml:ArcByCenterPoint>'
    )
    outline = only(aixm(arc + aixm_ring([[8.0, 47.0]]))).volumes[0].area
    assert outline.tolerance_m > 0.0
    assert min(lon for lon, _ in outline.ring) == pytest.approx(8.0, abs=1e-9)
    assert min(lat for _, lat in outline.ring) == pytest.approx(47.0, abs=1e-5)
    lon_first = aixm(aixm_ring([[lat, lon] for lon, lat in RING])).replace(
        b"urn:ogc:def:crs:EPSG::4326", b"urn:ogc:def:crs:OGC:1.3:CRS84"
    )
    assert only(lon_first).volumes[0].area == zone.volumes[0].area


def test_an_airspace_of_aixm_made_of_another_one_has_its_shape_or_asks():
    member = aixm(aixm_ring(RING)).decode()
    start, end = member.index("<m:hasMember>"), member.index("</m:AIXMBasicMessage>")
    first = member[start:end].replace("<aixm:timeSlice>", "<gml:identifier>x-1</gml:identifier><aixm:timeSlice>", 1)
    shape = first[first.index("<aixm:horizontalProjection>") : first.index("</aixm:AirspaceVolume>")]

    def part(kind, name):
        named = f'<aixm:dependency>{kind}</aixm:dependency><aixm:theAirspace xlink:href="urn:uuid:{name}"/>'
        dependency = f"<aixm:AirspaceVolumeDependency>{named}</aixm:AirspaceVolumeDependency>"
        return f"<aixm:contributorAirspace>{dependency}</aixm:contributorAirspace>"

    def second(*made_of):
        other = first.replace("<gml:identifier>x-1", "<gml:identifier>x-2").replace("ZZ1", "ZZ2")
        return other.replace("400", "900").replace(shape, part(*made_of))

    def zones(other):
        return zones_of(f"{member[:start]}{first}{other}{member[end:]}".encode(), FILE).zones

    one, whole = zones(second("FULL_GEOMETRY", "x-1"))
    assert whole.volumes == one.volumes
    _, flat = zones(second("HORZ_PROJECTION", "x-1"))
    assert flat.volumes[0].area == one.volumes[0].area
    assert flat.volumes[0].upper.written == "900 ft SFC"
    for lost in ("x-9", "x-2"):
        assert zones(second("FULL_GEOMETRY", lost))[1].place_questions


def test_old_openair_files_in_other_encodings_and_ends_of_lines_are_read():
    content = openair(*openair_ring(RING)).replace(b"School", b"Schule M\xfcnchen").replace(b"\n", b"\r")
    assert only(content).name == "Schule München"
    assert only(b"\xef\xbb\xbf" + openair(*openair_ring(RING))).name == "School"


def changed(feature, **changes):
    return json.dumps({"features": [{**feature, **changes}]}).encode()


FEATURE = ed269_feature(ed269_volume(polygon(RING)))


@pytest.mark.parametrize(
    "content",
    [
        changed(FEATURE, restriction="MAYBE"),
        changed(FEATURE, restriction=None),
        changed(FEATURE, applicability=[]),
        changed(FEATURE, applicability=[{"permanent": "NO"}]),
        changed(FEATURE, applicability=[{"permanent": "NO", "startDateTime": "soon"}]),
        changed(FEATURE, applicability=[{"permanent": "NO", "startDateTime": "2026-01-01T00:00:00"}]),
        changed(FEATURE, applicability=[{"permanent": "NO", "startDateTime": "2026-01-01T00:00Z", "until": "dusk"}]),
        changed(FEATURE, geometry=[{**FEATURE["geometry"][0], "uomDimensions": "FATHOM"}]),
        changed(FEATURE, geometry=[{**FEATURE["geometry"][0], "upperVerticalReference": "QFE"}]),
        changed(FEATURE, geometry=[{**FEATURE["geometry"][0], "shape": "cone"}]),
        changed(FEATURE, geometry=[ed269_volume({"type": "Circle", "center": [8.0, 47.0]})]),
        changed(FEATURE, geometry=[ed269_volume({"type": "Ellipse"})]),
        changed(FEATURE, geometry=[ed269_volume(polygon([*RING[:2], [8.0, 95.0], *RING[2:]]))]),
        changed(FEATURE, geometry="everywhere"),
        changed(FEATURE, geometry=[{**FEATURE["geometry"][0], "upperLimit": "120 or so"}]),
        changed(FEATURE, geometry=[{**FEATURE["geometry"][0], "upperLimit": "1e999"}]),
        ed318(polygon(RING), {"upper": 120, "upperReference": "FL", "lower": 0, "lowerReference": "AGL"}),
        ed318(polygon(RING), limitedApplicability=[{"schedule": [{"day": ["XMAS"], "startTime": "10:00Z"}]}]),
        ed318({"type": "Point", "coordinates": [8.0, 47.0]}),
        ed318({"type": "Sphere"}),
        openair(*openair_ring(RING), kind="G"),
        openair(*openair_ring(RING), upper="high"),
        openair(*openair_ring(RING), "AA NONE"),
        openair(*openair_ring(RING), "DY 47:00:00N 008:00:00E"),
        openair("DC 5"),
        aixm(aixm_ring(RING), more="<aixm:activation/>"),
        aixm(aixm_ring(RING), kind="G-SOMETHING"),
        aixm(aixm_ring(RING)).replace(b"<gml:curveMember>", b'<gml:curveMember xlink:href="#other"/><gml:curveMember>'),
        aixm(aixm_ring(RING)).replace(b"EPSG::4326", b"EPSG::3857"),
        aixm("<gml:ArcString/>"),
        aixm(aixm_ring(RING)).replace(b"BASELINE", b"TEMPDELTA"),
    ],
)
def test_what_a_file_leaves_open_is_a_question(content):
    zone = only(content)
    assert zone.questions or zone.place_questions or zone.width_questions


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (changed(FEATURE, restriction=None), "does not say what it restricts (field 'restriction'), so it counts as"),
        (changed(FEATURE, restriction="MAYBE"), "not known here, 'MAYBE', so it counts as prohibited"),
        (changed(FEATURE, applicability=[{}]), "the field 'permanent' is missing or empty"),
        (changed(FEATURE, geometry=[{**FEATURE["geometry"][0], "uomDimensions": ""}]), "height '0 AGL' does not say"),
        (openair(*openair_ring(RING), upper="high"), "the height 'high' cannot be read, so every height counts"),
        (aixm(aixm_ring(RING), upper=" "), "gives no upper limit, so it counts at any height"),
    ],
)
def test_questions_say_what_is_missing_and_what_follows(content, words):
    zone = only(content)
    assert any(words in question for question in zone.questions), zone.questions
    assert not any("None" in question or "''" in question for question in zone.questions)


def test_a_lost_type_of_openair_leaves_a_zone_that_asks():
    first, _ = zones_of(openair(*openair_ring(RING)).replace(b"AC P\n", b"") + openair(*openair_ring(RING)), FILE).zones
    assert first.restriction is Restriction.UNKNOWN
    assert first.volumes
    assert first.place_questions


def test_zones_of_one_name_have_identifiers_of_their_own():
    found = zones_of(ed269(FEATURE, FEATURE, {**FEATURE, "identifier": "Z1 (2)"}, FEATURE), FILE)
    assert len({zone.id for zone in found.zones}) == 4
    assert found.zones[0].id == "Z1"
    assert found.zones[2].id == "Z1 (2)"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "an empty file"),
        (b"\xef\xbb\xbf \n", "an empty file"),
        (b'{"UASZoneList": []}', "found something else"),
        (b"{}", "found something else"),
        (b'{"features": []}', "found something else"),
        (b'{"type": "FeatureCollection", "features": []}', "no zone"),
        (b'{"features": [{"restriction": "PROHIBITED", "x": NaN}]}', "finite"),
        (b'{"features": ' + b"[" * 200 + b"]" * 200 + b"}", "nested"),
        (b"PK\x03\x04", "unpack"),
        (aixm(aixm_ring(RING))[:-90], "XML"),
        (b'<?xml version="1.0"?><a xmlns="http://www.aixm.aero/schema/5.1"/>', "no zone"),
        (b"<kml><Placemark>", "XML"),
        (b'<!DOCTYPE kml [<!ENTITY a "b">]><kml><Document/></kml>', "document type"),
        (ed269(FEATURE)[:-40], "JSON"),
        (ed269(FEATURE).decode().encode("utf-16"), "found something else"),
        (ed269(ed269_feature(name="\u00e9")).replace(b"\\u00e9", b"\xe9"), "UTF-8"),
    ],
)
def test_files_that_cannot_be_read_whole_are_refused(content, words):
    with pytest.raises(InputError, match=words):
        zones_of(content, FILE)


def test_places_that_are_none_say_whether_latitude_and_longitude_are_exchanged():
    east = [[lat, lon + 106.0] for lon, lat in RING]
    assert "exchanged" in only(geojson(polygon(east))).place_questions[0]
    assert "does not say whether" in only(openair(*openair_ring(RING), upper="2500ft")).questions[0]


def with_crs(place, system):
    """A small square, whose numbers are places on earth whatever the system; `place` says what names it."""
    geometry = {"type": "Polygon", "coordinates": [[[10, 10], [50, 10], [50, 60], [10, 10]]]}
    feature = {"type": "Feature", "properties": {"name": "field"}, "geometry": geometry}
    content = {"type": "FeatureCollection", "features": [feature]}
    {"file": content, "feature": feature, "geometry": geometry}[place]["crs"] = system
    return json.dumps(content).encode()


def named(name):
    return {"type": "name", "properties": {"name": name}}


@pytest.mark.parametrize("place", ["file", "feature", "geometry"])
@pytest.mark.parametrize("system", [named("urn:ogc:def:crs:EPSG::32650"), named(""), named(4326), "EPSG:4326", {}])
def test_areas_in_metres_are_not_taken_for_degrees(place, system):
    """They would lie elsewhere, and count as clear."""
    with pytest.raises(InputError, match=r"export it in WGS 84"):
        zones_of(with_crs(place, system), Path("field.geojson"))


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326", "urn:ogc:def:crs:EPSG::4326"])
def test_wgs_84_may_be_named(name):
    (zone,) = zones_of(with_crs("file", named(name)), Path("field.geojson")).zones
    assert not zone.place_questions
