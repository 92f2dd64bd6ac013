"""PLY files for viewers: columns, order and axes that they expect, and the numbers of the scene."""

import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports.component_parts import ellipsoids_of_all
from reconstruction.exports.gaussian_blocks import turned
from reconstruction.exports.ply_export import write_ply
from reconstruction.splats.ply import ODD, read_blocks, read_header, read_splats
from tests.reconstruction.exports.hard_scenes import Interrupted, antialiased, quaternion_errors, scene_with
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

START = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"]


@pytest.mark.parametrize(("kind", "n_sizes"), [("2dgs", 2), ("3dgs", 3)])
@pytest.mark.parametrize("degree", [0, 3])
def test_columns_stand_in_the_order_that_programs_go_by(tmp_path, kind, n_sizes, degree):
    path = tmp_path / "наш вид.ply"
    done = write_ply(synthetic_scene(), path, kind, degree=degree, least_opacity=0.0)
    header = read_header(path)
    rest = [f"f_rest_{i}" for i in range(3 * ((degree + 1) ** 2 - 1))]
    sizes = [f"scale_{i}" for i in range(n_sizes)]
    expected = [*START, *rest, "opacity", *sizes, *(f"rot_{i}" for i in range(4)), "panel_id"]
    assert [name for name, _ in header.columns] == expected
    assert {kind for _, kind in header.columns} == {"<f4"}
    assert ("SplatRenderMode: 2dgs" in header.comments) == (kind == "2dgs")
    assert "SplatRenderMode: mip" not in header.comments
    assert (done.n_gaussians, done.n_bytes) == (header.n_rows, path.stat().st_size)


@pytest.mark.parametrize("is_on", [True, False])
def test_a_file_says_whether_it_is_to_be_drawn_antialiased(tmp_path, is_on):
    write_ply(antialiased(synthetic_scene(), is_on), tmp_path / "model.ply", "3dgs")
    assert ("SplatRenderMode: mip" in read_header(tmp_path / "model.ply").comments) == is_on


@pytest.mark.parametrize("axes", ["y-up", "y-down", "enu"])
def test_numbers_are_those_of_the_scene(tmp_path, axes):
    scene, path = synthetic_scene(), tmp_path / "model.ply"
    write_ply(scene, path, "2dgs", axes, least_opacity=0.0)
    truth = turned(ellipsoids_of_all(scene.components), axes)
    found = read_splats(path).splats
    assert np.array_equal(found.means.detach().numpy(), truth.means_m)
    assert quaternion_errors(found.quats.detach().numpy(), truth.quats).max() == 0.0
    np.testing.assert_allclose(found.scales.detach().numpy(), truth.scales_m[:, :2], rtol=1e-6)
    np.testing.assert_allclose(found.opacities.detach().numpy(), truth.opacities, atol=1e-6)
    assert np.array_equal(found.sh.detach().numpy(), truth.sh * ODD[:, None])
    table = next(read_blocks(path, read_header(path)))
    assert np.array_equal(table["panel_id"], truth.panels)


@pytest.mark.parametrize("logit", [-1e4, 1e4])
def test_opacities_of_0_and_1_have_finite_logits(tmp_path, logit):
    path = tmp_path / "model.ply"
    write_ply(scene_with(opacity_logits=logit), path, least_opacity=0.0)
    found = read_splats(path).splats.opacities.detach().numpy()
    np.testing.assert_allclose(found, float(logit > 0.0), atol=2e-7)


def test_what_cannot_be_written_is_refused(tmp_path):
    path = tmp_path / "model.ply"
    with pytest.raises(InputError, match="no Gaussian that could be seen"):
        write_ply(synthetic_scene(((0,),), 0), path)
    with pytest.raises(InputError, match="sh: holds numbers that are not finite"):
        write_ply(scene_with(sh=np.nan), path)
    scene = synthetic_scene()
    for component in scene.components:
        component.gaussians.values["log_scales"] = np.zeros((len(component.gaussians), 3), np.float32)
    with pytest.raises(InputError, match="the model has ellipsoids"):
        write_ply(scene, path, "2dgs")
    with pytest.raises(ValueError, match="degree: expected 0 to 3"):
        write_ply(scene, path, degree=4)
    assert not list(tmp_path.iterdir())


def test_an_interrupted_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "model.ply"
    write_ply(synthetic_scene(), path)
    before = path.read_bytes()
    with pytest.raises(OperationCancelled):
        write_ply(synthetic_scene(seed=5), path, monitor=Interrupted(5))
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["model.ply"]
