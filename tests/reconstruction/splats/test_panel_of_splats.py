import itertools

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from reconstruction.splats.panel_of_splats import ON_PANE_M, assign_panels, panels_by_place
from reconstruction.splats.rasterising.rasteriser import rasterise
from tests.reconstruction.splats.learned_scenes import views_around, wall

# Twelve panels side by side on the wall, the sixth one missing: there is a door.
EDGES = np.linspace(-1.2, 1.2, 13)
CORNERS = np.array([[(a, 0, -0.9), (b, 0, -0.9), (b, 0, 0.9), (a, 0, 0.9)] for a, b in itertools.pairwise(EDGES)])
DOOR = 5


@pytest.fixture
def scene():
    splats = wall(24, 6, torch.full((144, 3), 0.5))
    truth = np.clip((splats.means[:, 0].detach().numpy() + 1.2) / 0.2, 0, 11).astype(int)
    truth[truth == DOOR] = -1
    layers = []
    for view in views_around(3):
        position, rays = view.position_m.numpy(), view.directions().numpy()
        met = position + rays * (-position[1] / rays[..., 1])[..., None]
        numbers = np.floor((met[..., 0] + 1.2) / 0.2).astype(int)
        inside = (np.abs(met[..., 0]) < 1.2) & (np.abs(met[..., 2]) < 0.9) & (numbers != DOOR)
        layers.append((view, np.where(inside, numbers, -1)))
    return splats, layers, truth


def test_each_splat_gets_the_panel_that_it_shows_in_most(scene):
    splats, layers, truth = scene
    found = assign_panels(splats, layers, CORNERS).numpy()
    assert (found == truth).mean() > 0.97


def test_numbers_of_panels_are_never_mixed(scene):
    splats, layers, truth = scene
    renumbered = np.array([90, 3, 71, 5, 44, 0, 60, 2, 33, 7, 12, 8])
    corners = np.zeros((91, 4, 3))
    corners[:] = CORNERS[0]
    corners[renumbered] = CORNERS
    layers = [(view, np.where(panels >= 0, renumbered[panels], -1)) for view, panels in layers]
    found = assign_panels(splats, layers, corners).numpy()
    expected = np.where(truth >= 0, renumbered[truth], -1)
    assert ((found == expected) | (found == -1)).all()
    assert (found == expected).mean() > 0.97


def test_splats_off_the_pane_are_not_glass_and_unseen_ones_keep_what_they_have(scene):
    splats, layers, _ = scene
    with torch.no_grad():
        splats.means[40, 1] = -1.0
        splats.means[41] = torch.tensor([0.1, 0.0, 50.0])
        splats.means[42] = torch.tensor([0.1, -60.0, 0.0])
    splats.panels[41:43] = 6
    found = assign_panels(splats, layers, CORNERS).numpy()
    assert found[40] == -1
    assert found[41] == 6
    assert found[42] == -1


def test_panels_of_a_picture_agree_with_its_layer(scene):
    splats, layers, _ = scene
    splats.panels = assign_panels(splats, layers, CORNERS)
    view, panels = layers[1]
    with torch.no_grad():
        raster = rasterise(
            splats.means, splats.quats, splats.scales, splats.opacities, splats.f0, view, labels=splats.panels
        )
    assert (raster.labels.numpy() == panels)[panels >= 0].mean() > 0.9


def test_layers_of_another_size_or_site_are_wrong_calls(scene):
    splats, layers, _ = scene
    view, panels = layers[0]
    with pytest.raises(ValueError, match="expected shape"):
        assign_panels(splats, [(view, panels[1:])], CORNERS)
    with pytest.raises(ValueError, match="expected numbers below 3"):
        assign_panels(splats, [(view, panels)], CORNERS[:3])


@given(seed=st.integers(0, 2**32 - 1))
def test_by_their_places_splats_are_on_the_panel_that_they_were_put_on(seed):
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=rng.integers(2**31)).as_matrix()
    corners = (CORNERS[:, :: rng.choice([-1, 1])] @ turn.T) + rng.uniform(-50, 50, 3)
    truth = rng.integers(0, len(corners), 60)
    u, v = rng.uniform(0.02, 0.98, (2, 60, 1))
    first, second, _, fourth = corners[truth].transpose(1, 0, 2)
    normals = np.cross(second - first, fourth - first)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    off_m = rng.uniform(-2 * ON_PANE_M, 2 * ON_PANE_M, (60, 1))
    means = first + u * (second - first) + v * (fourth - first) + off_m * normals
    found = panels_by_place(means.astype(np.float32), corners)
    clear = np.abs(np.abs(off_m[:, 0]) - ON_PANE_M) > 1e-3
    expected = np.where(np.abs(off_m[:, 0]) < ON_PANE_M, truth, -1)
    assert (found == expected)[clear].all()


def test_by_their_places_splats_beside_all_panels_are_on_none_and_between_two_planes_on_the_nearer():
    pane = CORNERS[:1]
    behind = pane + np.array([0.0, 0.2, 0.0])
    means = np.array([(-1.1, 0.05, 0), (-1.1, 0.18, 0), (-0.9, 0.0, 0), (-1.1, 0.0, 1.0)], np.float32)
    assert panels_by_place(means, np.concatenate([pane, behind])).tolist() == [0, 1, -1, -1]
    assert panels_by_place(means[:0], pane).shape == (0,)
    assert panels_by_place(means, pane[:0]).tolist() == [-1] * 4
