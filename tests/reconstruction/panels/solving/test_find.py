"""From synthetic photos and a dented coarse model to panels in 3-D."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.geo.mesh import box_mesh
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.solving.find import FindParameters, find_panels
from reconstruction.scenes.facades.record import SyntheticFacade
from tests.reconstruction.synthetic_photos import coarse_model, made_photos
from tests.slow import slow

TOLD = np.diag([0.02**2] * 3 + [np.radians(0.1) ** 2] * 3)
"""Covariance that the poses state; they are exact."""


def posed(photos: list[SyntheticFacade]) -> list[PosedPhoto]:
    return [replace(made.photo, pose=replace(made.photo.pose, covariance=TOLD)) for made in photos]


def load_from(photos: list[SyntheticFacade]):  # type: ignore[no-untyped-def]
    places = [made.photo.pose.position_enu_m for made in photos]

    def load(photo: PosedPhoto) -> NDArray[np.uint8]:
        return next(
            made.image for made, place in zip(photos, places, strict=True) if place is photo.pose.position_enu_m
        )

    return load


@pytest.mark.slow
@pytest.mark.parametrize("curvature", [slow(0.0), 0.05])
def test_every_panel_is_found_in_3d_within_centimetres(curvature: float) -> None:
    photos = made_photos(curvature)
    wall = photos[0].case.wall
    found = find_panels(posed(photos), coarse_model(wall), load_from(photos))
    assert len(found.facades) == 1
    facade = found.facades[0]
    assert facade.id == "A"
    assert found.decisions["A"].on == (curvature != 0.0)
    truth = {(panel.row, panel.column): panel.corners_enu_m for panel in photos[0].panels}
    assert {(panel.row, panel.column) for panel in facade.panels} == set(truth)
    errors = np.concatenate([panel.corners_enu_m - truth[panel.row, panel.column] for panel in facade.panels])
    assert np.linalg.norm(errors, axis=1).max() < 0.12
    assert np.linalg.norm(errors, axis=1).mean() < 0.05


@pytest.mark.slow
def test_photos_of_nothing_are_refused_in_words() -> None:
    photos = made_photos(0.0, (0.0,))
    photos[0].image[:] = 128
    with pytest.raises(InfeasibleError, match="no grid of panels"):
        find_panels(posed(photos), coarse_model(photos[0].case.wall), load_from(photos), FindParameters())
    ground = box_mesh(np.array([-300.0, -300.0, -1.0]), np.array([300.0, 300.0, 0.0]))
    with pytest.raises(InfeasibleError, match="upright facade"):
        find_panels(posed(photos), ground, load_from(photos))
