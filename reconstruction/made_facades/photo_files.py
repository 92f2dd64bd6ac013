"""Made photos as files, with where and how they were taken written into them as DJI's cameras do."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.geodesy.enu import geodetic_from_enu
from planning.site import Origin
from reconstruction.cameras import Intrinsics, PosedPhoto

JPEG_QUALITY = 95

FIRST_AT, BETWEEN = datetime(2024, 5, 1, 10, 0, 0), timedelta(seconds=5)

XMP_HEAD = b"http://ns.adobe.com/xap/1.0/\0"
XMP_START, XMP_END = (
    b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
    b'<rdf:Description xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/" xmlns:tiff="http://ns.adobe.com/tiff/1.0/" '
    b'xmlns:xmp="http://ns.adobe.com/xap/1.0/" ',
    b"/></rdf:RDF></x:xmpmeta>",
)


def write_photos(
    folder: Path, photos: Sequence[tuple[PosedPhoto, NDArray[np.uint8]]], origin: Origin
) -> tuple[Path, ...]:
    """Write JPEG files with RTK positions, gimbal angles and a calibrated lens; returns their paths.

    Parameters
    ----------
    photos
        Cameras in the frame of `origin`, and their pictures, shape (h, w, 3), blue, green, red.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    paths = []
    for number, (photo, picture) in enumerate(photos):
        taken_at = FIRST_AT + number * BETWEEN
        path = folder / f"DJI_{taken_at:%Y%m%d%H%M%S}_{number + 1:04d}_V.JPG"
        encoded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()
        packet = XMP_HEAD + XMP_START + _properties(photo, origin, taken_at).encode() + XMP_END
        segment = b"\xff\xe1" + (len(packet) + 2).to_bytes(2, "big") + packet
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # The segment comes right after the two bytes that every JPEG file begins with.
            path.write_bytes(encoded[:2] + segment + encoded[2:])
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
        paths.append(path)
    return tuple(paths)


def _properties(photo: PosedPhoto, origin: Origin, taken_at: datetime) -> str:
    lens, pose = photo.intrinsics, photo.pose
    heading_deg, pitch_deg, roll_deg = pose.angles_deg
    lat, lon, height = (float(part[0]) for part in geodetic_from_enu(origin, pose.position_enu_m[None]))
    properties = {
        "tiff:Make": "DJI",
        "tiff:Model": "M3E",
        "xmp:CreateDate": f"{taken_at:%Y-%m-%dT%H:%M:%S}",
        "drone-dji:ImageSource": "WideCamera",
        "drone-dji:GpsLatitude": f"{lat:+.9f}",
        "drone-dji:GpsLongitude": f"{lon:+.9f}",
        "drone-dji:RtkFlag": "50",
        "drone-dji:RtkStdLon": "0.02",
        "drone-dji:RtkStdLat": "0.02",
        "drone-dji:RtkStdHgt": "0.03",
        "drone-dji:AltitudeType": "RtkAlt",
        "drone-dji:AbsoluteAltitude": f"{height:+.4f}",
        "drone-dji:RelativeAltitude": f"{pose.position_enu_m[2]:+.3f}",
        "drone-dji:GimbalYawDegree": f"{heading_deg:+.4f}",
        "drone-dji:GimbalPitchDegree": f"{pitch_deg:+.4f}",
        "drone-dji:GimbalRollDegree": f"{roll_deg:+.4f}",
        "drone-dji:DewarpFlag": "0",
        "drone-dji:DewarpData": _dewarp(lens),
        "drone-dji:CalibratedFocalLength": f"{lens.fx_px:.4f}",
        "drone-dji:CalibratedOpticalCenterX": f"{lens.cx_px:.4f}",
        "drone-dji:CalibratedOpticalCenterY": f"{lens.cy_px:.4f}",
    }
    return " ".join(f'{name}="{value}"' for name, value in properties.items())


def _dewarp(lens: Intrinsics) -> str:
    """Focal lengths, principal point from the middle of the picture, distortion."""
    centre = lens.cx_px - 0.5 * lens.width_px, lens.cy_px - 0.5 * lens.height_px
    return "2024-05-01;" + ",".join(f"{value:.9g}" for value in (lens.fx_px, lens.fy_px, *centre, *lens.distortion))
