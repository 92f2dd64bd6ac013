"""Rendered photos as JPEG files, with where and how they were taken written into them as DJI's cameras do.

What `planning.photos` and `reconstruction.photos.poses` read back is the same to a tenth of a millimetre and of a
thousandth of a degree: angles count from the north and the vertical of the photo's own place, as everywhere in photos.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime
from fractions import Fraction

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin, Vec3
from planning.photos.exif import Content, Ratio, Tag, exif_content
from planning.photos.record import RTK_FIXED
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.photos.lens import MM35_DIAGONAL
from reconstruction.photos.poses import enu_axes

JPEG_QUALITY = 95

MAKE, MODEL = "DJI", "M3E"

EXIF_HEAD = b"Exif\0\0"
XMP_HEAD = b"http://ns.adobe.com/xap/1.0/\0"
XMP_START, XMP_END = (
    b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
    b'<rdf:Description xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/" xmlns:tiff="http://ns.adobe.com/tiff/1.0/" '
    b'xmlns:xmp="http://ns.adobe.com/xap/1.0/" ',
    b"/></rdf:RDF></x:xmpmeta>",
)

SECONDS_PARTS, METRES_PARTS = 10_000_000, 10_000
"""Denominators in EXIF: of seconds of arc (3 micrometres on the ground) and of heights."""

ABOVE_ELLIPSOID, BELOW_ELLIPSOID = b"\2", b"\3"
"""EXIF 3.0's references of a height."""

RTK_SINGLE = 16
"""DJI's flag of a position without corrections."""

FINEST = 100_000
"""Largest denominator of an exposure time."""


@dataclass(frozen=True, slots=True)
class Circumstances:
    """What a photo tells of how it was taken, beside its camera.

    Parameters
    ----------
    is_rtk_fixed
        Whether the receiver had an RTK fix; otherwise none at all.
    std_m
        Standard deviations of its position, horizontally per axis and vertically.
    exposure_s, velocity_enu_m_s
        How long the shutter was open, and how the aircraft moved; None where they are not told.
    """

    is_rtk_fixed: bool = True
    std_m: tuple[float, float] = (0.02, 0.03)
    exposure_s: float | None = None
    velocity_enu_m_s: Vec3 | None = None


USUAL = Circumstances()


def photo_name(number: int, taken_at: datetime) -> str:
    """Name of a flight's photo, numbered from 1, as DJI's cameras give it."""
    return f"DJI_{taken_at:%Y%m%d%H%M%S}_{number:04d}_V.JPG"


def photo_jpeg(
    picture: NDArray[np.uint8],
    photo: PosedPhoto,
    origin: Origin,
    taken_at: datetime,
    home_up_m: float = 0.0,
    how: Circumstances = USUAL,
) -> bytes:
    """A JPEG file with position, gimbal angles and a calibrated lens.

    Parameters
    ----------
    picture
        Shape (h, w, 3), blue, green, red.
    photo
        Its camera, in the frame of `origin`.
    home_up_m
        Height of the place of take-off in that frame.
    """
    encoded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()
    lat, lon, height = (float(part[0]) for part in geodetic_from_enu(origin, photo.pose.position_enu_m[None]))
    above_home_m = float(photo.pose.position_enu_m[2]) - home_up_m
    local = _at_its_place(photo.pose, origin, lat, lon)
    properties = _properties(photo.intrinsics, local, (lat, lon, height), above_home_m, taken_at) | _flown(how)
    xmp = " ".join(f'{name}="{value}"' for name, value in properties.items()).encode()
    exif = exif_content(_tags(photo.intrinsics, (lat, lon, height), taken_at) | _exposed(how))
    segments = _segment(EXIF_HEAD + exif) + _segment(XMP_HEAD + XMP_START + xmp + XMP_END)
    # They come right after the two bytes that every JPEG file begins with.
    return encoded[:2] + segments + encoded[2:]


def _segment(content: bytes) -> bytes:
    return b"\xff\xe1" + (len(content) + 2).to_bytes(2, "big") + content


def _at_its_place(pose: Pose, origin: Origin, lat_deg: float, lon_deg: float) -> Pose:
    """The pose turned into the axes east, north and up of the place itself."""
    local_from_site = enu_axes(lat_deg, lon_deg) @ enu_axes(origin.lat_deg, origin.lon_deg).T
    return Pose(pose.position_enu_m, pose.cam_from_enu @ local_from_site.T)


def _properties(
    lens: Intrinsics, pose: Pose, place: tuple[float, float, float], above_home_m: float, taken_at: datetime
) -> dict[str, str]:
    heading_deg, pitch_deg, roll_deg = pose.angles_deg
    lat, lon, height = place
    return {
        "tiff:Make": MAKE,
        "tiff:Model": MODEL,
        "xmp:CreateDate": f"{taken_at:%Y-%m-%dT%H:%M:%S}",
        "drone-dji:ImageSource": "WideCamera",
        "drone-dji:GpsLatitude": f"{lat:+.9f}",
        "drone-dji:GpsLongitude": f"{lon:+.9f}",
        "drone-dji:AbsoluteAltitude": f"{height:+.4f}",
        "drone-dji:RelativeAltitude": f"{above_home_m:+.4f}",
        "drone-dji:GimbalYawDegree": f"{heading_deg:+.4f}",
        "drone-dji:GimbalPitchDegree": f"{pitch_deg:+.4f}",
        "drone-dji:GimbalRollDegree": f"{roll_deg:+.4f}",
        # Without it, a gimbal that looks level to the north counts as one that recorded nothing.
        "drone-dji:FlightYawDegree": f"{heading_deg:+.4f}",
        "drone-dji:DewarpFlag": "0",
        "drone-dji:DewarpData": _dewarp(lens),
        "drone-dji:CalibratedFocalLength": f"{lens.fx_px:.4f}",
        "drone-dji:CalibratedOpticalCenterX": f"{lens.cx_px:.4f}",
        "drone-dji:CalibratedOpticalCenterY": f"{lens.cy_px:.4f}",
    }


def _flown(how: Circumstances) -> dict[str, str]:
    horizontal_m, vertical_m = how.std_m
    tags = {
        "drone-dji:RtkFlag": str(RTK_FIXED if how.is_rtk_fixed else RTK_SINGLE),
        "drone-dji:RtkStdLon": f"{horizontal_m:.5f}",
        "drone-dji:RtkStdLat": f"{horizontal_m:.5f}",
        "drone-dji:RtkStdHgt": f"{vertical_m:.5f}",
        "drone-dji:AltitudeType": "RtkAlt" if how.is_rtk_fixed else "GpsFusionAlt",
    }
    if how.velocity_enu_m_s is not None:
        east, north, up = how.velocity_enu_m_s
        for axis, speed in (("X", north), ("Y", east), ("Z", -up)):
            tags[f"drone-dji:Flight{axis}Speed"] = f"{speed:+.3f}"
    return tags


def _exposed(how: Circumstances) -> dict[Tag, Content]:
    exposure = Fraction(how.exposure_s or 0.0).limit_denominator(FINEST)
    return {Tag.EXPOSURE_TIME: ((exposure.numerator, exposure.denominator),)} if exposure > 0 else {}


def _dewarp(lens: Intrinsics) -> str:
    """Focal lengths, principal point from the middle of the picture, distortion."""
    centre = lens.cx_px - 0.5 * lens.width_px, lens.cy_px - 0.5 * lens.height_px
    return "2024-05-01;" + ",".join(f"{value:.9g}" for value in (lens.fx_px, lens.fy_px, *centre, *lens.distortion))


def _tags(lens: Intrinsics, place: tuple[float, float, float], taken_at: datetime) -> dict[Tag, Content]:
    lat, lon, height = place
    equivalent_mm = lens.fx_px / math.hypot(lens.width_px, lens.height_px) * MM35_DIAGONAL
    return {
        Tag.MAKE: MAKE,
        Tag.MODEL: MODEL,
        Tag.DATE_TIME_ORIGINAL: f"{taken_at:%Y:%m:%d %H:%M:%S}",
        Tag.SUB_SEC_TIME_ORIGINAL: f"{taken_at.microsecond // 1000:03d}",
        Tag.FOCAL_LENGTH_35MM: max(1, round(equivalent_mm)),
        Tag.GPS_LATITUDE_REF: "S" if lat < 0.0 else "N",
        Tag.GPS_LATITUDE: _in_arc(lat),
        Tag.GPS_LONGITUDE_REF: "W" if lon < 0.0 else "E",
        Tag.GPS_LONGITUDE: _in_arc(lon),
        Tag.GPS_ALTITUDE_REF: BELOW_ELLIPSOID if height < 0.0 else ABOVE_ELLIPSOID,
        Tag.GPS_ALTITUDE: ((round(abs(height) * METRES_PARTS), METRES_PARTS),),
    }


def _in_arc(angle_deg: float) -> tuple[Ratio, Ratio, Ratio]:
    """Degrees, minutes and seconds of an angle's size."""
    minutes, seconds = divmod(abs(angle_deg) * 3600.0, 60.0)
    degrees, minutes = divmod(int(minutes), 60)
    return (degrees, 1), (minutes, 1), (round(seconds * SECONDS_PARTS), SECONDS_PARTS)
