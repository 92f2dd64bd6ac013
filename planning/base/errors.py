"""Every error that Reflight raises on purpose, in one tree.

A message says what was expected, what was found, where, and what to do. Wrong calls (a programmer's mistake) raise
`ValueError` or `TypeError` instead.
"""

from __future__ import annotations

from typing import Self

from planning.base.messages import say

MAX_MESSAGE = 1000
"""Characters of a message: what a damaged file has in place of a name or number can be as long as the file."""


def shortened(text: str) -> str:
    """A message with its middle left out where it is too long to be read."""
    if len(text) <= MAX_MESSAGE:
        return text
    return f"{text[: 2 * MAX_MESSAGE // 3]} ... {text[-MAX_MESSAGE // 3 :]}"


class GroundStationError(Exception):
    """Root of all errors whose message is meant for the user."""

    @classmethod
    def say(cls, template: str, *values: object, place: object = "") -> Self:
        """An error with this message: see `planning.base.messages.say`."""
        return cls(say(template, *values, place=place))


class InputError(GroundStationError):
    """A file or an argument that the user gave is wrong."""


class InfeasibleError(GroundStationError):
    """The input is well formed, but what was asked for cannot be done on this site with this aircraft."""


class MissionError(GroundStationError):
    """A mission cannot be written, read or flown as it stands."""


class LinkError(GroundStationError):
    """The link to a vehicle failed."""


class LinkTimeout(LinkError):  # noqa: N818  (the name says what happened)
    """The vehicle did not answer in time."""


class LinkRejected(LinkError):  # noqa: N818
    """The vehicle answered, and refused."""


class ReconstructionError(GroundStationError):
    """Photos cannot be turned into a model as they stand."""


class PluginError(GroundStationError):
    """A plug-in of another package failed; the message names it."""


class OperationCancelled(GroundStationError):  # noqa: N818
    """The user cancelled the work; nothing of it may look finished."""
