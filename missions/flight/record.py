"""The record of a flight: the track, the photos, and what was noticed; from a simulation, live telemetry or a log."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision
from planning.geo.frames import Vec3

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Samples of where the aircraft was, in the order of time; NaN where a source does not say.

    Parameters
    ----------
    time_s
        Shape (n,), seconds since the record's start, rising.
    position_enu_m, velocity_enu_m_s
        Shape (n, 3), local frame of the site.
    heading_rad
        Shape (n,), of the nose, clockwise from north.
    gimbal_pitch_rad, gimbal_heading_rad
        Shape (n,), of the camera, against the horizon and north.
    battery
        Shape (n,), charge left, 1 full.
    """

    time_s: Floats
    position_enu_m: Floats
    velocity_enu_m_s: Floats
    heading_rad: Floats
    gimbal_pitch_rad: Floats
    gimbal_heading_rad: Floats
    battery: Floats

    def __post_init__(self) -> None:
        n = len(self.time_s)
        for name in self.__slots__:
            shape = (n, 3) if name.endswith(("enu_m", "enu_m_s")) else (n,)
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name}: expected shape {shape}, got {getattr(self, name).shape}")
        if not (np.diff(self.time_s) >= 0.0).all():
            raise ValueError("time_s: expected rising times")


@dataclass(frozen=True, slots=True)
class TakenPhoto:
    """One photo that was really taken; None where the source does not say.

    Parameters
    ----------
    index
        The camera's own count.
    heading_deg, gimbal_pitch_deg
        Of the camera: clockwise from north; 0 level, -90 straight down.
    speed_m_s
        Over the ground at the shutter.
    source
        `camera-feedback`, `image-captured`, `log`, `photo-file`, or `simulation` for the true pose.
    exposure_s
        How long the shutter was open.
    """

    index: int
    time_s: float
    position_enu_m: Vec3
    heading_deg: float | None = None
    gimbal_pitch_deg: float | None = None
    speed_m_s: float | None = None
    source: str = "camera-feedback"
    file: str = ""
    exposure_s: float | None = None


@dataclass(frozen=True, slots=True)
class FlightEvent:
    """Something that happened: mode changes, texts of the autopilot, link lost and found, warnings."""

    time_s: float
    code: str
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class FlightRecord:
    """One sortie as it was flown.

    Parameters
    ----------
    sortie
        Number in the plan, from 1; 0 where it is not known.
    vehicle
        Who flew it, for the reader: autopilot and link.
    duration_s
        From lift-off to touch-down; None where the record does not hold both.
    effects
        Decisions of the simulator; empty for real flights.
    counted_before, counted_after
        Photos that the camera had counted before and after the flight; None where it did not say.
    is_disarmed
        Whether the record goes on to where the motors were stopped; None where it does not say.
    """

    sortie: int
    vehicle: str
    track: Track
    photos: tuple[TakenPhoto, ...]
    events: tuple[FlightEvent, ...] = ()
    duration_s: float | None = None
    effects: tuple[Decision, ...] = ()
    counted_before: int | None = None
    counted_after: int | None = None
    is_disarmed: bool | None = None
