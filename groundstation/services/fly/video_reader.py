"""The process that reads a video stream: opens it, decodes it, sends small pictures, and opens it again when it stops.

Only protocols of streams are let in (FFmpeg's `protocol_whitelist`), so that none leads to files of this computer.
"""

from __future__ import annotations

import os
import re
import tempfile
import threading
import time
from pathlib import Path

from groundstation.services.fly.rtp import listen, rtp_of
from groundstation.services.fly.video import OpenVideo, VideoPicture, VideoProblem
from groundstation.services.jobs.channel import Send
from planning.base.messages import say

OPTIONS = "protocol_whitelist;file,rtsp,rtp,udp,tcp|flags;low_delay|rtsp_flags;prefer_tcp"
"""For FFmpeg in OpenCV. A plain file is opened by its name only, which no address that is taken has."""

_UDP = re.compile(r"udp://(?P<host>[A-Za-z0-9._-]+):(?P<port>\d{1,5})/?", re.ASCII)

os.environ["OPENCV_FFMPEG_CAPTURE_OPTIONS"] = OPTIONS
os.environ["OPENCV_LOG_LEVEL"] = "OFF"
os.environ["OPENCV_FFMPEG_LOGLEVEL"] = "-8"

import cv2  # noqa: E402  (it reads these when it is loaded)
import numpy as np  # noqa: E402

TIMEOUT_MS = 5000
"""For opening, and for the next picture."""

AGAIN_S = 2.0
MAX_SIDE_PX = 8192


class VideoReader:
    """Reads one stream until it is told otherwise, or nobody listens any more."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self._order: OpenVideo | None = None
        self._ordered, self._is_gone = threading.Event(), threading.Event()

    def take(self, message: object) -> None:
        """Take the order."""
        if isinstance(message, OpenVideo):
            self._order = message
            self._ordered.set()

    def gone(self) -> float:
        """Nobody listens any more: nothing is to be finished."""
        self._is_gone.set()
        self._ordered.set()
        return 0.0

    def run(self) -> None:
        """Read, and try again after a while."""
        self._ordered.wait()
        number = 0
        while self._order is not None and not self._is_gone.is_set():
            number = self._read(self._order, number)
            self._is_gone.wait(AGAIN_S)

    def _read(self, order: OpenVideo, number: int) -> int:
        """Send pictures as long as they come; returns how many there were by now."""
        limits = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, TIMEOUT_MS, cv2.CAP_PROP_READ_TIMEOUT_MSEC, TIMEOUT_MS]
        with tempfile.TemporaryDirectory(prefix="reflight-video-") as folder:
            place = self._place(order.url, Path(folder))
            return self._pictures(order, cv2.VideoCapture(place, cv2.CAP_FFMPEG, limits), number)

    def _place(self, url: str, folder: Path) -> str:
        """What the decoder opens: the address, or of RTP a description of the stream that is written for it."""
        video, found = rtp_of(url), _UDP.fullmatch(url)
        if found is not None:
            try:
                video = listen(found["host"], int(found["port"]), self._is_gone.is_set)
            except OSError:
                video = None  # the decoder says so, too
        if video is None:
            return url
        path = folder / "video.sdp"
        path.write_text(video.sdp(), "ascii")
        return str(path)

    def _pictures(self, order: OpenVideo, capture: cv2.VideoCapture, number: int) -> int:
        try:
            if not capture.isOpened():
                self._send(VideoProblem(say("no video can be opened at {}; it is tried again", order.url)))
                return number
            shown_s = -1.0
            # Every picture is taken from the stream, or it would fall behind; few are decoded into colours and sent.
            while not self._is_gone.is_set() and capture.grab():
                now_s = time.monotonic()
                if now_s - shown_s < 1.0 / order.rate_hz:
                    continue
                is_there, found = capture.retrieve()
                if not is_there or found.ndim != 3 or max(found.shape[:2]) > MAX_SIDE_PX or min(found.shape[:2]) < 1:
                    continue
                shown_s, number = now_s, number + 1
                height = max(1, round(order.width_px * found.shape[0] / found.shape[1]))
                small = cv2.resize(found, (order.width_px, min(height, MAX_SIDE_PX)), interpolation=cv2.INTER_AREA)
                self._send(VideoPicture(np.asarray(cv2.cvtColor(small, cv2.COLOR_BGR2RGB), np.uint8), number))
        finally:
            capture.release()
        self._send(VideoProblem(say("the video has stopped; it is tried again")))
        return number


def service(send: Send) -> VideoReader:
    """What the process does."""
    return VideoReader(send)
