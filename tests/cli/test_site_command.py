"""`site import` and `site terrain`: models and heights become sites, or are refused with what to add."""

import pytest

from planning.geo.mesh import read_mesh
from planning.site.bundled import write_scene
from planning.site.file import read_site

GRID = ["--panel-grid", "-18,0,0 18,0,0 -18,0,42", "--rows", 14, "--columns", 20]
PLACE = ["--origin", "-33.8,151.2,5"]


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mesh")
    write_scene("office", folder)
    return folder / "office.ply"


@pytest.mark.slow
def test_ifc_becomes_a_site_and_text_tells_panels_place_and_next_command(reflight, shared_data, tmp_path):
    out = tmp_path / "wall.site.json"
    done = reflight("site", "import", shared_data / "bim" / "curtain_wall_small.ifc", "-o", out)
    assert done.status == 0
    assert f"{out}: site 'curtain_wall_small', 21 panels on 2 facades: A 12, B 9\n" in done.out
    assert "origin 40.42" in done.out
    assert "check it, or give --origin" in done.err
    assert done.err.splitlines()[-1] == f"next: app.py plan {out} -o {tmp_path / 'wall.plan.json'}"
    assert read_site(out).site.n_panels == 21


def test_citygml_becomes_a_site_and_json_tells_it(reflight, shared_data, tmp_path):
    out = tmp_path / "s.json"
    file = shared_data / "buildings" / "ingolstadt_lod3" / "4018302.xml"
    done = reflight("site", "import", file, "-o", out, "--json")
    assert (done.status, done.err) == (0, "")
    assert done.json["panels"] == 16
    assert done.json["facades"] == [{"id": "A", "panels": 9}, {"id": "B", "panels": 7}]
    assert done.json["sha256"] == read_site(out).sha256
    assert any("EPSG:32632" in note for note in done.json["notes"])


def test_cityjson_without_windows_says_what_to_add_and_takes_it(reflight, shared_data, tmp_path):
    file, out = shared_data / "buildings" / "cityjson" / "delft_1b.json", tmp_path / "s.json"
    assert "no building in this file has windows" in reflight("site", "import", file, "-o", out).error
    assert list(tmp_path.iterdir()) == []
    grid = "85040.6,447504.6,0 85009.8,447482.7,0 85040.6,447504.6,6"
    done = reflight("site", "import", file, "-o", out, "--panel-grid", grid, "--rows", 2, "--columns", 12)
    assert done.status == 0
    assert "24 panels on 1 facade: A 24" in done.out


def test_mesh_south_of_the_equator_with_panels_stated(reflight, mesh, tmp_path):
    out = tmp_path / "s.json"
    done = reflight("site", "import", mesh, "-o", out, *PLACE, *GRID, "--gap", 0.1, "--name", "Haus am Fluß", "--json")
    assert done.status == 0
    site = read_site(out).site
    assert (site.name, site.n_panels, site.origin.lat_deg) == ("Haus am Fluß", 280, -33.8)
    assert done.json["triangles"] == len(read_mesh(mesh).triangles)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (PLACE, "a mesh does not tell windows from walls"),
        (GRID, "--origin"),
        ([*PLACE, "--rows", 2], "--rows goes with --panel-grid"),
        ([*PLACE, *GRID, "--rows", 2, "--rows", 3], "--rows: expected it once, or once for each of 1"),
        ([*PLACE, *GRID[:2], "--rows", 0, "--columns", 5], "expected 1 to 100000 panels"),
        ([*PLACE, "--panel-grid", "-18,9,0 18,9,0 -18,9,42", "--rows", 2, "--columns", 2], "9.0 m from the building"),
        (["--origin", "95,0,0", *GRID], "--origin: lat_deg: expected -90 to 90, got 95"),
    ],
)
def test_meshes_lacking_something_are_refused_with_what_to_add(reflight, mesh, tmp_path, options, message):
    assert message in reflight("site", "import", mesh, "-o", tmp_path / "s.json", *options).error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "options", [["--origin", "1,2"], ["--origin", "a,b,c"], ["--origin", "nan,0,0"], ["--panel-grid", "1,2,3"]]
)
def test_points_that_are_none_are_wrong_usage(reflight, mesh, tmp_path, options):
    done = reflight("site", "import", mesh, "-o", tmp_path / "s.json", *options)
    assert done.status == 2
    assert "expected" in done.err.splitlines()[-1]


@pytest.mark.parametrize("suffix", [".ifc", ".gml", ".xml", ".json", ".obj", ".ply", ".glb", ".stl", ".dwg", ""])
@pytest.mark.parametrize("content", [b"", bytes(range(256))], ids=["empty", "binary"])
def test_files_that_are_no_building_are_refused(reflight, tmp_path, suffix, content):
    file = tmp_path / f"building{suffix}"
    file.write_bytes(content)
    assert str(file) in reflight("site", "import", file, "-o", tmp_path / "s.json", *PLACE).error
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("name", ["missing.ifc", "folder.ifc", "missing.json", "folder.ply"])
def test_missing_files_and_folders_are_refused(reflight, tmp_path, name):
    if name.startswith("folder"):
        (tmp_path / name).mkdir()
    assert name in reflight("site", "import", tmp_path / name, "-o", tmp_path / "s.json", *PLACE).error


@pytest.mark.parametrize(
    ("out", "message"), [("office.ply", "would replace"), ("no/s.json", "no folder"), (".", "folder")]
)
def test_an_import_never_replaces_what_it_reads(reflight, tmp_path, out, message):
    write_scene("office", tmp_path)
    before = (tmp_path / "office.ply").read_bytes()
    assert message in reflight("site", "import", tmp_path / "office.ply", "-o", tmp_path / out, *PLACE, *GRID).error
    assert (tmp_path / "office.ply").read_bytes() == before


def test_the_mesh_of_a_site_beside_its_source_gets_another_name(reflight, tmp_path):
    write_scene("office", tmp_path)
    before = (tmp_path / "office.ply").read_bytes()
    out = tmp_path / "office.json"
    assert reflight("site", "import", tmp_path / "office.ply", "-o", out, *PLACE, *GRID).status == 0
    assert (tmp_path / "office.ply").read_bytes() == before
    assert read_site(out).site.building_mesh != "office.ply"


# Terrain.


@pytest.fixture(scope="module")
def heights(tmp_path_factory):
    """The bundled office, and a slope around it as GeoTIFF with a tree on it."""
    from planning.site.bundled import ORIGIN
    from tests.planning.site.importing.height_files import transform_at, write_heights

    folder = tmp_path_factory.mktemp("terrain")
    write_scene("office", folder)
    place = {
        "origin": ORIGIN,
        "crs": "EPSG:32650",
        "transform": transform_at(ORIGIN, "EPSG:32650", 2.0),
        "size": (200, 200),
    }
    write_heights(folder / "dtm.tif", lambda x, y: 0.1 * (y + 45.0), **place)
    write_heights(
        folder / "dsm.tif", lambda x, y: 0.1 * (y + 45.0) + 9.0 * ((x - 40.0) ** 2 + (y + 30.0) ** 2 < 30.0), **place
    )
    return folder


def test_terrain_is_attached_and_told_and_taken_off_again(reflight, heights, tmp_path):
    site, out = heights / "office.site.json", tmp_path / "hill.site.json"
    asked = reflight("site", "terrain", site, heights / "dtm.tif", "-o", out)
    assert "does not say what its heights are above" in asked.error
    assert "--vertical" in asked.error
    assert list(tmp_path.iterdir()) == []
    told = ["--vertical", "ellipsoid", "--surface", heights / "dsm.tif", "--resolution", 2]
    done = reflight("site", "terrain", site, heights / "dtm.tif", *told, "-o", out)
    assert done.status == 0
    assert f"{out}: site 'office'\n" in done.out
    assert "terrain from -5.5 m to 12.5 m in the site's own frame, known on 100.0 % of the area" in done.out
    assert (
        "count from the terrain: the terrain below the airspace departs from its level ground by up to 10.1" in done.out
    )
    assert "obstacles from the surface: " in done.out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["hill.site.json", "hill.surface.ply", "office.ply"]
    model = read_site(out)
    assert [obstacle.id for obstacle in model.site.obstacles] == ["surface"]
    bare = reflight("site", "terrain", out, "--remove", "-o", tmp_path / "bare.site.json")
    assert bare.status == 0
    assert read_site(tmp_path / "bare.site.json").site == read_site(site).site


def test_terrain_in_json_tells_its_grid_sources_and_effect(reflight, heights, tmp_path):
    out = tmp_path / "a.json"
    told = ["--vertical", "ellipsoid", "--accuracy", 1.5, "--use", "off", "--json"]
    done = reflight("site", "terrain", heights / "office.site.json", heights / "dtm.tif", *told, "-o", out)
    assert (done.status, done.err) == (0, "")
    assert done.json["accuracy_m"] == 1.5
    assert done.json["unknown_share"] == 0.0
    assert done.json["error_m"] < 0.01
    assert done.json["step_m"] == pytest.approx(1.0, abs=0.01)
    assert done.json["sources"][0]["file"] == "dtm.tif"
    assert done.json["effect"]["on"] is False
    assert done.json["effect"]["decided_by"] == "user"
    assert done.json["sha256"] == read_site(out).sha256


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "expected files of heights, or --remove, and not both"),
        (["dtm.tif", "--remove"], "expected files of heights, or --remove, and not both"),
        (["dtm.tif", "--vertical", "ellipsoid", "--resolution", "0"], "step_m: expected more than 0 m, got 0"),
        (["dtm.tif", "--vertical", "tide"], "'tide' is nothing that heights are above"),
        (["nothing.tif"], "no such file"),
        (["office.ply"], "is no GeoTIFF"),
        (["."], "does not say what its heights are above"),
    ],
)
def test_terrain_that_cannot_be_attached_is_refused_in_one_line(reflight, heights, tmp_path, arguments, expected):
    named = [heights / each if each[0] != "-" and "." in each else each for each in arguments]
    done = reflight("site", "terrain", heights / "office.site.json", *named, "-o", tmp_path / "a.json")
    assert expected in done.error
    assert list(tmp_path.iterdir()) == []


def test_a_kml_of_places_and_a_drawing_are_refused_with_what_to_save_instead(reflight, tmp_path):
    kml, drawing = tmp_path / "a.kml", tmp_path / "a.dxf"
    kml.write_text('<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark/></Document></kml>')
    drawing.write_text("  0\nSECTION\n")
    error = reflight("site", "import", kml, "-o", tmp_path / "a.site.json").error
    assert "found a KML of places and outlines; it has no walls that could be measured: save the model itself" in error
    error = reflight("site", "import", drawing, "-o", tmp_path / "a.site.json").error
    assert "got '.dxf'; open it in the program that made it, and save it as one of these" in error
    error = reflight("import", kml, "-o", tmp_path / "a.plan.json").error
    assert "a KML of another program" in error
