"""What programs of others read in our files: the SPZ reference library, PlayCanvas' splat-transform, gsply and cjio.

The first two are npm packages (`@adobe/spz`, `@playcanvas/splat-transform`) that `make foreign` installs.
"""

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from reconstruction.exports.cityjson import write_cityjson
from reconstruction.exports.component_parts import Ellipsoids, ellipsoids_of_all
from reconstruction.exports.compression import Compression
from reconstruction.exports.gaussian_blocks import turned
from reconstruction.exports.ply_export import write_ply
from reconstruction.exports.sog import write_sog
from reconstruction.exports.spz import write_spz
from reconstruction.splats.ply import read_blocks, read_header
from tests import foreign
from tests.reconstruction.exports.hard_scenes import antialiased, in_order
from tests.reconstruction.exports.sog.reading import read_sog
from tests.reconstruction.exports.spz.reading import read_spz
from tests.reconstruction.exports.test_turned_axes import covariances
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

pytestmark = pytest.mark.slow

MODULES = Path(__file__).parents[2] / "foreign" / "node_modules"

ALL = Compression(first_bits=8, further_bits=8, palette=65_536, gaussians_each=1, least_opacity=0.0)

REFERENCE = """
import { readFileSync, writeFileSync } from 'fs';
const [library, file, axes, out] = process.argv.slice(1);
const spz = await (await import(library)).default();
const bytes = new Uint8Array(readFileSync(file));
const cloud = await spz.loadSpzFromBuffer(bytes, { to: spz.CoordinateSystem[axes] });
const found = { n: cloud.numPoints, degree: cloud.shDegree };
const names = ['positions', 'scales', 'rotations', 'alphas', 'colors', 'sh'];
for (const name of names) found[name] = Array.from(cloud[name]);
writeFileSync(out, JSON.stringify(found));
"""


@pytest.fixture(scope="module")
def scene():
    """With opacities that have finite logits in 8 bits."""
    scene = synthetic_scene(((120, 0, 60), (70,)), 50)
    for component in scene.components:
        logits = component.gaussians.values["opacity_logits"]
        np.clip(logits, -5.0, 5.0, out=logits)
    return scene


def run_node(*arguments):
    if shutil.which("node") is None:
        pytest.skip("Node.js is not on this machine")
    done = subprocess.run(["node", *map(str, arguments)], capture_output=True, text=True, check=False, timeout=500)
    assert done.returncode == 0, done.stderr[-2000:]


def package(name):
    folder = MODULES / name
    if not folder.is_dir():
        pytest.skip(f"the npm package {name} is not there: make foreign")
    return folder


def converted(source, target, *options):
    """A file that splat-transform has read and written."""
    run_node(package("@playcanvas/splat-transform") / "bin" / "cli.mjs", "-q", "-w", *options, source, target)
    return target


def of_ply(path):
    """Gaussians of a PLY file as it is, whatever its axes."""
    table = np.concatenate(list(read_blocks(path, read_header(path))))
    names = table.dtype.names

    def columns(*wanted):
        return np.stack([table[name] for name in wanted], axis=1).astype(np.float32)

    n_rest = sum(name.startswith("f_rest_") for name in names)
    sh = np.zeros((len(table), 16, 3), np.float32)
    sh[:, 0] = columns("f_dc_0", "f_dc_1", "f_dc_2")
    rest = columns(*(f"f_rest_{i}" for i in range(n_rest))).reshape(len(table), 3, -1).transpose(0, 2, 1)
    sh[:, 1 : 1 + rest.shape[1]] = rest
    quats = columns("rot_0", "rot_1", "rot_2", "rot_3")
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    sizes = columns(*(name for name in ("scale_0", "scale_1", "scale_2") if name in names))
    scales = np.full((len(table), 3), 1e-6, np.float32)
    scales[:, : sizes.shape[1]] = np.exp(sizes)
    opacities = 1.0 / (1.0 + np.exp(-table["opacity"].astype(np.float64)))
    panels = table["panel_id"].astype(np.int32) if "panel_id" in names else np.full(len(table), -1, np.int32)
    return Ellipsoids(columns("x", "y", "z"), quats, scales, opacities.astype(np.float32), sh, panels)


def assert_same(found, truth, with_panels=False):
    np.testing.assert_allclose(found.means_m, truth.means_m, atol=1e-6)
    np.testing.assert_allclose(found.scales_m, truth.scales_m, rtol=1e-5)
    np.testing.assert_allclose(found.opacities, truth.opacities, atol=1e-6)
    np.testing.assert_allclose(found.sh, truth.sh, atol=1e-6)
    np.testing.assert_allclose(covariances(found), covariances(truth), atol=1e-8)
    if with_panels:
        assert np.array_equal(found.panels, truth.panels)


@pytest.mark.parametrize("version", [3, 4])
@pytest.mark.parametrize(("axes", "name"), [("y-up", "RUB"), ("y-down", "RDF"), ("enu", "RFU")])
def test_the_reference_library_reads_our_spz_in_any_axes(scene, tmp_path, axes, name, version):
    path, out = write_spz(scene, tmp_path / "a.spz", ALL, version=version).path, tmp_path / "found.json"
    library = package("@adobe/spz") / "dist" / "spz.js"
    run_node("--input-type=module", "-e", REFERENCE, library, path, name, out)
    content = json.loads(out.read_text())
    n = content["n"]
    values = {key: np.array(each, np.float32).reshape(n, -1) for key, each in content.items() if isinstance(each, list)}
    sh = np.concatenate([values["colors"], values["sh"]], axis=1).reshape(n, 16, 3)
    opacities = (1.0 / (1.0 + np.exp(-values["alphas"][:, 0].astype(np.float64)))).astype(np.float32)
    quats, scales = values["rotations"][:, [3, 0, 1, 2]], np.exp(values["scales"])
    found = Ellipsoids(values["positions"], quats, scales, opacities, sh, np.full(n, -1, np.int32))
    assert_same(found, turned(read_spz(path), axes))


@pytest.mark.parametrize("kind", ["2dgs", "3dgs"])
def test_splat_transform_reads_our_ply(scene, tmp_path, kind):
    path = write_ply(scene, tmp_path / "a.ply", kind, least_opacity=0.0).path
    out = converted(path, tmp_path / "out.ply")
    header = read_header(out)
    assert ("SplatRenderMode: 2dgs" in header.comments) == (kind == "2dgs")
    assert ("scale_2" in header.names) == (kind == "3dgs")
    assert_same(of_ply(out), turned(ellipsoids_of_all(scene.components), "y-down"), with_panels=True)


def test_splat_transform_reads_our_sog_as_discs(scene, tmp_path):
    path = write_sog(scene, tmp_path / "a.sog", ALL).path
    out = converted(path, tmp_path / "out.ply")
    assert "SplatRenderMode: 2dgs" in read_header(out).comments
    assert_same(of_ply(out), turned(read_sog(path), "y-down"))


@pytest.mark.parametrize("is_on", [True, False])
@pytest.mark.parametrize("name", ["a.ply", "a.sog", "a.spz"])
def test_splat_transform_knows_which_splats_are_antialiased(scene, tmp_path, name, is_on):
    path, learned_so = tmp_path / name, antialiased(scene, is_on)
    if name == "a.ply":
        write_ply(learned_so, path, "3dgs")
    elif name == "a.sog":
        write_sog(learned_so, path)
    else:
        write_spz(learned_so, path)
    out = converted(path, tmp_path / "out.ply")
    assert ("SplatRenderMode: mip" in read_header(out).comments) == is_on


@pytest.mark.parametrize("version", [3, 4])
def test_splat_transform_reads_our_spz(scene, tmp_path, version):
    path = write_spz(scene, tmp_path / "a.spz", ALL, version=version).path
    assert_same(of_ply(converted(path, tmp_path / "out.ply")), turned(read_spz(path), "y-up"))


def test_we_read_what_splat_transform_writes(scene, tmp_path):
    path = write_ply(scene, tmp_path / "a.ply", least_opacity=0.0).path
    truth = in_order(scene, "y-down")
    plain = write_ply(scene, tmp_path / "plain.ply", degree=0, least_opacity=0.0).path
    for found, n_colours in (
        # Of a palette, its search takes 17 s of processor time.
        (read_sog(converted(plain, tmp_path / "b.sog", "-g", "cpu")), 1),
        (read_spz(converted(path, tmp_path / "b.spz", "--spz-version", "3"), "y-down"), 16),
        (read_spz(converted(path, tmp_path / "c.spz", "--spz-version", "4"), "y-down"), 16),
    ):
        nearest = np.linalg.norm(found.means_m[:, None] - truth.means_m[None], axis=2).argmin(axis=1)
        assert len(set(nearest)) == len(truth)
        own = truth.chosen(nearest)
        assert np.abs(found.means_m - own.means_m).max() < 5e-4
        assert np.abs(np.log(found.scales_m / own.scales_m)[:, :2]).max() < 0.05
        assert np.abs(found.opacities - own.opacities).max() < 1.1 / 255
        assert np.sqrt(np.square(found.sh - own.sh)[:, :n_colours].mean()) < 0.1


# Threads of TBB are not to be had where another library has brought an older one.
@pytest.mark.filterwarnings("ignore:.*TBB threading layer")
def test_gsply_reads_our_ply_and_spz(scene, tmp_path):
    gsply = pytest.importorskip("gsply")
    path = write_ply(scene, tmp_path / "a.ply", least_opacity=0.0).path
    truth = turned(ellipsoids_of_all(scene.components), "y-down")
    packed = write_spz(scene, tmp_path / "a.spz", ALL).path
    for found, expected in ((gsply.plyread(str(path)), truth), (gsply.spz.read_spz(str(packed)), None)):
        own = turned(read_spz(packed), "y-up") if expected is None else expected
        np.testing.assert_allclose(found.means, own.means_m, atol=1e-6)
        np.testing.assert_allclose(found.scales, np.log(own.scales_m), atol=1e-5)
        np.testing.assert_allclose(found.sh0, own.sh[:, 0], atol=1e-6)
        np.testing.assert_allclose(found.shN, own.sh[:, 1:], atol=1e-6)


def test_cjio_reads_our_city_model(scene, tmp_path):
    if importlib.util.find_spec("cjio") is None:
        pytest.skip("cjio is not installed")
    path = write_cityjson(scene, tmp_path / "a.json", {}).path
    reader = [sys.executable, "-W", "error", str(foreign.HERE / "read_cityjson.py"), str(path)]
    found = json.loads(subprocess.run(reader, check=True, capture_output=True, text=True).stdout)
    assert found["epsg"] == 32650
    assert found["n_objects"] == 1
    assert sorted(found["box"]) == pytest.approx(sorted(found["extent"]), abs=1e-3)
    assert found["n_vertices"] == found["n_needed"] > 0
