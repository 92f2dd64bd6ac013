"""The vehicle's receiver of RTK corrections: GPS_RTCM_DATA put together, and what that does to the fix.

A vehicle that `needs` them has a fix without RTK until they come, RTK float for some seconds, and RTK fixed as long as
they stay fresh. One that does not has the fix of its conditions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from missions.mavlink.messages import GpsRtcmData
from missions.mavlink.rtk import RtcmAssembler, RtcmDecoder, RtcmFrame

FRESH_S = 5.0
FLOAT_S = 10.0
"""From the first correction until whole numbers of wavelengths are known."""

FIX_3D, RTK_FLOAT, RTK_FIXED = 3, 5, 6
MAX_KEPT = 1000


@dataclass(slots=True)
class CorrectionsReceiver:
    """Takes what is sent."""

    needs: bool = False
    frames: list[RtcmFrame] = field(default_factory=list)
    _assembler: RtcmAssembler = field(default_factory=RtcmAssembler)
    _decoder: RtcmDecoder = field(default_factory=RtcmDecoder)
    _heard_s: float = -math.inf
    _since_s: float = math.inf

    def receive(self, message: GpsRtcmData, now_s: float) -> None:
        """Take a piece."""
        whole = self._assembler.receive(message)
        found = [] if whole is None else self._decoder.feed(whole)
        if not found:
            return
        if now_s - self._heard_s > FRESH_S:
            self._since_s = now_s
        self._heard_s = now_s
        self.frames = [*self.frames, *found][-MAX_KEPT:]

    def fix_type(self, fix_type: int, now_s: float) -> int:
        """The fix that comes of them; `fix_type` is that of the conditions."""
        if not self.needs or fix_type < RTK_FLOAT:
            return fix_type
        if now_s - self._heard_s > FRESH_S:
            return FIX_3D
        return RTK_FLOAT if now_s - self._since_s < FLOAT_S else fix_type
