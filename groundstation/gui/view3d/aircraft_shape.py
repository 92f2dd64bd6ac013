"""A quadrotor as it is drawn: arms, propellers, nose and camera, as a mesh in 3-D and as a symbol on the map."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from groundstation.gui.view3d.drawables import ON_TOP, Drawable, outlines
from groundstation.gui.view3d.paint import flat, shaded
from groundstation.gui.widgets.theme import Colours
from planning.geo.frames import Angles, camera_axes

Array = NDArray[np.float64]

# Body axes: x right, y to the nose, z up; the unit is half the distance between opposite motors.

ARM = 1.0 / math.sqrt(2.0)
"""Of a motor, to the right and ahead: the arms stand across."""

PROPELLER, N_CORNERS = 0.56, 16
"""Radius of a propeller's disc, and the corners that it is drawn with."""

ARM_HALF_WIDTH = 0.08
BODY_HALF = (0.30, 0.46, 0.15)
NOSE = 0.86
CAMERA_LENGTH = 0.55


LEAST_SPAN_M, SPAN_PX = 1.0, 46.0
"""Span of the aircraft as it is drawn: larger than it is, so that it is found in a view of the whole site."""


def shown_span_m(metres_per_px: float) -> float:
    """The span to draw an aircraft with where a pixel is so large."""
    return max(LEAST_SPAN_M, SPAN_PX * metres_per_px)


def _box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Array:
    """The six faces of a box, shape (6, 4, 3), counter-clockwise from outside."""
    x, y, z = (np.array([a, b]) for a, b in zip(low, high, strict=True))
    faces = (
        ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
        ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
        ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
        ((1, 1, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1)),
        ((0, 1, 0), (0, 0, 0), (0, 0, 1), (0, 1, 1)),
        ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    )
    return np.array([[(x[i], y[j], z[k]) for i, j, k in face] for face in faces], np.float64)


MOTORS = np.array([(ARM, ARM, 0.16), (-ARM, ARM, 0.16), (ARM, -ARM, 0.16), (-ARM, -ARM, 0.16)])


def _rims() -> Array:
    """The circles of the propellers, shape (4, n, 3)."""
    angle = np.arange(N_CORNERS) * 2.0 * math.pi / N_CORNERS
    circle = PROPELLER * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    return MOTORS[:, None] + circle


def _discs() -> Array:
    """The discs of the propellers as fans of quadrilaterals, shape (4 n, 4, 3); the front ones are the first half."""
    angle = np.linspace(0.0, 2.0 * math.pi, N_CORNERS + 1)
    rim = PROPELLER * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    fans = []
    for centre in MOTORS:
        for i in range(0, N_CORNERS, 2):
            fans.append([centre, centre + rim[i], centre + rim[i + 1], centre + rim[i + 2]])
    return np.array(fans)


def _arms() -> Array:
    """Two bars across, as quadrilaterals that are seen from above and below, shape (2, 4, 3)."""
    bars = []
    for side in (1.0, -1.0):
        along = np.array([side * ARM, ARM, 0.1])
        aside = ARM_HALF_WIDTH * np.array([ARM, -side * ARM, 0.0])
        back = np.array([-side * ARM, -ARM, 0.1])
        bars.append([along - aside, along + aside, back + aside, back - aside])
    return np.array(bars)


def _nose() -> Array:
    """An arrowhead on top that points ahead, shape (1, 4, 3)."""
    return np.array([[(0.0, NOSE, 0.17), (-0.3, 0.25, 0.17), (0.0, 0.38, 0.17), (0.3, 0.25, 0.17)]])


BODY = _box((-BODY_HALF[0], -BODY_HALF[1], -BODY_HALF[2]), BODY_HALF)
RIMS, DISCS, ARMS, NOSE_ARROW = _rims(), _discs(), _arms(), _nose()


def body_axes(attitude: Angles) -> Array:
    """Right, ahead and up of the airframe in ENU, the rows of a matrix, shape (3, 3).

    Heading first, then pitch (nose up), then roll (right side down), as autopilots report them.
    """
    ahead, right, up = camera_axes(attitude.heading_rad, attitude.pitch_rad)
    c, s = math.cos(attitude.roll_rad), math.sin(attitude.roll_rad)
    return np.stack([c * right - s * up, ahead, s * right + c * up])


def aircraft_drawables(
    place_enu_m: Array, attitude: Angles, camera: Angles | None, span_m: float, look: Colours
) -> list[Drawable]:
    """The quadrotor at a place; propellers' rims and camera are drawn over everything, so that no wall hides it.

    Parameters
    ----------
    span_m
        Distance between opposite motors as it is drawn.
    camera
        Where the camera points; a short thick line from the body shows it.
    """
    axes, scale = body_axes(attitude), 0.5 * span_m

    def placed(corners: Array) -> Array:
        return np.asarray(place_enu_m + scale * corners @ axes)

    def quads(*parts: tuple[Array, str], opacity: float = 1.0) -> Drawable:
        at = placed(np.concatenate([corners for corners, _ in parts]))
        normals = np.cross(at[:, 2] - at[:, 0], at[:, 3] - at[:, 1])
        colours = np.concatenate([flat(colour, len(corners), opacity) for corners, colour in parts])
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        shading = shaded(colours, normals / np.maximum(lengths, 1e-12))
        return Drawable(at.reshape(-1, 3), np.arange(4 * len(at)).reshape(-1, 4), shading)

    half = len(DISCS) // 2
    lines, cells = outlines(placed(RIMS))
    found = [
        quads((DISCS[:half], look.error), (DISCS[half:], look.accent), opacity=0.55),
        quads((ARMS, look.text), (BODY, look.muted), (NOSE_ARROW, look.error)),
        Drawable(lines, cells, flat(look.text, len(cells)), width_px=2.0, depth_shift=ON_TOP),
    ]
    if camera is not None:
        forward, _, _ = camera_axes(camera.heading_rad, camera.pitch_rad)
        eye = np.array([0.0, 0.9 * BODY_HALF[1], -BODY_HALF[2]]) @ axes
        ends = place_enu_m + scale * np.stack([eye, eye + CAMERA_LENGTH * forward])
        found.append(Drawable(ends, np.array([[0, 1]]), flat(look.text, 1), width_px=6.0, depth_shift=ON_TOP))
    return found


def paint_aircraft(
    painter: QPainter,
    at: QPointF,
    heading_rad: float,
    camera_heading_rad: float | None,
    radius_px: float,
    look: Colours,
) -> None:
    """The quadrotor from above, north up: the front propellers and the nose in another colour, the camera's sight."""
    painter.save()
    painter.translate(at)
    if camera_heading_rad is not None:
        painter.save()
        painter.rotate(math.degrees(camera_heading_rad))
        painter.setPen(QPen(QColor(look.accent), 2))
        for side in (-1.0, 1.0):
            painter.drawLine(QPointF(0.0, 0.0), QPointF(side * 1.1 * radius_px, -2.6 * radius_px))
        painter.restore()
    painter.rotate(math.degrees(heading_rad))
    arm, disc = radius_px * ARM, radius_px * PROPELLER
    painter.setPen(QPen(QColor(look.base), 7))
    for _ in range(2):
        painter.drawLine(QPointF(-arm, -arm), QPointF(arm, arm))
        painter.drawLine(QPointF(-arm, arm), QPointF(arm, -arm))
        painter.setPen(QPen(QColor(look.text), 3))
    for x, y in ((-arm, -arm), (arm, -arm), (-arm, arm), (arm, arm)):
        colour = QColor(look.error if y < 0.0 else look.accent)
        painter.setPen(QPen(QColor(look.text), 1.5))
        colour.setAlpha(170)
        painter.setBrush(colour)
        painter.drawEllipse(QPointF(x, y), disc, disc)
    painter.setBrush(QColor(look.error))
    painter.setPen(QPen(QColor(look.base), 1.5))
    nose = [(0.0, -1.15), (0.38, 0.25), (0.0, 0.02), (-0.38, 0.25)]
    painter.drawPolygon(QPolygonF([QPointF(radius_px * x, radius_px * y) for x, y in nose]))
    painter.restore()
