"""Photos that are nearly the same: a fingerprint of the picture, and pairs that agree in it and in their poses."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.cameras import Pose

Array = NDArray[np.float64]

SIDE_PX = 32
"""Size of the picture that the fingerprint is made of."""

KEPT = 8
"""Lowest frequencies along each side: 64 bits."""

LEAST_CONTRAST = 2.0
"""Standard deviation of the small picture, grey levels; below there is nothing to make a fingerprint of."""

NEAR_BITS = 10
"""Fingerprints of one view under small movements differ by fewer bits; those of unrelated pictures by 32 on average,
and by 10 or fewer once in 10^8 (binomial distribution)."""

SAME_BITS = 4
"""Where nothing is known of the poses: facades repeat themselves, and neighbouring views may look alike."""

NEAR_M, NEAR_DEG = 0.5, 2.0
"""Photos from places and in directions closer than this show reflections the same way: at 10 m distance, 0.5 m turn the
line of sight by 3 degrees, a tenth of a section."""

CHUNK = 512


def fingerprint(grey: NDArray[np.uint8]) -> int | None:
    """64 bits that stay nearly the same when a picture is scaled, brightened or moved a little; None without contrast.

    Signs of the lowest frequencies against their median (C. Zauner, "Implementation and benchmarking of perceptual
    image hash functions", 2010, section 3.2.1).
    """
    small = cv2.resize(grey, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA).astype(np.float32)
    if float(small.std()) < LEAST_CONTRAST:
        return None
    low = np.asarray(cv2.dct(small))[:KEPT, :KEPT].ravel()
    bits = low > np.median(low[1:])
    return int.from_bytes(np.packbits(bits).tobytes(), "big")


def like_pairs(fingerprints: list[int | None], poses: list[Pose] | None = None) -> list[tuple[int, int]]:
    """Pairs (i, j), i < j, of photos that show the same.

    With poses, from nearly the same place in nearly the same direction, and alike; without, all but equal.
    """
    known = np.array([index for index, print_ in enumerate(fingerprints) if print_ is not None], np.int64)
    prints = np.array([print_ for print_ in fingerprints if print_ is not None], np.uint64)
    pairs = _alike(prints, SAME_BITS) if poses is None else _near(prints, [poses[i] for i in known.tolist()])
    return [(int(known[i]), int(known[j])) for i, j in pairs]


def _near(prints: NDArray[np.uint64], poses: list[Pose]) -> list[tuple[int, int]]:
    from scipy.spatial import KDTree

    if len(poses) < 2:
        return []
    places = np.stack([pose.position_enu_m for pose in poses])
    rotations = np.stack([pose.cam_from_enu for pose in poses])
    pairs = KDTree(places).query_pairs(NEAR_M, output_type="ndarray")
    first, second = pairs[:, 0], pairs[:, 1]
    traces = np.einsum("kij,kij->k", rotations[first], rotations[second])
    is_near = traces >= 1.0 + 2.0 * np.cos(np.radians(NEAR_DEG))
    is_alike = np.bitwise_count(prints[first] ^ prints[second]) <= NEAR_BITS
    return [(int(i), int(j)) for i, j in sorted(map(tuple, pairs[is_near & is_alike].tolist()))]


def _alike(prints: NDArray[np.uint64], n_bits: int) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for start in range(0, len(prints), CHUNK):
        part = prints[start : start + CHUNK]
        near = np.bitwise_count(part[:, None] ^ prints[None, start:]) <= n_bits
        i, j = np.nonzero(np.triu(near, 1))
        found += zip((start + i).tolist(), (start + j).tolist(), strict=True)
    return found
