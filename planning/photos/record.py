"""What one photo file says, as a record in our units and frames."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

RTK_FIXED = 50
"""DJI's flag of a position that is good to centimetres: 0 none, 16 single, 32 to 49 float, 50 fixed."""


@dataclass(frozen=True, slots=True)
class Dewarp:
    """Brown's camera model as DJI writes it: focal lengths, offset of the optical centre from the picture's, pixels."""

    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    k1: float
    k2: float
    p1: float
    p2: float
    k3: float


@dataclass(frozen=True, slots=True)
class PhotoMetadata:
    """What a photo file says; None where it does not.

    Parameters
    ----------
    width_px, height_px, orientation
        Of the picture as stored, and EXIF's number for how it is to be turned (1: not at all).
    is_complete
        False where the file has no end of the picture.
    image_index
        The camera's count, from the file's name.
    image_source
        Which of several cameras, in DJI's words, such as `WideCamera` and `InfraredCamera`.
    taken_at
        The camera's clock, without time zone, with fractions of a second where they are recorded.
    utc_offset_s
        What that clock is ahead of UTC.
    exposed_at
        The positioning clock at the exposure, called UTC by DJI; in samples it was 19 s ahead of the camera's clock, so
        that the two are never to be mixed.
    lat_deg, lon_deg
        WGS 84: EXIF's, which all programs show, or XMP's where EXIF has none.
    position_disagreement_m
        How far EXIF's and XMP's positions are apart.
    height_ellipsoid_m, altitude_amsl_m
        One of them at most: above the ellipsoid or above sea level, as the maker defines it.
    height_above_takeoff_m
        Above the place of take-off, by the barometer.
    gimbal_heading_deg, gimbal_pitch_deg, gimbal_roll_deg
        Of the camera: clockwise from north in (-180, 180]; 0 level, -90 straight down; 0 upright. A gimbal that swung
        through the vertical has a pitch below -90, not a roll of 180.
    flight_heading_deg, flight_pitch_deg, flight_roll_deg
        Of the aircraft.
    speed_north_m_s, speed_east_m_s, speed_vertical_m_s
        DJI does not say in which direction the vertical speed counts.
    rtk_flag
        As `RTK_FIXED` says.
    rtk_std_lon_m, rtk_std_lat_m, rtk_std_height_m, rtk_age_s
        Standard deviations, and the age of the corrections.
    accuracy_horizontal_m, accuracy_vertical_m, accuracy_heading_deg, accuracy_tilt_deg
        Standard deviations of position and angles, where a maker other than DJI gives them.
    range_m, range_lat_deg, range_lon_deg, range_height_m
        What the laser range finder hit, its height counted like the photo's own.
    exposure_s, f_number, iso, focal_length_mm, focal_length_35mm_mm
        Of the shot; the last is the equivalent on 36 mm x 24 mm.
    focal_plane_px_per_mm
        Pixels of the stored picture on a millimetre of the sensor, as EXIF says.
    calibrated_focal_length_px, optical_center_px, dewarp
        Calibration by the maker, or by DJI Terra.
    is_dewarped
        Whether the picture has been straightened with it already.
    """

    path: Path
    width_px: int
    height_px: int
    is_complete: bool = True
    orientation: int | None = None
    make: str | None = None
    model: str | None = None
    drone_model: str | None = None
    camera_serial: str | None = None
    drone_serial: str | None = None
    image_index: int | None = None
    image_source: str | None = None
    taken_at: datetime | None = None
    utc_offset_s: float | None = None
    exposed_at: datetime | None = None
    lat_deg: float | None = None
    lon_deg: float | None = None
    position_disagreement_m: float | None = None
    gps_status: str | None = None
    height_ellipsoid_m: float | None = None
    altitude_amsl_m: float | None = None
    height_above_takeoff_m: float | None = None
    gimbal_heading_deg: float | None = None
    gimbal_pitch_deg: float | None = None
    gimbal_roll_deg: float | None = None
    flight_heading_deg: float | None = None
    flight_pitch_deg: float | None = None
    flight_roll_deg: float | None = None
    speed_north_m_s: float | None = None
    speed_east_m_s: float | None = None
    speed_vertical_m_s: float | None = None
    rtk_flag: int | None = None
    rtk_std_lon_m: float | None = None
    rtk_std_lat_m: float | None = None
    rtk_std_height_m: float | None = None
    rtk_age_s: float | None = None
    accuracy_horizontal_m: float | None = None
    accuracy_vertical_m: float | None = None
    accuracy_heading_deg: float | None = None
    accuracy_tilt_deg: float | None = None
    range_m: float | None = None
    range_lat_deg: float | None = None
    range_lon_deg: float | None = None
    range_height_m: float | None = None
    exposure_s: float | None = None
    f_number: float | None = None
    iso: int | None = None
    focal_length_mm: float | None = None
    focal_length_35mm_mm: float | None = None
    focal_plane_px_per_mm: float | None = None
    calibrated_focal_length_px: float | None = None
    optical_center_px: tuple[float, float] | None = None
    dewarp: Dewarp | None = None
    is_dewarped: bool | None = None

    @property
    def is_rtk_fixed(self) -> bool:
        """Whether the position is good to centimetres."""
        return self.rtk_flag == RTK_FIXED

    @property
    def speed_m_s(self) -> float | None:
        """Speed over ground and up or down together."""
        parts = (self.speed_north_m_s, self.speed_east_m_s, self.speed_vertical_m_s)
        known = [part for part in parts if part is not None]
        return math.hypot(*known) if len(known) == len(parts) else None
