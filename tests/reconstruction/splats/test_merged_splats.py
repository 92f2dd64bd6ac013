import numpy as np
import pytest
import torch

from reconstruction.light.shading import display_from_linear, linear_from_display
from reconstruction.splats.merged_splats import FEWEST, MOST_LARGER, MOST_OPAQUE, splats_of_detail
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import FEATURES, Splats
from reconstruction.training.config import ANTIALIASED

N = 40_000
FORWARD = (0.0, 1.0, 0.0)


def wall(n=N, opacity=0.8, glass=False, n_sizes=2, seed=0):
    """Discs, or ellipsoids, evenly over 10 m x 10 m in the plane y = 0; brightness rises with x and z."""
    rng = np.random.default_rng(seed)
    means = np.zeros((n, 3))
    means[:, [0, 2]] = rng.uniform(-5.0, 5.0, (n, 2))
    sizes = np.full((n, n_sizes), 0.7 * 10.0 / np.sqrt(n))
    sizes[:, 2:] *= 0.01
    colours = 0.5 + 0.03 * means[:, [0, 2, 0]] + 0.1 * rng.uniform(-1.0, 1.0, (n, 3))
    upright = np.tile([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0], (n, 1))
    panels = np.where(means[:, 0] < 0.0, 0, 1) if glass else np.full(n, -1)
    as_floats = [torch.tensor(values, dtype=torch.float32) for values in (means, upright, sizes)]
    return Splats.of(
        *as_floats, torch.full((n,), opacity), torch.tensor(colours, dtype=torch.float32), torch.tensor(panels)
    )


def from_south(distance_m, width_px=64):
    matrix = np.eye(4)
    matrix[:3, :3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    matrix[:3, 3] = [0.0, 0.0, distance_m]
    focal = 1.2 * width_px
    return View(width_px, width_px, focal, focal, width_px / 2, width_px / 2, torch.from_numpy(matrix))


@torch.no_grad()
def drawn(splats, view, settings=ANTIALIASED):
    """Features and opacity of each pixel."""
    place = -view.cam_from_world[:3, :3].T @ view.cam_from_world[:3, 3]
    raster = rasterise(
        splats.means,
        splats.quats,
        splats.scales,
        splats.opacities,
        splats.features(place.float()),
        view,
        settings=settings,
    )
    return raster.features, raster.alphas


@pytest.mark.few(1)
@pytest.mark.parametrize("n_sizes", [2, 3])
@pytest.mark.parametrize("opacity", [0.95, 0.5, 0.1])
def test_a_surface_drawn_by_fewer_is_the_mean_of_a_fine_picture(n_sizes, opacity):
    splats, view, finer = wall(opacity=opacity, n_sizes=n_sizes), from_south(15.0), 12
    few = splats_of_detail(splats).for_view(view, 1.5)
    assert len(few) < 0.35 * len(splats)
    truth, covered = (pooled(values, finer) for values in drawn(splats, from_south(15.0, finer * 64)))
    found, covers = (pooled(values, 1) for values in drawn(few, view))
    colour, normal = FEATURES["colour"], FEATURES["normal"]
    all_of_them = pooled(drawn(splats, view)[0], 1)
    error, usual = (float((each - truth)[..., colour].square().mean().sqrt()) for each in (found, all_of_them))
    assert error < 0.02
    # Cubes are coarser than pixels; but of the faintest splats those are missing that lie below the cut by themselves.
    assert error < (0.9 if opacity < 0.2 else 4.0) * usual
    # Those of half an opacity lie over each other here and there, which areas do not know.
    assert float((covers - covered).mean().abs()) < 0.06
    assert torch.allclose(found[..., normal] / covers, -torch.tensor(FORWARD), atol=0.01)


def pooled(values, n):
    """Means of n x n pixels, without the picture's edge."""
    values = values if values.ndim == 3 else values[..., None]
    return torch.nn.functional.avg_pool2d(values.permute(2, 0, 1), n).permute(1, 2, 0)[8:-8, 8:-8]


def test_nothing_changes_where_pixels_are_finer_than_cubes():
    """Splats out of sight are left out, and not one pixel knows."""
    splats = wall(4 * FEWEST)
    detail = splats_of_detail(splats)
    assert detail.tree.levels
    view = from_south(0.4)
    few = detail.for_view(view, 1.0)
    assert 0 < len(few) < 0.5 * len(splats)
    for before, after in zip(drawn(splats, view), drawn(few, view), strict=True):
        assert torch.equal(before, after)


def test_panes_stay_apart_with_their_reflectance():
    splats = wall(glass=True)
    with torch.no_grad():
        splats.reflectivity_logits.copy_(torch.where(splats.panels == 0, 2.0, -2.0))
    detail = splats_of_detail(splats)
    merged = detail.all.some(torch.arange(len(splats), len(detail.all)))
    sides = torch.where(merged.means[:, 0] < 0.0, 0, 1)
    assert torch.equal(merged.panels.long(), sides)
    expected = torch.sigmoid(torch.where(sides == 0, 2.0, -2.0))
    assert torch.allclose(merged.reflectivity, expected, atol=1e-5)
    assert torch.allclose(merged.f0, splats.f0[:1].expand_as(merged.f0), atol=1e-5)


def test_colours_are_averaged_as_light():
    splats = wall(4 * FEWEST)
    display = torch.where(torch.arange(len(splats))[:, None] % 2 == 0, 0.0, 1.0).expand(-1, 3)
    black_and_white = Splats.of(
        splats.means.detach(), splats.quats.detach(), splats.scales.detach(), splats.opacities.detach(), display
    )
    detail = splats_of_detail(black_and_white)
    last = detail.all.some(torch.tensor([len(detail.all) - 1]))
    place = torch.tensor([0.0, -9.0, 0.0])
    rows = np.flatnonzero([_root(detail.tree.parents, row) == len(detail.all) - 1 for row in range(len(splats))])
    light = linear_from_display(display[rows]).mean(dim=0)
    assert len(rows) > 5
    assert torch.allclose(last.colours(place)[0], light, atol=0.02)
    assert not torch.allclose(display_from_linear(light), display[rows].mean(dim=0), atol=0.1)


def _root(parents, row):
    while parents[row] >= 0:
        row = parents[row]
    return row


def test_middle_and_spread_are_those_of_all_parts():
    splats = wall(2 * FEWEST, opacity=0.5)
    detail = splats_of_detail(splats)
    tree, row = detail.tree, len(detail.all) - 1
    parts = [part for part in range(tree.n_splats) if _root(tree.parents, part) == row]
    means = splats.means.detach().double().numpy()[parts]
    assert np.allclose(detail.all.means[row].detach().numpy(), means.mean(axis=0), atol=1e-3)
    inner = np.diag([float(splats.scales[0, 0].detach()) ** 2] * 2)
    spread = np.cov(means[:, [0, 2]].T, bias=True) + inner
    sizes = detail.all.scales[row].detach().numpy()
    ratio = sizes / np.sqrt(np.linalg.eigvalsh(spread))[::-1]
    assert np.allclose(ratio, ratio[0], rtol=1e-3)
    assert 1.0 <= ratio[0] <= MOST_LARGER + 1e-3


@pytest.mark.parametrize("case", ["nothing covers", "one place", "needles", "far away"])
def test_numbers_stay_finite(case):
    splats = wall(3 * FEWEST)
    with torch.no_grad():
        if case == "nothing covers":
            splats.opacity_logits.fill_(-200.0)
        elif case == "one place":
            splats.means.copy_(splats.means[:1].expand_as(splats.means))
        elif case == "needles":
            splats.log_scales.copy_(torch.tensor([-2.0, -40.0]).expand_as(splats.log_scales))
        else:
            splats.means.add_(1e5)
    detail = splats_of_detail(splats)
    assert len(detail.all) > len(splats)
    for name in detail.all.names:
        assert torch.isfinite(detail.all.get_parameter(name)).all(), name
    assert float(detail.all.opacities.detach().max()) <= MOST_OPAQUE + 1e-5
    for value in drawn(detail.for_view(from_south(15.0), 3.0), from_south(15.0)):
        assert torch.isfinite(value).all()


def test_float32_is_as_good_as_float64():
    splats = wall(4 * FEWEST)
    one, other = splats_of_detail(splats), splats_of_detail(splats.double())
    assert np.array_equal(one.tree.parents, other.tree.parents)
    for name in ("means", "log_scales", "opacity_logits", "sh"):
        single, double = one.all.get_parameter(name).double(), other.all.get_parameter(name)
        assert torch.allclose(single, double, atol=2e-4), name


def test_attributes_of_a_method_are_averaged_too():
    splats = wall(3 * FEWEST)
    values = {name: splats.get_parameter(name).detach() for name in splats.names}
    shaded = Splats({**values, "roughness": torch.full((len(splats), 2), 0.3)}, splats.panels)
    merged = splats_of_detail(shaded).all
    assert torch.allclose(merged.attribute("roughness"), torch.tensor(0.3))


def test_the_same_splats_are_merged_alike():
    one, other = (splats_of_detail(wall(3 * FEWEST)).all for _ in range(2))
    assert all(torch.equal(one.get_parameter(name), other.get_parameter(name)) for name in one.names)
