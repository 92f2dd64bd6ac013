"""From made photos and a dented coarse model to panels in 3-D."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from planning.mesh import TriangleMesh, box_mesh, join
from reconstruction.cameras import PosedPhoto
from reconstruction.made_facades.cases import simple_case
from reconstruction.made_facades.record import Disturbances, Layout, MadeFacade
from reconstruction.made_facades.render import make_facade
from reconstruction.made_facades.wall import Wall
from reconstruction.panels.find import FindParameters, find_panels
from reconstruction.rectify.surface import FacadeSurface
from tests.reconstruction.rectify.scenes import surface_mesh

LAYOUT = Layout(n_rows=5, n_columns=9, panel_width_m=1.5, panel_height_m=2.4, widths="alternating")
DISTURBED = Disturbances(reflection=0.4, tilt_deg=0.3, clutter=True, blur_px=0.5, noise_grey=2.0)


def made(curvature: float, obliques: tuple[float, ...] = (0.0, 12.0)) -> list[MadeFacade]:
    wall = Wall((3.0, -4.0, 0.5), 200.0, curvature)
    return [make_facade(simple_case(LAYOUT, DISTURBED, wall=wall, seed=7, oblique_deg=angle)) for angle in obliques]


def coarse_model(wall: Wall) -> TriangleMesh:
    """The wall with dents of 5 cm, and the ground."""
    heading = np.radians(wall.outward_heading_deg)
    right = np.array([-np.cos(heading), np.sin(heading), 0.0])
    face = FacadeSurface(np.array(wall.base_enu_m), right, np.array([0.0, 0.0, 1.0]), wall.curvature_per_m)
    ground = box_mesh(np.array([-300.0, -300.0, -1.0]), np.array([300.0, 300.0, 0.0]))
    return join([surface_mesh(face, (-9.0, 0.0), (9.0, 14.0), 0.5, 0.05), ground])


def load_from(photos: list[MadeFacade]):  # type: ignore[no-untyped-def]
    images = {id(photo.photo): photo.image for photo in photos}

    def load(photo: PosedPhoto) -> NDArray[np.uint8]:
        return images[id(photo)]

    return load


@pytest.mark.parametrize("curvature", [0.0, 0.05])
def test_every_panel_is_found_in_3d_within_centimetres(curvature: float) -> None:
    photos = made(curvature)
    wall = photos[0].case.wall
    found = find_panels([photo.photo for photo in photos], coarse_model(wall), load_from(photos))
    assert len(found.facades) == 1
    facade = found.facades[0]
    assert facade.id == "A"
    assert found.decisions["A"].on == (curvature != 0.0)
    truth = {(panel.row, panel.column): panel.corners_enu_m for panel in photos[0].panels}
    assert {(panel.row, panel.column) for panel in facade.panels} == set(truth)
    errors = np.concatenate([panel.corners_enu_m - truth[panel.row, panel.column] for panel in facade.panels])
    assert np.linalg.norm(errors, axis=1).max() < 0.12
    assert np.linalg.norm(errors, axis=1).mean() < 0.05


def test_photos_of_nothing_are_refused_in_words() -> None:
    photos = made(0.0, (0.0,))
    photos[0].image[:] = 128
    with pytest.raises(InfeasibleError, match="no grid of panels"):
        find_panels([photos[0].photo], coarse_model(photos[0].case.wall), load_from(photos), FindParameters())
    ground = box_mesh(np.array([-300.0, -300.0, -1.0]), np.array([300.0, 300.0, 0.0]))
    with pytest.raises(InfeasibleError, match="upright facade"):
        find_panels([photos[0].photo], ground, load_from(photos))
