"""Letters of the charts of a flight: at any height of the chart and size of letters none lies over another."""

import itertools

import pytest
from PySide6.QtCore import QRectF

from groundstation.gui.charts.profile_chart import ProfileChart
from groundstation.gui.widgets.theme import Theme, apply_theme
from groundstation.services.mission.waypoints import HeightLimits, plan_profiles
from tests.missions.plans import example_plan

LIMITS = HeightLimits(ground_m=0.0, legal_m=26.0, floor_m=1.0, ceiling_m=25.0, is_level=True)
"""All of them close together, where the flight is: the hardest case."""


@pytest.fixture
def chart(application):
    chart = ProfileChart()
    chart.set_curves(plan_profiles(example_plan()), LIMITS)
    yield chart
    chart.close()
    apply_theme(application, Theme.LIGHT)


def boxes(chart) -> dict[str, QRectF]:
    """Where names stand in the chart of heights, px."""
    plot = chart.plots()[0]
    shown = [name.item for name in chart._names if name.item.isVisible()]
    return {item.toPlainText(): item.mapRectToItem(plot.vb, item.textItem.boundingRect()) for item in shown}


def settle(application) -> None:
    """Sizes are handed down from the window to the scene and its axes, an event each."""
    for _ in range(20):
        application.processEvents()


@pytest.mark.long
@pytest.mark.few(5)
@pytest.mark.parametrize("points", [9.0, 14.4, 18.0])
@pytest.mark.parametrize("size", [(1000, 300), (900, 150), (640, 110), (420, 80), (200, 60)])
def test_names_of_lines_lie_beside_each_other_and_within_the_chart(application, chart, size, points):
    apply_theme(application, Theme.LIGHT, points / 10.0)
    chart.resize(*size)
    chart.show()
    settle(application)
    room = chart.plots()[0].vb.rect().adjusted(-1.0, -1.0, 1.0, 1.0)
    found = boxes(chart)
    for name, box in found.items():
        assert room.contains(box), name
    for (one, first), (other, second) in itertools.combinations(found.items(), 2):
        assert not first.adjusted(1.0, 1.0, -1.0, -1.0).intersects(second), (one, other)
    if size == (1000, 300) and points == 9.0:
        assert [text.rpartition(" ")[0].rpartition(" ")[0] for text in found] == [
            "ground",
            "legal ceiling",
            "airspace floor",
            "airspace ceiling",
        ]


@pytest.mark.long
def test_titles_of_axes_are_as_large_as_the_windows_letters_and_smaller_where_the_chart_is_low(application, chart):
    apply_theme(application, Theme.LIGHT, 1.6)
    axis = chart.plots()[0].getAxis("left")
    for height_px, has_room in ((300, True), (110, False)):
        chart.resize(900, height_px)
        chart.show()
        settle(application)
        points = axis.label.font().pointSizeF()
        assert (points == 16.0) == has_room
        assert not axis.label.isVisible() or axis.label.boundingRect().width() <= axis.size().height() + 12.0
