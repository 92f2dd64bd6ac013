"""site.json: what is written reads back, and every wrong input gets a message that names the field."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.base.json_file import write_atomically
from planning.geo.mesh import box_mesh, closed_parts, read_mesh, write_mesh
from planning.site.bundled import SCENES, write_scene
from planning.site.file import read_site, site_to_json, write_site
from planning.site.records import panel_corners, require_panels
from tests.slow import slow


@pytest.fixture
def content():
    return json.loads(json.dumps(site_to_json(SCENES["canyon"]().site)))


def read_changed(tmp_path, content, mutate):
    write_mesh(tmp_path / "canyon.ply", SCENES["canyon"]().building)
    mutate(content)
    path = tmp_path / "site.json"
    path.write_text(json.dumps(content))
    return read_site(path)


def test_a_lowest_height_is_kept_and_a_site_without_one_has_the_file_that_it_always_had(tmp_path):
    bare = replace(SCENES["single-panel"]().site, building_mesh=None)
    assert "min_height_above_ground_m" not in site_to_json(bare)["airspace"]
    own = replace(bare, airspace=replace(bare.airspace, min_height_above_ground_m=7.5))
    write_site(tmp_path / "own.site.json", own)
    assert read_site(tmp_path / "own.site.json").site == own
    assert own.airspace.lowest_height_m() == 7.5
    assert bare.airspace.lowest_height_m() == 5.0
    assert own.airspace.lowest_height_m(3.0) == 3.0


@pytest.mark.parametrize("scene", [slow(name) if name == "tower" else name for name in sorted(SCENES)])
def test_every_bundled_site_reads_back_as_it_was_written(tmp_path, scene):
    path = write_scene(scene, tmp_path)
    model, original = read_site(path), SCENES[scene]()
    assert model.site == original.site
    np.testing.assert_allclose(
        np.sort(model.building.corners_enu_m.ravel()), np.sort(original.building.corners_enu_m.ravel()), atol=2e-5
    )
    assert len(model.sha256) == 64
    assert len(model.obstacles) == len(original.site.obstacles)


@pytest.mark.parametrize("scene", ["office", "library", "court", "tower"])
def test_panels_of_bundled_sites_face_away_from_their_building(scene):
    model = SCENES[scene]()
    corners = panel_corners(model.site)
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    from planning.geo.solids import Solids

    solids = Solids.of(model.building.corners_enu_m)
    assert (solids.clearance_m(corners.mean(axis=1) + 0.3 * normals) > 0).all()
    assert (solids.clearance_m(corners.mean(axis=1) - 0.3 * normals) < 0).all()


def test_unknown_fields_are_ignored(tmp_path, content):
    content["weather"] = "fine"
    content["facades"][0]["panels"][0]["maker"] = {"name": "x"}
    assert read_changed(tmp_path, content, lambda c: None).site.name == "canyon"


def set_at(*path_and_value):
    *path, value = path_and_value

    def mutate(content):
        for key in path[:-1]:
            content = content[key]
        if value is KeyError:
            del content[path[-1]]
        else:
            content[path[-1]] = value

    return mutate


CORNERS = ("facades", 0, "panels", 3, "corners_enu_m")
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]


@pytest.mark.parametrize(
    ("mutate", "message"),
    [
        (set_at("format", "reflight-site/2"), "format: expected 'reflight-site/1'"),
        (set_at("origin", KeyError), "missing required field 'origin'"),
        (set_at("origin", "lat_deg", 95.0), r"origin\.lat_deg: expected -90 to 90, got 95"),
        (set_at("origin", "lon_deg", "east"), r"origin\.lon_deg: expected number, got text"),
        (set_at("origin", "ellipsoid_height_m", 1e300), r"origin\.ellipsoid_height_m"),
        (set_at("home_enu_m", [0, 0]), "home_enu_m: expected list of length 3, got 2"),
        (set_at("home_enu_m", [691_000.0, 5_335_000.0, 20.0]), r"home_enu_m.* x is 691000 .*UTM"),
        (set_at("home_enu_m", [0.0, 1e300, 20.0]), r"home_enu_m.* y is 1e\+300 "),
        (set_at(*CORNERS, 2, 1, math.nan), r"facades\[0\]\.panels\[3\]\.corners_enu_m\[2\]\[1\]: expected a finite"),
        (set_at(*CORNERS, 2, 1, math.inf), r"corners_enu_m\[2\]\[1\]: expected a finite"),
        (set_at(*CORNERS, SQUARE[:3]), r"panels\[3\]\.corners_enu_m: expected list of length 4, got 3"),
        (set_at(*CORNERS, [[0, 0, 0]] * 4), "has an area of 0 m2"),
        (set_at(*CORNERS, [SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]]), "has an area of 0 m2"),
        (set_at(*CORNERS, [*SQUARE[:3], [0, 0.5, 1]]), "is not flat"),
        (set_at(*CORNERS, [*SQUARE[:3], [0.9, 0, 0.2]]), "not convex"),
        (set_at("facades", 0, "panels", 3, "id", "A-0002"), "unique panel ids, 'A-0002' occurs twice"),
        (lambda content: content.update(facades=[], building_mesh=None), "at least one panel, or a building_mesh"),
        (set_at("facades", {}), "facades: expected list, got object"),
        (set_at("building_mesh", "missing.ply"), "no such mesh file"),
        (set_at("building_mesh", "site.json"), r"expected a mesh file \(.ply"),
        (set_at("obstacles", 0, "mesh", "x.ply"), r"obstacles\[0\].*either mesh or box_enu_m"),
        (set_at("obstacles", 0, "box_enu_m", [[1, 1, 1], [0, 2, 2]]), r"obstacles\[0\]\.box_enu_m.*minimum corner"),
        (set_at("airspace", "max_enu_m", [-100, 0, 0]), r"airspace\.max_enu_m: the airspace is empty"),
        (
            set_at(
                "airspace", "no_fly", [{"id": "z", "polygon_enu_m": [[0, 0], [1, 1]], "floor_m": 0, "ceiling_m": 9}]
            ),
            r"airspace\.no_fly\[0\]\.polygon_enu_m.*at least 3",
        ),
        (
            set_at(
                "airspace",
                "no_fly",
                [{"id": "z", "polygon_enu_m": [[0, 0], [2, 2], [2, 0], [0, 2]], "floor_m": 0, "ceiling_m": 9}],
            ),
            "crosses itself",
        ),
        (
            set_at(
                "airspace",
                "no_fly",
                [{"id": "z", "polygon_enu_m": [[0, 0], [2, 0], [2, 2]], "floor_m": 9, "ceiling_m": 9}],
            ),
            "ceiling above its floor",
        ),
    ],
)
def test_wrong_fields_are_named_with_what_was_expected_and_found(tmp_path, content, mutate, message):
    with pytest.raises(InputError, match=message) as caught:
        read_changed(tmp_path, content, mutate)
    assert "site.json" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "not valid JSON, line 1"),
        (b"[1, 2", "not valid JSON"),
        (b"\xff\xfe{}", "UTF-8"),
        (b"[]", "expected object, got list"),
        (b'{"format": 1e999}', "format: expected a finite number"),
        (b"[" * 100_000, "nested too deeply"),
    ],
)
def test_files_that_are_not_sites_are_refused_with_a_reason(tmp_path, text, message):
    path = tmp_path / "site.json"
    path.write_bytes(text)
    with pytest.raises(InputError, match=message):
        read_site(path)


def test_missing_file_and_folder_are_refused_with_a_reason(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_site(tmp_path / "none.json")
    with pytest.raises(InputError, match="cannot be written"):
        write_site(tmp_path / "no" / "site.json", SCENES["roof"]().site)


def test_interrupted_write_leaves_the_old_file_and_no_other(tmp_path, monkeypatch):
    path = tmp_path / "site.json"
    path.write_text("old")
    monkeypatch.setattr("os.fsync", lambda _fd: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(InputError, match="No space left"):
        write_atomically(path, b"new")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl", ".glb"])
def test_meshes_of_every_kind_read_back_closed(tmp_path, suffix):
    import trimesh

    box = box_mesh(np.array([-1.0, -2.0, 0.0]), np.array([1.0, 2.0, 3.0]))
    path = tmp_path / f"box{suffix}"
    trimesh.Trimesh(box.vertices_enu_m, box.triangles, process=False).export(path)
    mesh = read_mesh(path)
    assert len(mesh.triangles) == 12
    assert (closed_parts(mesh.corners_enu_m) == 0).all()
    np.testing.assert_allclose(np.ptp(mesh.corners_enu_m.reshape(-1, 3), axis=0), [2, 4, 3], atol=1e-6)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 1\n", "cannot be read"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\n", "no triangles|cannot be read"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n", "not finite"),
        ("a.obj", b"v 691000 5335000 0\nv 691001 5335000 0\nv 691000 5335001 0\nf 1 2 3\n", "local ENU"),
        ("a.txt", b"", "expected a mesh file"),
        ("a.glb", b"glTF but not really", "does not begin with its description|is no GLB file"),
    ],
)
def test_bad_meshes_are_refused_with_a_reason(tmp_path, name, content, message):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_mesh(path)


@pytest.mark.parametrize("has_facades", [False, True])
def test_a_site_without_panels_is_written_and_read_back(tmp_path, has_facades):
    path = write_scene("court", tmp_path)
    model = read_site(path)
    emptied = tuple(replace(facade, panels=()) for facade in model.site.facades) if has_facades else ()
    site = replace(model.site, facades=emptied)
    sha256 = write_site(path, site)
    read = read_site(path)
    assert (read.site, read.sha256) == (site, sha256)
    assert len(read.building.triangles) == len(model.building.triangles)
    assert panel_corners(read.site).shape == (0, 4, 3)
    with pytest.raises(InputError, match="site 'court' has no panels yet: find them in photos"):
        require_panels(read.site)
    require_panels(model.site)
