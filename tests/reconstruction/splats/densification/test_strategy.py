import math

import pytest
import torch

from reconstruction.splats.densification.strategy import (
    CUT,
    HIDDEN_VIEWS,
    FixedNumber,
    Limits,
    SplatStatistics,
    forget,
    keep_within,
    n_dead,
    rearrange,
    within,
)
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.splats import SHAPES, Splats, normals_of
from tests.reconstruction.splats.learned_scenes import adam, picture_of, random_splats, train, truths_of, views_around


def trained(n=12, steps=3):
    splats, views = random_splats(n), views_around(2)
    optimiser = adam(splats)
    train(splats, views, truths_of(random_splats(n, seed=1), views), steps, optimiser=optimiser)
    return splats, optimiser


def moments(splats, optimiser, name):
    return optimiser.state[getattr(splats, name)]["exp_avg"]


def test_rows_of_all_parameters_move_together_with_their_moments():
    splats, optimiser = trained()
    splats.panels[:] = torch.arange(12)
    before = {name: getattr(splats, name).detach().clone() for name in SHAPES}
    means_before, steps = moments(splats, optimiser, "means").clone(), optimiser.state[splats.means]["step"].clone()
    source = torch.tensor([3, 3, 0, 11, 5])
    rearrange(splats, optimiser, source, torch.tensor([False, True, False, False, True]))
    for name in SHAPES:
        assert torch.equal(getattr(splats, name).detach(), before[name][source])
    assert splats.panels.tolist() == [3, 3, 0, 11, 5]
    found = moments(splats, optimiser, "means")
    assert torch.equal(found[[0, 2, 3]], means_before[[3, 0, 11]])
    assert (found[[1, 4]] == 0.0).all()
    assert optimiser.state[splats.means]["step"] == steps


def test_the_optimiser_goes_on_with_splats_that_became_more_while_an_older_picture_is_held():
    splats, optimiser = trained()
    view = views_around(2)[0]
    held = picture_of(splats, view)
    rearrange(splats, optimiser, torch.arange(24) % 12, torch.arange(24) >= 12)
    before = splats.means.detach().clone()
    picture_of(splats, view).features.sum().backward()
    optimiser.step()
    assert held.features.requires_grad
    assert len(splats) == 24
    assert (splats.means != before).any()
    assert sum(len(group["params"]) for group in optimiser.param_groups) == 5


def test_only_the_named_moments_are_forgotten():
    splats, optimiser = trained()
    forget(splats, optimiser, ("means",), torch.tensor([0, 2]))
    assert (moments(splats, optimiser, "means")[[0, 2]] == 0.0).all()
    assert (moments(splats, optimiser, "means")[1] != 0.0).any()
    assert (moments(splats, optimiser, "sh")[0] != 0.0).any()


def test_needles_giants_and_specks_are_brought_within_limits():
    splats = random_splats(3)
    with torch.no_grad():
        splats.log_scales[:] = torch.tensor([[1.0, 1e-3], [500.0, 400.0], [1e-9, 1e-8]]).log()
    limits = Limits(smallest_m=0.001, largest_m=10.0, stretched=16.0)
    keep_within(splats, limits)
    expected = torch.tensor([[1.0, 1.0 / 16.0], [10.0, 10.0], [0.001, 0.001]])
    assert torch.allclose(splats.scales.detach(), expected, rtol=1e-5)


def test_a_fixed_number_of_splats_stays_fixed_and_within_limits():
    splats = random_splats(10)
    views = views_around(2)
    strategy = FixedNumber(Limits(stretched=1.5))
    changes = train(splats, views, truths_of(random_splats(10, 1), views), 5, strategy)
    assert all(change.is_nothing for change in changes)
    assert (splats.scales.max(dim=1).values / splats.scales.min(dim=1).values).max() <= 1.5 * (1.0 + 1e-5)
    strategy.load_state_dict(strategy.state_dict())


def test_splats_at_the_cut_are_dead():
    splats = random_splats(3)
    with torch.no_grad():
        splats.opacity_logits[:] = torch.logit(torch.tensor([0.5, 0.99 * CUT, 0.001]))
    assert n_dead(splats) == 2


def test_displacements_of_discs_lie_in_their_planes_and_are_as_long_as_told():
    splats = random_splats(6)
    along_u, along_v = (within(splats, torch.arange(6), torch.eye(2)[axis].repeat(6, 1)) for axis in (0, 1))
    assert torch.allclose(along_u.norm(dim=1), splats.scales[:, 0], rtol=1e-5)
    assert torch.allclose(along_v.norm(dim=1), splats.scales[:, 1], rtol=1e-5)
    assert (along_u * along_v).sum(dim=1).abs().max() < 1e-6
    assert (along_u * normals_of(splats.quats)).sum(dim=1).abs().max() < 1e-6


def test_ellipsoids_are_moved_along_their_normals_too():
    discs = random_splats(6)
    values = {name: getattr(discs, name).detach() for name in SHAPES}
    values["log_scales"] = torch.cat([values["log_scales"], torch.full((6, 1), math.log(0.02))], dim=1)
    found = within(Splats(values, discs.panels), torch.arange(6), torch.tensor([[0.0, 0.0, 3.0]]).repeat(6, 1))
    assert torch.allclose(found, 0.06 * normals_of(discs.quats), atol=1e-6)


def test_pulls_are_those_of_the_whole_picture_when_a_window_is_seen():
    splats, view = random_splats(20), views_around(3)[1]
    seen = []
    for window in (view, view.cropped(4, 2, 40, 32)):
        offsets = torch.zeros(20, 2, requires_grad=True)
        raster = picture_of(splats, window, offsets=offsets)
        inner = raster.features[..., :3]
        # An error that only the part that both show has.
        x, y = (12, 10) if window is view else (8, 8)
        region = inner[y : y + 16, x : x + 24]
        (region.square().sum() / (inner.shape[0] * inner.shape[1])).backward()
        sums = SplatStatistics.nothing(20, torch.device("cpu"))
        sums.add(raster, offsets.grad, window)
        seen.append(sums.mean_pulls())
    assert seen[0].max() > 0.0
    assert torch.allclose(seen[0], seen[1], rtol=1e-3, atol=1e-6)


def test_splats_behind_others_are_hidden_after_enough_pictures_and_those_outside_are_not():
    sums = SplatStatistics.nothing(3, torch.device("cpu"))
    picture = torch.zeros(4, 4)
    raster = Raster(
        picture[..., None], picture, picture, None, torch.tensor([5.0, 0.0, 0.0]), torch.tensor([3.0, 3.0, 0.0])
    )
    for _ in range(HIDDEN_VIEWS):
        assert not sums.is_hidden().any()
        sums.add(raster, None, views_around(2)[0])
    assert sums.is_hidden().tolist() == [False, True, False]


def test_splats_at_a_lens_are_found():
    splats, view = random_splats(3), views_around(3)[1]
    with torch.no_grad():
        splats.means[1] = view.position_m + 0.3
    sums = SplatStatistics.nothing(3, torch.device("cpu"))
    assert not sums.is_at_lens(splats, 1.0).any()
    sums.add(picture_of(splats, view), None, view)
    assert sums.is_at_lens(splats, 1.0).tolist() == [False, True, False]
    assert not sums.is_at_lens(splats, 0.0).any()


@pytest.mark.parametrize(
    "wrong",
    [
        {"n_most": 0},
        {"smallest_m": 2.0, "largest_m": 1.0},
        {"stretched": 0.5},
        {"clear_m": -1.0},
        {"clear_m": math.nan},
    ],
)
def test_limits_that_cannot_be_are_wrong_calls(wrong):
    with pytest.raises(ValueError, match="expected"):
        Limits(**wrong)
