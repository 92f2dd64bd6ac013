"""Both strategies with three sizes: what they do to ellipsoids, and that these learn more with it."""

import math

import pytest
import torch

from reconstruction.splats.densification.adaptive import AdaptiveControl
from reconstruction.splats.densification.mcmc import MarkovChain, McmcParameters, shared_out
from reconstruction.splats.densification.strategy import CUT, FixedNumber, Limits, keep_within
from reconstruction.splats.rasterising.projection import rotations
from reconstruction.splats.splats import SHAPES
from tests.reconstruction.splats.densification.test_adaptive import QUICK, forced, grey_wall, half_detailed
from tests.reconstruction.splats.densification.test_mcmc import QUICK as QUICK_CHAIN
from tests.reconstruction.splats.densification.test_mcmc import relocated
from tests.reconstruction.splats.learned_scenes import (
    adam,
    error,
    picture_of,
    random_splats,
    solid,
    train,
    truths_of,
    view_from,
    views_around,
)
from tests.slow import slow

VIEW = view_from((0.0, -4.0, 0.3))


@pytest.fixture(scope="module")
def scene():
    """Views of a wall with detail on the left, its light, and a fixed number of ellipsoids that learned it."""
    views = views_around(3, width=40, height=30, f_px=42.0)
    truths = truths_of(half_detailed(), views)
    plain = solid(grey_wall())
    train(plain, views, truths, 150, FixedNumber())
    return views, truths, error(plain, views, truths)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("strategy", "times"), [(AdaptiveControl(QUICK, Limits(n_most=300)), 1.3), slow(MarkovChain(QUICK_CHAIN), 1.2)]
)
def test_detail_is_learned_better_with_more_ellipsoids(scene, strategy, times):
    views, truths, plain = scene
    grown = solid(grey_wall())
    changes = train(grown, views, truths, 150, strategy)
    assert not grown.is_flat
    assert sum(not change.is_nothing for change in changes) >= 5
    assert 150 <= len(grown) <= 300
    assert all(getattr(grown, name).isfinite().all() for name in SHAPES)
    assert error(grown, views, truths) < plain / times


@pytest.mark.parametrize("longest", [0, 1, 2])
def test_halves_lie_on_the_longest_of_three_axes(longest):
    splats = solid(random_splats(20, size_m=0.1))
    splats.panels[:] = torch.arange(20)
    with torch.no_grad():
        splats.log_scales[:] = math.log(0.15)
        splats.log_scales[:, longest] = math.log(0.4)
    places, axes = splats.means.detach().clone(), rotations(splats.quats.detach())[..., longest]
    assert forced(splats, VIEW).n_split == 20
    parents = splats.panels.long()
    moved = splats.means.detach() - places[parents]
    assert torch.allclose(moved.norm(dim=1), torch.tensor(0.6 * 0.4), rtol=1e-4)
    assert torch.allclose((moved * axes[parents]).sum(dim=1).abs(), moved.norm(dim=1), rtol=1e-4)
    expected = torch.full((40, 3), 0.15)
    expected[:, longest] = 0.77 * 0.4
    assert torch.allclose(splats.scales.detach(), expected, rtol=1e-4)


def test_twins_are_put_beside_each_other_along_all_axes():
    splats = solid(random_splats(40, size_m=0.08), 0.9)
    splats.panels[:] = torch.arange(40)
    places, axes = splats.means.detach().clone(), rotations(splats.quats.detach())
    assert forced(splats, VIEW).n_cloned > 30
    parents = splats.panels.long()
    along = torch.einsum("nij,ni->nj", axes[parents], splats.means.detach() - places[parents])
    is_cloned = along.norm(dim=1) > 0.0
    in_sizes = along[is_cloned] / splats.scales.detach()[is_cloned]
    assert torch.allclose(in_sizes.std(dim=0), torch.tensor(0.3), rtol=0.35)


@pytest.mark.parametrize(("size_m", "most"), [(0.25, 0.12), (0.08, 0.12)])
def test_a_picture_changes_little_when_its_ellipsoids_are_split_or_cloned(size_m, most):
    splats = solid(random_splats(40, size_m=size_m))
    before = truths_of(splats, [VIEW])[0]
    change = forced(splats, VIEW)
    assert (change.n_split > 30) if size_m > 0.1 else (change.n_cloned > 30)
    assert (truths_of(splats, [VIEW])[0] - before).abs().mean() < most * before.mean()


def test_dead_ellipsoids_go_to_living_ones_and_the_picture_stays():
    splats = solid(random_splats(60))
    with torch.no_grad():
        splats.opacity_logits[:10] = math.log(CUT / 2)
    before = truths_of(splats, [VIEW])[0]
    change = relocated(splats, VIEW, McmcParameters(start=20, stop=150, every=20, n_splats=60, noise=0.0))
    assert (change.n_relocated, change.n_dead, len(splats)) == (10, 0, 60)
    assert (truths_of(splats, [VIEW])[0] - before).abs().mean() < 0.03 * before.mean()


@pytest.mark.parametrize(("opacity", "copies"), [(0.9, 2), (0.99, 7), (0.3, 3)])
def test_copies_of_an_ellipsoid_cover_in_the_picture_what_the_one_covered(opacity, copies):
    one = solid(random_splats(1, size_m=0.8))
    with torch.no_grad():
        one.means[:] = 0.0
    several = type(one)(
        {name: getattr(one, name).detach().repeat_interleave(copies, 0) for name in SHAPES}, one.panels.repeat(copies)
    )
    shared, sizes = shared_out(torch.tensor([opacity]), one.scales.detach(), torch.tensor([copies]))
    with torch.no_grad():
        one.opacity_logits[:] = torch.logit(torch.tensor(opacity))
        several.opacity_logits[:] = torch.logit(shared)
        several.log_scales[:] = sizes.log()
    view = view_from((0.0, -8.0, 0.3), width=96, height=96, f_px=60.0)
    with torch.no_grad():
        before, after = (float(picture_of(splats, view).alphas.sum()) for splats in (one, several))
    # Up to what lies below the cut.
    assert after == pytest.approx(before, rel=0.04)


def test_see_through_ellipsoids_jitter_along_all_axes():
    splats = solid(random_splats(60), 1.0)
    with torch.no_grad():
        splats.opacity_logits[:] = math.log(0.003)
    before, axes = splats.means.detach().clone(), rotations(splats.quats.detach())
    MarkovChain(QUICK_CHAIN).after_step(0, splats, adam(splats), torch.Generator().manual_seed(0))
    along = torch.einsum("nij,ni->nj", axes, splats.means.detach() - before) / splats.scales.detach()
    assert torch.allclose(along.std(dim=0) / along.std(), torch.ones(3), rtol=0.35)
    assert along.abs().min(dim=0).values.max() > 0.0


def test_three_sizes_are_kept_within_limits_so_that_pancakes_stay_and_no_needle_is_left():
    splats = solid(random_splats(5))
    with torch.no_grad():
        sizes = torch.tensor(
            [[1.0, 0.1, 0.5], [500.0, 1.0, 400.0], [1e-9, 1e-8, 1e-7], [2e-3, 1.0, 3e-3], [0.8, 0.002, 0.9]]
        )
        splats.log_scales[:] = sizes.log()
    keep_within(splats, Limits(smallest_m=0.001, largest_m=10.0, stretched=16.0))
    found = splats.scales.detach()
    expected = torch.tensor([[1.0, 0.1, 0.5], [10.0, 1.0, 10.0], [0.001, 0.001, 0.001]])
    assert torch.allclose(found[:3], expected, rtol=1e-5)
    assert torch.allclose(found[3], torch.tensor([2e-3, 1.0, 1.0 / 16.0]), rtol=1e-5)
    assert torch.allclose(found[4], sizes[4], rtol=1e-5)


def test_the_wish_for_small_ellipsoids_has_the_gradient_of_what_it_says():
    splats = solid(random_splats(9))
    MarkovChain(McmcParameters(opacity_weight=0.3, size_weight=0.2)).before_step(0, splats, adam(splats))
    found = splats.log_scales.grad.clone()
    splats.zero_grad()
    scales = splats.scales
    (0.2 * (scales / scales.median().detach()).mean()).backward()
    assert torch.allclose(found, splats.log_scales.grad, rtol=1e-5)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", [AdaptiveControl, MarkovChain])
def test_a_training_of_ellipsoids_that_is_interrupted_goes_on_with_the_same_bits(kind):
    views = views_around(2)
    truths = truths_of(half_detailed(), views)
    parameters = QUICK if kind is AdaptiveControl else QUICK_CHAIN

    def run(interrupted):
        splats, strategy = solid(grey_wall()), kind(parameters)
        optimiser = adam(splats)
        train(splats, views, truths, 30, strategy, optimiser=optimiser, seed=1)
        if interrupted:
            state, strategy = strategy.state_dict(), kind(parameters)
            strategy.load_state_dict({name: value.clone() for name, value in state.items()})
        train(splats, views, truths, 12, strategy, optimiser=optimiser, seed=2, first=30)
        return splats

    whole, resumed = run(False), run(True)
    assert len(whole) > 48
    for name in SHAPES:
        assert torch.equal(getattr(whole, name), getattr(resumed, name))
