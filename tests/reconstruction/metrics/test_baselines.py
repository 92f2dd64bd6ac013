"""Masks of other methods: every usual coding is understood, every fault is named."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from reconstruction.metrics.run import mask_folder

HALF = np.zeros((10, 20), np.uint8)
HALF[:, 10:] = 1


def mask_of(folder: Path, picture: np.ndarray, width_px: int = 20, height_px: int = 10) -> np.ndarray:
    assert cv2.imwrite(str(folder / "a.png"), picture)
    return mask_folder(folder).mask("a", width_px, height_px)


@pytest.mark.parametrize(
    "picture",
    [
        HALF,
        HALF * 255,
        HALF * 140,
        HALF.astype(np.uint16) * 65_535,
        HALF.astype(np.uint16) * 40_000 + 3,
        np.dstack([HALF * 255] * 3),
        np.dstack([HALF * 255] * 3 + [np.full_like(HALF, 255)]),
    ],
    ids=["0 and 1", "0 and 255", "probability", "16 bit", "16 bit probability", "three channels", "with alpha"],
)
def test_usual_codings_are_understood(tmp_path: Path, picture: np.ndarray) -> None:
    np.testing.assert_array_equal(mask_of(tmp_path, picture), HALF == 1)


def test_empty_and_full_masks_stay_so(tmp_path: Path) -> None:
    assert not mask_of(tmp_path, HALF * 0).any()
    assert mask_of(tmp_path, HALF * 0 + 255).all()
    assert not mask_of(tmp_path, HALF * 0 + 120).any()


def test_mask_of_another_size_takes_the_nearest_pixel(tmp_path: Path) -> None:
    resized = mask_of(tmp_path, HALF * 255, 60, 33)
    assert resized.shape == (33, 60)
    np.testing.assert_array_equal(resized, np.arange(60)[None] >= 30 + 0 * np.arange(33)[:, None])


def test_faults_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found nothing"):
        mask_folder(tmp_path / "nowhere")
    with pytest.raises(InputError, match="found none"):
        mask_folder(tmp_path)
    colourful = np.dstack([HALF * 255, HALF * 0, HALF * 255])
    with pytest.raises(InputError, match=r"a\.png: expected a grey mask"):
        mask_of(tmp_path, colourful)
    with pytest.raises(InputError, match="'b'"):
        mask_folder(tmp_path).mask("b", 20, 10)
    with pytest.raises(InputError, match="missing: b0, b1, b2, b3, b4 and 2 more"):
        mask_folder(tmp_path).check(["a", *(f"b{number}" for number in range(7))])
    (tmp_path / "a.png").write_bytes(b"no picture")
    with pytest.raises(InputError, match=r"a\.png: cannot be decoded"):
        mask_folder(tmp_path).mask("a", 20, 10)
    with pytest.raises(InputError, match="found a file"):
        mask_folder(tmp_path / "a.png")
