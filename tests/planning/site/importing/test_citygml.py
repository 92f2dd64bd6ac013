"""CityGML: houses written here in every dialect, hostile files, and the eight real buildings."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.base.progress import QUIET
from planning.geo.crs import crs_conversion
from planning.geo.enu import enu_from_geodetic
from planning.geo.solids import Solids
from planning.site.importing.citygml_file import read_citygml
from planning.site.importing.importer import ImportedSite, import_site
from planning.site.importing.options import ImportOptions
from planning.site.importing.polygons import quad_areas, unit_normals
from planning.site.records import panel_corners
from tests.planning.facade_shapes import SHAPES, facades
from tests.planning.facade_shapes import normal as normal_of

Ring = list[tuple[float, float, float]]

EAST, NORTH, UP = 678_052.0, 5_403_685.0, 415.0
"""A corner of a house in Ingolstadt, EPSG:25832."""

BUILDING = {
    "1.0": "http://www.opengis.net/citygml/building/1.0",
    "2.0": "http://www.opengis.net/citygml/building/2.0",
    "3.0": "http://www.opengis.net/citygml/building/3.0",
}


def rectangle(low: tuple[float, float, float], high: tuple[float, float, float]) -> Ring:
    """Rectangle in a vertical or horizontal plane between opposite corners."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    if z0 == z1:
        return [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)]
    return [(x0, y0, z0), (x1, y1, z0), (x1, y1, z1), (x0, y0, z1)]


HOUSE = [
    rectangle((0.0, 0.0, 0.0), (10.0, 0.0, 6.0)),
    rectangle((10.0, 0.0, 0.0), (10.0, 8.0, 6.0)),
    rectangle((10.0, 8.0, 0.0), (0.0, 8.0, 6.0)),
    rectangle((0.0, 8.0, 0.0), (0.0, 0.0, 6.0)),
    rectangle((0.0, 0.0, 6.0), (10.0, 8.0, 6.0)),
    rectangle((0.0, 8.0, 0.0), (10.0, 0.0, 0.0)),
]

SOUTH = rectangle((2.0, 0.0, 1.0), (4.0, 0.0, 2.5))


class Dialect:
    """How a file writes things down."""

    def __init__(self, version: str = "2.0", form: str = "posList", swaps: bool = False) -> None:
        self.version, self.form, self.swaps = version, form, swaps

    def ring(self, ring: Ring) -> str:
        points = [(EAST + x, NORTH + y, UP + z) for x, y, z in [*ring, ring[0]]]
        points = [(y, x, z) if self.swaps else (x, y, z) for x, y, z in points]
        texts = [f"{a:.3f} {b:.3f} {c:.3f}" for a, b, c in points]
        if self.form == "pos":
            inner = "".join(f"<gml:pos>{text}</gml:pos>" for text in texts)
        elif self.form == "coordinates":
            inner = f"<gml:coordinates>{' '.join(text.replace(' ', ',') for text in texts)}</gml:coordinates>"
        else:
            inner = f"<gml:posList srsDimension='3'>\n{chr(10).join(texts)}\n</gml:posList>"
        return f"<gml:LinearRing>{inner}</gml:LinearRing>"

    def polygon(self, ring: Ring, *holes: Ring) -> str:
        inner = "".join(f"<gml:interior>{self.ring(hole)}</gml:interior>" for hole in holes)
        return f"<gml:Polygon><gml:exterior>{self.ring(ring)}</gml:exterior>{inner}</gml:Polygon>"

    def geometry(self, lod: int, *polygons: str) -> str:
        members = "".join(f"<gml:surfaceMember>{polygon}</gml:surfaceMember>" for polygon in polygons)
        name = f"b:lod{lod}MultiSurface"
        return f"<{name}><gml:MultiSurface>{members}</gml:MultiSurface></{name}>"

    def window(self, window_id: str, *rings: Ring, lod: int = 3) -> str:
        kind, role = ("WindowSurface", "fillingSurface") if self.version == "3.0" else ("Window", "opening")
        geometry = self.geometry(lod, *(self.polygon(ring) for ring in rings))
        return f"<b:{role}><b:{kind} gml:id='{window_id}'>{geometry}</b:{kind}></b:{role}>"

    def surface(self, kind: str, lod: int, *polygons: str, openings: str = "") -> str:
        role = "boundary" if self.version == "3.0" else "boundedBy"
        return f"<b:{role}><b:{kind}>{self.geometry(lod, *polygons)}{openings}</b:{kind}></b:{role}>"

    def house(self, *windows: str, building_id: str = "house", extra: str = "", at: float = 0.0) -> str:
        rings = [[(x + at, y, z) for x, y, z in ring] for ring in HOUSE]
        walls = "".join(self.surface("WallSurface", 3, self.polygon(ring)) for ring in rings[1:])
        south = self.surface("WallSurface", 3, self.polygon(rings[0]), openings="".join(windows))
        return f"<b:Building gml:id='{building_id}'>{south}{walls}{extra}</b:Building>"

    def model(self, *buildings: str, srs: str | None = "EPSG:25832") -> str:
        srs_name = "" if srs is None else f' srsName="{srs}" srsDimension="3"'
        members = "".join(f"<c:cityObjectMember>{building}</c:cityObjectMember>" for building in buildings)
        return (
            f'<?xml version="1.0"?><c:CityModel xmlns:c="http://www.opengis.net/citygml/{self.version}" '
            f'xmlns:b="{BUILDING[self.version]}" xmlns:gml="http://www.opengis.net/gml">'
            f"<gml:boundedBy><gml:Envelope{srs_name}/></gml:boundedBy>{members}</c:CityModel>"
        )


PLAIN = Dialect()


def imported(text: str, folder: Path, options: ImportOptions | None = None) -> ImportedSite:
    path = folder / "house.gml"
    path.write_text(text)
    return import_site(path, options or ImportOptions())


def expected_enu(site: ImportedSite, ring: Ring) -> np.ndarray:
    """Points of the file in the site's frame, converted apart from the importer."""
    points = np.array(ring) + np.array([EAST, NORTH, UP])
    conversion = crs_conversion("EPSG:25832", points)
    return enu_from_geodetic(site.model.site.origin, *conversion.geodetic(points))


@pytest.mark.few(4)
@pytest.mark.parametrize("form", ["posList", "pos", "coordinates"])
@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_versions_and_ways_to_write_points_give_the_same_panel(tmp_path: Path, version: str, form: str) -> None:
    dialect = Dialect(version, form)
    site = imported(dialect.model(dialect.house(dialect.window("w1", SOUTH))), tmp_path)
    (panel,) = site.model.site.panels
    assert panel.source_id == "w1"
    np.testing.assert_allclose(panel.corners_enu_m, expected_enu(site, SOUTH), atol=2e-4)
    assert len(site.model.building.triangles) == 2 * 7


def test_the_origin_is_on_the_ground_below_the_middle_of_the_house(tmp_path: Path) -> None:
    site = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))), tmp_path)
    np.testing.assert_allclose(expected_enu(site, [(5.0, 4.0, 0.0)]), [[0.0, 0.0, 0.0]], atol=1e-3)
    assert site.model.site.airspace.ground_z_m == 0.0
    assert site.model.site.name == "house"


@pytest.mark.parametrize("turn", [1, -1])
def test_normals_look_out_whichever_way_the_rings_turn(tmp_path: Path, turn: int) -> None:
    rings = {
        "south": SOUTH,
        "east": rectangle((10.0, 2.0, 1.0), (10.0, 4.0, 2.5)),
        "north": rectangle((4.0, 8.0, 1.0), (2.0, 8.0, 2.5)),
        "west": rectangle((0.0, 4.0, 1.0), (0.0, 2.0, 2.5)),
        "top": rectangle((2.0, 2.0, 6.0), (4.0, 4.0, 6.0)),
    }
    windows = [PLAIN.window(name, ring[::turn]) for name, ring in rings.items()]
    site = imported(PLAIN.model(PLAIN.house(*windows)), tmp_path)
    assert len(site.model.site.facades) == 5
    outwards = {"south": (0, -1, 0), "east": (1, 0, 0), "north": (0, 1, 0), "west": (-1, 0, 0), "top": (0, 0, 1)}
    for panel, normal in zip(site.model.site.panels, unit_normals(panel_corners(site.model.site)), strict=True):
        assert panel.source_id is not None
        # Grid north is 1.8 degrees from true north here.
        assert normal @ np.array(outwards[panel.source_id]) > np.cos(np.radians(2.0))


def test_a_window_in_a_reveal_lies_behind_the_wall_and_is_seen_through_the_hole(tmp_path: Path) -> None:
    recessed = [(x, y + 0.3, z) for x, y, z in SOUTH]
    reveal = []
    for (x0, _, z0), (x1, _, z1) in zip(SOUTH, [*SOUTH[1:], SOUTH[0]], strict=True):
        reveal.append(PLAIN.polygon([(x0, 0.0, z0), (x1, 0.0, z1), (x1, 0.3, z1), (x0, 0.3, z0)]))
    wall = PLAIN.surface(
        "WallSurface", 3, PLAIN.polygon(HOUSE[0], SOUTH), *reveal, openings=PLAIN.window("w", recessed)
    )
    rest = "".join(PLAIN.surface("WallSurface", 3, PLAIN.polygon(ring)) for ring in HOUSE[1:])
    site = imported(PLAIN.model(f"<b:Building gml:id='h'>{wall}{rest}</b:Building>"), tmp_path)
    np.testing.assert_allclose(site.model.site.panels[0].corners_enu_m, expected_enu(site, recessed), atol=2e-4)
    hidden = float(re.findall(r"reveals hide (\d+) %", " ".join(site.notes))[0])
    assert 5.0 < hidden < 40.0  # 0.15 m inside a niche of 2 x 1.5 m


def test_windows_of_several_polygons_and_odd_shapes_become_one_panel_each(tmp_path: Path) -> None:
    left = rectangle((2.0, 0.0, 1.0), (3.0, 0.0, 2.5))
    right = rectangle((3.0, 0.0, 1.0), (4.0, 0.0, 2.5))
    gable = [(6.0, 0.0, 3.0), (8.0, 0.0, 3.0), (8.0, 0.0, 4.0), (7.0, 0.0, 5.0), (6.0, 0.0, 4.0)]
    house = PLAIN.house(PLAIN.window("two", left, right), PLAIN.window("gable", gable))
    site = imported(PLAIN.model(house), tmp_path)
    areas = dict(
        zip([p.source_id for p in site.model.site.panels], quad_areas(panel_corners(site.model.site)), strict=True)
    )
    assert areas["two"] == pytest.approx(3.0, rel=1e-3)
    assert areas["gable"] == pytest.approx(3.0, rel=1e-3)
    assert any("stands in: 1 (gable)" in note for note in site.notes)


def test_the_same_window_twice_stays_twice_and_is_named(tmp_path: Path) -> None:
    house = PLAIN.house(PLAIN.window("w1", SOUTH), PLAIN.window("w2", SOUTH))
    site = imported(PLAIN.model(house), tmp_path)
    assert site.model.site.n_panels == 2
    assert any("w1 = w2" in note for note in site.notes)


def test_a_house_with_holes_for_its_windows_is_solid_even_when_a_window_is_there_twice(tmp_path: Path) -> None:
    windows = PLAIN.window("w1", SOUTH) + PLAIN.window("w2", SOUTH)
    wall = PLAIN.surface("WallSurface", 3, PLAIN.polygon(HOUSE[0], SOUTH), openings=windows)
    rest = "".join(PLAIN.surface("WallSurface", 3, PLAIN.polygon(ring)) for ring in HOUSE[1:])
    site = imported(PLAIN.model(f"<b:Building gml:id='h'>{wall}{rest}</b:Building>"), tmp_path)
    solids = Solids.of(site.model.building.corners_enu_m)
    assert solids.clearance_m(np.array([[0.0, 0.0, 3.0]]))[0] < -2.9
    assert not any("does not close" in note for note in site.notes)


def test_an_open_skin_is_named(tmp_path: Path) -> None:
    walls = "".join(PLAIN.surface("WallSurface", 3, PLAIN.polygon(ring)) for ring in HOUSE[1:4])
    south = PLAIN.surface("WallSurface", 3, PLAIN.polygon(HOUSE[0]), openings=PLAIN.window("w", SOUTH))
    site = imported(PLAIN.model(f"<b:Building gml:id='h'>{south}{walls}</b:Building>"), tmp_path)
    assert any("100 % of the building's surface does not close" in note for note in site.notes)


def test_only_the_finest_outside_surfaces_are_read(tmp_path: Path) -> None:
    coarse = PLAIN.surface("WallSurface", 2, PLAIN.polygon(HOUSE[0]))
    closure = PLAIN.surface("ClosureSurface", 3, PLAIN.polygon(HOUSE[1]))
    ceiling = PLAIN.surface("CeilingSurface", 3, PLAIN.polygon(HOUSE[4]))
    room = f"<b:interiorRoom><b:Room>{ceiling}</b:Room></b:interiorRoom>"
    plain = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))), tmp_path)
    more = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH), extra=coarse + closure + room)), tmp_path)
    assert len(more.model.building.triangles) == len(plain.model.building.triangles)


def test_windows_given_as_prototypes_are_counted(tmp_path: Path) -> None:
    implicit = "<b:lod3ImplicitRepresentation><c:ImplicitGeometry/></b:lod3ImplicitRepresentation>"
    window = f"<b:opening><b:Window gml:id='p'>{implicit}</b:Window></b:opening>"
    site = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH), window)), tmp_path)
    assert any("windows given as a shared prototype (implicit geometry), not read: 1" in note for note in site.notes)


def test_parts_belong_to_their_building_and_may_name_it(tmp_path: Path) -> None:
    part = f"<b:consistsOfBuildingPart>{PLAIN.house(PLAIN.window('w', SOUTH)).replace('b:Building', 'b:BuildingPart')}"
    part = part.replace("gml:id='house'", "gml:id='part'") + "</b:consistsOfBuildingPart>"
    text = PLAIN.model(f"<b:Building gml:id='whole'>{part}</b:Building>")
    site = imported(text, tmp_path, ImportOptions(building="part"))
    assert site.model.site.name == "whole"
    assert site.model.site.n_panels == 1


@pytest.mark.few(3)
@pytest.mark.parametrize(
    "srs", ["EPSG:25832", "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837", "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH"]
)
@pytest.mark.parametrize("swaps", [False, True])
def test_names_of_the_system_and_order_of_axes_do_not_move_the_house(tmp_path: Path, srs: str, swaps: bool) -> None:
    dialect = Dialect(swaps=swaps)
    site = imported(dialect.model(dialect.house(dialect.window("w", SOUTH)), srs=srs), tmp_path)
    np.testing.assert_allclose(site.model.site.panels[0].corners_enu_m, expected_enu(site, SOUTH), atol=2e-4)
    assert site.model.site.origin.ellipsoid_height_m == pytest.approx(415.0 + 46.47, abs=0.05)


def test_the_user_overrules_the_system_of_the_file(tmp_path: Path) -> None:
    text = PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH)), srs="EPSG:31467")
    with pytest.raises(InputError, match="far outside the area of use"):
        imported(text, tmp_path)
    site = imported(text, tmp_path, ImportOptions(crs="EPSG:25832", height_reference="ellipsoid"))
    assert site.model.site.origin.ellipsoid_height_m == pytest.approx(415.0, abs=1e-3)


def test_no_system_at_all_asks_for_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--crs EPSG:CODE"):
        imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH)), srs=None), tmp_path)


def two_houses(distance_m: float, windows_in_second: bool = True) -> str:
    ring = [(x + distance_m, y, z) for x, y, z in SOUTH]
    second = PLAIN.house(*([PLAIN.window("w2", ring)] if windows_in_second else []), building_id="b2", at=distance_m)
    return PLAIN.model(PLAIN.house(PLAIN.window("w1", SOUTH), building_id="b1"), second)


def test_buildings_side_by_side_are_one_site_and_one_may_be_named(tmp_path: Path) -> None:
    both = imported(two_houses(15.0), tmp_path)
    assert sorted(str(panel.source_id) for panel in both.model.site.panels) == ["w1", "w2"]
    assert both.model.site.obstacles == ()
    assert any("the site is 'b1' (windows: 1), 'b2' (windows: 1)" in note for note in both.notes)
    one = imported(two_houses(15.0), tmp_path, ImportOptions(building="b2"))
    assert [panel.source_id for panel in one.model.site.panels] == ["w2"]
    assert len(one.model.obstacles[0].triangles) == 14
    with pytest.raises(InputError, match=r"no building 'b9'; there are 'b1' \(windows: 1\), 'b2'"):
        imported(two_houses(15.0), tmp_path, ImportOptions(building="b9"))


def test_of_buildings_apart_the_one_with_most_windows_is_taken_and_the_others_are_named(tmp_path: Path) -> None:
    site = imported(two_houses(40.0), tmp_path)
    assert [panel.source_id for panel in site.model.site.panels] == ["w1"]
    assert any("'b2' (windows: 1) further away, to be imported with --building ID" in note for note in site.notes)
    assert len(site.model.obstacles[0].triangles) == 14


def test_windows_of_the_same_name_in_two_buildings_keep_apart(tmp_path: Path) -> None:
    site = imported(two_houses(15.0).replace("'w2'", "'w1'"), tmp_path)
    assert sorted(str(panel.source_id) for panel in site.model.site.panels) == ["b2/w1", "w1"]


def test_the_only_building_with_windows_needs_no_name(tmp_path: Path) -> None:
    site = imported(two_houses(30.0, windows_in_second=False), tmp_path)
    assert site.model.site.name == "b1"


@pytest.mark.parametrize(("distance_m", "is_kept"), [(30.0, True), (60.0, True), (90.0, False), (3000.0, False)])
def test_near_buildings_become_an_obstacle_and_far_ones_do_not(
    tmp_path: Path, distance_m: float, is_kept: bool
) -> None:
    site = imported(two_houses(distance_m, windows_in_second=False), tmp_path)
    assert len(site.model.site.obstacles) == int(is_kept)
    home = np.array(site.model.site.home_enu_m)
    if is_kept:
        corners = site.model.obstacles[0].corners_enu_m
        assert len(corners) == 12
        assert Solids.of(corners).clearance_m(home[None])[0] >= 15.0
    assert Solids.of(site.model.building.corners_enu_m).clearance_m(home[None])[0] >= 15.0


def test_buildings_without_windows_say_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no building in this file has windows; .*--panel-grid"):
        imported(PLAIN.model(PLAIN.house()), tmp_path)
    with pytest.raises(InputError, match="no building with surfaces"):
        imported(PLAIN.model(), tmp_path)


BOMB = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'
FETCH = '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/hostname">]>'


@pytest.mark.parametrize("doctype", [BOMB, FETCH])
def test_entities_are_refused(tmp_path: Path, doctype: str) -> None:
    text = PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))).replace('<?xml version="1.0"?>', doctype)
    with pytest.raises(InputError, match="declares a document type or entities"):
        imported(text, tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("</c:CityModel>", "", "not valid XML"),
        ("c:CityModel", "c:Citizens", r"expected a CityGML file \(root element CityModel\), found 'Citizens'"),
    ],
)
def test_broken_files_are_refused_with_the_reason(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH)))
    with pytest.raises(InputError, match=said):
        imported(text.replace(old, new), tmp_path)


@pytest.mark.parametrize("new", ["abc", "", "nan"])
def test_an_outline_that_is_broken_is_left_out_and_told(tmp_path: Path, new: str) -> None:
    whole = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))), tmp_path)
    text = PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))).replace("678052.000", new, 1)
    site = imported(text, tmp_path)
    assert site.model.site.n_panels == 1
    assert len(site.model.building.triangles) == len(whole.model.building.triangles) - 2
    assert any("left out, because they are broken" in note and "not read: 1 (" in note for note in site.notes)


@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_an_outline_of_two_points_does_not_keep_a_file_out(tmp_path: Path, version: str) -> None:
    dialect = Dialect(version)
    sliver = dialect.polygon(SOUTH[:2]).replace("<gml:LinearRing>", "<gml:LinearRing gml:id='sliver'>")
    surface = dialect.surface("WallSurface", 3, sliver)
    site = imported(dialect.model(dialect.house(dialect.window("w", SOUTH), extra=surface)), tmp_path)
    assert site.model.site.n_panels == 1
    assert any("not read: 1 (sliver)" in note for note in site.notes)


def test_a_broken_hole_leaves_its_face(tmp_path: Path) -> None:
    face = rectangle((20.0, 0.0, 0.0), (30.0, 0.0, 6.0))
    wall = PLAIN.surface("WallSurface", 3, PLAIN.polygon(face, SOUTH[:2]))
    plain = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))), tmp_path)
    site = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH), extra=wall)), tmp_path)
    assert len(site.model.building.triangles) == len(plain.model.building.triangles) + 2


@pytest.mark.few(2)
@pytest.mark.parametrize("shape", SHAPES)
def test_windows_face_where_the_file_says(tmp_path: Path, shape: str) -> None:
    windows = [
        PLAIN.window(panel.id, [tuple(corner) for corner in panel.corners_enu_m])
        for facade in facades(shape)
        for panel in facade.panels
    ]
    walls = PLAIN.surface("WallSurface", 3, openings="".join(windows))
    site = imported(PLAIN.model(f"<b:Building gml:id='panes'>{walls}</b:Building>"), tmp_path)
    found = {panel.source_id: normal_of(panel.corners_enu_m) for panel in site.model.site.panels}
    for facade in facades(shape):
        for panel in facade.panels:
            assert found[panel.id] @ normal_of(panel.corners_enu_m) > 0.99


def test_windows_that_a_closed_building_has_facing_inwards_are_turned_around(tmp_path: Path) -> None:
    site = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH[::-1]))), tmp_path)
    (panel,) = site.model.site.panels
    assert normal_of(panel.corners_enu_m)[1] < -0.99
    assert any(
        note == "windows that the file has facing into the building, turned around: 1 (w)" for note in site.notes
    )


def test_parts_keep_the_level_of_detail_that_each_has(tmp_path: Path) -> None:
    wall = PLAIN.surface("WallSurface", 2, PLAIN.polygon(rectangle((20.0, 0.0, 0.0), (30.0, 0.0, 6.0))))
    coarse = f"<b:consistsOfBuildingPart><b:BuildingPart>{wall}</b:BuildingPart></b:consistsOfBuildingPart>"
    plain = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH))), tmp_path)
    site = imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH), extra=coarse)), tmp_path)
    assert len(site.model.building.triangles) == len(plain.model.building.triangles) + 2


def test_deeply_nested_files_are_refused(tmp_path: Path) -> None:
    nested = "<b:x>" * 3000 + "</b:x>" * 3000
    with pytest.raises(InputError, match=r"nested more than .* levels deep"):
        imported(PLAIN.model(PLAIN.house(PLAIN.window("w", SOUTH), extra=nested)), tmp_path)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "noise.gml"
    path.write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="not valid XML"):
        read_citygml(path, ImportOptions(), QUIET)


REAL = {
    "4018106": 32,
    "4018115": 54,
    "4018133": 16,
    "4018149a": 24,
    "4018204b": 19,
    "4018260": 15,
    "4018270": 57,
    "4018302": 16,
}


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "n_windows"), REAL.items())
def test_real_buildings_keep_all_windows_and_every_one_sees_the_open(
    shared_data: Path, name: str, n_windows: int
) -> None:
    path = shared_data / "buildings" / "ingolstadt_lod3" / f"{name}.xml"
    site = import_site(path, ImportOptions())
    assert site.model.site.n_panels == n_windows
    corners = panel_corners(site.model.site)
    fronts = corners.mean(axis=1) + 0.15 * unit_normals(corners)
    # From each point in front some way leads 200 m out: the float64 twin of the importer's rays, in other directions.
    solids = Solids.of(site.model.building.corners_enu_m)
    rng = np.random.default_rng(0)
    is_open = np.zeros(len(fronts), bool)
    for _ in range(100):
        ways = unit_normals(corners) + rng.uniform(-0.8, 0.8, corners[:, 0].shape)
        is_open |= solids.lines_free(fronts, fronts + 200.0 * ways)
    assert is_open.all()


@pytest.mark.slow
def test_real_windows_are_where_the_file_has_them(shared_data: Path) -> None:
    path = shared_data / "buildings" / "ingolstadt_lod3" / "4018270.xml"
    site = import_site(path, ImportOptions())
    text = path.read_text()
    for panel in site.model.site.panels:
        assert panel.source_id is not None
        found = re.search(
            rf'<bldg:Window gml:id="{re.escape(panel.source_id)}">.*?<gml:posList[^>]*>(.*?)<', text, re.S
        )
        assert found is not None
        points = np.array(found[1].split(), float).reshape(-1, 3)[:4]
        conversion = crs_conversion("EPSG:32632", points)
        enu = enu_from_geodetic(site.model.site.origin, *conversion.geodetic(points))
        np.testing.assert_allclose(np.mean(panel.corners_enu_m, axis=0), enu.mean(axis=0), atol=2e-4)
