"""Made photos as files, with where and how they were taken written as DJI's cameras do."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from planning.geo.frames import Origin
from planning.geo.mesh import TriangleMesh, box_mesh, join, write_mesh
from reconstruction.base.cameras import Intrinsics
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.scenes.facades.cases import photo_of, wide_camera
from reconstruction.scenes.facades.record import (
    Case,
    Disturbances,
    Layout,
    SyntheticFacade,
    Wall,
)
from reconstruction.scenes.facades.render import render_facade, write_photos
from tests.reconstruction.panels.rectify.scenes import surface_mesh

ORIGIN = Origin(22.3372, 114.2636, 62.0)
LAYOUT = Layout(n_rows=5, n_columns=9, panel_width_m=1.5, panel_height_m=2.4, widths="alternating")
DISTURBED = Disturbances(reflection=0.4, tilt_deg=0.3, clutter=True, blur_px=0.5, noise_grey=2.0)
CAMERA = wide_camera(960, 720)


def made_photos(curvature: float = 0.0, obliques: Sequence[float] = (0.0, 12.0)) -> list[SyntheticFacade]:
    """Photos of one reflecting wall from several directions."""
    wall = Wall((3.0, -4.0, 0.5), 200.0, curvature)
    return [
        render_facade(simple_case(LAYOUT, DISTURBED, wall=wall, intrinsics=CAMERA, seed=7, oblique_deg=angle))
        for angle in obliques
    ]


def coarse_model(wall: Wall) -> TriangleMesh:
    """The wall with dents of 5 cm, and the ground."""
    heading = np.radians(wall.outward_heading_deg)
    right = np.array([-np.cos(heading), np.sin(heading), 0.0])
    face = FacadeSurface(np.array(wall.base_enu_m), right, np.array([0.0, 0.0, 1.0]), wall.curvature_per_m)
    ground = box_mesh(np.array([-100.0, -100.0, -1.0]), np.array([100.0, 100.0, 0.0]))
    return join([surface_mesh(face, (-9.0, 0.0), (9.0, 14.0), 0.5, 0.05), ground])


def write_flight(folder: Path, photos: Sequence[SyntheticFacade]) -> None:
    """All photos as JPEG files with RTK positions, gimbal angles and a calibrated lens."""
    write_photos(folder, [(made.photo, made.image) for made in photos], ORIGIN)


def write_model(path: Path, wall: Wall) -> None:
    """The coarse model as a file."""
    write_mesh(path, coarse_model(wall))


STRONG = Disturbances(
    reflection=0.45,
    tilt_deg=0.35,
    pillow_deg=0.25,
    blinds=0.3,
    glare=0.8,
    shadow=0.4,
    clutter=True,
    blur_px=0.6,
    noise_grey=3.0,
)
"""Everything at once, as on a sunny day in a street."""


def simple_case(
    layout: Layout | None = None,
    disturbances: Disturbances | None = None,
    *,
    wall: Wall | None = None,
    intrinsics: Intrinsics | None = None,
    seed: int = 0,
    oblique_deg: float = 0.0,
    from_below_deg: float = 0.0,
    roll_deg: float = 0.0,
    fill: float = 0.85,
) -> Case:
    """A facade seen straight from the front and without any disturbance, but for what is asked for."""
    layout, wall = layout or Layout(), wall or Wall()
    photo = photo_of(
        wall,
        layout,
        intrinsics or wide_camera(),
        seed=seed,
        oblique_deg=oblique_deg,
        from_below_deg=from_below_deg,
        roll_deg=roll_deg,
        fill=fill,
    )
    return Case("made", layout, wall, photo, disturbances or Disturbances(), seed=seed)
