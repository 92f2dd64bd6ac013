"""The map: projection on screen, tiles under the site, pan and zoom, picking, and what it says without a map."""

import contextlib
import gzip
import itertools
import json
import math
import sqlite3
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtWidgets import QMessageBox

from groundstation.services.map.online import OSM_ATTRIBUTION, OSM_URL, OnlineMap
from groundstation.services.map.web_mercator import Tile, world_from_enu, world_from_geodetic
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.units import UnitSystem
from planning.geo.frames import Origin
from tests.gui.driving import click_on, clicked, press, turn_until, type_into, words_of
from tests.missions.plans import example_plan
from tests.planning.plan_cases import kiosk
from tests.services.map_files import (
    colour_of,
    picture,
    square,
    tiles_around,
    vector_layer,
    write_map,
    write_pmtiles,
)
from tests.services.map_server import Server, send

HERE = (22.3372, 114.2636)


@pytest.fixture
def view(application):
    from groundstation.gui.map.map_view import MapView

    view = MapView()
    view.resize(700, 500)
    view.show()
    yield view
    view.close_view()
    view.close()


@pytest.fixture
def settle(application, view):
    """Wait until everything in sight is drawn."""

    def wait():
        end = time.monotonic() + 240.0
        calm = 0
        while calm < 3:
            assert time.monotonic() < end
            view.grab()
            application.processEvents()
            time.sleep(0.005)
            calm = calm + 1 if view.is_complete() else 0

    return wait


def pixel(view, x, y):
    colour = view.grab().toImage().pixelColor(round(x), round(y))
    return np.array([colour.red(), colour.green(), colour.blue()])


def on_screen(view, point_enu_m, origin):
    return view.viewport().screen(world_from_enu(origin, [point_enu_m]))[0]


def document(model=None, plan=None):
    entry = PlanEntry("plan-1", "Plan", plan or example_plan())
    return Document(site=model or kiosk(), plans=(entry,), current_plan_id="plan-1")


viewports = st.builds(
    lambda x, y, zoom, w, h: _viewport((x, y), zoom, w, h),
    st.floats(-0.2, 1.2),
    st.floats(0.0, 1.0),
    st.floats(0.0, 24.0),
    st.integers(1, 3000),
    st.integers(1, 2000),
)


def _viewport(centre, zoom, width, height):
    from groundstation.gui.map.viewport import Viewport

    return Viewport(centre, zoom, width, height)


@given(viewports, st.floats(-2.0, 2.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_zooming_keeps_what_is_at_the_pointer(viewport, levels, right, down):
    at = right * viewport.width_px, down * viewport.height_px
    before = viewport.world(*at)
    nearer = viewport.zoomed(levels, *at)
    assert 0.0 <= nearer.zoom <= 24.0
    if 0.0 < nearer.centre[1] < 1.0:
        assert nearer.screen(np.array([before]))[0] == pytest.approx(at, abs=1e-3)


@given(viewports)
def test_pixels_and_world_are_inverse_to_each_other(viewport):
    world = viewport.world(3.0, 7.0)
    assert viewport.screen(np.array([world]))[0] == pytest.approx([3.0, 7.0], abs=1e-3)


@given(viewports, st.integers(0, 22))
def test_tiles_in_sight_cover_the_widget_without_gaps_or_strangers(viewport, level):
    if viewport.scale / 2**level < 40.0 or viewport.width_px * viewport.height_px > 700 * 500:
        return
    size = viewport.scale / 2**level
    tiles = viewport.tiles(level)
    for tile, x, y in tiles:
        assert 0 <= tile.column < 2**level
        assert 0 <= tile.row < 2**level
        assert x < viewport.width_px + 1e-3
        assert y < viewport.height_px + 1e-3
        assert x + size > -1e-3
        assert y + size > -1e-3
    inside = viewport.world(viewport.width_px / 2, viewport.height_px / 2)
    if 0.0 < inside[1] < 1.0:
        assert any(
            x - 1e-3 <= viewport.width_px / 2 <= x + size + 1e-3
            and y - 1e-3 <= viewport.height_px / 2 <= y + size + 1e-3
            for _, x, y in tiles
        )


def test_without_a_map_it_says_how_to_load_one_and_still_shows_the_site(view, settle):
    view.set_document(document())
    settle()
    assert "No map is loaded" in view.note()
    x, y = on_screen(view, (0.0, 4.0, 0.0), kiosk().site.origin)
    assert np.abs(pixel(view, x, y) - [0x8D, 0x96, 0xA0]).max() <= 3


@pytest.mark.slow
def test_tiles_lie_where_they_belong_and_the_attribution_is_shown(view, settle, tmp_path):
    from groundstation.gui.map.map_paint import tile_level

    view.set_document(document())
    settle()
    before = view.grab().toImage()
    assert view.open_map(write_map(tmp_path / "m.mbtiles", tiles_around(*HERE, range(14, 20), reach=6)))
    settle()
    assert view.note() == ""
    viewport = view.viewport()
    level = tile_level(viewport, 14, 19)
    for tile, x, y in viewport.tiles(level):
        middle = x + viewport.scale / 2**level * 0.31, y + viewport.scale / 2**level * 0.53
        is_clear = 60 < middle[0] < 120 and 60 < middle[1] < 440
        if is_clear and view.item_at(_point(*middle)) is None:
            assert np.abs(pixel(view, *middle) - colour_of(tile)).max() <= 3
    corner = view.grab().toImage().copy(600, 478, 100, 22)
    assert corner != before.copy(600, 478, 100, 22)


def _point(x, y):
    from PySide6.QtCore import QPointF

    return QPointF(x, y)


def test_missing_levels_are_filled_from_above(view, settle, tmp_path):
    level = 15
    tiles = tiles_around(*HERE, (level,), reach=1)
    view.open_map(write_map(tmp_path / "m.mbtiles", tiles))
    view.set_viewport(_viewport(tuple(world_from_geodetic(*HERE)[0]), 20.0, 700, 500))
    settle()
    centre = world_from_geodetic(*HERE)[0] * 2**level
    expected = colour_of(Tile(level, int(centre[0]), int(centre[1])))
    assert np.abs(pixel(view, 350, 200) - expected).max() <= 3


def test_vector_tiles_are_drawn_sharp_far_below_their_last_level(view, settle, tmp_path):
    """A square of water: its edge is one pixel wide at a level 6 below that of the tile."""
    world = world_from_geodetic(*HERE)[0]
    tile = Tile(12, int(world[0] * 2**12), int(world[1] * 2**12))
    layer = vector_layer("water", [(3, square(1024, 2048), {})])
    damaged = tile._replace(column=tile.column + 1)
    tiles = {tile: gzip.compress(layer), damaged: layer[:-9]}
    view.open_map(write_pmtiles(tmp_path / "m.pmtiles", tiles, tile_type=1))
    corner = (tile.column + 0.5) / 2**12, (tile.row + 0.4) / 2**12
    view.set_viewport(_viewport(corner, 18.0, 700, 500))
    settle()
    water, land = np.array([0xA9, 0xCF, 0xE0]), np.array([0xF4, 0xF1, 0xEA])
    assert np.abs(pixel(view, 347, 250) - water).max() <= 3
    assert np.abs(pixel(view, 352, 250) - land).max() <= 3
    view.set_viewport(_viewport(((damaged.column + 0.4) / 2**12, corner[1]), 12.0, 700, 500))
    settle()
    assert np.abs(pixel(view, 350, 250) - water).max() > 20


def test_a_hole_in_a_level_shows_the_level_above(view, settle, tmp_path):
    world = world_from_geodetic(*HERE)[0]
    above = Tile(16, int(world[0] * 2**16), int(world[1] * 2**16))
    away = Tile(17, 5, 5)
    view.open_map(write_map(tmp_path / "m.mbtiles", [above, away]))
    view.set_viewport(_viewport(((above.column + 0.3) / 2**16, (above.row + 0.3) / 2**16), 17.0, 700, 500))
    settle()
    assert np.abs(pixel(view, 350, 250) - colour_of(above)).max() <= 3


def test_the_world_goes_on_across_the_antimeridian(view, settle, tmp_path):
    level = 10
    last = 2**level - 1
    row = 300
    view.open_map(write_map(tmp_path / "m.mbtiles", [Tile(level, last, row), Tile(level, 0, row)]))
    view.set_viewport(_viewport((1.0, (row + 0.5) / 2**level), float(level), 700, 500))
    settle()
    assert np.abs(pixel(view, 300, 250) - colour_of(Tile(level, last, row))).max() <= 3
    assert np.abs(pixel(view, 400, 250) - colour_of(Tile(level, 0, row))).max() <= 3


@pytest.mark.parametrize("origin", [Origin(-16.5, 180.0, 55.0), Origin(-16.5, -180.0, 55.0), Origin(84.9, 20.0, 0.0)])
def test_sites_at_the_edges_of_the_map_are_whole(view, settle, origin):
    model = kiosk(origin=origin)
    view.set_document(Document(site=model))
    settle()
    home = on_screen(view, model.site.home_enu_m, origin)
    assert (home > 0).all()
    assert (home < [700, 500]).all()
    assert view.item_at(_point(*home)) == Item(ItemKind.HOME)


def test_site_at_the_pole_is_said_to_be_beyond_the_map(view, settle):
    origin = Origin(90.0, 0.0, 0.0)
    view.set_document(document(kiosk(origin=origin), replace(example_plan(), origin=origin)))
    settle()
    assert "85.05" in view.note()


def test_dragging_pans_and_a_click_picks(view, settle, qtbot):
    from PySide6.QtCore import QPoint, Qt

    plan = example_plan()
    view.set_document(document(plan=plan))
    settle()
    heard = []
    view.picked.connect(heard.append)
    origin = kiosk().site.origin
    for viewpoint in plan.viewpoints[6:]:
        at = on_screen(view, viewpoint.position_enu_m, origin)
        qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(*(round(v) for v in at)))
        assert heard.pop() == Item(ItemKind.VIEWPOINT, viewpoint.id)
    before = on_screen(view, (0.0, 0.0, 0.0), origin)
    qtbot.mousePress(view, Qt.MouseButton.LeftButton, pos=QPoint(100, 100))
    qtbot.mouseMove(view, QPoint(130, 120))
    qtbot.mouseMove(view, QPoint(150, 140))
    qtbot.mouseRelease(view, Qt.MouseButton.LeftButton, pos=QPoint(150, 140))
    assert on_screen(view, (0.0, 0.0, 0.0), origin) - before == pytest.approx([50.0, 40.0], abs=1e-6)
    assert heard == []


def test_things_are_picked_by_what_they_are(view, settle):
    view.set_document(replace(document(), plans=(), current_plan_id=""))
    settle()
    origin = kiosk().site.origin

    def at(point):
        return view.item_at(_point(*on_screen(view, point, origin)))

    assert at((0.0, 4.0, 0.0)) == Item(ItemKind.BUILDING)
    assert at((19.5, -12.5, 0.0)) == Item(ItemKind.OBSTACLE, "tree")
    assert at((-27.0, 0.0, 0.0)) == Item(ItemKind.NO_FLY, "road")
    assert at((0.0, 0.0, 0.0)) == Item(ItemKind.FACADE, "A")
    assert at((0.0, -30.0, 0.0)) == Item(ItemKind.HOME)
    assert at((30.0, 30.0, 0.0)) is None


def test_looking_at_things_brings_them_to_the_middle(view, settle):
    view.set_document(document())
    settle()
    plan, origin = example_plan(), kiosk().site.origin
    view.look_at(Item(ItemKind.VIEWPOINT, "v0007"))
    assert on_screen(view, plan.viewpoints[7].position_enu_m, origin) == pytest.approx([350, 250], abs=1.0)
    view.look_at(Item(ItemKind.LEG, "1/2"))
    path = plan.sorties[0].path_enu_m
    middle = tuple((a + b) / 2 for a, b in zip(path[1], path[2], strict=True))
    assert on_screen(view, middle, origin) == pytest.approx([350, 250], abs=1.0)
    before = view.viewport()
    for nothing in (Item(ItemKind.VIEWPOINT, "v9999"), Item(ItemKind.LEG, "9/9"), Item(ItemKind.PANEL, "A-0000")):
        view.look_at(nothing)
    assert view.viewport() == before


def test_pointer_says_where_it_is(view, settle, application):
    from PySide6.QtCore import QEvent, Qt
    from PySide6.QtGui import QMouseEvent

    view.set_document(document())
    settle()
    at = on_screen(view, (0.0, 0.0, 0.0), kiosk().site.origin)
    none = Qt.MouseButton.NoButton
    modifiers = Qt.KeyboardModifier.NoModifier
    application.sendEvent(view, QMouseEvent(QEvent.Type.MouseMove, _point(*at), _point(*at), none, none, modifiers))
    lat, lon = (float(part.split("°")[0]) for part in view.pointer_text().split("  "))
    assert lat == pytest.approx(HERE[0], abs=2e-6)
    assert lon == pytest.approx(HERE[1], abs=2e-6)
    assert view.pointer_text().endswith("E")


def test_keys_wheel_and_pinch_move_the_map(view, settle, qtbot):
    from PySide6.QtCore import Qt

    view.set_document(document())
    settle()
    zoom = view.viewport().zoom
    qtbot.keyClick(view, Qt.Key.Key_Plus)
    assert view.viewport().zoom == pytest.approx(zoom + 1.0)
    view.pinch(0.5, _point(10, 10))
    assert view.viewport().zoom == pytest.approx(zoom)
    view.pinch(0.0, _point(10, 10))
    centre = view.viewport().centre
    qtbot.keyClick(view, Qt.Key.Key_Right)
    assert view.viewport().centre[0] > centre[0]
    qtbot.keyClick(view, Qt.Key.Key_F)
    assert view.viewport().zoom == pytest.approx(zoom)


def test_maps_that_cannot_be_used_are_refused_in_sight_and_the_old_one_stays(view, settle, tmp_path):
    good = write_map(tmp_path / "good.mbtiles", tiles_around(*HERE, (15,), reach=1))
    view.open_map(good)
    heard = []
    view.refused.connect(heard.append)
    foreign = write_map(tmp_path / "v.mbtiles", {Tile(1, 0, 0): b"GIF89a"}, {"format": "gif"})
    assert not view.open_map(foreign)
    assert "expected tiles in PNG" in heard[0]
    assert view.note() == heard[0]
    assert view.map_file() == good
    view.open_map(good)
    assert view.note() == ""


def test_a_map_of_another_place_says_so(view, settle, tmp_path):
    facts = {"name": "Berlin", "format": "png", "bounds": "13.0,52.0,14.0,53.0"}
    view.set_document(document())
    view.open_map(write_map(tmp_path / "b.mbtiles", tiles_around(52.5, 13.4, (10,)), facts))
    settle()
    assert 'The map "Berlin" does not cover this place' in view.note()


def test_hostile_pictures_leave_a_hole(view, settle, tmp_path):
    bomb = tmp_path / "bomb.mbtiles"
    world = world_from_geodetic(*HERE)[0]
    tile = Tile(15, int(world[0] * 2**15), int(world[1] * 2**15))
    write_map(bomb, {tile: picture(tile), tile._replace(column=tile.column + 1): picture(tile, size=2000)})
    with contextlib.closing(sqlite3.connect(bomb)) as connection, connection:
        broken = picture(tile)[:200]
        connection.execute("INSERT INTO tiles VALUES (15, ?, ?, ?)", (tile.column - 1, 2**15 - 1 - tile.row, broken))
    view.open_map(bomb)
    view.set_viewport(_viewport(((tile.column + 0.5) / 2**15, (tile.row + 0.5) / 2**15), 15.0, 700, 500))
    settle()
    assert np.abs(pixel(view, 300, 200) - colour_of(tile)).max() <= 3
    ground = pixel(view, 350, 100)
    assert np.abs(pixel(view, 540, 250) - ground).max() <= 3
    assert np.abs(pixel(view, 150, 250) - ground).max() <= 3


def test_scale_bar_is_in_the_users_units(view, settle):
    view.set_document(document())
    settle()
    metric = view.grab().toImage()
    view.set_units(UnitSystem.IMPERIAL)
    assert view.grab().toImage().copy(0, 460, 200, 40) != metric.copy(0, 460, 200, 40)


@pytest.mark.alone
def test_panning_a_large_plan_stays_within_a_frame(view, settle, tmp_path):
    from tests.missions.plans import make_plan, ring

    plan = make_plan([(ring(500), {}), (ring(500, 32.0, 500), {})])
    view.set_document(document(plan=plan))
    view.open_map(write_map(tmp_path / "m.mbtiles", tiles_around(*HERE, range(15, 20), reach=5)))
    settle()
    times = []
    for _ in range(30):
        started = time.perf_counter()
        view.set_viewport(view.viewport().panned(3.0, 2.0))
        view.repaint()
        times.append(time.perf_counter() - started)
    assert np.median(times) < 0.016


def test_the_same_document_again_costs_nothing(view, settle):
    same = document()
    view.set_document(same)
    settle()
    started = time.thread_time()
    for _ in range(100):
        view.set_document(same)
    assert time.thread_time() - started < 0.2


def test_site_and_plan_go_when_the_document_is_empty(view, settle):
    view.set_document(document())
    settle()
    full = view.grab().toImage()
    view.set_document(Document())
    settle()
    assert view.grab().toImage() != full
    assert view.item_at(_point(350, 250)) is None
    assert math.isfinite(view.viewport().zoom)


def test_the_first_map_is_at_the_site_before_its_outlines_are_there(application, monkeypatch):
    """It stood at 10 000 km, in the middle of the sea, until they were computed."""
    from groundstation.gui.map import map_view
    from groundstation.services.map.shapes import site_shapes
    from planning.site.bundled import SCENES

    gate = threading.Event()

    def late(model):
        gate.wait(240.0)
        return site_shapes(model)

    monkeypatch.setattr(map_view, "site_shapes", late)
    view, model = map_view.MapView(), SCENES["library"]()
    view.resize(600, 400)
    view.show()
    view.set_site(model)
    application.processEvents()
    size_m = model.site.airspace.max_enu_m[0] - model.site.airspace.min_enu_m[0]
    assert size_m / 2.0 < view._viewport.metres_per_px * 600 < 10.0 * size_m
    gate.set()
    turn_until(application, view.is_complete)
    assert view._viewport.metres_per_px * 600 < 10.0 * size_m
    view.close_view()


def test_without_a_site_there_is_no_scale_but_what_to_do(application):
    from groundstation.gui.map.map_view import MapView

    view = MapView()
    assert "Open or import a site" in view.note()
    view.close_view()


def write_overlay(path, east=0.0):
    """A square of 80 m around the site, and a point with a name."""
    lat, lon = HERE[0], HERE[1] + east
    ring = [[lon - 4e-4, lat - 4e-4], [lon + 4e-4, lat - 4e-4], [lon + 4e-4, lat + 4e-4], [lon - 4e-4, lat + 4e-4]]
    ring.append(ring[0])
    geometries = {"Polygon": [ring], "Point": [lon + 1e-4, lat + 1e-4]}
    features = [
        {"type": "Feature", "properties": {"name": "Yard"}, "geometry": {"type": kind, "coordinates": places}}
        for kind, places in geometries.items()
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def test_overlays_lie_on_the_map_and_can_be_faint_hidden_and_removed(view, settle, tmp_path):
    view.set_document(document())
    settle()
    plain = view.grab().toImage()
    at = view.viewport().screen(world_from_geodetic(HERE[0] + 2.6e-4, HERE[1] + 2.6e-4))[0]
    ground = pixel(view, *at)
    heard = []
    view.overlaysChanged.connect(heard.append)
    path = write_overlay(tmp_path / "yard.geojson")
    view.add_overlay(path)
    settle()
    strong = pixel(view, *at)
    assert np.abs(strong - ground).max() > 15
    (row,) = [row for row in view.layer_panel().list.value() if row.can_remove]
    assert (row.title, heard) == ("yard.geojson", [(path,)])
    box, slider = view.layer_panel().list.boxes(row.key)
    slider.setValue(20)
    settle()
    assert 0 < np.abs(pixel(view, *at) - ground).max() < np.abs(strong - ground).max()
    box.click()
    settle()
    assert np.abs(pixel(view, *at) - ground).max() == 0
    view.layers.remove(row.key)
    settle()
    assert heard[-1] == ()
    assert view.grab().toImage() == plain


def test_an_overlay_elsewhere_is_brought_into_view_and_a_bad_one_is_told(view, settle, tmp_path):
    view.set_document(document())
    settle()
    view.add_overlay(write_overlay(tmp_path / "far.geojson", east=0.3))
    settle()
    middle = view.viewport().screen(world_from_geodetic(HERE[0], HERE[1] + 0.3))[0]
    assert middle == pytest.approx([350, 250], abs=2.0)
    bad = tmp_path / "bad.kml"
    bad.write_text("nonsense")
    view.add_overlay(bad)
    settle()
    assert "not KML" in view.note()


def rows(view):
    return view.layer_panel().list.value()


def write_line(path, places):
    path.write_text(json.dumps({"type": "LineString", "coordinates": places}))
    return path


def test_an_overlay_far_from_the_site_is_told_and_moves_nothing(view, settle, tmp_path):
    view.set_document(document())
    settle()
    before = view.viewport()
    view.add_overlay(write_overlay(tmp_path / "far.geojson", east=5.0))
    settle()
    assert view.viewport() == before
    assert "far.geojson lies" in view.note()
    assert "the map stays where it is" in view.note()


@pytest.mark.parametrize("place", [HERE, (48.15, 11.5)], ids=["no place as it is", "a place elsewhere as it is"])
def test_an_overlay_with_swapped_axes_is_shown_at_the_site_once_the_user_agrees(view, settle, tmp_path, place):
    lat, lon = place
    here = document()
    origin = replace(here.site.site.origin, lat_deg=lat, lon_deg=lon)
    view.set_document(document(replace(here.site, site=replace(here.site.site, origin=origin))))
    settle()
    before = view.viewport()
    path = write_line(tmp_path / "swapped.geojson", [[lat - 4e-4, lon], [lat + 4e-4, lon]])
    with clicked(press(QMessageBox.StandardButton.Yes)):
        view.add_overlay(path)
        settle()
    assert view.viewport() == before
    (row,) = [row for row in rows(view) if row.can_remove]
    found = view.layers.overlay(row.key).extent()
    np.testing.assert_allclose(found.mean(axis=0), world_from_geodetic(lat, lon)[0], atol=1e-7)
    view.layers.remove(row.key)
    with clicked(press(QMessageBox.StandardButton.Cancel)):
        view.add_overlay(path)
        settle()
    assert view.viewport() == before
    assert "km from the site" in view.note() or not [row for row in rows(view) if row.can_remove]


def test_an_overlay_over_the_date_line_is_drawn_from_both_sides(application, view, settle, tmp_path):
    path = tmp_path / "line.geojson"
    path.write_text(json.dumps({"type": "LineString", "coordinates": [[179.99, -16.5], [-179.99, -16.5]]}))
    view.add_overlay(path)
    settle()
    for lon in (-179.995, 179.995):
        view.set_viewport(_viewport(tuple(world_from_geodetic(-16.5, lon)[0]), 14.0, 700, 500))
        view.repaint()
        turn_until(application, view.is_sharp)
        assert pixel(view, 350, 250).tolist() == [0x7B, 0x32, 0x94]


def test_site_and_plan_are_layers(view, settle):
    view.set_document(document())
    settle()
    at = on_screen(view, (0.0, 4.0, 0.0), kiosk().site.origin)
    rows = view.layer_panel().list
    assert [row.key for row in rows.value()] == ["sortie:1", "sortie:2", "site"]
    rows.boxes("site")[0].click()
    settle()
    assert view.item_at(_point(*at)) is None
    assert np.abs(pixel(view, *at) - [0x8D, 0x96, 0xA0]).max() > 30
    plan = on_screen(view, example_plan().viewpoints[3].position_enu_m, kiosk().site.origin)
    assert view.item_at(_point(*plan)).kind is ItemKind.VIEWPOINT
    rows.boxes("sortie:1")[0].click()
    assert view.item_at(_point(*plan)) is None
    other = on_screen(view, example_plan().viewpoints[7].position_enu_m, kiosk().site.origin)
    assert view.item_at(_point(*other)).kind is ItemKind.VIEWPOINT


def test_other_sorties_are_faint_while_one_is_selected(view, settle):
    view.set_document(document())
    settle()
    origin, plan = kiosk().site.origin, example_plan()
    route = plan.sorties[1].path_enu_m
    a, b = max(itertools.pairwise(route), key=lambda leg: math.dist(*leg))
    middle = on_screen(view, tuple(0.9 * p + 0.1 * q for p, q in zip(a, b, strict=True)), origin)
    strong = pixel(view, *middle)
    view.set_selection(Item(ItemKind.SORTIE, "1"))
    faint = pixel(view, *middle)
    assert np.abs(faint - strong).max() > 60
    view.set_selection(Item(ItemKind.SORTIE, "2"))
    assert (pixel(view, *middle) == strong).all()


def test_coordinates_are_searched_for_and_errors_are_in_plain_words(view, settle, qtbot):
    from PySide6.QtCore import Qt

    view.set_document(document())
    settle()
    type_into(view.search(), "50Q 218155 2472500")
    qtbot.keyClick(view.search(), Qt.Key.Key_Return)
    settle()
    place = view.viewport().screen(world_from_geodetic(22.335303, 114.263759))[0]
    assert place == pytest.approx([350, 250], abs=1.0)
    assert view.note().startswith("No map is loaded")
    marked = pixel(view, 350 + 12, 250)
    type_into(view.search(), "114.26, 22.3")
    qtbot.keyClick(view.search(), Qt.Key.Key_Return)
    assert "is the longitude written first" in view.note()
    assert place == pytest.approx([350, 250], abs=1.0)
    type_into(view.search(), "86, 20")
    qtbot.keyClick(view.search(), Qt.Key.Key_Return)
    assert "85.05" in view.note()
    type_into(view.search(), "")
    assert view.note().startswith("No map is loaded")
    assert (pixel(view, 350 + 12, 250) != marked).any()


def test_a_place_is_picked_once_and_escape_picks_none(view, settle, qtbot):
    from PySide6.QtCore import QPoint, Qt

    view.set_document(document())
    settle()
    places, ended, items = [], [], []
    view.placePicked.connect(lambda *place: places.append(place))
    view.pickEnded.connect(lambda: ended.append(1))
    view.picked.connect(items.append)
    view.start_pick("Click somewhere.")
    assert view.note() == "Click somewhere."
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(300, 200))
    expected = view.viewport().world(300, 200)
    assert world_from_geodetic(*places[0])[0] == pytest.approx(expected, abs=1e-12)
    assert (len(places), len(ended), items) == (1, 1, [])
    view.start_pick("Click somewhere.")
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(300, 200))
    assert (len(places), len(ended), len(items)) == (1, 2, 1)


@pytest.mark.long
@pytest.mark.parametrize(("lon", "lat"), [(180.0, -16.5), (-180.0, -16.5), (20.0, 84.9)])
def test_panning_stays_within_a_frame_at_the_edges_of_the_map(view, settle, tmp_path, lon, lat):
    """Vector tiles, an overlay of many points and a site at the date line and in the far north."""
    model = kiosk(origin=Origin(lat, lon, 55.0))
    view.set_document(Document(site=model))
    settle()
    layer = gzip.compress(vector_layer("water", [(3, square(500, 3500), {})]))
    tiles = dict.fromkeys(tiles_around(lat, lon, (12,), reach=2), layer)
    assert view.open_map(write_pmtiles(tmp_path / "m.pmtiles", tiles, tile_type=1))
    turns = np.linspace(0.0, 6.0, 5000)
    line = [[(lon + 1e-3 * math.sin(t) + 180.0) % 360.0 - 180.0, lat + 1e-4 * math.cos(t)] for t in turns]
    path = tmp_path / "ring.geojson"
    path.write_text(json.dumps({"type": "LineString", "coordinates": line}))
    view.add_overlay(path)
    settle()
    times = []
    for _ in range(30):
        started = time.thread_time()
        view.set_viewport(view.viewport().panned(3.0, 2.0))
        view.repaint()
        times.append(time.thread_time() - started)
    assert np.median(times) < 0.016
    settle()
    home = on_screen(view, model.site.home_enu_m, model.site.origin)
    assert view.item_at(_point(*home)) == Item(ItemKind.HOME)


@pytest.fixture
def server():
    with contextlib.closing(Server()) as found:
        found.answer = lambda handler: send(handler, answer_of(handler.path))
        yield found


def answer_of(path):
    zoom, column, row = (int(part) for part in path.removesuffix(".png").split("/")[1:])
    return picture(Tile(zoom, column, row))


@pytest.mark.long
def test_an_online_map_is_asked_only_after_consent_and_shows_its_licence(view, settle, server, monkeypatch, tmp_path):
    from PySide6.QtWidgets import QDialogButtonBox

    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    view.set_document(document())
    settle()
    assert server.asked == []
    words, heard = [], []
    view.onlineChanged.connect(heard.append)

    def fill(dialog):
        assert dialog.value() == OnlineMap(OSM_URL, OSM_ATTRIBUTION), "proposed, and off"
        dialog.server.setCurrentIndex(1)
        assert (dialog.url.text(), dialog.attribution.text()) == ("", "")
        ok = dialog.findChild(QDialogButtonBox).button(QDialogButtonBox.StandardButton.Ok)
        type_into(dialog.url, server.url + "/{z}/{x}/{y}.png")
        dialog.is_on.click()
        click_on(dialog, ok)
        words.append(words_of(dialog))
        assert server.asked == []
        type_into(dialog.attribution, "© The testers")
        click_on(dialog, ok)

    with clicked(fill):
        view.set_online_up()
    assert "licence is missing" in words[0]
    settle()
    assert view.note() == ""
    assert view.layers.attribution() == "© The testers"
    assert heard[0].is_on
    n_asked = len(server.asked)
    assert 0 < n_asked < 60
    x, y = 100, 400
    level = min(round(view.viewport().zoom), 19)
    tile = next(tile for tile, _, _ in view.viewport().tiles(level) if _holds(view, tile, x, y))
    assert np.abs(pixel(view, x, y) - colour_of(tile)).max() <= 3
    view.layer_panel().list.boxes("online")[0].click()
    settle()
    assert view.layers.attribution() == ""


def _holds(view, tile, x, y):
    world = np.array(view.viewport().world(x, y)) * 2**tile.zoom
    return (int(world[0]) % 2**tile.zoom, int(world[1])) == (tile.column, tile.row)


@pytest.mark.long
def test_a_server_that_refuses_is_told_and_not_asked_again_at_once(view, settle, server, monkeypatch, tmp_path):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    server.answer = lambda handler: send(handler, b"", 403)
    view.set_document(document())
    view.set_online(OnlineMap(server.url + "/{z}/{x}/{y}.png", "© testers", is_on=True))
    settle()
    assert "does not let Reflight in (answer 403)" in view.note()
    for _ in range(20):
        view.set_viewport(view.viewport().panned(30.0, 0.0))
        settle()
    assert len(server.asked) == 1
    view.set_online(OnlineMap(server.url + "/{z}/{x}/{y}.png", "© testers"))
    settle()
    assert view.note().startswith("No map is loaded")
