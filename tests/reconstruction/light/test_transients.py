"""Transients: what one photo shows and others contradict is found, and what is hard to learn is not taken for it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.light.transients import (
    BLOCK_PX,
    LEAST_ERROR,
    LEAST_PHOTOS,
    MOST_BLOCKS,
    Blocks,
    LeaveTransientsOut,
    evidence,
    mean_errors,
    places_of,
    transient_blocks,
    transients,
)

sizes = st.lists(st.tuples(st.integers(1, 700), st.integers(1, 700)), min_size=1, max_size=4)


@given(sizes, st.data())
def test_each_pixel_has_one_block_and_blocks_are_squares(found, data):
    blocks = Blocks(found)
    for number, (width, height) in enumerate(found):
        of_pixels = blocks.of_window(number, 0, 0, width, height)
        rows, columns = blocks.shapes[number]
        assert max(rows, columns) <= MOST_BLOCKS
        assert (of_pixels[0, 0], of_pixels[-1, -1]) == (blocks.starts[number], blocks.starts[number + 1] - 1)
        side = blocks.sides_px[number]
        assert side >= BLOCK_PX
        counts = np.bincount(of_pixels.ravel() - blocks.starts[number], minlength=rows * columns)
        assert counts.min() >= 1
        assert counts.max() <= side * side
    x, y = data.draw(st.integers(0, found[0][0] - 1)), data.draw(st.integers(0, found[0][1] - 1))
    window = blocks.of_window(0, x, y, found[0][0] - x, found[0][1] - y)
    np.testing.assert_array_equal(window, blocks.of_window(0, 0, 0, *found[0])[y:, x:])


def test_neighbours_are_those_of_the_same_photo():
    blocks = Blocks([(32, 16), (24, 24)])
    are = np.zeros(len(blocks), bool)
    are[3] = True  # the last one of the first photo's first row
    np.testing.assert_array_equal(np.flatnonzero(blocks.with_neighbours(are)), [2, 3, 7])
    are[:] = False
    are[8] = True  # the first one of the second photo
    np.testing.assert_array_equal(np.flatnonzero(blocks.with_neighbours(are)), [8, 9, 11])


def test_details_cancel_out_and_another_colour_does_not():
    rng = np.random.default_rng(0)
    blocks = np.repeat([0, 1], 64)
    fine = rng.permutation(np.repeat([-0.3, 0.3], 32))[:, None] * np.ones(3)
    errors, counts = mean_errors(blocks, np.concatenate([fine, np.full((64, 3), 0.1)]), 3)
    np.testing.assert_allclose(errors, [0.0, 0.1, 0.0], atol=1e-12)
    np.testing.assert_array_equal(counts, [64, 64, 0])


def test_what_errs_in_one_photo_is_a_transient_and_what_errs_in_all_is_not():
    rng = np.random.default_rng(1)
    n_photos, n_places = 20, 30
    usual = np.where(np.arange(n_places) < 6, 0.12, 0.02)  # a fifth of the places is hard to learn
    errors = usual * rng.uniform(0.7, 1.3, (n_photos, n_places))
    errors[4, 20] = errors[7, 25] = 0.2
    photos, places = np.indices(errors.shape).reshape(2, -1)
    found = transients(errors.ravel(), places, photos).reshape(errors.shape)
    np.testing.assert_array_equal(np.argwhere(found), [[4, 20], [7, 25]])


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.3))
def test_photos_that_agree_have_none(seed, error):
    rng = np.random.default_rng(seed)
    errors = np.full(200, error) * rng.uniform(0.8, 1.2, 200)
    assert not transients(errors, rng.integers(0, 9, 200), np.arange(200) % 7).any()


def test_small_errors_are_none_however_good_the_rest_is():
    errors = np.full(50, 1e-4)
    errors[3] = 0.9 * LEAST_ERROR
    assert not transients(errors, np.zeros(50, int), np.arange(50)).any()
    errors[3] = 1.1 * LEAST_ERROR
    assert np.flatnonzero(transients(errors, np.zeros(50, int), np.arange(50))).tolist() == [3]


def test_a_place_that_only_transients_show_is_found_all_the_same():
    errors = np.full(100, 0.02)
    errors[:5] = 0.3
    places = np.arange(100) // 5
    assert np.flatnonzero(transients(errors, places, np.arange(100) % 5)).tolist() == [0, 1, 2, 3, 4]


def test_without_blocks_there_are_none():
    nothing = np.zeros(0, int)
    assert transients(np.zeros(0), nothing, nothing).shape == (0,)
    assert evidence(np.zeros(0), nothing, nothing) == 0.0
    assert places_of(np.zeros((0, 3)), nothing, nothing).shape == (0,)


N_PHOTOS, N_PLACES = 20, 40
PHOTOS, PLACES = np.indices((N_PHOTOS, N_PLACES)).reshape(2, -1)
TOLERANCE = LeaveTransientsOut().tolerance


def usual_errors(seed):
    """Of photos that agree, where a fifth of the places is hard to learn; shape (N_PHOTOS, N_PLACES)."""
    rng = np.random.default_rng(seed)
    hard = rng.random(N_PLACES) < 0.2
    return np.where(hard, 0.1, 0.015) * rng.lognormal(0.0, 0.4, (N_PHOTOS, N_PLACES))


@given(st.integers(0, 2**32 - 1))
def test_evidence_tells_passers_by_from_what_is_hard_to_learn(seed):
    errors, rng = usual_errors(seed), np.random.default_rng(seed)
    assert evidence(errors.ravel(), PLACES, PHOTOS) < TOLERANCE
    for photo in range(N_PHOTOS):
        first = int(rng.integers(N_PLACES - 4))
        errors[photo, first : first + 4] = rng.uniform(0.2, 0.4)
    assert evidence(errors.ravel(), PLACES, PHOTOS) > TOLERANCE


@given(st.integers(0, 2**32 - 1))
def test_a_photo_with_a_wrong_pose_is_no_evidence(seed):
    errors = usual_errors(seed)
    errors[7, ::3] = 0.4
    assert transients(errors.ravel(), PLACES, PHOTOS).any()
    assert evidence(errors.ravel(), PLACES, PHOTOS) < TOLERANCE


def test_places_that_few_photos_show_are_no_evidence():
    errors = usual_errors(0)
    errors[:, :4] = np.random.default_rng(1).uniform(0.0, 0.5, (N_PHOTOS, 4))
    own = np.where(PLACES < 4, N_PLACES + 4 * PHOTOS + PLACES, PLACES)
    assert evidence(errors.ravel(), own, PHOTOS) < 0.5 * TOLERANCE


@pytest.mark.long
@given(st.integers(6, 30), st.integers(-20, 20), st.integers(0, 2**32 - 1))
def test_places_are_as_small_as_enough_photos_allow_in_whatever_unit(n_photos, exponent, seed):
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:12, :16]
    wall = np.column_stack([x.ravel(), np.zeros(x.size), y.ravel()])
    points = (wall[None] + rng.uniform(-0.4, 0.4, (n_photos, 1, 3))).reshape(-1, 3)
    photos, kinds = np.repeat(np.arange(n_photos), len(wall)), (points[:, 0] > 8.0).astype(int)
    places = places_of(points, kinds, photos)
    n_showing = np.array([len(np.unique(photos[places == place])) for place in range(places.max() + 1)])
    assert (n_showing[places] >= LEAST_PHOTOS).mean() >= 0.7
    assert len(n_showing) > 20
    assert not np.intersect1d(places[kinds == 0], places[kinds == 1]).size
    np.testing.assert_array_equal(places, places_of(2.0**exponent * points, kinds, photos))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rays_of_somebody_who_walked_by_are_found_in_single_and_double_precision(dtype):
    rng, n_photos = np.random.default_rng(3), 12
    blocks = Blocks([(64, 48)] * n_photos)
    rows, columns = np.mgrid[:48, :64]
    photos = np.repeat(np.arange(n_photos), rows.size)
    of_rays = blocks.at(photos, np.tile(columns.ravel(), n_photos), np.tile(rows.ravel(), n_photos))
    errors = rng.normal(0.0, 0.05, (len(photos), 3)).astype(dtype)
    person = (photos == 5) & (np.tile(columns.ravel(), n_photos) // 16 == 1)
    errors[person] += dtype(0.25)
    wall = np.tile(np.column_stack([columns.ravel(), rows.ravel(), 0 * rows.ravel()]) / 16.0, (n_photos, 1))
    found, share = transient_blocks(blocks, of_rays, errors, wall)
    assert found[of_rays[person]].all()
    assert set(photos[found[of_rays]]) == {5}
    assert share == 0.0  # one photo alone is no evidence
    other = (photos == 8) & (np.tile(columns.ravel(), n_photos) // 16 == 2)
    errors[other] -= dtype(0.25)
    assert transient_blocks(blocks, of_rays, errors, wall)[1] == pytest.approx(0.49, abs=0.02)
