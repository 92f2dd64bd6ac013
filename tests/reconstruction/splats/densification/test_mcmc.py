import math

import pytest
import torch

from reconstruction.splats.densification.mcmc import MarkovChain, McmcParameters, shared_out
from reconstruction.splats.densification.strategy import CUT, HIDDEN_VIEWS, FixedNumber, Limits
from reconstruction.splats.splats import SHAPES, normals_of
from tests.reconstruction.splats.densification.test_adaptive import grey_wall, half_detailed
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

QUICK = McmcParameters(start=20, stop=150, every=20, n_splats=250, growth=0.35)


def covered(opacity, size, n):
    """Integral of the opacity of n equal discs one behind the other, by a fine sum over rings."""
    radii = (torch.arange(20000, dtype=torch.float64) + 0.5) * 1e-3
    one = opacity * torch.exp(-(radii**2) / (2.0 * size**2))
    return float(((1.0 - (1.0 - one) ** n) * 2.0 * math.pi * radii).sum() * 1e-3)


@pytest.mark.parametrize(("opacity", "n"), [(0.9, 2), (0.99, 7), (0.3, 3), (0.05, 50), (0.7, 1)])
def test_copies_in_one_place_cover_what_the_one_covered(opacity, n):
    size = torch.tensor([[1.2, 1.2]], dtype=torch.float64)
    shared, sizes = shared_out(torch.tensor([opacity], dtype=torch.float64), size, torch.tensor([n]))
    assert 1.0 - (1.0 - float(shared)) ** n == pytest.approx(opacity, rel=1e-6)
    assert covered(float(shared), float(sizes[0, 0]), n) == pytest.approx(covered(opacity, 1.2, 1), rel=1e-4)


def relocated(splats, view, parameters=QUICK, seed=0):
    strategy, optimiser = MarkovChain(parameters), adam(splats)
    strategy.observe(picture_of(splats, view), None, view)
    return strategy.after_step(39, splats, optimiser, torch.Generator().manual_seed(seed))


def test_dead_splats_go_to_living_ones_and_the_picture_stays():
    splats, view = random_splats(60), view_from((0.0, -4.0, 0.3))
    splats.panels[:] = torch.arange(60)
    with torch.no_grad():
        splats.opacity_logits[:10] = math.log(CUT / 2)
    before = truths_of(splats, [view])[0]
    change = relocated(splats, view, McmcParameters(start=20, stop=150, every=20, n_splats=60, noise=0.0))
    assert (change.n_relocated, change.n_added, change.n_dead, len(splats)) == (10, 0, 0, 60)
    assert (splats.panels[:10] >= 10).all()
    assert splats.opacities.min() > 0.01
    after = truths_of(splats, [view])[0]
    assert (after - before).abs().mean() < 0.03 * before.mean()


def test_splats_become_more_up_to_the_number_asked_for():
    splats, view = random_splats(60), view_from((0.0, -4.0, 0.3))
    counts = []
    for _ in range(4):
        relocated(splats, view, McmcParameters(start=20, stop=150, every=20, n_splats=100, growth=0.3))
        counts.append(len(splats))
    assert counts == [78, 100, 100, 100]


def test_what_is_seen_nowhere_is_relocated_too():
    splats, view = grey_wall(), view_from((0.0, -4.0, 0.3))
    with torch.no_grad():
        splats.means[0] = torch.tensor([0.0, 1.0, 0.0])
        splats.log_scales[0] = math.log(0.02)
        splats.opacity_logits[1:] = 6.0
        splats.log_scales[1:] += math.log(2.0)
    strategy, optimiser = (
        MarkovChain(McmcParameters(start=20, stop=150, every=20, n_splats=48, noise=0.0)),
        adam(splats),
    )
    for _ in range(HIDDEN_VIEWS + 1):
        strategy.observe(picture_of(splats, view), None, view)
    assert strategy.after_step(39, splats, optimiser, torch.Generator().manual_seed(0)).n_relocated == 1
    assert abs(splats.means[0, 1].item()) < 1e-6


@pytest.mark.slow
def test_detail_is_learned_better_with_more_splats():
    views = views_around(3, width=40, height=30, f_px=42.0)
    truths = truths_of(half_detailed(), views)
    plain, grown = grey_wall(), grey_wall()
    train(plain, views, truths, 180, FixedNumber())
    train(grown, views, truths, 180, MarkovChain(QUICK))
    assert len(grown) == 250
    assert error(grown, views, truths) < error(plain, views, truths) / 1.35


@pytest.mark.slow
def test_more_splats_change_nothing_where_there_is_no_detail():
    views = [view_from((0.0, -1.2, 0.0)), view_from((0.1, -1.2, 0.05))]
    truths = truths_of(wall(32, 24, torch.full((768, 3), 0.5)), views)
    plain, grown = grey_wall(), grey_wall()
    train(plain, views, truths, 60, FixedNumber())
    train(grown, views, truths, 60, MarkovChain(QUICK, Limits(clear_m=0.2)))
    assert len(grown) > 48
    assert abs(error(grown, views, truths) - error(plain, views, truths)) < 0.005


def test_see_through_splats_jitter_in_their_plane_and_opaque_ones_stay():
    splats = random_splats(40)
    with torch.no_grad():
        splats.opacity_logits[:20] = math.log(0.003)
        splats.opacity_logits[20:] = 3.0
    before, normals = splats.means.detach().clone(), normals_of(splats.quats).detach()
    MarkovChain(QUICK).after_step(0, splats, adam(splats), torch.Generator().manual_seed(0))
    moved = splats.means.detach() - before
    assert moved[:20].norm(dim=1).min() > 1e-4
    assert moved[20:].abs().max() == 0.0
    assert (moved * normals).sum(dim=1).abs().max() < 1e-6


def test_the_wish_for_few_and_small_splats_has_the_gradient_of_what_it_says():
    splats = random_splats(9)
    chosen = McmcParameters(opacity_weight=0.3, size_weight=0.2)
    MarkovChain(chosen).before_step(0, splats, adam(splats))
    found = splats.opacity_logits.grad.clone(), splats.log_scales.grad.clone()
    splats.zero_grad()
    scales = splats.scales
    (0.3 * splats.opacities.mean() + 0.2 * (scales / scales.median().detach()).mean()).backward()
    assert torch.allclose(found[0], splats.opacity_logits.grad, rtol=1e-5)
    assert torch.allclose(found[1], splats.log_scales.grad, rtol=1e-5)


def test_a_training_that_is_interrupted_goes_on_with_the_same_bits():
    views = views_around(2)
    truths = truths_of(half_detailed(), views)
    parameters = McmcParameters(start=0, stop=100, every=12, n_splats=80)

    def run(interrupted):
        splats, strategy = grey_wall(), MarkovChain(parameters)
        optimiser = adam(splats)
        train(splats, views, truths, 20, strategy, optimiser=optimiser, seed=1)
        if interrupted:
            state, strategy = strategy.state_dict(), MarkovChain(parameters)
            strategy.load_state_dict({name: value.clone() for name, value in state.items()})
        train(splats, views, truths, 14, strategy, optimiser=optimiser, seed=2, first=20)
        return splats

    whole, resumed = run(False), run(True)
    assert len(whole) > 48
    for name in SHAPES:
        assert torch.equal(getattr(whole, name), getattr(resumed, name))


@pytest.mark.parametrize(
    "wrong", [{"start": 5, "stop": 4}, {"every": 0}, {"n_splats": 0}, {"least_opacity": CUT}, {"noise": -1.0}]
)
def test_settings_that_cannot_be_are_wrong_calls(wrong):
    with pytest.raises(ValueError, match="expected"):
        McmcParameters(**wrong)
