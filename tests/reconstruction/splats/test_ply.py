import math

import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from reconstruction.light.shading import BASE_REFLECTANCE, REFLECTIVITY
from reconstruction.splats.harmonic_colour import display_colours
from reconstruction.splats.ply import read_blocks, read_header, read_splats, write_blocks, write_splats
from reconstruction.splats.splats import SHAPES, Splats
from tests.reconstruction.splats.learned_scenes import random_splats


@pytest.fixture
def splats():
    made = random_splats(30)
    with torch.no_grad():
        made.sh.normal_(generator=torch.Generator().manual_seed(2))
        made.reflectivity_logits.normal_()
    made.panels[:] = torch.arange(30) % 4 - 1
    return made


def table_of(path):
    header = read_header(path)
    return header, np.concatenate(list(read_blocks(path, header)))


@pytest.mark.parametrize("kind", ["2dgs", "3dgs"])
def test_splats_come_back_bit_by_bit(tmp_path, splats, kind):
    write_splats(tmp_path / "a.ply", splats, kind, (1.5, -2.25, 1e-3), ["site: Tower\nof glass"])
    found = read_splats(tmp_path / "a.ply")
    for name in (*SHAPES, "panels"):
        assert torch.equal(getattr(found.splats, name), getattr(splats, name))
    assert found.origin_enu_m == (1.5, -2.25, 1e-3)
    assert "site: Tower of glass" in read_header(tmp_path / "a.ply").comments


def test_columns_stand_in_the_order_that_readers_without_names_expect(tmp_path, splats):
    write_splats(tmp_path / "a.ply", splats, "3dgs")
    header, table = table_of(tmp_path / "a.ply")
    names = [name for name, _ in header.columns]
    assert names[:9] == ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"]
    assert names[9:54] == [f"f_rest_{i}" for i in range(45)]
    assert names[54:62] == ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    assert names[62:] == ["refgs_r", "refgs_f0_0", "refgs_f0_1", "refgs_f0_2", "panel_id"]
    assert all(kind == "<f4" for _, kind in header.columns[:-1])
    assert np.allclose(table["scale_2"], math.log(1e-6))
    assert not any("SplatRenderMode" in comment for comment in header.comments)


def test_a_file_of_discs_has_two_sizes_and_says_so(tmp_path, splats):
    write_splats(tmp_path / "a.ply", splats, "2dgs")
    header, _ = table_of(tmp_path / "a.ply")
    assert "scale_2" not in header.names
    assert "SplatRenderMode: 2dgs" in header.comments


def test_harmonics_are_those_of_other_programs(tmp_path, splats):
    write_splats(tmp_path / "a.ply", splats, "3dgs")
    _, table = table_of(tmp_path / "a.ply")
    eye = torch.tensor([1.0, -3.0, 2.0])
    ours = display_colours(splats.means, splats.sh, eye, 1).detach().numpy()
    x, y, z = torch.nn.functional.normalize(splats.means.detach() - eye, dim=1).numpy().T
    # Kerbl et al., 2023: 0.5 + C0 dc - C1 y a + C1 z b - C1 x c, each colour's 15 coefficients together.
    for channel in range(3):
        a, b, c = (table[f"f_rest_{15 * channel + k}"] for k in range(3))
        theirs = 0.5 + 0.28209479 * table[f"f_dc_{channel}"] + 0.48860251 * (-y * a + z * b - x * c)
        assert np.allclose(theirs, ours[:, channel], atol=1e-5)


def rewritten(path, splats, change, kind="2dgs"):
    write_splats(path, splats, kind)
    header, table = table_of(path)
    names = [name for name in table.dtype.names if change.get(name, 0) is not None]
    new = np.zeros(len(table), [(name, table.dtype[name]) for name in names])
    for name in names:
        new[name] = change.get(name, table[name])
    write_blocks(path, len(new), new.dtype, header.comments, [new])


def test_splats_of_another_program_with_lower_harmonics_are_no_glass(tmp_path, splats):
    ours = ["refgs_r", "refgs_f0_0", "refgs_f0_1", "refgs_f0_2", "panel_id"]
    rewritten(tmp_path / "a.ply", splats, dict.fromkeys([*ours, *(f"f_rest_{i}" for i in range(9, 45))]))
    found = read_splats(tmp_path / "a.ply").splats
    assert (found.panels == -1).all()
    assert torch.allclose(torch.sigmoid(found.reflectivity_logits), torch.tensor(REFLECTIVITY))
    assert torch.allclose(found.f0, torch.tensor(BASE_REFLECTANCE))
    assert (found.sh[:, 1:4] != 0.0).any()
    assert (found.sh[:, 4:] == 0.0).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"opacity": None}, "has no 'opacity', so these are points"),
        ({"f_rest_44": None}, "expected 0, 9, 24 or 45 columns f_rest_0 and so on, found 44"),
        ({"rot_2": np.nan}, "not finite, among them quats"),
        ({"refgs_r": np.inf}, "not finite, among them reflectivity_logits"),
        ({"panel_id": -7}, "sizes or panels that cannot be"),
        ({"scale_0": -np.inf}, "not finite, among them log_scales"),
        ({"scale_0": 80.0}, "sizes or panels that cannot be"),
    ],
)
def test_files_that_are_no_splats_are_refused(tmp_path, splats, change, message):
    rewritten(tmp_path / "a.ply", splats, change)
    with pytest.raises(InputError, match=rf"a.ply: .*{message}"):
        read_splats(tmp_path / "a.ply")


@pytest.fixture
def ellipsoids(splats):
    values = {name: getattr(splats, name).detach() for name in SHAPES}
    third = torch.randn(30, 1, generator=torch.Generator().manual_seed(4)) - 3.0
    return Splats(values | {"log_scales": torch.cat([values["log_scales"], third], dim=1)}, splats.panels)


def test_ellipsoids_come_back_bit_by_bit_with_three_true_sizes(tmp_path, ellipsoids):
    write_splats(tmp_path / "a.ply", ellipsoids, "3dgs", (1.5, 0.0, 2.0))
    header, table = table_of(tmp_path / "a.ply")
    assert [name for name, _ in header.columns][54:62] == [
        *("opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3")
    ]
    assert np.array_equal(table["scale_2"], ellipsoids.log_scales[:, 2].detach().numpy())
    assert not any(table[name].any() for name in ("nx", "ny", "nz"))
    found = read_splats(tmp_path / "a.ply")
    assert not found.splats.is_flat
    for name in (*SHAPES, "panels"):
        assert torch.equal(getattr(found.splats, name), getattr(ellipsoids, name))


def test_ellipsoids_that_are_all_flat_stay_ellipsoids_in_files_of_ours(tmp_path, ellipsoids):
    with torch.no_grad():
        ellipsoids.log_scales[:, 2] = -20.0
    write_splats(tmp_path / "a.ply", ellipsoids, "3dgs")
    assert torch.equal(read_splats(tmp_path / "a.ply").splats.log_scales, ellipsoids.log_scales)


def test_ellipsoids_are_not_written_as_discs(tmp_path, ellipsoids):
    with pytest.raises(ValueError, match="expected '3dgs' for ellipsoids"):
        write_splats(tmp_path / "a.ply", ellipsoids, "2dgs")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("thickness", "is_flat"), [(-13.8, True), (-30.0, True), (-np.inf, True), (-3.0, False)])
def test_other_programs_files_hold_discs_where_the_third_size_says_nothing(tmp_path, splats, thickness, is_flat):
    ours = ["refgs_r", "refgs_f0_0", "refgs_f0_1", "refgs_f0_2", "panel_id"]
    rewritten(tmp_path / "a.ply", splats, {**dict.fromkeys(ours), "scale_2": thickness}, "3dgs")
    found = read_splats(tmp_path / "a.ply").splats
    assert found.is_flat == is_flat
    assert torch.equal(found.log_scales[:, :2], splats.log_scales)


def test_one_ellipsoid_among_discs_makes_a_file_of_ellipsoids(tmp_path, splats):
    thickness = np.full(30, -14.0, np.float32)
    thickness[17] = -2.5
    rewritten(tmp_path / "a.ply", splats, {"scale_2": thickness}, "3dgs")
    found = read_splats(tmp_path / "a.ply").splats
    assert np.array_equal(found.log_scales[:, 2].detach().numpy(), thickness)


def test_a_third_size_that_is_none_is_refused(tmp_path, splats):
    rewritten(tmp_path / "a.ply", splats, {"scale_2": np.nan}, "3dgs")
    with pytest.raises(InputError, match="not finite, among them log_scales"):
        read_splats(tmp_path / "a.ply")


@pytest.mark.parametrize("line", ["origin_enu_m: 1 2", "origin_enu_m: a b c", "origin_enu_m: 1 2 nan"])
def test_an_origin_that_is_none_is_refused(tmp_path, splats, line):
    write_splats(tmp_path / "a.ply", splats, "2dgs")
    _, table = table_of(tmp_path / "a.ply")
    write_blocks(tmp_path / "a.ply", len(table), table.dtype, [line], [table])
    with pytest.raises(InputError, match=r"a.ply.*origin_enu_m"):
        read_splats(tmp_path / "a.ply")


def test_no_splats_are_refused(tmp_path):
    write_splats(tmp_path / "a.ply", random_splats(0), "2dgs")
    with pytest.raises(InputError, match="holds no splats"):
        read_splats(tmp_path / "a.ply")


def test_another_reader_of_ply_sees_the_same_points(tmp_path, splats):
    write_splats(tmp_path / "a.ply", splats, "2dgs")
    import trimesh

    cloud = trimesh.load(tmp_path / "a.ply")
    assert np.allclose(cloud.vertices, splats.means.detach().numpy())
