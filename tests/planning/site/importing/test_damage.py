"""One damaged part in a file of any format: the rest is imported, and the part is named."""

from __future__ import annotations

import json
import random
import re
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.geo.mesh import box_mesh, join
from planning.site.importing.importer import ImportedSite, import_site
from planning.site.importing.options import ImportOptions
from tests.slow import slow

HERE = Origin(48.0, 11.0, 400.0)
TOLD = "left out, because they are broken"


def imported(path: Path, **options: Any) -> ImportedSite:
    return import_site(path, ImportOptions(panels_required=False, **options))


def told(site: ImportedSite) -> str:
    return next((note for note in site.notes if note.startswith(TOLD)), "")


# --- meshes ---

MESH = join(
    [box_mesh(np.array([-10.0, -6.0, 0.0]), np.array([10.0, 6.0, 15.0])),
     box_mesh(np.array([20.0, -6.0, 0.0]), np.array([30.0, 6.0, 12.0]))]
)  # fmt: skip
"""Two blocks of twelve triangles each."""

OBJ = "\n".join(
    [f"v {x} {y} {z}" for x, y, z in MESH.vertices_enu_m] + ["f {} {} {}".format(*(row + 1)) for row in MESH.triangles]
)
LAST = "v 30.0 6.0 12.0"


def exported(kind: str) -> bytes:
    return _bytes(trimesh.Trimesh(MESH.vertices_enu_m, MESH.triangles, process=False).export(file_type=kind))


def _bytes(content: Any) -> bytes:
    return content if isinstance(content, bytes) else str(content).encode()


def ply_text() -> str:
    made = trimesh.Trimesh(MESH.vertices_enu_m, MESH.triangles, process=False)
    return _bytes(made.export(file_type="ply", encoding="ascii")).decode().strip()


def patched(content: bytes, at: int, value: bytes) -> bytes:
    return content[:at] + value + content[at + len(value) :]


NAN = struct.pack("<f", float("nan"))

MESHES: dict[str, tuple[Callable[[], bytes], int, str]] = {
    "missing vertex.obj": (lambda: f"{OBJ}\nf 1 2 99".encode(), 24, "a triangle without"),
    "vertex 0.obj": (lambda: f"{OBJ}\nf 0 2 3".encode(), 24, "line 41"),
    "not a number.obj": (lambda: OBJ.replace(LAST, "v nan 6 12").encode(), 18, "line 16"),
    "two numbers.obj": (lambda: OBJ.replace(LAST, "v 30.0 6.0").encode(), 18, "line 16"),
    "letters.obj": (lambda: OBJ.replace(LAST, "v x y z").encode(), 18, "line 16"),
    "beyond.obj": (lambda: OBJ.replace(LAST, "v 1e308 6 12").encode(), 18, "a triangle without"),
    "face of two.obj": (lambda: f"{OBJ}\nf 1 2".encode(), 24, "line 41"),
    "face of letters.obj": (lambda: f"{OBJ}\nf a b c".encode(), 24, "line 41"),
    "extras.obj": (lambda: f"mtllib no.mtl\n{OBJ}\nfoo bar\nl 1 2\np 3\nvt 0 0".encode(), 24, ""),
    "counted back.obj": (lambda: f"{OBJ}\nf -1 -2 -3".encode(), 25, ""),
    "missing vertex.ply": (lambda: ply_text().rsplit("\n", 1)[0].encode() + b"\n3 0 1 99\n", 23, "a triangle without"),
    "short row.ply": (lambda: ply_text().rsplit("\n", 1)[0].encode() + b"\n3 0\n", 23, "line "),
    "binary missing vertex.ply": (lambda: exported("ply")[:-4] + struct.pack("<i", 99), 23, "a triangle without"),
    "binary no number.ply": (
        lambda: patched(exported("ply"), exported("ply").index(b"end_header\n") + 11, NAN),
        18,
        "a triangle without",
    ),
    "binary no number.stl": (lambda: patched(exported("stl"), 96, NAN), 23, "a triangle without"),
    "letters.stl": (lambda: re.sub(rb"vertex \S+", b"vertex a", exported("stl_ascii"), count=1), 23, "facet 1"),
    "two corners.stl": (lambda: re.sub(rb"vertex [^\n]*\n", b"", exported("stl_ascii"), count=1), 23, "facet 1"),
}


@pytest.mark.few(6)
@pytest.mark.parametrize("name", MESHES)
def test_what_is_whole_of_a_mesh_is_imported_and_the_rest_named(tmp_path: Path, name: str) -> None:
    make, n_triangles, named = MESHES[name]
    path = tmp_path / name.replace(" ", "-")
    path.write_bytes(make())
    site = imported(path, origin=HERE)
    assert len(site.model.building.triangles) == n_triangles
    assert (named in told(site)) if named else told(site) == ""


def two_blocks() -> tuple[dict[str, Any], bytes]:
    """A GLB of two meshes: its description, and the chunk with its numbers."""
    scene = trimesh.Scene([trimesh.creation.box(bounds=[[x, 0.0, 0.0], [x + 10.0, 12.0, 10.0]]) for x in (0.0, 20.0)])
    content = _bytes(scene.export(file_type="glb"))
    length = struct.unpack("<I", content[12:16])[0]
    return json.loads(content[20 : 20 + length]), content[20 + length :]


def glb(document: dict[str, Any], rest: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + rest
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


@pytest.mark.parametrize(
    ("keys", "value", "named"),
    [
        (["meshes", 1, "primitives", 0, "indices"], 99, "mesh '"),
        (["meshes", 1, "primitives", 0, "attributes"], {}, "mesh '"),
        (["meshes", 1, "primitives", 0], "nothing", "mesh '"),
        (["accessors", -1, "componentType"], 1, "mesh '"),
        (["accessors", -1, "count"], 10**6, "mesh '"),
        (["bufferViews", -1, "byteLength"], 10**9, "mesh '"),
        (["nodes", -1, "mesh"], 77, "node '"),
    ],
)
def test_a_mesh_of_a_glb_that_leads_nowhere_leaves_the_others(
    tmp_path: Path, keys: list[Any], value: Any, named: str
) -> None:
    document, rest = two_blocks()
    target: Any = document
    for key in keys[:-1]:
        target = target[key]
    target[keys[-1]] = value
    (tmp_path / "a.glb").write_bytes(glb(document, rest))
    site = imported(tmp_path / "a.glb", origin=HERE)
    assert len(site.model.building.triangles) == 12
    assert named in told(site)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.ply", lambda: "\n".join(ply_text().split("\n")[:-3]).encode(), "cut off: it announces 40 rows, and 37"),
        ("a.ply", lambda: exported("ply")[:-20], "cut off"),
        ("a.stl", lambda: exported("stl")[:-30], "cut off: it announces 24 triangles, and 23"),
        ("a.obj", lambda: b"v 0 0 0\nf 1 2 3\n", "no triangles that are whole"),
    ],
)
def test_a_mesh_that_is_cut_off_is_refused(tmp_path: Path, name: str, content: Callable[[], bytes], said: str) -> None:
    (tmp_path / name).write_bytes(content())
    with pytest.raises(InputError, match=said):
        imported(tmp_path / name, origin=HERE)


# --- real files ---


def damaged_gml(text: str, rng: random.Random) -> str:
    """One outline of a file made senseless, or an element added that no schema has."""
    rings = list(re.finditer(r"(<[\w:]*posList[^>]*>)([^<]*)(</)", text))
    ring = rng.choice(rings)
    numbers = ring[2].split()
    instead = {
        "two points": " ".join(numbers[:6]),
        "no number": " ".join(["x", *numbers[1:]]),
        "nan": " ".join(["nan", *numbers[1:]]),
        "odd": " ".join(numbers[:-1]),
        "nothing": "",
        "unknown": ring[2],
    }
    kind = rng.choice(sorted(instead))
    added = "<zz:wonder xmlns:zz='http://example.org/none'><zz:more/></zz:wonder>" if kind == "unknown" else ""
    return text[: ring.start()] + ring[1] + instead[kind] + added + text[ring.end(2) :]


BUILDINGS = ["4018106", "4018133", "4018204b", "4018270", *map(slow, ("4018115", "4018149a", "4018260", "4018302"))]


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILDINGS)
def test_a_damaged_outline_of_a_real_building_costs_that_outline(shared_data: Path, tmp_path: Path, name: str) -> None:
    real = shared_data / "buildings" / "ingolstadt_lod3" / f"{name}.xml"
    text, whole = real.read_text("utf-8"), imported(real)
    rng = random.Random(name)
    path = tmp_path / f"{name}.xml"
    for _ in range(2):
        path.write_text(damaged_gml(text, rng), "utf-8")
        site = imported(path)
        lost = whole.model.site.n_panels - site.model.site.n_panels
        assert lost <= 1
        assert len(site.model.building.triangles) <= len(whole.model.building.triangles)
        if len(site.model.building.triangles) < len(whole.model.building.triangles):
            assert told(site)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["delft_1b", "multi_lod", "rotterdam_subset", "zurich_subset_lod2"])
def test_a_damaged_part_of_a_real_city_model_costs_that_part(shared_data: Path, tmp_path: Path, name: str) -> None:
    content = json.loads((shared_data / "buildings" / "cityjson" / f"{name}.json").read_text("utf-8"))
    rng = random.Random(name)
    options = {"crs": "EPSG:7415"} if name in ("multi_lod", "rotterdam_subset") else {}
    path = tmp_path / f"{name}.json"
    for damage in ("ring", "object", "geometry", "vertex"):
        broken = json.loads(json.dumps(content))
        objects = sorted(key for key, each in broken["CityObjects"].items() if each.get("geometry"))
        key = rng.choice(objects)
        geometry = broken["CityObjects"][key]["geometry"][0]
        if damage == "ring":
            surfaces = geometry["boundaries"]
            while isinstance(surfaces[0][0][0], list):
                surfaces = surfaces[0]
            surfaces[0] = [[0, 1]]
        elif damage == "object" and len(objects) > 1:
            broken["CityObjects"][key] = 5
        elif damage == "geometry" and len(objects) > 1:
            geometry["boundaries"] = "wall"
        elif damage == "vertex":
            broken["vertices"][rng.randrange(len(broken["vertices"]))] = ["x", None]
        path.write_text(json.dumps(broken), "utf-8")
        assert len(imported(path, **options).model.building.triangles) > 0


IFC_DAMAGES: dict[str, Callable[[str], str]] = {
    "gone": lambda _line: "",
    "unknown": lambda line: re.sub(r"=\s*\w+\(", "=IFCWONDER(", line),
    "dangling": lambda line: re.sub(r"#\d+(?=[,)])", "#99999999", line, count=1),
    "text without end": lambda line: line.replace(");", "'x);"),
    "no bracket": lambda line: line.replace("(", "", 1),
    "beyond": lambda line: re.sub(r"(?<=[(,])-?\d+\.\d*(E-?\d+)?", "1.E400", line, count=1),
}


def damaged_ifc(text: str, damage: str, rng: random.Random) -> str:
    lines = text.split("\n")
    shapes = [k for k, line in enumerate(lines) if re.match(r"#\d+ ?= ?IFC(FACE|POLYLOOP|CARTESIANPOINT|DIREC)", line)]
    change = IFC_DAMAGES[damage]
    place = next(k for k in rng.sample(shapes, len(shapes)) if change(lines[k]) != lines[k])
    lines[place] = change(lines[place])
    return "\n".join(lines)


@pytest.mark.slow
@pytest.mark.parametrize("damage", IFC_DAMAGES)
@pytest.mark.parametrize(("name", "n_panels"), [("curtain_wall_small", 21), ("office_a", 69)])
def test_a_damaged_line_of_a_real_bim_model_costs_that_line(
    shared_data: Path, tmp_path: Path, name: str, n_panels: int, damage: str
) -> None:
    text = (shared_data / "bim" / f"{name}.ifc").read_text("latin-1")
    path = tmp_path / f"{name}.ifc"
    path.write_text(damaged_ifc(text, damage, random.Random(f"{name} {damage}")), "latin-1")
    site = imported(path)
    assert site.model.site.n_panels >= n_panels - 1
    assert site.model.site.n_panels == n_panels or told(site)
