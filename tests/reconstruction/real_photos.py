"""Real photos as if a drone had taken them: the pictures as they are, with poses of a known error written in.

Of the reference model of the photos of Lund, the unit counts as a metre, and the y axis points down.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.mesh import TriangleMesh, extrude
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import Similarity, posed_photos
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, packet, save
from tests.reconstruction.colmap.models import turned

LEAN_RAD = np.radians(9.5)
"""By how much the reference model's y axis is off the vertical, so that the door stands upright."""

UPRIGHT = Similarity(
    1.0,
    np.array(
        [
            [1.0, 0.0, 0.0],
            [0.0, np.sin(LEAN_RAD), np.cos(LEAN_RAD)],
            [0.0, -np.cos(LEAN_RAD), np.sin(LEAN_RAD)],
        ]
    ),
    np.array([0.0, 0.0, 3.0]),
)
"""From the reference model's frame."""

ORIGIN = Origin(55.7039, 13.1935, 90.0)
START = datetime(2011, 5, 2, 17, 24, 9)
NEAR_M, DEPTH_M, REACH = 0.3, 10.0, (1.0, 99.0)
"""Of the coarse building: points this near make its front; its depth; the part of the points it spans, per cent."""

SIGMA_M, HEADING_DEG, TILT_DEG = 0.02, 2.0, 0.5


def reference_photos(folder: Path) -> list[PosedPhoto]:
    """With the poses of the reference model."""
    return list(posed_photos(read_model(folder / "colmap_ground_truth"), UPRIGHT, folder))


def write_flight(truth: Sequence[PosedPhoto], folder: Path, lens: Intrinsics, seed: int = 0) -> None:
    """Write photos with positions good to `SIGMA_M`, headings to 2 and tilts to half a degree, and another lens."""
    rng = np.random.default_rng(seed)
    for number, photo in enumerate(truth):
        off = turned(photo, rng.normal(0.0, SIGMA_M, 3), np.zeros(3))
        heading, *tilts = off.pose.angles_deg
        heading += rng.normal(0.0, HEADING_DEG)
        pitch, roll = np.array(tilts) + rng.normal(0.0, TILT_DEG, 2)
        lat, lon, height = (float(part[0]) for part in geodetic_from_enu(ORIGIN, off.pose.position_enu_m[None]))
        taken = START + timedelta(seconds=5.0 * number)
        properties = {
            "RtkFlag": "50",
            "RtkStdLon": f"{SIGMA_M}",
            "RtkStdLat": f"{SIGMA_M}",
            "RtkStdHgt": f"{SIGMA_M}",
            "AltitudeType": "RtkAlt",
            "AbsoluteAltitude": f"{height:+.4f}",
            "RelativeAltitude": f"{off.pose.position_enu_m[2]:+.3f}",
            "GimbalYawDegree": f"{heading:+.4f}",
            "GimbalPitchDegree": f"{pitch:+.4f}",
            "GimbalRollDegree": f"{roll:+.4f}",
            "CalibratedFocalLength": f"{lens.fx_px:.4f}",
            "CalibratedOpticalCenterX": f"{lens.cx_px:.4f}",
            "CalibratedOpticalCenterY": f"{lens.cy_px:.4f}",
        }
        exif = exif_part(
            {0x010F: "DJI", 0x0110: "M3E"},
            {0x9003: f"{taken:%Y:%m:%d %H:%M:%S}", 0x829A: 0.008},
            gps_tags(lat, lon, height),
        )
        save(folder / photo.name, jpeg(exif, packet(properties), base=photo.path.read_bytes()))


def coarse_building(points_enu_m: np.ndarray, seed: int = 0) -> TriangleMesh:
    """A box whose front is the upright plane that most points of a model lie on, of 500 tried."""
    rng = np.random.default_rng(seed)
    flat = points_enu_m[:, :2]
    best, most = (np.array([1.0, 0.0]), 0.0), 0
    for _ in range(500):
        one, other = flat[rng.choice(len(flat), 2, replace=False)]
        along = (other - one) / max(1e-9, float(np.linalg.norm(other - one)))
        normal = np.array([along[1], -along[0]])
        n_near = int((np.abs((flat - one) @ normal) < NEAR_M).sum())
        if n_near > most:
            best, most = (normal, float(one @ normal)), n_near
    normal, offset = best
    normal, offset = (-normal, -offset) if offset > 0.0 else (normal, offset)  # the cameras are around (0, 0)
    near = points_enu_m[np.abs(points_enu_m[:, :2] @ normal - offset) < NEAR_M]
    along = np.array([-normal[1], normal[0]])
    left, right = np.percentile(near[:, :2] @ along, REACH)
    low, high = np.percentile(near[:, 2], REACH)
    front = [along * s + normal * offset for s in (left, right)]
    back = [corner - DEPTH_M * normal for corner in reversed(front)]
    return extrude(np.array([*front, *back]), float(low), float(high))
