"""Height fields against closed forms and dense sampling."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.height_field import HeightField

WEST, SOUTH, STEP = -7.0, 3.0, 2.5


def field_of(function, rows=9, columns=13):
    x, y = np.meshgrid(WEST + STEP * np.arange(columns), SOUTH + STEP * np.arange(rows))
    return HeightField(WEST, SOUTH, STEP, function(x, y))


def drawn(seed, n, field, z=(0.0, 20.0)):
    low, high = (field.west_m, field.south_m, z[0]), (field.east_m, field.north_m, z[1])
    return np.random.default_rng(seed).uniform(low, high, (n, 3))


def rough(seed):
    return HeightField(WEST, SOUTH, STEP, np.random.default_rng(seed).uniform(-4.0, 4.0, (9, 13)))


def test_a_tilted_plane_is_met_exactly_between_its_nodes():
    field = field_of(lambda x, y: 3.0 + 0.25 * x - 0.5 * y)
    points = drawn(1, 500, field)
    truth = 3.0 + 0.25 * points[:, 0] - 0.5 * points[:, 1]
    assert field.heights_m(points) == pytest.approx(truth, abs=1e-12)
    a, b = points[:250], points[250:]
    above_a, above_b = a[:, 2] - truth[:250], b[:, 2] - truth[250:]
    least, most = field.leg_heights_m(a, b)
    assert least == pytest.approx(np.minimum(above_a, above_b), abs=1e-12)
    assert most == pytest.approx(np.maximum(above_a, above_b), abs=1e-12)


def test_the_least_height_over_one_saddle_is_that_of_its_parabola():
    # z = x y over the unit cell: t (1 - t) along one diagonal, 0.25 at its middle; t^2 along the other.
    field = HeightField(0.0, 0.0, 1.0, np.array([[0.0, 0.0], [0.0, 1.0]]))
    ends = np.array([[0.0, 1.0, 0.25]]), np.array([[1.0, 0.0, 0.25]])
    least, most = field.leg_heights_m(*ends)
    assert least[0] == 0.0
    assert most[0] == 0.25
    ends = np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 1.0, 0.0]])
    least, most = field.leg_heights_m(*ends)
    assert (least[0], most[0]) == (-1.0, 1.0)


@given(st.integers(0, 2**32 - 1), st.sampled_from(["any", "level", "east", "north", "up", "through nodes", "back"]))
def test_no_sample_of_a_leg_lies_lower_than_its_least_height_and_some_come_near(seed, kind):
    field = rough(seed)
    a, b = drawn(seed, 20, field), drawn(seed + 1, 20, field)
    if kind == "level":
        b[:, 2] = a[:, 2]
    elif kind == "east":
        b[:, 1] = a[:, 1]
    elif kind == "north":
        b[:, 0] = a[:, 0]
    elif kind == "up":
        b[:, :2] = a[:, :2]
    elif kind == "through nodes":
        for ends in (a, b):
            ends[:, :2] = [WEST, SOUTH] + STEP * np.round((ends[:, :2] - [WEST, SOUTH]) / STEP)
    least, most = field.leg_heights_m(a, b)
    if kind == "back":
        other = field.leg_heights_m(b, a)
        assert other[0] == pytest.approx(least, abs=1e-11)
        assert other[1] == pytest.approx(most, abs=1e-11)
    t = np.linspace(0.0, 1.0, 4001)[None, :, None]
    samples = a[:, None] + t * (b - a)[:, None]
    inside = np.clip(samples, [field.west_m, field.south_m, -99.0], [field.east_m, field.north_m, 99.0])
    above = samples[..., 2] - field.heights_m(inside.reshape(-1, 3)).reshape(samples.shape[:2])
    assert (above.min(axis=1) >= least - 1e-9).all()
    assert (above.max(axis=1) <= most + 1e-9).all()
    # 40 m in 4000 steps of a centimetre, at slopes of at most some 10 m on 2.5 m.
    assert (above.min(axis=1) <= least + 0.1).all()
    assert (above.max(axis=1) >= most - 0.1).all()


@given(st.integers(0, 2**32 - 1), st.booleans())
def test_legs_keep_a_height_exactly_where_their_least_height_is_as_much(seed, has_holes):
    rng = np.random.default_rng(seed)
    z = 8.0 * np.sin(np.arange(70) / 9.0)[:, None] * np.cos(np.arange(90) / 7.0) + rng.normal(0.0, 0.5, (70, 90))
    if has_holes:
        z[rng.random(z.shape) < 3e-4] = np.nan
    field = HeightField(WEST, SOUTH, STEP, z)
    a, b = drawn(seed, 200, field, (0.0, 40.0)), drawn(seed + 1, 200, field, (0.0, 40.0))
    a[::7, 0], b[::7, 0] = WEST + 16 * STEP, WEST + 16 * STEP  # along the border of two blocks
    b[::5, :2] = a[::5, :2]
    a[::11, 0] -= 300.0  # beyond the grid
    for height_m in (0.0, 5.0):
        kept = field.legs_keep(a, b, height_m)
        assert (kept == (field.leg_heights_m(a, b)[0] >= height_m)).all()
        assert kept.any()
        assert not kept.all()


def test_where_nothing_is_known_nothing_is_kept():
    field = field_of(lambda x, y: 0.0 * x)
    field.z_m[4, 6] = np.nan
    x, y = WEST + 6 * STEP, SOUTH + 4 * STEP
    points = np.array([[x + 0.1, y + 0.1, 5.0], [x - 2.4, y - 2.4, 5.0], [x + 2.6, y, 5.0], [x, SOUTH - 0.1, 5.0]])
    assert np.isnan(field.heights_m(points)).tolist() == [True, True, False, True]
    a = np.array([[WEST, y - 1.0, 50.0], [WEST, SOUTH, 50.0], [WEST - 1.0, y, 50.0], [x, SOUTH, 50.0]])
    b = np.array(
        [[WEST + 30.0, y - 1.0, 50.0], [WEST + 30.0, SOUTH, 50.0], [WEST + 30.0, y, 50.0], [x, SOUTH + 20.0, 9.0]]
    )
    least, most = field.leg_heights_m(a, b)
    assert least.tolist() == [-np.inf, 50.0, -np.inf, -np.inf]
    assert most.tolist() == [np.inf, 50.0, np.inf, np.inf]


def test_the_border_of_the_grid_belongs_to_it():
    field = field_of(lambda x, y: x + y)
    corners = np.array([[x, y, 100.0] for x in (field.west_m, field.east_m) for y in (field.south_m, field.north_m)])
    assert field.heights_m(corners) == pytest.approx(corners[:, 0] + corners[:, 1], abs=1e-12)
    least, _ = field.leg_heights_m(corners[[0, 0, 1]], corners[[1, 3, 2]])
    assert np.isfinite(least).all()


@given(st.integers(0, 2**32 - 1))
def test_widened_bounds_enclose_all_points(seed):
    field, points = rough(seed), drawn(seed, 300, rough(seed), (-15.0, 15.0))
    above, below = np.zeros_like(field.z_m), np.zeros_like(field.z_m)
    highest = field.cells_m(np.maximum)
    field.spread_departures(points, above, below, highest)
    upper, lower = (HeightField(WEST, SOUTH, STEP, field.z_m + off) for off in (above, below))
    assert (upper.heights_m(points) >= points[:, 2] - 1e-9).all()
    assert (lower.heights_m(points) <= points[:, 2] + 1e-9).all()
    assert (above >= 0.0).all()
    cell = np.floor((points[:, :2] - [WEST, SOUTH]) / STEP).astype(int)
    assert (highest[cell[:, 1], cell[:, 0]] >= points[:, 2]).all()


def test_heights_below_a_box_are_those_of_all_cells_that_it_touches():
    field = field_of(lambda x, y: x)
    part = field.part_m(np.array([-1.9, 3.1]), np.array([-1.1, 5.0]))
    assert set(part.tolist()) == {-2.0, 0.5}
    assert np.isnan(field.part_m(np.array([-8.0, 4.0]), np.array([0.0, 5.0]))).any()


@pytest.mark.parametrize(("shape", "step"), [((1, 5), 1.0), ((5,), 1.0), ((3, 3), 0.0), ((3, 3), np.nan)])
def test_what_is_no_grid_is_refused(shape, step):
    with pytest.raises(ValueError, match="expected"):
        HeightField(0.0, 0.0, step, np.zeros(shape))
