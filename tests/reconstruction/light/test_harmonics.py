"""Spherical harmonics on panels: orthonormal, in the right place, linear between places."""

import math

import numpy as np
import pytest
import torch
from scipy.special import sph_harm_y

from reconstruction.light.harmonics import HarmonicTexture, harmonics, n_harmonics

CORNERS = torch.tensor([[[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 1.0]]])


def two_panels():
    return torch.cat([CORNERS, CORNERS + torch.tensor([1.0, 0.0, 0.0])])


def places(u, v, panel=0):
    return torch.tensor([[u - 1.0 + panel, 0.0, v]])


UP = torch.tensor([[0.0, 0.0, 1.0]])


def test_harmonics_are_those_of_scipy_as_real_combinations():
    rng = np.random.default_rng(0)
    theta, phi = np.arccos(rng.uniform(-1, 1, 40)), rng.uniform(0, 2 * math.pi, 40)
    points = np.column_stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    found = harmonics(torch.from_numpy(points)).numpy()
    expected = []
    for degree in range(4):
        for order in range(-degree, degree + 1):
            value = sph_harm_y(degree, abs(order), theta, phi) * (-1) ** order
            factor = 1.0 if order == 0 else math.sqrt(2.0)
            expected.append(factor * (value.imag if order < 0 else value.real))
    assert found == pytest.approx(np.array(expected).T, abs=1e-12)


def test_at_a_place_stands_its_light_and_between_places_what_is_linear():
    texture = HarmonicTexture(two_panels(), 2, torch.full((2, 3), 0.5))
    with torch.no_grad():
        texture.coefficients[4 + 0, 0] = 2.0
        texture.coefficients[4 + 1, 0] = 4.0
    constant = math.sqrt(1 / (4 * math.pi))

    def logit(u, v):
        return torch.logit(texture(places(u, v, 1), UP, torch.tensor([1])))[0, 0].item()

    assert logit(0.0, 0.0) == pytest.approx(2.0 * constant, abs=1e-5)
    assert logit(1.0, 0.0) == pytest.approx(4.0 * constant, abs=1e-5)
    assert logit(0.5, 0.0) == pytest.approx(3.0 * constant, abs=1e-5)
    assert logit(0.5, 0.5) == pytest.approx(1.5 * constant, abs=1e-5)
    # Off the panel is on its edge.
    assert logit(7.0, -3.0) == pytest.approx(4.0 * constant, abs=1e-5)


def test_panels_have_light_of_their_own():
    texture = HarmonicTexture(two_panels(), 3, torch.tensor([[0.25] * 3, [0.5] * 3]))
    first, second = (texture(places(0.5, 0.5, k), UP, torch.tensor([k])) for k in (0, 1))
    assert torch.allclose(first, torch.tensor(0.25))
    assert torch.allclose(second, torch.tensor(0.5))
    with torch.no_grad():
        texture.coefficients[9:] = 1.0
    first, second = (texture(places(0.5, 0.5, k), UP, torch.tensor([k])) for k in (0, 1))
    assert torch.allclose(first, torch.tensor(0.25))
    assert (second > 0.6).all()


def test_of_degree_0_light_is_the_same_in_all_directions():
    means = torch.full((1, 3), 0.4)
    generator = torch.Generator().manual_seed(0)
    east = torch.tensor([[1.0, 0.0, 0.0]])
    for degree, is_same in ((0, True), (1, False)):
        texture = HarmonicTexture(CORNERS, 2, means, degree)
        assert texture.coefficients.shape == (4, 3 * n_harmonics(degree))
        with torch.no_grad():
            texture.coefficients.copy_(torch.randn(texture.coefficients.shape, generator=generator))
        up, aside = (texture(places(0.3, 0.4), direction, torch.tensor([0])) for direction in (UP, east))
        assert torch.equal(up, aside) == is_same


def test_gradients_are_those_of_finite_differences():
    texture = HarmonicTexture(two_panels(), 3, torch.full((2, 3), 0.25)).double()
    generator = torch.Generator().manual_seed(0)
    with torch.no_grad():
        texture.coefficients.copy_(torch.randn(texture.coefficients.shape, generator=generator))
    points = torch.tensor([[-0.71, 0.0, 0.13], [0.35, 0.0, 0.9]], dtype=torch.float64, requires_grad=True)
    directions = torch.tensor([[0.6, 0.0, 0.8], [0.0, -0.6, 0.8]], dtype=torch.float64, requires_grad=True)
    panels = torch.tensor([0, 1])
    assert torch.autograd.gradcheck(lambda p, d: texture(p, d, panels), (points, directions))
    assert texture.coefficients.shape == (18, 3 * n_harmonics(3))


def test_a_grid_of_one_place_and_degrees_that_are_not_known_are_refused():
    with pytest.raises(ValueError, match="side"):
        HarmonicTexture(CORNERS, 1, torch.full((1, 3), 0.5))
    for degree in (-1, 4):
        with pytest.raises(ValueError, match="degree"):
            HarmonicTexture(CORNERS, 2, torch.full((1, 3), 0.5), degree)
