"""The paper's way to 3-D: rays onto the model, means along rows and columns."""

from __future__ import annotations

import numpy as np
import pytest

from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from tests.reconstruction.panels.rectify.scenes import looking_at, surface_mesh
from tests.reconstruction.panels.rectify.test_surface import surface
from tests.reconstruction.panels.solving.by_ray_casting import averaged, cast_corners

S, T = np.linspace(-6.0, 6.0, 7), np.linspace(-4.0, 4.0, 5)


def dented(curvature: float, noise_m: float) -> TriangleMesh:
    return surface_mesh(surface(curvature, lean_rad=0.0), (-12.0, -9.0), (12.0, 9.0), 0.5, noise_m)


@pytest.mark.parametrize("curvature", [0.0, 0.03])
def test_corners_come_back_and_averages_take_dents_out(curvature: float) -> None:
    face = surface(curvature, lean_rad=0.0)
    photo = looking_at(face, 20.0, 4.0, 2.0)
    truth = face.to_enu(np.stack(np.meshgrid(S, T), axis=-1).reshape(-1, 2)).reshape(5, 7, 3)
    corners = photo.pixels(truth.reshape(-1, 3)).reshape(5, 7, 2)
    exact = cast_corners(photo, corners, RayCaster(dented(curvature, 0.0)))
    assert np.abs(exact - truth).max() < 0.01
    rough = cast_corners(photo, corners, RayCaster(dented(curvature, 0.1)))
    error, averaged_error = np.abs(rough - truth).mean(), np.abs(averaged(rough) - truth).mean()
    assert averaged_error < 0.7 * error


def test_rows_share_their_height_and_columns_their_place() -> None:
    corners = np.random.default_rng(0).normal(size=(4, 6, 3))
    corners[1, 2] = np.nan
    even = averaged(corners)
    assert np.ptp(even[..., 2], axis=1).max() == 0.0
    assert np.ptp(even[..., :2], axis=0).max() == 0.0
    assert even[1, 0, 2] == pytest.approx(np.nanmean(corners[1, :, 2]))
    assert np.isfinite(even).all()


def test_what_is_not_known_stays_unknown() -> None:
    photo = looking_at(surface(0.0))
    corners = np.full((2, 2, 2), np.nan)
    corners[0, 0] = (1.0, 1.0)
    found = cast_corners(photo, corners, RayCaster(surface_mesh(surface(0.0), (-1.0, -1.0), (1.0, 1.0))))
    assert np.isnan(found).all()
    assert np.isnan(averaged(found)).all()
    with pytest.raises(ValueError, match="rows, columns"):
        cast_corners(photo, np.zeros((4, 2)), RayCaster(dented(0.0, 0.0)))
