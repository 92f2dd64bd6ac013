"""Binary glTF: by its specification, and by a reader that is not ours."""

import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports.component_parts import AT_ONCE, ellipsoids_of, part_of
from reconstruction.exports.compression import PRESETS
from reconstruction.exports.glb import SPZ, GlbBuffer, identifier, one_after_the_other, write_glb
from reconstruction.exports.gltf import GltfOptions, write_gltf
from reconstruction.objects.gs_scene import GsGaussian
from tests.reconstruction.exports.glb_reader import FEATURES, SPLATTING, Glb
from tests.reconstruction.exports.spz.reading import read_spz
from tests.reconstruction.objects.synthetic_scene import gaussians, synthetic_scene

IDENTIFIER = re.compile(r"[a-zA-Z_][a-zA-Z0-9_]*")

HOSTILE = ['"><img src=x>', "../../etc/passwd", "a\0b\n\t\x1b[31m", "Ä-☃-𝄞", "\ud800", " ", "'; DROP TABLE", "x" * 500]


class Cancelling:
    def __init__(self, after):
        self.left = after

    def report(self, stage, done, total):
        if self.left == 0:
            raise OperationCancelled
        self.left -= 1


def written(scene, folder, *arguments, **options):
    path = folder / "model.glb"
    write_gltf(scene, path, *arguments, **options)
    return Glb(path.read_bytes())


def rotation_of(xyzw):
    x, y, z, w = xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def component_with(scene, number, **values):
    """The scene with other Gaussians' values in one component."""
    component = scene.components[number]
    table = GsGaussian({**component.gaussians.values, **values}, component.gaussians.places)
    components = list(scene.components)
    components[number] = replace(component, gaussians=table)
    return replace(scene, components=tuple(components))


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_gaussians_have_the_numbers_of_the_scene(tmp_path, degree):
    scene = synthetic_scene()
    found = written(scene, tmp_path, GltfOptions(sh_degree=degree))
    for component in scene.components:
        expected, values = ellipsoids_of(component), found.attributes(f"{component.name}: Gaussians")
        assert np.array_equal(values["POSITION"], expected.means_m)
        assert np.array_equal(values[f"{SPLATTING}:ROTATION"], expected.quats[:, [1, 2, 3, 0]])
        assert np.array_equal(values[f"{SPLATTING}:SCALE"], expected.scales_m)
        assert np.array_equal(values[f"{SPLATTING}:OPACITY"], expected.opacities)
        names = [f"{SPLATTING}:SH_DEGREE_{of}_COEF_{m}" for of in range(degree + 1) for m in range(2 * of + 1)]
        assert {name for name in values if "SH_DEGREE" in name} == set(names)
        for number, name in enumerate(names):
            assert np.array_equal(values[name], expected.sh[:, number])
        primitive = found.primitives[f"{component.name}: Gaussians"]
        assert primitive["mode"] == 0
        splatting = primitive["extensions"][SPLATTING]
        assert (splatting["kernel"], splatting["colorSpace"]) == ("ellipse", "srgb_rec709_display")


def test_points_alone_are_the_same_points(tmp_path):
    scene = synthetic_scene()
    whole = written(scene, tmp_path).attributes("A: Gaussians")
    found = written(scene, tmp_path, GltfOptions(gaussians="points"))
    points = found.attributes("A: Gaussians")
    assert points.keys() == {"POSITION", "COLOR_0", "_FEATURE_ID_0"}
    assert all(np.array_equal(values, whole[name]) for name, values in points.items())
    assert SPLATTING not in found.json["extensionsUsed"]


@pytest.mark.parametrize("degree", [0, 1, 3])
def test_compressed_gaussians_are_those_of_the_file_within_the_file(tmp_path, degree):
    scene = synthetic_scene(((300, 0, 5), (2,)), 40)
    options = GltfOptions(sh_degree=degree, gaussians="spz", compression=PRESETS["fine"])
    found = written(scene, tmp_path, options)
    assert found.json["extensionsRequired"] == [SPLATTING, SPZ]
    assert {SPLATTING, SPZ} <= set(found.json["extensionsUsed"])
    for component in scene.components:
        primitive = found.primitives[f"{component.name}: Gaussians"]
        n = len(component.gaussians)
        accessors = {name: found.json["accessors"][number] for name, number in primitive["attributes"].items()}
        assert all(each["count"] == n and "bufferView" not in each for each in accessors.values())
        coefficients = [
            f"{SPLATTING}:SH_DEGREE_{of}_COEF_{m}" for of in range(1, degree + 1) for m in range(2 * of + 1)
        ]
        own = ["POSITION", "COLOR_0", f"{SPLATTING}:ROTATION", f"{SPLATTING}:SCALE"]
        assert list(accessors) == own + coefficients
        means = component.gaussians.values["means"]
        assert accessors["POSITION"]["min"] == means.min(axis=0).tolist()
        # Without kernel and colours of degree 0 it is the way of the draft that CesiumJS reads.
        assert primitive["extensions"][SPLATTING].keys() == {"extensions"}
        view = primitive["extensions"][SPLATTING]["extensions"][SPZ]["bufferView"]
        alone = tmp_path / "alone.spz"
        alone.write_bytes(found.view(view))
        read, expected = read_spz(alone, "enu"), ellipsoids_of(component)
        nearest = np.linalg.norm(read.means_m[:, None] - expected.means_m, axis=2).argmin(axis=1)
        assert np.array_equal(np.sort(nearest), np.arange(n))
        np.testing.assert_allclose(read.means_m, expected.means_m[nearest], atol=1e-3)
        np.testing.assert_allclose(read.opacities, expected.opacities[nearest], atol=0.003)
        n_read = (degree + 1) ** 2
        # The format has display colours from -0.44 to 1.44, and higher degrees from -1 to 1.
        most = np.where(np.arange(n_read) == 0, 0.94 / 0.28209479, 1.0)[:, None]
        np.testing.assert_allclose(read.sh[:, :n_read], np.clip(expected.sh[nearest, :n_read], -most, most), atol=0.03)


def test_compressed_gaussians_that_nobody_sees_stay_so_that_no_file_is_without_any(tmp_path):
    scene = synthetic_scene(((3,),), 0)
    for component in scene.components:
        component.gaussians.values["opacity_logits"][:] = -20.0
    found = written(scene, tmp_path, GltfOptions(gaussians="spz"))
    assert found.json["accessors"][found.primitives["A: Gaussians"]["attributes"]["POSITION"]]["count"] == 3


def test_points_of_viewers_without_gaussians_have_the_diffuse_colour(tmp_path):
    scene = synthetic_scene()
    values = written(scene, tmp_path).attributes("background: Gaussians")
    display = np.clip(0.5 + values[f"{SPLATTING}:SH_DEGREE_0_COEF_0"] / (2.0 * np.sqrt(np.pi)), 0.0, 1.0)
    light = values["COLOR_0"][:, :3]
    back = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(back, display, atol=2e-4)
    np.testing.assert_allclose(values["COLOR_0"][:, 3], values[f"{SPLATTING}:OPACITY"], atol=1e-5)


def test_the_root_turns_east_north_up_into_y_up_at_the_place_in_the_site(tmp_path):
    scene = synthetic_scene()
    found = written(scene, tmp_path)
    (root,) = found.json["scenes"][0]["nodes"]
    node = found.json["nodes"][root]
    matrix = np.array(node["matrix"]).reshape(4, 4).T
    turn = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    np.testing.assert_array_equal(matrix[:3, :3], turn)
    np.testing.assert_array_equal(matrix[:3, 3], turn @ np.array(scene.origin_enu_m))
    np.testing.assert_array_equal(matrix[3], [0, 0, 0, 1])
    names = [found.json["nodes"][child]["name"] for child in node["children"]]
    assert names == [component.name for component in scene.components]
    extras = found.json["asset"]["extras"]
    assert extras["origin_wgs84"] == {"lat_deg": 22.3372, "lon_deg": 114.2636, "ellipsoid_height_m": 62.0}
    assert extras["origin_enu_m"] == list(scene.origin_enu_m)


def test_another_reader_finds_points_and_panels_where_they_are(tmp_path):
    scene = synthetic_scene(((300, 0, 5), (2,)), 40)
    write_gltf(scene, tmp_path / "model.glb")
    read = trimesh.load(tmp_path / "model.glb")
    turn = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    placed = {}
    for name in read.graph.nodes_geometry:
        transform, geometry = read.graph[name]
        placed[geometry] = trimesh.transform_points(read.geometry[geometry].vertices, transform)
    for component in scene.components:
        expected = (component.gaussians.values["means"] + np.array(scene.origin_enu_m)) @ turn.T
        np.testing.assert_allclose(placed[f"{component.name}: Gaussians"], expected, atol=1e-5)
        if component.elements:
            panels = read.geometry[f"{component.name}: panels"]
            corners = np.array([element.corners_enu_m for element in component.elements]).reshape(-1, 3)
            np.testing.assert_allclose(placed[f"{component.name}: panels"], corners @ turn.T, atol=1e-6)
            areas = panels.area_faces.reshape(-1, 2).sum(axis=1)
            np.testing.assert_allclose(areas, 1.35 * 1.8, rtol=1e-6)
            # The facade looks south: -y, in the frame of the mesh.
            np.testing.assert_allclose(panels.face_normals, np.tile([0.0, -1.0, 0.0], (len(areas) * 2, 1)), atol=1e-6)


def test_rows_of_the_table_are_those_that_gaussians_and_quads_name(tmp_path):
    scene = synthetic_scene(((3, 0, 5), (2, 1)))
    found = written(scene, tmp_path)
    rows = found.table
    for component in scene.components[:-1]:
        quads = found.attributes(f"{component.name}: panels")
        assert found.primitives[f"{component.name}: panels"]["mode"] == 4
        for number, element in enumerate(component.elements):
            ids = quads["_FEATURE_ID_0"][4 * number : 4 * number + 4]
            assert (ids == ids[0]).all()
            assert rows[int(ids[0])]["IFC GlobalId"] == element.global_id
            np.testing.assert_allclose(
                quads["POSITION"][4 * number : 4 * number + 4] + np.array(scene.origin_enu_m),
                element.corners_enu_m,
                atol=1e-6,
            )
        ids = found.attributes(f"{component.name}: Gaussians")["_FEATURE_ID_0"]
        names = [element.name for element in component.elements for _ in range(element.n_gaussians)]
        assert [rows[int(row)]["Name"] for row in ids] == names
        features = found.primitives[f"{component.name}: Gaussians"]["extensions"][FEATURES]["featureIds"][0]
        assert features["featureCount"] == len(set(ids.tolist()))
    assert "_FEATURE_ID_0" not in found.attributes("background: Gaussians")
    assert rows[0]["Area, m2"] == pytest.approx(1.35 * 1.8)
    assert (rows[0]["Width, m"], rows[0]["Height, m"]) == (pytest.approx(1.35), pytest.approx(1.8))
    assert [row["Facade"] for row in rows] == ["A", "A", "A", "B", "B"]


def test_quads_are_not_seen_and_not_passed_through(tmp_path):
    (material,) = written(synthetic_scene(), tmp_path).json["materials"]
    opacity = material["pbrMetallicRoughness"]["baseColorFactor"][3]
    # Less than half a step of 8 bits, and more than nothing: viewers discard fragments of opacity 0 when picking.
    assert 0.0 < opacity * 255 < 0.5
    assert (material["alphaMode"], material["doubleSided"]) == ("BLEND", True)
    with pytest.raises(ValueError, match="panel_opacity"):
        GltfOptions(panel_opacity=0.0)
    with pytest.raises(ValueError, match="sh_degree"):
        GltfOptions(sh_degree=4)


VALUES = st.one_of(
    st.none(),
    st.text(max_size=12),
    st.integers(-(2**70), 2**70),
    st.integers(-(2**31), 2**31),
    st.floats(allow_nan=False, allow_infinity=False),
)


@given(
    st.lists(st.dictionaries(st.text(max_size=8), VALUES, max_size=4), min_size=3, max_size=3),
    st.booleans(),
)
def test_attributes_come_back_as_they_were(tmp_path_factory, given_attributes, is_named):
    scene = synthetic_scene(((1, 0, 2),), 0)
    ids = [element.global_id for _, element in scene.elements]
    attributes = dict(zip(ids, given_attributes, strict=True)) | ({"unknown": {"a": 1}} if is_named else {})
    found = written(scene, tmp_path_factory.mktemp("glb"), GltfOptions(0), attributes)
    columns = found.json["extensions"]["EXT_structural_metadata"]["schema"]["classes"]["panel"]["properties"]
    assert all(IDENTIFIER.fullmatch(key) for key in columns)
    own = {"IFC GlobalId", "Name", "Facade", "Number in the model", "Area, m2", "Width, m", "Height, m"}
    for row, expected in zip(found.table, given_attributes, strict=True):
        for name, value in expected.items():
            if value is None or value == "" or name in own:
                continue
            back = row[name]
            # A column that holds texts, or whole numbers too long for it, has all values as texts.
            assert back == value or back == str(value) or back == str(float(value))
        assert set(row) - own <= {name for name, value in expected.items() if value not in (None, "")}


def test_columns_have_the_narrowest_type_that_holds_all(tmp_path):
    scene = synthetic_scene(((1, 1, 1),), 0)
    columns = {
        "few": (1, -2, 3),
        "some missing": (-(2**31), None, 0),
        "long": (2**40, 0, 1),
        "too long": (2**70, 0, 1),
        "mixed": (1, 2.5, None),
        "inexact": (2**60 + 1, 0.5, 1),
        "texts": ("a", 1, None),
        "none": (None, "", None),
    }
    ids = [element.global_id for _, element in scene.elements]
    attributes = {each: {name: values[n] for name, values in columns.items()} for n, each in enumerate(ids)}
    found = written(scene, tmp_path, GltfOptions(), attributes)
    properties = found.json["extensions"]["EXT_structural_metadata"]["schema"]["classes"]["panel"]["properties"]
    types = {one["name"]: one.get("componentType", one["type"]) for one in properties.values()}
    assert {name: types.get(name) for name in columns} == {
        "few": "INT32",
        "some missing": "INT64",
        "long": "INT64",
        "too long": "STRING",
        "mixed": "FLOAT64",
        "inexact": "STRING",
        "texts": "STRING",
        "none": None,
    }
    assert found.table[0]["some missing"] == -(2**31)
    assert "some missing" not in found.table[1]
    assert found.table[1]["mixed"] == 2.5


def test_hostile_names_stay_data(tmp_path):
    scene = synthetic_scene(((1,) * len(HOSTILE), (2,)), 1)
    component = scene.components[0]
    elements = tuple(replace(element, name=name) for element, name in zip(component.elements, HOSTILE, strict=True))
    named = replace(component, name='../"A"\0', elements=elements)
    scene = replace(scene, name="</script>\ud800", components=(named, *scene.components[1:]))
    attributes = {element.global_id: {element.name: element.name} for element in elements}
    found = written(scene, tmp_path, GltfOptions(), attributes)
    for row, name in zip(found.table, HOSTILE, strict=False):
        readable = name.encode("utf-8", "replace").decode()
        assert row["Name"] == readable
        assert row[readable] == readable
    assert found.json["nodes"][found.json["scenes"][0]["nodes"][0]]["name"] == "</script>?"
    assert [path.name for path in tmp_path.iterdir()] == ["model.glb"]


@pytest.mark.parametrize(
    ("sizes", "n_background", "n_meshes"),
    [((), 0, 0), (((0, 0),), 0, 1), ((), 1, 1), (((),), 2, 1), (((1,), ()), 0, 2)],
)
def test_scenes_may_lack_anything(tmp_path, sizes, n_background, n_meshes):
    scene = replace(synthetic_scene(sizes, n_background), origin=None)
    found = written(scene, tmp_path)
    assert len(found.json.get("meshes", [])) == n_meshes
    assert found.json["asset"]["extras"]["origin_wgs84"] is None
    assert len(found.json["nodes"]) == 1 + len(scene.components) + n_meshes
    for mesh in found.primitives:
        assert all(np.isfinite(values).all() for values in found.attributes(mesh).values())


def test_sizes_may_be_as_good_as_none(tmp_path):
    scene = synthetic_scene((), 5)
    scene = component_with(scene, 0, log_scales=np.full((5, 3), -200.0, np.float32))
    scales = written(scene, tmp_path).attributes("background: Gaussians")[f"{SPLATTING}:SCALE"]
    assert (scales == 0.0).all()


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("column", ["means", "quats", "log_scales", "opacity_logits", "sh"])
def test_numbers_that_are_none_are_refused_and_the_old_file_stays(tmp_path, column, number):
    scene = synthetic_scene()
    write_gltf(scene, tmp_path / "model.glb")
    before = (tmp_path / "model.glb").read_bytes()
    values = scene.components[1].gaussians.values[column].copy()
    values.flat[-1] = number
    with pytest.raises(InputError, match=rf"model\.glb: component 'B': {column}: .*train again"):
        write_gltf(component_with(scene, 1, **{column: values}), tmp_path / "model.glb")
    assert (tmp_path / "model.glb").read_bytes() == before


def test_attributes_sizes_and_origins_must_be_numbers(tmp_path):
    scene = synthetic_scene()
    path = tmp_path / "model.glb"
    first = scene.components[0].elements[0]
    with pytest.raises(InputError, match="attribute 'u': expected finite numbers, got nan"):
        write_gltf(scene, path, attributes={first.global_id: {"u": np.nan}})
    with pytest.raises(InputError, match="origin"):
        write_gltf(replace(scene, origin_enu_m=(0.0, np.inf, 0.0)), path)
    with pytest.raises(InputError, match="log_scales"):
        write_gltf(component_with(scene, 0, log_scales=np.full((8, 2), 80.0, np.float32)), path)
    corners = ((np.nan, 0.0, 0.0), *first.corners_enu_m[1:])
    others = scene.components[0].elements[1:]
    broken = replace(scene.components[0], elements=(replace(first, corners_enu_m=corners), *others))
    with pytest.raises(InputError, match=f"panel '{first.name}': its corners"):
        write_gltf(replace(scene, components=(broken,)), path)
    twice = replace(scene.components[0], elements=tuple(replace(each, global_id="x") for each in (first, *others)))
    with pytest.raises(InputError, match="same GlobalId"):
        write_gltf(replace(scene, components=(twice,)), path)
    assert not list(tmp_path.iterdir())


def test_a_cancelled_export_leaves_the_old_file(tmp_path):
    scene = synthetic_scene()
    write_gltf(scene, tmp_path / "model.glb")
    before = (tmp_path / "model.glb").read_bytes()
    with pytest.raises(OperationCancelled):
        write_gltf(synthetic_scene(seed=1), tmp_path / "model.glb", monitor=Cancelling(after=1))
    assert (tmp_path / "model.glb").read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


def test_places_that_cannot_be_written_are_refused(tmp_path):
    with pytest.raises(InputError, match="no folder"):
        write_gltf(synthetic_scene(), tmp_path / "none" / "model.glb")
    with pytest.raises(InputError, match="folder"):
        write_gltf(synthetic_scene(), tmp_path)
    with pytest.raises(InputError, match="no file"):
        write_gltf(synthetic_scene(), type(tmp_path)("/dev/null"))


def test_more_than_four_gigabytes_are_refused(tmp_path):
    buffer = GlbBuffer()
    buffer.view(2**32)
    with pytest.raises(InputError, match=r"would have 4\.3 GB"):
        write_glb(tmp_path / "model.glb", {"asset": {"version": "2.0"}}, buffer)
    assert not list(tmp_path.iterdir())


def test_the_same_scene_makes_the_same_bytes(tmp_path):
    attributes = {synthetic_scene().components[0].elements[0].global_id: {"b": 1, "a": "x"}}
    for name in ("one.glb", "two.glb"):
        write_gltf(synthetic_scene(), tmp_path / name, attributes=attributes)
    assert (tmp_path / "one.glb").read_bytes() == (tmp_path / "two.glb").read_bytes()


def test_blocks_are_those_of_the_whole(tmp_path):
    scene = synthetic_scene(((AT_ONCE - 1, 0, 3), (5,)), 2)
    found = written(scene, tmp_path, GltfOptions(0))
    expected, values = ellipsoids_of(scene.components[0]), found.attributes("A: Gaussians")
    assert np.array_equal(values["POSITION"], expected.means_m)
    assert np.array_equal(values[f"{SPLATTING}:OPACITY"], expected.opacities)
    assert np.array_equal(np.flatnonzero(np.diff(values["_FEATURE_ID_0"])), [AT_ONCE - 2])
    assert values["_FEATURE_ID_0"][-1] == 2


@given(st.lists(st.integers(0, 4), max_size=5), st.integers(0, 12), st.integers(0, 12))
def test_parts_keep_the_elements_of_their_rows(sizes, start, length):
    component = synthetic_scene((tuple(sizes),), 0).components[0]
    n = len(component.gaussians)
    start, stop = min(start, n), min(start + length, n)
    part = part_of(component, start, stop)
    assert len(part.gaussians) == stop - start
    assert np.array_equal(ellipsoids_of(part).panels, ellipsoids_of(component).panels[start:stop])


@given(st.lists(st.text(max_size=6)))
def test_names_become_different_identifiers(names):
    found = one_after_the_other(map(identifier, names))
    assert len(set(found)) == len(names)
    assert all(IDENTIFIER.fullmatch(name) for name in found)


def test_gaussians_of_three_sizes_keep_the_third(tmp_path):
    rng = np.random.default_rng(0)
    scene = synthetic_scene((), 4)
    sizes = rng.normal(-3.0, 1.0, (4, 3)).astype(np.float32)
    scene = component_with(scene, 0, **gaussians(4, rng).values | {"log_scales": sizes})
    scales = written(scene, tmp_path).attributes("background: Gaussians")[f"{SPLATTING}:SCALE"]
    np.testing.assert_allclose(scales, np.exp(sizes), rtol=1e-6)
