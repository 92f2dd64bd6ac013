"""glTF and 3D Tiles in programs of others: Khronos' validator, Babylon.js, loaders.gl."""

import json
import struct

import numpy as np
import pytest

from reconstruction.exports.component_parts import ellipsoids_of
from reconstruction.exports.glb import SPLATTING, SPZ
from reconstruction.exports.gltf import GltfOptions, write_gltf
from reconstruction.exports.tiles3d import TilesOptions, write_tiles
from tests.foreign import run_node
from tests.reconstruction.exports.glb_reader import Glb
from tests.reconstruction.exports.test_gltf import HOSTILE
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

pytestmark = pytest.mark.slow

KNOWN_TO_FEW = {SPLATTING, SPZ, "EXT_mesh_features", "EXT_structural_metadata"}
"""Extensions that the validator does not know, and says so."""


def renamed(path):
    """The file with attributes of the extension under names that any reader has to look at.

    The validator knows no KHR_gaussian_splatting and takes its names of attributes for wrong ones.
    """
    content = path.read_bytes()
    glb = Glb(content)
    text = json.dumps(glb.json).replace('"KHR_gaussian_splatting:', '"_').encode()
    text += b" " * (-len(text) % 4)
    rest = content[20 + struct.unpack_from("<I", content, 12)[0] :]
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON")
    other = path.with_name("renamed.glb")
    other.write_bytes(head + text + rest)
    return other


def attributes_for(scene):
    values = [{"maker": "Glas „ä“ ☃", "age": 3, "u": 1.25}, {"age": None, "u": 5}, {"maker": "x", "wide": 2**70}]
    ids = [element.global_id for _, element in scene.elements]
    return dict(zip(ids, values, strict=False)), ids


@pytest.mark.parametrize("gaussians", ["numbers", "spz"])
@pytest.mark.parametrize(("sizes", "rest", "degree"), [(((3, 0, 5), (2,)), 4, 3), (((0, 0),), 0, 1), ((), 1, 0)])
def test_khronos_validator_finds_nothing(tmp_path, sizes, rest, degree, gaussians):
    scene = synthetic_scene(sizes, rest)
    path = tmp_path / "model.glb"
    write_gltf(scene, path, GltfOptions(sh_degree=degree, gaussians=gaussians), attributes_for(scene)[0])
    issues = run_node("validate_gltf.js", renamed(path))["issues"]
    told = [each for each in issues["messages"] if each["code"] != "UNUSED_OBJECT"]
    assert {each["code"] for each in told} <= {"UNSUPPORTED_EXTENSION"}
    assert len(told) <= len(KNOWN_TO_FEW)
    # Tables of properties are used by an extension alone.
    used = Glb(path.read_bytes()).json
    views = {accessor["bufferView"] for accessor in used.get("accessors", []) if "bufferView" in accessor}
    unused = {int(each["pointer"].split("/")[-1]) for each in issues["messages"] if each["code"] == "UNUSED_OBJECT"}
    assert unused.isdisjoint(views)
    wrong = run_node("validate_gltf.js", path)["issues"]["messages"]
    errors = [each for each in wrong if each["severity"] == 0]
    assert all("/attributes/KHR_gaussian_splatting:" in each["pointer"] for each in errors)


def test_babylon_finds_gaussians_and_panels(tmp_path):
    scene = synthetic_scene(((30, 0, 50), (2,)), 40)
    path = tmp_path / "model.glb"
    write_gltf(scene, path)
    found = run_node("read_babylon.js", path)
    splats = {each["name"]: each for each in found["splats"]}
    for component in scene.components:
        expected, read = ellipsoids_of(component), splats[f"{component.name}: Gaussians"]
        assert (read["parent"], read["degree"]) == (component.name, 3)
        np.testing.assert_array_equal(np.float32(read["positions"]), expected.means_m)
        np.testing.assert_array_equal(np.float32(read["scales"]), expected.scales_m)
        colours = np.clip(0.5 + expected.sh[:, 0] / (2.0 * np.sqrt(np.pi)), 0.0, 1.0) * 255.0
        np.testing.assert_allclose(np.array(read["colours"])[:, :3], colours, atol=0.51)
        np.testing.assert_allclose(np.array(read["colours"])[:, 3], expected.opacities * 255.0, atol=0.51)
    for mesh in found["meshes"]:
        (component,) = [each for each in scene.components if mesh["name"] == f"{each.name}: panels"]
        x, y, z = np.array([element.corners_enu_m for element in component.elements]).reshape(-1, 3).T
        np.testing.assert_allclose(mesh["corners"], np.column_stack([x, z, -y]), atol=1e-5)
        assert 0.0 < mesh["visibility"] < 0.002
    assert len(found["meshes"]) == 2


def test_loaders_gl_finds_the_records_of_panels(tmp_path):
    scene = synthetic_scene(((3, 0, 5), (2,)))
    attributes, ids = attributes_for(scene)
    path = tmp_path / "model.glb"
    write_gltf(scene, path, GltfOptions(), attributes)
    found = run_node("read_loaders.js", path)
    (table,) = found["tables"]
    assert table["global_id"] == ids
    assert table["maker"] == ["Glas „ä“ ☃", "no data", "x", "no data"]
    assert table["age"][0] == 3
    assert table["u"][:2] == [1.25, 5.0]
    assert table["wide"][2] == str(2**70)
    assert found["features"]["B: panels"] == [3, 3, 3, 3]
    assert found["features"]["A: Gaussians"] == [0, 0, 0, 2, 2, 2, 2, 2]


def test_loaders_gl_walks_the_tileset(tmp_path):
    scene = synthetic_scene(((30, 0, 50, 9), (2,)), 100, name=HOSTILE[0])
    write_tiles(scene, tmp_path, TilesOptions(gaussians_per_tile=25))
    found = run_node("read_tileset.js", tmp_path / "tileset.json")
    assert (found["type"], found["version"]) == ("TILES3D", "1.1")
    urls = [tile["url"] for tile in found["tiles"] if tile["type"] == "scenegraph"]
    assert sorted(urls) == sorted(str(path) for path in tmp_path.glob("*.glb"))
    assert all((tile["type"] == "scenegraph") == (tile["error"] == 0.0) for tile in found["tiles"])
    write_tiles(synthetic_scene(((900, 800),), 3000), tmp_path, TilesOptions(gaussians_per_tile=1000))
    coarser = [tile for tile in run_node("read_tileset.js", tmp_path / "tileset.json")["tiles"] if tile["n_children"]]
    assert {(tile["type"], tile.get("refine")) for tile in coarser} == {
        ("empty", 1),
        ("empty", None),
        ("scenegraph", 2),
    }
