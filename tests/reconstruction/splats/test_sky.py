import pytest
import torch
from torch.nn.functional import normalize

from reconstruction.splats.sky import BRIGHTEST, Sky, behind_reference


def directions(*shape, seed=0):
    return normalize(torch.randn(*shape, 3, generator=torch.Generator().manual_seed(seed)), dim=-1)


def test_a_new_sky_is_even():
    assert torch.allclose(Sky(expected=0.3)(directions(20)), torch.full((20, 3), 0.3), atol=1e-6)


def test_a_sky_can_start_from_a_colour():
    sky = Sky()
    sky.start_from(torch.tensor([0.2, 0.5, 3.0]))
    assert torch.allclose(sky(directions(5)), torch.tensor([0.2, 0.5, 3.0]).repeat(5, 1), atol=1e-5)
    sky.start_from(torch.tensor([0.0, 1.0, 50.0]))
    assert torch.isfinite(sky(directions(5))).all()
    assert sky(directions(5)).max() <= BRIGHTEST


def test_only_what_splats_leave_open_shows_the_sky():
    alphas = torch.tensor([[1.0, 0.9999, 0.75, 0.0]], requires_grad=True)
    behind = Sky(expected=0.5).behind(directions(1, 4), alphas)
    assert torch.allclose(behind, torch.tensor([0.0, 0.0, 0.125, 0.5])[None, :, None].expand(1, 4, 3), atol=1e-6)
    behind.sum().backward()
    assert torch.allclose(alphas.grad, torch.tensor([[0.0, 0.0, -1.5, -1.5]]), atol=1e-5)


def test_nothing_is_behind_a_picture_that_is_full():
    alphas = torch.ones(2, 3, requires_grad=True)
    behind = Sky().behind(directions(2, 3), alphas)
    assert behind.shape == (2, 3, 3)
    assert (behind == 0.0).all()


def test_a_learned_sky_is_the_same_from_a_camera_that_was_not_learned_from():
    def truth(rays):
        return 0.4 + 0.3 * torch.stack([rays[:, 0], rays[:, 1], rays[:, 2]], dim=1)

    sky = Sky(rows=8)
    optimiser = torch.optim.Adam(sky.parameters(), lr=0.1)
    seen = directions(600, seed=1)
    for _ in range(50):
        optimiser.zero_grad()
        (sky(seen) - truth(seen)).abs().mean().backward()
        optimiser.step()
    unseen = directions(500, seed=2)
    assert (sky(unseen) - truth(unseen)).abs().mean() < 0.02


def textured(rows=16):
    sky = Sky(rows)
    generator = torch.Generator().manual_seed(3)
    with torch.no_grad():
        for level in sky.levels:
            level.normal_(generator=generator)
    return sky


def test_the_kernel_gives_what_plain_torch_gives_in_double_precision():
    sky, rays = textured(), directions(400)
    poles = torch.tensor([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1e-8, 0.0, 1.0]])
    rays = torch.cat([rays, poles])
    alphas = torch.linspace(0.0, 1.0, 404, requires_grad=True)
    given = torch.randn(404, 3, generator=torch.Generator().manual_seed(4))
    fast = sky.behind(rays[None], alphas[None])[0]
    fast_gradients = torch.autograd.grad(fast, [alphas, *sky.parameters()], given)
    slow_sky = textured().double()
    slow_alphas = alphas.detach().double().requires_grad_()
    slow = behind_reference(slow_sky.picture(), rays.double(), slow_alphas)
    slow_gradients = torch.autograd.grad(slow, [slow_alphas, *slow_sky.parameters()], given.double())
    assert torch.allclose(fast.double(), slow, atol=2e-5)
    for one, other in zip(fast_gradients, slow_gradients, strict=True):
        assert (one - other).norm() < 1e-5 * other.norm()


def test_any_number_of_threads_gives_the_same_bits(monkeypatch):
    sky, rays, found = textured(), directions(40, 50), []
    for threads in (1, 3):
        monkeypatch.setattr("planning.base.jit.n_threads", lambda threads=threads: threads)
        alphas = torch.rand(40, 50, generator=torch.Generator().manual_seed(6)).requires_grad_()
        light = sky.behind(rays, alphas)
        found.append([light, *torch.autograd.grad(light.square().sum(), [alphas, *sky.parameters()])])
    assert all(torch.equal(one, many) for one, many in zip(*found, strict=True))


def test_the_sky_has_no_seam_in_the_south_and_no_hole_at_the_poles():
    sky = textured()
    angle = torch.tensor([3.14155, -3.14155])
    south = torch.stack([torch.sin(angle), torch.cos(angle), torch.zeros(2)], dim=1)
    assert (sky(south).diff(dim=0)).abs().max() < 1e-3
    up = normalize(torch.tensor([[1e-7, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]), dim=1)
    assert torch.isfinite(sky(up)).all()
    assert torch.isfinite(sky.picture()).all()


def test_rows_that_cannot_be_halved_are_a_wrong_call():
    with pytest.raises(ValueError, match="power of 2 from 4 on, got 12"):
        Sky(rows=12)
