"""Line segments in a picture, from any of several detectors, all in continuous pixel coordinates."""

from __future__ import annotations

from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Grey = NDArray[np.uint8]
SegmentDetector = Literal["hough", "lsd", "edlines", "fld"]

CANNY_SHARES = (0.75, 0.92)
"""Quantiles of the gradient that Canny takes for its two thresholds: one pixel in ten of a facade is on an edge."""

LEAST_CANNY = (12.0, 30.0)
"""Floors of the two (Sobel units, 8 per grey level), so that noise on an even picture makes no edges."""

HOUGH_VOTES_SHARE = 0.6
"""Votes a line needs in the Hough transform, as a share of the least length."""

MAX_GAP_PX = 5


def find_segments(grey: Grey, detector: SegmentDetector, min_length_px: float) -> Array:
    """Line segments of a grey 8-bit picture, shape (n, 4): x and y of both ends, ordered as the detector gives them.

    Raises
    ------
    ValueError
        Not a grey 8-bit picture, or no such detector.
    """
    if grey.ndim != 2 or grey.dtype != np.uint8:
        raise ValueError(f"grey: expected a picture of shape (h, w) and type uint8, got {grey.shape}, {grey.dtype}")
    if min(grey.shape) < 3:
        return np.empty((0, 4))
    if detector not in _DETECTORS:
        raise ValueError(f"detector: expected one of {', '.join(_DETECTORS)}, got {detector}")
    found = _DETECTORS[detector](np.ascontiguousarray(grey), min_length_px)
    segments = np.empty((0, 4)) if found is None else np.asarray(found, float).reshape(-1, 4) + 0.5
    return np.asarray(segments[lengths(segments) >= min_length_px])


def lengths(segments: Array) -> Array:
    """Of segments, shape (n, 4), in pixels."""
    return np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])


def canny_edges(grey: Grey) -> Grey:
    """Canny's edges with thresholds from the picture's own gradients, shape (h, w), 0 or 255."""
    dx = np.asarray(cv2.Sobel(grey, cv2.CV_16S, 1, 0))
    dy = np.asarray(cv2.Sobel(grey, cv2.CV_16S, 0, 1))
    sizes = np.abs(dx[::4, ::4].astype(np.int32)) + np.abs(dy[::4, ::4])
    low, high = (max(floor, float(q)) for floor, q in zip(LEAST_CANNY, np.quantile(sizes, CANNY_SHARES), strict=True))
    return np.asarray(cv2.Canny(dx, dy, low, high), np.uint8)


def _hough(grey: Grey, min_length_px: float) -> Any:
    smooth = np.asarray(cv2.GaussianBlur(grey, (0, 0), 1.0), np.uint8)
    votes = max(10, round(HOUGH_VOTES_SHARE * min_length_px))
    return cv2.HoughLinesP(
        canny_edges(smooth), 1.0, np.pi / 360.0, votes, minLineLength=min_length_px, maxLineGap=MAX_GAP_PX
    )


def _lsd(grey: Grey, min_length_px: float) -> Any:
    return cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD).detect(grey)[0]


def _edlines(grey: Grey, min_length_px: float) -> Any:
    drawing = cv2.ximgproc.createEdgeDrawing()
    settings = cv2.ximgproc.EdgeDrawing.Params()
    settings.MinLineLength = max(5, round(min_length_px))
    drawing.setParams(settings)
    drawing.detectEdges(grey)
    return drawing.detectLines()


def _fld(grey: Grey, min_length_px: float) -> Any:
    low, high = 20.0, 50.0
    return cv2.ximgproc.createFastLineDetector(max(5, round(min_length_px)), 1.414, low, high, 3, True).detect(grey)


_DETECTORS = {"hough": _hough, "lsd": _lsd, "edlines": _edlines, "fld": _fld}
