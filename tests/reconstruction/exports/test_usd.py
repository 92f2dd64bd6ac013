"""USD: read back and judged by OpenUSD itself."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports.component_parts import ellipsoids_of
from reconstruction.exports.usd import UsdOptions, write_usd
from tests.reconstruction.exports.test_gltf import HOSTILE, Cancelling, component_with
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Gf, Usd, UsdGeom, UsdUtils, UsdValidation, UsdVol


def opened(scene, folder, *arguments, name="model.usdc", **options):
    write_usd(scene, folder / name, *arguments, **options)
    assert [path.name for path in folder.iterdir()] == [name]
    return Usd.Stage.Open(str(folder / name))


def complaints(stage):
    """Of all of OpenUSD's own validators."""
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    return [error.GetErrorAsString() for error in context.Validate(stage)]


@pytest.mark.parametrize(
    ("degree", "name"), [(0, "model.usda"), (1, "model.usd"), (2, "model.usdc"), (3, "model.usdc")]
)
def test_gaussians_have_the_numbers_of_the_scene(tmp_path, degree, name):
    scene = synthetic_scene()
    stage = opened(scene, tmp_path, UsdOptions(sh_degree=degree), name=name)
    for component in scene.components:
        expected = ellipsoids_of(component)
        splats = UsdVol.ParticleField3DGaussianSplat(
            stage.GetPrimAtPath(f"/World/{component.name}/Gaussians")
        ).GetPrim()
        values = {each: np.array(splats.GetAttribute(each).Get()) for each in ("positions", "scales", "opacities")}
        assert np.array_equal(values["positions"], expected.means_m)
        assert np.array_equal(values["scales"], expected.scales_m)
        assert np.array_equal(values["opacities"], expected.opacities)
        quats = splats.GetAttribute("orientations").Get()
        assert [(q.real, *q.imaginary) for q in quats] == [tuple(row) for row in expected.quats.tolist()]
        assert splats.GetAttribute("radiance:sphericalHarmonicsDegree").Get() == degree
        harmonics = np.array(splats.GetAttribute("radiance:sphericalHarmonicsCoefficients").Get())
        assert np.array_equal(harmonics.reshape(len(expected), -1, 3), expected.sh[:, : (degree + 1) ** 2])
        low, high = np.array(UsdGeom.Boundable(splats).GetExtentAttr().Get())
        assert (low <= expected.means_m.min(axis=0)).all()
        assert (high >= expected.means_m.max(axis=0)).all()
    assert complaints(stage) == []


def test_the_stage_is_the_sites_frame(tmp_path):
    scene = synthetic_scene()
    stage = opened(scene, tmp_path)
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    world = stage.GetDefaultPrim()
    assert world.GetPath() == "/World"
    assert UsdGeom.Xformable(world).GetLocalTransformation().ExtractTranslation() == Gf.Vec3d(*scene.origin_enu_m)
    ours = world.GetCustomDataByKey("reflight")
    assert ours["global_id"] == scene.global_id
    assert ours["origin_wgs84"] == {"lat_deg": 22.3372, "lon_deg": 114.2636, "ellipsoid_height_m": 62.0}
    kinds = [Usd.ModelAPI(child).GetKind() for child in world.GetChildren()]
    assert kinds == ["component"] * len(scene.components)


def test_panels_are_quads_that_know_their_records(tmp_path):
    scene = synthetic_scene()
    first = scene.components[0].elements[0]
    attributes = {
        first.global_id: {"Material (außen)": 'Glas "ä"', "layer": "x", "age": 2**40, "far": 2**80, "none": None},
        scene.components[0].global_id: {"wall": 1.5},
    }
    stage = opened(scene, tmp_path, attributes=attributes)
    for component in scene.components[:-1]:
        for element in component.elements:
            prim = stage.GetPrimAtPath(f"/World/{component.name}/{element.name.replace('-', '_')}")
            mesh = UsdGeom.Mesh(prim)
            placed = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0)
            corners = [placed.Transform(Gf.Vec3d(point)) for point in mesh.GetPointsAttr().Get()]
            np.testing.assert_allclose(corners, element.corners_enu_m, atol=1e-6)
            ours = prim.GetCustomDataByKey("reflight")
            assert (ours["global_id"], ours["name"], ours["facade"]) == (
                element.global_id,
                element.name,
                component.name,
            )
            assert UsdGeom.PrimvarsAPI(prim).GetPrimvar("panel").Get() == element.panel
        on = np.array(
            UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(f"/World/{component.name}/Gaussians")).GetPrimvar("panel").Get()
        )
        assert np.array_equal(on, ellipsoids_of(component).panels)
    ours = stage.GetPrimAtPath("/World/A/A_0000").GetCustomDataByKey("reflight")
    assert (ours["Material_au_en"], ours["layer"], ours["age"], ours["far"]) == ('Glas "ä"', "x", 2**40, str(2**80))
    assert "none" not in ours
    assert stage.GetPrimAtPath("/World/A").GetCustomDataByKey("reflight")["attributes"] == {"wall": 1.5}
    opacity = UsdGeom.Mesh(stage.GetPrimAtPath("/World/A/A_0000")).GetDisplayOpacityAttr().Get()
    np.testing.assert_allclose(opacity, [0.001])


@pytest.mark.parametrize("name", ["model.usdc", "model.usda"])
def test_hostile_names_become_names_that_differ(tmp_path, name):
    names = [*HOSTILE, "Gaussians", "1", "a b", "a_b", "a/b", ""]
    scene = synthetic_scene(((1,) * len(names), (2,)), 1)
    component = scene.components[0]
    elements = tuple(replace(element, name=each) for element, each in zip(component.elements, names, strict=True))
    components = (replace(component, name="B", elements=elements), *scene.components[1:])
    attributes = {elements[0].global_id: {each: each for each in HOSTILE}}
    stage = opened(replace(scene, components=components, name="a\0b"), tmp_path, attributes=attributes, name=name)
    facade, other, _ = stage.GetDefaultPrim().GetChildren()
    assert (facade.GetName(), other.GetName()) == ("B", "B_2")
    found = {prim.GetCustomDataByKey("reflight")["global_id"]: prim for prim in facade.GetChildren()[1:]}
    for element in elements:
        shown = element.name.encode("utf-8", "replace").decode().replace("\0", "\ufffd")
        assert found[element.global_id].GetDisplayName() == shown
    assert complaints(stage) == []


def test_scenes_may_lack_anything(tmp_path):
    for number, scene in enumerate(
        (synthetic_scene((), 0), synthetic_scene(((), (0,)), 1), synthetic_scene(((0, 1),), 0))
    ):
        folder = tmp_path / str(number)
        folder.mkdir()
        stage = opened(replace(scene, origin=None), folder)
        n_splats = sum(prim.GetTypeName() == "ParticleField3DGaussianSplat" for prim in stage.Traverse())
        assert n_splats == sum(len(component.gaussians) > 0 for component in scene.components)
        assert sum(prim.IsA(UsdGeom.Mesh) for prim in stage.Traverse()) == len(list(scene.elements))
        assert complaints(stage) == []


def test_the_same_scene_makes_the_same_bytes(tmp_path):
    for name in ("one.usdc", "two.usdc"):
        write_usd(synthetic_scene(((300, 20), (9,)), 40), tmp_path / name)
    assert (tmp_path / "one.usdc").read_bytes() == (tmp_path / "two.usdc").read_bytes()


def test_an_export_that_fails_leaves_the_old_file(tmp_path):
    path = tmp_path / "model.usdc"
    write_usd(synthetic_scene(), path)
    before = path.read_bytes()
    with pytest.raises(OperationCancelled):
        write_usd(synthetic_scene(seed=1), path, monitor=Cancelling(after=2))
    bad = component_with(synthetic_scene(), 1, sh=np.full((2, 16, 3), np.inf, np.float32))
    with pytest.raises(InputError, match=r"component 'B': sh: .*train again"):
        write_usd(bad, path)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["model.usdc"]


def test_places_and_endings_that_cannot_be_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"ends in \.usdc"):
        write_usd(synthetic_scene(), tmp_path / "model.obj")
    with pytest.raises(InputError, match="no folder"):
        write_usd(synthetic_scene(), tmp_path / "none" / "model.usdc")
    with pytest.raises(ValueError, match="sh_degree"):
        UsdOptions(sh_degree=4)


def test_without_usd_core_it_says_what_to_install(tmp_path, monkeypatch):
    # Python takes a module that is None for one that is not there.
    monkeypatch.setitem(sys.modules, "pxr.UsdVol", None)
    with pytest.raises(InputError, match=r"pip install 'reflight-groundstation\[usd\]'"):
        write_usd(synthetic_scene(), tmp_path / "model.usdc")
    assert not list(tmp_path.iterdir())


def test_a_package_for_apples_viewers_can_be_made_of_it(tmp_path):
    write_usd(synthetic_scene(), tmp_path / "model.usdc")
    assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "model.usdc"), str(tmp_path / "model.usdz"))
    stage = Usd.Stage.Open(str(tmp_path / "model.usdz"))
    assert stage.GetPrimAtPath("/World/A/Gaussians").GetTypeName() == "ParticleField3DGaussianSplat"
