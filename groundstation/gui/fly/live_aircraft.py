"""What the Fly tab knows of each aircraft: how it is reached, its flight, and what was told of it, also afterwards."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from groundstation.services.fly.events import FlightEnded, LinkState, LiveView, PhotoCounted
from groundstation.services.fly.fleet import Fleet
from groundstation.services.fly.flight import LiveFlight
from groundstation.services.fly.options import ConnectionChoice, FlightSettings
from groundstation.services.fly.sortie import LiveSortie
from groundstation.vehicle.state import VehicleText
from planning.base.findings import Severity
from planning.geo.frames import Vec3
from planning.plan import Plan


@dataclass(slots=True)
class ActiveFlight:
    """Grows as the flight tells.

    Parameters
    ----------
    track_enu_m
        Where the aircraft was, ten times a second at most.
    link_problem
        Why both ends of an open link do not understand each other; empty where nothing shows it.
    photos
        By the view that they are of.
    notes
        What happened: how long after take-off (None on the ground), how severe, and the text.
    took_off_s
        When the motors started, by the vehicle's own clock; None on the ground.
    was_on_ground
        It was heard before that, so that it is known.
    """

    sortie: LiveSortie
    view: LiveView | None = None
    link: LinkState = LinkState.OPENING
    link_problem: str = ""
    track_enu_m: list[Vec3] = field(default_factory=list)
    photos: dict[str, PhotoCounted] = field(default_factory=dict)
    counted: PhotoCounted | None = None
    ended: FlightEnded | None = None
    notes: list[tuple[float | None, Severity, str]] = field(default_factory=list)
    last_text_s: float = -math.inf
    battery: float | None = None
    took_off_s: float | None = None
    was_on_ground: bool = False

    def take_view(self, view: LiveView) -> tuple[VehicleText, ...]:
        """The flight as it stands now; returns the autopilot's texts that are new."""
        self.view = view
        state = view.state
        if self.took_off_s is None and state.is_armed:
            self.took_off_s = state.boot_time_s
        self.was_on_ground |= state.heartbeat is not None and not state.is_armed
        if state.motion is not None and view.link is LinkState.ALIVE:
            place = state.motion.value.position_enu_m
            if not self.track_enu_m or self.track_enu_m[-1] != place:
                self.track_enu_m.append(place)
        if view.readouts.battery is not None:
            self.battery = view.readouts.battery
        # Those that a state keeps are the last ones of all.
        texts = tuple(text for text in state.texts if text.time_s > self.last_text_s)
        if texts:
            self.last_text_s = texts[-1].time_s
        return texts

    def since_take_off_s(self, view: LiveView) -> float | None:
        """How long the motors have been running, as plans and reports count; None on the ground."""
        now_s = view.state.boot_time_s
        return None if self.took_off_s is None or now_s is None else max(0.0, now_s - self.took_off_s)

    @property
    def slower(self) -> float:
        """How many times as long as planned the autopilot takes for the sortie; 1 where that is not known."""
        orders = self.sortie.orders
        planned_s = self.sortie.case.plan.sorties[orders.number - 1].duration_s
        autopilot = None if self.view is None else self.view.state.autopilot
        return orders.duration_s(autopilot) / planned_s if planned_s > 0.0 else 1.0

    def take_photo(self, counted: PhotoCounted) -> None:
        """A photo was taken."""
        self.counted = counted
        if counted.view_id:
            self.photos[counted.view_id] = counted


@dataclass(slots=True, eq=False)
class LiveAircraft:
    """One aircraft; only where several fly at once there is more than one.

    Parameters
    ----------
    number
        By which it is called, from 1: that of the plan's sorties.
    sortie_number
        Which sortie it flies next, from 1.
    flight_id
        Of the events of its flight; 0 for none.
    job_id
        Of the job that prepares its sortie.
    connects_again
        As soon as its link is closed, for the plan that is shown then.
    """

    number: int
    choice: ConnectionChoice
    settings: FlightSettings
    sortie_number: int = 1
    flight: LiveFlight | None = None
    fleet: Fleet | None = None
    flight_id: int = 0
    job_id: int = 0
    active: ActiveFlight | None = None
    connects_again: bool = False

    @property
    def view(self) -> LiveView | None:
        """Its flight as it stands; None where it is not connected, or was not heard yet."""
        return None if self.flight is None or self.active is None else self.active.view

    @property
    def is_in_flight(self) -> bool:
        """Whether it is in the air, as far as is known."""
        return self.flight is not None and self.flight.is_in_flight

    def flies(self, plan: Plan | None) -> bool:
        """Whether its last connection was made for a plan."""
        return self.active is not None and self.active.sortie.case.plan is plan

    def since_take_off_s(self) -> float | None:
        """How long its motors have been running, infinity where nobody saw them start; None on the ground."""
        view = self.view
        if self.active is None or view is None or not view.state.is_armed:
            return None
        return self.active.since_take_off_s(view) if self.active.was_on_ground else math.inf


def sortie_of(plan: Plan | None, number: int) -> int:
    """The first sortie, from 1, that a plan gives an aircraft; the first of all where it gives it none."""
    sorties = () if plan is None else plan.sorties
    return next((n for n, sortie in enumerate(sorties, 1) if sortie.aircraft == number), 1)


def n_aircraft(plan: Plan | None) -> int:
    """How many aircraft a plan flies with at once."""
    return max((sortie.aircraft or 1 for sortie in (() if plan is None else plan.sorties)), default=1)
