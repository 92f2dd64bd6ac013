"""COLMAP's files: there and back without loss, the real model, and files that lie about themselves."""

from __future__ import annotations

import contextlib
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.colmap.folder import COUNT, read_model, write_model
from reconstruction.colmap.record import (
    N_PARAMETERS,
    NO_POINT,
    NO_POINTS,
    ColmapCamera,
    ColmapImage,
    ColmapModel,
    ColmapPoints,
    quaternion_of,
    rotation_of,
)
from reconstruction.light.photo_set import read_photo_set

HUGE = 2**60


def model(seed=0, n_images=3, names=("a.jpg", "with some spaces.jpg", "sub/Überführung 1.JPG")):
    rng = np.random.default_rng(seed)
    cameras = {}
    for number, (name, n) in enumerate(N_PARAMETERS.items(), 7):
        cameras[number] = ColmapCamera(number, name, 4000, 3000, (3000.0, *rng.uniform(1.0, 9.0, n - 1).tolist()))
    images, n_seen = {}, 0
    for index in range(n_images):
        n = index * 5  # the first has no observations
        ids = rng.integers(1, 9, n)
        ids[::3] = NO_POINT
        q = quaternion_of(rotation_of(tuple(rng.normal(size=4))))
        images[index + 1] = ColmapImage(
            index + 1, q, tuple(rng.normal(size=3)), 7 + index, names[index], rng.uniform(0, 4000, (n, 2)), ids
        )
        n_seen += n
    tracks = rng.integers(1, 4, (9, 2))
    points = ColmapPoints(
        np.array([4, 2**40, 9]), rng.normal(size=(3, 3)), rng.integers(0, 256, (3, 3)).astype(np.uint8),
        rng.uniform(size=3), np.array([0, 4, 4, 9]), tracks,
    )  # fmt: skip
    return ColmapModel(cameras, images, points)


def assert_same(one: ColmapModel, other: ColmapModel) -> None:
    assert one.cameras == other.cameras
    assert list(one.images) == list(other.images)
    for a, b in zip(one.images.values(), other.images.values(), strict=True):
        assert (a.id, a.q_wxyz, a.t, a.camera_id, a.name) == (b.id, b.q_wxyz, b.t, b.camera_id, b.name)
        np.testing.assert_array_equal(a.points_px, b.points_px)
        np.testing.assert_array_equal(a.point_ids, b.point_ids)
    for field in ColmapPoints.__slots__:
        np.testing.assert_array_equal(getattr(one.points, field), getattr(other.points, field))
        assert getattr(one.points, field).dtype == getattr(other.points, field).dtype


@pytest.mark.parametrize("kind", ["bin", "txt"])
def test_a_model_comes_back_bit_for_bit(tmp_path, kind):
    for seed in range(5):
        folder = tmp_path / f"{seed}"
        write_model(folder, model(seed), kind)
        assert_same(read_model(folder), model(seed))


@pytest.mark.parametrize("kind", ["bin", "txt"])
def test_an_empty_model_and_one_without_points_come_back(tmp_path, kind):
    for index, empty in enumerate((ColmapModel({}, {}), ColmapModel(model().cameras, model().images, NO_POINTS))):
        write_model(tmp_path / str(index), empty, kind)
        assert_same(read_model(tmp_path / str(index)), empty)
    (tmp_path / "1" / f"points3D.{kind}").unlink()
    assert len(read_model(tmp_path / "1").points) == 0


@pytest.mark.slow
def test_the_real_model_goes_through_both_formats_unchanged(shared_data, tmp_path):
    real = read_model(shared_data / "multiview" / "lund_door" / "colmap_ground_truth")
    assert len(real.images) == 12
    assert len(real.points) == 11384  # as its own head says
    assert len(real.points.tracks) / len(real.points) == pytest.approx(6.4412333099086441)
    n_of_points = [np.count_nonzero(image.point_ids != NO_POINT) for image in real.images.values()]
    assert np.mean(n_of_points) == pytest.approx(6110.583333333333)
    assert real.cameras[1].model == "SIMPLE_RADIAL"
    for kind in ("bin", "txt"):
        write_model(tmp_path / kind, real, kind)
        assert_same(read_model(tmp_path / kind), real)


def test_our_binary_files_are_those_that_pycolmap_reads_and_writes(shared_data, tmp_path):
    pycolmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    real = read_model(shared_data / "multiview" / "lund_door" / "colmap_ground_truth")
    write_model(tmp_path / "ours", real)
    (tmp_path / "theirs").mkdir()
    theirs = pycolmap.Reconstruction(str(tmp_path / "ours"))
    assert theirs.num_reg_images() == 12
    theirs.write_binary(str(tmp_path / "theirs"))
    assert (tmp_path / "theirs" / "rigs.bin").exists()  # and is passed over
    again = read_model(tmp_path / "theirs")
    assert again.cameras == real.cameras
    for image_id, image in real.images.items():
        np.testing.assert_allclose(again.images[image_id].centre_world, image.centre_world, atol=1e-12)
        np.testing.assert_array_equal(again.images[image_id].point_ids, image.point_ids)
    order = np.argsort(real.points.ids)
    np.testing.assert_array_equal(again.points.xyz[np.argsort(again.points.ids)], real.points.xyz[order])


def test_binary_files_go_before_text(tmp_path):
    write_model(tmp_path / "a", model(1), "txt")
    write_model(tmp_path / "b", model(2), "bin")
    for path in (tmp_path / "b").iterdir():
        path.rename(tmp_path / "a" / path.name)
    assert_same(read_model(tmp_path / "a"), model(2))


def binary(tmp_path, **contents):
    write_model(tmp_path, model())
    for name, content in contents.items():
        (tmp_path / f"{name}.bin").write_bytes(content)
    return tmp_path


@pytest.mark.parametrize("name", ["cameras", "images", "points3D"])
def test_a_count_of_two_to_the_sixtieth_is_refused_without_taking_memory(tmp_path, name):
    folder = binary(tmp_path, **{name: COUNT.pack(HUGE) + b"\0" * 200})
    with pytest.raises(InputError, match=f"{name}.bin.*{HUGE} entries follow"):
        read_model(folder)


def test_huge_counts_inside_entries_are_refused(tmp_path):
    image = struct.pack("<QI7dI", 1, 1, 1.0, *[0.0] * 6, 7) + b"a.jpg\0" + COUNT.pack(HUGE)
    with pytest.raises(InputError, match="entries follow"):
        read_model(binary(tmp_path / "a", images=image))
    point = struct.pack("<QQ3d3BdQ", 1, 1, 0.0, 0.0, 0.0, 1, 2, 3, 0.5, HUGE)
    with pytest.raises(InputError, match="observations follow"):
        read_model(binary(tmp_path / "b", points3D=point))


@given(st.data())
def test_files_cut_off_anywhere_are_refused_in_words(data):
    from reconstruction.colmap import folder as files

    whole = model()
    for content, read in (
        (files.cameras_bytes(list(whole.cameras.values())), files.read_cameras_binary),
        (files.images_bytes(list(whole.images.values())), files.read_images_binary),
        (files.points_bytes(whole.points), files.read_points_binary),
    ):
        length = data.draw(st.integers(0, len(content) - 1))
        with pytest.raises(InputError, match=r"damaged|in the middle"):
            read(content[:length], "file.bin")


@given(st.data())
def test_damaged_bytes_never_do_more_than_be_refused(data):
    from reconstruction.colmap import folder as files

    whole = model()
    for content, read in (
        (files.cameras_bytes(list(whole.cameras.values())), files.read_cameras_binary),
        (files.images_bytes(list(whole.images.values())), files.read_images_binary),
        (files.points_bytes(whole.points), files.read_points_binary),
    ):
        damaged = bytearray(content)
        for _ in range(3):
            damaged[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
        with contextlib.suppress(InputError):
            read(bytes(damaged), "file.bin")


@pytest.mark.parametrize(
    ("name", "line", "words"),
    [
        ("cameras", "1 PINHOLE 4000 3000 a b c d", "expected the columns CAMERA_ID MODEL"),
        ("cameras", "1 PINHOLE", "expected the columns CAMERA_ID MODEL"),
        ("cameras", "1 PINHOLE 4000 3000 3000 3000 2000", "expected 4 numbers for PINHOLE"),
        ("cameras", "1 PINHOLE 4000 3000 -3000 3000 2000 1500", "above 0"),
        ("cameras", "1 PINHOLE 4000 3000 nan 3000 2000 1500", "expected 4 numbers"),
        ("cameras", "1 THIN_PRISM_FISHEYE 4000 3000 1 1 1 1 0 0 0 0 0 0 0 0", "image_undistorter"),
        ("images", "1 1 0 0 0 0 0 0", "expected the columns IMAGE_ID"),
        ("images", "1 1 0 0 0 0 0 0 99 a.jpg\n", "has camera 99"),
        ("images", "1 0 0 0 0 0 0 0 7 a.jpg\n", "no rotation"),
        ("images", "1 1 0 0 0 inf 0 0 7 a.jpg\n", "not finite"),
        ("images", "1 1 0 0 0 0 0 0 7 a.jpg\n1 2", "expected the columns X Y POINT3D_ID"),
        (
            "images",
            "1 1 0 0 0 0 0 0 7 a.jpg\n2 1 0 0 0 0 0 0 7 b.jpg",
            "line 3: expected the observations",
        ),
        (
            "images",
            "1 1 0 0 0 0 0 0 7 a.jpg\n1 2 99999999999999999999999",
            "expected the columns X Y POINT3D_ID",
        ),
        ("images", "1 1 0 0 0 0 0 0 7 a.jpg\n\n2 1 0 0 0 0 0 0 7 a.jpg\n", "twice"),
        ("points3D", "1 0 0 0 1 2 300 0.5", "expected the columns POINT3D_ID"),
        ("points3D", "1 0 0 0 1 2 3 0.5 1", "expected the columns POINT3D_ID"),
        ("points3D", "1 nan 0 0 1 2 3 0.5", "not finite"),
    ],
)
def test_text_files_that_are_wrong_say_where(tmp_path, name, line, words):
    write_model(tmp_path, model(), "txt")
    (tmp_path / f"{name}.txt").write_text(f"# a comment\n{line}\n", "utf-8")
    with pytest.raises(InputError, match=words):
        read_model(tmp_path)


def test_no_point_is_read_in_both_ways_of_writing(tmp_path):
    write_model(tmp_path, model(), "txt")
    (tmp_path / "images.txt").write_text(f"1 1 0 0 0 0 0 0 7 a.jpg\r\n5 6 {2**64 - 1} 7 8 -1 9 9 4\n", "utf-8")
    (image,) = read_model(tmp_path).images.values()
    assert image.name == "a.jpg"
    assert image.point_ids.tolist() == [-1, -1, 4]


@pytest.mark.parametrize("number", [10, 77, -1])
def test_camera_models_that_are_not_understood_are_named(tmp_path, number):
    content = COUNT.pack(1) + struct.pack("<IiQQ8d", 3, number, 10, 10, *[1.0] * 8)
    with pytest.raises(
        InputError, match=r"camera 3: the camera model (THIN_PRISM_FISHEYE|number \S+) is not supported"
    ):
        read_model(binary(tmp_path, cameras=content))


def test_folders_without_or_with_another_model_are_refused(tmp_path):
    write_model(tmp_path / "project" / "sparse" / "0", model())
    with pytest.raises(InputError, match=r"has one in .*project.sparse.0: name that"):
        read_model(tmp_path / "project")
    with pytest.raises(InputError, match=r"dataset\.json, but a COLMAP model in"):
        read_photo_set(tmp_path / "project")
    (tmp_path / "cameras.xml").write_text("<document/>")
    with pytest.raises(InputError, match="Export Cameras as Colmap"):
        read_model(tmp_path / "cameras.xml")
    with pytest.raises(InputError, match="found no folder"):
        read_model(tmp_path / "nothing")
    with pytest.raises(InputError, match="sparse/0"):
        read_model(tmp_path)
    write_model(tmp_path / "a", model())
    with pytest.raises(InputError, match="holds a COLMAP model already"):
        write_model(tmp_path / "a", model(), "txt")


@pytest.mark.parametrize("name", [" a.jpg", "a\n.jpg", "a.jpg "])
def test_names_that_text_cannot_hold_are_refused_there_only(tmp_path, name):
    odd = model(n_images=1, names=(name,))
    with pytest.raises(InputError, match="write the binary ones"):
        write_model(tmp_path / "t", odd, "txt")
    write_model(tmp_path / "b", odd)
    assert_same(read_model(tmp_path / "b"), odd)


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 1e-3))
def test_quaternions_and_rotations_are_each_others_inverse(q):
    rotation = rotation_of(tuple(q))
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(rotation_of(quaternion_of(rotation)), rotation, atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_have_a_quaternion(axis):
    half = -np.eye(3)
    half[axis, axis] = 1.0
    np.testing.assert_allclose(rotation_of(quaternion_of(half)), half, atol=1e-15)
