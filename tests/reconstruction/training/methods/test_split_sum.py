"""Reflectance of rough surfaces: the table against sums over the hemisphere."""

import numpy as np
import pytest
import torch

from reconstruction.training.methods.ref_gaussian import SIZE, hammersley, reflectance, split_sum, split_sum_table


def summed(f0, roughness, cosine, n=2_000_000, seed=0):
    """Share of even light that comes back, and its standard error: the rendering equation with f = D G F / (4 (n . l)
    (n . v)), by random directions of light, as likely from everywhere above the surface.
    """
    generator = np.random.default_rng(seed)
    up, turn = generator.random(n), 2.0 * np.pi * generator.random(n)
    aside = np.sqrt(1.0 - up * up)
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    light = np.stack([aside * np.cos(turn), aside * np.sin(turn), up], axis=1)
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    alpha = roughness**2
    d = alpha**2 / (np.pi * (half[:, 2] ** 2 * (alpha**2 - 1.0) + 1.0) ** 2)
    k = 0.5 * alpha
    g = up / (up * (1.0 - k) + k) * cosine / (cosine * (1.0 - k) + k)
    f = f0 + (1.0 - f0) * (1.0 - half @ view) ** 5
    parts = d * g * f / (4.0 * up * cosine) * up * 2.0 * np.pi
    return parts.mean(), parts.std() / np.sqrt(n)


@pytest.mark.parametrize(
    ("f0", "roughness", "cosine"),
    [(0.04, 0.5, 0.9), (0.5, 0.3, 0.6), (1.0, 0.7, 0.3), (0.04, 1.0, 0.15), (0.9, 0.45, 0.08)],
)
def test_the_table_is_the_integral_over_the_hemisphere(f0, roughness, cosine):
    truth, error = summed(f0, roughness, cosine, 400_000)
    one = torch.ones(1, dtype=torch.float64)
    found = float(reflectance(f0 * one[:, None], roughness * one, cosine * one))
    assert error < 0.01
    assert found == pytest.approx(truth, abs=3e-3 + 4.0 * error)


def test_the_table_is_linear_enough_between_its_places_and_has_samples_enough():
    generator = np.random.default_rng(1)
    for cosine in (0.035, 0.07, 0.4, 0.93):
        roughness = np.sort(generator.uniform(0.0, 1.0, 30))
        truth = split_sum(roughness, cosine, 8192)
        asked = torch.from_numpy(roughness), torch.full((30,), cosine, dtype=torch.float64)
        bias, whole = (reflectance(torch.full((30, 1), f0, dtype=torch.float64), *asked)[:, 0] for f0 in (0.0, 1.0))
        assert np.abs(bias.numpy() - truth[:, 1]).max() < 5e-3
        assert np.abs((whole - bias).numpy() - truth[:, 0]).max() < 5e-3


def test_a_mirror_has_the_fresnel_term_of_schlick():
    cosines = torch.linspace(0.0, 1.0, SIZE, dtype=torch.float64)
    found = reflectance(torch.full((SIZE, 1), 0.3, dtype=torch.float64), torch.zeros_like(cosines), cosines)
    # 1e-4 stands for a cosine of 0, and the term falls by 5 there.
    assert torch.allclose(found[:, 0], 0.3 + 0.7 * (1.0 - cosines) ** 5, atol=5e-4)


def test_no_more_comes_back_than_falls_in_and_nothing_is_negative():
    table = split_sum_table()
    assert np.isfinite(table).all()
    assert table.min() >= 0.0
    assert table.sum(axis=2).max() < 1.0 + 1e-3


def test_gradients_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(0)
    asked = [
        torch.rand(6, *shape, generator=generator, dtype=torch.float64).requires_grad_() for shape in ((3,), (), ())
    ]
    assert torch.autograd.gradcheck(reflectance, asked)


def test_ends_and_what_is_beyond_them_are_numbers():
    ends = torch.tensor([-0.1, 0.0, 1e-7, 1.0, 1.0 + 1e-6, 3.0])
    roughness, cosines = (each.ravel().requires_grad_() for each in torch.meshgrid(ends, ends, indexing="ij"))
    f0 = torch.full((36, 3), 0.5, requires_grad=True)
    roughness, cosines = roughness.detach().requires_grad_(), cosines.detach().requires_grad_()
    found = reflectance(f0, roughness, cosines)
    slopes = torch.autograd.grad(found.sum(), [f0, roughness, cosines])
    assert found.isfinite().all()
    assert all(each.isfinite().all() for each in slopes)
    assert torch.equal(reflectance(f0, roughness, cosines), reflectance(f0, roughness.clamp(0, 1), cosines.clamp(0, 1)))


def test_hammersley_points_are_spread_evenly():
    x, y = hammersley(64)
    cells = np.floor(x * 8).astype(int) * 8 + np.floor(y * 8).astype(int)
    assert sorted(cells) == list(range(64))
