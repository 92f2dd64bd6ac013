"""Photos of a flight file: where they were taken and looked, and how the aircraft moved meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from groundstation.services.top_up import flown_plan
from missions.flight.flight_file import Flight, read_flight
from missions.flight.matching import PhotoRef
from missions.flight.motion import shutter_velocities
from missions.flight.poses import pose_of_photo, taken_poses
from missions.flight.record import TakenPhoto
from planning.errors import InputError
from planning.findings import Finding, Severity
from planning.plan import Plan, Viewpoint
from planning.site import SiteModel
from reconstruction.scenes.flight_views import Shot, flown_shots


def shots_of_flight(path: Path, plan: Plan | None, model: SiteModel) -> tuple[tuple[Shot, ...], tuple[Finding, ...]]:
    """Shots of a flight over a site, and what there is to say of photos that are left out.

    Parameters
    ----------
    plan
        That was flown: its angles count where the flight knows none.

    Raises
    ------
    InputError
        The file cannot be read, is of another site, or none of its photos says where the camera looked.
    """
    flight, site = read_flight(path), model.site
    if flight.site != site.name or flight.origin != site.origin:
        raise InputError(
            f"{path}: this is a flight over '{flight.site}', and not over '{site.name}' at its origin; name the "
            "site that was flown over"
        )
    poses = _poses(flight, plan, model)
    n_photos = sum(len(record.photos) for record in flight.sorties)
    if not poses:
        raise InputError(
            f"{path}: none of its {n_photos} photos says where the camera looked; name the plan that was flown "
            "as well (--plan)"
        )
    sorties, motions = [], []
    for number, record in enumerate(flight.sorties):
        velocities = shutter_velocities(record)
        posed = [(ref, photo) for ref, photo in _photos_of(flight, number) if ref in poses]
        sorties.append([(poses[ref], photo.time_s) for ref, photo in posed])
        motions.append([(velocities[ref.photo], photo.exposure_s) for ref, photo in posed])
    findings = (_without_direction(n_photos - len(poses), n_photos),) if len(poses) < n_photos else ()
    return flown_shots(sorties, motions), findings


def _poses(flight: Flight, plan: Plan | None, model: SiteModel) -> dict[PhotoRef, Viewpoint]:
    """Poses of all photos whose direction is known."""
    if plan is not None:
        return taken_poses(plan, flight.sorties, flown_plan(flight, plan, model).matching)
    refs = (pair for number in range(len(flight.sorties)) for pair in _photos_of(flight, number))
    poses = ((ref, pose_of_photo(photo, None)) for ref, photo in refs)
    return {ref: pose for ref, pose in poses if pose is not None}


def _photos_of(flight: Flight, record: int) -> Iterator[tuple[PhotoRef, TakenPhoto]]:
    return ((PhotoRef(record, number), photo) for number, photo in enumerate(flight.sorties[record].photos))


def _without_direction(n: int, n_all: int) -> Finding:
    text = f"{n} of {n_all} photos do not say where the camera looked, and are left out; name the plan that was flown"
    return Finding(Severity.WARNING, "photo-direction", text, "", float(n), 0.0, "photos")
