"""Going over a grid line by line and cell by cell, as keys do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.photos.grid_edits import (
    cell_at,
    cell_beside,
    cell_bounds,
    cell_middle,
    following_line,
    lines_of,
    place_beside,
)
from reconstruction.panels.search.record import FacadeGrid, GridLine


def grid(n_rows, n_columns):
    rng = np.random.default_rng(n_rows + 10 * n_columns)
    rows, columns = (np.cumsum(rng.uniform(5.0, 40.0, n)).tolist() for n in (n_rows, n_columns))
    return FacadeGrid("A", None, tuple(map(GridLine, rows)), tuple(map(GridLine, columns)), ())


sizes = st.integers(0, 6)


@given(n_rows=sizes, n_columns=sizes)
def test_every_line_is_passed_once_and_backwards_in_the_other_order(n_rows, n_columns):
    made = grid(n_rows, n_columns)

    def walk(step):
        line, passed = None, []
        while (line := following_line(made, line, step)) is not None:
            passed.append(line)
        return passed

    assert walk(1) == [("column", k) for k in range(n_columns)] + [("row", k) for k in range(n_rows)]
    assert walk(-1) == walk(1)[::-1]


@given(n_rows=st.integers(2, 6), n_columns=st.integers(2, 6), data=st.data())
def test_a_line_is_added_between_two_neighbours(n_rows, n_columns, data):
    made = grid(n_rows, n_columns)
    axis = data.draw(st.sampled_from(["column", "row"]))
    lines = lines_of(made, axis)
    index = data.draw(st.integers(0, len(lines) - 1))
    place = place_beside(made, (axis, index))
    positions = [line.position_px for line in lines]
    below = max(k for k, position in enumerate(positions) if position < place)
    assert index in (below, below + 1)
    assert place == pytest.approx(0.5 * (positions[below] + positions[below + 1]))


@given(n_rows=sizes, n_columns=sizes, steps=st.lists(st.tuples(st.integers(-2, 2), st.integers(-2, 2)), max_size=8))
def test_steps_from_cell_to_cell_stay_in_the_grid(n_rows, n_columns, steps):
    made, cell = grid(n_rows, n_columns), None
    for up, right in steps:
        cell = cell_beside(made, cell, up, right)
        if n_rows < 2 or n_columns < 2:
            assert cell is None
        else:
            assert cell_at(made, cell_middle(made, *cell)) == cell


def test_a_step_up_goes_up_on_the_facade():
    made = grid(4, 4)
    assert cell_beside(made, (0, 1), 1, 0) == (1, 1)
    assert cell_bounds(made, 1, 1)[3] == cell_bounds(made, 0, 1)[2]
