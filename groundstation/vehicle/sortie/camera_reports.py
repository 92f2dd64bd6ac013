"""Asks a camera for the reports of its photos that the radio lost, and how many photos it has counted.

MAVLink's camera protocol: CAMERA_IMAGE_CAPTURED may be asked for again by its index, which counts from 0, and
CAMERA_CAPTURE_STATUS says how many photos there are. ArduPilot tells of photos with CAMERA_FEEDBACK, which cannot be
asked for again, but says how many there are; an autopilot that does neither does not answer, and nothing comes of it.
"""

from __future__ import annotations

import math

from missions.mavlink.messages import (
    Address,
    CameraCaptureStatus,
    CameraFeedback,
    CameraImageCaptured,
    CommandLong,
    Message,
    Received,
)

MAV_CMD_REQUEST_MESSAGE = 512
CAPTURE_STATUS, IMAGE_CAPTURED = 262, 263

ASK_EVERY_S = 1.0
N_ASKS = 8
MAX_AT_ONCE = 5
"""Reports asked for at a time: what lost them is often a thin link."""

MAX_GAP = 500
"""A larger one is a camera that began to count anew, and no gap."""

ALL_COMPONENTS = 0


class CameraReports:
    """Notes which photos were told of, and asks for the others until each was asked for `N_ASKS` times.

    Attributes
    ----------
    count
        What the camera said last; None before it said anything.
    """

    def __init__(self) -> None:
        self.count: int | None = None
        self._camera: Address | None = None
        self._last: int | None = None
        self._feeds_back = False
        self._missing: dict[int, int] = {}
        self._n_count_asks: int | None = None
        self._asked_s = -math.inf

    @property
    def is_settled(self) -> bool:
        """Whether there is nothing more to ask or to wait for."""
        return not self._missing and self._n_count_asks is None

    def ask_count(self) -> None:
        """Find out how many photos there are."""
        self._n_count_asks = 0

    def receive(self, received: Received) -> None:
        """Take a message of the vehicle or of its camera."""
        message = received.message
        if isinstance(message, CameraImageCaptured):
            self._camera = received.source
            self._told(message.image_index)
        elif isinstance(message, CameraFeedback):
            self._feeds_back = True
            self._missing.clear()
        elif isinstance(message, CameraCaptureStatus) and message.image_count >= 0:
            self._camera = received.source
            self._n_count_asks = None
            self._expect(message.image_count)
            self.count = message.image_count

    def tick(self, now_s: float, system: int) -> list[Message]:
        """Ask for what is missing, where it is time to."""
        if self.is_settled or now_s < self._asked_s + ASK_EVERY_S:
            return []
        self._asked_s = now_s
        # The last question was given its time for an answer, too.
        self._missing = {index: n_asks for index, n_asks in self._missing.items() if n_asks < N_ASKS}
        asked: list[Message] = []
        if self._n_count_asks is not None:
            self._n_count_asks = self._n_count_asks + 1 if self._n_count_asks < N_ASKS else None
            asked += [self._request(system, CAPTURE_STATUS)] if self._n_count_asks is not None else []
        for index in sorted(self._missing)[:MAX_AT_ONCE]:
            asked.append(self._request(system, IMAGE_CAPTURED, index))
            self._missing[index] += 1
        return asked

    def _told(self, index: int) -> None:
        self._missing.pop(index, None)
        if self._last is None or index > self._last:
            self._expect(index)
            self._last = index

    def _expect(self, end: int) -> None:
        """All photos before this one must have been told of: from the last one on, or from the count before."""
        start = self.count if self._last is None else self._last + 1
        if start is not None and 0 < end - start <= MAX_GAP and not self._feeds_back:
            for index in range(start, end):
                self._missing.setdefault(index, 0)

    def _request(self, system: int, message_id: int, index: int = 0) -> CommandLong:
        component = ALL_COMPONENTS if self._camera is None else self._camera.component
        return CommandLong(system, component, MAV_CMD_REQUEST_MESSAGE, float(message_id), float(index))
