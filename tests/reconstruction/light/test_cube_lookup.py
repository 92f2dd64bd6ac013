"""Lookups in cubes: kernel against twin, no seams, and numbers always."""

import itertools

import pytest
import torch

from reconstruction.light.cube_lookup import FACES, Levels, averaged, looked_up_reference, texel_directions

SIDES = (8, 4, 2)


def random(*shape, seed=0, dtype=torch.float32):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed), dtype=torch.float64).to(dtype)


def texels(channels=3, seed=0, dtype=torch.float32):
    """Levels with borders, all of them of one random finest cube."""
    return averaged(SIDES[0], SIDES[-1])(random(FACES * SIDES[0] ** 2, channels, seed=seed, dtype=dtype))


def rays(n, seed=1, dtype=torch.float32):
    return torch.nn.functional.normalize(random(n, 3, seed=seed, dtype=torch.float64), dim=-1).to(dtype)


@pytest.mark.parametrize("channels", [3, 16])
def test_the_kernel_gives_what_plain_torch_gives_in_double_precision(channels):
    where, given = Levels(SIDES), random(4000, channels, seed=3)
    levels = 2.4 * torch.rand(4000, generator=torch.Generator().manual_seed(4)) - 0.2
    fast = [rays(4000), levels, texels(channels)]
    slow = [each.double() for each in fast]
    fast, slow = ([each.clone().requires_grad_() for each in group] for group in (fast, slow))
    found, truth = where.look_up(*fast), looked_up_reference(*slow, where)
    assert float((found - truth).detach().abs().max()) < 5e-6
    (found * given).sum().backward()
    (truth * given.double()).sum().backward()
    assert (fast[2].grad - slow[2].grad).norm() < 1e-6 * slow[2].grad.norm()
    for one, other in zip(fast[:2], slow[:2], strict=True):
        # Where a ray meets the border of two texels to the last digit, each precision takes another slope.
        is_close = (one.grad - other.grad).abs() < 1e-4 * (1.0 + other.grad.abs())
        assert float(is_close.double().mean()) > 0.998


@pytest.mark.slow
def test_gradients_are_those_of_finite_differences():
    where = Levels((2, 1))
    levels = torch.tensor([0.3, 0.2, 0.7, 0.6], dtype=torch.float64).requires_grad_()
    asked = rays(4, seed=6, dtype=torch.float64).requires_grad_()
    table = random(where.n_texels, 2, dtype=torch.float64).requires_grad_()
    assert torch.autograd.gradcheck(lambda *each: looked_up_reference(*each, where), (asked, levels, table))


def test_there_is_no_seam_across_edges_and_in_corners():
    where, table, step = Levels(SIDES), texels(), 1e-6
    edges = [
        torch.tensor([a, b, c]) for a, b, c in itertools.product((-1.0, 1.0, -0.71, 0.13, 0.98), repeat=3)
        if sum(abs(each) == 1.0 for each in (a, b, c)) >= 2
    ]  # fmt: skip
    at = torch.stack(edges).double()
    around = torch.tensor(list(itertools.product((-step, 0.0, step), repeat=3)), dtype=torch.float64)
    asked = (at[:, None, :] + around).reshape(-1, 3)
    assert len(edges) == 12 * 3 + 8
    for level in (0.0, 0.5, 2.0):
        levels = torch.full((len(asked),), level)
        for found in (
            where.look_up(asked.float(), levels, table),
            looked_up_reference(asked, levels.double(), table.double(), where),
        ):
            spread = found.reshape(len(edges), len(around), 3)
            assert float((spread.amax(dim=1) - spread.amin(dim=1)).max()) < 1e-4


def test_in_the_middle_of_a_texel_stands_its_value():
    where = Levels(SIDES)
    values = random(FACES * 64, 3, seed=8)
    table = averaged(8, 2)(values)
    middle = torch.from_numpy(texel_directions(8)).float()
    assert torch.allclose(where.look_up(middle, torch.zeros(len(middle)), table), values, atol=1e-5)


def test_levels_beyond_the_ends_are_the_ends_without_a_slope():
    where, table, asked = Levels(SIDES), texels(), rays(6)
    levels = torch.tensor([-3.0, -1e-7, 0.0, 2.0, 2.1, 50.0], requires_grad=True)
    found = where.look_up(asked, levels, table)
    ends = torch.tensor([0.0, 0.0, 0.0, 2.0, 2.0, 2.0])
    assert torch.equal(found.detach(), where.look_up(asked, ends, table))
    (slopes,) = torch.autograd.grad(found.square().sum(), levels)
    assert (slopes != 0.0).tolist() == [False, False, True, True, False, False]


def test_a_single_level_is_asked_at_any_roughness():
    where = Levels((4,))
    table = random(where.n_texels, 3)
    asked, levels = rays(5), torch.tensor([0.0, 0.4, 1.0, 7.0, -2.0], requires_grad=True)
    fast = where.look_up(asked, levels, table)
    assert torch.allclose(fast, looked_up_reference(asked, levels, table, where), atol=1e-6)
    assert torch.equal(torch.autograd.grad(fast.sum(), levels)[0], torch.zeros(5))


def test_directions_of_no_length_and_huge_ones_are_numbers_with_numbers_for_gradients():
    where, table = Levels(SIDES), texels()
    asked = torch.tensor([[0.0, 0.0, 0.0], [1e-30, 0.0, 0.0], [1e18, -1e18, 3.0], [0.0, -0.0, -1.0], [1.0, 1.0, 1.0],
                          [1e-10, 1e-12, 0.0], [1e30, 0.0, 0.0]])  # fmt: skip
    for dtype in (torch.float32, torch.float64):
        moved = asked.to(dtype).requires_grad_()
        levels = torch.full((len(asked),), 0.5, dtype=dtype, requires_grad=True)
        found = where.look_up(moved, levels, table.to(dtype).requires_grad_())
        slopes = torch.autograd.grad(found.square().sum(), [moved, levels])
        assert found.isfinite().all()
        assert all(each.isfinite().all() for each in slopes)
        assert torch.equal(slopes[0][0], torch.zeros(3, dtype=dtype))


def test_what_is_no_number_is_asked_nowhere_else():
    """Texels outside the cube would be other memory."""
    where, table, nan = Levels(SIDES), texels().requires_grad_(), float("nan")
    asked = torch.tensor([[nan, 0.0, 1.0], [1.0, nan, 0.0], [0.5, 1.0, nan], [nan, nan, nan], [float("inf"), 1.0, 0.0]])
    for levels in (torch.zeros(5), torch.full((5,), nan)):
        found = where.look_up(asked, levels, table)
        found.sum().backward()
        assert found.isfinite().all()
        assert table.grad.isfinite().all()


def test_any_number_of_threads_gives_the_same_bits(monkeypatch):
    where, found = Levels(SIDES), []
    asked, levels, table = rays(9000), 2.0 * torch.rand(9000, generator=torch.Generator().manual_seed(5)), texels()
    for threads in (1, 3):
        monkeypatch.setattr("planning.base.jit.n_threads", lambda threads=threads: threads)
        moved = [each.clone().requires_grad_() for each in (asked, levels, table.detach())]
        seen = where.look_up(*moved)
        found.append([seen, *torch.autograd.grad(seen.square().sum(), moved)])
    assert all(torch.equal(one, many) for one, many in zip(*found, strict=True))


def test_no_rays_are_no_light():
    where, table = Levels(SIDES), texels().detach().requires_grad_()
    found = where.look_up(torch.zeros(0, 3), torch.zeros(0), table)
    found.sum().backward()
    assert found.shape == (0, 3)
    assert torch.equal(table.grad, torch.zeros_like(table))
