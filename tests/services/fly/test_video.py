"""Live video: addresses, and pictures from streams that another program sends, on this computer."""

import socket
import threading
import time
from contextlib import contextmanager

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.video import MAX_URL_CHARACTERS, VideoPicture, VideoStream, video_url
from planning.base.errors import InputError


@pytest.mark.parametrize(
    "url",
    [
        "",
        "rtsp://192.168.42.1:8554/main.264",
        "rtsp://cam.local/live?x=1",
        "udp://0.0.0.0:5600",
        "rtsp://[fe80::1]:554/a",
    ],
)
def test_addresses_of_streams_are_taken(url):
    assert video_url(f"  {url} ") == url


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("file:///etc/passwd", "expected rtsp"),
        ("/etc/passwd", "expected rtsp"),
        ("concat:a|b", "expected rtsp"),
        ("rtsp://", "expected rtsp"),
        ("rtsp://a b", "expected rtsp"),
        ("rtsp://a/|pipe:0", "expected rtsp"),
        ("http://a/list.m3u8", "expected rtsp"),
        ("udp://0.0.0.0", "a port from 1"),
        ("udp://0.0.0.0:99999", "a port from 1"),
        ("rtsp://me:secret@cam/live", "without a password"),
        ("rtsp://a/" + "x" * MAX_URL_CHARACTERS, "expected rtsp"),
    ],
)
def test_what_is_no_stream_is_refused_and_the_secret_is_not_repeated(url, words):
    with pytest.raises(InputError, match=words) as refused:
        video_url(url)
    assert "secret" not in str(refused.value)


@given(st.text(max_size=60))
def test_whatever_a_vehicle_tells_is_an_address_or_is_refused(text):
    try:
        found = video_url(text)
    except InputError:
        return
    assert found == "" or found.startswith(("rtsp://", "udp://"))


def film(path, fourcc, n=60):
    """A red square that goes to the right."""
    writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*fourcc), 25.0, (320, 240))
    assert writer.isOpened()
    for number in range(n):
        picture = np.full((240, 320, 3), 40, np.uint8)
        picture[100:140, 4 * number : 4 * number + 40] = (0, 0, 255)
        writer.write(picture)
    writer.release()
    return path


@contextmanager
def sent_by_udp(path):
    """Send a film again and again to a port of this computer; yields its address."""
    sent, is_over = path.read_bytes(), threading.Event()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]

    def send():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            while not is_over.is_set():
                for start in range(0, len(sent), 7 * 188):
                    sender.sendto(sent[start : start + 7 * 188], ("127.0.0.1", port))
                    time.sleep(0.005)

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    try:
        yield f"udp://127.0.0.1:{port}"
    finally:
        is_over.set()
        sender.join()


def wait_for(condition, timeout_s=60.0):
    end = time.monotonic() + timeout_s
    while (found := condition()) is None or found is False or found == "":
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def is_film(picture):
    """Whether the red square is in it."""
    red = (picture[..., 0] > 150) & (picture[..., 1] < 100)
    return 0.01 < red.mean() < 0.05


@pytest.mark.slow
def test_a_film_comes_picture_by_picture_and_its_end_is_told(tmp_path):
    heard = []

    class Heard(VideoStream):
        def _take(self, message):
            heard.append(message)
            super()._take(message)

    stream = Heard(str(film(tmp_path / "film.mp4", "mp4v")), 160)
    try:
        assert "has stopped" in wait_for(stream.problem)
    finally:
        stream.close()
    pictures = [message for message in heard if isinstance(message, VideoPicture)]
    assert [each.number for each in pictures] == list(range(1, len(pictures) + 1))
    assert all(each.picture.shape == (120, 160, 3) and is_film(each.picture) for each in pictures)
    assert pictures


@pytest.mark.slow
def test_a_transport_stream_over_udp_is_shown(tmp_path):
    """As cameras and bridges send it: packets of seven cells of 188 bytes."""
    with sent_by_udp(film(tmp_path / "film.ts", "mp4v", 100)) as url:
        stream = VideoStream(video_url(url), 160)
        try:
            # Whoever joins late sees grey until the next whole picture.
            wait_for(lambda: (found := stream.latest()) is not None and is_film(found.picture))
        finally:
            stream.close()


def test_where_nothing_is_sent_that_is_told_and_it_ends_when_asked():
    stream = VideoStream("rtsp://127.0.0.1:1/none", 160)
    assert "no video can be opened at rtsp://127.0.0.1:1/none" in wait_for(stream.problem)
    started = time.monotonic()
    stream.close()
    assert time.monotonic() - started < 5.0
    assert "has ended" in stream.problem()


@pytest.mark.slow
@pytest.mark.parametrize("damage", ["noise", "cut", "playlist"])
def test_a_damaged_stream_ends_nothing_but_the_video(tmp_path, damage):
    path = film(tmp_path / "film.ts", "mp4v")
    content = bytearray(path.read_bytes())
    if damage == "noise":
        rng = np.random.default_rng(1)
        for at in rng.integers(0, len(content), len(content) // 50):
            content[at] ^= 0xFF
    elif damage == "cut":
        del content[len(content) // 3 :]
    else:
        content = bytearray(b"ffconcat version 1.0\nfile /etc/passwd\n")
    path.write_bytes(bytes(content))
    stream = VideoStream(str(path), 160)
    try:
        assert wait_for(stream.problem)
    finally:
        stream.close()
