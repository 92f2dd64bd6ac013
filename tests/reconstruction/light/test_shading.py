"""Deferred shading against float64 and the formulas by hand; never NaN."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.light.shading import (
    display_from_linear,
    incidence_cosines,
    linear_from_display,
    reflected_directions,
    schlick,
    shade,
)


def units(n, seed):
    directions = torch.randn(n, 3, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
    return directions / directions.norm(dim=1, keepdim=True)


def shaded(omega_o, normals, diffuse, reflectivity, f0, light):
    return shade(diffuse, reflectivity, schlick(f0, incidence_cosines(omega_o, normals)), light)


def random_inputs(n, seed, dtype):
    generator = torch.Generator().manual_seed(seed)
    shares = [torch.rand(n, size, generator=generator, dtype=torch.float64) for size in (3, 1, 3, 3)]
    return [value.to(dtype) for value in (units(n, seed), units(n, seed + 1), *shares)]


def test_a_mirrored_ray_leaves_at_the_angle_it_came_on_the_other_side():
    omega_o, normals = units(500, 1), units(500, 2)
    found = reflected_directions(omega_o, normals)
    along = (found * normals).sum(dim=1)
    assert torch.allclose(along, -(omega_o * normals).sum(dim=1), atol=1e-14)
    assert torch.allclose(found - along[:, None] * normals, omega_o - (omega_o * normals).sum(1, True) * normals)
    assert torch.allclose(found.norm(dim=1), torch.ones(500, dtype=torch.float64))
    assert torch.equal(found, reflected_directions(omega_o, -normals))


def test_cosines_are_those_of_normals_turned_to_the_camera():
    omega_o, normals = units(500, 3), units(500, 4)
    cosines = incidence_cosines(omega_o, normals)
    turned = torch.where((omega_o * normals).sum(dim=1, keepdim=True) > 0.0, -normals, normals)
    assert torch.allclose(cosines, -(omega_o * turned).sum(dim=1))
    assert torch.equal(cosines, incidence_cosines(omega_o, -normals))
    assert ((cosines >= 0.0) & (cosines <= 1.0)).all()


def test_float32_follows_float64_in_values_and_gradients():
    short, long = (random_inputs(2000, 5, dtype) for dtype in (torch.float32, torch.float64))
    for inputs in (short, long):
        for value in inputs:
            value.requires_grad_()
    found, truth = shaded(*short), shaded(*long)
    assert (found.double() - truth).abs().max() < 1e-6
    (found**2).sum().backward()
    (truth**2).sum().backward()
    for ours, theirs in zip(short, long, strict=True):
        assert (ours.grad.double() - theirs.grad).abs().max() < 2e-5


def test_gradients_are_those_of_finite_differences():
    inputs = [value.requires_grad_() for value in random_inputs(6, 7, torch.float64)]
    assert torch.autograd.gradcheck(shaded, inputs)


@pytest.mark.parametrize("cosine", [-2.0, -1e-7, 0.0, 1e-30, 1.0, 1.0 + 1e-6, 3.0])
def test_at_grazing_angles_and_beyond_fresnel_stays_in_bounds_with_finite_gradients(cosine):
    f0 = torch.tensor([[0.0, 0.04, 1.0]], requires_grad=True)
    cosines = torch.tensor([cosine], requires_grad=True)
    found = schlick(f0, cosines)
    found.sum().backward()
    assert ((found >= f0) & (found <= 1.0)).all()
    assert f0.grad.isfinite().all()
    assert cosines.grad.isfinite().all()
    expected = 0.04 + 0.96 * (1.0 - min(max(cosine, 0.0), 1.0)) ** 5
    assert found[0, 1].item() == pytest.approx(expected, rel=1e-6)


def test_rays_in_the_surface_and_from_behind_give_finite_light_and_gradients():
    normals = torch.tensor([[0.0, 0.0, 1.0]] * 3, requires_grad=True)
    omega_o = torch.tensor([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8]], requires_grad=True)
    diffuse, reflectivity, f0, light = (torch.full((3, size), 0.5) for size in (3, 1, 3, 3))
    found = shaded(omega_o, normals, diffuse, reflectivity, f0, light)
    found.sum().backward()
    for value in (found, normals.grad, omega_o.grad):
        assert value.isfinite().all()
    assert found[0].tolist() == pytest.approx([0.25 + 0.5 * 1.0 * 0.5] * 3)


def test_without_reflectivity_there_is_only_diffuse_light_and_with_all_of_it_only_mirrored():
    diffuse, light, fresnel = (torch.rand(5, 3, generator=torch.Generator().manual_seed(k)) for k in range(3))
    assert torch.equal(shade(diffuse, torch.zeros(5, 1), fresnel, light), diffuse)
    assert torch.allclose(shade(diffuse, torch.ones(5, 1), fresnel, light), fresnel * light)


@given(st.floats(0.0, 1.0, width=32))
def test_display_values_and_linear_light_are_inverses(value):
    there = linear_from_display(torch.tensor([value], dtype=torch.float64))
    assert display_from_linear(there).item() == pytest.approx(value, abs=2e-8)


def test_the_display_curve_is_srgbs_and_has_a_gradient_everywhere():
    # IEC 61966-2-1: middle grey, 0.18 of white, is value 118 of 255.
    assert round(255 * display_from_linear(torch.tensor([0.18])).item()) == 118
    light = torch.tensor([-1.0, 0.0, 0.0031308, 0.5, 1.0, 4.0], requires_grad=True)
    found = display_from_linear(light)
    found.sum().backward()
    assert light.grad.isfinite().all()
    assert (light.grad[1:] > 0.0).all()
    assert found[-1] > 1.0
    assert found[0] == 0.0
    assert math.isclose(found[4].item(), 1.0, abs_tol=1e-6)
