"""FLIP: what the authors' program says of the same pictures, masks, strips, and its own properties."""

import numpy as np
import pytest

from reconstruction.metrics import flip as module
from reconstruction.metrics.flip import flip, flip_map, flip_of_masks


def pictures(height, width, seed):
    """A colourful picture with noise, and the same shifted, darker and with other noise; 8 bit."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:height, 0:width] / 20.0
    waves = [np.sin(x + seed), np.cos(y * x / 3.0), np.sin(x - 2.0 * y)]
    truth = np.stack([0.5 + 0.4 * wave for wave in waves], axis=-1) + 0.1 * rng.normal(size=(height, width, 3))
    found = 0.9 * np.roll(np.clip(truth, 0.0, 1.0), 2, axis=1) + 0.05 * rng.normal(size=truth.shape)
    return tuple(np.round(255.0 * np.clip(each, 0.0, 1.0)).astype(np.uint8) for each in (found, truth))


@pytest.mark.parametrize(
    ("height", "width", "seed", "mean"),
    [(60, 80, 0, 0.3879358), (41, 37, 1, 0.4871931), (200, 150, 2, 0.4031695)],
)
def test_it_says_what_the_authors_program_says(height, width, seed, mean):
    # Of flip-evaluator 1.7: evaluate(truth / 255, found / 255, "LDR"), float32.
    assert flip(*pictures(height, width, seed)) == pytest.approx(mean, abs=3e-6)


def test_its_map_is_that_of_the_authors_program():
    evaluator = pytest.importorskip("flip_evaluator", reason="the extra 'foreign' is not installed")
    found, truth = pictures(70, 90, 3)
    given = [(picture / 255.0).astype(np.float32) for picture in (truth, found)]
    expected, _, _ = evaluator.evaluate(*given, "LDR", applyMagma=False)
    np.testing.assert_allclose(flip_map(found, truth), expected.squeeze(), atol=1e-5)


def test_equal_pictures_do_not_differ_and_black_and_white_differ_most():
    found, truth = pictures(30, 40, 4)
    assert flip(truth, truth) == 0.0
    black, white = np.zeros_like(truth), np.full_like(truth, 255)
    assert 0.9 < flip(black, white) <= 1.0
    assert np.all((flip_map(found, truth) >= 0.0) & (flip_map(found, truth) <= 1.0))
    assert flip(found, truth) == pytest.approx(flip(truth, found))
    assert flip(found / 255.0, truth / 255.0) == pytest.approx(flip(found, truth), rel=1e-9)


def test_masks_and_strips_change_nothing_but_what_is_counted(monkeypatch):
    found, truth = pictures(60, 30, 5)
    mask = np.zeros((60, 30), bool)
    mask[10:45, 5:20] = True
    values = flip_map(found, truth)
    monkeypatch.setattr(module, "STRIP_ROWS", 17)
    whole, part, none = flip_of_masks(found, truth, (None, mask, np.zeros_like(mask)))
    assert whole == pytest.approx(values.mean(), rel=1e-12)
    assert part == pytest.approx(values[mask].mean(), rel=1e-12)
    assert none is None


def test_a_blur_too_fine_to_see_from_afar_differs_less():
    _, truth = pictures(60, 60, 6)
    checks = np.indices((60, 60)).sum(axis=0) % 2 * 60
    found = np.clip(truth.astype(int) + checks[..., None] - 30, 0, 255).astype(np.uint8)
    near, far = (flip_map(found, truth, pixels).mean() for pixels in (15.0, 150.0))
    assert far < 0.7 * near


def test_pictures_of_other_shapes_are_refused():
    with pytest.raises(ValueError, match="one shape"):
        flip_map(np.zeros((5, 5, 3)), np.zeros((5, 6, 3)))
    with pytest.raises(ValueError, match="one shape"):
        flip_map(np.zeros((5, 5, 1)), np.zeros((5, 5, 1)))
