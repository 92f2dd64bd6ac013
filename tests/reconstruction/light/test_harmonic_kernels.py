"""Blended harmonics, compiled, against plain torch in double precision."""

import numpy as np
import pytest
import torch
from torch.nn.functional import normalize

from reconstruction.light import harmonics as kernels
from reconstruction.light.harmonics import HarmonicTexture

CORNERS = torch.tensor(
    [
        [[-1.0, 0.0, -1.0], [-0.1, 0.0, -1.0], [-0.1, 0.0, 1.0], [-1.0, 0.0, 1.0]],
        [[0.1, 0.0, -1.0], [0.8, 0.3, -1.0], [0.8, 0.3, 0.5], [0.1, 0.0, 0.5]],
    ]
)


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_light_and_gradients_are_those_of_the_texture_in_torch(degree):
    generator = torch.Generator().manual_seed(degree)
    texture = HarmonicTexture(CORNERS, 3, torch.tensor([[0.2, 0.3, 0.4], [0.5, 0.6, 0.7]]), degree)
    with torch.no_grad():
        texture.coefficients += torch.randn(texture.coefficients.shape, generator=generator)
    panels = torch.randint(2, (200,), generator=generator)
    # Also of places beyond the edges.
    shares = 1.2 * torch.rand(200, 2, generator=generator) - 0.1
    corners = CORNERS[panels]
    points = corners[:, 0] + sum(shares[:, [k]] * (corners[:, 2 * k + 1] - corners[:, 0]) for k in (0, 1))
    omega_r = normalize(torch.randn(200, 3, generator=generator), dim=1)
    slopes = torch.randn(200, 3, generator=generator)
    given = (*(part.numpy() for part in (points, omega_r, panels, texture.corners)), texture.side)
    table = texture.coefficients.detach().numpy().reshape(-1, texture.n_harmonics, 3)
    light, by_table, by_means = np.empty((200, 3), np.float32), np.zeros_like(table), np.zeros((2, 3), np.float32)
    kernels.blend(*given, table, texture.means.detach().numpy(), light)
    kernels.blend_back(*given, light, slopes.numpy(), by_table, by_means)
    exact = texture.double()
    expected = exact(points.double().requires_grad_(), omega_r.double(), panels)
    (expected * slopes).sum().backward()
    found = (light, by_table.reshape(len(by_table), -1), by_means)
    truths = (expected.detach(), exact.coefficients.grad, exact.means.grad)
    for value, truth in zip(found, truths, strict=True):
        assert np.linalg.norm(value - truth.numpy()) < 1e-5 * np.linalg.norm(truth.numpy())
