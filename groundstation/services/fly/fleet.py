"""Aircraft of one plan that are in the air at once: what their flights share, each on a thread of its own.

Photos of all of them count for one coverage, their records make one report, and each flight's thread tells where its
aircraft is and reads where the others are, so that the distance between them is watched whatever the window does.
"""

from __future__ import annotations

import itertools
import math
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from groundstation.services.fly.connection import FlightRecordings, OpenedLink
from groundstation.services.fly.events import FlightEnded, LiveView, Request, ViewState
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.state import Landed, Motion, VehicleState
from groundstation.vehicle.surroundings import Surroundings
from groundstation.vehicle.watch import APART_TOLERANCE_M, STALE_S, OtherAircraft, motion_in_air, stop_of
from missions.flight.matching import DEFAULT_GATES, Gates, pose_of_photo
from missions.flight.record import FlightRecord, TakenPhoto
from missions.flight.report_rules import DEFAULT_LIMITS, Limits
from missions.simulator.server import CommonTime
from planning.base.errors import GroundStationError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import Clock
from planning.checks.case import Case, judge, pose_of
from planning.coverage.evaluate import sights
from planning.geo.frames import Vec3, heading_difference_rad
from planning.plan import Plan, Viewpoint
from planning.routing.at_once import LegTimes, forbidden_s, leg_distances_m, sortie_leg_times

# Coverage growing photo by photo: each photo is counted as it was really taken, not as its view was planned.


@dataclass(frozen=True, slots=True, eq=False)
class CountedPhoto:
    """A photo, the view that it is of (None for none), and what it added."""

    photo: TakenPhoto
    view: Viewpoint | None
    n_new: int
    position_error_m: float | None
    heading_error_deg: float | None
    gimbal_pitch_error_deg: float | None


class LiveCoverage:
    """Counts the photos of one or more sorties of a plan, of several aircraft too: it may be used from any thread.

    Parameters
    ----------
    case
        The plan, measured.
    """

    def __init__(self, case: Case) -> None:
        self._case, self._lock = case, threading.Lock()
        self._by_id = {view.id: view for view in case.plan.viewpoints}
        self._planned = np.zeros(case.model.n_elements, np.bool_)
        self._counts = np.zeros(case.model.n_elements, np.int64)
        self.photo_of: dict[str, CountedPhoto] = {}

    @property
    def covered(self) -> int:
        """Sections that at least one photo shows."""
        return int(np.count_nonzero(self._counts))

    @property
    def covered_planned(self) -> int:
        """Sections that the sorties so far cover as they were planned."""
        return int(np.count_nonzero(self._planned))

    def planned(self) -> NDArray[np.bool_]:
        """Whether the sorties so far cover each section as they were planned, shape (m, n_sections)."""
        return self._planned.copy().reshape(len(self._case.model.frames), -1)

    def counts(self) -> NDArray[np.int64]:
        """Photos that show each section, shape (m, n_sections); a copy."""
        with self._lock:
            return self._counts.copy().reshape(len(self._case.model.frames), -1)

    def add_sortie(self, viewpoint_ids: Sequence[str]) -> None:
        """Another sortie is flown; what it covers as planned counts from now on."""
        for viewpoint_id in viewpoint_ids:
            self._planned[self._case.measures.seen[pose_of(self._by_id[viewpoint_id])].elements] = True

    def add(self, photo: TakenPhoto, viewpoint_ids: Sequence[str], gates: Gates = DEFAULT_GATES) -> CountedPhoto:
        """Count a photo, as the view of these that it fits best and that has none yet.

        A photo whose direction its source does not say is taken to look where its view does; without a view it counts
        for no section.
        """
        views = [self._by_id[viewpoint_id] for viewpoint_id in viewpoint_ids if viewpoint_id not in self.photo_of]
        view = matching_view(photo, views, gates)
        pose = pose_of_photo(photo, view)
        n_new = 0
        if pose is not None:
            (sight,) = sights(self._case.model, (pose,))
            with self._lock:
                n_new = int(np.count_nonzero(self._counts[sight.elements] == 0))
                self._counts[sight.elements] += 1
        counted = CountedPhoto(photo, view, n_new, *_errors(photo, view))
        if view is not None:
            self.photo_of[view.id] = counted
        return counted

    def states(
        self, viewpoint_ids: Sequence[str], missing: Sequence[str], limits: Limits = DEFAULT_LIMITS
    ) -> tuple[tuple[str, ViewState], ...]:
        """How each view of a sortie stands, in the order of flight; `missing` were passed without a photo."""
        states: list[tuple[str, ViewState]] = []
        has_next = False
        for viewpoint_id in viewpoint_ids:
            counted = self.photo_of.get(viewpoint_id)
            if counted is not None:
                error_m = counted.position_error_m or 0.0
                state = ViewState.OFF if error_m > limits.position_m else ViewState.TAKEN
            elif viewpoint_id in missing:
                state = ViewState.MISSING
            else:
                state = ViewState.TO_COME if has_next else ViewState.NEXT
                has_next = True
            states.append((viewpoint_id, state))
        return tuple(states)


def matching_view(photo: TakenPhoto, views: Sequence[Viewpoint], gates: Gates) -> Viewpoint | None:
    """The view that a photo fits best: the largest of its errors, in parts of the gates, is least and within them."""
    best, least = None, 1.0
    for view in views:
        position_m, heading_deg, pitch_deg = _errors(photo, view)
        misfit = max(
            (position_m or 0.0) / gates.position_m,
            abs(heading_deg or 0.0) / gates.angle_deg,
            abs(pitch_deg or 0.0) / gates.angle_deg,
        )
        if misfit < least:
            best, least = view, misfit
    return best


def _errors(photo: TakenPhoto, view: Viewpoint | None) -> tuple[float | None, float | None, float | None]:
    """Distance in metres, heading and pitch in degrees, taken less planned; None where not known."""
    if view is None:
        return None, None, None
    heading = pitch = None
    if photo.heading_deg is not None:
        turned = heading_difference_rad(math.radians(view.heading_deg), math.radians(photo.heading_deg))
        heading = math.degrees(float(turned))
    if photo.gimbal_pitch_deg is not None:
        pitch = photo.gimbal_pitch_deg - view.gimbal_pitch_deg
    return math.dist(photo.position_enu_m, view.position_enu_m), heading, pitch


# Where each aircraft is.


@dataclass(frozen=True, slots=True)
class _Heard:
    sortie: int
    motion: Motion
    stop_enu_m: Vec3
    time_s: float


class Traffic:
    """Where the aircraft are that are in the air; may be used from any thread.

    Parameters
    ----------
    clock
        Real time: those of simulated vehicles run apart.
    """

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self._clock, self._lock = clock, threading.Lock()
        self._heard: dict[int, _Heard] = {}
        self._told_s: dict[int, float] = {}
        self._least_m: dict[tuple[int, int], float] = {}

    def tell(self, number: int, sortie: int, state: VehicleState, around: Surroundings, now_s: float) -> None:
        """An aircraft was heard, last in this state; `now_s` by the clock of its messages."""
        if not is_in_air(state):
            self.leave(number)
            return
        motion = motion_in_air(state, now_s)
        # What was told already does not become newer: a link that is lost shows by its age.
        if motion is None or state.motion is None or self._told_s.get(number) == state.motion.time_s:
            return
        heard = _Heard(sortie, motion, stop_of(state, motion, around), self._clock())
        with self._lock:
            self._told_s[number], self._heard[number] = state.motion.time_s, heard
            for other, beside in self._heard.items():
                if other != number and heard.time_s - beside.time_s <= STALE_S:
                    pair = (min(sortie, beside.sortie), max(sortie, beside.sortie))
                    away_m = math.dist(motion.position_enu_m, beside.motion.position_enu_m)
                    self._least_m[pair] = min(away_m, self._least_m.get(pair, math.inf))

    def leave(self, number: int) -> None:
        """An aircraft is on the ground, or nobody listens to it any more."""
        with self._lock:
            self._heard.pop(number, None)
            self._told_s.pop(number, None)

    def others(self, number: int) -> tuple[OtherAircraft, ...]:
        """All in the air but one."""
        now_s = self._clock()
        with self._lock:
            heard = [(other, each) for other, each in self._heard.items() if other != number]
        return tuple(OtherAircraft(other, each.motion, each.stop_enu_m, now_s - each.time_s) for other, each in heard)

    def least_m(self) -> tuple[float, tuple[int, int]] | None:
        """Smallest distance so far of two aircraft that were both heard, and their sorties; None where none was."""
        with self._lock:
            return min(((least_m, pair) for pair, least_m in self._least_m.items()), default=None)


def is_in_air(state: VehicleState) -> bool:
    """Whether an aircraft flies, as far as is known."""
    return state.is_armed and (state.landed is None or state.landed.value is not Landed.ON_GROUND)


# What flights of one plan share.


class Fleet:
    """Made with the first flight of a plan, shared with those that are connected beside it.

    Parameters
    ----------
    flown
        Records of the same plan from before; photos and coverage count on.
    """

    def __init__(self, case: Case, folder: Path, flown: tuple[FlightRecord, ...] = ()) -> None:
        self.coverage, self.traffic, self.simulated_time = LiveCoverage(case), Traffic(), CommonTime()
        self._case, self._lock = case, threading.Lock()
        self._recordings = FlightRecordings(case, folder, flown)
        self._legs: dict[int, LegTimes | None] = {}
        self._forbidden: dict[tuple[tuple[int, float], tuple[int, float]], NDArray[np.float64]] = {}
        planned = tuple(view_id for sortie in case.plan.sorties for view_id in sortie.viewpoint_ids)
        for record in flown:
            for photo in record.photos:
                self.coverage.add(photo, planned)

    @property
    def plan(self) -> Plan:
        """That all of them fly."""
        return self._case.plan

    def ended(
        self,
        run: FlightRun,
        record: FlightRecord,
        error: GroundStationError | None,
        opened: OpenedLink | None,
        name: str,
    ) -> FlightEnded:
        """A sortie is over: the report is on all sorties so far, and on how near aircraft that were heard came."""
        with self._lock:
            return self._recordings.ended(run, record, error, opened, name, tuple(self._nearest()))

    def wait_s(self, number: int, in_air: Mapping[int, float], slower: Mapping[int, float]) -> float:
        """How long a sortie, from 1, has to wait on the ground to keep apart from those in the air, as planning does.

        Parameters
        ----------
        in_air
            For how long the motors of sorties have been running, by their number; infinity where nobody knows.
        slower
            How many times as long as planned its autopilot takes for each of these sorties.

        Returns
        -------
        float
            0 where it may start now, infinity where that is not known.
        """
        spans: list[tuple[float, float]] = []
        for other, since_s in in_air.items():
            found = self._forbidden_s((other, slower[other]), (number, slower[number]))
            if found is None or math.isinf(since_s):
                return math.inf
            spans += [(low - since_s, high - since_s) for low, high in found.tolist()]
        wait_s = 0.0
        for low, high in sorted(spans):
            if low < wait_s < high:
                wait_s = high
        return wait_s

    def _forbidden_s(self, one: tuple[int, float], other: tuple[int, float]) -> NDArray[np.float64] | None:
        """Of two sorties, each with how many times as long as planned it takes."""
        if (one, other) not in self._forbidden:
            first, second = self._legs_of(*one), self._legs_of(*other)
            if first is None or second is None:
                return None
            is_near = leg_distances_m(first, second) < self.plan.rules.apart_m
            self._forbidden[one, other] = forbidden_s(is_near, first, second)
        return self._forbidden[one, other]

    def _legs_of(self, number: int, slower: float) -> LegTimes | None:
        if number not in self._legs:
            self._legs[number] = sortie_leg_times(self.plan, self.plan.sorties[number - 1])
        legs = self._legs[number]
        if legs is None:
            return None
        return replace(legs, from_s=slower * legs.from_s[:1], until_s=slower * legs.until_s[:1])  # its pace is known

    def _nearest(self) -> Iterator[Finding]:
        found = self.traffic.least_m()
        if found is not None:
            value, pair = found
            limit, place = self.plan.rules.apart_m - APART_TOLERANCE_M, say("sorties {} and {}", *pair)
            subject = say("smallest distance between aircraft while both were heard")
            yield judge(value >= limit, "aircraft-apart-live", subject, value, limit, "m", place, least=True)


# All aircraft return to one home: one after the other, while the rest hover.


@dataclass(frozen=True, slots=True)
class ReturnAll:
    """The aircraft that wait, in the order in which they will return."""

    waiting: tuple[int, ...] = ()

    @classmethod
    def of(cls, views: Mapping[int, LiveView]) -> tuple[ReturnAll, tuple[tuple[int, Request], ...]]:
        """All in the air: the one with the least battery returns now, the rest wait; and what is asked of each."""
        aloft = [number for number, view in views.items() if is_in_air(view.state)]
        left_s = {number: views[number].readouts.battery_left_s or 0.0 for number in aloft}
        order = sorted(aloft, key=left_s.__getitem__)
        asked = [(number, Request.RETURN) for number in order[:1]]
        asked += [(number, Request.PAUSE) for number in order[1:] if Request.PAUSE in views[number].may]
        return cls(tuple(order[1:])), tuple(asked)

    def without(self, number: int) -> ReturnAll:
        """The pilot has asked an aircraft for something else."""
        return replace(self, waiting=tuple(each for each in self.waiting if each != number))

    def after(self, views: Mapping[int, LiveView]) -> tuple[ReturnAll, tuple[tuple[int, Request], ...]]:
        """As the flights stand now: whose turn it is, or who cannot wait for it, and what is asked of them."""
        waiting = [number for number in self.waiting if number in views and is_in_air(views[number].state)]
        due = [number for number in waiting if _must_go_home(views[number])]
        on_their_way = [number for number, view in views.items() if is_in_air(view.state) and number not in waiting]
        if waiting and not due and not on_their_way:
            due = waiting[:1]
        left = tuple(number for number in waiting if number not in due)
        return ReturnAll(left), tuple((number, Request.RETURN) for number in due)


def _must_go_home(view: LiveView) -> bool:
    return any(warning.code == "battery" and warning.severity is Severity.ERROR for warning in view.warnings)


def distances_m(states: Mapping[int, VehicleState]) -> dict[int, tuple[float, int]]:
    """Distance of each aircraft in the air to the nearest other one, and which that is."""
    places = {n: state.motion.value.position_enu_m for n, state in states.items() if state.motion and is_in_air(state)}
    found: dict[int, tuple[float, int]] = {}
    for one, other in itertools.permutations(places, 2):
        away_m = math.dist(places[one], places[other])
        if one not in found or away_m < found[one][0]:
            found[one] = (away_m, other)
    return found
