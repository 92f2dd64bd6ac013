"""Shaders of web pages by themselves, on whatever adapter there is, against the program's own light."""

import base64
import json
import re
import zlib
from dataclasses import replace

import numpy as np
import pytest
import torch

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.exports.web import WebOptions, write_web
from reconstruction.light.config import GlassLearned
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.glass_rays import rays_of_pixels
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import GridBox, RadianceGrid
from reconstruction.light.ray_table import RayTable
from reconstruction.light.reflection_mlp import MlpShape, ReflectionMlp
from reconstruction.light.shading import display_from_linear
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.pane_mirrors import mirrors_of
from tests.reconstruction.exports.page_shaders import Shaders, view_numbers
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

ORIGIN_ENU_M = np.array([100.0, -20.0, 5.0])
WIDTH, HEIGHT, FOCAL = 240, 160, 150.0


def leaning_panes(rng):
    """Three panes before the camera and one beside it, metres ENU: not rectangles all of them."""
    square = np.array([(-1.0, 0.0, -1.0), (1.0, 0.0, -1.0), (1.0, 0.0, 1.0), (-1.0, 0.0, 1.0)])
    middles = np.array([(-2.2, 0.0, 0.0), (0.0, 0.2, 0.1), (2.2, 0.0, 0.0), (0.0, -0.3, 2.3)])
    return square + middles[:, None] + rng.uniform(-0.1, 0.1, (4, 1, 3)) * (1.0, 0.0, 1.0) + ORIGIN_ENU_M


def grid_of(rng):
    """With dense and empty places, as none that was trained is."""
    box = GridBox(0.4, (0.1, 0.8, 0.2), (1.5, 1.1, 1.3), (17, 13, 15), 0.5, 2.0)
    grid = RadianceGrid(box, 0.3, 0, 16)
    with torch.no_grad():
        density = rng.normal(-0.6, 0.35, grid.cells.shape[:3])
        density[:, :, :7] = -0.5
        grid.cells[..., 0] = torch.from_numpy(density).float()
        grid.cells[..., 1:] = torch.from_numpy(rng.uniform(0.2, 1.0, (*density.shape, 3))).float()
        grid.far.copy_(torch.from_numpy(rng.uniform(0.2, 1.2, grid.far.shape)).float())
    grid.refresh()
    assert 0.1 < (grid.skips > 0).mean() < 0.9
    return grid


def environment_of(rng):
    """With detail of all sizes."""
    found = EnvironmentMap(16, 0.3)
    with torch.no_grad():
        for level in found.levels:
            level.copy_(torch.from_numpy(rng.normal(0.0, 0.5, level.shape)).float())
    return found


def network_of(rng):
    """Small, and with waves as short as a pane."""
    shape = MlpShape(width=14, layers=4, position_order=4, direction_order=3)
    return ReflectionMlp(shape, 0.3, torch.Generator().manual_seed(int(rng.integers(1000))))


def model_of(rng, rays=4, make=grid_of):
    """Panes that lean and are bowed, and any light."""
    planes = PanelPlanes(leaning_panes(rng))
    light = GlassLight(make(rng), planes, GlassLearned(rays=rays, tilts=True, bows=True))
    with torch.no_grad():
        light.tilts.copy_(torch.from_numpy(rng.normal(0.0, 0.02, light.tilts.shape)).float())
        light.bows.copy_(torch.from_numpy(rng.normal(0.0, 0.02, light.bows.shape)).float())
    splats = Splats(
        {
            "means": torch.zeros(1, 3),
            "quats": torch.tensor([[1.0, 0.0, 0.0, 0.0]]),
            "log_scales": torch.zeros(1, 2),
            "opacity_logits": torch.zeros(1),
            "sh": torch.zeros(1, 16, 3),
            "reflectivity_logits": torch.zeros(1),
            "f0_logits": torch.zeros(1, 3),
        },
        torch.zeros(1, dtype=torch.int32),
    )
    return SceneModel(splats, Sky(), light, planes, ORIGIN_ENU_M, 1.0).eval()


def made_mirrors(scene, n_panels=None, make=grid_of):
    """Of a scene that was not trained: any light, and random values of all of its Gaussians."""
    rng = np.random.default_rng(0)
    n = scene.n_gaussians
    m = len(list(scene.elements)) if n_panels is None else n_panels
    return replace(
        mirrors_of(model_of(rng, make=make)),
        tilts=rng.normal(0.0, 0.01, (m, 2)).astype(np.float32),
        bows=rng.normal(0.0, 0.01, (m, 2)).astype(np.float32),
        sh=rng.normal(0.0, 0.05, (n, 16, 3)).astype(np.float32),
        reflectivity=rng.uniform(0.2, 0.9, n).astype(np.float32),
        f0=rng.uniform(0.1, 0.8, (n, 3)).astype(np.float32),
    )


def looking(eye, heading_deg, pitch_deg):
    """A camera before the panes, and its axes as rows."""
    h, p = np.radians([heading_deg, pitch_deg])
    forward = np.array([np.cos(p) * np.sin(h), np.cos(p) * np.cos(h), np.sin(p)])
    right = np.array([np.cos(h), -np.sin(h), 0.0])
    axes = np.stack([right, -np.cross(right, forward), forward])
    lens = Intrinsics(WIDTH, HEIGHT, FOCAL, FOCAL, WIDTH / 2, HEIGHT / 2)
    return PosedPhoto("", None, lens, Pose(np.asarray(eye) + ORIGIN_ENU_M, axes)), axes


@pytest.fixture(scope="module")
def shaders():
    return Shaders()


@pytest.mark.long
@pytest.mark.parametrize(("rays", "make"), [(1, grid_of), (4, grid_of), (4, environment_of)])
def test_panes_mirror_to_pixels_what_the_model_mirrors(shaders, rays, make):
    rng = np.random.default_rng(rays)
    model = model_of(rng, rays, make)
    for eye, heading, pitch in [((0.3, -4.0, 0.5), 2.0, -3.0), ((3.0, -2.0, -1.0), -50.0, 10.0)]:
        photo, axes = looking(eye, heading, pitch)
        columns, rows = rng.integers(0, WIDTH, 500), rng.integers(0, HEIGHT, 500)
        panels = rng.integers(0, 4, 500)
        table = RayTable.of([photo], model.planes, {})
        asked_rays = rays_of_pixels(table, 0, *(torch.from_numpy(each) for each in (columns, rows, panels)))
        with torch.no_grad():
            light, cosines = (each.numpy() for each in model.light(asked_rays))
        pixels = np.column_stack([columns + 0.5 - WIDTH / 2, rows + 0.5 - HEIGHT / 2, panels])
        view = view_numbers(eye, axes, FOCAL, (WIDTH, HEIGHT), int(np.sqrt(rays)))
        found = shaders.mirrored(mirrors_of(model), model.corners_m, view, pixels)
        is_seen = asked_rays.hits().cosines.numpy() > 0.05
        assert is_seen.sum() > 200
        np.testing.assert_allclose(found[is_seen, 3], cosines[is_seen], atol=2e-5)
        # Half floats: 1e-3 at most was measured.
        np.testing.assert_allclose(found[is_seen, :3], light[is_seen], atol=0.003)
        assert light[is_seen].std() > 0.05


def glazed(model, rng):
    """The model with splats all over its panes, and some beside and before them."""
    panels = np.repeat([0, 1, 2, 3, -1], 40)
    u, v = rng.random((2, 160, 1))
    corners = model.corners_m[panels[:160]]
    on_panes = corners[:, 0] + u * (corners[:, 1] - corners[:, 0]) + v * (corners[:, 3] - corners[:, 0])
    n = len(panels)
    values = {
        "means": np.concatenate([on_panes, rng.uniform(-2.5, 2.5, (40, 3))]),
        "quats": np.where(panels[:, None] >= 0, (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0), rng.normal(size=(n, 4))),
        "log_scales": np.log(rng.uniform(0.1, 0.4, (n, 2))),
        "opacity_logits": rng.normal(1.0, 1.5, n),
        "sh": rng.normal(0.0, 1.0, (n, 16, 3)) * np.array([0.8, *[0.05] * 15])[:, None],
        "reflectivity_logits": rng.normal(1.0, 1.0, n),
        "f0_logits": rng.normal(0.0, 1.0, (n, 3)),
    }
    tensors = {name: torch.from_numpy(value).float() for name, value in values.items()}
    return model.with_splats(Splats(tensors, torch.from_numpy(panels).int()))


@pytest.mark.long
@pytest.mark.parametrize(("make", "rays"), [(grid_of, 1), (network_of, 4)])
def test_pages_show_what_the_model_shows_through_all_passes(shaders, make, rays):
    rng = np.random.default_rng(3)
    model = glazed(model_of(rng, rays, make), rng)
    size = width, height = 96, 64
    for eye, heading, pitch in [((0.3, -4.0, 0.5), 2.0, -3.0), ((2.5, -2.5, -0.5), -40.0, 20.0)]:
        _, axes = looking(eye, heading, pitch)
        cam_from_world = torch.eye(4, dtype=torch.float64)
        cam_from_world[:3, :3] = torch.from_numpy(axes)
        cam_from_world[:3, 3] = torch.from_numpy(-axes @ np.array(eye))
        view = View(width, height, 60.0, 60.0, width / 2, height / 2, cam_from_world)
        with torch.no_grad():
            picture = model(view, settings=RasterSettings(blur_px=np.sqrt(0.3), antialiased=True))
        found = shaders.picture(model, view_numbers(eye, axes, 60.0, size, int(np.sqrt(rays))), size)
        shown, expected = (display_from_linear(torch.as_tensor(each)).clamp(0, 1) for each in (found, picture.light))
        error = ((shown - expected) ** 2).mean()
        assert error < 10**-4.5  # 51 and 60 dB were measured
        # Without what panes mirror it is another picture.
        assert ((display_from_linear(picture.diffuse).clamp(0, 1) - expected) ** 2).mean() > 100 * error


def decoded_glass(page, number):
    """Own values of the page's Gaussians on panes: colours of all directions, R and F0."""
    text = re.search(rf'id="m{number}">([^<]*)<', page)[1]
    content = base64.b64decode(text)
    n = len(content) // 8
    values = np.frombuffer(content, "<u4").reshape(n, 2).view(np.uint8).reshape(n, 8) / 255.0
    return values[:, :3], values[:, 3], values[:, 4:7]


def test_pages_carry_what_panes_are_made_of_beside_what_is_baked(tmp_path):
    scene = synthetic_scene(sizes=((30, 0, 20), (10,)), n_background=40)
    mirrors = made_mirrors(scene)
    page = write_web(scene, tmp_path, (), WebOptions(degree=0, mirrors=mirrors)).path.read_text()
    model = json.loads(re.search(r'id="model">([^<]*)<', page)[1])
    assert model["mirrors"]["n_glass"] == 60
    panels = [element.panel for _, element in scene.elements]
    np.testing.assert_allclose(model["mirrors"]["tilts"], mirrors.tilts[panels], atol=1e-8)
    cells = zlib.decompress(base64.b64decode(re.search(r'id="l0">([^<]*)<', page)[1]))
    planes = np.frombuffer(cells, np.uint8).reshape(8, -1)
    assert np.array_equal(planes.T.copy().view("<f2").reshape(mirrors.cells.shape), mirrors.cells)
    # The same Gaussians, whatever their order in the page.
    _, reflectivity, f0 = decoded_glass(page, 0)
    places = np.concatenate([facade.gaussians.places for facade in scene.components[:-1]])
    expected = np.column_stack([mirrors.reflectivity, mirrors.f0])[places]
    found = np.column_stack([reflectivity, f0])
    distances = np.abs(found[:, None] - expected[None]).max(axis=2)
    assert sorted(distances.argmin(axis=0)) == sorted(distances.argmin(axis=1)) == list(range(60))
    assert distances.min(axis=1).max() < 0.5 / 255.0 + 1e-6


def test_the_first_picture_of_a_large_model_is_within_2_mb(tmp_path):
    scene = synthetic_scene(sizes=((9000,) * 2,), n_background=2000)
    page = write_web(scene, tmp_path, (), WebOptions(mirrors=made_mirrors(scene))).path.read_bytes()
    assert page.index(b'id="g1"') > page.index(b'id="l0"') > page.index(b'id="m0"') > page.index(b'id="g0"')
    assert page.index(b'id="l0"') < 2_000_000


def test_pages_whose_panes_cannot_mirror_carry_nothing_of_it(tmp_path):
    for number, sizes in enumerate([((0, 0),), ()]):
        scene = synthetic_scene(sizes=sizes, n_background=5)
        options = WebOptions(mirrors=made_mirrors(scene, n_panels=2))
        page = write_web(scene, tmp_path / str(number), (), options).path.read_text()
        assert json.loads(re.search(r'id="model">([^<]*)<', page)[1])["mirrors"] is None
        assert 'id="m0"' not in page
        assert 'id="l0"' not in page


def test_only_light_that_the_page_can_compute_is_given_to_it():
    model = model_of(np.random.default_rng(0))
    assert mirrors_of(model).rays == 2
    model.geometry = "splats"
    assert mirrors_of(model) is None
    model.geometry = "panels"
    # A kind of light that learns more than the page knows of must not be shown without that.
    model.light.light.detail = torch.nn.Parameter(torch.zeros(1))
    assert mirrors_of(model) is None
    # Nor one that is too wide for shared memory.
    wide = MlpShape(width=514, layers=2, position_order=2, direction_order=2)
    model.light.light = ReflectionMlp(wide, 0.3, torch.Generator().manual_seed(0))
    assert mirrors_of(model) is None
    model.light = None
    assert mirrors_of(model) is None
