"""Panels with pictures: what is on them is what the model shows there, the right way round."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import trimesh

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports.mesh import AWAY, EDGE_PX, MeshOptions, pack, panel_view, write_mesh
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training.model.joint_model import SceneModel
from tests.reconstruction.exports.hard_scenes import Interrupted
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

ORIGIN_M = np.array([1.0, 2.0, 3.0])
SOUTH = ((0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (1.5, 0.0, 2.0), (0.0, 0.0, 2.0))
EAST = ((4.0, 1.0, 0.5), (4.0, 3.0, 0.5), (4.0, 3.0, 1.5), (4.0, 1.0, 1.5))
COLOURS = {(0, 0): (0.9, 0.1, 0.1), (1, 0): (0.1, 0.9, 0.1), (0, 1): (0.1, 0.1, 0.9), (1, 1): (0.9, 0.9, 0.1)}
"""Of the quarters of a panel, by right and upper half."""

OPTIONS = MeshOptions(px_per_m=40.0, page_px=256)


def scene_and_model():
    scene = synthetic_scene(((1,), (1,)), 1)
    corners = (SOUTH, EAST)
    components = [
        replace(component, elements=(replace(component.elements[0], corners_enu_m=corners[number]),))
        for number, component in enumerate(scene.components[:2])
    ]
    scene = replace(scene, components=(*components, scene.components[2]), origin_enu_m=tuple(ORIGIN_M))
    planes = PanelPlanes(np.array(corners))
    return scene, SceneModel(splats_on(corners), Sky(), None, planes, ORIGIN_M, 1.0).eval()


def splats_on(panels):
    """A carpet of discs on each panel, in four colours, and one that hides the first panel from far away."""
    means, normals, colours = [], [], []
    for corners in np.array(panels):
        right, up = corners[1] - corners[0], corners[3] - corners[0]
        shares = (np.arange(40) + 0.5) / 40.0
        for a in shares:
            for b in shares:
                means.append(corners[0] + a * right + b * up)
                normals.append(np.cross(right, up))
                colours.append(COLOURS[int(a > 0.5), int(b > 0.5)])
    means.append(np.array(panels[0]).mean(axis=0) + np.array([0.0, -3.0, 0.0]))
    normals.append(np.array([0.0, -1.0, 0.0]))
    colours.append((1.0, 1.0, 1.0))
    n = len(means)
    normals = np.array(normals) / np.linalg.norm(normals, axis=1, keepdims=True)
    quats = np.column_stack([1.0 + normals[:, 2], -normals[:, 1], normals[:, 0], np.zeros(n)])
    scales = torch.full((n, 2), 0.04)
    scales[-1] = 2.0
    means = torch.tensor(np.array(means) - ORIGIN_M, dtype=torch.float32)
    opacities, colours = torch.full((n,), 0.99), torch.tensor(np.array(colours), dtype=torch.float32)
    return Splats.of(means, torch.tensor(quats, dtype=torch.float32), scales, opacities, colours)


@pytest.fixture(scope="module")
def made():
    return scene_and_model()


def texels(mesh, places):
    """Colours, 0 to 1, of a mesh's texture at shares of its sides (right, up)."""
    image = np.asarray(mesh.visual.material.baseColorTexture)[..., :3] / 255.0
    uv = mesh.visual.uv
    height, width = image.shape[:2]
    found = []
    for a, b in places:
        u, v = uv[0] + a * (uv[1] - uv[0]) + b * (uv[3] - uv[0])
        found.append(image[int((1.0 - v) * height), int(u * width)])
    return np.array(found)


def test_pictures_lie_on_their_panels_the_right_way_round(made, tmp_path):
    scene, model = made
    done = write_mesh(scene, model, tmp_path / "наш вид.glb", OPTIONS, {scene.components[0].global_id: {"a": 1}})
    assert (done.n_panels, done.n_bytes) == (2, done.path.stat().st_size)
    loaded = trimesh.load(done.path)
    for _, element in scene.elements:
        transform, name = loaded.graph[element.name]
        mesh = loaded.geometry[name]
        east_up_south = trimesh.transform_points(mesh.vertices, transform)
        enu = np.column_stack([east_up_south[:, 0], -east_up_south[:, 2], east_up_south[:, 1]])
        np.testing.assert_allclose(enu, element.corners_enu_m, atol=1e-5)
        halves = [(0.25 + 0.5 * right, 0.25 + 0.5 * up) for right, up in COLOURS]
        np.testing.assert_allclose(texels(mesh, halves), list(COLOURS.values()), atol=0.03)
        edges = [(0.01, 0.01), (0.99, 0.01), (0.01, 0.99), (0.99, 0.99)]
        assert np.abs(texels(mesh, edges) - list(COLOURS.values())).max() < 0.25


def test_each_panel_is_an_object_with_its_global_id(made, tmp_path):
    scene, model = made
    content = write_mesh(scene, model, tmp_path / "a.glb", OPTIONS).path.read_bytes()
    length = int.from_bytes(content[12:16], "little")
    nodes = json.loads(content[20 : 20 + length])["nodes"]
    ids = {node["extras"]["global_id"] for node in nodes if "mesh" in node}
    assert ids == {element.global_id for _, element in scene.elements}
    assert content == write_mesh(scene, model, tmp_path / "b.glb", OPTIONS).path.read_bytes()


@pytest.mark.parametrize("corners", [SOUTH, EAST, ((0, 0, 0), (1, 1, 0.2), (1.3, 1, 2), (0.1, 0, 1.8))])
@pytest.mark.parametrize("px_per_m", [1.0, 37.0])
def test_corners_of_a_panel_are_where_its_view_shows_them(corners, px_per_m):
    corners = np.array(corners, float)
    found = panel_view(corners, px_per_m)
    matrix = found.view.cam_from_world.numpy()
    seen = corners @ matrix[:3, :3].T + matrix[:3, 3]
    view = found.view
    pixels = seen[:, :2] / seen[:, 2:] * (view.fx_px, view.fy_px) + (view.cx_px, view.cy_px)
    np.testing.assert_allclose(pixels, found.corners_px, atol=0.05)
    assert np.linalg.det(matrix[:3, :3]) == pytest.approx(1.0)
    assert found.distance_m >= AWAY
    assert found.corners_px.min() >= EDGE_PX - 1e-6
    assert view.fx_px / found.distance_m >= px_per_m - 1e-6


def test_a_panel_without_area_is_refused(made, tmp_path):
    scene, model = made
    first = scene.components[0]
    flat = replace(first, elements=(replace(first.elements[0], corners_enu_m=(SOUTH[0],) * 4),))
    with pytest.raises(InputError, match="panel 'A-0000' has no area"):
        write_mesh(replace(scene, components=(flat,)), model, tmp_path / "a.glb")
    with pytest.raises(InputError, match="there are no panels"):
        write_mesh(replace(scene, components=scene.components[2:]), model, tmp_path / "a.glb")


def test_pictures_that_are_too_large_are_refused_with_what_fits(made, tmp_path):
    scene, model = made
    with pytest.raises(InputError, match="would have 404 pixels on a side, and textures have 256; choose 126"):
        write_mesh(scene, model, tmp_path / "a.glb", MeshOptions(px_per_m=200.0, page_px=256))
    with pytest.raises(InputError, match="2 textures of 256 pixels would be needed, and 1 are the most"):
        write_mesh(scene, model, tmp_path / "a.glb", MeshOptions(px_per_m=120.0, page_px=256, most_pages=1))
    assert not list(tmp_path.iterdir())


def test_an_interrupted_write_leaves_the_old_file(made, tmp_path):
    scene, model = made
    path = write_mesh(scene, model, tmp_path / "a.glb", OPTIONS).path
    before = path.read_bytes()
    with pytest.raises(OperationCancelled):
        write_mesh(scene, model, path, MeshOptions(px_per_m=20.0), monitor=Interrupted(1))
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["a.glb"]


@pytest.mark.parametrize("name", ["px_per_m", "page_px", "most_pages", "in_front_m"])
def test_options_out_of_range_are_refused(name):
    for value in (0, 1_000_000):
        with pytest.raises(ValueError, match=name):
            MeshOptions(**{name: value})


@pytest.mark.parametrize("seed", range(4))
def test_no_two_pictures_overlap_and_none_is_cut(seed):
    rng = np.random.default_rng(seed)
    sizes = [SimpleNamespace(w=int(w), h=int(h)) for w, h in rng.integers(1, 65, (200, 2))]
    atlas = pack([(each.w, each.h) for each in sizes], 128)
    covered = [np.zeros((height, width), int) for width, height in atlas.pages]
    for each, place in zip(sizes, atlas.places, strict=True):
        window = covered[place.page][place.y_px : place.y_px + each.h, place.x_px : place.x_px + each.w]
        assert window.shape == (each.h, each.w)
        window += 1
    assert max(page.max() for page in covered) == 1
    used = sum(each.w * each.h for each in sizes) / sum(page.size for page in covered)
    assert used > 0.6
    with pytest.raises(ValueError, match="expected 1 to 128 pixels"):
        pack([(129, 1)], 128)
