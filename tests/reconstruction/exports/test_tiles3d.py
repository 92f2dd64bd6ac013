"""3D Tiles: places, boxes, what each tile has, and folders that are whole at every moment."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer

from planning.base.errors import InputError, OperationCancelled
from planning.geo.enu import geodetic_from_enu
from reconstruction.exports.component_parts import Ellipsoids, ellipsoids_of, extents_m
from reconstruction.exports.glb import SPZ
from reconstruction.exports.tiles3d import CONTENT, TilesOptions, branches_of, part_of_branch, write_tiles
from tests.reconstruction.exports.glb_reader import SPLATTING, Glb
from tests.reconstruction.exports.test_gltf import HOSTILE, Cancelling, component_with, rotation_of
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

SIZES = ((30, 0, 50, 9), (2,))


def read(folder, name="tileset.json"):
    return json.loads((folder / name).read_text())


def tiles_of(tile):
    yield tile
    for child in tile.get("children", ()):
        yield from tiles_of(child)


def files_of(folder, name="tileset.json"):
    return [tile["content"]["uri"] for tile in tiles_of(read(folder, name)["root"]) if "content" in tile]


def box_of(tile):
    numbers = np.array(tile["boundingVolume"]["box"])
    half = np.abs(numbers[3:].reshape(3, 3)).sum(axis=0)
    return numbers[:3] - half, numbers[:3] + half


def means_of(glb):
    (name,) = glb.primitives
    return glb.attributes(name)["POSITION"]


def panels_of(glb):
    """Of its Gaussians."""
    is_facade = "_FEATURE_ID_0" in glb.attributes(next(iter(glb.primitives)))
    return {row["Number in the model"] for row in glb.table} if is_facade else set()


def contents_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_tiles_lie_on_earth_where_the_site_is(tmp_path):
    scene = synthetic_scene()
    write_tiles(scene, tmp_path)
    transform = np.array(read(tmp_path)["root"]["transform"]).reshape(4, 4).T
    points = np.array([[0.0, 0.0, 0.0], [100.0, -50.0, 20.0], [-300.0, 10.0, 5.0], [0.0, 0.0, 80.0]])
    found = (np.column_stack([points, np.ones(4)]) @ transform.T)[:, :3]
    lat, lon, height = geodetic_from_enu(scene.origin, points)
    expected = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True).transform(lon, lat, height)
    np.testing.assert_allclose(found, np.column_stack(expected), atol=1e-6)
    assert abs(np.linalg.det(transform[:3, :3]) - 1.0) < 1e-12


def test_a_site_without_a_place_has_tiles_in_its_own_frame_only(tmp_path):
    scene = replace(synthetic_scene(), origin=None)
    with pytest.raises(InputError, match="set the site's origin"):
        write_tiles(scene, tmp_path / "tiles")
    assert not (tmp_path / "tiles").exists()
    write_tiles(scene, tmp_path / "tiles", TilesOptions(place="local"))
    assert "transform" not in read(tmp_path / "tiles")["root"]


def test_each_gaussian_is_in_one_tile_inside_its_box(tmp_path):
    scene = synthetic_scene(SIZES, 100)
    write_tiles(scene, tmp_path, TilesOptions(gaussians_per_tile=25, gaussians="numbers"))
    means = []
    for tile in tiles_of(read(tmp_path)["root"]):
        if "-gaussians-" not in tile.get("content", {}).get("uri", ""):
            continue
        glb = Glb((tmp_path / tile["content"]["uri"]).read_bytes())
        (name,) = glb.primitives
        (node,) = glb.json["scenes"][0]["nodes"]
        assert glb.json["nodes"][node]["matrix"][12:] == [1.0, 3.0, -2.0, 1.0]
        values = glb.attributes(name)
        n = len(values["POSITION"])
        assert n <= 25 or len(panels_of(glb)) == 1
        found = Ellipsoids(
            values["POSITION"],
            values[f"{SPLATTING}:ROTATION"][:, [3, 0, 1, 2]],
            values[f"{SPLATTING}:SCALE"],
            np.zeros(n, np.float32),
            np.zeros((n, 16, 3), np.float32),
            np.zeros(n, np.int32),
        )
        low, high = box_of(tile)
        centres = found.means_m + np.array(scene.origin_enu_m)
        np.testing.assert_allclose(low, (centres - extents_m(found)).min(axis=0), atol=1e-9)
        np.testing.assert_allclose(high, (centres + extents_m(found)).max(axis=0), atol=1e-9)
        means.append(found.means_m)
    expected = np.concatenate([component.gaussians.values["means"] for component in scene.components])
    assert np.array_equal(np.unique(np.concatenate(means), axis=0), np.unique(expected, axis=0))
    assert sum(map(len, means)) == len(expected)


def test_boxes_of_panels_are_around_their_corners(tmp_path):
    scene = synthetic_scene()
    write_tiles(scene, tmp_path)
    root = read(tmp_path, "panels.json")["root"]
    tiles = [tile for tile in tiles_of(root) if "content" in tile]
    everywhere = np.array([element.corners_enu_m for _, element in scene.elements]).reshape(-1, 3)
    np.testing.assert_allclose(box_of(root), [everywhere.min(axis=0), everywhere.max(axis=0)], atol=1.001e-3)
    for component, tile in zip(scene.components[:-1], tiles, strict=True):
        corners = np.array([element.corners_enu_m for element in component.elements]).reshape(-1, 3)
        low, high = box_of(tile)
        np.testing.assert_allclose(low, corners.min(axis=0), atol=1.001e-3)
        np.testing.assert_allclose(high, corners.max(axis=0), atol=1.001e-3)


def test_extents_are_those_of_three_standard_deviations():
    found = ellipsoids_of(synthetic_scene().components[0])
    for quat, scales, extents in zip(found.quats, found.scales_m, extents_m(found), strict=True):
        turn = rotation_of(quat[[1, 2, 3, 0]].astype(float))
        covariance = turn @ np.diag(scales.astype(float) ** 2) @ turn.T
        np.testing.assert_allclose(extents, 3.0 * np.sqrt(np.diag(covariance)), rtol=1e-5)


def test_boxes_and_errors_of_children_are_within_those_of_parents(tmp_path):
    write_tiles(synthetic_scene(SIZES, 100), tmp_path, TilesOptions(gaussians_per_tile=25))
    tileset = read(tmp_path)
    assert tileset["asset"]["version"] == "1.1"
    assert tileset["root"]["refine"] == "ADD"
    assert tileset["geometricError"] >= tileset["root"]["geometricError"]
    n_inner = 0
    for tile in tiles_of(tileset["root"]):
        assert ("content" in tile) != ("children" in tile)
        assert ("content" in tile) == (tile["geometricError"] == 0.0)
        low, high = box_of(tile)
        n_inner += "children" in tile
        for child in tile.get("children", ()):
            child_low, child_high = box_of(child)
            assert (child_low >= low - 1e-3).all()
            assert (child_high <= high + 1e-3).all()
            assert child["geometricError"] <= tile["geometricError"]
    assert n_inner > 4


def test_tiles_that_are_shared_out_show_fewer_gaussians_of_all_their_panels(tmp_path):
    scene = synthetic_scene(((2000, 0, 1500, 1800, 900), (20,)), 3000)
    write_tiles(scene, tmp_path, TilesOptions(gaussians_per_tile=1000, gaussians="numbers"))
    root, n_inner = read(tmp_path)["root"], 0
    for tile in tiles_of(root):
        if not ("content" in tile and "children" in tile):
            continue
        n_inner += 1
        assert tile["refine"] == "REPLACE"
        below = [found for child in tile["children"] for found in tiles_of(child)]
        assert all("-gaussians-" in found["content"]["uri"] for found in below)
        sides = [found["geometricError"] for found in below]
        assert tile["geometricError"] >= max(sides)
        assert tile["geometricError"] > 0.0
        finest = [found for found in below if "children" not in found]
        glb, *others = (Glb((tmp_path / found["content"]["uri"]).read_bytes()) for found in (tile, *finest))
        assert panels_of(glb) == set().union(*map(panels_of, others))
        means = means_of(glb)
        assert len(means) <= 1000 < sum(len(means_of(other)) for other in others)
        low, high = box_of(tile)
        assert (means + scene.origin_enu_m >= low - 1e-5).all()
        assert (means + scene.origin_enu_m <= high + 1e-5).all()
    assert n_inner >= 4
    assert [child["geometricError"] > 0.0 for child in root["children"]] == [True, True, True]
    assert read(tmp_path)["geometricError"] >= root["geometricError"]


@pytest.mark.long
def test_without_coarser_ones_each_gaussian_is_in_the_folder_once(tmp_path):
    scene = synthetic_scene(((2000, 1500),), 3000)
    write_tiles(scene, tmp_path, TilesOptions(gaussians_per_tile=1000, has_coarser=False))
    for tile in tiles_of(read(tmp_path)["root"]):
        assert ("content" in tile) != ("children" in tile)
        assert tile.get("refine", "ADD") == "ADD"
    n = len(files_of(tmp_path))
    write_tiles(scene, tmp_path, TilesOptions(gaussians_per_tile=1000))
    assert len(files_of(tmp_path)) > n


def test_three_tilesets_share_the_files(tmp_path):
    write_tiles(synthetic_scene(SIZES, 10), tmp_path)
    everything = files_of(tmp_path)
    gaussians, panels = files_of(tmp_path, "gaussians.json"), files_of(tmp_path, "panels.json")
    assert sorted(gaussians + panels) == sorted(everything)
    assert all("-gaussians-" in name for name in gaussians)
    assert [name.split("-panels-")[0] for name in panels] == ["A", "B"]
    on_disk = {path.name for path in tmp_path.iterdir()}
    assert on_disk == {*everything, "tileset.json", "gaussians.json", "panels.json"}


def test_a_tileset_of_compressed_gaussians_says_what_its_files_need(tmp_path):
    write_tiles(synthetic_scene(SIZES, 10), tmp_path)
    needed = read(tmp_path, "gaussians.json")
    assert needed["extensionsUsed"] == [CONTENT]
    assert needed["extensions"][CONTENT]["extensionsRequired"] == [SPLATTING, SPZ]
    for name in ("panels.json", "tileset.json"):
        assert "extensions" not in read(tmp_path, name)
    for file in files_of(tmp_path, "gaussians.json"):
        found = Glb((tmp_path / file).read_bytes()).json
        assert found["extensionsRequired"] == [SPLATTING, SPZ]
        # CesiumJS looks at the first node of the scene alone.
        (root,) = found["scenes"][0]["nodes"]
        assert found["nodes"][root].keys() >= {"mesh", "matrix"}
    write_tiles(synthetic_scene(SIZES, 10), tmp_path, TilesOptions(gaussians="numbers"))
    assert "extensions" not in read(tmp_path, "gaussians.json")


def test_tiles_say_what_they_are(tmp_path):
    scene = synthetic_scene()
    facade, panel = scene.components[0], scene.components[0].elements[0]
    attributes = {facade.global_id: {"wall": "Süd"}, panel.global_id: {"maker": "Glaswerk"}}
    write_tiles(scene, tmp_path, TilesOptions(sh_degree=0), attributes)
    tileset = read(tmp_path)
    classes = tileset["schema"]["classes"]
    assert tileset["metadata"] == {"class": "site", "properties": {"global_id": scene.global_id, "name": "made"}}
    found = tileset["root"]["children"][0]
    assert found["metadata"]["properties"] == {
        "global_id": facade.global_id,
        "name": "A",
        "kind": "facade",
        "n_panels": 3,
        "n_gaussians": 8,
    }
    assert found["metadata"]["properties"].keys() == classes["component"]["properties"].keys()
    assert found["extras"]["attributes"] == {"wall": "Süd"}
    panels = Glb((tmp_path / files_of(tmp_path, "panels.json")[0]).read_bytes())
    assert panels.table[0]["maker"] == "Glaswerk"
    schema = panels.json["extensions"]["EXT_structural_metadata"]["schema"]
    assert schema["classes"]["panel"] == classes["panel"]
    # A facade without the attribute has the same columns.
    others = Glb((tmp_path / files_of(tmp_path, "panels.json")[1]).read_bytes())
    assert others.json["extensions"]["EXT_structural_metadata"]["schema"] == schema


def test_new_tiles_take_the_place_of_old_ones_and_of_nothing_else(tmp_path):
    write_tiles(synthetic_scene(), tmp_path)
    (tmp_path / "photo.png").write_bytes(b"mine")
    (tmp_path / "other-0123456789ab.glb").write_bytes(b"mine, too")
    write_tiles(synthetic_scene(seed=1), tmp_path)
    on_disk = {path.name for path in tmp_path.iterdir()}
    mine = {"photo.png", "other-0123456789ab.glb"}
    assert on_disk == {*files_of(tmp_path), "tileset.json", "gaussians.json", "panels.json", *mine}
    first = contents_of(tmp_path)
    write_tiles(synthetic_scene(seed=1), tmp_path)
    assert contents_of(tmp_path) == first


def test_a_tileset_of_somebody_else_has_no_say_in_what_is_removed(tmp_path):
    folder = tmp_path / "tiles"
    folder.mkdir()
    (tmp_path / "a-0123456789ab.glb").write_bytes(b"mine")
    uris = [{"uri": "../a-0123456789ab.glb"}, {"uri": 3}, {"uri": "tileset.json"}]
    (folder / "tileset.json").write_text(json.dumps(uris))
    write_tiles(synthetic_scene(), folder)
    (folder / "tileset.json").write_text("[" * 100_000)
    write_tiles(synthetic_scene(), folder)
    assert (tmp_path / "a-0123456789ab.glb").read_bytes() == b"mine"
    assert len(files_of(folder)) == 5


@pytest.mark.parametrize("after", [0, 1, 3])
def test_an_export_that_ends_early_leaves_the_old_tiles(tmp_path, after):
    options = TilesOptions(gaussians_per_tile=4)
    write_tiles(synthetic_scene(), tmp_path, options)
    before = contents_of(tmp_path)
    with pytest.raises(OperationCancelled):
        write_tiles(synthetic_scene(seed=1), tmp_path, options, monitor=Cancelling(after))
    assert contents_of(tmp_path) == before
    bad = component_with(synthetic_scene(), 1, means=np.full((2, 3), np.nan, np.float32))
    with pytest.raises(InputError, match="train again"):
        write_tiles(bad, tmp_path, options)
    assert contents_of(tmp_path) == before


def test_scenes_of_nothing_are_refused(tmp_path):
    for scene in (synthetic_scene((), 0), synthetic_scene(((),), 0)):
        with pytest.raises(InputError, match="neither Gaussians nor panels"):
            write_tiles(scene, tmp_path)
    assert not list(tmp_path.iterdir())
    write_tiles(synthetic_scene(((0,),), 0), tmp_path)
    assert len(files_of(tmp_path)) == 1
    assert not files_of(tmp_path, "gaussians.json")


def test_hostile_names_make_harmless_files(tmp_path):
    scene = synthetic_scene(((1,),) * len(HOSTILE[:7]), 1)
    components = [replace(one, name=name) for one, name in zip(scene.components, HOSTILE[:7], strict=False)]
    folder = tmp_path / "tiles"
    write_tiles(replace(scene, components=(*components, scene.components[-1]), name=HOSTILE[4]), folder)
    assert [path.name for path in tmp_path.iterdir()] == ["tiles"]
    for path in folder.iterdir():
        assert path.is_file()
        assert set(path.name) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.")
    names = [tile["metadata"]["properties"]["name"] for tile in read(folder)["root"]["children"]]
    assert names[0] == HOSTILE[0]


def test_wrong_options_are_wrong_calls():
    with pytest.raises(ValueError, match="gaussians_per_tile"):
        TilesOptions(gaussians_per_tile=0)
    with pytest.raises(ValueError, match="sh_degree"):
        TilesOptions(sh_degree=-1)


@given(st.lists(st.integers(0, 9), max_size=12), st.integers(0, 40), st.integers(1, 12), st.booleans())
def test_branches_share_out_all_that_a_component_has(sizes, n_background, at_most, is_one_place):
    scene = synthetic_scene((tuple(sizes),), n_background)
    for component in scene.components:
        if is_one_place:
            component.gaussians.values["means"][:] = 1.0
        leaves, open_ = [], [branches_of(component, at_most)]
        while open_:
            branch = open_.pop()
            open_ += branch.halves
            if not branch.halves:
                leaves.append(part_of_branch(component, branch))
            assert all(len(half.items) for half in branch.halves)
        places = np.concatenate([leaf.gaussians.places for leaf in leaves])
        assert sorted(places) == sorted(component.gaussians.places)
        panels = dict(zip(component.gaussians.places.tolist(), ellipsoids_of(component).panels.tolist(), strict=True))
        for leaf in leaves:
            assert len(leaf.gaussians) <= at_most or len(leaf.elements) == 1
            assert [panels[place] for place in leaf.gaussians.places] == ellipsoids_of(leaf).panels.tolist()
