"""Colours of panes in one go, against deferred shading in plain torch and double precision."""

import torch

from reconstruction.light.reflective_panels import pane_colours
from reconstruction.light.shading import display_from_linear, schlick, shade

N, PANES = 300, 7


def case():
    """c, light, cosines, logits of R and F0, corner loss; then panes, factors and distances off the axis."""
    generator = torch.Generator().manual_seed(0)
    uniform = [torch.rand(shape, generator=generator) for shape in ((N, 3), (N, 3), (N,), (N,), (N,))]
    diffuse, light, cosines, factors, off_axis = uniform
    # From what is as dark as the straight part of sRGB's curve to what is overexposed.
    strength = torch.logspace(-4, 1, N)[:, None]
    cosines[:3] = torch.tensor([0.0, 1.0, 1e-4])
    logits = torch.randn(PANES, 1, generator=generator), torch.randn(PANES, 3, generator=generator)
    panels = torch.randint(PANES, (N,), generator=generator)
    learned = [strength * diffuse, strength * light, cosines, *logits, torch.tensor(0.3)]
    return [value.requires_grad_() for value in learned], (panels, 0.5 + factors, off_axis)


def plain(diffuse, light, cosines, reflectivity, base, corner_loss, panels, factors, off_axis):
    kept = 1.0 - torch.clamp(corner_loss * off_axis, max=0.9)[:, None]
    fresnel = schlick(torch.sigmoid(base)[panels], cosines)
    return display_from_linear(
        factors[:, None] * kept * shade(diffuse, torch.sigmoid(reflectivity)[panels], fresnel, light)
    )


def test_colours_and_all_gradients_are_those_of_deferred_shading():
    learned, fixed = case()
    weights = torch.randn(N, 3, generator=torch.Generator().manual_seed(1))
    found = pane_colours(*learned, *fixed)
    (found * weights).sum().backward()
    exact = [value.detach().double().requires_grad_() for value in learned]
    expected = plain(*exact, *fixed)
    (expected * weights).sum().backward()
    assert (found - expected).abs().max() < 1e-6 * expected.max()
    for value, truth in zip(learned, exact, strict=True):
        assert (value.grad - truth.grad).norm() < 1e-5 * truth.grad.norm()


def test_corners_of_a_picture_lose_nine_tenths_at_most_and_no_gradient_beyond():
    learned, fixed = case()
    learned[5] = torch.tensor(100.0, requires_grad=True)
    found = pane_colours(*learned, *fixed)
    assert torch.allclose(found, plain(*learned, *fixed), atol=1e-5)
    found[fixed[2] > 0.1].sum().backward()
    assert learned[5].grad == 0.0


def test_no_rays_have_no_colours():
    learned, fixed = case()
    none = [value[:0] for value in (*learned[:3],)]
    assert pane_colours(*none, *learned[3:], *(value[:0] for value in fixed)).shape == (0, 3)
