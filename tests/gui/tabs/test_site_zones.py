"""Geo-zones in the real window: added by the Site tab's button, seen on the map and in the tree, authorised, undone."""

from datetime import UTC, datetime

import numpy as np
import pytest
from PySide6.QtCore import QDateTime, QPoint, Qt
from PySide6.QtTest import QTest

from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.view3d.drawables import Layer
from groundstation.services.project.document import Item, ItemKind
from planning.base.findings import Severity
from planning.site.bundled import ORIGIN
from planning.site.zones.keep_out import no_fly_volumes
from planning.site.zones.records import Restriction
from tests.gui.driving import choose, click_on, clicked, type_into
from tests.gui.tabs.test_site_tab import Window
from tests.planning.site.zones.zone_files import ed269, ed269_feature, ed269_volume, lon_lat, polygon, square

SCHOOL, HELIPORT = Item(ItemKind.ZONE, "zones.json/SCHOOL"), Item(ItemKind.ZONE, "zones.json/HELI")


@pytest.fixture
def hands(application):
    window = Window(application, "single-panel")
    yield window
    window.close()


@pytest.fixture
def zones(tmp_path):
    circle = {"type": "Circle", "center": lon_lat([(-200.0, 0.0)], ORIGIN)[0], "radius": 170}
    school = ed269_feature(ed269_volume(polygon(square(40.0, -40.0, 15.0, ORIGIN))), identifier="SCHOOL")
    heliport = ed269_feature(ed269_volume(circle), identifier="HELI", name="Heliport", restriction="REQ_AUTHORISATION")
    path = tmp_path / "zones.json"
    path.write_bytes(ed269(school, heliport))
    return path


def add(hands, path):
    with clicked(choose(path)):
        click_on(hands.window, hands.tab.detail.tools.zones_button)
    hands.idle()


def show_map(hands):
    hands.window.shared_view.show_page(SharedViewPage.MAP)
    view = hands.window.shared_view.map_page()
    hands.until(view.is_complete)
    hands.until(lambda: view._site is not None and view._model is hands.context.document.site)
    return view


@pytest.mark.long
def test_zones_are_added_seen_authorised_and_taken_away(hands, zones):
    add(hands, zones)
    assert [source.file for source in hands.site.zones] == ["zones.json"]
    assert hands.context.selection == Item(ItemKind.ZONE_FILE, "zones.json")
    assert "ED-269" in hands.tab.detail.properties.page().text()
    assert len(no_fly_volumes(hands.context.document.site)) == 2
    view = show_map(hands)
    assert [zone.restriction for zone in view._site.zones] == [Restriction.PROHIBITED, Restriction.AUTHORISATION]
    assert [(is_kept, text) for _, is_kept, text in view.legend()] == [
        (True, "flights prohibited"),
        (True, "flights with an authorisation only"),
    ]
    ring = view._viewport.screen(view._site.zones[0].rings[0])
    middle = ring.mean(axis=0)
    QTest.mouseMove(view, QPoint(*(round(value) for value in middle)))
    hands.until(lambda: "School: flights prohibited (SENSITIVE)" in view.toolTip())
    QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(*(round(value) for value in middle)))
    hands.until(lambda: hands.context.selection == SCHOOL)
    page = hands.tab.detail.properties.page()
    assert "plans keep out of it" in page.text()
    assert hands.tab.left.tree.value() == SCHOOL
    type_into(page.reference_box(), "No. 4711")
    QTest.keyClick(page.reference_box(), Qt.Key.Key_Return)
    hands.idle()
    assert hands.site.zones[0].permitted == {"SCHOOL": "No. 4711"}
    assert len(no_fly_volumes(hands.context.document.site)) == 1
    assert "permitted by 'No. 4711'" in page.text()
    assert next((is_kept, text) for _, is_kept, text in show_map(hands).legend()) == (
        False,
        "flights prohibited: not kept out of",
    )
    hands.undo()
    assert not hands.site.zones[0].permitted
    hands.context.select(Item(ItemKind.ZONE_FILE, "zones.json"))
    from PySide6.QtWidgets import QPushButton

    page = hands.tab.detail.properties.page()
    click_on(hands.window, next(each for each in page.findChildren(QPushButton) if each.text() == "Remove this file"))
    hands.idle()
    assert not hands.site.zones
    assert hands.context.selection == Item(ItemKind.BUILDING)


@pytest.mark.slow
def test_who_says_that_an_unsure_zone_is_not_here_opens_nothing_that_can_be_read_of_it(hands, tmp_path):
    ring = square(150.0, -40.0, 15.0, ORIGIN)
    lost = ed269_feature(ed269_volume(polygon([*ring[:4], [None, 47.0], ring[4]])), identifier="SCHOOL")
    sure = ed269_feature(ed269_volume(polygon(square(-60.0, 0.0, 5.0, ORIGIN))), identifier="HELI")
    path = tmp_path / "zones.json"
    path.write_bytes(ed269(lost, sure))
    add(hands, path)
    shown = hands.tab.detail.findings._list.item(0).text()
    assert "“Not here, according to”" in shown
    assert "--" not in shown
    hands.context.select(HELIPORT)
    hands.idle()
    assert not hands.tab.detail.properties.page().answer_box().isVisible()
    hands.context.select(SCHOOL)
    hands.idle()
    page = hands.tab.detail.properties.page()
    type_into(page.answer_box(), "Town, by phone")
    QTest.keyClick(page.answer_box(), Qt.Key.Key_Return)
    hands.idle()
    assert hands.site.zones[0].not_here == {"SCHOOL": "Town, by phone"}
    assert len(no_fly_volumes(hands.context.document.site)) == 2
    assert "plans keep out of it; what cannot be read of it is not here according to 'Town, by phone'" in page.text()
    assert not any(finding.code == "zone-question" for finding in hands.tab.detail.findings.findings())
    hands.undo()
    assert not hands.site.zones[0].not_here


def test_a_file_that_cannot_be_read_is_refused_in_words_and_changes_nothing(hands, zones):
    zones.write_bytes(zones.read_bytes()[:-30])
    add(hands, zones)
    assert not hands.site.zones
    assert any(message.severity is Severity.ERROR and "not valid JSON" in message.text for message in hands.messages), (
        hands.messages
    )


@pytest.mark.slow
def test_a_home_in_a_zone_is_told_by_the_site_s_check(hands, tmp_path):
    path = tmp_path / "all.json"
    path.write_bytes(ed269(ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 90.0, ORIGIN))))))
    add(hands, path)
    found = hands.tab.detail.findings.findings()
    assert next(finding.code for finding in found) == "home-unusable"
    assert "geo-zone 'School'" in found[0].message
    shown = hands.tab.detail.findings._list.item(0).text()
    assert "“Authorisation”" in shown
    assert "--" not in shown


@pytest.mark.slow
def test_the_planned_time_decides_which_zones_the_next_plan_keeps_out_of(hands, tmp_path):
    night = [{"permanent": "NO", "schedule": [{"day": ["ANY"], "startTime": "20:00Z", "endTime": "23:59Z"}]}]
    volume = ed269_volume(polygon(square(0.0, 0.0, 90.0, ORIGIN)))
    path = tmp_path / "night.json"
    path.write_bytes(ed269(ed269_feature(volume, applicability=night)))
    add(hands, path)
    assert len(no_fly_volumes(hands.context.document.site)) == 1
    hands.window.show_tab("mission")
    day = hands.window.tab("mission").findings.day_box()
    click_on(hands.window, day.has_time, QPoint(8, day.has_time.height() // 2))
    for at, n_kept in ((datetime(2026, 11, 28, 12, tzinfo=UTC), 0), (datetime(2026, 11, 28, 19, tzinfo=UTC), 1)):
        day.when.setDateTime(QDateTime.fromSecsSinceEpoch(round(at.timestamp())))
        hands.until(lambda n=n_kept: len(no_fly_volumes(hands.context.document.site)) == n)
    day.when.setDateTime(QDateTime.fromSecsSinceEpoch(round(datetime(2026, 11, 28, 12, tzinfo=UTC).timestamp())))
    hands.undo()
    hands.context.session.redo()
    hands.until(lambda: len(no_fly_volumes(hands.context.document.site)) == 0)
    assert hands.site.zones
    click_on(hands.window, day.has_time, QPoint(8, day.has_time.height() // 2))
    hands.until(lambda: len(no_fly_volumes(hands.context.document.site)) == 1)
    hands.window.show_tab("site")
    hands.idle()


@pytest.mark.long
def test_zones_stand_in_the_scene_and_say_beside_the_pointer_what_they_ask_for(hands, tmp_path):
    ring = square(70.0, -40.0, 12.0, ORIGIN)
    school = ed269_feature(ed269_volume(polygon(ring), lower=10, upper=60), message="Ask the head of the school.")
    shelf = ed269_volume(polygon(square(0.0, 0.0, 4000.0, ORIGIN)), lower=0, upper=3000)
    wide = ed269_feature(shelf, identifier="CTR", name="Control zone", restriction="CONDITIONAL")
    path = tmp_path / "zones.json"
    path.write_bytes(ed269(school, wide))
    add(hands, path)
    school_item, wide_item = Item(ItemKind.ZONE, "zones.json/Z1"), Item(ItemKind.ZONE, "zones.json/CTR")
    scene = hands.scene
    by_item = {zone.item: zone for zone in scene._site.zones}
    assert set(by_item) == {school_item, wide_item}
    heights = by_item[school_item].triangles_enu_m()[..., 2]
    assert (heights.min(), heights.max()) == pytest.approx((10.0, 60.0), abs=0.5)
    # The other goes on beside and above what is drawn, so it has no lid.
    walls = by_item[wide_item].triangles_enu_m()
    assert np.ptp(walls[..., 2], axis=1).max() > 0.0
    assert not (np.ptp(walls[..., 2], axis=1) == 0.0).any()
    assert {"School", "Control zone"} <= {label.text for label in scene._site.labels}

    scene.set_orbit(scene.orbit().zoomed(0.1))
    scene._pick_index()
    view = scene.orbit().pinhole(scene.canvas().width(), scene.canvas().height())
    (x, y), *_ = view.project(np.array([[70.0, -40.0, 59.0]]))[0]
    QTest.mouseMove(scene.canvas(), QPoint(round(x) + 3, round(y) + 3))
    QTest.mouseMove(scene.canvas(), QPoint(round(x), round(y)))
    hands.until(lambda: scene._hover == school_item)
    tip = scene._tip_text.splitlines()
    assert tip[0] == "School: flights prohibited (SENSITIVE), 10 m AGL - 60 m AGL"
    assert tip[1].startswith("from 1")
    assert tip[2:] == ["Ask the head of the school.", "plans keep out of it"]
    hands.click((70.0, -40.0, 59.0))
    hands.until(lambda: hands.context.selection == school_item)

    # What stands in a zone is pointed at, not the zone.
    panel = hands.site.panels[0]
    hands.click(np.mean(panel.corners_enu_m, axis=0))
    hands.until(lambda: hands.context.selection == Item(ItemKind.PANEL, panel.id))
    titles = scene._layer_titles()
    assert titles[Layer.ZONES] == "Geo-zones"
    scene.set_layer_visible(Layer.ZONES, False)
    QTest.mouseMove(scene.canvas(), QPoint(round(x) + 3, round(y) + 3))
    QTest.mouseMove(scene.canvas(), QPoint(round(x), round(y)))
    hands.until(lambda: scene._hover != school_item)
    hands.undo()
    assert scene._site.zones == ()
