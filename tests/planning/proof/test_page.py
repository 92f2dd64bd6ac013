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
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.verifiers import NODE, PAGE, QtScript, by_module, by_node, load, mission_names


@pytest.fixture(scope="module")
def page() -> QtScript:
    return QtScript()


def test_the_page_proves_what_the_program_proves_in_the_same_words(page: QtScript, tmp_path: Path) -> None:
    files, _ = kept_hut()
    claims = page(files)
    assert claims == by_module(load(), files, tmp_path)
    assert {claim.verdict for claim in claims} == {"proved"}


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
    assert len(found["claims"]) == 11 + len(mission_names(files)) + 1
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


JSON_TEXTS = (
    b'{"a": [1, 2.5e3, -0, "x\\u00e9\\n\\/"], "b": null, "c": {"d": true}}',
    b"[1,]",
    b"01",
    b"-",
    b'"\\ud800"',
    b"NaN",
    b"[Infinity]",
    b"1e400",
    b"1e299",
    b"1e300",
    b'{"a": 1, "a": 2}',
    b"[1] x",
    b"\t[true, false]\r\n",
    b'{"__proto__": 1}',
    b'"\x01"',
    b"''",
    b"1.",
    b".5",
    b"+1",
    b"1E5",
    b"[1 2]",
    b'{"a" 1}',
    b"",
    b"9" * 400,
    b"\xef\xbb\xbf{}",
    b'"\xc3\xa9"',
    b'"\xff"',
    b'"\xed\xa0\x80"',
    b'"\xf0\x9f\x98\x80"',
    b'"\xc0\xaf"',
    b"\x00",
    b"[" * 64 + b"]" * 64,
    b"[" * 65 + b"]" * 65,
    b"[" * 66 + b"]" * 66,
    b"[" * 100_000,
    b'{"a": ' * 66 + b"1" + b"}" * 66,
    b"nul",
    b"truex",
    b'"\\x41"',
    b'"\\u12"',
    b"1e-400",
    b"123456789012345678901234567890",
    b"0.1e1",
    b"[0x10]",
    b"1_000",
    "\u0663".encode(),
    b"\xa0[]",
    b"\x0b[]",
    b'{"a":1,}',
    b"{,}",
    b"{1:2}",
    b'"',
    b'"\\',
    b"[",
    b"{",
    b'{"a',
    b"\x7f",
)


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
        assert json.loads(found or "") == truth


@given(
    st.floats(-1e9, 1e9) | st.sampled_from([0.0, 1e-5, 1e-4, 123456.0, 1234567.0, 0.1, 100000.0, 999999.5, 3.5, 1e6])
)
def test_numbers_are_written_alike(page: QtScript, value: float) -> None:
    assert json.loads(page.call(f"short({value!r})", b"") or "") == f"{value:g}"


@given(st.floats(-360.0, 360.0))
def test_sines_are_the_same_to_the_last_bit(page: QtScript, angle_deg: float) -> None:
    assert json.loads(page.call(f"sincos({angle_deg!r})", b"") or "") == list(verifier.sincos(angle_deg))
