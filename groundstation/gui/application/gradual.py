"""What is made in parts, a turn of the event loop for each: the window answers in between."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QObject

TURN_MS = 10
"""Between two parts of what is made by and by; without a pause Qt may do them all in one turn."""


class GradualTab(QObject):
    """A tab whose page takes so long to make that the window would stand still.

    Subclasses make themselves in `_parts`, with a `yield` behind each part, the last one, too: the window takes a turn
    for the page's place. Who wants the whole at once gets it.

    Parameters
    ----------
    at_once
        Make all of it now; else `go_on` makes a part at a time, and `finish` the rest.
    """

    def __init__(self, parent: QObject, *, at_once: bool) -> None:
        super().__init__(parent)
        self._making = self._parts()
        if at_once:
            self.finish()

    def go_on(self) -> bool:
        """Make another part; whether there may be more."""
        return next(self._making, self) is None

    def finish(self) -> None:
        """Make what is still missing."""
        while self.go_on():
            pass

    def _parts(self) -> Iterator[None]:
        raise NotImplementedError
