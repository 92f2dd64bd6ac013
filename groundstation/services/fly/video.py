"""The camera's live video: a process of its own reads and decodes the stream, and sends small pictures.

The decoder is the FFmpeg in OpenCV, which is here anyway; Qt's multimedia module is a package of 175 MB more. A stream
comes over the air and may be damaged or hostile: what it does to the decoder ends that process, never the flight.
"""

from __future__ import annotations

import re
import threading
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from groundstation.services.fly.rtp import MAX_SDP_BYTES, read_sdp, rtp_of
from groundstation.services.jobs.channel import Process, ProcessEnded
from planning.base.errors import InputError
from planning.base.files import FileLimit, read_input_file
from planning.base.messages import say

MAX_URL_CHARACTERS = 160
"""Of VIDEO_STREAM_INFORMATION's uri."""

SCHEMES = ("rtsp", "udp")
"""RTSP, and RTP or MPEG transport streams over UDP; others, such as playlists, would open what nobody asked for."""

SDP_FILE = FileLimit(say("a session description"), MAX_SDP_BYTES)

_URL = re.compile(r"(?P<scheme>[a-z]+)://(?P<place>[^\s/?#@\\|;,'\"]+)(?P<rest>[/?#][^\s\\|;'\"]*)?", re.ASCII)
_PLACE = re.compile(r"(\[[0-9a-fA-F:.]+\]|[A-Za-z0-9._-]+)(:(?P<port>\d{1,5}))?", re.ASCII)

READER = "groundstation.services.fly.video_reader"
"""By its name only: it loads OpenCV's decoders, which nothing else here does."""


def video_url(text: str) -> str:
    """The address of a stream as it was typed or as a vehicle told it; empty for none.

    Raises
    ------
    InputError
        It is none of `rtsp://HOST[:PORT][/PATH]`, `udp://HOST:PORT` and `rtp://HOST:PORT/ENCODING[/TYPE]`, or holds a
        password, which would be kept.
    """
    url = text.strip()
    if not url or (len(url) <= MAX_URL_CHARACTERS and rtp_of(url) is not None):
        return url
    found = _URL.fullmatch(url)
    if "@" in url.partition("/")[2].partition("/")[2].partition("/")[0]:
        raise InputError.say("video: expected an address without a password, for addresses are kept; found one")
    place = None if found is None else _PLACE.fullmatch(found["place"])
    if found is None or place is None or found["scheme"] not in SCHEMES or len(url) > MAX_URL_CHARACTERS:
        raise InputError.say("video: expected rtsp://HOST:PORT/PATH or udp://HOST:PORT, found '{}'", url[:80])
    if not (place["port"] is None and found["scheme"] == "rtsp") and not 0 < int(place["port"] or 0) < 65536:
        raise InputError.say("video: expected a port from 1 to 65535 in '{}'", url)
    return url


def typed_video(text: str) -> str:
    """As `video_url`, also of the name of an SDP file, which is read once: who types it may mean a file.

    Raises
    ------
    InputError
        As there, or the file cannot be read or describes no video.
    """
    path = Path(text.strip())
    if path.suffix.lower() != ".sdp" or "://" in text:
        return video_url(text)
    video = read_sdp(read_input_file(path, SDP_FILE).decode("utf-8", "replace"), path)
    # Parameter sets that are too long for an address come in the stream in any case.
    return video.url if len(video.url) <= MAX_URL_CHARACTERS else replace(video, sets="").url


@dataclass(frozen=True, slots=True)
class OpenVideo:
    """To the reader: show this stream, `width_px` wide, in at most so many pictures a second."""

    url: str
    width_px: int
    rate_hz: float = 12.0


@dataclass(frozen=True, slots=True, eq=False)
class VideoPicture:
    """From the reader: a picture, shape (height, width, 3), red, green, blue; and how many came before it."""

    picture: NDArray[np.uint8]
    number: int


@dataclass(frozen=True, slots=True)
class VideoProblem:
    """From the reader: no pictures come, and it tries again."""

    text: str


class VideoStream:
    """The latest picture of a stream, for whoever asks, from any thread.

    Parameters
    ----------
    url
        As `video_url` gives it.
    """

    def __init__(self, url: str, width_px: int) -> None:
        self._lock = threading.Lock()
        self._picture: VideoPicture | None = None
        self._problem = ""
        self._process = Process(READER, self._take)
        self._process.send(OpenVideo(url, width_px))

    def latest(self) -> VideoPicture | None:
        """The latest picture; None before the first, and while none come."""
        with self._lock:
            return self._picture

    def problem(self) -> str:
        """Why no pictures come; empty where they do, or are awaited."""
        with self._lock:
            return self._problem

    def close(self) -> None:
        """End the reading."""
        self._process.end()

    def _take(self, message: object) -> None:
        with self._lock:
            match message:
                case VideoPicture():
                    self._picture, self._problem = message, ""
                case VideoProblem():
                    self._picture, self._problem = None, message.text
                case ProcessEnded():
                    self._picture, self._problem = None, say("the decoder of the video has ended")
