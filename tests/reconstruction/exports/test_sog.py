"""SOG files: what is read back is what was written to within the format's steps, and hostile files are refused."""

import io
import json
import math
import zipfile

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError, OperationCancelled
from reconstruction.exports.compression import PRESETS, Compression
from reconstruction.exports.sog import image_of, palette_size, write_sog
from tests.reconstruction.exports.hard_scenes import (
    Interrupted,
    antialiased,
    in_order,
    quaternion_errors,
    scene_with,
    spread,
)
from tests.reconstruction.exports.sog.reading import read_sog
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

ALL = Compression(palette=65_536, gaussians_each=1, least_opacity=0.0)


def members(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def write_members(path, files):
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)


def by_hand(path):
    """A file's Gaussians one number at a time, after the specification's words: axes and all are the file's."""
    files = members(path)
    meta = json.loads(files["meta.json"])
    pixels = {}
    for name, content in files.items():
        if name.endswith(".webp"):
            image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
            alpha = image[..., 3:] if image.shape[2] == 4 else np.full((*image.shape[:2], 1), 255, np.uint8)
            pixels[name] = np.concatenate([image[..., 2::-1], alpha], axis=2).astype(int)
    width = pixels["sh0.webp"].shape[1]
    found = []
    for i in range(meta["count"]):
        at = {name: image[i // width, i % width] for name, image in pixels.items() if name != "shN_centroids.webp"}
        place = []
        for axis in range(3):
            low, high = meta["means"]["mins"][axis], meta["means"]["maxs"][axis]
            value = at["means_l.webp"][axis] + 256 * at["means_u.webp"][axis]
            log = low + (high - low) * value / 65535
            place.append(math.copysign(math.exp(abs(log)) - 1, log))
        largest = at["quats.webp"][3] - 252
        quat = [(each / 255 - 0.5) * math.sqrt(2) for each in at["quats.webp"][:3]]
        quat.insert(largest, math.sqrt(max(0.0, 1 - sum(q * q for q in quat))))
        label = at["shN_labels.webp"][0] + 256 * at["shN_labels.webp"][1]
        entries = pixels["shN_centroids.webp"]
        rest = [entries[label // 64, 15 * (label % 64) + j, c] for j in range(15) for c in range(3)]
        found.append(
            {
                "means_m": place,
                "quats": quat,
                "logs": [meta["scales"]["codebook"][each] for each in at["scales.webp"][:3]],
                "colours": [meta["sh0"]["codebook"][each] for each in at["sh0.webp"][:3]],
                "opacities": at["sh0.webp"][3] / 255,
                "rest": [meta["shN"]["codebook"][each] for each in rest],
            }
        )
    return {name: np.array([each[name] for each in found]) for name in found[0]}


def test_a_file_holds_what_the_specification_says(tmp_path):
    path = tmp_path / "model.sog"
    write_sog(synthetic_scene(((70, 9),)), path, ALL, "enu")
    found, read = by_hand(path), read_sog(path, "enu")
    np.testing.assert_allclose(read.means_m, found["means_m"], rtol=1e-6, atol=1e-7)
    assert quaternion_errors(found["quats"], read.quats).max() < 1e-6
    np.testing.assert_allclose(np.log(read.scales_m), found["logs"], atol=1e-5)
    np.testing.assert_allclose(read.opacities, found["opacities"], atol=1e-6)
    np.testing.assert_allclose(read.sh[:, 0], found["colours"], atol=1e-6)
    np.testing.assert_allclose(read.sh[:, 1:].reshape(len(read), -1), found["rest"], atol=1e-6)
    assert json.loads(members(path)["meta.json"])["model"] == "2dgs"


@pytest.mark.parametrize(("is_on", "model"), [(True, "antialiased"), (False, "2dgs")])
def test_a_file_says_whether_it_is_to_be_drawn_antialiased(tmp_path, is_on, model):
    write_sog(antialiased(synthetic_scene(), is_on), tmp_path / "model.sog")
    assert json.loads(members(tmp_path / "model.sog")["meta.json"])["model"] == model


@settings(max_examples=12, deadline=None)
@given(
    n=st.integers(1, 30),
    seed=st.integers(0, 99),
    axes=st.sampled_from(["y-up", "y-down", "enu"]),
    furthest_m=st.sampled_from([1e-3, 1.0, 137.0, 2e4]),
)
def test_what_is_read_differs_by_the_format_s_steps_only(tmp_path_factory, n, seed, axes, furthest_m):
    scene = spread(synthetic_scene(((n,),), n, seed), furthest_m, seed)
    path = tmp_path_factory.mktemp("sog") / "model.sog"
    done, truth = write_sog(scene, path, ALL, axes), in_order(scene, axes)
    read = read_sog(path, axes)
    assert (done.n_gaussians, done.n_left_out, done.n_bytes) == (2 * n, 0, path.stat().st_size)
    assert np.abs(read.means_m - truth.means_m).max() <= done.position_error_m + 2e-7 * furthest_m
    assert done.position_error_m <= (1 + furthest_m) * 1.01 * math.log1p(furthest_m) / 65535
    assert quaternion_errors(read.quats, truth.quats).max() < 8e-3
    assert np.abs(np.log(read.scales_m / truth.scales_m)).max() < 0.02
    assert np.abs(read.opacities - truth.opacities).max() <= 0.5 / 255 + 1e-6
    assert np.abs(read.sh - truth.sh).max() < 0.05


def test_a_larger_palette_is_nearer_and_larger(tmp_path):
    scene, errors, sizes = synthetic_scene(((600,),), 200), [], []
    truth = in_order(scene, "y-down")
    for size in (16, 64, 512):
        compression = Compression(palette=size, gaussians_each=1, least_opacity=0.0)
        sizes.append(write_sog(scene, tmp_path / "model.sog", compression).n_bytes)
        errors.append(float(np.square(read_sog(tmp_path / "model.sog").sh[:, 1:] - truth.sh[:, 1:]).mean()))
    assert sizes == sorted(sizes)
    assert errors == sorted(errors, reverse=True)
    assert errors[2] < 0.5 * errors[0]


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_lower_degrees_have_no_higher_ones(tmp_path, degree):
    done = write_sog(synthetic_scene(), tmp_path / "model.sog", Compression(degree, least_opacity=0.0))
    read = read_sog(done.path)
    assert not read.sh[:, (degree + 1) ** 2 :].any()
    assert ("shN" in json.loads(members(done.path)["meta.json"])) == (degree > 0)


@pytest.mark.parametrize(
    ("n", "preset", "size"),
    [
        (1, "small", 1),
        (50, "small", 50),
        (5000, "small", 78),
        (10**7, "small", 2048),
        (8000, "balanced", 1000),
        (10**7, "balanced", 16_384),
        (8000, "fine", 4000),
        (10**7, "fine", 65_536),
    ],
)
def test_palettes_grow_with_the_model_up_to_the_preset_s_size(n, preset, size):
    assert palette_size(n, PRESETS[preset]) == size


def test_the_same_scene_makes_the_same_bytes_and_tells_where_it_belongs(tmp_path):
    scene = synthetic_scene(((30,),), 30, name="Ämter & <b>")
    for name in ("one", "two"):
        write_sog(scene, tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()
    asset = json.loads(members(tmp_path / "one")["meta.json"])["asset"]
    assert asset["site"] == "Ämter & <b>"
    assert asset["origin_wgs84"] == [22.3372, 114.2636, 62.0]
    assert asset["origin_enu_m"] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    "columns",
    [
        {"means": 0.0},
        {"means": (1e-3, 0.0, -1e-3)},
        {"means": (19_999.0, -2e4, 1.0)},
        {"log_scales": -100.0},
        {"log_scales": 20.0},
        {"opacity_logits": 1e4},
        {"opacity_logits": -1e4},
        {"sh": 0.0},
        {"sh": 50.0},
        {"quats": 0.0},
    ],
)
def test_numbers_at_the_ends_come_back(tmp_path, columns):
    scene = scene_with(**columns)
    done = write_sog(scene, tmp_path / "наш вид ☀.sog", ALL)
    read, truth = read_sog(done.path), in_order(scene, "y-down")
    error_m = done.position_error_m + 2e-7 * np.abs(truth.means_m).max()
    assert np.abs(np.sort(read.means_m, axis=0) - np.sort(truth.means_m, axis=0)).max() <= error_m
    if "log_scales" in columns:
        largest = max(columns["log_scales"], math.log(1e-30))
        np.testing.assert_allclose(np.log(read.scales_m[:, :2].astype(float)), largest, rtol=1e-6)
    if "opacity_logits" in columns:
        assert (read.opacities == (columns["opacity_logits"] > 0.0)).all()
    if "sh" in columns:
        np.testing.assert_allclose(read.sh[:, 0], columns["sh"], atol=1e-5)


def test_one_gaussian_and_none(tmp_path):
    assert len(read_sog(write_sog(synthetic_scene(((1,),), 0), tmp_path / "one.sog", ALL).path)) == 1
    with pytest.raises(InputError, match="no Gaussian that could be seen"):
        write_sog(synthetic_scene(((0,),), 0), tmp_path / "none.sog")
    scene = synthetic_scene()
    scene.components[0].gaussians.values["sh"][0, 3, 1] = np.nan
    with pytest.raises(InputError, match="component 'A': sh: holds numbers that are not finite"):
        write_sog(scene, tmp_path / "none.sog")
    assert not (tmp_path / "none.sog").exists()


@pytest.mark.parametrize("n", [0, 4, 7, 10])
def test_an_interrupted_write_leaves_the_old_file(tmp_path, n):
    path = tmp_path / "model.sog"
    write_sog(synthetic_scene(), path)
    before = path.read_bytes()
    with pytest.raises(OperationCancelled):
        write_sog(synthetic_scene(seed=5), path, monitor=Interrupted(n))
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["model.sog"]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    path = tmp_path_factory.mktemp("sog") / "model.sog"
    write_sog(synthetic_scene(), path)
    return members(path)


def changed(files, **parts):
    return {**files, "meta.json": json.dumps({**json.loads(files["meta.json"]), **parts}).encode()}


def lossy():
    return cv2.imencode(".webp", np.zeros((4, 4, 3), np.uint8), [cv2.IMWRITE_WEBP_QUALITY, 50])[1].tobytes()


def of_part(members, part, **parts):
    return changed(members, **{part: {**json.loads(members["meta.json"])[part], **parts}})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: {}, "has no 'meta.json'"),
        (lambda f: {**f, "meta.json": b"{"}, "not valid JSON"),
        (lambda f: {**f, "meta.json": b"[" * 100_000}, "nested too deeply"),
        (lambda f: {**f, "meta.json": bytes(1 << 21)}, "more than 1048576 bytes"),
        (lambda f: {**f, "meta.json": b"[]"}, "meta|expected"),
        (lambda f: changed(f, version=1), "version 2, found 1"),
        (lambda f: changed(f, count=0), "has 0 Gaussians"),
        (lambda f: changed(f, count=10**9), "has 1000000000 Gaussians"),
        (lambda f: changed(f, count=17), "has 16 pixels; expected 17"),
        (lambda f: changed(f, count="many"), "count"),
        (lambda f: of_part(f, "means", mins=[0, 0]), "means"),
        (lambda f: of_part(f, "means", maxs=[0, 0, 1e9]), "means: expected numbers of"),
        (lambda f: of_part(f, "means", maxs=[0, 0, float("nan")]), r"means\.maxs\[2\]: expected a finite number"),
        (lambda f: of_part(f, "scales", codebook=[0.0] * 255), "codebook of 256 numbers, found 255"),
        (lambda f: of_part(f, "sh0", codebook=[1e30] * 256), "sh0: expected numbers"),
        (lambda f: of_part(f, "shN", bands=4), "shN: expected 1 to 65536 entries of degree 1 to 3"),
        (lambda f: of_part(f, "shN", bands=1), r"pixels; expected 192 x 1"),
        (lambda f: of_part(f, "shN", count=1), "names entry"),
        (lambda f: of_part(f, "quats", files=["../../etc/passwd"]), "has no '../../etc/passwd'"),
        (lambda f: {name: each for name, each in f.items() if name != "sh0.webp"}, "has no 'sh0.webp'"),
        (lambda f: {**f, "sh0.webp": f["sh0.webp"][:-9]}, "sh0.webp is damaged"),
        (lambda f: {**f, "sh0.webp": b"RIFF"}, "sh0.webp: expected a lossless WebP"),
        (lambda f: {**f, "sh0.webp": lossy()}, "sh0.webp: expected a lossless WebP"),
        (lambda f: {**f, "quats.webp": image_of(np.zeros((4, 4, 4), np.uint8))}, "something else than rotations"),
        (
            lambda f: {**f, "sh0.webp": image_of(np.zeros((400, 400, 4), np.uint8))},
            "400 x 400 pixels; expected at most",
        ),
    ],
)
def test_hostile_files_are_refused_in_words(tmp_path, files, change, message):
    path = tmp_path / "model.sog"
    write_members(path, change(files))
    with pytest.raises(InputError, match=rf"model\.sog: .*({message})"):
        read_sog(path)


def test_zip_bombs_and_other_files_are_refused_in_words(tmp_path, files):
    path = tmp_path / "model.sog"
    for content in (b"", b"PK\x03\x04", b"RIFF____WEBP", bytes(100)):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"model\.sog: is no SOG file"):
            read_sog(path)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("meta.json", bytes(50_000_000))
    path.write_bytes(stream.getvalue())
    with pytest.raises(InputError, match=r"'meta\.json' has more than"):
        read_sog(path)
    write_members(path, files)
    whole = path.read_bytes()
    at = whole.index(files["sh0.webp"][:40])
    path.write_bytes(whole[: at + 20] + b"\xff" + whole[at + 21 :])
    with pytest.raises(InputError, match=r"model\.sog: "):
        read_sog(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_sog(tmp_path / "absent.sog")
