"""When a photo of CAMERA_FEEDBACK was taken: its UNIX time, by the vehicle's clock since power-up.

A report is mostly as old as the message before it. Not the first one after a link loss: nothing else has told the time
since before the gap.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

NEARBY_S = 5.0
"""Two clocks that are further apart than this do not tell the same time."""

SILENT_S = 0.5
"""A vehicle that is watched tells its time ten times a second; what it told this long ago is old."""

LONGEST_GAP_S = 86400.0
"""A photo that seems to be later than this tells of a wrong clock, not of a link loss."""

LEAST_UNIX_USEC = 10**15
"""Of the year 2001; what is less counts from power-up or counts nothing."""


@dataclass(frozen=True, slots=True)
class PhotoClock:
    """How far the UNIX time of photos is ahead of the vehicle's own.

    Parameters
    ----------
    unix_less_own_s
        None before it is known.
    is_told
        SYSTEM_TIME told it; else it is from a photo, which may have been some tenths of a second on its way.
    """

    unix_less_own_s: float | None = None
    is_told: bool = False

    def told(self, time_unix_usec: int, own_s: float) -> PhotoClock:
        """The clock after SYSTEM_TIME, which gives both times; the same where the UNIX time is not known yet."""
        return PhotoClock(time_unix_usec / 1e6 - own_s, True) if time_unix_usec >= LEAST_UNIX_USEC else self

    def heard(self, time_usec: int, own_s: float, silent_s: float) -> PhotoClock:
        """The clock after a photo, which counts where nothing told of it, and only beside a fresh time."""
        if self.is_told or self.unix_less_own_s is not None or time_usec < LEAST_UNIX_USEC or silent_s >= SILENT_S:
            return self
        return replace(self, unix_less_own_s=time_usec / 1e6 - own_s)

    def taken_s(self, time_usec: int, own_s: float, silent_s: float) -> float:
        """When a photo was taken, by the vehicle's clock; `own_s` where its UNIX time is not known or cannot be true.

        Parameters
        ----------
        own_s
            What the vehicle's clock said last.
        silent_s
            How long ago that was, by the receiver's clock: if long, the photo may be much later.
        """
        if self.unix_less_own_s is None or time_usec < LEAST_UNIX_USEC:
            return own_s
        taken_s = time_usec / 1e6 - self.unix_less_own_s
        latest_s = own_s + (NEARBY_S if silent_s < SILENT_S else LONGEST_GAP_S)
        return taken_s if own_s - NEARBY_S < taken_s < latest_s else own_s
