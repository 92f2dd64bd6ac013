import itertools

import numpy as np
import pytest
import torch

from reconstruction.splatting.panel_of_splats import assign_panels
from reconstruction.splatting.rasteriser import rasterise
from tests.reconstruction.splatting.learned_scenes import views_around, wall

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
