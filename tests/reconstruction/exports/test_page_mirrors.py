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
from reconstruction.exports.page_mirrors import mirrors_of
from reconstruction.exports.web import WebOptions, wgsl, write_web
from reconstruction.light.config import GlassLearned
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.glass_rays import rays_of_pixels
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import GridBox, RadianceGrid
from reconstruction.light.ray_table import RayTable
from reconstruction.light.reflection_mlp import MlpShape, ReflectionMlp
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training.model.joint_model import SceneModel
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

ORIGIN_ENU_M = np.array([100.0, -20.0, 5.0])
WIDTH, HEIGHT, FOCAL = 240, 160, 150.0

ASK = """
@group(1) @binding(0) var<storage, read> asked: array<vec4f>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= arrayLength(&asked)) { return; }
  let found = mirrored_by(u32(asked[id.x].z), asked[id.x].xy);
  answers[id.x] = vec4f(found.light, found.cosine);
}
"""


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


def numbers_of(mirrors, corners_m):
    """Content of `Light` and of the `Pane`s, as mirrors.js fills them in."""
    n = mirrors.numbers
    names = (
        *("middle", "half_side", "inner", "cell", "over", "outer", "turn", "reach", "unit", "far_side", "far_times"),
        *("density_scale", "opaque", "environment"),
    )
    light = np.concatenate([*(np.atleast_1d(n[name]) for name in names), np.zeros(3)]).astype(np.float32)
    normals = np.cross(corners_m[:, 2] - corners_m[:, 0], corners_m[:, 3] - corners_m[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    edges = [corners_m[:, i] - corners_m[:, 0] for i in (1, 3)]
    over = [edge / (edge**2).sum(axis=1, keepdims=True) for edge in edges]
    columns = zip((corners_m[:, 0], normals, *over), (*mirrors.tilts.T, *mirrors.bows.T), strict=True)
    return light, np.stack([np.column_stack(each) for each in columns], axis=1).astype(np.float32)


class Shaders:
    """The page's programs with one more that asks what panes mirror to pixels."""

    def __init__(self):
        wgpu = pytest.importorskip("wgpu", reason="wgpu is not installed: pip install wgpu")
        try:
            adapter = wgpu.gpu.request_adapter_sync()
        except RuntimeError:
            adapter = None
        if adapter is None:
            pytest.skip("no graphics adapter: apt-get install mesa-vulkan-drivers")
        self.wgpu, self.device = wgpu, adapter.request_device_sync()
        module = self.device.create_shader_module(code=wgsl() + ASK)
        self.pipeline = self.device.create_compute_pipeline(
            layout="auto", compute={"module": module, "entry_point": "ask"}
        )

    def buffer(self, values, usage):
        return self.device.create_buffer_with_data(data=np.ascontiguousarray(values), usage=usage)

    def texture(self, levels, kind, texel_bytes, dimension):
        """Of arrays (depth, height, width, ...) or (height, width, ...), each half as large as the one before."""
        sizes = [(*level.shape[2::-1],) if dimension == "3d" else (*level.shape[1::-1], 1) for level in levels]
        usage = self.wgpu.TextureUsage.TEXTURE_BINDING | self.wgpu.TextureUsage.COPY_DST
        found = self.device.create_texture(
            size=sizes[0], format=kind, usage=usage, dimension=dimension, mip_level_count=len(levels)
        )
        for number, (level, size) in enumerate(zip(levels, sizes, strict=True)):
            layout = {"bytes_per_row": size[0] * texel_bytes, "rows_per_image": size[1]}
            place = {"texture": found, "mip_level": number}
            self.device.queue.write_texture(place, np.ascontiguousarray(level), layout, size)
        return found.create_view()

    def mirrored(self, mirrors, corners_m, eye_m, axes, asked):
        """Light and cosines, shape (n, 4), of pixels counted from the middle and panes, shape (n, 3)."""
        usage, device = self.wgpu.BufferUsage, self.device
        view = np.zeros(32, np.float32)
        view[0:3], view[3], view[22], view[23] = eye_m, FOCAL, mirrors.rays, 1.0
        for row, axis in zip((4, 8, 12), axes, strict=True):
            view[row : row + 3] = axis
        light, panes = numbers_of(mirrors, corners_m)
        found = device.create_buffer(size=16 * len(asked), usage=usage.STORAGE | usage.COPY_SRC)
        linear = dict.fromkeys(("address_mode_u", "address_mode_v", "address_mode_w"), "clamp-to-edge")
        own = {
            0: {"buffer": self.buffer(view, usage.UNIFORM)},
            10: {"buffer": self.buffer(light, usage.UNIFORM)},
            11: {"buffer": self.buffer(panes, usage.STORAGE)},
            12: self.texture([mirrors.cells], "rgba16float", 8, "3d"),
            13: self.texture([mirrors.skips], "r8uint", 1, "3d"),
            14: self.texture(mirrors.far, "rgba16float", 8, "2d"),
            15: device.create_sampler(mag_filter="linear", min_filter="linear", **linear),
            17: device.create_sampler(
                mag_filter="linear", min_filter="linear", **{**linear, "address_mode_u": "repeat"}
            ),
        }
        questions = np.column_stack([asked, np.zeros(len(asked))]).astype(np.float32)
        answers = {0: {"buffer": self.buffer(questions, usage.STORAGE)}, 1: {"buffer": found}}
        encoder = device.create_command_encoder()
        step = encoder.begin_compute_pass()
        step.set_pipeline(self.pipeline)
        for number, group in enumerate((own, answers)):
            entries = [{"binding": binding, "resource": each} for binding, each in group.items()]
            layout = self.pipeline.get_bind_group_layout(number)
            step.set_bind_group(number, device.create_bind_group(layout=layout, entries=entries))
        step.dispatch_workgroups(-(-len(asked) // 64))
        step.end()
        device.queue.submit([encoder.finish()])
        return np.frombuffer(device.queue.read_buffer(found), np.float32).reshape(-1, 4)


@pytest.fixture(scope="module")
def shaders():
    return Shaders()


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
        found = shaders.mirrored(mirrors_of(model), model.corners_m, np.array(eye), axes, pixels)
        is_seen = asked_rays.hits().cosines.numpy() > 0.05
        assert is_seen.sum() > 200
        np.testing.assert_allclose(found[is_seen, 3], cosines[is_seen], atol=2e-5)
        # Half floats: 1e-3 at most was measured.
        np.testing.assert_allclose(found[is_seen, :3], light[is_seen], atol=0.003)
        assert light[is_seen].std() > 0.05


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
    shape = MlpShape(width=8, layers=2, position_order=2, direction_order=2)
    network = ReflectionMlp(shape, 0.3, torch.Generator().manual_seed(0))
    model.light.light = network
    assert mirrors_of(model) is None
    model.light = None
    assert mirrors_of(model) is None
