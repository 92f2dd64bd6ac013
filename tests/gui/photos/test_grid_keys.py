"""Correcting a grid without a pointer: lines and panels are chosen and changed with keys, or with large buttons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.services.photos.grid_edits import set_panel
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.record import InclinedLine


@pytest.fixture
def keyed(found):
    """The view with the keyboard."""
    found.use_tool("MOVE")
    found.controller.window.activateWindow()
    found.view.setFocus()
    found.application.processEvents()
    return found


def positions(page, axis="columns"):
    return [line.position_px for line in getattr(page.grid, axis)]


@pytest.mark.slow
def test_tab_goes_through_all_lines_and_then_leaves_the_picture(keyed):
    n_lines = len(keyed.grid.columns) + len(keyed.grid.rows)
    passed = []
    for _ in range(n_lines):
        keyed.keys("Tab")
        passed.append(keyed.view.chosen_line())
    assert passed[0] == ("column", 0)
    assert passed[-1] == ("row", len(keyed.grid.rows) - 1)
    assert len(set(passed)) == n_lines
    assert keyed.controller.window.focusWidget() is keyed.view
    keyed.keys("Tab")
    assert keyed.view.chosen_line() is None
    assert keyed.controller.window.focusWidget() is not keyed.view


@pytest.mark.slow
def test_shift_and_tab_goes_backwards(keyed):
    QTest.keyClick(keyed.view, Qt.Key.Key_Backtab, Qt.KeyboardModifier.ShiftModifier)
    assert keyed.view.chosen_line() == ("row", len(keyed.grid.rows) - 1)


@pytest.mark.slow
@pytest.mark.parametrize("is_rectified", [False, True])
def test_arrows_move_a_line_by_a_pixel_and_with_shift_by_ten_as_one_correction(keyed, is_rectified):
    if is_rectified:
        keyed.tab.pane.rectified.click()
        keyed.idle()
        keyed.view.setFocus()
    before = positions(keyed)
    keyed.keys("Tab", "Tab", "Right", "Right", "Left")
    keyed.keys("Right", shift=True)
    assert positions(keyed) == before
    keyed.keys("Return")
    keyed.idle()
    change = np.array(positions(keyed)) - before
    assert change[1] == pytest.approx(11.0)
    assert np.abs(np.delete(change, 1)).max() == 0.0
    assert not keyed.draft.unsolved
    assert keyed.view.chosen_line() == ("column", 1)
    assert keyed.tab.controller.undo_label == "Move line"
    keyed.tab.tools.undo.click()
    keyed.idle()
    assert positions(keyed) == before


@pytest.mark.slow
def test_a_line_that_rests_is_put_down_by_itself(keyed, qtbot):
    before = positions(keyed, "rows")
    keyed.keys(*["Tab"] * (len(keyed.grid.columns) + 2), "Down")
    with qtbot.waitSignal(keyed.view.lineMoved, timeout=240_000):
        pass
    keyed.idle()
    assert positions(keyed, "rows")[1] == pytest.approx(before[1] + 1.0)


@pytest.mark.slow
def test_a_line_stops_at_its_neighbour(keyed):
    keyed.keys("Tab", "Tab")
    for _ in range(60):
        keyed.keys("Right", shift=True)
    keyed.keys("Return")
    keyed.idle()
    now = positions(keyed)
    assert now[1] == pytest.approx(now[2] - 3.0)
    assert not any("line" in message.text for message in keyed.messages)


@pytest.mark.slow
def test_delete_and_insert_take_a_line_out_and_put_one_in(keyed):
    n_columns = len(keyed.grid.columns)
    keyed.keys("Tab", "Tab", "Tab", "Delete")
    keyed.idle()
    assert len(keyed.grid.columns) == n_columns - 1
    assert keyed.view.chosen_line() == ("column", 2)
    left, right = positions(keyed)[2:4]
    keyed.keys("Insert")
    keyed.idle()
    assert len(keyed.grid.columns) == n_columns
    assert positions(keyed)[3] == pytest.approx(0.5 * (left + right))
    keyed.keys("Escape")
    assert keyed.view.chosen_line() is None


@pytest.mark.slow
def test_without_a_chosen_line_arrows_move_the_picture(keyed):
    draft, corner = keyed.draft, keyed.view.to_picture(keyed.view.rect().center().toPointF())
    keyed.keys("Escape", "Right", "Down")
    assert keyed.draft is draft
    assert (keyed.view.to_picture(keyed.view.rect().center().toPointF()) - corner).manhattanLength() > 1.0
    keyed.view.show_whole()


@pytest.mark.slow
def test_arrows_choose_a_panel_which_is_taken_out_and_put_back(keyed):
    keyed.use_tool("PANEL")
    keyed.view.setFocus()
    keyed.keys("Right", "Right", "Up")
    assert keyed.view.chosen_cell() == (1, 1)
    for key, n_panels in (("Insert", 30), ("Delete", 29), ("Delete", 29), ("Insert", 30), ("Space", 29), ("Space", 30)):
        keyed.keys(key)
        keyed.idle()
        assert len(keyed.draft.facade("A").panels) == n_panels, key
        assert keyed.view.chosen_cell() == (1, 1)
    keyed.use_tool("MOVE")
    assert keyed.view.chosen_cell() is None


@pytest.mark.slow
def test_a_pressed_line_is_moved_with_buttons_that_fingers_hit(found):
    found.use_tool("MOVE")
    before = positions(found)
    y = 0.5 * (found.grid.rows[0].position_px + found.grid.rows[1].position_px)
    found.press((before[3], y))
    assert found.view.chosen_line() == ("column", 3)
    left, right, up, _ = found.tab.tools._arrows
    for button, n_presses in ((right, 3), (left, 1), (up, 2)):
        for _ in range(n_presses):
            button.click()
    found.view.put_down()
    found.idle()
    assert positions(found)[3] == pytest.approx(before[3] + 2.0)


@pytest.mark.slow
def test_the_outcome_of_an_earlier_correction_does_not_drop_the_line_that_is_being_moved(keyed):
    keyed.keys("Tab", "Right", "Return", "Right", "Right")
    before = positions(keyed)[0]
    keyed.tab.controller.draftChanged.emit()
    keyed.keys("Return")
    keyed.idle()
    assert positions(keyed)[0] == pytest.approx(before + 2.0)


def test_pieces_of_a_cut_cell_are_drawn_and_go_and_come_together(found):
    """A brace across a cell makes two triangles of it."""
    grid = found.grid
    x0, x1 = grid.columns[2].position_px, grid.columns[3].position_px
    y0, y1 = grid.rows[0].position_px, grid.rows[1].position_px
    place = found.tab.pane.place()
    cut = facade_grid(
        grid.id, grid.rectification, grid.rows, grid.columns, (InclinedLine((x0, y1), (x1, y0), width_px=2.0),)
    )
    draft = replace(
        found.draft, found=replace(found.draft.found, grids={**found.draft.found.grids, ("A", place.photo): cut})
    )
    row = len(grid.rows) - 2

    def shapes(a_draft):
        return sorted(len(panel.corners_px) for panel in a_draft.grid(place).panels if panel.part > 0)

    assert shapes(draft) == [3, 3]
    found.view.set_grids((cut,), cut, is_rectified=False)
    found.view.show_whole()
    whole = found.view.grab().toImage()
    found.view.set_grids((grid,), grid, is_rectified=False)
    bare = found.view.grab().toImage()
    middle = found.view.place_of((0.5 * (x0 + x1), 0.5 * (y0 + y1))).toPoint()
    assert whole.pixelColor(middle) != bare.pixelColor(middle)
    out = set_panel(draft, place, row, 2, is_panel=False)
    assert shapes(out) == []
    assert (row, 2) in out.grid(place).missing
    assert shapes(set_panel(out, place, row, 2, is_panel=True)) == [3, 3]
