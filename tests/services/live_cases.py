"""A small plan to be flown live, and somebody who follows the events of a flight."""

import queue
import threading
import time
from dataclasses import replace
from functools import cache

from groundstation.services.fly.connection import Simulation
from groundstation.services.fly.events import FlightChanged, FlightEnded, LinkChanged, LinkState
from groundstation.services.fly.sortie import prepare_sortie
from planning.base.errors import LinkError
from planning.planner import plan_flight
from planning.request import PlanRequest
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK


@cache
def planned():
    """A site and a plan of six views in one sortie."""
    model = kiosk()
    return model, plan_flight(model, PlanRequest(n_views=6, greedy=QUICK)).plan


@cache
def sortie():
    model, plan = planned()
    return prepare_sortie(plan, model, 1)


SPEED_UP = 40.0


def simulation(speed_up=SPEED_UP, **changes):
    model, plan = planned()
    return Simulation(plan, model, speed_up=speed_up, **changes)


class Cut:
    """A link that can be unplugged, which it says, or jammed, which nobody says."""

    def __init__(self, link):
        self._link, self.address = link, link.address
        self.is_unplugged, self.is_jammed = threading.Event(), threading.Event()

    def send(self, message):
        self._check()
        if not self.is_jammed.is_set():
            self._link.send(message)

    def receive(self, timeout_s):
        self._check()
        received = self._link.receive(timeout_s)
        return None if self.is_jammed.is_set() else received

    def close(self):
        pass  # the vehicle flies on

    def end(self):
        self._link.close()

    def _check(self):
        if self.is_unplugged.is_set():
            raise LinkError("the radio was unplugged")


class Reopening:
    """Opens the same simulated vehicle again after its link broke."""

    speed_up, is_simulated, name = SPEED_UP, True, "radio"

    def __init__(self, **changes):
        self._opened, self.changes = None, changes

    def open(self, orders, clock, observe):
        if self._opened is None:
            opened = simulation(self.speed_up, **self.changes).open(orders, clock, observe)
            self._opened = replace(opened, link=Cut(opened.link))
        if self.cut.is_unplugged.is_set():
            raise LinkError("there is no radio")
        return self._opened

    @property
    def cut(self):
        return self._opened.link

    def end(self):
        """End the vehicle, which would fly on as long as the process lives."""
        if self._opened is not None:
            self.cut.end()


class Follower:
    """Collects the events of a flight; waits for what they say.

    The flight waits with each event until the next is looked for, and its simulated vehicle waits with it: what a test
    does about an event, it does at once, however slow the machine is.
    """

    def __init__(self):
        self.events, self.told_s, self.view = [], [], None
        self._queue = queue.SimpleQueue()
        self._next, self._has_one, self._is_waited_for = threading.Semaphore(0), False, True

    def __call__(self, event):
        self._queue.put((time.monotonic(), event))
        if self._is_waited_for:
            self._next.acquire()

    def let_go(self):
        """The flight waits no longer: it is to be closed."""
        self._is_waited_for = False
        self._next.release()

    def until(self, condition, timeout_s=400.0):
        """Take events until one meets the condition; returns it."""
        end = time.monotonic() + timeout_s
        while True:
            if self._has_one and self._is_waited_for:
                self._next.release()
            told_s, event = self._queue.get(timeout=max(0.01, end - time.monotonic()))
            self._has_one = True
            self.told_s.append(told_s)
            self.events.append(event)
            if isinstance(event, FlightChanged):
                self.view = event.view
            if condition(event):
                return event

    def until_may(self, request):
        return self.until(lambda event: isinstance(event, FlightChanged) and request in event.view.may)

    def until_closed(self):
        return self.until(lambda event: isinstance(event, LinkChanged) and event.link is LinkState.CLOSED)

    def until_ended(self, timeout_s=400.0):
        return self.until(lambda event: isinstance(event, FlightEnded), timeout_s)

    def of(self, kind):
        return [event for event in self.events if isinstance(event, kind)]
