"""Photos of a flight as files: where and when they were taken written as DJI's cameras do, with known errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from planning.geo.enu import geodetic_from_enu
from planning.geo.geoid import amsl_from_ellipsoid_m
from planning.plan import Viewpoint
from planning.site.records import Site
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, packet, save

START = datetime(2024, 5, 1, 10, 0, 0)


@dataclass(frozen=True)
class Device:
    """How the photos are taken and written.

    `position_m`, `angle_deg` are standard deviations; `takeoff_error_m` is what heights above take-off are too high by,
    `absolute_error_m` the same for absolute ones.
    """

    has_rtk: bool = True
    position_m: float = 0.0
    angle_deg: float = 0.0
    takeoff_error_m: float = 0.0
    absolute_error_m: float = 0.0
    interval_s: float = 6.0
    has_gimbal: bool = True
    has_heights: bool = True
    exposure_s: float = 0.001
    speed_m_s: float = 0.3
    source: str = "WideCamera"


def write_photos(
    folder: Path, site: Site, views: Sequence[Viewpoint], device: Device = Device(), start_s=0.0, first=1, seed=1
) -> None:
    """One photo for each view, in order."""
    noise = np.random.default_rng(seed)
    home_m = geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0]
    points = np.array([view.position_enu_m for view in views]) + noise.normal(0.0, device.position_m, (len(views), 3))
    lat, lon, height = geodetic_from_enu(site.origin, points)
    absolute = height if device.has_rtk else amsl_from_ellipsoid_m(lat, lon, height)
    for i, view in enumerate(views):
        taken = START + timedelta(seconds=start_s + device.interval_s * i)
        heading, pitch = np.array((view.heading_deg, view.gimbal_pitch_deg)) + noise.normal(0.0, device.angle_deg, 2)
        properties = {"ImageSource": device.source, "FlightYawDegree": "+12.0", "DroneSerialNumber": "A1"}
        properties |= {"FlightXSpeed": f"{device.speed_m_s}", "FlightYSpeed": "0.0", "FlightZSpeed": "0.0"}
        properties |= {"RtkFlag": "50", "AltitudeType": "RtkAlt"} if device.has_rtk else {}
        if device.has_heights:
            properties["AbsoluteAltitude"] = f"{absolute[i] + device.absolute_error_m:+.3f}"
            properties["RelativeAltitude"] = f"{height[i] - home_m + device.takeoff_error_m:+.3f}"
        if device.has_gimbal:
            properties["GimbalYawDegree"] = f"{(heading + 180.0) % 360.0 - 180.0:+.2f}"
            properties |= {"GimbalPitchDegree": f"{pitch:+.2f}", "GimbalRollDegree": "+0.00"}
        else:
            properties |= dict.fromkeys(("GimbalYawDegree", "GimbalPitchDegree", "GimbalRollDegree"), "+0.00")
        gps = gps_tags(float(lat[i]), float(lon[i]), float(absolute[i]))
        exif = exif_part(
            {0x010F: "DJI", 0x0110: "M3E"},
            {0x9003: f"{taken:%Y:%m:%d %H:%M:%S}", 0x9291: f"{taken:%f}"[:3], 0x829A: device.exposure_s, 0x920A: 12.29},
            gps if device.has_heights else {tag: value for tag, value in gps.items() if tag < 5},
        )
        save(folder / f"DJI_{taken:%Y%m%d%H%M%S}_{first + i:04d}_V.JPG", jpeg(exif, packet(properties)))
