"""Panels drawn into photos: against polygons of shapely, rays, and each other."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.geo.mesh import TriangleMesh, box_mesh, empty_mesh
from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.dataset.layers import draw_panels, facing, without_hidden
from tests.reconstruction.panels.rectify.scenes import BENT, looking_at
from tests.reconstruction.panels.rectify.test_surface import surface

Array = NDArray[np.float64]
TINY = Intrinsics(160, 120, 114.0, 114.0, 80.0, 60.0)


def grid(curvature: float = 0.0, rows: int = 4, columns: int = 6) -> Array:
    face = surface(curvature, lean_rad=0.0)
    cells = [(s, t) for t in np.arange(rows) * 2.5 - 5.0 for s in np.arange(columns) * 1.5 - 4.5]
    return np.array([face.to_enu(np.array([[s, t], [s + 1.4, t], [s + 1.4, t + 2.4], [s, t + 2.4]])) for s, t in cells])


def photo(distance: float = 15.0, aside: float = 0.0, above: float = 0.0, roll: float = 0.0) -> PosedPhoto:
    return looking_at(surface(0.0, lean_rad=0.0), distance, aside, above, TINY, roll)


@given(
    distance=st.floats(2.0, 30.0),
    aside=st.floats(-15.0, 15.0),
    above=st.floats(-10.0, 10.0),
    roll=st.floats(-30.0, 30.0),
)
@settings(max_examples=25)
def test_every_pixel_has_the_panel_that_its_ray_hits(distance: float, aside: float, above: float, roll: float) -> None:
    seen = photo(distance, aside, above, roll)
    corners = grid(0.02)
    x, y = np.meshgrid(np.arange(160) + 0.5, np.arange(120) + 0.5)
    halves = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    mesh = TriangleMesh(halves.reshape(-1, 3), np.arange(6 * len(corners)).reshape(-1, 3))
    hits = RayCaster(mesh).cast(*seen.rays(np.column_stack([x.ravel(), y.ravel()])))
    by_rays = np.where(hits.is_hit, hits.triangles % len(corners) + 1, 0).reshape(120, 160)
    drawn = draw_panels(seen, corners)
    assert (drawn.index == by_rays).mean() > 0.998
    both = (drawn.index == by_rays) & (drawn.index > 0)
    _, directions = seen.rays(np.column_stack([x[both], y[both]]))
    along = hits.distance_m.reshape(120, 160)[both] * (directions @ seen.pose.forward_enu)
    assert np.allclose(drawn.depth_m[both], along, rtol=1e-3)


def test_areas_equal_those_of_the_polygons() -> None:
    seen = photo(15.0, 4.0)
    corners = grid()
    index = draw_panels(seen, corners).index
    for number, panel in enumerate(corners):
        polygon = shapely.Polygon(seen.pixels(panel)).intersection(shapely.box(0, 0, 160, 120))
        assert abs((index == number + 1).sum() - polygon.area) <= 0.6 * polygon.length + 1.0


def test_the_nearer_panel_wins_whatever_the_order() -> None:
    far, near = grid()[:1], grid()[:1] + 3.0 * surface(0.0, lean_rad=0.0).normal_enu
    seen = photo()
    for corners, wanted in ((np.concatenate([far, near]), 2), (np.concatenate([near, far]), 1)):
        index = draw_panels(seen, corners).index
        u, v = seen.pixels(near[0].mean(axis=0)[None])[0]
        assert index[int(v), int(u)] == wanted


def test_panels_behind_the_camera_and_across_its_plane_are_cut_off() -> None:
    seen = photo(1.0, 0.0)
    index = draw_panels(seen, grid()).index
    assert index.any()
    face = surface(0.0, lean_rad=0.0)
    floor = np.array([[-5.0, -50.0], [5.0, -50.0], [5.0, 50.0], [-5.0, 50.0]])
    across = face.anchor_enu_m + floor[:, :1] * face.right_enu + floor[:, 1:] * face.normal_enu - 2.0 * face.up_enu
    drawn = draw_panels(photo(5.0), across[None])
    assert (drawn.index[100:] == 1).all()
    assert (drawn.index[:50] == 0).all()
    assert np.isfinite(drawn.depth_m[drawn.index > 0]).all()


def test_a_building_in_front_hides_and_the_panels_own_mesh_does_not() -> None:
    face = surface(0.0, lean_rad=0.0)
    seen = photo(20.0)
    drawn = draw_panels(seen, grid())
    assert np.array_equal(without_hidden(seen, drawn, RayCaster(empty_mesh())), drawn.index)
    middle = face.anchor_enu_m + 10.0 * face.normal_enu
    kiosk = box_mesh(middle - 1.5, middle + 1.5)
    hidden = without_hidden(seen, drawn, RayCaster(kiosk))
    assert 0.05 < 1.0 - (hidden > 0).sum() / (drawn.index > 0).sum() < 0.9
    own = TriangleMesh(grid().reshape(-1, 3) + 0.1 * face.normal_enu, np.arange(96).reshape(-1, 4)[:, :3])
    assert np.array_equal(without_hidden(seen, drawn, RayCaster(own)), drawn.index)


def test_sides_of_panels() -> None:
    assert facing(photo(15.0), grid()).all()
    assert not facing(photo(-15.0), grid()).any()


def test_wrong_input_is_refused() -> None:
    with pytest.raises(ValueError, match="straight"):
        draw_panels(looking_at(surface(0.0), intrinsics=BENT), grid())
    with pytest.raises(ValueError, match="shape"):
        draw_panels(photo(), np.zeros((3, 3, 3)))
