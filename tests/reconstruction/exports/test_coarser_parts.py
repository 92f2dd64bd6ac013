"""Merged Gaussians of parts: few enough, of the panels they were of, and like the many from afar."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.exports.component_parts import ellipsoids_of
from reconstruction.exports.tiles3d import branches_of, coarser_part, part_of_branch
from reconstruction.splats.merged_splats import FEWEST
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.splats import Splats
from tests.reconstruction.objects.synthetic_scene import pane, synthetic_scene
from tests.reconstruction.splats.test_merged_splats import drawn, from_south


def halves_of(component, at_most):
    branch = branches_of(component, at_most)
    return [part_of_branch(component, half) for half in branch.halves]


def facade_of(sizes, seed=0):
    """A facade whose Gaussians lie on its panels, which are 1.35 m x 1.8 m."""
    scene = synthetic_scene((sizes,), 0, seed=seed)
    facade, rng = scene.components[0], np.random.default_rng(seed)
    for column, element in enumerate(facade.elements):
        corners = np.array(pane(column, 0))
        means = rng.uniform(corners.min(axis=0), corners.max(axis=0), (element.n_gaussians, 3))
        rows = slice(element.start, element.stop)
        facade.gaussians.values["means"][rows] = means
        facade.gaussians.values["log_scales"][rows] = np.log(0.7 * np.sqrt(1.35 * 1.8 / max(1, element.n_gaussians)))
        facade.gaussians.values["quats"][rows] = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
        facade.gaussians.values["opacity_logits"][rows] = 2.0
        facade.gaussians.values["sh"][rows] = 0.0
        facade.gaussians.values["sh"][rows, 0] = 0.4 * np.cos(column + np.arange(3)) + 0.2 * rng.normal(
            size=(element.n_gaussians, 3)
        )
    return facade


@given(st.lists(st.integers(0, 900), min_size=2, max_size=6), st.integers(4, 1200), st.integers(0, 5))
def test_each_panel_has_its_own_and_none_is_lost(sizes, at_most, seed):
    facade = facade_of(tuple(sizes), seed)
    parts = halves_of(facade, 1)
    if not parts:
        return
    found = coarser_part(parts, at_most)
    if found is None:
        # Cubes can be too large for this to hold only where there is next to nothing to merge.
        assert sum(sizes) < FEWEST or at_most < FEWEST
        return
    made, before = found.component, sum(map(len, (part.gaussians for part in parts)))
    assert 0 < len(made.gaussians) <= min(at_most, before)
    assert found.side_m > 0.0
    assert (made.global_id, made.name, made.kind) == (facade.global_id, facade.name, facade.kind)
    names = [element.name for element in made.elements]
    assert sorted(names) == sorted(element.name for element in facade.elements if element.n_gaussians)
    assert all(element.n_gaussians for element in made.elements)
    ellipsoids = ellipsoids_of(made)
    for element in facade.elements:
        corners = np.array(element.corners_enu_m)
        within = ellipsoids.means_m[ellipsoids.panels == element.panel]
        assert (within >= corners.min(axis=0) - 1e-5).all()
        assert (within <= corners.max(axis=0) + 1e-5).all()
    for value in made.gaussians.values.values():
        assert np.isfinite(value).all()


OF_VIEWERS = RasterSettings(antialiased=True)
"""With the blur that other programs have."""


def test_from_afar_they_look_like_the_many():
    facade = facade_of((4000, 3000, 5000, 2000))
    found = coarser_part(halves_of(facade, 7000), 3000)
    assert found is not None
    # Cubes are of a pixel.
    matrix = from_south(65.0 * found.side_m).cam_from_world
    matrix[0, 3], matrix[1, 3] = -3.0, 0.9
    view = replace(from_south(1.0), cam_from_world=matrix, fx_px=65.0, fy_px=65.0)
    pictures = []
    for component in (facade, found.component):
        panels = torch.from_numpy(ellipsoids_of(component).panels)
        table = {name: torch.from_numpy(value) for name, value in component.gaussians.values.items()}
        features, alphas = drawn(Splats(table, panels), view, OF_VIEWERS)
        pictures.append(torch.cat([features[..., :3], alphas[..., None]], dim=-1))
    many, few = pictures
    assert many[..., 3].max() > 0.8
    # Against the light that a picture without them would lack.
    assert (few - many).square().mean() < 0.005 * many.square().mean()


def test_of_merged_ones_there_can_be_fewer_again():
    parts = [part_of_branch(facade_of((9000, 9000)), half) for half in branches_of(facade_of((9000, 9000)), 1).halves]
    once = [coarser_part([part], 3000) for part in parts]
    assert all(once)
    twice = coarser_part([found.component for found in once], 1000)
    assert twice is not None
    assert len(twice.component.gaussians) <= 1000
    assert twice.side_m > max(found.side_m for found in once)


@pytest.mark.parametrize("sizes", [(10, 10), (1,) * 600])
def test_what_cannot_be_merged_has_none(sizes):
    facade = facade_of(sizes)
    assert coarser_part(halves_of(facade, 10), 5) is None


def test_backgrounds_have_no_panels():
    background = synthetic_scene((), 4000).components[-1]
    found = coarser_part(halves_of(background, 2000), 500)
    assert found is not None
    assert found.component.kind == "background"
    assert found.component.elements == ()
    assert len(found.component.gaussians) <= 500
