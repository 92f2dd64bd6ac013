"""The window by keyboard: Tab goes through it as it is read, and stops only where keys do something."""

from pathlib import Path

import pytest

from groundstation.services.project.document import Document
from planning.site.bundled import SCENES
from tests.gui.driving import close_controller, turn_until


@pytest.fixture
def form(application):
    """Two columns made from right to left, as Qt's own order has them."""
    from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

    window = QWidget()
    layout = QHBoxLayout(window)
    columns = {}
    for name in ("right", "left"):
        column = columns[name] = QWidget()
        rows = QVBoxLayout(column)
        for number in (1, 2):
            edit = QLineEdit()
            edit.setObjectName(f"{name} {number}")
            rows.addWidget(edit)
        layout.addWidget(column)
    outside = QPushButton()
    outside.setObjectName("outside")
    layout.addWidget(outside)
    window.show()
    application.processEvents()
    yield window, columns["left"], columns["right"]
    window.close()


def names_from(regions, start, n, *, forward=True):
    from groundstation.gui.widgets.tab_order import next_in_order

    found, widget = [], start
    for _ in range(n):
        widget = next_in_order(regions, widget, forward=forward)
        found.append(widget.objectName())
    return found


def test_tab_goes_through_the_regions_in_their_order_and_around(form):
    _window, left, right = form
    assert names_from((left, right), None, 5) == ["left 1", "left 2", "right 1", "right 2", "left 1"]


def test_backtab_goes_the_same_way_back(form):
    _window, left, right = form
    assert names_from((left, right), None, 5, forward=False) == ["right 2", "right 1", "left 2", "left 1", "right 2"]


def test_what_is_hidden_disabled_or_not_for_tab_is_passed_over(form):
    from PySide6.QtCore import Qt
    from PySide6.QtWidgets import QLineEdit

    window, left, right = form
    window.findChild(QLineEdit, "left 2").hide()
    window.findChild(QLineEdit, "right 1").setEnabled(False)
    window.findChild(QLineEdit, "right 2").setFocusPolicy(Qt.FocusPolicy.ClickFocus)
    assert names_from((left, right), None, 2) == ["left 1", "left 1"]


def test_from_outside_all_regions_it_begins_anew_and_without_stops_there_is_none(form):
    from PySide6.QtWidgets import QPushButton

    from groundstation.gui.widgets.tab_order import first_in, next_in_order

    window, left, right = form
    outside = window.findChild(QPushButton, "outside")
    assert names_from((left, right), outside, 1) == ["left 1"]
    left.setEnabled(False)
    assert next_in_order((left,), None, forward=True) is None
    assert first_in(left) is None
    assert first_in(right).objectName() == "right 1"


def test_order_is_as_it_is_read_whatever_was_made_first(form):
    window, _left, _right = form
    assert names_from((window,), None, 6) == ["right 1", "right 2", "left 1", "left 2", "outside", "right 1"]


def test_from_a_frame_it_goes_on_beside_it_and_from_what_was_hidden_beside_what_that_was_in(form):
    from PySide6.QtWidgets import QLineEdit

    _window, left, right = form
    assert names_from((right, left), left, 1) == ["left 1"]
    assert names_from((right, left), left, 1, forward=False) == ["right 2"]
    edit = right.findChild(QLineEdit, "right 2")
    edit.hide()
    assert names_from((right, left), edit, 1) == ["right 1"]


@pytest.mark.parametrize("forward", [True, False])
def test_what_goes_takes_nothing_along_that_tab_came_to_after_it(form, application, forward):
    """PySide holds what its own way through the window gives for parts of what they were asked of."""
    from PySide6.QtCore import QEvent
    from PySide6.QtWidgets import QLineEdit
    from shiboken6 import isValid

    window, left, right = form
    rows = [window.layout().itemAt(number) for number in range(3)]
    names_from((left, right), None, 5, forward=forward)
    gone = window.findChild(QLineEdit, "left 1")
    names_from((left, right), gone, 2, forward=forward)
    gone.deleteLater()
    application.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    assert not isValid(gone)
    assert all(isValid(row) for row in rows)


@pytest.fixture(scope="module")
def window(application, worker, tmp_path_factory):
    """The window with a site, of which tests choose the tab only."""
    from groundstation.gui.window.project_controller import ProjectController

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.mktemp("config")))
        controller = ProjectController(application, worker=worker)
        controller.show()
        window = controller.window
        window.setGeometry(0, 0, 1280, 720)
        controller.context.session.open(Document(SCENES["single-panel"]()), None)
        turn_until(application, lambda: window.shared_view.scene() is not None)
        yield window
        close_controller(controller)


@pytest.mark.slow
@pytest.mark.parametrize("tab", ["site", "plan", "mission"])
def test_tab_reaches_every_region_once_around_and_stops_at_no_frame(application, window, tab):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest
    from PySide6.QtWidgets import QScrollArea

    window.show_tab(tab)
    application.processEvents()
    made = window.tab(tab)
    first = window.focusWidget()
    assert made.left.isAncestorOf(first), "a tab that is shown takes the keyboard"
    stops = [first]
    for _ in range(100):
        QTest.keyClick(window.windowHandle(), Qt.Key.Key_Tab)
        if window.focusWidget() is first:
            break
        stops.append(window.focusWidget())
    assert window.focusWidget() is first, "Tab comes around"
    assert len(set(map(id, stops))) == len(stops), "no widget holds Tab back"
    assert not any(isinstance(stop, QScrollArea) for stop in stops)
    regions = [made.left, window.shared_view, made.right, made.bottom, window.messages]
    reached = [
        next((number for number, region in enumerate(regions) if region and region.isAncestorOf(stop)), None)
        for stop in stops
    ]
    inside = [number for number in reached if number is not None]
    assert inside == sorted(inside)
    assert set(inside) == {number for number, region in enumerate(regions) if region is not None and region.isVisible()}


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("kind", "reason", "is_shown"),
    [
        ("FocusIn", "TabFocusReason", True),
        ("FocusIn", "BacktabFocusReason", True),
        ("FocusIn", "MouseFocusReason", False),
        ("FocusOut", "TabFocusReason", False),
    ],
)
def test_the_view_is_framed_while_keys_go_to_it_and_keys_brought_them(application, window, kind, reason, is_shown):
    from PySide6.QtCore import QEvent, Qt
    from PySide6.QtGui import QFocusEvent

    scene = window.shared_view.scene()
    scene._overlay.set_frame(not is_shown)
    event = QFocusEvent(getattr(QEvent.Type, kind), getattr(Qt.FocusReason, reason))
    application.sendEvent(scene.canvas(), event)
    assert scene._overlay._has_frame is is_shown


def test_every_table_lets_tab_pass(application):
    """Tables keep Tab for themselves unless told otherwise."""
    import groundstation.gui

    for path in Path(groundstation.gui.__file__).parent.rglob("*.py"):
        source = path.read_text("utf-8")
        makes_tables = source.count("QTableView(") + source.count("QTableWidget(")
        assert source.count("setTabKeyNavigation(False)") >= makes_tables, path


def test_a_frame_that_has_the_keyboard_is_marked_and_nothing_else_is(application, form):
    from PySide6.QtWidgets import QLineEdit

    from groundstation.gui.widgets.tab_order import FocusFrame, set_enabled

    window, left, _right = form
    mark = FocusFrame(window)
    window.activateWindow()
    turn_until(application, window.isActiveWindow)
    assert not mark.isVisible()
    edit = left.findChild(QLineEdit)
    edit.setFocus()
    assert not mark.isVisible(), "a widget shows by itself that it has the keyboard"
    set_enabled(edit, False)
    assert window.focusWidget() is left
    assert mark.isVisible()
    assert mark.widget() is left
    left.findChildren(QLineEdit)[1].setFocus()
    assert not mark.isVisible()
