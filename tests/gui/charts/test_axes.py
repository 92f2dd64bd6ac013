"""Axes of charts: numbers at their places, whatever the ends are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QRectF
from PySide6.QtGui import QFontMetricsF, QImage, QPainter

from groundstation.gui.charts.axes import PAD_PX, Axes, box_of_axes, ticks
from groundstation.gui.widgets.theme import colours

BOX = QRectF(60.0, 10.0, 200.0, 100.0)


@pytest.mark.slow
@given(st.floats(1e-6, 1e7), st.floats(1e-3, 2.0))
def test_ticks_are_round_evenly_apart_and_far_enough(end, least):
    found = ticks(0.0, end, least)
    assert found[0] == 0.0
    assert found[-1] <= end * (1.0 + 1e-6)
    step = found[1] if len(found) > 1 else end + 1.0
    assert step >= least * end * (1.0 - 1e-6) or len(found) == 1
    assert np.allclose(np.diff(found), step)
    if len(found) > 1:
        assert f"{step:e}"[0] in "125"


@pytest.mark.parametrize("ends", [(0.0, 1.0), (21.3, 24.9), (0.00012, 0.00019), (1e6, 3e6), (-5.0, 5.0)])
def test_ticks_are_round_and_between_the_ends(ends):
    low, high = ends
    found = ticks(low, high, 0.15)
    assert 2 <= len(found) <= 8
    assert all(low - 1e-9 <= tick <= high * (1.0 + 1e-9) + 1e-12 for tick in found)


@given(st.floats(1e-3, 1e6), st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_the_corners_of_the_box_are_the_ends_of_the_axes(end_x, low, rise):
    axes = Axes(BOX, end_x, low + rise, low)
    first, last = axes.place(0.0, low), axes.place(end_x, low + rise)
    assert (first.x(), first.y()) == (BOX.left(), BOX.bottom())
    assert (last.x(), last.y()) == pytest.approx((BOX.right(), BOX.top()))


@pytest.mark.parametrize("title_y", ["", "PSNR"])
def test_an_upright_title_is_drawn_only_where_there_is_one(application, title_y):
    image = QImage(300, 200, QImage.Format.Format_RGB32)
    image.fill(0xFFFFFF)
    painter = QPainter(image)
    painter.setFont(application.font())
    box = box_of_axes(QRectF(image.rect()), painter.font())
    Axes(box, 10.0, 1.0).paint(painter, colours(), "time in s", title_y)
    painter.end()
    drawn = np.array(image.constBits()).reshape(200, 300, 4)[..., :3].min(axis=2) < 160
    beside = drawn[:, : int(PAD_PX + QFontMetricsF(application.font()).height())]
    assert bool(beside.any()) == bool(title_y)
    assert drawn[int(box.bottom()) + 2 :].any(), "numbers and a title below"


def test_there_is_always_a_box(application):
    for width, height in ((1.0, 1.0), (20.0, 15.0), (60.0, 300.0)):
        box = box_of_axes(QRectF(0.0, 0.0, width, height), application.font(), 12.0)
        assert min(box.width(), box.height()) >= 1.0
