"""From where, and in which direction, the photos of a flight were really taken."""

from __future__ import annotations

from collections.abc import Sequence

from missions.flight.matching import Matching, PhotoRef
from missions.flight.record import FlightRecord, TakenPhoto
from planning.geo.frames import wrap_heading_deg
from planning.plan import Plan, Viewpoint


def taken_poses(plan: Plan, records: Sequence[FlightRecord], matching: Matching) -> dict[PhotoRef, Viewpoint]:
    """Poses of all photos whose direction is known; that of a view has the view's angles where its source does not say.

    The photos that are missing here belong to no view, and nothing says where they look.
    """
    by_id = {view.id: view for view in plan.viewpoints}
    view_of = {match.photo: by_id[match.view_id] for match in matching.views if match.photo is not None}
    refs = (PhotoRef(record, photo) for record, flown in enumerate(records) for photo in range(len(flown.photos)))
    poses = ((ref, pose_of_photo(records[ref.record].photos[ref.photo], view_of.get(ref))) for ref in refs)
    return {ref: pose for ref, pose in poses if pose is not None}


def pose_of_photo(photo: TakenPhoto, view: Viewpoint | None) -> Viewpoint | None:
    """Where a photo was taken from and looks to; None where neither it nor its view says the direction."""
    heading_deg, pitch_deg = photo.heading_deg, photo.gimbal_pitch_deg
    if view is not None:
        heading_deg = view.heading_deg if heading_deg is None else heading_deg
        pitch_deg = view.gimbal_pitch_deg if pitch_deg is None else pitch_deg
    if heading_deg is None or pitch_deg is None:
        return None
    return Viewpoint("photo", photo.position_enu_m, wrap_heading_deg(heading_deg), min(90.0, max(-180.0, pitch_deg)))
