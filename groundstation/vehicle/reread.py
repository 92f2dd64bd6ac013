"""What is on board after the link was lost: read once more, and compared with what was uploaded."""

from __future__ import annotations

from collections.abc import Callable

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Message, MissionItemInt, Received
from missions.mavlink.transfer.download import Download
from missions.mavlink.transfer.exchange import Ending, Route
from missions.mavlink.transfer.rounding import compare

Told = Callable[[str, bool | None], None]
"""Called at the end: the result in words, and whether the mission is equal (None: it could not be read)."""


class MissionReread:
    """Downloads the mission and compares it."""

    def __init__(self, route: Route, sent: tuple[MissionItemInt, ...], autopilot: Autopilot, told: Told) -> None:
        self._download, self._sent, self._autopilot, self._told = Download(route), sent, autopilot, told
        self.outcome: bool | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return self._download.next_deadline_s

    def start(self, now_s: float) -> list[Message]:
        """Ask for the mission."""
        return self._download.start(now_s)

    def receive(self, received: Received) -> list[Message]:
        """Take an item."""
        return self._after(self._download.receive(received))

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up."""
        return self._after(self._download.tick(now_s))

    def _after(self, sent: list[Message]) -> list[Message]:
        read = self._download.outcome
        if read is None or self.outcome is not None:
            return sent
        if read.ending is not Ending.DONE:
            self.outcome = False
            self._told(f"the mission on board could not be read again ({read.ending.value})", None)
            return sent
        differences = compare(self._sent, read.items, self._autopilot)
        self.outcome = not differences
        if differences:
            self._told(f"the vehicle has another mission now: {differences[0]}", False)
        else:
            self._told("the mission on board is the one that was uploaded", True)
        return sent
