"""Bundled sites are what they say: sizes, facings, buildings behind the glass, homes one can fly from."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.geo.mesh import closed_parts
from planning.site.bundled import SCENES, arc_grid, panel_grid, write_scene
from planning.site.file import read_site
from planning.site.free_space import free_space
from planning.site.records import panel_corners

N_PANELS = {
    "office": 280,
    "library": 300,
    "court": 7 * 18 + 7 * 24,
    "canyon": 200,
    "roof": 32,
    "tower": 3640,
    "single-panel": 1,
}


def normals_of(corners: np.ndarray) -> np.ndarray:
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("name", sorted(SCENES))
def test_every_scene_has_its_panels_and_a_home_to_fly_from(name: str) -> None:
    model = SCENES[name]()
    assert model.site.name == name
    assert model.site.n_panels == N_PANELS[name]
    assert len({panel.id for panel in model.site.panels}) == N_PANELS[name]
    space = free_space(model, 10.0)
    assert space.is_allowed(space.column_top_enu_m[None]).all()
    corners = panel_corners(model.site)
    assert (corners >= np.array(model.site.airspace.min_enu_m) - [0.0, 0.0, 3.0]).all()
    assert (corners <= model.site.airspace.max_enu_m).all()
    np.testing.assert_array_equal(corners, corners.round(4))


@pytest.mark.parametrize("name", sorted(set(SCENES) - {"single-panel"}))
def test_every_building_is_one_closed_solid(name: str) -> None:
    corners = SCENES[name]().building.corners_enu_m
    assert set(closed_parts(corners)) == {0}
    volume = np.einsum("tk,tk->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    assert volume > 100.0, "and its triangles face outwards"


def test_facings_are_as_described() -> None:
    facing = {name: normals_of(panel_corners(SCENES[name]().site)) for name in SCENES}
    np.testing.assert_allclose(facing["office"], np.broadcast_to([0.0, -1.0, 0.0], (280, 3)), atol=1e-9)
    np.testing.assert_allclose(facing["roof"], np.broadcast_to([0.0, 0.0, 1.0], (32, 3)), atol=1e-9)
    angles = np.degrees(np.arctan2(facing["library"][:30, 1], facing["library"][:30, 0]))
    np.testing.assert_allclose(angles, np.linspace(-148.0, -32.0, 30), atol=0.05)
    court = {tuple(normal) for normal in facing["court"].round(9)}
    assert court == {(1.0, 0.0, 0.0), (0.0, -1.0, 0.0)}
    assert len({tuple(normal) for normal in facing["tower"].round(9)}) == 4


def test_panels_run_in_rows_from_below_left_with_gaps_between_them() -> None:
    facade = panel_grid("F", ((0.0, 0.0, 0.0), (6.0, 0.0, 0.0), (0.0, 0.0, 4.0)), 2, 3, gap_m=0.2)
    corners = np.array([panel.corners_enu_m for panel in facade.panels])
    assert [panel.id for panel in facade.panels] == [f"F-{i:04d}" for i in range(6)]
    np.testing.assert_allclose(corners[0], [[0.1, 0, 0.1], [1.9, 0, 0.1], [1.9, 0, 1.9], [0.1, 0, 1.9]])
    np.testing.assert_allclose(corners[4] - corners[0], np.broadcast_to([2.0, 0.0, 2.0], (4, 3)))
    areas = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
    np.testing.assert_allclose(areas, 1.8**2)


def test_panels_on_an_arc_are_chords_of_the_circle() -> None:
    facade = arc_grid("F", (1.0, 2.0), 10.0, (0.0, math.pi / 2), (0.0, 3.0), 1, 4)
    corners = np.array([panel.corners_enu_m for panel in facade.panels])
    np.testing.assert_allclose(np.linalg.norm(corners[..., :2] - [1.0, 2.0], axis=-1), 10.0, atol=1e-4)
    widths = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    np.testing.assert_allclose(widths, 2 * 10.0 * math.sin(math.pi / 16), atol=2e-4)
    outwards = corners.mean(axis=1)[:, :2] - [1.0, 2.0]
    assert (np.einsum("nk,nk->n", normals_of(corners)[:, :2], outwards) > 0).all()


def test_written_scenes_plan_as_the_ones_in_memory(tmp_path: Path) -> None:
    path = write_scene("canyon", tmp_path)
    model = read_site(path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["canyon.ply", "canyon.site.json"]
    assert model.site == SCENES["canyon"]().site
    with pytest.raises(InputError, match="no bundled site 'castle'; known are: canyon, court"):
        write_scene("castle", tmp_path)
