import itertools

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.splats.merged_splats import ALONE, FEWEST, HALVINGS, detail_tree
from reconstruction.splats.rasterising.views import View
from tests.reconstruction.splats.drawn_splats import turned_view

CASES = ("even", "clusters", "line", "one far away", "all at one place", "far from the origin")


def places(case, n, rng):
    found = rng.uniform(-5.0, 5.0, (n, 3))
    if case == "clusters":
        found = 0.01 * found + rng.uniform(-5.0, 5.0, (9, 3))[rng.integers(9, size=n)]
    elif case == "line":
        found[:, 1:] = 1.0
    elif case == "one far away":
        found[0] = 1e5
    elif case == "all at one place":
        found[:] = found[0]
    elif case == "far from the origin":
        found += 1e4
    return found


def made(case="even", seed=0, n=3 * FEWEST, n_groups=3, finest_m=1e-3):
    rng = np.random.default_rng(seed)
    means, groups = places(case, n, rng), rng.integers(-1, n_groups - 1, n)
    sizes = finest_m * np.exp(rng.uniform(0.0, 6.0, n))
    return detail_tree(means, sizes, groups), means, sizes, groups


def looking_at(place, distance_m, seed=0, width_px=64):
    """From anywhere so far away, in any direction that has the place in the picture."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    matrix[:3, 3] = np.array([0.1, -0.1, 1.0]) * distance_m - turn @ place
    return View(width_px, 48, 50.0, 60.0, 30.0, 20.0, torch.from_numpy(matrix))


def position(view):
    matrix = view.cam_from_world.numpy()
    return -matrix[:3, :3].T @ matrix[:3, 3]


def chains(tree):
    """Of each splat: itself, its cube, that one's, ..."""
    found = []
    for row in range(tree.n_splats):
        chain = [row]
        while tree.parents[chain[-1]] != ALONE:
            chain.append(int(tree.parents[chain[-1]]))
        found.append(chain)
    return found


def side_of(tree, row):
    return next(level.side_m for level in tree.levels if level.start <= row < level.stop)


@pytest.mark.parametrize("case", CASES)
def test_cubes_hold_what_is_theirs_and_lie_in_their_parents(case):
    tree, means, sizes, groups = made(case)
    assert tree.levels
    group_of, rounding = {}, 1e-9 * (1.0 + np.abs(means).max())
    for row, chain in enumerate(chains(tree)):
        for cube in chain[1:]:
            low, side = tree.corners_m[cube - tree.n_splats], side_of(tree, cube)
            assert (low - rounding <= means[row]).all()
            assert (means[row] <= low + side + rounding).all()
            assert sizes[row] <= side
            assert group_of.setdefault(cube, groups[row]) == groups[row]
        sides = [side_of(tree, cube) for cube in chain[1:]]
        assert sides == sorted(set(sides))
        assert all(above > below for below, above in itertools.pairwise(chain))


def test_a_cube_has_two_parts_at_least():
    tree = made("clusters")[0]
    counts = np.bincount(tree.parents[tree.parents != ALONE])
    assert set(counts[tree.n_splats :]) - {0} == set(counts[tree.n_splats :])
    assert counts[tree.n_splats :].min() >= 2
    assert len(counts) == len(tree.parents)


@pytest.mark.slow
@given(
    st.sampled_from(CASES),
    st.integers(0, 99),
    st.floats(-3.0, 3.0).map(lambda power: 10.0**power),
    st.floats(-2.0, 2.0).map(lambda power: 10.0**power),
)
def test_each_splat_in_sight_is_drawn_once_by_the_coarsest_cube_that_is_small_enough(case, seed, distance_m, finest_px):
    tree, means, _, _ = made(case, seed % 3, n=FEWEST)
    view = looking_at(means[seed], distance_m, seed)
    matrix = view.cam_from_world.numpy()
    at = means @ matrix[:3, :3].T + matrix[:3, 3]
    x, y = view.fx_px * at[:, 0] / at[:, 2] + view.cx_px, view.fy_px * at[:, 1] / at[:, 2] + view.cy_px
    in_sight = (at[:, 2] > 0.0) & (x >= 0) & (x <= view.width_px) & (y >= 0) & (y <= view.height_px)
    rows = tree.rows_for(view, finest_px)
    assert (np.diff(rows) > 0).all()
    drawn = set(rows.tolist())
    for chain, is_seen in zip(chains(tree), in_sight, strict=True):
        small = [cube for cube in chain[1:] if is_small(tree, cube, view, finest_px)]
        found = drawn.intersection(chain)
        assert len(found) <= 1
        if found or is_seen:
            assert found == {small[-1] if small else chain[0]}


def is_small(tree, cube, view, finest_px):
    """The slow way: the nearest point of a cube, by clipping."""
    low, side, place = tree.corners_m[cube - tree.n_splats], side_of(tree, cube), position(view)
    distance = np.linalg.norm(np.clip(place, low, low + side) - place)
    return side * max(view.fx_px, view.fy_px) <= finest_px * distance


def test_what_is_behind_the_camera_or_beside_the_picture_is_left_out():
    tree, means, _, _ = made("clusters", n=4 * FEWEST)
    view = looking_at(means[0], 1.0)
    rows = tree.rows_for(view, 1e-9)
    assert 0 < len(rows) < 0.8 * tree.n_splats


@pytest.mark.parametrize("n", [0, 1, FEWEST - 1])
def test_few_splats_are_drawn_as_they_are(n):
    tree = made(n=n)[0]
    assert tree.levels == ()
    assert tree.rows_for(turned_view(), 1e9).tolist() == list(range(n))


def test_splats_too_large_for_any_cube_are_in_none():
    rng = np.random.default_rng(0)
    means, sizes = rng.uniform(-1.0, 1.0, (4 * FEWEST, 3)), np.full(4 * FEWEST, 0.01)
    sizes[::4] = 50.0
    tree = detail_tree(means, sizes, np.full(len(means), -1))
    assert (tree.parents[: len(means) : 4] == ALONE).all()
    assert (tree.parents[1 : len(means) : 4] != ALONE).mean() > 0.9


def test_as_many_groups_as_numbers_hardly_hold_stay_apart():
    rng = np.random.default_rng(1)
    n = 4 * FEWEST
    groups = np.concatenate([np.arange(n // 2), np.arange(n // 2)]) + (1 << 30)
    means = rng.uniform(0.0, 1.0, (n // 2, 3)).repeat(2, axis=0).reshape(n // 2, 2, 3).transpose(1, 0, 2).reshape(n, 3)
    tree = detail_tree(means, np.full(n, 2.0**-HALVINGS), groups)
    for level in tree.levels:
        rows, cubes = tree.members(level)
        firsts = np.full(level.stop - level.start, -1)
        splats = rows < n
        firsts[cubes[splats]] = groups[rows[splats]]
        assert (firsts[cubes[splats]] == groups[rows[splats]]).all()
    assert tree.levels
