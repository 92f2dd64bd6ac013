"""Blur in pixels: as much as was put in, whatever the picture shows."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from reconstruction.photos.quality import MOTION_TO_SIGMA, sharpness
from tests.reconstruction.photos.pictures import facade, moved


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("sigma", [1.0, 2.0, 3.0])
def test_a_known_blur_is_measured_on_any_picture(seed, sigma):
    found = sharpness(cv2.GaussianBlur(facade(seed), (0, 0), sigma))
    assert 0.85 * sigma < found.sigma_px < 1.15 * sigma


@pytest.mark.parametrize("seed", range(6))
def test_sharp_pictures_are_sharp(seed):
    assert sharpness(facade(seed)).sigma_px < 0.5


@pytest.mark.parametrize("length", [5, 9, 13])
def test_a_movement_counts_in_its_own_direction(length):
    along_x = sharpness(moved(facade(1), length))
    assert 0.9 * length * MOTION_TO_SIGMA < along_x.sigma_px
    assert length > 5 or along_x.sigma_px < 1.5 * length * MOTION_TO_SIGMA
    assert along_x.direction_deg == 0.0
    along_y = sharpness(np.ascontiguousarray(moved(facade(1).T, length).T))
    assert along_y.direction_deg == 90.0


def test_contrast_and_noise_hardly_matter():
    rng = np.random.default_rng(0)
    blurred = [cv2.GaussianBlur(facade(2, contrast=contrast), (0, 0), 2.0) for contrast in (30.0, 60.0, 110.0)]
    measured = [sharpness(picture).sigma_px for picture in blurred]
    noisy = np.clip(blurred[2] + rng.normal(0.0, 4.0, blurred[2].shape), 0, 255).astype(np.uint8)
    measured.append(sharpness(noisy).sigma_px)
    assert max(measured) - min(measured) < 0.25
    variances = [cv2.Laplacian(picture, cv2.CV_64F).var() for picture in blurred]
    assert max(variances) > 7.0 * min(variances)  # which is why it is not the measure here


def test_tiles_stand_for_a_large_picture():
    large = cv2.GaussianBlur(np.tile(facade(3, (600, 800)), (3, 3)), (0, 0), 2.0)
    assert sharpness(large).sigma_px == pytest.approx(sharpness(large[:600, :800]).sigma_px, abs=0.15)


@pytest.mark.parametrize(
    "grey",
    [
        np.zeros((300, 400), np.uint8),
        np.full((300, 400), 255, np.uint8),
        np.full((1, 1), 7, np.uint8),
        np.full((3, 5000), 7, np.uint8),
        np.tile(np.arange(256, dtype=np.uint8), (300, 1)),
    ],
    ids=["black", "white", "one pixel", "a strip", "a ramp"],
)
def test_where_there_are_no_edges_nothing_is_told(grey):
    assert sharpness(grey).sigma_px is None


def test_real_photos_are_sharp_and_blurred_by_what_is_added(shared_data):
    for path in (shared_data / "multiview" / "lund_door" / "DSC_0001.JPG", shared_data / "multiview/berlin/01.jpg"):
        grey = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        assert sharpness(grey).sigma_px < 0.9
        for sigma in (2.0, 3.0):
            assert 0.75 * sigma < sharpness(cv2.GaussianBlur(grey, (0, 0), sigma)).sigma_px < 1.05 * sigma
