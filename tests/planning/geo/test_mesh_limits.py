"""Mesh files that cost more than they say, or lie: told before a reader starts, in words, and within memory."""

import json
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from planning.base.errors import InputError
from planning.geo.mesh import COMPRESSED, check_mesh_size, read_mesh

ROOT = Path(__file__).resolve().parents[3]


def glb(header, binary):
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def house():
    """Description and bytes of a sound file: two triangles."""
    points = np.array([[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]], "<f4").tobytes()
    indices = np.array([0, 1, 2, 0, 2, 3], "<u4").tobytes()
    header = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(points) + len(indices)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }
    return header, points + indices


def refusal(path, content):
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_mesh(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert len(text) < 700
    return text


def test_a_sound_file_is_read_with_all_that_stands_beside_its_triangles(tmp_path):
    header, binary = house()
    header["nodes"] = [{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]}]
    header["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 0})
    (tmp_path / "a.glb").write_bytes(glb(header, binary))
    assert len(read_mesh(tmp_path / "a.glb").triangles) == 4


def many_views(header):
    """Four megabytes that a hundred thousand views show anew."""
    header["bufferViews"] += [{"buffer": 0, "byteLength": 4_000_000}] * 1_000


def many_places(header):
    """The same triangles in a hundred thousand places."""
    header["accessors"][1]["count"] = 900_000
    header["nodes"] = [{"children": list(range(1, 400))}, *[{"mesh": 0}] * 399]


def many_meshes(header):
    """The same triangles in very many meshes."""
    header["accessors"][1]["count"] = 900_000
    header["meshes"][0]["primitives"] *= 500


@pytest.mark.parametrize("change", [many_views, many_places, many_meshes])
def test_files_of_few_bytes_that_mean_gigabytes_are_refused(tmp_path, change):
    header, binary = house()
    change(header)
    content = glb(header, binary + bytes(4_000_000))
    assert len(content) < 7_000_000
    assert "this mesh would take about" in refusal(tmp_path / "a.glb", content)


def without_view(header):
    del header["accessors"][0]["bufferView"]


def sparse(header):
    header["accessors"][0]["sparse"] = {"count": 1, "indices": {}, "values": {}}


def elsewhere(header):
    header["buffers"][0]["uri"] = "/dev/zero"


def compressed(header):
    header["extensionsRequired"] = [COMPRESSED[0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (without_view, "sparse accessors"),
        (sparse, "sparse accessors"),
        (elsewhere, "in another file"),
        (compressed, "compressed"),
        (lambda header: header["accessors"][1].update(count=-1), "damaged"),
        (lambda header: header["accessors"][1].update(count="6"), "damaged"),
        (lambda header: header["accessors"][1].update(count=1e308), "damaged"),
        (lambda header: header["accessors"][0].update(type="VEC9"), "damaged"),
        (lambda header: header["meshes"][0]["primitives"][0].update(indices=7), "damaged"),
        (lambda header: header.update(nodes=[{"children": [9]}]), "damaged"),
        (lambda header: header.update(nodes=[{"mesh": 0, "children": [0]}]), "no triangles|cannot be read|"),
        (lambda header: header.update(bufferViews=None), "damaged"),
    ],
)
def test_forms_that_are_not_read_and_lies_are_told(tmp_path, change, words):
    header, binary = house()
    change(header)
    path = tmp_path / "a.glb"
    path.write_bytes(glb(header, binary))
    if words.endswith("|"):
        try:
            read_mesh(path)
        except InputError:
            return
    else:
        with pytest.raises(InputError, match=words):
            read_mesh(path)


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n", "names vertex|cannot be read"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 -9\n", "names vertex|cannot be read"),
        ("a.obj", b"v 0 0 0\nv 1e308 0 0\nv 1 1e308 0\nf 1 2 3\n", r"a coordinate of 1e\+308 m"),
        ("a.obj", b"v 0 0 0\nv 1e999 0 0\nv 1 1 0\nf 1 2 3\n", "not finite"),
        ("a.obj", b"v 0 0 0\nv nan 0 0\nv 1 1 0\nf 1 2 3\n", "not finite|cannot be read"),
        ("a.obj", b"\n" * 30_000_000, "would take about"),
        ("a.ascii.stl", b"solid\n" + b"vertex 1 1 1\n" * 20_000_000, "would take about"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n" + b"1\n" * 25_000_000, "would take about"),
        ("a.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n",
         "cannot be read"),
    ],
)  # fmt: skip
def test_texts_beyond_all_bounds_are_refused(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_mesh(path)


def test_no_file_that_a_mesh_names_is_opened(tmp_path):
    trimesh.creation.box().export(tmp_path / "a.obj")
    text = (tmp_path / "a.obj").read_text()
    (tmp_path / "a.obj").write_text("mtllib /dev/zero\nusemtl x\n" + text)
    assert len(read_mesh(tmp_path / "a.obj").triangles) == 12
    box = trimesh.creation.box().export(file_type="ply")
    (tmp_path / "a.ply").write_bytes(
        box.replace(b"element vertex", b"comment TextureFile /dev/zero\nelement vertex", 1)
    )
    assert len(read_mesh(tmp_path / "a.ply").triangles) == 12


MEASURED = """
import re, sys
from pathlib import Path
from planning.geo.mesh import read_mesh
def highest():
    return 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
read_mesh(Path(sys.argv[1]))
Path("/proc/self/clear_refs").write_text("5")
before = highest()
read_mesh(Path(sys.argv[2]))
print(highest() - before)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ending", "options"),
    [(".obj", {}), (".ply", {}), (".stl", {}), (".glb", {}), (".ply", {"encoding": "ascii"})],
)
def test_large_sound_meshes_take_about_what_is_foreseen(tmp_path, ending, options, monkeypatch):
    small, large = tmp_path / f"small{ending}", tmp_path / f"large{ending}"
    if options:
        options["file_type"] = ending[1:]
    trimesh.creation.box().export(small, **options)
    trimesh.creation.icosphere(subdivisions=7).export(large, **options)
    command = [sys.executable, "-c", MEASURED, str(small), str(large)]
    taken = int(subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout)
    foreseen = []
    monkeypatch.setattr("planning.geo.mesh._refuse", lambda n_bytes, *_: foreseen.append(n_bytes))
    check_mesh_size(large.read_bytes(), ending, large)
    assert 0.1 < taken / foreseen[0] < 2.0, (taken, foreseen)
