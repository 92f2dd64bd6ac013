"""What is known of the flight that is shown, also after it ended."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from groundstation.services.fly.events import FlightEnded, LinkState, LiveView, PhotoCounted
from groundstation.services.fly.sortie import LiveSortie
from groundstation.vehicle.state import VehicleText
from planning.base.findings import Severity
from planning.geo.frames import Vec3


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

    def take_view(self, view: LiveView) -> tuple[VehicleText, ...]:
        """The flight as it stands now; returns the autopilot's texts that are new."""
        self.view = view
        state = view.state
        if self.took_off_s is None and state.is_armed:
            self.took_off_s = state.boot_time_s
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

    def take_photo(self, counted: PhotoCounted) -> None:
        """A photo was taken."""
        self.counted = counted
        if counted.view_id:
            self.photos[counted.view_id] = counted
