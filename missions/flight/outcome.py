"""What a flight achieved against its plan, as records: per view, per sortie, and in all; `report.py` makes them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from planning.base.findings import Finding
from planning.geo.frames import Vec3


class Reason(StrEnum):
    """Why a planned view has no photo; `TAKEN` where it has one.

    `NOT_FLOWN`: no record belongs to its sortie. `NOT_REACHED`: the aircraft passed it by. `NO_PHOTO`: it was there,
    but the camera did not answer. `REPORT_LOST`: the camera counted a photo there, but its report did not arrive; from
    where it was taken is not known. `TOO_FAR` and `WRONG_ANGLE`: a photo was taken, but not of this view.
    `FLIGHT_ENDED`: the sortie was over before. `NOT_RECORDED`: the record ends before, while the aircraft flies on.
    `NO_TRACK`: the record does not say where the aircraft was.
    """

    TAKEN = "taken"
    NOT_FLOWN = "not-flown"
    NOT_REACHED = "not-reached"
    NO_PHOTO = "no-photo"
    REPORT_LOST = "report-lost"
    TOO_FAR = "too-far"
    WRONG_ANGLE = "wrong-angle"
    FLIGHT_ENDED = "flight-ended"
    NOT_RECORDED = "not-recorded"
    NO_TRACK = "no-track"


class Ending(StrEnum):
    """How a flight left its mission before the end, as its record knows; `UNKNOWN` where it does not, or flew it all.

    `RETURN` and `LAND`: in that mode, by the pilot or for a reason that the record does not hold. `BATTERY`, `LINK`,
    `REMOTE`, `FENCE`: by the autopilot itself, for a low battery, for the silence of the ground station or of the
    remote control, and at the fence. `HAND`: in a mode in which the pilot steers. `MOTORS`: they stopped in the air.
    """

    UNKNOWN = "unknown"
    RETURN = "return"
    LAND = "land"
    BATTERY = "battery"
    LINK = "link"
    REMOTE = "remote"
    FENCE = "fence"
    HAND = "hand"
    MOTORS = "motors"


@dataclass(frozen=True, slots=True)
class ViewOutcome:
    """A planned view and its photo; None where there is none or the source does not say.

    Parameters
    ----------
    sortie
        Number in the plan, from 1.
    record, photo
        Which of the flight's records and of its photos, from 0.
    position_error_m
        From the planned position to the camera at the shutter.
    heading_error_deg, gimbal_pitch_error_deg
        Flown less planned.
    blur_px
        How far the picture moves on the sensor during the exposure.
    distance_m
        From the camera to the nearest panel, mesh or obstacle; negative inside one.
    n_planned, n_flown
        Sections that the view covers as planned, and its photo as taken.
    """

    view_id: str
    sortie: int
    reason: Reason
    record: int | None = None
    photo: int | None = None
    n_planned: int = 0
    n_flown: int = 0
    position_error_m: float | None = None
    heading_error_deg: float | None = None
    gimbal_pitch_error_deg: float | None = None
    speed_m_s: float | None = None
    blur_px: float | None = None
    distance_m: float | None = None


@dataclass(frozen=True, slots=True)
class SortieOutcome:
    """One record of a flight against the sortie it flew.

    Parameters
    ----------
    record
        Which of the flight's records, from 0.
    sortie
        Number in the plan, from 1; 0 where it flew none of them.
    n_views, n_taken
        Views of the sortie, and those of them with a photo in this record.
    n_extra
        Photos of this record that belong to no view, or to one that has a photo already.
    duration_predicted_s, duration_flown_s
        From lift-off to touch-down; without what the plan adds for motors on the ground, check hover and landing.
    battery_predicted, battery_used
        Parts of a full battery; the prediction with what the plan adds.
    least_distance_m, least_distance_time_s, least_distance_enu_m
        Smallest distance to panels, mesh and obstacles along the track, when, and where.
    least_height_m, least_height_time_s
        Smallest height above the ground along the track, as far as the ground is known, beside the places of take-off
        and landing; and when.
    unknown_ground
        Share of those ways, 0 to 1, below which the terrain has no heights.
    ending
        How the record left its mission.
    """

    record: int
    sortie: int
    n_views: int
    n_taken: int
    n_extra: int
    duration_predicted_s: float | None = None
    duration_flown_s: float | None = None
    battery_predicted: float | None = None
    battery_used: float | None = None
    least_distance_m: float | None = None
    least_distance_time_s: float | None = None
    least_distance_enu_m: Vec3 | None = None
    ending: Ending = Ending.UNKNOWN
    least_height_m: float | None = None
    least_height_time_s: float | None = None
    unknown_ground: float = 0.0


@dataclass(frozen=True, slots=True)
class Summary:
    """A flight in numbers.

    Parameters
    ----------
    n_views, n_taken, n_photos
        Planned views, those with a photo, and all photos taken.
    covered_planned, covered, total
        Sections covered by the plan, by the photos as they were taken, and all there are.
    lost_panels
        Panels that the plan sees and no photo does.
    duration_predicted_s, duration_flown_s
        From lift-off to touch-down, of all sorties flown; None where a record does not say.
    least_distance_m
        To panels, mesh and obstacles, along all tracks.
    least_height_m
        Above the ground, likewise.
    """

    n_views: int
    n_taken: int
    n_photos: int
    covered_planned: int
    covered: int
    total: int
    lost_panels: tuple[str, ...] = ()
    duration_predicted_s: float | None = None
    duration_flown_s: float | None = None
    least_distance_m: float | None = None
    least_height_m: float | None = None


@dataclass(frozen=True, slots=True)
class FlightReport:
    """The whole comparison: numbers, every view in the plan's order, every record, and what each rule found."""

    summary: Summary
    views: tuple[ViewOutcome, ...]
    sorties: tuple[SortieOutcome, ...]
    findings: tuple[Finding, ...]
