"""The page: the verifier's twin in JavaScript, which opens from a folder without a network and says the same."""

from __future__ import annotations

import hashlib
import json
import re
import zlib
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.proof import reflight_verify as verifier
from tests.planning.proof.attack import same
from tests.planning.proof.borders import changed_parts
from tests.planning.proof.probes import JSON_TEXTS, meshes
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.tamper import parent_of, sealed
from tests.planning.proof.verifiers import (
    NODE,
    PAGE,
    PLAN,
    PROOF,
    SITE,
    QtScript,
    by_module,
    by_node,
    load,
    mission_names,
)

Place = tuple[float, float, float]


@pytest.fixture(scope="module")
def page() -> QtScript:
    return QtScript()


def test_the_page_proves_what_the_program_proves_in_the_same_words(page: QtScript, tmp_path: Path) -> None:
    files, _ = kept_hut()
    claims = page(files)
    assert claims == by_module(load(), files, tmp_path)
    assert {claim.verdict for claim in claims} == {"proved"}


@pytest.mark.slow
@pytest.mark.skipif(NODE is None, reason="Node is not installed")
def test_the_page_says_the_same_of_numbers_at_their_limits_and_of_odd_parts(tmp_path: Path) -> None:
    hut, _ = kept_hut()
    found, kinds = [], list(changed_parts())
    for record, path, value in kinds:
        name = {"site": SITE, "plan": PLAN, "proof": PROOF}[record]
        content = json.loads(hut[name])
        parent_of(content, path)[path[-1]] = value
        found.append(sealed({**hut, name: json.dumps(content).encode()}))
    module, folder = load(), tmp_path / "files"
    folder.mkdir()
    for kind, files, page_claims in zip(kinds, found, by_node(found, tmp_path), strict=True):
        assert same(by_module(module, files, folder), page_claims), kind


@pytest.mark.long
@pytest.mark.skipif(NODE is None, reason="Node is not installed")
def test_node_says_what_qt_says(page: QtScript, tmp_path: Path) -> None:
    files, _ = kept_hut()
    weaker = {**files, "plan.json": files["plan.json"].replace(b'"min_distance_m": 4.0', b'"min_distance_m": 5.0')}
    assert by_node([files, weaker], tmp_path) == [page(files), page(weaker)]


def test_the_page_is_one_file_that_reaches_for_nothing() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    assert not re.search(
        r"\b(src|href)\s*=|@import|\bimport\b|\bfetch\(|XMLHttpRequest|WebSocket|innerHTML|eval\(", text
    )
    addresses = set(re.findall(r"https?://[^\s\"'<>;)]+", text))
    assert addresses == {
        "http://www.apache.org/licenses/LICENSE-2.0",
        "http://www.opengis.net/kml/2.2",
        "http://www.dji.com/wpmz/1.0.6",
    }


def test_a_folder_of_files_is_sorted_out_by_what_the_proof_names(page: QtScript) -> None:
    files, _ = kept_hut()
    proof = json.loads(files["plan.proof"])
    assert (proof["site"]["name"], proof["plan"]["name"]) == ("site.json", "plan.json")
    found = page.folder(files)
    assert found["missing"] == ""
    assert [claim["id"] for claim in found["claims"]][-1] == "missions"
    assert {claim["verdict"] for claim in found["claims"]} == {"proved"}
    assert len(found["claims"]) == len(verifier.CLAIMS) + len(mission_names(files)) + 1
    assert "no .proof" in page.folder({"site.json": files["site.json"]})["missing"]
    without_plan = {name: content for name, content in files.items() if name != "plan.json"}
    assert "plan.json" in page.folder(without_plan)["missing"]


@given(
    st.binary(max_size=3000),
    st.integers(0, 9),
    st.sampled_from([zlib.Z_DEFAULT_STRATEGY, zlib.Z_FIXED, zlib.Z_HUFFMAN_ONLY]),
)
def test_packed_data_are_unpacked(page: QtScript, content: bytes, level: int, strategy: int) -> None:
    packer = zlib.compressobj(level, zlib.DEFLATED, -15, 8, strategy)
    packed = packer.compress(content) + packer.flush()
    found = page.call(f"inflate(bytes, {len(content)})", packed)
    assert bytes(json.loads(found)) == content
    if len(content) > 0:
        assert page.call(f"inflate(bytes, {len(content) - 1})", packed) is None


@given(st.binary(max_size=400), st.integers(0, 2**32))
def test_damaged_packed_data_are_refused_as_zlib_refuses_them(page: QtScript, content: bytes, seed: int) -> None:
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    damaged = bytearray(packer.compress(content) + packer.flush())
    random = Random(seed)
    damaged[random.randrange(len(damaged))] ^= 1 << random.randrange(8)
    reader = zlib.decompressobj(-15)
    try:
        truth = reader.decompress(bytes(damaged))
        is_whole = reader.eof and not reader.unused_data and len(truth) == len(content)
    except zlib.error:
        is_whole = False
    found = page.call(f"inflate(bytes, {len(content)})", bytes(damaged))
    assert (found is not None) == is_whole
    if is_whole:
        assert bytes(json.loads(found or "")) == truth


@given(st.binary(max_size=300))
def test_checksums_are_those_of_the_standard_library(page: QtScript, content: bytes) -> None:
    assert page.call("sha256(bytes)", content) == json.dumps(hashlib.sha256(content).hexdigest())
    assert page.call("crc32(bytes)", content) == json.dumps(zlib.crc32(content))


@pytest.mark.parametrize("content", JSON_TEXTS, ids=range(len(JSON_TEXTS)))
def test_json_is_read_and_refused_alike(page: QtScript, content: bytes) -> None:
    try:
        truth = verifier.read_json(content, "it")
        is_read = True
    except verifier.Refused:
        truth, is_read = None, False
    found = page.call("plain(readJson(bytes, 'it'))", content)
    assert (found is not None) == is_read
    if is_read:
        # What overflows is written as null there.
        assert json.loads(found or "") == json.loads(json.dumps(truth).replace("Infinity", "null"))


@given(
    st.floats(-1e9, 1e9) | st.sampled_from([0.0, 1e-5, 1e-4, 123456.0, 1234567.0, 0.1, 100000.0, 999999.5, 3.5, 1e6])
)
def test_numbers_are_written_alike(page: QtScript, value: float) -> None:
    assert json.loads(page.call(f"short({value!r})", b"") or "") == f"{value:g}"


@given(st.floats(-360.0, 360.0))
def test_sines_are_the_same_but_for_rounding(page: QtScript, angle_deg: float) -> None:
    found = json.loads(page.call(f"sincos({angle_deg!r})", b"") or "")
    assert found == pytest.approx(verifier.sincos(angle_deg), abs=2e-16)


coordinates = st.floats(-100.0, 100.0)
places = st.tuples(coordinates, coordinates, coordinates)


@given(places, places, places, places)
def test_distances_from_triangles_are_the_same_to_the_last_bit(
    page: QtScript, p: Place, a: Place, b: Place, c: Place
) -> None:
    asked = f"distance({list(p)!r}, {[list(a), list(b), list(c)]!r})"
    assert json.loads(page.call(asked, b"") or "") == verifier.distance(p, (a, b, c))


@given(st.floats(-89.0, 89.0), st.floats(-180.0, 180.0), st.floats(-100.0, 1000.0))
def test_places_of_missions_are_the_same_but_for_rounding(
    page: QtScript, lat: float, lon: float, height: float
) -> None:
    origin = (22.3372, 114.2636, 62.0)
    found = page.call(f"enu({list(origin)!r}, {lat!r}, {lon!r}, {height!r})", b"")
    assert json.loads(found or "") == pytest.approx(verifier.enu(origin, lat, lon, height), abs=1e-8)


@given(st.floats(1e-9, 1e4), st.floats(0.1, 20.0), st.floats(0.1, 10.0), st.sampled_from([1e30, 0.5, 4.0, 100.0]))
def test_times_of_legs_are_the_same_to_the_last_bit(
    page: QtScript, size: float, speed: float, acceleration: float, jerk: float
) -> None:
    found = page.call(f"restToRest({size!r}, {speed!r}, {acceleration!r}, {jerk!r})", b"")
    assert json.loads(found or "") == verifier.rest_to_rest(size, speed, acceleration, jerk)


@pytest.mark.parametrize("content", list(meshes()), ids=lambda content: str(len(content)))
def test_meshes_are_read_and_refused_alike(page: QtScript, content: bytes) -> None:
    try:
        truth = [[list(corner) for corner in triangle] for triangle in verifier.read_ply(content)]
    except verifier.Refused:
        assert page.call("readPly(bytes)", content) is None
        return
    assert json.loads(page.call("readPly(bytes)", content) or "") == truth
