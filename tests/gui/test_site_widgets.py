"""Widgets of the Site tab by themselves: the tree's model, editors that give back what they were given, the forms."""

from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import (
    add_box,
    add_rally_point,
    add_zone,
    height_above_sea_m,
    move_home,
    rename_item,
)
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity
from planning.geo.frames import Origin
from planning.site.bundled import SCENES
from planning.site.importing.options import ImportOptions, PanelGrid
from planning.site.importing.source import BuildingChoice

COURT = SCENES["court"]()
METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL


def heard(signal):
    """A list that grows with everything a signal of one value says."""
    values = []
    signal.connect(values.append)
    return values


@pytest.fixture
def tree_model(application):
    from PySide6.QtTest import QAbstractItemModelTester

    from groundstation.gui.site.site_tree import SiteTreeModel

    model = SiteTreeModel()
    tester = QAbstractItemModelTester(model, QAbstractItemModelTester.FailureReportingMode.Fatal)
    yield model
    tester.deleteLater()


def rows(model, parent=None):
    """Texts of all rows, nested."""
    from PySide6.QtCore import QModelIndex

    parent = QModelIndex() if parent is None else parent
    found = []
    for row in range(model.rowCount(parent)):
        index = model.index(row, 0, parent)
        found.append((model.data(index), model.data(model.index(row, 1, parent)), rows(model, index)))
    return found


def test_tree_lists_everything_on_the_site_and_survives_the_model_tester(tree_model):
    tree_model.set_site(COURT, METRIC)
    site, facades, obstacles, zones, rally, geo_zones, airspace, home = rows(tree_model)
    assert site[:2] == ("court", "panels: 294")
    assert [row[:2] for row in facades[2]] == [("A", "panels: 126"), ("B", "panels: 168")]
    assert len(facades[2][1][2]) == 168
    assert obstacles[1] == zones[1] == rally[1] == geo_zones[1] == "0"
    assert airspace[1] == "145 × 135 × 52 m"
    assert home == ("Home", "0.0 m", [])
    model, _ = add_box(COURT, (0.0, -60.0, 0.0), (1.0, -58.0, 3.0))
    model, _ = add_zone(model, [(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)])
    tree_model.set_site(model, IMPERIAL)
    assert rows(tree_model)[2][2] == [("box-1", "3 × 7 × 10 ft", [])]
    assert rows(tree_model)[3][2][0][:2] == ("no-fly-1", "33 × 66 × 180 ft")
    tree_model.set_site(add_rally_point(COURT, (15.0, -50.0, 1.0))[0], METRIC)
    assert rows(tree_model)[4][1:] == ("1", [("rally-1", "1.0 m", [])])
    tree_model.set_site(None, METRIC)
    assert rows(tree_model) == []


def test_every_item_finds_its_row_and_every_row_its_item(tree_model):
    tree_model.set_site(COURT, METRIC)
    for item in (Item(ItemKind.BUILDING), Item(ItemKind.FACADE, "B"), Item(ItemKind.PANEL, "B-0167")):
        index = tree_model.index_of(item)
        assert tree_model.item(index) == item
        assert tree_model.item(index.siblingAtColumn(1)) == item
    assert not tree_model.index_of(Item(ItemKind.FACADE, "Z")).isValid()
    assert not tree_model.index_of(None).isValid()


def test_edits_that_change_texts_only_keep_the_rows(tree_model):
    tree_model.set_site(COURT, METRIC)
    resets, changes = [], []
    tree_model.modelReset.connect(lambda: resets.append(1))
    tree_model.dataChanged.connect(lambda *_: changes.append(1))
    tree_model.set_site(move_home(COURT, (15.0, -50.0, 2.0)), METRIC)
    assert (len(resets), len(changes)) == (0, 1)
    tree_model.set_site(rename_item(COURT, Item(ItemKind.FACADE, "A"), "West"), METRIC)
    assert len(resets) == 1


def test_tree_keeps_selection_and_folding_over_an_edit_and_delete_asks(application):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest

    from groundstation.gui.site.site_tree import SiteTree

    tree = SiteTree()
    chosen, removed = heard(tree.valueChanged), heard(tree.removeRequested)
    tree.set_site(COURT, METRIC)
    tree.setValue(Item(ItemKind.PANEL, "B-0003"))
    assert tree.isExpanded(tree.model().index_of(Item(ItemKind.FACADE, "B")))
    edited, _ = add_box(COURT, (0.0, -60.0, 0.0), (1.0, -58.0, 3.0))
    tree.set_site(edited, METRIC)
    assert tree.value() == Item(ItemKind.PANEL, "B-0003")
    assert tree.isExpanded(tree.model().index_of(Item(ItemKind.FACADE, "B")))
    assert chosen == [], "only the user's own choices are told"
    QTest.keyClick(tree, Qt.Key.Key_Delete)
    assert removed == [Item(ItemKind.PANEL, "B-0003")]
    QTest.keyClick(tree, Qt.Key.Key_End)
    assert chosen[-1] == Item(ItemKind.HOME)
    QTest.keyClick(tree, Qt.Key.Key_Delete)
    assert len(removed) == 1, "home cannot be removed"
    texts = [action.text() for action in tree.menu(Item(ItemKind.FACADE, "B")).actions()]
    assert texts == ["Show it", "Rename", "Turn to the other side", "Delete"]
    assert [action.text() for action in tree.menu(Item(ItemKind.HOME)).actions()] == ["Show it"]
    tree.deleteLater()


@pytest.mark.parametrize("units", [METRIC, IMPERIAL])
def test_editors_give_back_what_they_were_given_and_tell_only_the_users_edits(application, units):
    from groundstation.gui.widgets.value_boxes import ExtentBox, PointBox, PolygonBox

    point, extent, polygon = PointBox(units), ExtentBox(units), PolygonBox(units)
    cases = [
        (point, (1.2345, -6.789, 0.001)),
        (extent, ((-1.0, -2.345678, 0.0), (4.0, 5.0, 6.789))),
        (polygon, ((0.1234, 1.0), (10.0, 1.5), (5.55, 9.9999), (0.0, 5.0))),
    ]
    for box, value in cases:
        told = heard(box.valueChanged)
        box.setValue(value)
        box.set_units(METRIC)
        box.set_units(units)
        assert box.value() == value
        assert told == []
    told = heard(point.valueChanged)
    point.boxes()[1].box().setValue(10.0)
    assert told == [(1.2345, 10.0 if units is METRIC else pytest.approx(3.048), 0.001)]


def test_corners_of_a_polygon_are_added_half_way_and_removed_down_to_three(application):
    from groundstation.gui.widgets.value_boxes import PolygonBox

    box = PolygonBox(METRIC)
    box.setValue(((0.0, 0.0), (10.0, 0.0), (10.0, 10.0)))
    told = heard(box.valueChanged)
    box.add_corner(2)
    assert told[-1] == ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 5.0))
    box.remove_corner(0)
    assert told[-1] == ((10.0, 0.0), (10.0, 10.0), (5.0, 5.0))


def test_heights_of_the_origin_follow_each_other_and_impossible_ones_are_told(application):
    from groundstation.gui.site.pages import OriginBox

    zurich = Origin(47.376912345678, 8.541712345678, 457.0)
    box = OriginBox(METRIC)
    box.setValue(zurich)
    assert box.value() == zurich
    lat, _lon, ellipsoid, sea = box.boxes()
    told = heard(box.valueChanged)
    sea.box().setValue(410.0)
    assert told[-1].lat_deg == zurich.lat_deg, "degrees that were not edited stay exact"
    assert height_above_sea_m(told[-1]) == pytest.approx(410.0, abs=1e-3)
    assert ellipsoid.value() == told[-1].ellipsoid_height_m
    assert told[-1].ellipsoid_height_m - 410.0 == pytest.approx(47.3, abs=1.0)  # EGM96 at Zurich
    lat.setValue(-10.0)
    assert told[-1].lat_deg == -10.0
    assert sea.value() == pytest.approx(height_above_sea_m(told[-1]))
    n_told = len(told)
    ellipsoid.box().setValue(10_050.0)
    assert len(told) == n_told
    assert "expected -1000 to 10000" in box._error.text()


def test_grid_form_gives_back_its_wish_and_reckons_the_panels_size(application):
    from groundstation.gui.site.grid_form import GridForm, GridRequest
    from planning.site.importing.panel_grid import GridField

    form = GridForm(METRIC)
    assert form.value() == GridRequest()
    request = GridRequest(((0.0, 0.0, 0.0), (36.0, 0.0, 0.0), (0.0, 0.0, 42.0)), 14, 20, 0.1, 1.5)
    form.setValue(request)
    assert form.value() == request
    assert "Panels: 280, each 1.7 m × 2.9 m" in form._size.text()
    told = heard(form.valueChanged)
    form._rows.setValue(7)
    assert told == [replace(request, n_rows=7)]
    form.show_state("good", is_good=True)
    assert form.can_accept()
    form.show_error(GridField.GAP, "no glass")
    assert not form.can_accept()
    assert form._error.text() == "Gap: no glass"


@pytest.mark.parametrize("name", ["a.ifc", "a.gml", "a.json", "a.obj"])
def test_import_form_gives_back_its_options(application, name):
    from groundstation.gui.site.site_opener import ImportForm

    form = ImportForm(Path(name), METRIC)
    assert form.value() == ImportOptions()
    form.set_choices((BuildingChoice("b1", "Town hall", 3, (10.0, 20.0, 30.0)), BuildingChoice("b2", "", 0, (1, 2, 3))))
    grid = PanelGrid(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)), 2, 3)
    cases = [
        ImportOptions(name="x", origin=Origin(1.0, 2.0, 3.0), panel_grids=(grid,), grid_tolerance_m=0.5),
        ImportOptions(crs="EPSG:2056", axis_order="yx", height_reference="ellipsoid", building="b2"),
        ImportOptions(unit="mm", up="y", airspace_margin_m=75.0, crs="EPSG:25832"),
    ]
    for options in cases:
        form.setValue(options)
        assert form.value() == options


def test_place_of_a_mesh_is_never_guessed(application):
    from groundstation.gui.site.site_opener import ImportForm

    form = ImportForm(Path("tower.obj"), METRIC)
    assert form.value().origin is None
    form.origin_box().boxes()[0].setValue(47.0)
    assert form.value().origin == Origin(47.0, 0.0, 0.0)


def test_findings_name_their_place(application):
    from groundstation.gui.site.site_panels import FindingsList, item_of

    shown = FindingsList()
    home = Finding(Severity.ERROR, "home-unusable", "move home", "home")
    facade = Finding(Severity.WARNING, "facade-out-of-reach", "turn it", "facade/A/1")
    shown.set_findings((home, facade))
    chosen = heard(shown.chosen)
    for row in range(2):
        shown._list.itemClicked.emit(shown._list.item(row))
    assert chosen == [Item(ItemKind.HOME), Item(ItemKind.FACADE, "A/1")]
    assert item_of(replace(home, place="")) is None
    shown.set_findings(())
    assert shown._title.text() == "All checks passed: home, airspace, facades."
