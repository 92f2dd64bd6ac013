"""Flights for tests: records of a plan flown exactly, and ways to spoil them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.motion.timing import motion_limits, sortie_flight_path, stopping_duration_s, stopping_times_s
from planning.plan import Plan, viewpoint_arrays

SAMPLE_S = 0.2


def with_durations(plan: Plan) -> Plan:
    """The plan with the durations that flying it as `flown_as_planned` does takes."""
    by_id = {view.id: view for view in plan.viewpoints}
    sorties = []
    for sortie in plan.sorties:
        timed = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules)
        assert timed is not None
        sorties.append(replace(sortie, duration_s=stopping_duration_s(timed[0], plan.aircraft, plan.rules)))
    return replace(plan, sorties=tuple(sorties))


def flown_as_planned(plan: Plan) -> tuple[FlightRecord, ...]:
    """One record for each sortie: every vertex reached, every photo taken where and when it should be."""
    by_id = {view.id: view for view in plan.viewpoints}
    records = []
    for number, sortie in enumerate(plan.sorties, 1):
        timed = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules)
        assert timed is not None
        path, at_photos = timed
        arrival_s = stopping_times_s(path, motion_limits(plan.aircraft, plan.rules))
        leave_s = arrival_s + path.hover_s
        start_s = plan.rules.takeoff_landing_s / 2.0
        duration_s = float(leave_s[-1]) + 2.0 * start_s
        knots_s = start_s + np.stack([arrival_s, leave_s], axis=1).ravel()
        knots_s = np.concatenate([[0.0], knots_s, [duration_s]])
        points = np.repeat(path.vertices_enu_m, 2, axis=0)
        points = np.concatenate([points[:1], points, points[-1:]])
        views = viewpoint_arrays(tuple(by_id[identifier] for identifier in sortie.viewpoint_ids))
        photo_s = start_s + leave_s[at_photos] - plan.rules.photo_s
        time_s = np.unique(np.concatenate([np.arange(0.0, duration_s, SAMPLE_S), photo_s, [duration_s]]))
        position = np.stack([np.interp(time_s, knots_s, points[:, axis]) for axis in range(3)], axis=1)
        velocity = np.gradient(position, time_s, axis=0)
        velocity[np.isin(time_s, photo_s)] = 0.0
        turned_s = start_s + leave_s[at_photos]
        view = np.minimum(np.searchsorted(turned_s, time_s), len(photo_s) - 1)
        track = Track(
            time_s,
            position,
            velocity,
            views.heading_rad[view],
            views.pitch_rad[view],
            views.heading_rad[view],
            1.0 - time_s / plan.aircraft.endurance_s,
        )
        photos = tuple(
            TakenPhoto(
                index,
                float(when),
                by_id[identifier].position_enu_m,
                by_id[identifier].heading_deg,
                by_id[identifier].gimbal_pitch_deg,
                0.0,
            )
            for index, (when, identifier) in enumerate(zip(photo_s, sortie.viewpoint_ids, strict=True), 1)
        )
        records.append(FlightRecord(number, "test", track, photos, duration_s=float(leave_s[-1])))
    return tuple(records)


def with_photos(
    record: FlightRecord, change: Callable[[tuple[TakenPhoto, ...]], tuple[TakenPhoto, ...]]
) -> FlightRecord:
    """The record with other photos."""
    return replace(record, photos=change(record.photos))


def never_taken(record: FlightRecord, *lost: int) -> FlightRecord:
    """The record of a camera that did not take some photos, and counts on as if they had not been asked for."""
    kept = [photo for i, photo in enumerate(record.photos) if i not in lost]
    return replace(record, photos=tuple(replace(photo, index=i) for i, photo in enumerate(kept, 1)))


def moved(photo: TakenPhoto, by_enu_m: tuple[float, float, float], turned_deg: float = 0.0) -> TakenPhoto:
    """The photo taken elsewhere, looking elsewhere."""
    x, y, z = (a + b for a, b in zip(photo.position_enu_m, by_enu_m, strict=True))
    heading = photo.heading_deg
    return replace(photo, position_enu_m=(x, y, z), heading_deg=None if heading is None else heading + turned_deg)


def cut_at(record: FlightRecord, end_s: float) -> FlightRecord:
    """What is left of a record that ends at a time."""
    track, kept = record.track, record.track.time_s <= end_s
    columns = {name: getattr(track, name)[kept] for name in Track.__slots__}
    photos = tuple(photo for photo in record.photos if photo.time_s <= end_s)
    return replace(record, track=Track(**columns), photos=photos, duration_s=None)
