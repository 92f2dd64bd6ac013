"""From where, and in which direction, the photos of a flight were really taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from missions.flight.matching import Matching, PhotoRef
from missions.flight.record import FlightRecord
from planning.plan import Plan, ViewpointArrays


@dataclass(frozen=True, slots=True, eq=False)
class TakenPoses:
    """Poses of the photos whose direction is known, and how many others there are."""

    views: ViewpointArrays
    n_without_direction: int


def taken_poses(plan: Plan, records: Sequence[FlightRecord], matching: Matching) -> TakenPoses:
    """Poses of all photos; a photo of a view has the view's angles where its source does not say."""
    by_id = {view.id: view for view in plan.viewpoints}
    view_of = {match.photo: by_id[match.view_id] for match in matching.views if match.photo is not None}
    poses: list[tuple[float, ...]] = []
    n_without_direction = 0
    for record_index, record in enumerate(records):
        for photo_index, photo in enumerate(record.photos):
            heading_deg, pitch_deg = photo.heading_deg, photo.gimbal_pitch_deg
            view = view_of.get(PhotoRef(record_index, photo_index))
            if view is not None:
                heading_deg = view.heading_deg if heading_deg is None else heading_deg
                pitch_deg = view.gimbal_pitch_deg if pitch_deg is None else pitch_deg
            if heading_deg is None or pitch_deg is None:
                n_without_direction += 1
            else:
                poses.append((*photo.position_enu_m, heading_deg, pitch_deg))
    columns = np.array(poses, np.float64).reshape(-1, 5)
    angles_rad = np.radians(columns[:, 3:])
    return TakenPoses(ViewpointArrays(columns[:, :3], angles_rad[:, 0], angles_rad[:, 1]), n_without_direction)
