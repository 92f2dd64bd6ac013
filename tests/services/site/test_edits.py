"""Edits of a site: whatever the order, identifiers stay unique, the old site stays as it was, the checksum fits."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import (
    REMOVABLE,
    HeightReference,
    add_box,
    add_mesh_obstacle,
    add_panel_grid,
    add_rally_point,
    add_zone,
    flip_facade,
    height_above_sea_m,
    move_home,
    move_rally_point,
    remove_item,
    rename_item,
    rename_site,
    set_airspace,
    set_box,
    set_origin,
    set_zone,
)
from groundstation.services.site.findings import site_findings
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.geo.mesh import box_mesh, write_mesh
from planning.site.bundled import SCENES
from planning.site.file import read_site, site_sha256, write_site
from planning.site.importing.panel_grid import GridField, PanelGridError
from planning.site.importing.polygons import unit_normals
from planning.site.records import panel_corners

OFFICE = SCENES["office"]()
CANYON = SCENES["canyon"]()
SOUTH = ((-18.0, 0.0, 0.0), (18.0, 0.0, 0.0), (-18.0, 0.0, 42.0))

numbers = st.floats(-80.0, 80.0)
points = st.tuples(numbers, numbers, numbers)
names = st.text(min_size=0, max_size=6)


def items(model):
    site = model.site
    return [
        *(Item(ItemKind.FACADE, facade.id) for facade in site.facades),
        *(Item(ItemKind.PANEL, panel.id) for panel in site.panels[:5]),
        *(Item(ItemKind.OBSTACLE, obstacle.id) for obstacle in site.obstacles),
        *(Item(ItemKind.NO_FLY, zone.id) for zone in site.airspace.no_fly),
    ]


@st.composite
def edited(draw):
    """A site after some random edits, and all the sites before."""
    model, before = draw(st.sampled_from([SCENES["roof"](), CANYON])), []
    for _ in range(draw(st.integers(1, 6))):
        before.append((model, model.site))
        known = items(model)
        which = draw(st.integers(0, 6).filter(lambda which, known=known: known or which not in (3, 4)))
        try:
            match which:
                case 0:
                    model, _ = add_box(model, draw(points), draw(points))
                case 1:
                    model, _ = add_zone(model, draw(st.lists(st.tuples(numbers, numbers), min_size=3, max_size=5)))
                case 2:
                    model = move_home(model, draw(points), on_ground=draw(st.booleans()))
                case 3:
                    model = remove_item(model, draw(st.sampled_from(known)))
                case 4:
                    model = rename_item(model, draw(st.sampled_from(known)), draw(names))
                case 5:
                    facades = [item for item in known if item.kind is ItemKind.FACADE]
                    model = flip_facade(model, draw(st.sampled_from(facades)).id) if facades else model
                case 6:
                    model, _ = add_mesh_obstacle(model, "crane", box_mesh(np.zeros(3), np.ones(3)))
        except InputError:
            continue
    return model, before


@settings(max_examples=60)
@given(edited())
def test_any_edits_leave_a_site_that_is_written_and_read_back_with_the_same_checksum(tmp_path_factory, case):
    model, before = case
    folder = tmp_path_factory.mktemp("site")
    for name, mesh in (
        (model.site.building_mesh, model.building),
        *((o.mesh, m) for o, m in zip(model.site.obstacles, model.obstacles, strict=True)),
    ):
        if name is not None:
            write_mesh(folder / name, mesh)
    written = write_site(folder / "site.json", model.site)
    read = read_site(folder / "site.json")
    assert read.site == model.site
    assert model.sha256 in ("", written)
    assert written == read.sha256 == hashlib.sha256((folder / "site.json").read_bytes()).hexdigest()
    assert len(read.obstacles) == len(model.obstacles)
    for old, site in before:
        assert old.site == site
    for found in (
        [o.id for o in model.site.obstacles],
        [f.id for f in model.site.facades],
        [z.id for z in model.site.airspace.no_fly],
        [o.mesh for o in model.site.obstacles if o.mesh],
    ):
        assert len(set(found)) == len(found)


@given(points, points)
def test_boxes_take_opposite_corners_in_any_order(a, b):
    assume(all(abs(p - q) > 2e-3 for p, q in zip(a, b, strict=True)))
    one, name = add_box(OFFICE, a, b)
    two, _ = add_box(OFFICE, b, a)
    assert one.site == two.site
    assert name == "box-1"
    np.testing.assert_allclose(one.obstacles[0].vertices_enu_m.min(axis=0), np.minimum(a, b), atol=1e-3)
    np.testing.assert_allclose(one.obstacles[0].vertices_enu_m.max(axis=0), np.maximum(a, b), atol=1e-3)


def test_boxes_and_zones_get_free_names_and_new_shapes():
    model, first = add_box(CANYON, (0.0, -15.0, 0.0), (1.0, -14.0, 5.0))
    model, second = add_box(model, (3.0, -15.0, 0.0), (4.0, -14.0, 5.0))
    assert (first, second) == ("box-1", "box-2")
    model = remove_item(model, Item(ItemKind.OBSTACLE, first))
    model, again = add_box(model, (0.0, -15.0, 0.0), (1.0, -14.0, 5.0))
    assert again == first
    model = set_box(model, second, (3.0, -15.0, 0.0), (4.0, -14.0, 9.0))
    index = [o.id for o in model.site.obstacles].index(second)
    assert model.obstacles[index].vertices_enu_m[:, 2].max() == 9.0
    model, zone = add_zone(model, [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)])
    assert model.site.airspace.no_fly[0].floor_m == 0.0
    assert model.site.airspace.no_fly[0].ceiling_m == CANYON.site.airspace.max_enu_m[2]
    model = set_zone(model, zone, ((0.0, 0.0), (9.0, 0.0), (9.0, 9.0)), 2.0, 8.0)
    assert model.site.airspace.no_fly[0].polygon_enu_m[1] == (9.0, 0.0)
    model = set_airspace(model, (-50.0, -50.0, 1.0), (50.0, 50.0, 60.0), 0.5)
    assert [found.id for found in model.site.airspace.no_fly] == [zone]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda m: add_box(m, (0, 0, 0), (1, 1, 0)), "minimum corner"),
        (lambda m: add_box(m, (0, 0, 0), (1, 1, 30_000)), "within 20000 m"),
        (lambda m: add_zone(m, [(0, 0), (1, 1)]), "at least 3 corners"),
        (lambda m: add_zone(m, [(0, 0), (2, 2), (2, 0), (0, 2)]), "crosses itself"),
        (
            lambda m: set_airspace(m, (0, 0, 0), (1, 1, 0), 0.0),
            "up: expected the first value below the second, got 0 m and 0 m",
        ),
        (
            lambda m: set_box(add_box(m, (0, 0, 0), (1, 1, 1))[0], "box-1", (0, 2, 0), (1, 1, 1)),
            "north: expected the first",
        ),
        (lambda m: move_home(m, (float("nan"), 0, 0)), "finite"),
        (lambda m: rename_site(m, " "), "expected a name for the site"),
        (lambda m: set_origin(m, 91.0, 0.0, 0.0, HeightReference.ELLIPSOID), "lat_deg: expected -90 to 90"),
        (lambda m: set_origin(m, 91.0, 0.0, 0.0, HeightReference.SEA_LEVEL), "lat_deg: expected -90 to 90"),
        (lambda m: set_origin(m, 0.0, 0.0, 1e5, HeightReference.SEA_LEVEL), "ellipsoid_height_m"),
        (lambda _: remove_item(SCENES["single-panel"](), Item(ItemKind.FACADE, "A")), "at least one panel"),
        (lambda m: rename_item(m, Item(ItemKind.FACADE, "A"), "  "), "expected a name"),
        (lambda m: rename_item(m, Item(ItemKind.PANEL, "A-0001"), "A-0002"), "panel 'A-0002' already"),
    ],
)
def test_impossible_values_are_refused_with_the_field(edit, message):
    with pytest.raises(InputError, match=message):
        edit(OFFICE)


@pytest.mark.parametrize("kind", sorted(set(ItemKind) - REMOVABLE))
def test_what_every_site_has_cannot_be_removed_or_renamed(kind):
    with pytest.raises(ValueError, match="always has"):
        remove_item(OFFICE, Item(kind))
    with pytest.raises(ValueError, match="has no name"):
        rename_item(OFFICE, Item(kind), "x")


@pytest.mark.parametrize("kind", sorted(REMOVABLE))
def test_what_is_not_there_cannot_be_removed_or_renamed(kind):
    with pytest.raises(ValueError, match="there is no"):
        remove_item(OFFICE, Item(kind, "x"))
    with pytest.raises(ValueError, match="there is no"):
        rename_item(OFFICE, Item(kind, "x"), "y")


@given(st.floats(-90.0, 90.0), st.floats(-180.0, 180.0), st.floats(-500.0, 5000.0))
def test_heights_of_the_origin_convert_both_ways(lat_deg, lon_deg, altitude_m):
    model = set_origin(OFFICE, lat_deg, lon_deg, altitude_m, HeightReference.SEA_LEVEL)
    assert height_above_sea_m(model.site.origin) == pytest.approx(altitude_m, abs=2e-4)
    assert abs(model.site.origin.ellipsoid_height_m - altitude_m) < 108.0  # EGM96 lies within -107 and 86 m


def test_renamed_facade_takes_its_panels_along_and_frees_its_letter_for_no_other():
    model = rename_item(OFFICE, Item(ItemKind.FACADE, "A"), "South")
    assert model.site.panels[3].id == "South-0003"
    odd = rename_item(OFFICE, Item(ItemKind.PANEL, "A-0003"), "door")
    assert rename_item(odd, Item(ItemKind.FACADE, "A"), "South").site.panels[3].id == "door"


def test_grid_on_the_building_becomes_a_facade_of_its_own():
    north = ((18.0, 18.0, 1.0), (-18.0, 18.0, 1.0), (18.0, 18.0, 40.0))
    added = add_panel_grid(OFFICE, north, 3, 9, 0.2)
    assert added.facade_id == "B"
    assert added.notes == ()
    facade = added.model.site.facades[1]
    assert [panel.id for panel in facade.panels][:2] == ["B-0000", "B-0001"]
    corners = panel_corners(replace(added.model.site, facades=(facade,)))
    np.testing.assert_allclose(unit_normals(corners), np.tile([0.0, 1.0, 0.0], (27, 1)), atol=1e-9)
    renamed = rename_item(added.model, Item(ItemKind.FACADE, "A"), "South")
    assert add_panel_grid(renamed, SOUTH, 2, 2).facade_id == "A"


@pytest.mark.parametrize(
    ("rectangle", "counts", "gap_m", "field", "message"),
    [
        (SOUTH, (0, 5), 0.0, GridField.COUNTS, "expected 1 to 100000 panels"),
        ((SOUTH[0], SOUTH[0], SOUTH[2]), (2, 2), 0.0, GridField.CORNERS, "no facade"),
        ((SOUTH[0], SOUTH[1], (0.0, 0.0, 42.0)), (2, 2), 0.0, GridField.CORNERS, "angle at the lower left corner is"),
        (SOUTH, (10, 10), 5.0, GridField.GAP, "leaves no glass"),
        (tuple((x, y - 30.0, z) for x, y, z in SOUTH), (2, 2), 0.0, GridField.CORNERS, "30.0 m from the building"),
        ((SOUTH[1], SOUTH[0], (18.0, 0.0, 42.0)), (4, 4), 0.0, GridField.CORNERS, "16 of 16 panels look into"),
    ],
)
def test_grids_that_do_not_fit_say_why_without_options_of_the_command_line(rectangle, counts, gap_m, field, message):
    with pytest.raises(PanelGridError, match=message) as caught:
        add_panel_grid(OFFICE, rectangle, *counts, gap_m)
    assert caught.value.field is field
    assert "--" not in str(caught.value)


def test_flipping_a_facade_twice_gives_it_back_and_once_turns_its_normals():
    once = flip_facade(CANYON, "A")
    np.testing.assert_allclose(
        unit_normals(panel_corners(once.site)), -unit_normals(panel_corners(CANYON.site)), atol=1e-9
    )
    assert flip_facade(once, "A").site == CANYON.site
    corners = panel_corners(once.site)
    assert (corners[:, 0, 2] < corners[:, 3, 2]).all(), "panels begin at a lower corner"


@pytest.mark.few(2)
@pytest.mark.parametrize("scene", sorted(SCENES))
def test_bundled_sites_are_fit_to_fly(scene):
    assert site_findings(SCENES[scene]()) == ()


def codes(model):
    return {finding.code: finding for finding in site_findings(model)}


def test_findings_name_what_makes_a_site_useless():
    inside = codes(move_home(OFFICE, (0.0, 9.0, 0.0)))["home-unusable"]
    assert inside.severity is Severity.ERROR
    assert "inside a building" in inside.message
    assert inside.place == "home"
    assert "not below or inside the airspace" in codes(move_home(OFFICE, (500.0, 0.0, 0.0)))["home-unusable"].message
    zone, _ = add_zone(OFFICE, [(-5.0, -50.0), (5.0, -50.0), (5.0, -40.0), (-5.0, -40.0)])
    assert "no-fly volume" in codes(zone)["home-unusable"].message
    away, _ = add_zone(OFFICE, [(100.0, 100.0), (105.0, 100.0), (105.0, 105.0)])
    assert list(codes(away)) == ["no-fly-outside"]
    assert codes(flip_facade(OFFICE, "A"))["facade-out-of-reach"].place == "facade/A"
    low = OFFICE.site.airspace
    sunk = set_airspace(OFFICE, (*low.min_enu_m[:2], -3.0), low.max_enu_m, 0.0)
    assert codes(sunk)["airspace-below-ground"].value == -3.0
    assert "home-below-ground" in codes(move_home(OFFICE, (0.0, -45.0, -2.0)))


def test_home_is_put_on_the_ground_where_wanted():
    raised = set_airspace(OFFICE, OFFICE.site.airspace.min_enu_m, OFFICE.site.airspace.max_enu_m, 1.25)
    assert move_home(raised, (3.0, -40.0, 7.0), on_ground=True).site.home_enu_m == (3.0, -40.0, 1.25)
    assert move_home(raised, (3.0, -40.0, 7.0)).site.home_enu_m == (3.0, -40.0, 7.0)


def test_frames_that_stand_out_in_front_of_the_panels_do_not_put_them_out_of_reach():
    model = OFFICE
    for east in np.arange(-18.0, 18.1, 1.8):
        model, _ = add_box(model, (east - 0.05, -0.2, 0.0), (east + 0.05, 0.0, 42.0))
    assert site_findings(model) == ()


def test_facade_behind_a_wall_is_out_of_reach_and_one_below_the_airspace_is_not():
    wall, _ = add_box(OFFICE, (-80.0, -20.0, 0.0), (80.0, -3.0, 80.0))
    assert codes(wall)["facade-out-of-reach"].place == "facade/A"
    airspace = OFFICE.site.airspace
    above = set_airspace(OFFICE, (*airspace.min_enu_m[:2], 44.0), airspace.max_enu_m, 0.0)
    assert site_findings(above) == ()


def test_rally_points_are_marked_moved_renamed_and_removed():
    marked, first = add_rally_point(OFFICE, (20.0, -28.0, 3.0))
    marked, second = add_rally_point(marked, (10.0, -30.0, 0.0))
    assert (first, second) == ("rally-1", "rally-2")
    down = move_rally_point(marked, first, (21.0, -28.0, 3.0), on_ground=True)
    assert down.site.rally_points[0].position_enu_m == (21.0, -28.0, OFFICE.site.airspace.ground_z_m)
    assert down.site.rally_points[1] == marked.site.rally_points[1]
    item = Item(ItemKind.RALLY, first)
    renamed = rename_item(marked, item, "car park")
    assert [point.id for point in renamed.site.rally_points] == ["car park", "rally-2"]
    with pytest.raises(InputError, match="there is a rally point 'rally-2' already"):
        rename_item(marked, item, "rally-2")
    with pytest.raises(InputError, match="position_enu_m"):
        move_rally_point(marked, first, (1e7, 0.0, 0.0))
    left = remove_item(remove_item(marked, item), Item(ItemKind.RALLY, second))
    assert left.site == OFFICE.site
    assert left.sha256 == site_sha256(OFFICE.site)


def test_a_rally_point_in_a_bad_place_is_told_of():
    marked, name = add_rally_point(OFFICE, (0.0, -5.0, 0.0))
    (finding,) = (finding for finding in site_findings(marked) if finding.code == "rally-point")
    assert (finding.severity, finding.place) == (Severity.ERROR, f"rally/{name}")


def test_the_last_facade_can_go_where_there_is_a_building_and_a_new_one_be_drawn():
    bare = remove_item(SCENES["roof"](), Item(ItemKind.FACADE, "A"))
    assert bare.site.facades == ()
    (found,) = site_findings(bare)
    assert (found.code, found.severity, found.place) == ("no-panels", Severity.WARNING, "building")
    top = ((-10.0, -6.0, 12.0), (10.0, -6.0, 12.0), (-10.0, 6.0, 12.0))
    drawn = add_panel_grid(bare, top, 2, 3)
    assert (drawn.facade_id, drawn.model.site.n_panels) == ("A", 6)
    assert site_findings(drawn.model) == ()


def test_another_airspace_box_keeps_the_lowest_height_and_the_zones():
    airspace = replace(OFFICE.site.airspace, min_height_above_ground_m=7.0)
    own = replace(OFFICE, site=replace(OFFICE.site, airspace=airspace))
    changed = set_airspace(own, (-50.0, -60.0, 4.0), (50.0, 40.0, 70.0), 0.5).site.airspace
    assert changed == replace(airspace, min_enu_m=(-50.0, -60.0, 4.0), max_enu_m=(50.0, 40.0, 70.0), ground_z_m=0.5)
