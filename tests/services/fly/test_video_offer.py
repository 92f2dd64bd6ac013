"""The camera's own word for where its video is: asked for, judged, and never opened by itself."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.video import video_url
from groundstation.services.fly.video_offer import (
    MAV_CMD_REQUEST_MESSAGE,
    MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION,
    MPEG_TS,
    RTP_UDP,
    RTSP,
    TCP_MPEG,
    OfferedVideo,
    VideoFinder,
    offer_of,
)
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, CommandLong, Heartbeat, Received, VideoStreamInformation
from missions.simulator.vehicle import SimulatedVehicle
from tests.missions.simulator.ground import ORIGIN, PointMass

VEHICLE, CAMERA, GROUND = Address(1, 1), Address(1, 100), Address(255, 190)
URL = "rtsp://192.168.144.25:8554/main.264"


def stream(uri=URL, kind=RTSP, number=1, name="day"):
    return VideoStreamInformation(number, 1, kind, 1, 30.0, 1920, 1080, 4_000_000, 0, 80, name, uri)


def heartbeat(autopilot=3, kind=2):
    return Heartbeat(kind, autopilot, 0, 0, 4)


class Talk:
    """A finder, and what it says as time passes."""

    def __init__(self):
        self.finder, self.sent = VideoFinder(), []

    def hear(self, message, source, at_s):
        self.sent += self.finder.receive(Received(message, source, at_s))

    def until(self, end_s, start_s=0.0):
        now_s = start_s
        while now_s < end_s:
            self.sent += self.finder.tick(now_s)
            now_s += 0.1

    def asked(self):
        return [(each.target_component, each.command, each.param1) for each in self.sent]


def test_a_camera_that_is_heard_is_asked_and_what_it_tells_is_offered():
    talk = Talk()
    talk.hear(heartbeat(), VEHICLE, 0.0)
    talk.hear(heartbeat(8, 30), CAMERA, 0.0)
    talk.until(0.5)
    assert talk.asked() == [(100, MAV_CMD_REQUEST_MESSAGE, 269.0)]
    assert talk.finder.offered() is None
    talk.hear(stream(), CAMERA, 0.6)
    assert talk.finder.offered() == OfferedVideo("day", URL)
    talk.until(60.0, 0.6)
    assert len(talk.sent) == 1, "it is asked no more"


def test_one_that_does_not_answer_is_asked_in_the_old_way_too_and_then_left():
    talk = Talk()
    talk.hear(heartbeat(), VEHICLE, 0.0)
    talk.hear(heartbeat(8, 30), CAMERA, 0.0)
    talk.until(60.0)
    new, old = (100, MAV_CMD_REQUEST_MESSAGE, 269.0), (100, MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION, 0.0)
    assert talk.asked() == [new] * 3 + [old] * 3


def test_without_a_camera_on_the_link_the_autopilot_is_asked_and_never_by_a_command_that_others_await():
    talk = Talk()
    talk.hear(heartbeat(), VEHICLE, 0.0)
    talk.until(4.9)
    assert talk.sent == []
    talk.until(60.0, 4.9)
    assert set(talk.asked()) == {(1, MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION, 0.0)}
    talk.hear(stream(), VEHICLE, 60.0)
    assert talk.finder.offered().url == URL


def test_strangers_are_not_believed():
    talk = Talk()
    talk.hear(heartbeat(), VEHICLE, 0.0)
    talk.hear(heartbeat(8, 30), CAMERA, 0.0)
    talk.hear(heartbeat(8, 30), Address(7, 100), 0.0)
    talk.until(1.0)
    assert [each.target_system for each in talk.sent] == [1]
    talk.hear(stream(), Address(7, 100), 1.0)
    talk.hear(stream(), Address(1, 101), 1.0)
    assert talk.finder.offered() is None
    for number in range(200):
        talk.hear(stream(number=number), CAMERA, 2.0)
    assert len(talk.finder._streams) == 8


@pytest.mark.parametrize(
    ("kind", "uri", "url", "words"),
    [
        (RTSP, URL, URL, ""),
        (MPEG_TS, "udp://239.0.0.1:5600", "udp://239.0.0.1:5600", ""),
        (MPEG_TS, "5600", "udp://0.0.0.0:5600", ""),
        (MPEG_TS, "0.0.0.0:5600", "udp://0.0.0.0:5600", ""),
        (RTP_UDP, "5600", "udp://0.0.0.0:5600", ""),
        (RTP_UDP, "udp://10.0.0.1:5600", "udp://10.0.0.1:5600", ""),
        (TCP_MPEG, "tcp://10.0.0.1:5600", "", "over TCP, which is not read"),
        (RTSP, "rtsp://127.0.0.1:8554/x", "", "an address that holds on itself alone"),
        (RTSP, "rtsp://0.0.0.0:8554/x", "", "an address that holds on itself alone"),
        (RTSP, "rtsp://me:secret@10.0.0.1/x", "", "without a password"),
        (RTSP, "file:///etc/passwd", "", "expected rtsp://HOST:PORT/PATH"),
        (RTSP, "rtsp://h/x;rm -rf", "", "expected rtsp://HOST:PORT/PATH"),
        (RTSP, "", "", "without an address"),
        (99, URL, URL, ""),
    ],
)
def test_each_kind_is_an_address_or_has_words_that_say_what_to_do(kind, uri, url, words):
    found = offer_of(stream(uri, kind))
    assert found.url == url
    assert words in found.problem
    assert bool(found.url) != bool(found.problem)


LETTERS = st.characters(max_codepoint=0x2FF)


@given(st.text(LETTERS, max_size=200), st.integers(0, 255), st.text(LETTERS, max_size=40))
def test_whatever_is_told_is_an_address_that_may_be_typed_or_none(uri, kind, name):
    found = offer_of(stream(uri, kind, name=name))
    assert found.url == video_url(found.url)
    assert found.name.isprintable()


def test_a_stream_that_can_be_shown_comes_before_one_that_cannot():
    talk = Talk()
    talk.hear(heartbeat(), VEHICLE, 0.0)
    talk.hear(heartbeat(8, 30), CAMERA, 0.0)
    talk.hear(stream("5600", TCP_MPEG, 1), CAMERA, 1.0)
    assert talk.finder.offered().url == ""
    talk.hear(stream(number=2, name="night"), CAMERA, 1.0)
    assert talk.finder.offered() == OfferedVideo("night", URL)


def test_the_simulated_vehicle_tells_its_stream():
    vehicle = SimulatedVehicle(Autopilot.PX4, PointMass(), ORIGIN, is_ready=True)
    vehicle.video_streams = (stream(),)
    talk, now_s = Talk(), 0.0
    while talk.finder.offered() is None:
        now_s += 0.1
        assert now_s < 20.0
        out = vehicle.step(0.1)
        for asked in talk.finder.tick(now_s):
            assert isinstance(asked, CommandLong)
            out += vehicle.receive(Received(asked, GROUND, now_s))
        for message in out:
            talk.hear(message, VEHICLE, now_s)
    assert talk.finder.offered().url == URL
