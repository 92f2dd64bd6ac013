"""How many pixels a picture may have so that it comes in time, from how long pictures took.

A picture takes some time for each pixel, and some for all that the model is made of, however small it is: of a million
splats most of it. Fewer pixels do not help there, they only look worse.
"""

from __future__ import annotations

OTHER_SIZE = 1.5
"""Times as many pixels as another picture, from which on both tell what a pixel takes."""

ADDED = 0.25
"""Of the time that cannot be avoided, what pixels may add to it where it alone is too long."""


class PicturePace:
    """Learns from pictures of one model."""

    def __init__(self) -> None:
        self._last: tuple[float, float] | None = None
        self._other: tuple[float, float] | None = None

    def took(self, pixels: float, seconds: float) -> None:
        """A picture has come."""
        if self._last is not None and _differ(self._last[0], pixels):
            self._other = self._last
        self._last = float(pixels), max(0.0, float(seconds))

    def pixels_within(self, seconds: float) -> float | None:
        """That come in so many seconds, or, where none do, that add little to what all pictures take; None before any.

        May be infinite, where pictures of all sizes took equally long.
        """
        if self._last is None:
            return None
        fixed, each = self._parts()
        allowed = max(seconds - fixed, ADDED * fixed)
        return allowed / each if each > 0.0 else float("inf")

    def seconds_of(self, pixels: float) -> float:
        """That a picture will take; 0 before any."""
        if self._last is None:
            return 0.0
        fixed, each = self._parts()
        return fixed + each * pixels

    def _parts(self) -> tuple[float, float]:
        """Seconds of any picture, and of each pixel; without another size, all of it is the pixels'."""
        assert self._last is not None
        pixels, seconds = self._last
        if self._other is None or not _differ(self._other[0], pixels):
            return 0.0, seconds / pixels
        each = min(max((seconds - self._other[1]) / (pixels - self._other[0]), 0.0), seconds / pixels)
        return seconds - each * pixels, each


def _differ(one: float, other: float) -> bool:
    return max(one, other) >= OTHER_SIZE * min(one, other)
