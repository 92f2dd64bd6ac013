from __future__ import annotations

import torch

from reconstruction.splats.rasterising.projection import rotations
from reconstruction.splats.splats import flattened, shortest_axes
from tests.reconstruction.splats.drawn_splats import seeded


def test_shortest_axes_are_unit_and_face_the_camera() -> None:
    g = seeded(1)
    means, quats = (torch.randn(50, k, generator=g, dtype=torch.float64) for k in (3, 4))
    log_scales = torch.randn(50, 3, generator=g, dtype=torch.float64)
    eye = torch.tensor([0.5, -2.0, 1.0])
    normals = shortest_axes(means, quats, log_scales, eye)
    torch.testing.assert_close(normals.norm(dim=1), torch.ones(50, dtype=torch.float64))
    assert ((normals * (means - eye)).sum(dim=1) <= 0.0).all()
    turned = rotations(quats)
    precision = turned @ torch.diag_embed(torch.exp(-2.0 * log_scales)) @ turned.transpose(1, 2)
    largest = torch.linalg.eigh(precision).eigenvectors[:, :, -1]
    torch.testing.assert_close((normals * largest).sum(dim=1).abs(), torch.ones(50, dtype=torch.float64))


def test_shortest_axes_have_gradients_also_where_two_are_equal() -> None:
    g = seeded(2)
    means, quats = (torch.randn(6, k, generator=g, dtype=torch.float64) for k in (3, 4))
    eye = torch.zeros(3)
    apart = torch.tensor([[0.0, 1.0, 2.0], [3.0, -1.0, 0.0], [1.0, 1.0, 0.0]], dtype=torch.float64).repeat(2, 1)
    quats.requires_grad_()
    assert torch.autograd.gradcheck(lambda q: shortest_axes(means, q, apart, eye), quats)
    equal = torch.zeros(6, 3, dtype=torch.float64, requires_grad=True)
    normals = shortest_axes(means, quats, equal, eye)
    torch.testing.assert_close(normals.abs(), rotations(quats)[..., 0].abs())
    normals.sum().backward()
    assert quats.grad is not None
    assert quats.grad.isfinite().all()
    assert quats.grad.any()
    zero = shortest_axes(means, torch.zeros(6, 4, dtype=torch.float64, requires_grad=True), apart, eye)
    zero.sum().backward()
    torch.testing.assert_close(zero.norm(dim=1), torch.ones(6, dtype=torch.float64))
    assert shortest_axes(means[:0], quats[:0], apart[:0], eye).shape == (0, 3)


def test_flattened_ellipsoids_keep_their_longer_axes_and_the_shortest_is_the_normal() -> None:
    g = seeded(3)
    quats = torch.randn(60, 4, generator=g, dtype=torch.float64)
    log_scales = torch.randn(60, 3, generator=g, dtype=torch.float64)
    turned, sizes = flattened(quats, log_scales)
    axes, found, shortest = rotations(quats), rotations(turned), log_scales.argmin(dim=1)
    assert sorted(shortest.unique().tolist()) == [0, 1, 2]
    for i, k in enumerate(shortest.tolist()):
        order = [(k + 1) % 3, (k + 2) % 3, k]
        torch.testing.assert_close(found[i], axes[i][:, order])
        assert torch.equal(sizes[i], log_scales[i, order[:2]])
        assert float(sizes[i].min()) >= float(log_scales[i, k])
    assert flattened(quats[:0], log_scales[:0])[1].shape == (0, 2)
