"""From what a log says to flight records: cleaned, split into flights, in the frame of the site.

A log may hold several flights; one runs from arming to disarming, or through the whole log where it does not say when
the motors ran. What never left its place and took no photo is no flight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from missions.flight.logs.raw import Floats, RawLog, RawPhoto, Row, camera_angles_rad, table
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track
from missions.mavlink.autopilots import Autopilot
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import wrap_heading_deg, wrap_heading_rad
from planning.geo.mesh import MAX_COORDINATE_M
from planning.site.records import HEIGHT_DIFFERENCE_M, MAX_DISTANCE_M, Site

HeightSource = Literal["takeoff", "sea-level"]
"""What heights are counted from: `takeoff` is the site's home, plus what the autopilot says to be above its own home,
as missions are flown; `sea-level` is the altitude as it stands, which is as good as the receiver and the geoid."""

GAP_S = 2.0
"""Values are not carried over longer pauses: an aircraft at 5 m/s is 10 m further on."""

FLOWN_M = 2.0
"""A record that stays within this is no flight: a receiver on the ground wanders about as far."""

ON_GROUND_M = 2.0
"""Height above home below which a record begins or ends on the ground."""

LIFTED_M = 0.5
"""Height above where it stood from which an aircraft flies; barometers wander by some decimetres."""

ARMED_LATE_S = 2.0
"""Motors may have been armed this much earlier than a log says: heartbeats, which tell of it, come once a second.
Photos, too, are told of a little later than they are taken."""


@dataclass(frozen=True, slots=True)
class LogFlights:
    """The flights of a log, in order, what the pilot should know about them, and whose they are if that is known."""

    records: tuple[FlightRecord, ...]
    findings: tuple[Finding, ...]
    autopilot: Autopilot | None = None


def flights_of(log: RawLog, site: Site, label: str, heights: HeightSource = "takeoff") -> LogFlights:
    """Flight records of a log.

    Parameters
    ----------
    label
        Name of the log, for messages.

    Raises
    ------
    InputError
        The log holds no positions, all of them are far from the site, or the aircraft never flew.
    """
    place = _Place.of(log, site, label, heights)
    photos = log.photos or log.triggers
    findings = [*log.findings, *place.findings]
    if photos and not log.photos:
        text = say("the log tells when photos were triggered, not that they were taken")
        findings.append(Finding(Severity.WARNING, "triggers-only", text))
    records = []
    for interval in _intervals(log, place.time_s):
        record = _record(log, place, photos, interval)
        if record is not None:
            records.append(record)
    if not records:
        raise InputError.say(
            "the aircraft did not fly while this log was written; take the log of the flight", place=label
        )
    return LogFlights(tuple(records), tuple(findings), log.autopilot)


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """Positions of a log in the site's frame.

    Parameters
    ----------
    time_s, position_enu_m
        Shape (n,), rising, and (n, 3).
    """

    site: Site
    heights: HeightSource
    time_s: Floats
    position_enu_m: Floats
    findings: tuple[Finding, ...]

    @classmethod
    def of(cls, log: RawLog, site: Site, label: str, heights: HeightSource) -> _Place:
        rows = np.array(log.positions, np.float64).reshape(-1, 5)
        findings = []
        back_s = float(np.max(-np.diff(rows[:, 0]), initial=0.0))
        if back_s > 1.0:
            text = say("time goes back in the log, by {:.1f} s at most; what it says was put in order", back_s)
            findings.append(Finding(Severity.WARNING, "time-went-back", text, "", back_s))
        values = table(log.positions, 5)
        values = values[_is_on_globe(values[:, 1:4])]
        if len(values) == 0:
            raise InputError.say(
                "holds no position of the aircraft; a log of the whole flight with GNSS reception is needed",
                place=label,
            )
        if len(values) < len(rows):
            n = len(rows) - len(values)
            findings.append(
                Finding(Severity.NOTE, "positions-dropped", say("{} positions are none and were left out", n))
            )
        if heights == "takeoff" and not np.isfinite(values[:, 4]).any():
            text = say("the log has no heights above take-off; those above sea level are taken")
            findings.append(Finding(Severity.WARNING, "height-reference", text))
            heights = "sea-level"
        points = _enu_m(values[:, 1:], site, heights)
        is_near = np.isfinite(points).all(axis=1) & (np.abs(points) < MAX_COORDINATE_M).all(axis=1)
        nearest_m = float(np.min(np.linalg.norm(points[is_near], axis=1), initial=np.inf))
        if nearest_m > MAX_DISTANCE_M:
            away_km = float(np.min(np.linalg.norm(np.nan_to_num(points), axis=1))) / 1000.0
            raise InputError.say(
                "the flight is {:.1f} km from the site '{}'; expected at most {:g} km; is it the right log, and "
                "the right site?",
                away_km,
                site.name,
                MAX_DISTANCE_M / 1000.0,
                place=label,
            )
        findings += _height_findings(values[is_near, 1:], site, points[is_near], heights)
        return cls(site, heights, values[is_near, 0], points[is_near], tuple(findings))

    def photo_enu_m(self, photo: RawPhoto) -> Floats | None:
        """Where a photo says it was taken, shape (3,); None where it does not."""
        row = np.array([[photo.lat_deg, photo.lon_deg, photo.altitude_amsl_m, photo.above_home_m]])
        if not _is_on_globe(row[:, :3]).all():
            return None
        point = _enu_m(row, self.site, self.heights)[0]
        return point if np.isfinite(point).all() and (np.abs(point) < MAX_COORDINATE_M).all() else None

    def interpolated_enu_m(self, time_s: Floats) -> Floats:
        """Positions at any times, shape (n, 3); NaN in gaps."""
        return np.stack([_at(time_s, self.time_s, self.position_enu_m[:, axis]) for axis in range(3)], axis=1)


def _is_on_globe(rows: Floats) -> NDArray[np.bool_]:
    """Whether latitude, longitude, altitude are a place; autopilots without a fix write 0, 0."""
    finite = np.asarray(np.isfinite(rows).all(axis=1))
    lat, lon = np.abs(np.where(finite[:, None], rows[:, :2], 0.0)).T
    return np.asarray(finite & (lat <= 90.0) & (lon <= 180.0) & ((lat > 1e-6) | (lon > 1e-6)))


def _enu_m(rows: Floats, site: Site, heights: HeightSource) -> Floats:
    """ENU, shape (n, 3), of latitude, longitude, altitude above sea level and above home; NaN without height."""
    from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
    from planning.geo.geoid import ellipsoid_from_amsl_m

    lat, lon, amsl_m, above_home_m = rows.T
    if heights == "sea-level":
        height_m = ellipsoid_from_amsl_m(lat, lon, amsl_m)
    else:
        home_m = float(geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0])
        height_m = home_m + above_home_m
    is_known = np.isfinite(height_m) & (np.abs(height_m) < 1e5)
    points = enu_from_geodetic(site.origin, lat, lon, np.where(is_known, height_m, 0.0))
    return np.where(is_known[:, None], points, np.nan)


def _height_findings(rows: Floats, site: Site, points: Floats, heights: HeightSource) -> list[Finding]:
    """How far both ways to count heights are apart, where that is worth a word."""
    other = _enu_m(rows, site, "sea-level" if heights == "takeoff" else "takeoff")
    apart = (other - points)[:, 2]
    if not np.isfinite(apart).any():
        return []
    median_m = float(np.median(apart[np.isfinite(apart)]))
    if abs(median_m) <= HEIGHT_DIFFERENCE_M:
        return []
    used, not_used = (
        (say("take-off"), say("sea level")) if heights == "takeoff" else (say("sea level"), say("take-off"))
    )
    text = say("heights are counted from {}; counted from {} they would be {:+.1f} m", used, not_used, median_m)
    return [Finding(Severity.NOTE, "height-reference", text, "", median_m, HEIGHT_DIFFERENCE_M, "m")]


class _Interval(NamedTuple):
    """When the motors ran, and whether the log goes on to where they were stopped; None where it does not say."""

    start_s: float
    end_s: float
    is_disarmed: bool | None


def _intervals(log: RawLog, time_s: Floats) -> list[_Interval]:
    """When the motors ran; the whole log where it does not say."""
    armed = sorted(log.armed)
    if not any(is_armed for _, is_armed in armed):
        return [_Interval(float(time_s[0]), float(time_s[-1]) + ARMED_LATE_S, None)]
    intervals: list[_Interval] = []
    for (start_s, is_armed), (end_s, _) in zip(armed, [*armed[1:], (np.inf, False)], strict=True):
        if is_armed:
            earliest_s = intervals[-1].end_s if intervals else -np.inf
            start_s = max(start_s - ARMED_LATE_S, earliest_s)
            late_s = min(end_s, float(time_s[-1])) + ARMED_LATE_S
            intervals.append(_Interval(start_s, late_s, bool(np.isfinite(end_s))))
    return intervals


def _record(log: RawLog, place: _Place, photos: list[RawPhoto], interval: _Interval) -> FlightRecord | None:
    """The flight between two times; None where there was none."""
    start_s, end_s, is_disarmed = interval
    within = (place.time_s >= start_s) & (place.time_s <= end_s)
    time_s, positions = place.time_s[within], place.position_enu_m[within]
    # A report that was lost and asked for again comes late.
    taken = sorted((photo for photo in photos if start_s <= photo.time_s <= end_s), key=lambda photo: photo.time_s)
    moved_m = float(np.linalg.norm(np.ptp(positions, axis=0))) if len(positions) else 0.0
    if len(positions) == 0 or (moved_m < FLOWN_M and not taken):
        return None
    zero_s = float(time_s[0])
    track = _track(log, time_s, positions)
    events = [event for event in log.events if start_s <= event.time_s <= end_s]
    for before, pause in zip(time_s[:-1], np.diff(time_s), strict=True):
        if pause > GAP_S:
            events.append(FlightEvent(float(before), "gap", say("the log says nothing for {:.1f} s", pause)))
    shifted = (FlightEvent(event.time_s - zero_s, event.code, event.text) for event in events)
    return FlightRecord(
        sortie=0,
        vehicle=log.vehicle,
        track=Track(track.time_s - zero_s, *(getattr(track, name) for name in Track.__slots__[1:])),
        photos=tuple(p for photo in taken if (p := _photo(photo, place, track, zero_s)) is not None),
        events=tuple(sorted(shifted, key=lambda event: event.time_s)),
        duration_s=_duration_s(time_s, positions[:, 2] - place.site.home_enu_m[2]),
        counted_before=next((n for at_s, n in reversed(log.counted) if at_s <= start_s + ARMED_LATE_S), None),
        counted_after=next((n for at_s, n in log.counted if at_s >= end_s - ARMED_LATE_S), None),
        is_disarmed=is_disarmed,
    )


def _track(log: RawLog, time_s: Floats, positions: Floats) -> Track:
    velocity = table(log.velocities, 4)
    velocity_enu = velocity[:, [2, 1, 3]] * (1.0, 1.0, -1.0)
    heading = _angle_at(time_s, log.headings)
    camera_heading = _angle_at(time_s, log.gimbal_headings)
    camera_yaw = _angle_at(time_s, log.gimbal_yaws)
    of_nose = wrap_heading_rad(heading + np.where(np.isnan(camera_yaw), 0.0, camera_yaw))
    battery = table(log.battery, 2)
    return Track(
        time_s=time_s,
        position_enu_m=positions,
        velocity_enu_m_s=np.stack([_at(time_s, velocity[:, 0], velocity_enu[:, axis]) for axis in range(3)], axis=1),
        heading_rad=heading,
        gimbal_pitch_rad=_angle_at(time_s, log.gimbal_pitches),
        gimbal_heading_rad=np.where(np.isnan(camera_heading), of_nose, camera_heading),
        battery=_at(time_s, battery[:, 0], battery[:, 1], 10.0 * GAP_S),
    )


def _at(wanted_s: Floats, time_s: Floats, values: Floats, gap_s: float = GAP_S) -> Floats:
    """Values at wanted times, linear between known ones; NaN further than `gap_s` from the nearest one."""
    known = np.isfinite(values)
    time_s, values = time_s[known], values[known]
    if len(time_s) == 0:
        return np.full(len(wanted_s), np.nan)
    after = np.clip(np.searchsorted(time_s, wanted_s), 0, len(time_s) - 1)
    before = np.maximum(after - 1, 0)
    away_s = np.minimum(np.abs(wanted_s - time_s[before]), np.abs(wanted_s - time_s[after]))
    return np.where(away_s <= gap_s, np.interp(wanted_s, time_s, values), np.nan)


def _angle_at(wanted_s: Floats, rows: list[Row]) -> Floats:
    """Angles at wanted times in (-pi, pi], the short way between known ones; NaN in gaps."""
    values = table(rows, 2)
    values = values[np.isfinite(values[:, 1])]
    return wrap_heading_rad(_at(wanted_s, values[:, 0], np.unwrap(values[:, 1])))


def _photo(photo: RawPhoto, place: _Place, track: Track, zero_s: float) -> TakenPhoto | None:
    """A photo in the site's frame; None where neither it nor the track say where it was taken."""
    when = np.array([photo.time_s])
    position = place.photo_enu_m(photo)
    if position is None:
        position = place.interpolated_enu_m(when)[0]
    if not np.isfinite(position).all():
        return None
    speed = np.linalg.norm([_at(when, track.time_s, track.velocity_enu_m_s[:, axis])[0] for axis in range(3)])
    heading_deg, pitch_deg = _camera_deg(photo, track)
    return TakenPhoto(
        index=photo.index,
        time_s=photo.time_s - zero_s,
        position_enu_m=(float(position[0]), float(position[1]), float(position[2])),
        heading_deg=heading_deg,
        gimbal_pitch_deg=pitch_deg,
        speed_m_s=float(speed) if np.isfinite(speed) else None,
        source=photo.source,
        file=photo.file,
    )


def _camera_deg(photo: RawPhoto, track: Track) -> tuple[float | None, float | None]:
    """Heading and pitch of the camera at a photo.

    In this order: what the log says of the camera itself; the gimbal's own messages; the attitude that came with the
    photo, where no gimbal is heard; the heading of the nose.
    """
    when = np.array([photo.time_s])
    heading_deg, pitch_deg = photo.heading_deg, photo.gimbal_pitch_deg
    if pitch_deg is None:
        pitch_deg = _degrees_at(when, track.time_s, track.gimbal_pitch_rad)
    angles = None if pitch_deg is not None or photo.q_wxyz is None else camera_angles_rad(*photo.q_wxyz)
    if angles is not None:
        own_heading_deg, pitch_deg = map(math.degrees, angles)
        heading_deg = own_heading_deg if heading_deg is None else heading_deg
    if heading_deg is None:
        heading_deg = _degrees_at(when, track.time_s, track.gimbal_heading_rad)
    return heading_deg, pitch_deg


def _degrees_at(when: Floats, time_s: Floats, angles_rad: Floats) -> float | None:
    known = np.isfinite(angles_rad)
    value = float(_at(when, time_s[known], np.unwrap(angles_rad[known]))[0])
    return wrap_heading_deg(float(np.degrees(value))) if np.isfinite(value) else None


def _duration_s(time_s: Floats, height_m: Floats) -> float | None:
    """From lift-off to touch-down; None where the record does not begin and end on the ground."""
    if len(time_s) < 2 or height_m[0] > ON_GROUND_M or height_m[-1] > ON_GROUND_M:
        return None
    is_up = np.flatnonzero((height_m > height_m[0] + LIFTED_M) & (height_m > height_m[-1] + LIFTED_M))
    return float(time_s[is_up[-1]] - time_s[is_up[0]]) if len(is_up) else None
