"""The environment on a cube: even light stays even, rough light is what GGX sees, and both can be learned."""

import math

import numpy as np
import pytest
import torch

from reconstruction.light.cube_lookup import solid_angles, texel_directions, texels_of
from reconstruction.light.cube_map import ROUGH_LEVELS, CubeMap, level_of
from reconstruction.light.shading import reflected_directions
from tests.reconstruction.light.test_lobes import ggx_by_half_vectors
from tests.reconstruction.training.methods.synthetic_ball import (
    N_TRAINED,
    N_UNSEEN,
    environment,
    psnr,
    seen,
    trained,
    unit,
)

SIDE = 32


def filled(side=SIDE):
    """A map that shows the made environment."""
    made = CubeMap(side)
    with torch.no_grad():
        light = torch.from_numpy(environment(texel_directions(side)))
        made.texels.copy_(torch.log(torch.expm1(light)))
    return made


def directions(n, seed=0):
    return torch.from_numpy(unit(np.random.default_rng(seed).normal(size=(n, 3))))


def test_a_new_map_gives_the_expected_light_everywhere():
    made, asked = CubeMap(8, 0.4), directions(50).float()
    for roughness in (None, torch.rand(50, generator=torch.Generator().manual_seed(1))):
        assert torch.allclose(made(asked, roughness), torch.tensor(0.4), atol=1e-5)
    assert torch.allclose(made.on_matt(asked), torch.tensor(0.4), atol=1e-5)


@pytest.mark.slow
def test_a_mirror_shows_each_texel_where_it_is():
    made, middle = filled(), torch.from_numpy(texel_directions(SIDE)).float()
    truth = torch.from_numpy(environment(texel_directions(SIDE))).float()
    assert torch.allclose(made(middle), truth, atol=1e-5)
    assert torch.allclose(made(middle, torch.zeros(len(middle))), truth, atol=1e-5)


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize(("roughness", "share"), [(0.15, 0.05), (0.22, 0.07), (0.4, 0.05), (0.6, 0.04), (0.9, 0.02)])
def test_rough_light_is_what_a_ggx_lobe_sees(roughness, share):
    """At and between levels; errors as shares of the spread of the light that comes out, seen three times finer."""
    made, asked = filled().double(), directions(150)
    light = environment(texel_directions(SIDE))
    places = texel_directions(64)
    cosines = np.clip(asked.numpy() @ places.T, -1.0, 1.0)
    weights = ggx_by_half_vectors(cosines, roughness) * solid_angles(64)
    # Between texels light is linear, as lookups have it, so that narrow lobes see what they should.
    seen_light = filled()(torch.from_numpy(places).float()).detach().double().numpy()
    assert np.abs(seen_light.mean(axis=0) - light.mean(axis=0)).max() < 0.02
    truth = weights @ seen_light / weights.sum(axis=1, keepdims=True)
    found = made(asked, torch.full((150,), roughness, dtype=torch.float64)).detach().numpy()
    error = np.sqrt(np.mean((found - truth) ** 2))
    assert error < share * truth.std(axis=0).mean()


@pytest.mark.long
def test_light_on_matt_surfaces_is_irradiance_over_pi():
    made, asked = filled(), directions(40)
    places = texel_directions(64)
    light = environment(texel_directions(SIDE))[texels_of(places, SIDE)]
    cosines = np.maximum(asked.numpy() @ places.T, 0.0)
    truth = (cosines * solid_angles(64)) @ light / math.pi
    found = made.on_matt(asked.float()).detach().numpy()
    assert np.abs(found - truth).max() < 0.02


def test_float32_and_float64_agree_in_values_and_gradients():
    fast, slow = filled(8), filled(8).double()
    generator = torch.Generator().manual_seed(2)
    roughness = torch.rand(3000, generator=generator)
    given, found = torch.randn(3000, 3, generator=generator), []
    for made, dtype in ((fast, torch.float32), (slow, torch.float64)):
        asked = [directions(3000).to(dtype).requires_grad_(), roughness.to(dtype).requires_grad_()]
        light = made(*asked)
        found.append([light, *torch.autograd.grad((light * given.to(dtype)).sum(), [made.texels, *asked])])
    for one, other in zip(*found, strict=True):
        is_close = (one - other).abs() < 1e-4 * (1.0 + other.abs())
        assert float(is_close.double().mean()) > 0.998


@pytest.mark.long
def test_gradients_are_those_of_finite_differences():
    made = filled(8).double()
    asked = directions(3, seed=4).requires_grad_()
    roughness = torch.tensor([0.08, 0.4, 0.8], dtype=torch.float64).requires_grad_()
    assert torch.autograd.gradcheck(made, (asked, roughness))

    def of_texels(texels):
        return torch.func.functional_call(made, {"texels": texels}, (asked.detach(), roughness.detach()))

    start = made.texels.detach().clone().requires_grad_()
    (slope,) = torch.autograd.grad(of_texels(start).square().sum(), start)
    along = torch.randn(start.shape, generator=torch.Generator().manual_seed(5), dtype=torch.float64)
    ends = [of_texels(start.detach() + step * along).square().sum() for step in (1e-5, -1e-5)]
    assert float((slope * along).sum()) == pytest.approx(float(ends[0] - ends[1]) / 2e-5, rel=1e-6)


def test_ends_of_roughness_and_axes_are_numbers_with_numbers_for_gradients():
    made = filled(8)
    corners = torch.tensor([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.577350, 0.577350, 0.577350]])
    for value in (-0.5, 0.0, 1e-6, 0.15, 1.0, 2.0):
        asked = corners.clone().requires_grad_()
        roughness = torch.full((4,), value, requires_grad=True)
        light = made(asked, roughness)
        slopes = torch.autograd.grad(light.sum(), [asked, roughness, made.texels])
        assert light.isfinite().all()
        assert all(each.isfinite().all() for each in slopes)


def test_levels_are_met_at_their_roughness_and_grow_with_it():
    ends = torch.tensor([0.0, *(each.roughness for each in ROUGH_LEVELS)], dtype=torch.float64)
    assert torch.allclose(level_of(ends), torch.arange(len(ends), dtype=torch.float64))
    assert (torch.diff(level_of(torch.linspace(0.0, 1.0, 200, dtype=torch.float64))) > 0.0).all()


def test_light_without_gradients_follows_the_texels():
    made, asked, roughness = filled(8), directions(5).float(), torch.full((5,), 0.5)
    with torch.no_grad():
        before = made(asked, roughness)
        assert torch.equal(made(asked, roughness), before)
        made.texels += 1.0
        assert (made(asked, roughness) > before + 0.3).all()
        made.load_state_dict(filled(8).state_dict())
        assert torch.equal(made(asked, roughness), before)
    assert torch.equal(made(asked, roughness), before)
    assert made(asked, roughness).requires_grad


def test_only_texels_are_saved():
    assert list(CubeMap(8).state_dict()) == ["texels"]


@pytest.mark.long
def test_a_mirror_ball_teaches_the_light_that_no_ray_has_shown():
    made = CubeMap(SIDE)
    known, unseen = (seen(n, seed, f0=1.0, diffuse=0.0) for n, seed in ((N_TRAINED, 0), (N_UNSEEN, 1)))
    trained(lambda o, n, _: made(reflected_directions(o, n)), [(made.parameters(), 0.1)], known, 120)
    with torch.no_grad():
        # 39.9 dB was measured.
        assert psnr(made(reflected_directions(*unseen[:2])), unseen[2]) > 36.0


def test_sides_and_light_that_cannot_be_are_refused():
    for side in (4, 12, 0):
        with pytest.raises(ValueError, match="power of 2"):
            CubeMap(side)
    for expected in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match="light above 0"):
            CubeMap(8, expected)
