"""Photos that are nearly the same."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from reconstruction.base.cameras import Pose
from reconstruction.photos.quality import NEAR_BITS, fingerprint, like_pairs
from tests.reconstruction.photos.pictures import facade


def bits_apart(a, b):
    return (fingerprint(a) ^ fingerprint(b)).bit_count()


@pytest.mark.parametrize("seed", range(5))
def test_one_view_keeps_its_fingerprint_and_others_do_not(seed):
    grey = facade(seed)
    shifted = np.roll(grey, 6, axis=1)
    for same in (cv2.resize(grey, (320, 240)), cv2.convertScaleAbs(grey, alpha=0.8, beta=20), shifted):
        assert bits_apart(grey, same) <= NEAR_BITS
    assert bits_apart(grey, facade(seed + 100)) > 2 * NEAR_BITS


def test_a_picture_without_contrast_has_no_fingerprint():
    assert fingerprint(np.full((100, 100), 128, np.uint8)) is None
    assert fingerprint(np.zeros((1, 1), np.uint8)) is None


def looking(east, heading):
    return Pose.looking(np.array([east, -20.0, 5.0]), heading, 0.0)


def test_with_poses_both_must_agree():
    one, other = fingerprint(facade(0)), fingerprint(facade(9))
    poses = [looking(0.0, 0.0), looking(0.1, 1.0), looking(0.2, 0.0), looking(5.0, 0.0), looking(0.0, 30.0)]
    assert like_pairs([one, one, other, one, one], poses) == [(0, 1)]
    assert like_pairs([one, None, other, one, one], poses) == []
    assert like_pairs([one], poses[:1]) == []
    assert like_pairs([], []) == []


def test_without_poses_only_all_but_equal_pictures_count():
    one = fingerprint(facade(0))
    assert like_pairs([one, one ^ 0b111, one ^ 0xFF, None]) == [(0, 1)]


def test_many_photos_are_compared_in_chunks():
    rng = np.random.default_rng(0)
    prints = [int(value) for value in rng.integers(0, 2**63, 1500)]
    prints[1400] = prints[3] ^ 1
    assert like_pairs(prints) == [(3, 1400)]
