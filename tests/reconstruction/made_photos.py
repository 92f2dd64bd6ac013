"""Made photos as files, with where and how they were taken written as DJI's cameras do."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import cv2
import numpy as np

from planning.geodesy.enu import geodetic_from_enu
from planning.mesh import TriangleMesh, box_mesh, join, write_mesh
from planning.site import Origin
from reconstruction.made_facades.cases import simple_case
from reconstruction.made_facades.record import Disturbances, Layout, MadeFacade
from reconstruction.made_facades.render import make_facade
from reconstruction.made_facades.wall import Wall
from reconstruction.rectify.surface import FacadeSurface
from tests.planning.photo_files.photo_writer import exif_part, gps_tags, jpeg, packet, save
from tests.reconstruction.rectify.scenes import surface_mesh

ORIGIN = Origin(22.3372, 114.2636, 62.0)
START = datetime(2024, 5, 1, 10, 0, 0)
LAYOUT = Layout(n_rows=5, n_columns=9, panel_width_m=1.5, panel_height_m=2.4, widths="alternating")
DISTURBED = Disturbances(reflection=0.4, tilt_deg=0.3, clutter=True, blur_px=0.5, noise_grey=2.0)


def made_photos(curvature: float = 0.0, obliques: Sequence[float] = (0.0, 12.0)) -> list[MadeFacade]:
    """Photos of one reflecting wall from several directions."""
    wall = Wall((3.0, -4.0, 0.5), 200.0, curvature)
    return [make_facade(simple_case(LAYOUT, DISTURBED, wall=wall, seed=7, oblique_deg=angle)) for angle in obliques]


def coarse_model(wall: Wall) -> TriangleMesh:
    """The wall with dents of 5 cm, and the ground."""
    heading = np.radians(wall.outward_heading_deg)
    right = np.array([-np.cos(heading), np.sin(heading), 0.0])
    face = FacadeSurface(np.array(wall.base_enu_m), right, np.array([0.0, 0.0, 1.0]), wall.curvature_per_m)
    ground = box_mesh(np.array([-100.0, -100.0, -1.0]), np.array([100.0, 100.0, 0.0]))
    return join([surface_mesh(face, (-9.0, 0.0), (9.0, 14.0), 0.5, 0.05), ground])


def write_flight(folder: Path, photos: Sequence[MadeFacade]) -> None:
    """All photos as JPEG files with RTK positions, gimbal angles and a calibrated lens."""
    for number, made in enumerate(photos):
        lens, pose = made.photo.intrinsics, made.photo.pose
        lat, lon, height = (float(part[0]) for part in geodetic_from_enu(ORIGIN, pose.position_enu_m[None]))
        taken = START + timedelta(seconds=5.0 * number)
        properties = {
            "ImageSource": "WideCamera",
            "RtkFlag": "50",
            "RtkStdLon": "0.02",
            "RtkStdLat": "0.02",
            "RtkStdHgt": "0.03",
            "AltitudeType": "RtkAlt",
            "AbsoluteAltitude": f"{height:+.4f}",
            "RelativeAltitude": f"{pose.position_enu_m[2]:+.3f}",
            "GimbalYawDegree": f"{pose.heading_deg:+.4f}",
            "GimbalPitchDegree": f"{pose.pitch_deg:+.4f}",
            "GimbalRollDegree": "+0.00",
            "CalibratedFocalLength": f"{lens.fx_px:.4f}",
            "CalibratedOpticalCenterX": f"{lens.cx_px:.4f}",
            "CalibratedOpticalCenterY": f"{lens.cy_px:.4f}",
        }
        exif = exif_part(
            {0x010F: "DJI", 0x0110: "M3E"},
            {0x9003: f"{taken:%Y:%m:%d %H:%M:%S}", 0x829A: 0.001},
            gps_tags(lat, lon, height),
        )
        picture = cv2.imencode(".jpg", made.image, [cv2.IMWRITE_JPEG_QUALITY, 95])[1].tobytes()
        name = f"DJI_{taken:%Y%m%d%H%M%S}_{number + 1:04d}_V.JPG"
        save(folder / name, jpeg(exif, packet(properties), base=picture))


def write_model(path: Path, wall: Wall) -> None:
    """The coarse model as a file."""
    write_mesh(path, coarse_model(wall))
