"""Radiance grids against their twin in double precision, and what a grid is for: near things where they are."""

import numpy as np
import pytest
import torch
from torch.nn.functional import normalize

from planning.base import jit
from reconstruction.light import radiance_grid
from reconstruction.light import radiance_grid as twin
from reconstruction.light.radiance_grid import CORNERS, GridBox, RadianceGrid

BOX = GridBox(0.3, (0.1, 0.2, 0.3), (1.0, 0.7, 0.5), (13, 9, 8), 0.5, 1.0)
DOUBLE = torch.float64


def grid_of(seed=0, box=BOX, is_empty_in_parts=True):
    """A grid of random light and density; a slab in its middle is empty, and passed over."""
    generator = torch.Generator().manual_seed(seed)
    grid = RadianceGrid(box, 0.3, 0, 8)
    with torch.no_grad():
        grid.cells += torch.randn(grid.cells.shape, generator=generator) * torch.tensor([0.1, 0.2, 0.2, 0.2])
        grid.far += 0.2 * torch.randn(grid.far.shape, generator=generator)
        if is_empty_in_parts:
            grid.cells[:, :, 2:9, 0] = -1.0
    grid.refresh()
    return grid


def rays(n, seed=1):
    generator = torch.Generator().manual_seed(seed)
    points = 0.5 * torch.randn(n, 3, generator=generator)
    return points, normalize(torch.randn(n, 3, generator=generator), dim=1)


def twin_light(grid, points, directions, cells, far):
    """In double precision, of a grid that is training."""
    starts = torch.frac(torch.arange(len(points)) * 0.6180339887).to(DOUBLE)
    numbers, times, steps = (torch.from_numpy(a).to(DOUBLE) for a in (grid.numbers, grid.times, grid.steps))
    return twin.march(
        grid.box.turned(points), grid.box.turned(directions), starts, cells, torch.from_numpy(grid.skips), far,
        numbers, times, steps, grid.unit,
    )[0]  # fmt: skip


def relative(found, expected):
    return float((found - expected).norm() / expected.norm())


@pytest.mark.parametrize("is_empty_in_parts", [True, False])
def test_light_and_all_gradients_are_those_of_the_twin(is_empty_in_parts):
    grid = grid_of(is_empty_in_parts=is_empty_in_parts)
    assert (grid.skips.max() > 0) == is_empty_in_parts
    points, directions = rays(60)
    weights = torch.randn(60, 3, generator=torch.Generator().manual_seed(2))
    own = [points.requires_grad_(), directions.requires_grad_(), grid.cells, grid.far]
    light = grid(points, directions)
    (light * weights).sum().backward()
    exact = [value.detach().to(DOUBLE).requires_grad_() for value in own]
    expected = twin_light(grid, *exact)
    (expected * weights).sum().backward()
    assert relative(light.detach(), expected.detach()) < 1e-6
    for value, truth in zip(own, exact, strict=True):
        assert relative(value.grad, truth.grad) < 1e-4


def test_passing_over_what_is_empty_changes_nothing_but_time():
    grid = grid_of()
    points, directions = rays(200)
    grid.eval()
    quick = grid(points, directions)
    grid.skips = np.minimum(grid.skips, 1)
    assert torch.equal(grid(points, directions), quick)


def test_the_number_of_threads_changes_no_bit(monkeypatch):
    found = []
    monkeypatch.setattr(radiance_grid, "FEW_RAYS", 50)
    for n_threads in (1, 3):
        monkeypatch.setattr(jit, "n_threads", lambda n=n_threads: n)
        grid = grid_of()
        points, directions = rays(101)
        light = grid(points.requires_grad_(), directions)
        (light.square().sum() + grid.roughness(0.1, 0.2, 0.3)).backward()
        found.append([light.detach(), grid.cells.grad, grid.far.grad, points.grad])
    assert all(torch.equal(a, b) for a, b in zip(*found, strict=True))


def gradients_of(n):
    grid = grid_of()
    own = [part.requires_grad_() for part in rays(n)]
    grid(*own).square().sum().backward()
    return [grid.cells.grad, grid.far.grad, *(part.grad for part in own)]


def test_rays_that_are_marched_again_on_the_way_back_have_the_same_gradients(monkeypatch):
    expected = gradients_of(101)
    monkeypatch.setattr(radiance_grid, "KEPT_RAYS", 30)
    assert all(torch.equal(a, b) for a, b in zip(gradients_of(101), expected, strict=True))


def test_of_many_rays_each_fourth_has_four_times_its_own_gradients(monkeypatch):
    expected = gradients_of(102)
    monkeypatch.setattr(radiance_grid, "MANY_MOVED", 100)
    *of_grid, of_points, of_directions = gradients_of(102)
    assert all(torch.equal(a, b) for a, b in zip(of_grid, expected[:2], strict=True))
    for found, truth in zip((of_points, of_directions), expected[2:], strict=True):
        assert torch.allclose(found[::4], 4.0 * truth[::4])
        assert not found[torch.arange(102) % 4 > 0].any()


def test_roughness_has_the_gradient_of_its_twin():
    grid = grid_of(is_empty_in_parts=False)
    grid.roughness(0.5, 0.25, 0.125).backward()
    exact = grid.cells.detach().to(DOUBLE).requires_grad_()
    amounts = torch.tensor([0.5, 0.25, 0.25, 0.25], dtype=DOUBLE)
    (twin.roughness(exact, amounts, torch.tensor(CORNERS, dtype=DOUBLE)) + 0.125 * exact[..., 0].sum()).backward()
    assert relative(grid.cells.grad, exact.grad) < 1e-5


def walled(at_y=0.6):
    """A wall in a level box, red to the east and blue to the west, before a green sky."""
    grid = RadianceGrid(GridBox(0.0, (0.0, 0.5, 0.0), (1.0, 0.5, 1.0), (41, 21, 41), 0.5, 1.0), 0.3, 0, 4)
    with torch.no_grad():
        grid.cells[..., 0] = -1.0
        y = (torch.linspace(-1.5, 1.5, 21) * 0.5) + 0.5
        grid.cells[:, y > at_y, :, 0] = 2.0
        x = torch.linspace(-1.5, 1.5, 41)
        grid.cells[..., 1:] = torch.where(
            x[:, None] > 0.0, torch.tensor([1.0, 0.0, 0.0]), torch.tensor([0.0, 0.0, 1.0])
        )
        grid.far[:] = torch.tensor([0.0, 1.0, 0.0])
    grid.refresh()
    return grid.eval()


def test_a_wall_is_seen_where_it_is_from_everywhere_and_far_light_where_nothing_is():
    grid = walled()
    places = torch.tensor([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]).repeat_interleave(2, dim=0)
    # Towards the wall's eastern and western half, from either side: directions alone would not tell them apart.
    aims = torch.tensor([[0.4, 0.6, 0.0], [-0.4, 0.6, 0.0]]).repeat(2, 1)
    light = grid(places, normalize(aims - places, dim=1))
    east, west = torch.tensor([1.0, 0.0, 0.0]), torch.tensor([0.0, 0.0, 1.0])
    assert torch.allclose(light, torch.stack([east, west, east, west]), atol=0.05)
    away = grid(torch.zeros(1, 3), torch.tensor([[0.0, -1.0, 0.0]]))
    assert torch.allclose(away, torch.tensor([[0.0, 1.0, 0.0]]), atol=0.05)


def test_growing_keeps_the_light():
    grid = RadianceGrid(GridBox(0.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (17, 17, 17), 0.5, 1.0), 0.3, 2, 32)
    smooth = torch.linspace(-1.0, 1.0, grid.cells.shape[2])
    with torch.no_grad():
        grid.cells[..., 0] += 0.05 * smooth
        grid.cells[..., 1] += 0.2 * smooth
        grid.far[..., 2] += 0.3 * torch.linspace(0.0, 1.0, len(grid.far))
    points, directions = rays(50)
    grid.eval()
    before = grid(points, directions)
    for _ in range(2):
        grid.grow()
    assert grid.cells.shape == (17, 17, 17, 4)
    assert grid.far.shape == (32, 32, 3)
    # What is sampled more finely is another sum.
    assert torch.allclose(grid(points, directions), before, atol=0.03)
    with pytest.raises(ValueError, match="as fine"):
        grid.grow()


def test_the_picture_of_far_light_has_no_seam():
    far = torch.rand(8, 8, 3, generator=torch.Generator().manual_seed(3), dtype=DOUBLE)
    x, y, z = (
        value.reshape(-1) for value in torch.meshgrid(*[torch.linspace(-1, 1, 7, dtype=DOUBLE)] * 3, indexing="ij")
    )
    around = normalize(torch.stack([x, y, z], dim=1)[(x.abs() + y.abs() + z.abs()) > 0.1], dim=1)
    step = 1e-6 * torch.randn(around.shape, generator=torch.Generator().manual_seed(4), dtype=DOUBLE)
    there = normalize(around + step, dim=1)
    assert (twin.far_light(far, around) - twin.far_light(far, there)).abs().max() < 1e-4


@pytest.mark.parametrize("scale", [0.0, 1.0, 100.0, 1e6])
def test_rays_from_anywhere_in_any_direction_have_finite_light_and_gradients(scale):
    grid = grid_of()
    axes = torch.cat([torch.eye(3), -torch.eye(3)])
    points = (scale * torch.tensor([0.3, -0.7, 0.2])).repeat(6, 1).requires_grad_()
    directions = axes.clone().requires_grad_()
    light = grid(points, directions)
    light.sum().backward()
    for value in (light, points.grad, directions.grad, grid.cells.grad, grid.far.grad):
        assert value.isfinite().all()


def test_grids_of_any_density_give_finite_light_and_gradients():
    for raw in (-1e6, -1.0, 0.0, 1.0, 1e6):
        grid = grid_of(is_empty_in_parts=False)
        with torch.no_grad():
            grid.cells[..., 0] = raw
        grid.refresh()
        points, directions = rays(20)
        grid(points, directions).sum().backward()
        assert grid.cells.grad.isfinite().all()


def test_rays_that_are_no_numbers_have_light_that_is_none_and_harm_no_other_ray():
    grid = grid_of()
    points, directions = rays(4)
    expected = grid(points, directions)[1:]
    points[0], directions[0] = float("nan"), float("nan")
    light = grid(points, directions)
    assert light[0].isnan().all()
    assert torch.equal(light[1:], expected)
    light.sum().backward()
    assert grid.cells.grad.shape == grid.cells.shape


def test_no_rays_have_no_light_and_move_nothing():
    grid, points = grid_of(), torch.zeros(0, 3, requires_grad=True)
    light = grid(points, torch.zeros(0, 3))
    assert light.shape == (0, 3)
    light.sum().backward()
    assert [bool(each.grad.any()) for each in (grid.cells, grid.far, points)] == [False] * 3


@pytest.mark.parametrize("side", [0, 3, 12])
def test_pictures_of_far_light_whose_size_cannot_be_doubled_are_refused(side):
    with pytest.raises(ValueError, match="power of 2"):
        RadianceGrid(BOX, 0.3, 0, side)


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a CUDA device")
def test_a_graphics_card_gives_the_same_light():
    grid = grid_of().eval()
    points, directions = rays(60)
    here = grid(points, directions)
    assert torch.allclose(grid.cuda()(points.cuda(), directions.cuda()).cpu(), here, atol=1e-4)


def test_distances_end_at_the_first_wall_and_nowhere_in_empty_space():
    grid = grid_of(is_empty_in_parts=False)
    with torch.no_grad():
        grid.cells[..., 0] = -1.0
        grid.cells[:, -1, :, 0] = 30.0 / radiance_grid.DENSITY_SCALE
    grid.refresh()
    # The last vertices along y, which the box turns: what is beyond its rim, and a cell before it.
    directions = grid.box.turned(torch.tensor([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]), back=True)
    points = torch.tensor([[0.1, 0.2, 0.3]]).expand(2, 3)
    towards, away = grid.distances(points, directions).tolist()
    assert np.isinf(away)
    assert 0.0 < towards < np.inf
    # All that comes from there is light of the wall, and from the other side what is far away.
    with torch.no_grad():
        grid.cells[..., 1:], grid.far[:] = 1.0, 0.0
        light = grid.eval()(points, directions)
    assert float(light[0].min()) > 0.9
    assert float(light[1].max()) < 0.1


def test_distances_are_where_the_march_lost_half_of_its_light():
    grid = grid_of(3).eval()
    points, directions = rays(200)
    found = grid.distances(points, directions).to(DOUBLE)
    times, steps = (torch.from_numpy(a).to(DOUBLE) for a in (grid.times, grid.steps))
    box, cells = torch.from_numpy(grid.numbers).to(DOUBLE), grid.cells.detach().to(DOUBLE)
    origins, along = grid.box.turned(points.to(DOUBLE)), grid.box.turned(directions.to(DOUBLE))
    places = origins[:, None] + (times + 0.5 * steps)[:, None] * along[:, None]
    inside = (places - box[:3]) * box[3:6]
    sizes = torch.tensor(cells.shape[2::-1], dtype=DOUBLE)
    corners = (twin.contracted(inside, box[6]) / (1.0 + box[6]) * 0.5 + 0.5) * (sizes - 1.0)
    density = twin.ramp(twin.DENSITY_SCALE * twin.interpolated(cells, corners)[..., 0]) * grid.unit * steps
    passed = torch.exp(-torch.cumsum(density, dim=1))
    for number in range(len(points)):
        nearer = passed[number][times + 0.5 * steps < found[number] - 1e-4]
        assert (nearer >= 0.5 - 1e-3).all()
        assert torch.isinf(found[number]) or float(passed[number][nearer.numel()]) <= 0.5 + 1e-3
