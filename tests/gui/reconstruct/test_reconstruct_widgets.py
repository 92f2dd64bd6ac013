"""Widgets of the Reconstruct tab by themselves."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QFocusEvent, QImage, QKeyEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from groundstation.gui.charts.axes import Line, LinesPlot
from groundstation.gui.reconstruct.choice_side import ChoiceForm
from groundstation.gui.reconstruct.model_view import (
    FASTER,
    FLIGHT_MS,
    FLYING,
    GRAB_PX,
    LONGEST_S,
    SHARE_S,
    STEP_WHEEL,
    TURN_RAD_KEY,
    TURN_RAD_PX,
    GuidedCamera,
    ModelView,
    flight,
)
from groundstation.gui.reconstruct.reconstruct_page import ProgressPage
from groundstation.gui.reconstruct.view_pictures import image_of, layer_names
from groundstation.gui.widgets.photo_strip import SIDE_PX, Thumbnails
from groundstation.services.reconstruct.choices import TrainChoice
from groundstation.services.reconstruct.curves import ThinCurve
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.training.layers import LAYERS, PICTURE
from tests.gui.driving import turn_until


@pytest.fixture
def view(application):
    view = ModelView()
    view.resize(400, 300)
    view.show()
    view.heard = []
    view.orbited.connect(lambda *way: view.heard.append(("orbited", *way)))
    view.turned.connect(lambda *way: view.heard.append(("turned", *way)))
    view.moved.connect(lambda *way: view.heard.append(("moved", *way)))
    view.flown.connect(lambda *way: view.heard.append(("flown", *way)))
    view.homeRequested.connect(lambda: view.heard.append(("home",)))
    yield view
    view.hide()


def plain(colour, width=200, height=150):
    image = QImage(width, height, QImage.Format.Format_RGB32)
    image.fill(colour)
    return image


@pytest.mark.parametrize(
    ("key", "modifier", "heard"),
    [
        (Qt.Key.Key_Left, Qt.KeyboardModifier.NoModifier, ("orbited", -TURN_RAD_KEY, 0.0)),
        (Qt.Key.Key_Up, Qt.KeyboardModifier.NoModifier, ("orbited", 0.0, TURN_RAD_KEY)),
        (Qt.Key.Key_Right, Qt.KeyboardModifier.ControlModifier, ("turned", TURN_RAD_KEY, 0.0)),
        (Qt.Key.Key_Plus, Qt.KeyboardModifier.NoModifier, ("moved", 0.0, 0.0, STEP_WHEEL)),
        (Qt.Key.Key_Minus, Qt.KeyboardModifier.NoModifier, ("moved", 0.0, 0.0, -STEP_WHEEL)),
        (Qt.Key.Key_0, Qt.KeyboardModifier.NoModifier, ("home",)),
    ],
)
def test_keys_lead_the_camera(view, key, modifier, heard):
    QTest.keyClick(view, key, modifier)
    assert view.heard == [heard]


def test_held_keys_fly_until_they_are_let_go(application, view):
    QTest.keyPress(view, Qt.Key.Key_W)
    turn_until(application, lambda: len(view.heard) >= 3)
    QTest.keyPress(view, Qt.Key.Key_D)
    turn_until(application, lambda: view.heard[-1][1] > 0.0)
    assert view.heard[-1][1] == view.heard[-1][3]
    QTest.keyRelease(view, Qt.Key.Key_W)
    n = len(view.heard)
    turn_until(application, lambda: len(view.heard) > n)
    assert all(name == "flown" and forward >= 0.0 == up for name, _, up, forward in view.heard)
    assert view.heard[-1][3] == 0.0
    QTest.keyRelease(view, Qt.Key.Key_D)
    n = len(view.heard)
    QTest.qWait(3 * FLIGHT_MS)
    assert len(view.heard) == n


def test_flight_ends_where_the_keyboard_goes_elsewhere(application, view):
    QTest.keyPress(view, Qt.Key.Key_S)
    turn_until(application, lambda: view.heard)
    QApplication.sendEvent(view, QFocusEvent(QEvent.Type.FocusOut))
    n = len(view.heard)
    QTest.qWait(3 * FLIGHT_MS)
    assert len(view.heard) == n


def test_keys_that_fly_are_no_shortcuts_and_others_are(view):
    for key, modifier, is_taken in (
        (Qt.Key.Key_W, Qt.KeyboardModifier.NoModifier, True),
        (Qt.Key.Key_W, Qt.KeyboardModifier.ShiftModifier, True),
        (Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier, False),
        (Qt.Key.Key_F, Qt.KeyboardModifier.NoModifier, False),
    ):
        asked = QKeyEvent(QEvent.Type.ShortcutOverride, key, modifier)
        asked.ignore()
        QApplication.sendEvent(view, asked)
        assert asked.isAccepted() == is_taken


@given(st.sets(st.sampled_from(list(FLYING))), st.floats(0.0, 10.0), st.booleans())
def test_flight_is_as_fast_in_every_direction_and_never_leaps(held, seconds, is_fast):
    length = math.hypot(*flight(held, seconds, is_fast))
    fastest = SHARE_S * min(seconds, LONGEST_S) * (FASTER if is_fast else 1.0)
    assert length == pytest.approx(fastest) or length == 0.0
    # Opposite keys are none at all.
    assert not any(flight(list(FLYING), seconds, is_fast))
    alone = [flight([key], 0.1, False) for key in FLYING]
    assert np.allclose(np.sum(alone, axis=0), 0.0)
    assert len(set(alone)) == len(FLYING)


def test_what_is_flown_to_stays_as_far_away(view):
    guided = GuidedCamera(view)
    lens = Intrinsics(640, 480, 500.0, 500.0, 320.0, 240.0)
    guided.camera, guided.distance_m = PosedPhoto("a", Path("a"), lens, Pose(np.zeros(3), np.eye(3))), 10.0
    view.flown.emit(0.1, 0.2, 0.3)
    assert np.allclose(guided.camera.pose.position_enu_m, [1.0, -2.0, 3.0])
    assert guided.distance_m == 10.0
    view.moved.emit(0.0, 0.0, 0.5)
    assert guided.distance_m == 5.0


def test_shift_and_arrows_shift(view):
    QTest.keyClick(view, Qt.Key.Key_Down, Qt.KeyboardModifier.ShiftModifier)
    ((name, right, up, forward),) = view.heard
    assert (name, right, forward) == ("moved", 0.0, 0.0)
    assert up < 0.0


def drag(view, start, end, button=Qt.MouseButton.LeftButton, modifier=Qt.KeyboardModifier.NoModifier):
    from PySide6.QtCore import QEvent
    from PySide6.QtGui import QMouseEvent

    kinds = (
        (QEvent.Type.MouseButtonPress, start, button),
        (QEvent.Type.MouseMove, end, button),
        (QEvent.Type.MouseButtonRelease, end, Qt.MouseButton.NoButton),
    )
    for kind, place, buttons in kinds:
        event = QMouseEvent(kind, QPointF(place), view.mapToGlobal(QPointF(place)), button, buttons, modifier)
        {
            QEvent.Type.MouseButtonPress: view.mousePressEvent,
            QEvent.Type.MouseMove: view.mouseMoveEvent,
            QEvent.Type.MouseButtonRelease: view.mouseReleaseEvent,
        }[kind](event)


def test_dragging_takes_the_scene_along(view):
    view.set_pictures(plain(Qt.GlobalColor.red), None)
    drag(view, QPoint(100, 100), QPoint(120, 90))
    # The scene goes with the hand: the camera flies the other way round.
    assert view.heard == [("orbited", pytest.approx(-20 * TURN_RAD_PX), pytest.approx(-10 * TURN_RAD_PX))]
    drag(view, QPoint(100, 100), QPoint(130, 100), Qt.MouseButton.RightButton)
    name, right, up, forward = view.heard[-1]
    assert (name, up, forward) == ("moved", 0.0, 0.0)
    assert right == pytest.approx(-30.0 / 300.0)


def test_the_wheel_comes_nearer(view):
    middle = QPointF(200, 150)
    event = QWheelEvent(
        middle,
        view.mapToGlobal(middle),
        QPoint(),
        QPoint(0, 120),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    view.wheelEvent(event)
    assert view.heard == [("moved", 0.0, 0.0, pytest.approx(STEP_WHEEL))]


def test_the_line_divides_two_pictures_and_is_dragged(view):
    values = []
    view.valueChanged.connect(values.append)
    view.set_pictures(plain(Qt.GlobalColor.red), plain(Qt.GlobalColor.blue))
    shown = view.grab().toImage()
    assert shown.pixelColor(100, 200).red() == 255
    assert shown.pixelColor(300, 200).blue() == 255
    drag(view, QPoint(200 + int(GRAB_PX) - 2, 150), QPoint(320, 150))
    assert values == [pytest.approx(0.8)]
    assert view.heard == []
    assert view.grab().toImage().pixelColor(300, 200).red() == 255
    view.setValue(7.0)
    assert view.value() == 1.0
    # With one picture there is no line to take hold of.
    view.set_pictures(plain(Qt.GlobalColor.red), None)
    drag(view, QPoint(400, 150), QPoint(380, 150))
    assert view.heard[-1][0] == "orbited"


def test_pictures_keep_their_shape_and_notes_stand_in_their_place(view):
    view.set_pictures(plain(Qt.GlobalColor.red, 400, 100), None)
    assert (view.room().width(), view.room().height()) == (400.0, 100.0)
    view.set_pictures(None, None)
    view.set_note("nothing yet")
    view.grab()
    assert view.note() == "nothing yet"


def test_pictures_come_over_as_they_are():
    picture = np.zeros((4, 7, 3), np.uint8)
    picture[1, 2] = (10, 200, 30)
    image = image_of(picture)
    assert (image.width(), image.height()) == (7, 4)
    assert image.pixelColor(2, 1).getRgb()[:3] == (10, 200, 30)


def test_every_layer_has_a_name(application):
    names = layer_names()
    assert set(names) == {PICTURE, *LAYERS}
    assert len(set(names.values())) == len(names)


def test_a_choice_is_shown_and_given_back(application):
    form = ChoiceForm()
    heard = []
    form.valueChanged.connect(heard.append)
    for choice in (
        TrainChoice(),
        TrainChoice("2dgs", "overnight"),
        TrainChoice(minutes=45.0),
        TrainChoice(light="mlp"),
    ):
        form.setValue(choice)
        assert form.value() == choice
        assert form._form.isRowVisible(form.minutes) == (choice.minutes is not None)
    assert heard == []
    form.setValue(TrainChoice())
    form.time.setCurrentIndex(form.time.count() - 1)
    assert heard[-1].minutes == form.minutes.value()
    form.minutes.setValue(7.0)
    assert heard[-1].minutes == 7.0
    form.time.setCurrentIndex(1)
    assert (heard[-1].preset, heard[-1].minutes) == ("1h", None)


def test_charts_are_drawn_whatever_comes(application):
    plot = LinesPlot("t", "y")
    plot.resize(300, 150)
    plot.grab()
    for y in ([], [3.0], [3.0, 3.0], [1.0, np.nan, 2.0], [0.0, 0.0], [1e-9, 2e-9]):
        x = np.arange(len(y), dtype=float)
        for n_lines in (1, 4):
            plot.set_lines(tuple(Line(f"line {n}", x, np.array(y)) for n in range(n_lines)))
            low, high = plot.range_y()
            assert low < high
            plot.grab()
    plot.resize(20, 20)
    plot.grab()


def test_progress_is_drawn_after_a_while_over_minutes_where_it_is_long(application):
    page = ProgressPage()
    page.set_state("", None)
    assert page.text() == "Nothing is being trained."
    quality, colour = ThinCurve(), ThinCurve()
    for seconds in (600.0, 1200.0):
        quality.add(seconds, 20.0)
        colour.add(seconds, 0.1)
    page.set_curves(quality, {"colour": colour})
    turn_until(application, lambda: bool(page.quality.lines()))
    assert page.quality.lines()[0].x.tolist() == [10.0, 20.0]
    assert page.losses.lines()[0].name == "colour"


def test_small_pictures_are_decoded_beside_the_window_and_damaged_ones_are_none(application, tmp_path):
    import cv2

    good, bad = tmp_path / "good.png", tmp_path / "bad.png"
    cv2.imwrite(str(good), np.full((600, 800, 3), (0, 0, 255), np.uint8))
    bad.write_bytes(b"no picture")
    store, ready = Thumbnails(), []
    store.ready.connect(ready.append)
    assert store.picture(good, 800) is None
    assert store.picture(bad, 800) is None
    assert store.picture(tmp_path / "none.png", 800) is None
    turn_until(application, lambda: len(ready) == 3)
    picture = store.picture(good, 800)
    assert (picture.width(), picture.height()) == (SIDE_PX, round(SIDE_PX * 0.75))
    assert picture.pixelColor(5, 5).getRgb()[:3] == (255, 0, 0)
    assert store.picture(bad, 800) is None
    store.close()
