"""The camera's trigger: which of the asked photos are really taken, and when.

ArduPilot holds the shutter for CAM1_DURATION; what is asked meanwhile is lost without a word. With CAM1_INTRVAL_MIN one
photo asked too early waits, the others are lost. PX4's camera takes each, but none within TRIG_ACT_TIME.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from missions.mavlink.autopilots import Autopilot
from missions.simulator.autopilot.guidance import Guidance
from missions.simulator.autopilot.parameters import ParameterTable

FOREVER = math.inf


class CameraControl:
    """Counts photos and asks for them; `shoot` opens the shutter.

    Parameters
    ----------
    shoot
        Called with the number of each photo that is taken, from 1.
    """

    def __init__(
        self,
        autopilot: Autopilot,
        parameters: ParameterTable,
        guidance: Guidance,
        shoot: Callable[[int], None],
    ) -> None:
        self._autopilot, self._parameters, self._guidance, self._shoot = autopilot, parameters, guidance, shoot
        self.n_photos = 0
        self.n_lost = 0
        self._busy_until_s = -FOREVER
        self._pending_s = FOREVER
        self._next_s, self._every_s, self._left = FOREVER, 0.0, 0.0
        self._every_m = 0.0
        self._last_xy_m = (0.0, 0.0)

    @property
    def is_fitted(self) -> bool:
        """Whether there is one, by the parameters; without, commands to it are accepted and do nothing."""
        return self._parameters["TRIG_MODE" if self._autopilot is Autopilot.PX4 else "CAM1_TYPE"] > 0

    def trigger(self) -> None:
        """Ask for one photo now."""
        if not self.is_fitted:
            return
        now_s = self._guidance.now_s
        if self._autopilot is Autopilot.PX4:
            held_s, waits = self._parameters["TRIG_ACT_TIME"] / 1000.0, False
        else:
            interval_s = self._parameters["CAM1_INTRVAL_MIN"]
            held_s, waits = max(self._parameters["CAM1_DURATION"], interval_s), interval_s > 0.0
        if now_s < self._busy_until_s - 1e-9:
            if waits and self._pending_s == FOREVER:
                self._pending_s = self._busy_until_s
            else:
                self.n_lost += 1
            return
        self._busy_until_s = now_s + held_s
        self.n_photos += 1
        self._shoot(self.n_photos)

    def start_series(self, every_s: float, count: int) -> None:
        """Take `count` photos (0: until stopped), the first now."""
        self.stop_series()
        self.trigger()
        if count != 1 and every_s > 0.0:
            self._every_s, self._left = every_s, count - 1 if count > 1 else FOREVER
            self._next_s = self._guidance.now_s + every_s

    def start_distance(self, every_m: float, at_once: bool) -> None:
        """Take a photo each time the aircraft moved so far over the ground; 0 stops it."""
        self._every_m = max(0.0, every_m)
        self._last_xy_m = self._guidance.here_enu_m[:2]
        if at_once and every_m > 0.0:
            self.trigger()

    def stop_series(self) -> None:
        """Take no more photos by time."""
        self._next_s = FOREVER

    def stop(self) -> None:
        """Take no more photos by time or distance."""
        self.stop_series()
        self._every_m = 0.0

    def tick(self) -> None:
        """Take what is due; asked once for every control step."""
        now_s = self._guidance.now_s
        if now_s >= self._pending_s - 1e-9:
            self._pending_s = FOREVER
            self.trigger()
        if now_s >= self._next_s - 1e-9:
            self._left -= 1
            self._next_s = self._next_s + self._every_s if self._left > 0 else FOREVER
            self.trigger()
        if self._every_m > 0.0:
            x, y, _ = self._guidance.here_enu_m
            if math.hypot(x - self._last_xy_m[0], y - self._last_xy_m[1]) >= self._every_m:
                self._last_xy_m = (x, y)
                self.trigger()
