"""The camera's picture beside the view: its video where it comes, else the site as it is drawn."""

import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.gui.fly.flight_overlay import MOVED_M, LiveCamera
from groundstation.gui.fly.flight_settings_page import SettingsPage
from groundstation.gui.view3d.canvas import image_array
from groundstation.services.fly.options import FlightSettings
from groundstation.services.fly.video_offer import OfferedVideo, VideoFinder
from groundstation.vehicle.state import Motion, Timed, VehicleState
from planning.geo.frames import Angles
from tests.gui.driving import click_on, turn_until, type_into
from tests.gui.fly.test_fly_page import connect, controller, page
from tests.services.fly.test_video import film, is_film, sent_by_udp
from tests.services.live_cases import sortie

__all__ = ["controller", "page"]


@pytest.fixture
def camera(application):
    camera = LiveCamera()
    camera.resize(240, camera.height_for(240))
    camera.show()
    yield camera
    camera.close_view()
    camera.close()


def looking(place, pitch_rad=-0.3):
    return VehicleState(
        motion=Timed(Motion(place, (0.0, 0.0, 0.0), 10.0), 0.0), camera=Timed(Angles(0.0, pitch_rad, 0.0), 0.0)
    )


def test_the_site_is_drawn_from_the_pose_that_the_vehicle_reports(application, camera):
    camera.set_sortie(sortie())
    x, y, z = sortie().case.plan.viewpoints[0].position_enu_m
    camera.look(VehicleState())
    assert camera.pose() is None
    camera.look(looking((x, y, z)))
    # Each part of the site is drawn in a turn of its own.
    turn_until(application, lambda: camera.pose() is not None)
    application.processEvents()
    first = camera._canvas.picture()
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 3
    camera.look(looking((x + 0.5 * MOVED_M, y, z)))
    assert camera.pose()[0] == x, "nothing that could be seen"
    camera.look(looking((x + 1.0, y, z), math.radians(20.0)))
    application.processEvents()
    assert camera.pose()[0] == x + 1.0
    assert (camera._canvas.picture() != first).any()
    assert camera.caption() == "Camera, drawn"
    heard = []
    camera.sizeToggled.connect(lambda: heard.append(True))
    QTest.mouseClick(camera, Qt.MouseButton.LeftButton)
    assert heard == [True]


@pytest.mark.slow
def test_the_video_takes_the_place_of_the_drawing_and_gives_it_back(application, camera, tmp_path):
    camera.set_sortie(sortie())
    with sent_by_udp(film(tmp_path / "film.ts", "mp4v", 100)) as url:
        camera.set_video(url)
        camera.show_video()
        assert camera.caption() == "Drawn: video awaited"
        turn_until(application, camera.shows_video)
        assert camera.caption() == "Camera, video"
        turn_until(application, lambda: is_film(image_array(camera._film.pixmap().toImage())))
    turn_until(application, lambda: not camera.shows_video())
    assert camera.caption() == "Drawn: no video"
    camera.set_video("")
    camera.show_video()
    assert camera.caption() == "Camera, drawn"


def test_the_address_of_the_video_is_taken_or_what_is_wrong_is_said(application):
    page, heard = SettingsPage(), []
    page.valueChanged.connect(heard.append)
    page.setValue(FlightSettings())
    for typed, words in (("file:///etc/passwd", "expected rtsp://HOST:PORT/PATH"), ("rtsp://a:b@c/", "password")):
        type_into(page.video, typed)
        page.video.editingFinished.emit()
        assert words in page.video_said()
    assert heard == []
    type_into(page.video, "udp://0.0.0.0:5600")
    page.video.editingFinished.emit()
    assert page.video_said() == ""
    assert heard == [replace(FlightSettings(), video="udp://0.0.0.0:5600")]


def test_the_video_that_the_camera_offers_is_shown_once_the_pilot_wants_it(application, camera):
    url = "rtsp://127.0.0.9:1/none"
    page = SettingsPage()
    chosen = []
    page.valueChanged.connect(chosen.append)
    camera.videoAccepted.connect(page.take_video)
    camera.set_sortie(sortie())
    camera.offer_video(None)
    assert camera.offer.isHidden()
    camera.offer_video(OfferedVideo("day", "", "the camera sends its video as RTP"))
    assert camera.offer.isHidden()
    page.offer_video(OfferedVideo("day", "", "the camera sends its video as RTP"))
    assert page.video_said() == "the camera sends its video as RTP"
    offered = OfferedVideo("day", url)
    page.offer_video(offered)
    assert page.video_said() == f"The vehicle's camera offers {url}"
    camera.offer_video(offered)
    assert camera.offer.isVisible()
    assert camera._stream is None, "nothing is opened by itself"
    QTest.mouseClick(camera.offer, Qt.MouseButton.LeftButton)
    assert chosen[-1].video == url
    assert page.video.text() == url
    camera.set_video(url)
    camera.offer_video(offered)
    assert camera.offer.isHidden()
    # What the pilot typed stays, whatever the camera offers.
    type_into(page.video, "rtsp://10.0.0.2/own")
    QTest.keyClick(page.video, Qt.Key.Key_Return)
    page.offer_video(offered)
    assert chosen[-1].video == page.video.text() == "rtsp://10.0.0.2/own"


@pytest.mark.slow
def test_the_flight_screen_takes_the_offer_by_a_click(application, controller, page, monkeypatch):
    monkeypatch.setattr(VideoFinder, "offered", lambda self: OfferedVideo("day", "udp://127.0.0.1:5999"))
    connect(application, page)
    turn_until(application, page.overlay.camera.offer.isVisible)
    click_on(controller.window, page.overlay.camera.offer)
    assert page.settings.value().video == "udp://127.0.0.1:5999"
    assert page.overlay.camera._url == "udp://127.0.0.1:5999"
    page.settings.take_video("")
