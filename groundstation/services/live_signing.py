"""Tells once, while a link is open, that its two ends do not sign alike."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.services.live_connection import OpenedLink
from groundstation.services.live_events import LinkProblem
from groundstation.services.signing import signing_problem


class SigningNews:
    """Publishes what is wrong with the signing of a link when that changes to something."""

    def __init__(self, publish: Callable[[LinkProblem], None]) -> None:
        self._publish = publish
        self._told = ""

    def look(self, opened: OpenedLink | None, *, is_heard: bool) -> None:
        """Look at what came in on a link; `is_heard`: an autopilot was."""
        if opened is None or opened.counts is None:
            return
        text = signing_problem(opened.counts, is_signed=opened.is_signed, is_heard=is_heard)
        if text and text != self._told:
            self._publish(LinkProblem(text))
        self._told = text
