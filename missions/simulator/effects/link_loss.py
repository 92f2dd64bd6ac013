"""Link loss: messages that the radio does not carry, now and then or for a while."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from missions.mavlink.link import Link
from missions.mavlink.messages import Message, Received
from missions.simulator.conditions import Conditions
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment, Decision
from planning.base.messages import say

FlightClock = Callable[[], float]
"""Seconds since take-off, simulated; minus infinity before."""


class LossyLink:
    """Any link, with loss on both ways; by seed and order of messages.

    Parameters
    ----------
    loss
        Share of messages that get lost, 0 to 1.
    outages_s
        Begin and end of times in which all get lost.
    clock
        What outages are measured by; `SimulatedVehicle.flight_s` for a simulated vehicle.
    """

    def __init__(
        self, link: Link, loss: float, outages_s: tuple[tuple[float, float], ...], clock: FlightClock, seed: int
    ) -> None:
        if not 0.0 <= loss <= 1.0:
            raise ValueError(f"loss: expected 0 to 1, got {loss}")
        self._link, self._loss, self._outages_s, self._clock = link, loss, outages_s, clock
        self.address = link.address
        self._out, self._in = (np.random.default_rng([seed, way]) for way in (0, 1))
        self.n_lost = 0

    def send(self, message: Message) -> None:
        """Send a message, or lose it."""
        if not self._loses(self._out):
            self._link.send(message)

    def receive(self, timeout_s: float) -> Received | None:
        """The next message that is not lost; None also where one was."""
        received = self._link.receive(timeout_s)
        return None if received is None or self._loses(self._in) else received

    def close(self) -> None:
        """Close the link."""
        self._link.close()

    def _loses(self, rng: np.random.Generator) -> bool:
        now_s = self._clock()
        lost = bool(rng.random() < self._loss) or any(begin <= now_s < end for begin, end in self._outages_s)
        self.n_lost += lost
        return lost


class LinkLoss:
    """The effect: share of the messages that get lost."""

    name = say("link loss")
    unit = say("of the messages")
    tolerance = 0.0
    """None: whatever is lost has to be sent again."""

    def assess(self, scene: FlightScene) -> Assessment:
        """Loss outside outages, and the share of the flight that they take."""
        conditions, duration_s = scene.conditions, max(scene.duration_s, 1e-9)
        out_s = sum(max(0.0, min(end, duration_s) - min(begin, duration_s)) for begin, end in conditions.outages_s)
        out = min(1.0, out_s / duration_s)
        size = out + (1.0 - out) * conditions.message_loss
        reason = say("{:.0%} of the messages and {:.0f} s are said to be lost", conditions.message_loss, out_s)
        return Assessment(size, reason if size else say("no loss is said to be expected"), 0.0)


def through_air(
    link: Link, decisions: tuple[Decision, ...], conditions: Conditions, clock: FlightClock, seed: int = 0
) -> Link:
    """The link with its losses where that effect is on, else the link itself."""
    if not any(decision.effect == LinkLoss.name and decision.on for decision in decisions):
        return link
    return LossyLink(link, conditions.message_loss, conditions.outages_s, clock, seed)
