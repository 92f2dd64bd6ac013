"""PSNR and structural similarity: worked examples, a slow twin, masks, strips, and hard cases."""

import math

import numpy as np
import pytest

from reconstruction.metrics import image_metrics
from reconstruction.metrics.image_metrics import (
    C1,
    C2,
    PictureScore,
    Quality,
    mean_quality,
    psnr_db,
    score_picture,
    ssim_map,
    window_weights,
)


def picture(seed, height=23, width=17):
    return np.random.default_rng(seed).random((height, width, 3))


def slow_similarity(a, b, row, column):
    """Of one window, by the sums of Wang et al., Eqs. 13 and 14 to 16."""
    weights = np.array(
        [[math.exp(-((i - 5) ** 2 + (j - 5) ** 2) / (2 * 1.5**2)) for j in range(11)] for i in range(11)]
    )
    weights /= weights.sum()
    values = []
    for channel in range(a.shape[2]):
        x, y = (p[row : row + 11, column : column + 11, channel] for p in (a, b))
        mx, my = (weights * x).sum(), (weights * y).sum()
        vx, vy = (weights * (x - mx) ** 2).sum(), (weights * (y - my) ** 2).sum()
        cov = (weights * (x - mx) * (y - my)).sum()
        values.append(((2 * mx * my + C1) * (2 * cov + C2)) / ((mx**2 + my**2 + C1) * (vx + vy + C2)))
    return np.mean(values)


def test_psnr_of_a_known_error():
    # An error of 0.1 everywhere: 10 log10(1 / 0.01).
    truth = np.full((12, 12, 3), 0.4)
    assert score_picture(truth + 0.1, truth).psnr_db == pytest.approx(20.0)
    # One grey level of 255 everywhere: 20 log10(255), as every table of 8-bit pictures has it.
    eight = np.full((12, 12, 3), 100, np.uint8)
    assert score_picture(eight + np.uint8(1), eight).psnr_db == pytest.approx(48.1308, abs=1e-4)
    assert psnr_db(0.0) == 100.0


def test_flat_pictures_differ_by_their_brightness_alone():
    # With no variance SSIM is (2 a b + C1) / (a^2 + b^2 + C1) (Wang et al., Eq. 6), times 1.
    a, b = 0.2, 0.6
    found = score_picture(np.full((15, 15, 3), a), np.full((15, 15, 3), b))
    assert found.ssim == pytest.approx((2 * a * b + C1) / (a * a + b * b + C1), rel=1e-12)


def test_less_contrast_around_one_mean_is_told_by_the_variances():
    # b = mean + (a - mean) / 2 about the window's own mean: (2 v / 2 + C2) / (v + v / 4 + C2), brightness being equal.
    a = picture(0, 11, 11)
    means = np.einsum("i,ijk,j->k", window_weights(), a, window_weights())
    variances = np.einsum("i,ijk,j->k", window_weights(), (a - means) ** 2, window_weights())
    expected = np.mean((variances + C2) / (1.25 * variances + C2))
    assert score_picture(means + 0.5 * (a - means), a).ssim == pytest.approx(expected, rel=1e-9)


def test_every_window_is_that_of_the_slow_twin():
    a, b = picture(1), picture(2)
    found = ssim_map(a, b)
    assert found.shape == (13, 7)
    for row, column in ((0, 0), (12, 6), (5, 3)):
        assert found[row, column] == pytest.approx(slow_similarity(a, b, row, column), abs=1e-12)


def test_scores_are_symmetric_and_best_for_equal_pictures():
    a, b = picture(3), picture(4)
    assert score_picture(a, b) == score_picture(b, a)
    assert score_picture(a, a) == PictureScore(100.0, pytest.approx(1.0, abs=1e-12), 23 * 17)
    assert score_picture(1.0 - a, a).ssim < 0.0


def test_strips_do_not_change_scores(monkeypatch):
    a, b, mask = picture(5, 61, 19), picture(6, 61, 19), picture(7, 61, 19)[..., 0] > 0.5
    whole = score_picture(a, b), score_picture(a, b, mask)
    monkeypatch.setattr(image_metrics, "STRIP_ROWS", 7)
    for found, expected in zip((score_picture(a, b), score_picture(a, b, mask)), whole, strict=True):
        assert found.psnr_db == pytest.approx(expected.psnr_db, rel=1e-12)
        assert found.ssim == pytest.approx(expected.ssim, rel=1e-12)
    assert whole[0].ssim == pytest.approx(ssim_map(a, b).mean(), rel=1e-12)
    assert whole[1].ssim == pytest.approx(ssim_map(a, b)[mask[5:-5, 5:-5]].mean(), rel=1e-12)


def test_a_mask_scores_its_own_pixels():
    truth = np.full((20, 20, 3), 0.5)
    found, mask = truth.copy(), np.zeros((20, 20), bool)
    mask[4:9, 4:9] = True
    found[~mask] = 0.0
    assert score_picture(found, truth, mask).psnr_db == 100.0
    assert score_picture(found, truth, mask).ssim < 1.0, "windows reach beyond the mask"
    assert score_picture(found, truth, mask).n_pixels == 25


def test_where_nothing_can_be_scored_there_is_no_score():
    a = picture(8)
    assert score_picture(a, a, np.zeros((23, 17), bool)) == PictureScore(None, None, 0)
    border = np.zeros((23, 17), bool)
    border[0] = True
    assert score_picture(a, a, border) == PictureScore(100.0, None, 17)
    assert score_picture(a[:10, :10], a[:10, :10]) == PictureScore(100.0, None, 100)


@pytest.mark.parametrize("level", [0.0, 1e-7, 0.1, 1.0 / 3.0, 1.0])
def test_flat_windows_in_single_precision_are_no_worse_than_perfect(level):
    flat = np.full((16, 16, 3), level, np.float32)
    noisy = flat + np.random.default_rng(0).normal(0.0, 1e-8, flat.shape).astype(np.float32)
    found = score_picture(noisy, flat)
    assert found.ssim is not None
    assert 1.0 - 1e-6 < found.ssim <= 1.0


def test_what_is_not_finite_or_out_of_range_still_gives_a_score():
    truth = picture(9)
    bad = truth.copy()
    bad[0, 0], bad[1, 1], bad[2, 2] = np.nan, np.inf, -np.inf
    found = score_picture(bad * 1.0, truth)
    assert math.isfinite(found.psnr_db)
    assert -1.0 <= found.ssim <= 1.0


@pytest.mark.parametrize(
    ("found", "truth", "mask"),
    [
        (np.zeros((12, 12, 3)), np.zeros((12, 13, 3)), None),
        (np.zeros((12, 12)), np.zeros((12, 12)), None),
        (np.zeros((12, 12, 3)), np.zeros((12, 12, 3)), np.ones((12, 12))),
        (np.zeros((12, 12, 3)), np.zeros((12, 12, 3)), np.ones((12, 11), bool)),
    ],
)
def test_wrong_shapes_are_refused(found, truth, mask):
    with pytest.raises(ValueError, match="expected"):
        score_picture(found, truth, mask)
    with pytest.raises(ValueError, match="expected two pictures"):
        ssim_map(np.zeros((10, 12, 3)), np.zeros((10, 12, 3)))


def test_quality_of_views_is_the_mean_over_those_that_show_a_facade():
    assert mean_quality([(20.0, 10.0), (None, 50.0), (30.0, 11.0)]) == Quality(25.0, 2, True)
    assert mean_quality([(None, 10.0), (None, 14.0)]) == Quality(12.0, 2, False)
    assert mean_quality([(None, None)]) is None
    assert mean_quality([]) is None


def test_similarity_can_be_left_out():
    a, b = np.random.default_rng(3).random((2, 40, 30, 3))
    whole, quick = score_picture(a, b), score_picture(a, b, with_ssim=False)
    assert quick == PictureScore(whole.psnr_db, None, 1200)
