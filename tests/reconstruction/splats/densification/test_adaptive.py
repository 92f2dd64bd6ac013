import math

import pytest
import torch

from reconstruction.splats.densification.adaptive import AdaptiveControl, AdaptiveParameters
from reconstruction.splats.densification.strategy import CUT, FixedNumber, Limits
from reconstruction.splats.splats import SHAPES
from tests.reconstruction.splats.learned_scenes import (
    adam,
    error,
    picture_of,
    random_splats,
    train,
    truths_of,
    view_from,
    views_around,
    wall,
)

QUICK = AdaptiveParameters(start=20, stop=150, every=20, gradient=0.1, reset_every=0)


def half_detailed():
    """A wall that is grey on the right and has a pattern four times finer than its splats on the left."""
    colours = torch.full((24, 32, 3), 0.5)
    colours[:, :16] = torch.rand(24, 16, 3, generator=torch.Generator().manual_seed(3))
    return wall(32, 24, colours.reshape(-1, 3))


def grey_wall(panels=None):
    return wall(8, 6, torch.full((48, 3), 0.5), panels=panels)


def forced(splats, view, parameters=QUICK, limits=None, seed=0):
    """One change right after one picture, every visible splat being pulled at."""
    strategy, optimiser = AdaptiveControl(parameters, limits), adam(splats)
    offsets = torch.full((len(splats), 2), 1.0)
    strategy.observe(picture_of(splats, view), offsets, view)
    step = parameters.start - parameters.start % parameters.every + parameters.every - 1
    return strategy.after_step(step, splats, optimiser, torch.Generator().manual_seed(seed))


@pytest.fixture(scope="module")
def learned():
    views = views_around(3, width=40, height=30, f_px=42.0)
    truths = truths_of(half_detailed(), views)
    plain, grown = grey_wall(), grey_wall(panels=torch.arange(48))
    train(plain, views, truths, 180, FixedNumber())
    changes = train(grown, views, truths, 180, AdaptiveControl(QUICK, Limits(n_most=300)))
    return views, truths, plain, grown, changes


@pytest.mark.slow
def test_detail_is_learned_better_with_more_splats(learned):
    views, truths, plain, grown, _ = learned
    assert error(grown, views, truths) < error(plain, views, truths) / 1.7


@pytest.mark.long
def test_splats_go_where_the_detail_is(learned):
    grown = learned[3]
    on_left = (grown.means[:, 0] < 0.0).float().mean()
    assert 120 <= len(grown) <= 300
    assert on_left > 0.62


def test_children_are_of_their_parents_panel_and_in_its_plane():
    splats = grey_wall(panels=torch.arange(48))
    with torch.no_grad():
        splats.quats += 0.2 * torch.randn(48, 4, generator=torch.Generator().manual_seed(0))
    places, normals = splats.means.detach().clone(), splats.normals(torch.zeros(3)).detach()
    change = forced(splats, view_from((0.0, -4.0, 0.3)))
    assert change.n_split + change.n_cloned == 48
    parents = splats.panels.long()
    assert parents.bincount().tolist() == [2] * 48
    off = ((splats.means.detach() - places[parents]) * normals[parents]).sum(dim=1)
    assert off.abs().max() < 1e-6
    assert (splats.means.detach() - places[parents]).norm(dim=1).max() > 0.01


@pytest.mark.parametrize(("size_m", "most"), [(0.25, 0.12), (0.08, 0.12)])
def test_a_picture_changes_little_when_its_splats_are_split_or_cloned(size_m, most):
    splats, view = random_splats(40, size_m=size_m), view_from((0.0, -4.0, 0.3))
    before = truths_of(splats, [view])[0]
    change = forced(splats, view)
    assert (change.n_split > 30) if size_m > 0.1 else (change.n_cloned > 30)
    after = truths_of(splats, [view])[0]
    assert (after - before).abs().mean() < most * before.mean()


def test_an_even_wall_stays_as_it_is():
    inside = view_from((0.0, -1.2, 0.0))
    views = [inside, view_from((0.1, -1.2, 0.05))]
    splats = grey_wall()
    truths = truths_of(wall(32, 24, torch.full((768, 3), 0.5)), views)
    train(splats, views, truths, 60, AdaptiveControl(QUICK, Limits(clear_m=0.2)))
    assert len(splats) <= 52


def test_the_number_of_splats_has_an_end_and_the_strongest_pulls_go_first():
    splats, view = grey_wall(panels=torch.arange(48)), view_from((0.0, -4.0, 0.3))
    strategy, optimiser = AdaptiveControl(QUICK, Limits(n_most=50)), adam(splats)
    pulls = torch.full((48, 2), 1.0)
    pulls[[7, 31]] = 5.0
    strategy.observe(picture_of(splats, view), pulls, view)
    strategy.after_step(39, splats, optimiser, torch.Generator())
    assert len(splats) == 50
    assert splats.panels.bincount()[[7, 31]].tolist() == [2, 2]


def test_splats_that_fade_or_are_at_the_lens_are_pruned():
    splats, view = grey_wall(), view_from((0.0, -4.0, 0.3))
    with torch.no_grad():
        splats.opacity_logits[3] = math.log(0.015)
        splats.means[5] = view.position_m + torch.tensor([0.0, 0.5, 0.0])
    strategy, optimiser = AdaptiveControl(QUICK), adam(splats)
    strategy.observe(picture_of(splats, view), None, view)
    change = strategy.after_step(39, splats, optimiser, torch.Generator())
    assert (change.n_pruned, len(splats), change.n_dead) == (2, 46, 0)


def test_a_reset_leaves_every_splat_above_the_cut_and_none_dies_of_it():
    views = views_around(2)
    splats = random_splats(60)
    truths = truths_of(splats, views)
    strategy = AdaptiveControl(AdaptiveParameters(start=0, stop=1000, every=10, gradient=1e9, reset_every=40, grace=30))
    optimiser = adam(splats)
    changes = train(splats, views, truths, 40, strategy, optimiser=optimiser)
    assert changes[-1].is_reset
    assert not changes[-1].is_nothing
    assert 0.09 < splats.opacities.max() <= 0.1001
    assert splats.opacities.min() > CUT
    assert (optimiser.state[splats.opacity_logits]["exp_avg"] == 0.0).all()
    n = len(splats)
    later = train(splats, views, truths, 35, strategy, optimiser=optimiser, first=40)
    assert sum(change.n_pruned for change in later[:29]) == 0
    assert len(splats) >= n - 3
    assert splats.opacities.median() > 0.3


def test_a_training_that_is_interrupted_goes_on_with_the_same_bits():
    views = views_around(2)
    truths = truths_of(half_detailed(), views)
    parameters = AdaptiveParameters(start=0, stop=100, every=12, gradient=0.1, reset_every=30)

    def run(interrupted):
        splats, strategy = grey_wall(), AdaptiveControl(parameters)
        optimiser = adam(splats)
        train(splats, views, truths, 20, strategy, optimiser=optimiser, seed=1)
        if interrupted:
            again = AdaptiveControl(parameters)
            again.load_state_dict({name: value.clone() for name, value in strategy.state_dict().items()})
            strategy = again
        train(splats, views, truths, 14, strategy, optimiser=optimiser, seed=2, first=20)
        return splats

    whole, resumed = run(False), run(True)
    assert len(whole) > 48
    for name in SHAPES:
        assert torch.equal(getattr(whole, name), getattr(resumed, name))


def test_splats_of_a_pixel_are_not_made_more_of():
    splats, view = random_splats(40, size_m=0.012), view_from((0.0, -4.0, 0.3))
    assert forced(splats, view).is_nothing


def test_a_model_whose_splats_all_faded_keeps_them():
    splats, view = grey_wall(), view_from((0.0, -4.0, 0.3))
    with torch.no_grad():
        splats.opacity_logits.fill_(-4.5)
    assert forced(splats, view).n_pruned == 0
    assert len(splats) == 48


def test_nothing_happens_outside_the_steps_it_is_meant_for():
    splats, view = grey_wall(), view_from((0.0, -4.0, 0.3))
    strategy, optimiser = AdaptiveControl(QUICK), adam(splats)
    for step in (9, 19, 159):
        strategy.observe(picture_of(splats, view), torch.ones(48, 2), view)
        assert (strategy.after_step(step, splats, optimiser, torch.Generator()).is_nothing) == (step != 39)
    assert len(splats) == 48


@pytest.mark.parametrize(
    "wrong",
    [
        {"start": 5, "stop": 4},
        {"every": 0},
        {"gradient": 0.0},
        {"least_opacity": 0.001},
        {"reset_opacity": 0.01},
        {"grace": -1},
    ],
)
def test_settings_that_cannot_be_are_wrong_calls(wrong):
    with pytest.raises(ValueError, match="expected"):
        AdaptiveParameters(**wrong)
