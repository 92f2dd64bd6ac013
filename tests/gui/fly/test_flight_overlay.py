"""Figures, attitude, warnings and the aircraft as they are drawn over the view."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter

from groundstation.gui.fly.flight_overlay import WarningBanner
from groundstation.gui.fly.readouts_view import LETTERS, TAPE_DEG, AttitudeView, FlightFigures, tape_font, tape_marks
from groundstation.gui.view3d.aircraft_shape import aircraft_drawables, body_axes, paint_aircraft
from groundstation.gui.widgets.theme import LIGHT
from groundstation.services.fly.announce import aged_warnings, ordered_warnings
from groundstation.services.fly.events import LinkState, LiveView, Readouts, ViewState
from groundstation.services.units import UnitSystem
from groundstation.vehicle.preflight import OnBoard
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import Timed, VehicleState
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity
from planning.base.messages import say
from planning.geo.frames import Angles

SHOWN = Readouts(
    height_m=20.0,
    above_ground_m=21.5,
    speed_m_s=3.2,
    facade_m=12.4,
    least_facade_m=10.0,
    battery=0.63,
    battery_left_s=601.0,
    wind_m_s=4.1,
    wind_from_deg=240.0,
    to_go_s=95.0,
    next_photo_s=7.0,
)
STATES = tuple(zip("abcd", (ViewState.TAKEN, ViewState.MISSING, ViewState.NEXT, ViewState.TO_COME), strict=True))


def view_of(warnings=(), link=LinkState.ALIVE, readouts=SHOWN, states=STATES):
    state = VehicleState(heartbeat=Timed(5, 100.0))
    return LiveView(
        link, 1.0, Phase.FLYING, state, (), warnings, OnBoard(), ("", 0.0, 0.0), frozenset(), readouts, states
    )


def warning(code, severity, since_s):
    return FlightWarning(code, severity, say("the wind is {:.1f} m/s", 9.0), since_s, 9.0, 8.0, "m/s")


def test_figures_are_those_of_the_flight_in_the_units_of_the_user(application):
    figures = FlightFigures()
    figures.set_view(view_of())
    text = figures.text()
    assert "above ground: 21.5 m" in text
    assert "to the facade, min 10.0 m: 12.4 m" in text
    assert "battery, reserve in 10:01: 63%" in text
    assert "to go: 1:35" in text
    assert "next photo, 1 missing: 3/4" in text
    assert "wind, 240°: 4.1 m/s" in text
    figures.set_units(UnitSystem.IMPERIAL)
    assert "above ground: 70.5 ft" in figures.text()
    figures.set_view(None)
    assert "above ground: -" in figures.text()


def test_a_figure_that_a_warning_is_about_stands_on_its_colour_and_an_old_one_is_grey(application):
    figures = FlightFigures()
    figures.resize(200, 600)

    def has(colour):
        image = figures.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
        rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)[..., 2::-1]
        wanted = QColor(colour).getRgb()[:3]
        return int((rows == wanted).all(axis=2).sum())

    figures.set_view(view_of())
    assert has(LIGHT.error) == 0
    ink = has(LIGHT.text)
    figures.set_view(view_of((warning("facade-distance", Severity.ERROR, 90.0),)))
    assert has(LIGHT.error) > 4000
    figures.set_view(view_of(link=LinkState.LOST))
    assert has(LIGHT.text) < 0.1 * ink


@pytest.mark.parametrize("high", [60, 200, 700])
def test_figures_fit_whatever_room_they_get(application, high):
    figures = FlightFigures()
    figures.set_view(view_of())
    figures.resize(120, high)
    assert not figures.grab().isNull()


@given(st.floats(-math.pi, math.pi), st.floats(-1.5, 1.5), st.floats(-math.pi, math.pi))
def test_axes_of_the_airframe_are_orthonormal_and_right_handed(heading, pitch, roll):
    axes = body_axes(Angles(heading, pitch, roll))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_the_airframe_rolls_its_right_side_down_and_pitches_its_nose_up():
    east = body_axes(Angles(math.radians(90.0), 0.0, math.radians(30.0)))
    np.testing.assert_allclose(east[1], [1.0, 0.0, 0.0], atol=1e-12)
    assert east[0] @ [0.0, 0.0, 1.0] == pytest.approx(-0.5), "the right side is down"
    assert body_axes(Angles(0.0, math.radians(20.0), 0.0))[1][2] > 0.3, "the nose is up"


def test_the_aircraft_is_as_large_as_asked_and_stands_where_it_is():
    place = np.array([10.0, -4.0, 30.0])
    parts = aircraft_drawables(place, Angles(0.3, 0.05, -0.1), Angles(0.3, -0.4, 0.0), 4.0, LIGHT)
    points = np.concatenate([part.points_enu_m for part in parts])
    reach = np.linalg.norm(points - place, axis=1).max()
    assert 2.0 < reach < 4.0
    assert np.linalg.norm(points.mean(axis=0) - place) < 0.5
    assert len(aircraft_drawables(place, Angles(0.3, 0.0, 0.0), None, 4.0, LIGHT)) == len(parts) - 1


def test_the_symbol_on_the_map_turns_with_the_heading(application):
    def painted(heading_deg):
        image = QImage(80, 80, QImage.Format.Format_RGB32)
        image.fill(QColor("white"))
        painter = QPainter(image)
        paint_aircraft(painter, image.rect().center().toPointF(), math.radians(heading_deg), None, 17.0, LIGHT)
        painter.end()
        found = np.frombuffer(image.constBits(), np.uint8).reshape(80, 80, 4)[..., 2::-1].astype(int)
        red = (found[..., 0] - found[..., 2]) > 60
        y, x = np.nonzero(red)
        return x.mean() - 39.5, y.mean() - 39.5

    assert painted(0.0)[1] < -2.0, "the red front is to the north"
    assert painted(90.0)[0] > 2.0
    assert painted(180.0)[1] > 2.0


def test_warnings_stand_until_they_are_over_the_worst_and_newest_first(application):
    banner = WarningBanner()
    found = (
        warning("wind", Severity.WARNING, 40.0),
        warning("battery", Severity.ERROR, 50.0),
        warning("gnss", Severity.WARNING, 60.0),
        warning("airspace", Severity.ERROR, 95.0),
    )
    assert [each.code for each in ordered_warnings(found)] == ["airspace", "battery", "gnss", "wind"]
    assert banner.set_warnings(aged_warnings(view_of(found)))
    lines = banner.text().splitlines()
    assert lines[0].startswith("DANGER (0:06): the wind is 9.0 m/s")
    assert lines[1].startswith("DANGER (0:51)")
    assert lines[3] == "1 more in the list"
    assert not banner.set_warnings(aged_warnings(view_of(found))), "nothing is different"
    wide, narrow = banner.height_for(700), banner.height_for(200)
    assert 4 * banner.fontMetrics().height() < wide < narrow, "all lines have room"
    banner.set_warnings(aged_warnings(view_of()))
    assert banner.is_empty()


def test_words_of_the_heading_tape_are_whole_and_there_are_some_on_both_sides(application):
    room, box, metrics = (
        QRectF(0.0, 0.0, 208.0, 40.0),
        QRectF(80.0, 0.0, 48.0, 26.0),
        QFontMetricsF(tape_font(application.font())),
    )
    for heading in range(360):
        shown = [(x, text) for x, text, is_whole in tape_marks(float(heading), room, box, metrics) if is_whole]
        wide = [metrics.horizontalAdvance(text) for _, text in shown]
        rooms = [QRectF(x - 0.5 * width, 6.0, width, 16.0) for (x, _), width in zip(shown, wide, strict=True)]
        assert all(room.contains(words) and not box.intersects(words) for words in rooms), heading
        assert min(x for x, _ in shown) < box.left() < box.right() < max(x for x, _ in shown), heading
        for x, text in shown:
            mark = next((mark for mark, letters in LETTERS.items() if letters == text), None)
            off_deg = ((int(text) if mark is None else mark) - heading + 180.0) % 360.0 - 180.0
            assert x == pytest.approx(104.0 + off_deg * 208.0 / TAPE_DEG)


def test_attitude_is_shown_and_said(application):
    view = AttitudeView()
    view.resize(view.sizeHint())
    assert view.text() == ""
    blank = view.grab().toImage()
    angles = Angles(math.radians(-10.0), math.radians(5.0), math.radians(-20.0))
    view.set_angles(angles, Angles(0.0, math.radians(-30.0), 0.0))
    assert view.text() == "heading 350°, pitch +5°, roll -20°"
    level = view.grab().toImage()
    assert level != blank
    view.set_angles(dataclasses.replace(angles, roll_rad=0.4), None)
    assert view.grab().toImage() != level
