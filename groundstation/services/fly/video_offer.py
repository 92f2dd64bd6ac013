"""The address of the camera's video, as the vehicle's camera tells it: asked for with a flight, never opened by itself.

Cameras that are heard are asked with REQUEST_MESSAGE, and with the older REQUEST_VIDEO_STREAM_INFORMATION where they do
not answer; without a camera of its own on the link the autopilot is asked, which answers for it. What comes is a text
of whoever is on the link: it has to pass as an address (`video.video_url`), and the pilot confirms it.
"""

from __future__ import annotations

import math
import re
import threading
from dataclasses import dataclass

from groundstation.services.fly.video import video_url
from missions.mavlink.messages import Address, CommandLong, Heartbeat, Message, Received, VideoStreamInformation
from planning.base.errors import InputError
from planning.base.messages import say

MAV_CMD_REQUEST_MESSAGE, MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION = 512, 2504
VIDEO_STREAM_INFORMATION = 269.0
MAV_TYPE_CAMERA, MAV_AUTOPILOT_INVALID = 30, 8

RTSP, RTP_UDP, TCP_MPEG, MPEG_TS = range(4)
"""VIDEO_STREAM_TYPE."""

ASK_EVERY_S, N_ASKED = 2.0, 3
"""Between two questions to one camera, and how often each of the two ways is tried."""

NO_CAMERA_S = 5.0
"""After so long without a camera's heartbeat the autopilot is asked for it."""

MOST_STREAMS = 8

_OWN = re.compile(r"rtsp://(0\.0\.0\.0|127\.|localhost|\[::1?\])", re.IGNORECASE)
_PORT = re.compile(r"(?:(?:udp|rtp)://)?(?:(?P<host>[\w.]+|\[[0-9a-fA-F:.]+\])?:)?(?P<port>\d{1,5})/?", re.ASCII)


@dataclass(frozen=True, slots=True)
class OfferedVideo:
    """A stream that a camera tells of.

    Parameters
    ----------
    url
        As `video_url` takes it; empty where it cannot be shown.
    problem
        Why it cannot be shown, and what to do; empty where it can.
    """

    name: str
    url: str
    problem: str = ""


@dataclass(slots=True)
class _Asked:
    """How often an address was asked, and when it is next."""

    n: int = 0
    due_s: float = -math.inf


class VideoFinder:
    """Asks for the streams of a vehicle's cameras, as a companion of a flight; `offered` from any thread."""

    def __init__(self) -> None:
        self._vehicle: Address | None = None
        self._asked: dict[Address, _Asked] = {}
        self._heard_s = math.inf
        self._lock = threading.Lock()
        self._streams: dict[tuple[Address, int], VideoStreamInformation] = {}

    def offered(self) -> OfferedVideo | None:
        """The first stream that can be shown, else the first at all; None before one was told."""
        with self._lock:
            found = [offer_of(self._streams[key]) for key in sorted(self._streams, key=_order)]
        return next((each for each in found if each.url), found[0] if found else None)

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        message, source = received.message, received.source
        if isinstance(message, Heartbeat):
            if message.autopilot != MAV_AUTOPILOT_INVALID and self._vehicle is None:
                self._vehicle, self._heard_s = source, received.time_s
            is_own = self._vehicle is not None and source.system == self._vehicle.system
            if message.type == MAV_TYPE_CAMERA and is_own and len(self._asked) < MOST_STREAMS:
                self._asked.setdefault(source, _Asked())
        if isinstance(message, VideoStreamInformation) and source in self._asked:
            with self._lock:
                if len(self._streams) < MOST_STREAMS or (source, message.stream_id) in self._streams:
                    self._streams[source, message.stream_id] = message
        return []

    def tick(self, now_s: float) -> list[Message]:
        """What is due."""
        vehicle = self._vehicle
        if vehicle is None:
            return []
        if now_s > self._heard_s + NO_CAMERA_S and not self._asked:
            self._asked[vehicle] = _Asked()
        sent: list[Message] = []
        for address, asked in self._asked.items():
            has_told = any(source == address for source, _ in self._streams)
            # The autopilot's acknowledgements of REQUEST_MESSAGE are awaited by others.
            is_old = address == vehicle or asked.n >= N_ASKED
            if has_told or asked.n >= 2 * N_ASKED or now_s < asked.due_s:
                continue
            asked.n, asked.due_s = asked.n + 1, now_s + ASK_EVERY_S
            if is_old:
                command = MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION
                sent.append(CommandLong(address.system, address.component, command, 0.0))
            else:
                message_id = VIDEO_STREAM_INFORMATION
                sent.append(CommandLong(address.system, address.component, MAV_CMD_REQUEST_MESSAGE, message_id, 0.0))
        return sent


def _order(key: tuple[Address, int]) -> tuple[int, int, int]:
    address, stream = key
    return address.system, address.component, stream


def offer_of(stream: VideoStreamInformation) -> OfferedVideo:
    """What a camera tells of a stream, as an address, or why it is none."""
    name = "".join(letter for letter in stream.name if letter.isprintable())[:32]
    uri = stream.uri.strip()
    if stream.type == TCP_MPEG:
        return OfferedVideo(name, "", say("the camera sends its video over TCP, which is not read: set it to RTSP"))
    if stream.type in (MPEG_TS, RTP_UDP):
        # Which of the two arrives, the reader sees.
        found = _PORT.fullmatch(uri)
        uri = uri if found is None else f"udp://{found['host'] or '0.0.0.0'}:{found['port']}"
    if _OWN.match(uri):
        text = say("the camera tells an address that holds on itself alone: type its own in the settings of the flight")
        return OfferedVideo(name, "", text)
    try:
        url = video_url(uri)
    except InputError as error:
        return OfferedVideo(name, "", str(error))
    return OfferedVideo(name, url, "" if url else say("the camera tells of a video without an address"))
