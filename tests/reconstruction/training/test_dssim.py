"""Structural dissimilarity: the score it is one less of, a twin in double precision, gradients, and hard cases."""

import math

import numpy as np
import pytest
import torch

from reconstruction.metrics.image_metrics import score_picture
from reconstruction.training import losses
from reconstruction.training.losses import dssim, dssim_torch


def pictures(height=15, width=18, channels=3, seed=0, dtype=torch.float32):
    made = torch.rand(2, height, width, channels, generator=torch.Generator().manual_seed(seed), dtype=dtype)
    return made[0].requires_grad_(), made[1]


def test_it_is_one_less_the_score():
    found, truth = pictures()
    ssim = score_picture(found.detach().numpy(), truth.numpy()).ssim
    assert dssim(found, truth).item() == pytest.approx(1.0 - ssim, abs=1e-6)
    assert dssim(found.detach(), truth).item() == dssim(found, truth).item()
    assert dssim(truth, truth).item() == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize(("height", "width", "channels"), [(11, 11, 3), (13, 40, 1), (40, 13, 3)])
def test_value_and_gradient_are_those_of_a_twin_in_double_precision(height, width, channels):
    found, truth = pictures(height, width, channels)
    twin = found.detach().double().requires_grad_()
    expected = dssim_torch(twin, truth.double())
    expected.backward()
    value = dssim(found, truth)
    (3.0 * value).backward()
    assert value.dtype == torch.float32
    assert value.item() == pytest.approx(expected.item(), abs=1e-6)
    assert torch.allclose(found.grad.double(), 3.0 * twin.grad, rtol=1e-5, atol=1e-6 * float(twin.grad.abs().max()))


def test_the_gradient_is_that_of_finite_differences():
    found, truth = pictures(12, 11, 2, dtype=torch.float64)
    assert torch.autograd.gradcheck(lambda a: dssim(a, truth), (found,))


def test_bands_do_not_change_a_bit(monkeypatch):
    found, truth = pictures(33, 14)
    dssim(found, truth).backward()
    value, gradient = dssim(found, truth).item(), found.grad.clone()
    monkeypatch.setattr(losses, "BAND_ROWS", 5)
    found.grad = None
    again = dssim(found, truth)
    again.backward()
    assert again.item() == value
    assert torch.equal(found.grad, gradient)


@pytest.mark.parametrize("level", [0.0, 1e-30, 1e-3, 1.0 / 3.0, 1.0])
def test_flat_windows_are_equal_and_pull_nowhere(level):
    found = torch.full((14, 14, 3), level, requires_grad=True)
    value = dssim(found, torch.full((14, 14, 3), level))
    value.backward()
    assert value.item() == pytest.approx(0.0, abs=1e-9)
    assert float(found.grad.abs().max()) < 1e-9


@pytest.mark.parametrize("size", [1e4, 1e9, 1e18])
def test_light_far_too_bright_stays_finite_and_within_bounds(size):
    found, truth = pictures()
    found = (found.detach() * size).requires_grad_()
    value = dssim(found, truth)
    value.backward()
    assert 0.0 <= value.item() <= 2.0
    assert bool(torch.isfinite(found.grad).all())
    flat = torch.full((14, 14, 3), size)
    assert 0.0 <= dssim(flat, truth[:14, :14]).item() <= 2.0


def test_numbers_that_are_none_are_not_hidden():
    found, truth = pictures()
    found = found.detach().clone()
    found[3, 3, 0] = math.nan
    assert math.isnan(dssim(found, truth).item())


def test_following_the_gradient_makes_pictures_alike():
    found, truth = pictures(24, 24)
    before = dssim(found, truth).item()
    for step in range(200):
        found.grad = None
        dssim(found, truth).backward()
        found.data -= 0.03 * 0.98**step * found.grad.sign()
    assert dssim(found, truth).item() < 0.1 * before
    assert score_picture(found.detach().numpy(), truth.numpy()).psnr_db > 20.0


def test_pictures_that_are_views_of_others_are_understood():
    _, truth = pictures(16, 16)
    large = torch.rand(20, 20, 4, generator=torch.Generator().manual_seed(5), requires_grad=True)
    dssim(large[2:18, 1:17, :3], truth).backward()
    assert float(large.grad[..., 3].abs().max()) == 0.0
    assert float(large.grad[2:18, 1:17, :3].abs().max()) > 0.0


def test_pictures_smaller_than_a_window_are_not_compared():
    found, truth = pictures(10, 30)
    value = dssim(found, truth)
    value.backward()
    assert value.item() == 0.0
    assert float(found.grad.abs().max()) == 0.0


def test_wrong_calls_are_refused():
    found, truth = pictures()
    for a, b, words in (
        (found, truth[:12], "one shape"),
        (found.double(), truth, "float32 or float64"),
        (truth, found, "gradients reach"),
    ):
        with pytest.raises(ValueError, match=words):
            dssim(a, b)


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs CUDA")
def test_cuda_finds_what_the_processor_does():
    found, truth = pictures()
    dssim(found, truth).backward()
    there = found.detach().cuda().requires_grad_()
    value = dssim(there, truth.cuda())
    value.backward()
    assert value.item() == pytest.approx(dssim(found, truth).item(), abs=1e-5)
    assert np.allclose(there.grad.cpu(), found.grad, rtol=1e-3, atol=1e-6)
