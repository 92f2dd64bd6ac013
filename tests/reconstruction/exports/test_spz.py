"""SPZ files: what is read back is what was written to within the format's steps, and hostile files are refused."""

import gzip
import itertools
import math
import struct
import tracemalloc
import zlib

import numpy as np
import pytest
from backports import zstd
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports.compression import PRESETS, Compression
from reconstruction.exports.spz import write_spz
from tests.reconstruction.exports.hard_scenes import (
    Interrupted,
    antialiased,
    in_order,
    quaternion_errors,
    scene_with,
    spread,
)
from tests.reconstruction.exports.spz.reading import read_spz
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

ALL = Compression(first_bits=8, further_bits=8, least_opacity=0.0)


def as_version_3(path):
    """What the gzip stream of a file of version 3 holds; of one of version 4, what it would hold."""
    content = path.read_bytes()
    if content[:4] != b"NGSP":
        return gzip.decompress(content)
    magic, version, n, degree, fraction, flags, n_streams, at = struct.unpack_from("<IIIBBBBI", content)
    assert (magic, version, n_streams, at) == (0x5053474E, 4, 6 if degree else 5, 32)
    assert content[20:32] == bytes(12)
    table = struct.unpack_from(f"<{2 * n_streams}Q", content, 32)
    ends = 32 + 16 * n_streams + np.cumsum([0, *table[::2]])
    assert ends[-1] == len(content)
    streams = [zstd.decompress(content[start:end]) for start, end in itertools.pairwise(ends)]
    assert [len(each) for each in streams] == list(table[1::2])
    return struct.pack("<IIIBBBB", magic, 3, n, degree, fraction, flags, 0) + b"".join(streams)


def by_hand(path):
    """A file's Gaussians one number at a time, after the specification's words: axes and all are the file's."""
    content = as_version_3(path)
    magic, version, n, degree, fraction, flags, _ = struct.unpack_from("<IIIBBBB", content)
    assert (magic, version, flags) == (0x5053474E, 3, 0)
    n_rest = 3 * ((degree + 1) ** 2 - 1)
    starts = np.cumsum([16, 9 * n, n, 3 * n, 3 * n, 4 * n, n_rest * n])
    assert len(content) == starts[-1]
    found = []
    for i in range(n):
        place = [
            int.from_bytes(content[at : at + 3], "little", signed=True) / 2**fraction
            for at in range(starts[0] + 9 * i, starts[0] + 9 * i + 9, 3)
        ]
        packed = int.from_bytes(content[starts[4] + 4 * i : starts[4] + 4 * i + 4], "little")
        largest, parts = packed >> 30, [packed >> 20 & 1023, packed >> 10 & 1023, packed & 1023]
        sizes = [(-1 if part & 512 else 1) * (part & 511) / 511 / math.sqrt(2) for part in parts]
        xyzw = [*sizes[:largest], math.sqrt(max(0.0, 1 - sum(s * s for s in sizes))), *sizes[largest:]]
        found.append(
            {
                "means_m": place,
                "opacities": content[starts[1] + i] / 255,
                "colours": [(each / 255 - 0.5) / 0.15 for each in content[starts[2] + 3 * i : starts[2] + 3 * i + 3]],
                "logs": [each / 16 - 10 for each in content[starts[3] + 3 * i : starts[3] + 3 * i + 3]],
                "quats": [xyzw[3], *xyzw[:3]],
                "rest": [(each - 128) / 128 for each in content[starts[5] + n_rest * i : starts[5] + n_rest * (i + 1)]],
            }
        )
    return {name: np.array([each[name] for each in found]) for name in found[0]}


@pytest.mark.parametrize("version", [3, 4])
@pytest.mark.parametrize("is_on", [True, False])
def test_a_file_says_whether_it_is_to_be_drawn_antialiased(tmp_path, is_on, version):
    write_spz(antialiased(synthetic_scene(), is_on), tmp_path / "model.spz", ALL, version=version)
    flags = as_version_3(tmp_path / "model.spz")[14]
    assert flags == int(is_on)
    assert len(read_spz(tmp_path / "model.spz")) > 0


@pytest.mark.parametrize("version", [3, 4])
def test_a_file_holds_what_the_specification_says(tmp_path, version):
    path = tmp_path / "model.spz"
    write_spz(synthetic_scene(), path, ALL, "enu", version=version)
    found, read = by_hand(path), read_spz(path, "enu")
    assert np.array_equal(found["means_m"].astype(np.float32), read.means_m)
    assert quaternion_errors(found["quats"], read.quats).max() < 1e-6
    np.testing.assert_allclose(np.log(read.scales_m), found["logs"], atol=1e-5)
    np.testing.assert_allclose(read.opacities, found["opacities"], atol=1e-6)
    np.testing.assert_allclose(read.sh[:, 0], found["colours"], atol=1e-5)
    np.testing.assert_allclose(read.sh[:, 1:].reshape(len(read), -1), found["rest"], atol=1e-6)


@settings(max_examples=15, deadline=None)
@given(
    n=st.integers(1, 30),
    seed=st.integers(0, 99),
    axes=st.sampled_from(["y-up", "y-down", "enu"]),
    furthest_m=st.sampled_from([1e-3, 1.0, 137.0, 2e4]),
)
def test_what_is_read_differs_by_the_format_s_steps_only(tmp_path_factory, n, seed, axes, furthest_m):
    scene = spread(synthetic_scene(((n,),), n, seed), furthest_m, seed)
    path = tmp_path_factory.mktemp("spz") / "model.spz"
    done, truth = write_spz(scene, path, ALL, axes), in_order(scene, axes)
    read = read_spz(path, axes)
    assert (done.n_gaussians, done.n_left_out, done.n_resized) == (2 * n, 0, 0)
    assert done.n_bytes == path.stat().st_size
    assert done.position_error_m <= max(2.0**-25, 1.01 * furthest_m / 2**23)
    assert np.abs(read.means_m - truth.means_m).max() <= done.position_error_m + 1e-7 * furthest_m
    assert quaternion_errors(read.quats, truth.quats).max() < 2.5e-3
    assert np.abs(np.log(read.scales_m / truth.scales_m)[:, :2]).max() <= 0.5 / 16 + 1e-5
    assert np.abs(read.opacities - truth.opacities).max() <= 0.5 / 255 + 1e-6
    colours = np.clip(truth.sh[:, 0], -0.5 / 0.15, 0.5 / 0.15)
    assert np.abs(read.sh[:, 0] - colours).max() <= 0.5 / 255 / 0.15 + 1e-5
    if axes == "enu":  # turned harmonics are rounded in the file's axes
        assert np.abs(read.sh[:, 1:] - np.clip(truth.sh[:, 1:], -1.0, 127 / 128)).max() <= 0.5 / 128 + 1e-6
    else:
        assert np.abs(read.sh[:, 1:] - truth.sh[:, 1:]).max() < 0.03


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_both_versions_hold_the_same_bytes(tmp_path, degree):
    scene, wanted = synthetic_scene(((300,),), 50), Compression(degree)
    done = [write_spz(scene, tmp_path / f"{version}.spz", wanted, version=version) for version in (3, 4)]
    assert as_version_3(done[0].path) == as_version_3(done[1].path)
    assert done[0].n_gaussians == done[1].n_gaussians == len(read_spz(done[1].path))
    first, second = (read_spz(each.path) for each in done)
    assert all(np.array_equal(getattr(first, name), getattr(second, name)) for name in ("means_m", "quats", "sh"))


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_fewer_degrees_and_bits_make_smaller_files_and_larger_errors(tmp_path, degree):
    scene = synthetic_scene(((500,),), 100)
    path = tmp_path / "model.spz"
    sizes, errors = [], []
    for bits in (8, 5, 2):
        sizes.append(write_spz(scene, path, Compression(degree, bits, bits, least_opacity=0.0), "enu").n_bytes)
        rest, truth = (each.sh[:, 1 : (degree + 1) ** 2] for each in (read_spz(path, "enu"), in_order(scene, "enu")))
        errors.append(float(np.abs(rest - np.clip(truth, -1.0, 1.0)).max()) if degree else 0.0)
        assert not read_spz(path, "enu").sh[:, (degree + 1) ** 2 :].any()
    assert sizes == sorted(sizes, reverse=True)
    assert errors == sorted(errors)
    assert degree == 0 or (errors[0] <= 1 / 128 and 1 / 16 < errors[2] <= 1 / 4 + 1 / 256)


def test_what_nobody_sees_is_left_out(tmp_path):
    scene = synthetic_scene()
    logits = scene.components[-1].gaussians.values["opacity_logits"]
    logits[:] = [-10.0, -5.55, -5.53, 4.0]
    done = write_spz(scene, tmp_path / "model.spz", PRESETS["balanced"])
    assert (done.n_gaussians, done.n_left_out) == (scene.n_gaussians - 2, 2)
    assert len(read_spz(done.path)) == done.n_gaussians


def test_the_same_scene_makes_the_same_bytes_and_keeps_to_itself(tmp_path):
    scene = synthetic_scene(((30,),), 30)
    before = {name: value.copy() for name, value in scene.components[0].gaussians.values.items()}
    for name in ("one", "two"):
        write_spz(scene, tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()
    assert all(np.array_equal(before[name], value) for name, value in scene.components[0].gaussians.values.items())


@pytest.mark.parametrize("log_m", [-200.0, -11.0, 6.5, 20.0])
def test_sizes_beyond_the_format_become_its_nearest_and_are_counted(tmp_path, log_m):
    scene = scene_with(log_scales=log_m)
    done = write_spz(scene, tmp_path / "model.spz")
    assert done.n_resized == done.n_gaussians
    nearest = min(max(log_m, -10.0), -10.0 + 255 / 16)
    np.testing.assert_allclose(np.log(read_spz(done.path).scales_m[:, :2]), nearest, atol=1e-5)


@pytest.mark.parametrize("logit", [-1e4, 1e4])
def test_opacities_of_0_and_1(tmp_path, logit):
    scene = scene_with(opacity_logits=logit)
    done = write_spz(scene, tmp_path / "model.spz", ALL)
    assert (read_spz(done.path).opacities == (logit > 0)).all()
    if logit < 0:
        with pytest.raises(InputError, match="no Gaussian that could be seen"):
            write_spz(scene, tmp_path / "none.spz")


@pytest.mark.parametrize("place_m", [(0.0, 0.0, 0.0), (1e-3, 0.0, -1e-3), (19_999.0, -2e4, 1.0)])
def test_all_at_one_place(tmp_path, place_m):
    done = write_spz(scene_with(means=place_m), tmp_path / "model.spz", axes="enu")
    assert np.abs(read_spz(done.path, "enu").means_m - np.float32(place_m)).max() <= done.position_error_m


def test_one_gaussian_and_none(tmp_path):
    done = write_spz(synthetic_scene(((1,),), 0), tmp_path / "наш вид ☀.spz", ALL)
    assert len(read_spz(done.path)) == 1
    with pytest.raises(InputError, match="no Gaussian that could be seen"):
        write_spz(synthetic_scene(((0,),), 0), tmp_path / "none.spz")
    assert not (tmp_path / "none.spz").exists()


@pytest.mark.parametrize("name", ["means", "quats", "log_scales", "opacity_logits", "sh"])
@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_numbers_that_are_none_are_refused(tmp_path, name, number):
    scene = synthetic_scene()
    scene.components[1].gaussians.values[name][0] = number
    with pytest.raises(InputError, match=f"component 'B': {name}: holds numbers that are not finite"):
        write_spz(scene, tmp_path / "model.spz")
    assert not list(tmp_path.iterdir())


def test_places_further_than_the_format_can_tell_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"lies 9e\+06 m from the origin"):
        write_spz(scene_with(means=9e6), tmp_path / "model.spz")


@pytest.mark.parametrize("version", [3, 4])
@pytest.mark.parametrize("n", [0, 3, 6, 7])
def test_an_interrupted_write_leaves_the_old_file(tmp_path, n, version):
    path = tmp_path / "model.spz"
    write_spz(synthetic_scene(), path, version=version)
    before = path.read_bytes()
    with pytest.raises(OperationCancelled):
        write_spz(synthetic_scene(seed=5), path, monitor=Interrupted(n), version=version)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["model.spz"]


def header(version=3, n=1, degree=0, fraction=12, magic=b"NGSP"):
    return struct.pack("<4sIIBBBB", magic, version, n, degree, fraction, 0, 0)


SIZES = (9, 1, 3, 3, 4)
"""Of a Gaussian's streams at degree 0."""


def of_version_4(n=1, degree=0, fraction=12, *, version=4, n_streams=5, at=32, streams=None, table=None, more=b""):
    """A file with one Gaussian of zeros, but for what is said."""
    frames = [zstd.compress(bytes(n * size)) for size in SIZES] if streams is None else streams
    sizes = [(len(frame), n * size) for frame, size in zip(frames, SIZES, strict=True)] if table is None else table
    header = struct.pack("<4sIIBBBBI12x", b"NGSP", version, n, degree, fraction, 0, n_streams, at)
    return b"".join([header, bytes(max(0, at - 32)), *(struct.pack("<QQ", *each) for each in sizes), *frames, more])


def frames(**others):
    """Streams of one Gaussian of zeros, with others in some's place."""
    usual = dict(zip(("positions", "alphas", "colors", "scales", "rotations"), SIZES, strict=True))
    return [others.get(name, zstd.compress(bytes(size))) for name, size in usual.items()]


def test_extensions_before_the_table_are_passed_over(tmp_path):
    path = tmp_path / "more.spz"
    path.write_bytes(of_version_4(at=32 + 500))
    assert len(read_spz(path)) == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"NGSP\x04\0\0\0", "cut off"),
        (of_version_4()[:60], "cut off"),
        (of_version_4(version=5), "expected SPZ of version 2 to 4, found 5"),
        (of_version_4(version=3), "expected SPZ of version 2 to 4, found 3"),
        (of_version_4(degree=4), "colours of degree 4"),
        (of_version_4(fraction=25), "25 bits after the binary point"),
        (of_version_4(n=0), "says that it has 0 Gaussians"),
        (of_version_4(n=2**32 - 1, streams=frames()), "says that it has 4294967295 Gaussians"),
        (of_version_4(n_streams=6), "has 6 streams"),
        (of_version_4(degree=1), "has 5 streams"),
        (of_version_4(at=31), "from byte 31 on"),
        (of_version_4(at=3 << 20), "from byte 3145728 on"),
        (of_version_4(at=60)[:90], "cut off"),
        (of_version_4(table=[(2**63, 9)] * 5), "do not end where it does"),
        (of_version_4(more=b"?"), "do not end where it does"),
        (of_version_4(streams=frames(alphas=b"no frame!")), "is damaged"),
        (of_version_4(streams=frames(alphas=zstd.compress(bytes(2)))), "more or less than it says"),
        (of_version_4(streams=frames(alphas=zstd.compress(b""))), "more or less than it says"),
        (of_version_4(streams=frames(alphas=zstd.compress(bytes(1)) + b"?")), "more or less than it says"),
        (of_version_4(streams=frames(alphas=zstd.compress(bytes(1))[:-1])), "more or less than it says"),
        (of_version_4(streams=frames(alphas=zstd.compress(bytes(1 << 28)))), "more or less than it says"),
        (of_version_4(table=[(len(each), 10**15) for each in frames()]), "bytes of positions; expected 9"),
    ],
    ids=itertools.count(),
)
def test_hostile_files_of_version_4_are_refused_in_words(tmp_path, content, message):
    path = tmp_path / "model.spz"
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"model\.spz: .*({message})"):
        read_spz(path)


def test_a_bomb_of_version_4_takes_no_memory(tmp_path):
    path = tmp_path / "bomb.spz"
    path.write_bytes(of_version_4(streams=frames(positions=zstd.compress(bytes(1 << 29)))))
    tracemalloc.start()
    with pytest.raises(InputError, match="more or less than it says"):
        read_spz(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10 << 20


def test_version_2_has_rotations_of_three_bytes(tmp_path):
    path = tmp_path / "old.spz"
    body = bytes(9) + b"\xff" + bytes([128] * 3) + bytes([100] * 3) + bytes([255, 128, 128])
    path.write_bytes(gzip.compress(header(2) + body))
    np.testing.assert_allclose(read_spz(path, "enu").quats, [[0.0, 1.0, 0.0, 0.0]], atol=0.01)


def test_extensions_after_the_gaussians_are_passed_over(tmp_path):
    path = tmp_path / "more.spz"
    path.write_bytes(gzip.compress(header() + bytes(20) + b"of somebody's"))
    assert len(read_spz(path)) == 1
    path.write_bytes(gzip.compress(header() + bytes(20 + (1 << 21))))
    with pytest.raises(InputError, match="goes on for more than"):
        read_spz(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is no SPZ file"),
        (b"ply\nformat", "is no SPZ file"),
        (b"\x1f\x8b\x08\0", "cut off"),
        (gzip.compress(b""), "cut off"),
        (gzip.compress(header(magic=b"PSGN") + bytes(20)), "something else in its gzip stream"),
        (gzip.compress(header(1) + bytes(20)), "expected SPZ of version 2 or 3, found 1"),
        (gzip.compress(header(4) + bytes(20)), "expected SPZ of version 2 or 3, found 4"),
        (gzip.compress(header(degree=4) + bytes(200)), "colours of degree 4"),
        (gzip.compress(header(fraction=25) + bytes(20)), "25 bits after the binary point"),
        (gzip.compress(header(n=0)), "says that it has 0 Gaussians"),
        (gzip.compress(header(n=2**32 - 1) + bytes(20)), "says that it has 4294967295 Gaussians"),
        (gzip.compress(header(n=3) + bytes(20)), "cut off"),
        (gzip.compress(header() + bytes(20))[:-9], "cut off"),
        (gzip.compress(header() + bytes(20))[:-8] + bytes(8), "is damaged"),
        (gzip.compress(header() + bytes(20))[:24] + b"\xff\xff\xff\xff", "is damaged|cut off"),
    ],
    ids=itertools.count(),
)
def test_hostile_files_are_refused_in_words(tmp_path, content, message):
    path = tmp_path / "model.spz"
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"model\.spz: .*({message})"):
        read_spz(path)


def test_a_gzip_bomb_is_refused_before_it_is_unpacked(tmp_path):
    path = tmp_path / "bomb.spz"
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    content = packer.compress(header(n=20_000_000)) + b"".join(packer.compress(bytes(1 << 20)) for _ in range(4))
    path.write_bytes(content + packer.flush() + bytes(400_000))
    with pytest.raises(InputError, match="has 20000000 Gaussians; at most 10000000 are read"):
        read_spz(path)


def test_missing_files_and_folders_are_told(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_spz(tmp_path / "absent.spz")
    with pytest.raises(InputError, match="found a folder"):
        read_spz(tmp_path)
    with pytest.raises(InputError, match="there is no folder"):
        write_spz(synthetic_scene(), tmp_path / "absent" / "model.spz")


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    path = tmp_path_factory.mktemp("damaged") / "b.spz"
    write_spz(synthetic_scene(), path)
    return path, gzip.decompress(path.read_bytes())


@settings(max_examples=60, deadline=None)
@given(at=st.floats(0.0, 1.0), value=st.integers(0, 255), kept=st.sampled_from([0.1, 0.5, 0.99, 1.0, 1.0, 1.0]))
def test_a_damaged_file_of_version_4_is_read_or_refused_and_nothing_else(tmp_path_factory, at, value, kept):
    path = tmp_path_factory.mktemp("damaged") / "b.spz"
    write_spz(synthetic_scene(), path, version=4)
    content = bytearray(path.read_bytes())
    content[min(int(at * len(content)), len(content) - 1)] = value
    path.write_bytes(content[: round(kept * len(content))])
    try:
        read = read_spz(path)
    except InputError:
        return
    for name in ("means_m", "quats", "scales_m", "opacities", "sh"):
        assert np.isfinite(getattr(read, name)).all()


@settings(max_examples=40, deadline=None)
@given(at=st.integers(0, 40), value=st.integers(0, 255), kept=st.floats(0.0, 1.0))
def test_a_damaged_file_is_read_or_refused_and_nothing_else(unpacked, at, value, kept):
    path, content = unpacked
    changed = bytearray(content)
    changed[at] = value
    path.write_bytes(gzip.compress(bytes(changed[: round(kept * len(changed))]), 1))
    try:
        read = read_spz(path)
    except InputError:
        return
    for name in ("means_m", "quats", "scales_m", "opacities", "sh"):
        assert np.isfinite(getattr(read, name)).all()
