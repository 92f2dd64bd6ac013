import numpy as np
import pytest
import torch

from reconstruction.light.harmonics import n_harmonics
from reconstruction.light.shading import display_from_linear
from reconstruction.splats.harmonic_colour import (
    AT_ONCE,
    display_colours,
    display_colours_reference,
    flat_harmonics,
    light_of_display,
    seen_light,
)

EYE = torch.tensor([0.3, -4.0, 1.0])


def random_case(n, dtype=torch.float32):
    generator = torch.Generator().manual_seed(n)
    means = torch.randn(n, 3, generator=generator).to(dtype).requires_grad_()
    sh = torch.randn(n, 16, 3, generator=generator).to(dtype).requires_grad_()
    return means, sh, torch.randn(n, 3, generator=generator).to(dtype)


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_the_kernel_gives_what_plain_torch_gives_in_double_precision(degree):
    means, sh, given = random_case(300)
    slow_means, slow_sh = (value.detach().double().requires_grad_() for value in (means, sh))
    fast, slow = display_colours(means, sh, EYE, degree), display_colours_reference(slow_means, slow_sh, EYE, degree)
    assert torch.allclose(fast.double(), slow, atol=1e-5)
    of_means, of_sh = torch.autograd.grad(fast, (means, sh), given)
    slow_of_means, slow_of_sh = torch.autograd.grad(slow, (slow_means, slow_sh), given.double())
    assert (of_means - slow_of_means).norm() <= 1e-5 * (1.0 + slow_of_means.norm())
    assert (of_sh - slow_of_sh).norm() <= 1e-6 * slow_of_sh.norm()


@pytest.mark.parametrize("degree", [0, 3])
def test_light_by_the_kernel_is_that_of_plain_torch_below_black_and_above_white(degree):
    means, sh, given = random_case(300)
    slow_means, slow_sh = (value.detach().double().requires_grad_() for value in (means, sh))
    fast, slow = seen_light(means, sh, EYE, degree), seen_light(slow_means, slow_sh, EYE, degree)
    assert (slow == 0.0).any()
    assert (slow > 1.0).any()
    assert torch.allclose(fast.double(), slow, atol=1e-5)
    of_means, of_sh = torch.autograd.grad(fast, (means, sh), given)
    slow_of_means, slow_of_sh = torch.autograd.grad(slow, (slow_means, slow_sh), given.double())
    assert (of_means - slow_of_means).norm() <= 1e-5 * (1.0 + slow_of_means.norm())
    assert (of_sh - slow_of_sh).norm() <= 1e-5 * slow_of_sh.norm()


def test_light_by_the_kernel_has_no_step_where_its_curve_changes():
    display = torch.cat([torch.linspace(-0.1, 0.1, 4001), torch.linspace(0.9, 1.1, 4001)])
    sh = flat_harmonics(display[:, None].expand(-1, 3)).requires_grad_()
    light = seen_light(torch.zeros(len(display), 3), sh, EYE, 0)
    (slopes,) = torch.autograd.grad(light.sum(), sh)
    assert torch.allclose(light[:, 0], light_of_display(display), atol=1e-6)
    assert (light[:, 0].diff()[:4000] >= 0.0).all()
    assert torch.isfinite(slopes).all()
    assert slopes.min() >= 0.0


def test_gradients_of_the_twin_are_those_of_differences():
    means, sh, _ = random_case(4, torch.float64)
    assert torch.autograd.gradcheck(lambda a, b: display_colours_reference(a, b, EYE, 3), (means, sh))


def test_harmonics_that_are_not_used_yet_get_no_gradient():
    means, sh, given = random_case(50)
    (of_sh,) = torch.autograd.grad(display_colours(means, sh, EYE, 1), (sh,), given)
    assert of_sh[:, :4].abs().min() > 0.0
    assert (of_sh[:, 4:] == 0.0).all()


def test_pieces_of_work_leave_no_seam():
    means, sh, given = random_case(AT_ONCE + 3)
    colours = display_colours(means, sh, EYE, 3)
    of_means, _ = torch.autograd.grad(colours, (means, sh), given)
    tail = slice(AT_ONCE - 2, AT_ONCE + 3)
    part = means.detach()[tail].requires_grad_()
    alone = display_colours(part, sh.detach()[tail].requires_grad_(), EYE, 3)
    (of_part,) = torch.autograd.grad(alone, (part,), given[tail])
    assert torch.equal(colours[tail], alone)
    assert torch.equal(of_means[tail], of_part)


def test_a_camera_inside_a_splat_does_no_harm():
    means = torch.stack([EYE, EYE + 1e-9]).requires_grad_()
    sh = torch.ones(2, 16, 3, requires_grad=True)
    display_colours(means, sh, EYE, 3).sum().backward()
    assert torch.isfinite(means.grad).all()
    assert torch.isfinite(sh.grad).all()


def test_no_splats_have_no_colours():
    assert display_colours(torch.zeros(0, 3), torch.zeros(0, 16, 3), EYE, 3).shape == (0, 3)


def test_flat_harmonics_show_their_colour_to_all_sides():
    display = torch.tensor([[0.2, 0.5, 0.9]])
    for eye in ((5.0, 0.0, 0.0), (0.0, -3.0, 2.0)):
        found = display_colours(torch.zeros(1, 3), flat_harmonics(display), torch.tensor(eye), 3)
        assert torch.allclose(found, display, atol=1e-6)


def test_light_of_display_undoes_the_display_curve_below_and_above_white():
    light = torch.tensor([0.0, 1e-4, 0.0031308, 0.02, 0.5, 1.0, 3.0], dtype=torch.float64)
    assert torch.allclose(light_of_display(display_from_linear(light)), light, atol=1e-7)


def test_light_is_never_negative_and_its_slope_is_finite_everywhere():
    display = torch.linspace(-2.0, 3.0, 1001, dtype=torch.float64, requires_grad=True)
    light = light_of_display(display)
    (slopes,) = torch.autograd.grad(light.sum(), display)
    assert light.min() == 0.0
    assert (light.diff() >= 0.0).all()
    assert torch.isfinite(slopes).all()
    assert slopes[display > 0.0].min() > 0.0


def test_an_unknown_degree_is_a_wrong_call():
    with pytest.raises(ValueError, match="0 to 3, got 4"):
        display_colours(torch.zeros(1, 3), torch.zeros(1, 16, 3), EYE, 4)


def test_every_degree_adds_its_own_harmonics():
    assert np.array_equal([n_harmonics(degree) for degree in range(4)], [1, 4, 9, 16])
