"""Fourier features in float32 against 50 digits, where the plain sine fails."""

import math

import mpmath
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.light.reflection_mlp import MAX_ORDER, fourier_features, n_features

BOUND = 5e-7
"""Rounding of 2 pi h to float32, 1.2e-7 of at most pi, and of a sine."""


def exact(value, order):
    """Sines and cosines of 2^k pi times a float32, k = 0 to order - 1, each shape (order,)."""
    with mpmath.workdps(50):
        angles = [mpmath.mpf(float(value)) * 2**k * mpmath.pi for k in range(order)]
        return np.array([[float(f(angle)) for angle in angles] for f in (mpmath.sin, mpmath.cos)])


@given(st.floats(-1.0, 1.0, width=32))
def test_every_order_up_to_16_is_exact_to_the_rounding_of_float32(value):
    found = fourier_features(torch.tensor([[value]]), 16).reshape(16, 2).T.double().numpy()
    assert np.abs(found - exact(value, 16)).max() < BOUND


def test_the_plain_sine_misses_that_bound_from_order_8_on():
    values = torch.rand(2000, 1, generator=torch.Generator().manual_seed(1)) * 2.0 - 1.0
    for order, least in ((8, 1e-5), (12, 1e-4), (16, 1e-3)):
        scale = 2.0 ** (order - 1)
        truth = torch.sin(scale * math.pi * values.double())
        plain = torch.sin((scale * math.pi) * values)
        ours = fourier_features(values, order).reshape(-1, order, 2)[:, -1, :1]
        assert (plain.double() - truth).abs().max() > least > 20 * BOUND
        assert (ours.double() - truth).abs().max() < BOUND + 2.0**order * 1e-16


@pytest.mark.parametrize("order", [1, 4, 12, 16])
def test_gradients_are_those_of_the_sines_in_float64(order):
    values = torch.rand(200, 3, generator=torch.Generator().manual_seed(2)) * 2.0 - 1.0
    weights = torch.randn(200, n_features(3, order), generator=torch.Generator().manual_seed(3))
    ours = values.clone().requires_grad_()
    (fourier_features(ours, order) * weights).sum().backward()
    twin = values.double().requires_grad_()
    angles = twin[:, None, :] * (math.pi * 2.0 ** torch.arange(order, dtype=torch.float64))[:, None]
    features = torch.stack([angles.sin(), angles.cos()], dim=2).reshape(200, -1)
    (features * weights.double()).sum().backward()
    assert (ours.grad.double() - twin.grad).abs().max() < 3e-6 * math.pi * 2.0**order


def test_whole_periods_give_exactly_0_and_1():
    found = fourier_features(torch.tensor([[-1.0], [0.0], [1.0]]), 12).reshape(3, 12, 2)
    assert (found[:, 1:, 0] == 0.0).all()
    assert (found[:, 1:, 1] == 1.0).all()


def test_columns_are_sines_then_cosines_of_all_channels_by_frequency():
    values = torch.tensor([[0.1, 0.2, 0.3]])
    found = fourier_features(values, 2)[0]
    angles = torch.tensor([0.1, 0.2, 0.3]) * math.pi
    expected = torch.cat([angles.sin(), angles.cos(), (2 * angles).sin(), (2 * angles).cos()])
    assert torch.allclose(found, expected, atol=1e-6)
    assert found.shape == (n_features(3, 2),)


def test_no_frequency_is_no_column_and_no_row_is_no_row():
    assert fourier_features(torch.zeros(4, 3), 0).shape == (4, 0)
    assert fourier_features(torch.zeros(0, 3), 5).shape == (0, 30)


@pytest.mark.parametrize("dtype", [torch.float16, torch.bfloat16, torch.int64])
def test_other_numbers_than_float32_and_float64_are_refused(dtype):
    with pytest.raises(TypeError, match="float32"):
        fourier_features(torch.zeros(1, 3).to(dtype), 4)


def test_wrong_shapes_and_orders_are_refused():
    with pytest.raises(ValueError, match="shape"):
        fourier_features(torch.zeros(3), 4)
    for order in (-1, MAX_ORDER + 1):
        with pytest.raises(ValueError, match="order"):
            fourier_features(torch.zeros(1, 3), order)
