"""The waypoint table: a sound Qt model, filters, references, units, and selection without loops."""

import time
from dataclasses import replace

import pytest

from groundstation.services.mission.waypoints import HeightShown, waypoint_rows
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem
from tests.missions.plans import example_plan, make_plan, ring


@pytest.fixture
def model(application):
    from PySide6.QtTest import QAbstractItemModelTester

    from groundstation.gui.widgets.waypoint_table import WaypointModel

    model = WaypointModel()
    tester = QAbstractItemModelTester(model, QAbstractItemModelTester.FailureReportingMode.Fatal)
    yield model
    tester.deleteLater()


@pytest.fixture
def table(application):
    from groundstation.gui.widgets.waypoint_table import WaypointTable

    table = WaypointTable()
    table.resize(1000, 300)
    table.show()
    yield table
    table.close()


def texts(model, row):
    return [model.index(row, column).data() for column in range(model.columnCount())]


def shown(table):
    proxy = table.view().model()
    return [proxy.index(row, 2).data() for row in range(proxy.rowCount())]


@pytest.mark.slow
def test_model_keeps_qts_rules_through_resets_units_and_empty_plans(model):
    from groundstation.gui.widgets.waypoint_table import PositionShown

    plan = example_plan()
    for rows in (waypoint_rows(plan), (), waypoint_rows(replace(plan, sorties=())), waypoint_rows(plan)):
        model.set_rows(rows)
        assert model.rowCount() == len(rows)
        for units in UnitSystem:
            model.set_units(units)
            for position in PositionShown:
                for height in HeightShown:
                    model.set_shown(position, height)
        model.set_panels_covered({"v0001": 7})


def test_a_thousand_views_are_shown_in_a_blink(table):
    rows = waypoint_rows(make_plan([(ring(500), {}), (ring(500, 32.0, 500), {})]))
    started = time.thread_time()  # whatever else the machine does
    table.set_rows(rows)
    assert len(shown(table)) == 1008
    assert time.thread_time() - started < 0.1


def test_cells_say_what_the_row_holds(model):
    rows = waypoint_rows(example_plan())
    model.set_rows(rows, {"v0000": 12})
    row = next(i for i, r in enumerate(rows) if r.viewpoint and r.viewpoint.id == "v0000")
    cells = texts(model, row)
    assert cells[:6] == ["1", "2", "v0000", "0.0", "25.0", "22.0"]
    assert cells[6] == "20.5"
    assert cells[7:9] == ["-180.0", "-30.0"]
    assert cells[11:] == ["12", ""]
    assert texts(model, 0)[2] == ""
    assert texts(model, 0)[10] == "0:00"


def test_feet_are_feet(model):
    rows = waypoint_rows(example_plan())
    model.set_rows(rows)
    metric = float(texts(model, 2)[5])
    model.set_units(UnitSystem.IMPERIAL)
    assert float(texts(model, 2)[5]) == pytest.approx(metric / 0.3048, abs=0.06)
    assert "[ft]" in model.headerData(5, _horizontal())


def test_heights_change_with_their_reference_and_say_so(model):
    from groundstation.gui.widgets.waypoint_table import PositionShown

    rows = waypoint_rows(example_plan())
    model.set_rows(rows)
    titles, values = [], []
    for height in HeightShown:
        model.set_shown(PositionShown.GEODETIC, height)
        titles.append(model.headerData(5, _horizontal()))
        values.append(float(texts(model, 2)[5]))
    assert len(set(titles)) == 3
    # Hong Kong: the ellipsoid is 62 m below the site's zero and 2 m above the geoid.
    assert values[2] - values[0] == pytest.approx(62.0, abs=0.2)
    assert 1.0 < values[1] - values[2] < 3.0
    assert texts(model, 2)[3].startswith("22.337")


def _horizontal():
    from PySide6.QtCore import Qt

    return Qt.Orientation.Horizontal


def test_sorting_goes_by_value_not_by_text(table):
    from PySide6.QtCore import Qt

    from groundstation.gui.widgets.waypoint_table import SORT_ROLE, Column

    table.set_rows(waypoint_rows(example_plan()))
    proxy = table.view().model()
    for column in Column:
        table.view().sortByColumn(column, Qt.SortOrder.AscendingOrder)
        values = [proxy.index(row, column).data(SORT_ROLE) for row in range(proxy.rowCount())]
        assert values == sorted(values), column
    table.view().sortByColumn(-1, Qt.SortOrder.AscendingOrder)
    assert [i for i in shown(table) if i] == [f"v{n:04d}" for n in range(10)]


def test_filter_by_sortie_and_photos(table):
    rows = waypoint_rows(example_plan())
    table.set_rows(rows)
    assert len(shown(table)) == len(rows)
    table._photos_only.setChecked(True)
    assert len(shown(table)) == 10
    table._sortie.setCurrentIndex(2)
    assert shown(table) == ["v0006", "v0007", "v0008", "v0009"]
    table.set_rows(waypoint_rows(make_plan([(ring(3), {})])))
    assert shown(table) == ["v0000", "v0001", "v0002"]


def test_row_and_selection_follow_each_other_without_loops(table):
    table.set_rows(waypoint_rows(example_plan()))
    heard = []
    table.picked.connect(heard.append)
    item = Item(ItemKind.VIEWPOINT, "v0007")
    table.set_selection(item)
    table.set_selection(item)
    assert heard == []
    current = table.view().selectionModel().currentIndex()
    assert table.view().model().index(current.row(), 2).data() == "v0007"
    assert table.view().selectionModel().isRowSelected(current.row())
    table.view().selectRow(2)
    assert heard == [Item(ItemKind.VIEWPOINT, "v0000")]
    table.set_selection(None)
    assert not table.view().selectionModel().hasSelection()
    assert len(heard) == 1


def test_turning_points_stand_for_their_leg_and_take_off_for_home(table):
    table.set_rows(waypoint_rows(example_plan()))
    heard = []
    table.picked.connect(heard.append)
    table.view().selectRow(1)
    table.view().selectRow(0)
    assert heard == [Item(ItemKind.LEG, "1/1"), Item(ItemKind.HOME)]


def test_selecting_what_is_filtered_away_selects_nothing(table):
    table.set_rows(waypoint_rows(example_plan()))
    table._sortie.setCurrentIndex(1)
    table.set_selection(Item(ItemKind.VIEWPOINT, "v0007"))
    assert not table.view().selectionModel().hasSelection()
    table.set_selection(Item(ItemKind.PANEL, "A-0000"))
    assert not table.view().selectionModel().hasSelection()


def test_another_plan_does_not_speak_for_the_user(table):
    table.set_rows(waypoint_rows(example_plan()))
    table.view().selectRow(4)
    heard = []
    table.picked.connect(heard.append)
    table.set_rows(waypoint_rows(make_plan([(ring(3), {})])))
    table.set_rows(())
    assert heard == []


def moved(plan, viewpoint_id):
    """The plan with one viewpoint, and its vertex of the path, a metre further up."""

    def up(place):
        return (place[0], place[1], place[2] + 1.0)

    old = next(view for view in plan.viewpoints if view.id == viewpoint_id)
    views = [replace(view, position_enu_m=up(old.position_enu_m)) if view is old else view for view in plan.viewpoints]
    sorties = [
        replace(
            sortie,
            path_enu_m=tuple(up(place) if place == old.position_enu_m else place for place in sortie.path_enu_m),
        )
        for sortie in plan.sorties
    ]
    return replace(plan, viewpoints=tuple(views), sorties=tuple(sorties))


def test_an_edit_changes_cells_and_leaves_filter_order_and_selection(table):
    from PySide6.QtCore import Qt

    from groundstation.gui.widgets.waypoint_table import Column

    plan = example_plan()
    table.set_rows(waypoint_rows(plan))
    table._photos_only.setChecked(True)
    table.view().sortByColumn(Column.VIEWPOINT, Qt.SortOrder.DescendingOrder)
    table.set_selection(Item(ItemKind.VIEWPOINT, "v0003"))
    resets, changed = [], []
    table.model().modelReset.connect(lambda: resets.append(1))
    table.model().dataChanged.connect(lambda first, last: changed.append((first.row(), last.row())))
    edited = waypoint_rows(moved(plan, "v0003"))
    table.set_rows(edited)
    assert not resets
    at = next(number for number, row in enumerate(edited) if row.viewpoint and row.viewpoint.id == "v0003")
    assert len(changed) == 1
    assert changed[0][0] == at, "what comes before is as it was"
    assert texts(table.model(), at)[5] == f"{edited[at].position_enu_m[2]:.1f}"
    assert shown(table) == [f"v{number:04d}" for number in range(9, -1, -1)]
    current = table.view().selectionModel().currentIndex()
    assert table.view().model().index(current.row(), 2).data() == "v0003"
    table.set_rows(edited)
    assert len(changed) == 1, "nothing changed"


def test_only_the_cells_of_views_that_cover_more_or_less_change(model):
    model.set_rows(waypoint_rows(example_plan()), {f"v{number:04d}": number for number in range(10)})
    changed = []
    model.dataChanged.connect(lambda first, last: changed.append((first.row(), first.column(), last.row())))
    model.set_panels_covered({f"v{number:04d}": 99 if number == 4 else number for number in range(10)})
    (row, column, last), *others = changed
    assert not others
    assert row == last
    assert texts(model, row)[2] == "v0004"
    assert texts(model, row)[column] == "99"


def test_as_many_other_waypoints_are_other_waypoints(table):
    plan = make_plan([(ring(4), {}), (ring(3, 30.0, 4), {})])
    table.set_rows(waypoint_rows(plan))
    table._sortie.setCurrentIndex(2)
    assert shown(table) == ["", "", "v0004", "v0005", "v0006", "", ""]
    table.set_rows(waypoint_rows(make_plan([(ring(3), {}), (ring(4, 30.0, 3), {})])))
    assert shown(table) == ["", "", "v0003", "v0004", "v0005", "v0006", "", ""]


def test_what_the_choosers_say_is_what_the_columns_show(table):
    table.set_rows(waypoint_rows(example_plan()))
    header = table.model()
    for position, first in ((1, "Latitude [°]"), (0, "East [m]")):
        table._position.setCurrentIndex(position)
        assert header.headerData(3, _horizontal()) == first
    for height, title in ((2, "Above ellipsoid [m]"), (1, "Above sea (EGM96) [m]"), (0, "Up, local [m]")):
        table._height.setCurrentIndex(height)
        assert header.headerData(5, _horizontal()) == title
