"""The environment map: no seam, no pole, and the right pixel."""

import math

import pytest
import torch

from reconstruction.light.environment_map import EnvironmentMap, looked_up_reference, turns_and_rows

UP_DOWN = torch.tensor([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])


def filled(rows=16, seed=0):
    """A map with random texels."""
    made = EnvironmentMap(rows, 0.4)
    generator = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        for level in made.levels:
            level.copy_(torch.randn(level.shape, generator=generator))
    return made


def light(environment, directions):
    return environment(directions, directions)


def directions_at(heading_deg, elevation_deg):
    heading, elevation = torch.deg2rad(torch.as_tensor(heading_deg)), torch.deg2rad(torch.as_tensor(elevation_deg))
    parts = (heading.sin() * elevation.cos(), heading.cos() * elevation.cos(), elevation.sin())
    return torch.stack(torch.broadcast_tensors(*parts), dim=-1)


def test_a_new_map_gives_the_expected_light_everywhere():
    found = light(EnvironmentMap(16, 0.4), directions_at(torch.linspace(-180, 180, 50), 20.0))
    assert torch.allclose(found, torch.tensor(0.4))


def test_there_is_no_seam_at_the_back():
    for elevation in (-70.0, 0.0, 5.0, 88.0):
        across = directions_at(torch.tensor([180.0 - 1e-4, 180.0, -180.0 + 1e-4], dtype=torch.float64), elevation)
        found = light(filled(), across.float())
        assert (found.max(dim=0).values - found.min(dim=0).values).max() < 1e-4


@pytest.mark.slow
def test_poles_have_light_and_gradients_that_are_numbers():
    directions = torch.cat([UP_DOWN, UP_DOWN + torch.tensor([1e-8, 0.0, 0.0])]).requires_grad_()
    environment = filled()
    light(environment, directions).sum().backward()
    assert light(environment, directions).isfinite().all()
    assert directions.grad.isfinite().all()
    assert all(level.grad.isfinite().all() for level in environment.levels)


def test_headings_are_clockwise_from_north_and_rows_run_from_the_zenith():
    turns, rows = turns_and_rows(directions_at(torch.tensor([0.0, 90.0, -90.0, 45.0]), torch.tensor(30.0)))
    assert turns.tolist() == pytest.approx([0.0, 0.25, -0.25, 0.125], abs=1e-6)
    assert rows.tolist() == pytest.approx([1 / 3] * 4, abs=1e-6)
    assert turns_and_rows(UP_DOWN)[1].tolist() == pytest.approx([0.0, 1.0], abs=1e-6)
    assert turns_and_rows(UP_DOWN)[0].tolist() == [0.0, 0.0]


def test_in_the_middle_of_a_pixel_stands_its_value_and_between_two_their_mean():
    environment = EnvironmentMap(4, 0.5)
    texels = environment.levels[0]
    with torch.no_grad():
        texels[1 * 8 + 2] = 1.0
        texels[1 * 8 + 3] = 3.0
    headings = torch.tensor([2.5, 3.0, 3.5]) * 45.0
    found = torch.logit(light(environment, directions_at(headings, 90.0 - 1.5 * 45.0)))
    assert found[:, 0].tolist() == pytest.approx([1.0, 2.0, 3.0], abs=1e-4)


@pytest.mark.long
def test_gradients_are_those_of_finite_differences():
    environment = filled(8).double()
    directions = directions_at(torch.tensor([10.0, 100.0, -170.0, 33.0]), torch.tensor([5.0, -40.0, 60.0, 80.0]))
    assert torch.autograd.gradcheck(lambda d: environment(d, d), directions.double().requires_grad_())


def test_the_kernel_gives_what_plain_torch_gives_in_double_precision():
    generator = torch.Generator().manual_seed(5)
    rays = torch.nn.functional.normalize(torch.randn(5000, 3, generator=generator), dim=-1)
    south = torch.tensor([[0.0, -1.0, 0.0], [1e-4, -1.0, 0.0], [-1e-4, -1.0, 0.0], [1e-3, 0.0, 1.0]])
    rays, given = torch.cat([rays, UP_DOWN, south]), torch.randn(5006, 3, generator=generator)
    found, truth = filled(), filled().double()
    fast_rays, slow_rays = rays.clone().requires_grad_(), rays.double().requires_grad_()
    fast = found(fast_rays, fast_rays)
    slow = torch.sigmoid(truth.mean + looked_up_reference(slow_rays, list(truth.levels)))
    (fast * given).sum().backward()
    (slow * given).sum().backward()
    # 2e-6 was measured: of 32 columns, float32 knows a heading to 2e-6.
    assert float((fast - slow).detach().abs().max()) < 1e-5
    for one, other in zip(found.parameters(), truth.parameters(), strict=True):
        assert (one.grad - other.grad).norm() < 5e-6 * other.grad.norm()
    # Where a ray meets the border of two texels to the last digit, each precision takes another slope.
    is_close = (fast_rays.grad - slow_rays.grad).norm(dim=1) < 1e-3 * (1.0 + slow_rays.grad.norm(dim=1))
    assert float(is_close.double().mean()) > 0.998


def test_any_number_of_threads_gives_the_same_bits(monkeypatch):
    environment, found = filled(), []
    rays = torch.nn.functional.normalize(torch.randn(9000, 3, generator=torch.Generator().manual_seed(7)), dim=-1)
    for threads in (1, 3):
        monkeypatch.setattr("planning.base.jit.n_threads", lambda threads=threads: threads)
        moved = rays.clone().requires_grad_()
        seen = light(environment, moved)
        found.append([seen, *torch.autograd.grad(seen.square().sum(), [moved, *environment.parameters()])])
    assert all(torch.equal(one, many) for one, many in zip(*found, strict=True))


def test_only_what_is_asked_for_has_a_gradient():
    environment, rays = filled(), directions_at(torch.linspace(-170.0, 170.0, 9), 20.0)
    light(environment, rays).sum().backward()
    assert rays.grad is None
    assert all(bool(level.grad.any()) for level in environment.levels)
    for values in environment.parameters():
        values.requires_grad_(False)
    moved = rays.clone().requires_grad_()
    light(environment, moved).sum().backward()
    assert bool(moved.grad.any())


def test_levels_double_up_to_the_rows_asked_for():
    assert [math.isqrt(len(level) // 2) for level in EnvironmentMap(32, 0.5).levels] == [4, 8, 16, 32]
    for rows in (0, 2, 12):
        with pytest.raises(ValueError, match="power of 2"):
            EnvironmentMap(rows, 0.5)
