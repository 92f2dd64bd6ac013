"""A request to the vehicle that is sent again until it is answered: a state machine without a link."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

from missions.mavlink.messages import Message


class RepeatedRequest(ABC):
    """Something that is asked for until it is answered: `n_attempts` times at most, every `attempt_s`."""

    outcome: object | None

    def __init__(self, n_attempts: int, attempt_s: float) -> None:
        self.outcome = None
        self._n_attempts, self._attempt_s = n_attempts, attempt_s
        self._n_sent = 0
        self._deadline_s = math.inf

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called; infinity once it has ended."""
        return self._deadline_s if self.outcome is None else math.inf

    def start(self, now_s: float) -> list[Message]:
        """Send it for the first time."""
        return self._send(now_s)

    def tick(self, now_s: float) -> list[Message]:
        """Send it again when the time is up, or give up."""
        if self.outcome is not None or now_s < self._deadline_s:
            return []
        if self._n_sent < self._n_attempts:
            return self._send(now_s)
        self._give_up()
        return []

    def _send(self, now_s: float) -> list[Message]:
        messages = self._messages()
        self._n_sent += 1
        self._deadline_s = now_s + self._attempt_s
        return messages

    @abstractmethod
    def _messages(self) -> list[Message]:
        """What is sent now."""

    @abstractmethod
    def _give_up(self) -> None:
        """End without an answer."""
