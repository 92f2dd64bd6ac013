"""Cameras of a planned or flown flight, as the photos that are to be rendered."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

from planning.plan import Camera, Plan, Viewpoint
from reconstruction.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.photos.write import photo_name

FIRST_AT, BETWEEN = datetime(2024, 5, 1, 10, 0, 0), timedelta(seconds=5)
"""When photos of a plan, which has no clock, are said to be taken."""

BETWEEN_SORTIES = timedelta(hours=1)
"""From the start of a flown sortie's record to that of the next; records count their own time."""

WIDTHS_PX = (16, 20_000)
"""Narrower pictures show nothing, wider ones no camera takes."""


@dataclass(frozen=True, slots=True)
class Shot:
    """Where a camera was and looked, and when: `at` counts from the first sortie's start."""

    view: Viewpoint
    at: timedelta


def planned_shots(plan: Plan) -> tuple[Shot, ...]:
    """Shots of a plan in the order of flight; viewpoints that are in no sortie come last."""
    order = {id_: place for place, id_ in enumerate(id_ for sortie in plan.sorties for id_ in sortie.viewpoint_ids)}
    views = sorted(plan.viewpoints, key=lambda view: order.get(view.id, len(order)))
    return tuple(Shot(view, number * BETWEEN) for number, view in enumerate(views))


def lens_of(camera: Camera, width_px: int | None = None) -> Intrinsics:
    """Of a planned camera whose pictures are made `width_px` wide, in the same shape; None: as the camera takes them.

    Raises
    ------
    ValueError
        The width cannot be one of a picture.
    """
    lens = Intrinsics.of(camera)
    if width_px is None:
        return lens
    if not WIDTHS_PX[0] <= width_px <= WIDTHS_PX[1]:
        raise ValueError(f"width_px: expected {WIDTHS_PX[0]} to {WIDTHS_PX[1]}, got {width_px}")
    return lens.scaled(width_px, max(1, round(width_px * lens.height_px / lens.width_px)))


def posed_photos(shots: Iterable[Shot], lens: Intrinsics, folder: Path) -> tuple[PosedPhoto, ...]:
    """Photos of shots, in the order of time, named as DJI's cameras name them, to lie in `folder`."""
    photos = []
    for number, shot in enumerate(sorted(shots, key=lambda shot: shot.at), 1):
        taken_at = FIRST_AT + shot.at
        name = photo_name(number, taken_at)
        photos.append(PosedPhoto(name, folder / name, lens, Pose.of(shot.view), taken_at))
    return tuple(photos)


def flown_shots(sorties: Sequence[Sequence[tuple[Viewpoint, float]]]) -> tuple[Shot, ...]:
    """Shots of a flight.

    Parameters
    ----------
    sorties
        Each one's poses with seconds since the start of its record.
    """
    return tuple(
        Shot(view, number * BETWEEN_SORTIES + timedelta(seconds=time_s))
        for number, sortie in enumerate(sorties)
        for view, time_s in sortie
    )
