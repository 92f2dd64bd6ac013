"""Huber's function of errors, which a radiance grid makes small."""

import pytest
import torch

from reconstruction.light.config import ReflectionConfig
from reconstruction.light.losses import no_brighter, ray_errors


def test_errors_are_absolute_ones_where_none_is_squared():
    found, truth = torch.tensor([[0.5, 0.2, 0.9]]), torch.tensor([[0.4, 0.4, 0.9]])
    assert ray_errors(found, truth).item() == pytest.approx(0.3)


def test_small_errors_count_by_their_squares_and_large_ones_by_their_size_without_a_step_or_a_kink():
    errors = torch.linspace(-0.3, 0.3, 601, dtype=torch.float64)
    found = torch.stack([errors, *[torch.zeros_like(errors)] * 2], dim=1).requires_grad_()
    total = ray_errors(found, torch.zeros_like(found), 0.1)
    total.sum().backward()
    small, size = errors.abs() < 0.1, errors.abs()
    assert torch.allclose(total[small], 0.5 * errors[small] ** 2 / 0.1)
    assert torch.allclose(total[~small], size[~small] - 0.05)
    # The slope is that of the plain error from there on, so that rates and weights mean the same.
    assert torch.allclose(found.grad[:, 0], (errors / 0.1).clamp(-1.0, 1.0))


def test_a_radiance_grid_has_a_loss_and_passes_of_its_own():
    config = ReflectionConfig()
    assert config.squared_to == 0.0
    assert config.for_grid.squared_to == config.grid.squared_to > 0.0
    assert config.for_grid.passes == config.grid.passes > config.passes
    assert ReflectionConfig(passes=60.0).for_grid.passes == 60.0


def test_where_a_photo_is_overexposed_only_darker_light_is_an_error():
    truth = torch.tensor([1.0, 0.99, 0.5, 1.0, 0.99])
    found = torch.tensor([1.3, 1.1, 0.9, 0.8, 0.8], requires_grad=True)
    seen = no_brighter(found, truth, 250.0 / 255.0)
    torch.testing.assert_close(seen, torch.tensor([1.0, 0.99, 0.9, 0.8, 0.8]))
    seen.sum().backward()
    assert found.grad.tolist() == [0.0, 0.0, 1.0, 1.0, 1.0]
    assert no_brighter(found, truth).tolist() == pytest.approx([1.0, 1.1, 0.9, 0.8, 0.8])
