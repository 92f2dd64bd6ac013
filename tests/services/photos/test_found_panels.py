"""Corrections of found panels: made in one photo, meant for the facade, carried over to its other photos."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.photos.found_panels import GridPlace, search_panels, solved_draft, with_found_panels
from groundstation.services.photos.grid_edits import (
    add_line,
    cell_at,
    cell_middle,
    line_near,
    move_line,
    remove_line,
    set_panel,
)
from groundstation.services.photos.intake import PhotoMark, card_of_place, photo_cards, photo_intake
from planning.base.errors import InfeasibleError, InputError
from planning.geo.mesh import empty_mesh
from tests.reconstruction.panels.solving.test_solve import COLUMNS, ROWS
from tests.services.photo_cases import draft_of, site_model, write_photos

FIRST = GridPlace("A", 0)


@pytest.fixture(scope="module")
def draft():
    return draft_of()


def columns_m(draft):
    return np.array([line.position_m for line in draft.facade("A").columns])


def px_per_m(draft, place=FIRST):
    grid = draft.grid(place)
    return (grid.columns[-1].position_px - grid.columns[0].position_px) / (COLUMNS[-1] - COLUMNS[0])


@pytest.mark.slow
def test_a_moved_line_moves_on_the_facade_by_as_much_and_the_others_stay(draft):
    position = draft.grid(FIRST).columns[4].position_px + 0.3 * px_per_m(draft)
    moved = solved_draft(move_line(draft, FIRST, "column", 4, position))
    change = columns_m(moved) - columns_m(draft)
    assert change[4] == pytest.approx(0.3, abs=0.03)
    assert np.abs(np.delete(change, 4)).max() < 0.02
    assert len(moved.facade("A").panels) == 30


def test_a_correction_reaches_every_photo_of_the_facade(draft):
    position = draft.grid(FIRST).columns[4].position_px + 0.3 * px_per_m(draft)
    moved = move_line(draft, FIRST, "column", 4, position)
    for place in draft.places():
        before, after = draft.grid(place).columns, moved.grid(place).columns
        step_m = (after[4].position_px - before[4].position_px) / px_per_m(draft, place)
        assert step_m == pytest.approx(0.3, abs=0.05)
        assert after[4].width_px == pytest.approx(before[4].width_px)


@pytest.mark.slow
def test_a_removed_line_leaves_one_panel_where_two_were_and_comes_back_where_it_is_added(draft):
    position = draft.grid(FIRST).columns[5].position_px
    removed = solved_draft(remove_line(draft, FIRST, "column", 5))
    assert len(removed.facade("A").columns) == len(COLUMNS) - 1
    assert len(removed.facade("A").panels) == 27
    added = solved_draft(add_line(removed, FIRST, "column", position))
    assert np.abs(columns_m(added) - columns_m(draft)).max() < 0.03
    assert len(added.facade("A").panels) == 30


def test_a_row_is_added_in_the_middle_of_others(draft):
    grid = draft.grid(FIRST)
    middle = 0.5 * (grid.rows[1].position_px + grid.rows[2].position_px)
    added = solved_draft(add_line(draft, FIRST, "row", middle)).facade("A")
    assert len(added.rows) == len(ROWS) + 1
    assert added.rows[2].position_m == pytest.approx(0.5 * (ROWS[1] + ROWS[2]), abs=0.1)


@pytest.mark.slow
def test_a_panel_taken_out_is_gone_from_the_facade_and_can_be_put_back(draft):
    out = set_panel(draft, FIRST, 1, 6, is_panel=False)
    assert all((1, 6) in out.grid(place).missing for place in draft.places())
    kept = {(panel.row, panel.column) for panel in solved_draft(out).facade("A").panels}
    assert kept == {(panel.row, panel.column) for panel in draft.facade("A").panels} - {(1, 6)}
    back = solved_draft(set_panel(out, FIRST, 1, 6, is_panel=True))
    assert len(back.facade("A").panels) == 30


def test_a_panel_taken_out_stays_out_when_a_line_is_added_beside_it(draft):
    out = set_panel(draft, FIRST, 1, 6, is_panel=False)
    place_px = cell_middle(out.grid(FIRST), 0, 2)[0]
    added = solved_draft(add_line(out, FIRST, "column", place_px))
    assert (1, 7) not in {(panel.row, panel.column) for panel in added.facade("A").panels}
    assert len(added.facade("A").panels) == 32


def test_corrections_leave_the_draft_they_were_made_on_as_it_was(draft):
    before = dict(draft.found.grids)
    remove_line(draft, FIRST, "row", 1)
    assert draft.found.grids == before
    assert not draft.unsolved


def test_a_line_does_not_pass_its_neighbour(draft):
    beyond = draft.grid(FIRST).columns[5].position_px + 1.0
    with pytest.raises(InputError, match="as far as its neighbours"):
        move_line(draft, FIRST, "column", 4, beyond)


def test_a_line_is_not_added_on_another(draft):
    with pytest.raises(InputError, match="a line already"):
        add_line(draft, FIRST, "row", draft.grid(FIRST).rows[1].position_px + 1.0)


def test_the_last_two_lines_stay(draft):
    left = draft
    for _ in range(2):
        left = remove_line(left, FIRST, "row", 1)
    with pytest.raises(InputError, match="two lines in each direction"):
        remove_line(left, FIRST, "row", 0)


@pytest.mark.slow
def test_a_facade_without_panels_is_not_solved(draft):
    left = draft
    for row in range(3):
        for column in range(10):
            left = set_panel(left, FIRST, row, column, is_panel=False)
    solved = solved_draft(left)
    assert solved.facade("A").panels == ()
    with pytest.raises(InputError, match="no panel is left"):
        with_found_panels(site_model(), solved)
    bare = {key: replace(grid, rows=grid.rows[:1]) for key, grid in draft.found.grids.items()}
    gone = replace(draft, found=replace(draft.found, grids=bare), unsolved=frozenset({"A"}))
    with pytest.raises(InfeasibleError, match="no photo shows a grid"):
        solved_draft(gone)


def test_lines_and_cells_are_found_where_they_are(draft):
    grid = draft.grid(FIRST)
    for row, column in ((0, 0), (2, 9), (1, 4)):
        assert cell_at(grid, cell_middle(grid, row, column)) == (row, column)
    assert cell_at(grid, (grid.columns[0].position_px - 1.0, grid.rows[1].position_px)) is None
    beside = (grid.columns[3].position_px + 2.0, cell_middle(grid, 1, 3)[1])
    assert line_near(grid, beside, 4.0) == ("column", 3)
    assert line_near(grid, beside, 1.0) is None


def test_found_panels_take_the_place_of_the_sites_own(draft):
    model = site_model()
    changed = with_found_panels(model, draft)
    assert [facade.id for facade in changed.site.facades] == ["A"]
    assert len(changed.site.panels) == 30
    assert changed.sha256 != model.sha256
    assert changed.building is model.building
    with pytest.raises(ValueError, match="solved"):
        with_found_panels(model, remove_line(draft, FIRST, "row", 1))


def test_a_site_without_a_building_cannot_be_searched(draft):
    with pytest.raises(InputError, match="no building mesh"):
        search_panels(draft.photos, (), replace(site_model(), building=empty_mesh()))
    with pytest.raises(InputError, match="none of the photos"):
        search_panels((), (), site_model())


def test_cards_tell_what_is_wrong_with_each_photo(tmp_path):
    write_photos(tmp_path)
    paths = sorted(tmp_path.iterdir())
    content = paths[1].read_bytes()
    paths[1].write_bytes(content[: len(content) // 2])
    (tmp_path / "none.jpg").write_bytes(b"no picture")
    intake = photo_intake(tmp_path, site_model())
    cards = photo_cards(intake)
    assert [card.path for card in cards] == paths
    assert {PhotoMark.UNREADABLE, PhotoMark.CUT_OFF} <= set(cards[1].marks)
    assert cards[0].posed is not None
    assert not {PhotoMark.UNREADABLE, PhotoMark.UNPOSED} & set(cards[0].marks)
    assert intake.usable == (True, False, True)
    assert card_of_place(cards, str(paths[1])) == 1
    assert card_of_place(cards, "X-1") is None
