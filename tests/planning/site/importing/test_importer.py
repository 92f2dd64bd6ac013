"""The whole import: defaults, wishes, files written, and the command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from groundstation.cli.main import main
from planning.base.errors import InputError, OperationCancelled
from planning.base.progress import QUIET
from planning.geo.frames import Origin
from planning.geo.mesh import box_mesh, empty_mesh, join, read_mesh
from planning.geo.solids import Solids
from planning.site.file import read_site
from planning.site.free_space import free_space
from planning.site.importing.importer import ImportedSite, assemble, import_site, write_imported_site
from planning.site.importing.options import ImportOptions, PanelGrid
from planning.site.importing.placement import LocalFrame, Placement
from planning.site.importing.source import SourceModel, SourceWindow
from planning.site.records import panel_corners

HERE = Origin(48.7, 11.4, 450.0)
HOUSE = box_mesh(np.array([-10.0, -6.0, 0.0]), np.array([10.0, 6.0, 12.0]))
WINDOW = np.array([[-1.0, -6.01, 4.0], [1.0, -6.01, 4.0], [1.0, -6.01, 6.0], [-1.0, -6.01, 6.0]])


def source(*windows: np.ndarray, **fields: object) -> SourceModel:
    """House with windows, as a reader hands it over."""
    content = {
        "name": "Haus",
        "windows": tuple(SourceWindow(f"w{k}", ring) for k, ring in enumerate(windows or (WINDOW,))),
        "building": HOUSE,
        "neighbours": empty_mesh(),
        "placement": Placement(HERE, LocalFrame(HERE), 0.0),
    }
    return SourceModel(**(content | fields))  # type: ignore[arg-type]


def assembled(model: SourceModel | None = None, options: ImportOptions | None = None) -> ImportedSite:
    return assemble(Path("house.ifc"), model or source(), options or ImportOptions())


# --- defaults and wishes ---


def test_defaults_are_a_flyable_site_and_every_one_is_noted() -> None:
    site = assembled()
    airspace = site.model.site.airspace
    assert airspace.min_enu_m == (-50.0, -46.01, 2.0)
    assert airspace.max_enu_m == (50.0, 46.0, 42.0)
    assert airspace.ground_z_m == 0.0
    assert site.model.site.home_enu_m == (0.0, pytest.approx(-23.01), 0.0)
    space = free_space(site.model, 10.0)
    assert space.is_allowed(np.array([[0.0, -30.0, 10.0]])).all()
    text = " ".join(site.notes)
    for option in ("--airspace-margin", "--floor", "--ceiling", "--home"):
        assert option in text


def test_building_without_panels_is_a_flyable_site_where_that_is_wanted() -> None:
    model = source(windows=())
    with pytest.raises(InputError, match=r"there are no windows; .*--panel-grid.*--without-panels"):
        assembled(model)
    site = assembled(model, ImportOptions(panels_required=False))
    assert site.model.site.facades == ()
    assert any("there are no windows, so the site has no panels yet" in note for note in site.notes)
    assert any("on the ground beside the building" in note for note in site.notes)
    home = np.array(site.model.site.home_enu_m)
    assert Solids.of(HOUSE.corners_enu_m).clearance_m(home[None])[0] >= 15.0
    assert home[1] < HOUSE.vertices_enu_m[:, 1].min()
    assert free_space(site.model, 10.0).is_allowed(np.array([[0.0, -30.0, 10.0]])).all()


def test_home_keeps_15_m_from_every_wall_seen_from_above() -> None:
    for windows in ((WINDOW,), (WINDOW[::-1] * np.array([1.0, -1.0, 1.0]),)):
        site = assembled(source(*windows)).model
        column = np.array([site.site.home_enu_m] * 40) + np.linspace(0.0, 60.0, 40)[:, None] * np.array([0.0, 0.0, 1.0])
        assert Solids.of(site.building.corners_enu_m).clearance_m(column).min() >= 15.0
        assert np.sign(site.site.home_enu_m[1]) == np.sign(windows[0][0, 1])  # in front of the facade


def test_home_moves_aside_for_a_neighbour_and_out_of_a_court() -> None:
    opposite = box_mesh(np.array([-8.0, -40.0, 0.0]), np.array([8.0, -20.0, 9.0]))
    home = np.array(assembled(source(neighbours=opposite)).model.site.home_enu_m)
    assert Solids.of(join([HOUSE, opposite]).corners_enu_m).clearance_m(home[None])[0] >= 15.0
    wings = [box_mesh(np.array([x, -40.0, 0.0]), np.array([x + 5.0, -6.0, 12.0])) for x in (-10.0, 5.0)]
    home = np.array(assembled(source(building=join([HOUSE, *wings]))).model.site.home_enu_m)
    assert home[1] <= -55.0


def test_a_site_walled_in_on_all_sides_still_has_a_home_and_says_that_it_is_tight() -> None:
    ring = [
        box_mesh(np.array(low), np.array(high))
        for low, high in [
            ((-60.0, -60.0, 0.0), (60.0, -18.0, 9.0)),
            ((-60.0, 18.0, 0.0), (60.0, 60.0, 9.0)),
            ((-60.0, -18.0, 0.0), (-22.0, 18.0, 9.0)),
            ((22.0, -18.0, 0.0), (60.0, 18.0, 9.0)),
        ]
    ]
    site = assembled(source(neighbours=join(ring)))
    assert any("home is tight" in note for note in site.notes)
    home = np.array(site.model.site.home_enu_m)
    assert 2.0 < Solids.of(join([HOUSE, *ring]).corners_enu_m).clearance_m(home[None])[0] < 15.0


def test_home_of_a_roof_is_beside_the_building() -> None:
    skylight = np.array([[-1.0, -1.0, 12.01], [1.0, -1.0, 12.01], [1.0, 1.0, 12.01], [-1.0, 1.0, 12.01]])
    site = assembled(source(skylight)).model
    assert Solids.of(site.building.corners_enu_m).clearance_m(np.array([site.site.home_enu_m]))[0] >= 15.0


def test_wishes_are_kept() -> None:
    options = ImportOptions(
        name="Mein Haus", home_enu_m=(30.0, -30.0, 0.5), airspace_margin_m=60.0, floor_m=4.0, ceiling_m=55.0
    )
    site = assembled(options=options).model.site
    assert site.name == "Mein Haus"
    assert site.home_enu_m == (30.0, -30.0, 0.5)
    assert site.airspace.min_enu_m == (-70.0, -66.01, 4.0)
    assert site.airspace.max_enu_m[2] == 55.0


def test_wishes_that_leave_no_airspace_are_refused() -> None:
    with pytest.raises(InputError, match=r"--floor and --ceiling leave no airspace.*z runs from 2.0 to 1.0"):
        assembled(options=ImportOptions(ceiling_m=1.0))


@pytest.mark.parametrize("margin_m", [-3.0, 0.5])
def test_airspace_too_tight_for_a_home_is_refused(margin_m: float) -> None:
    with pytest.raises(InputError, match="no place for home inside the airspace"):
        assembled(options=ImportOptions(airspace_margin_m=margin_m))


def test_home_far_away_is_refused() -> None:
    with pytest.raises(InputError, match=r"--home: expected local ENU metres"):
        assembled(options=ImportOptions(home_enu_m=(678_052.0, 0.0, 0.0)))


def test_windows_that_all_lie_indoors_are_an_error() -> None:
    inside = WINDOW + np.array([0.0, 5.0, 0.0])
    with pytest.raises(InputError, match=r"no window of 1 is a pane that faces the open; .*--panel-grid"):
        assembled(source(inside))


def test_slivers_and_indoor_windows_are_counted_and_the_rest_kept() -> None:
    sliver = WINDOW * np.array([0.001, 1.0, 1.0])
    inside = WINDOW + np.array([0.0, 5.0, 0.0])
    site = assembled(source(sliver, WINDOW, inside))
    assert [panel.source_id for panel in site.model.site.panels] == ["w1"]
    assert any("windows left out as slivers or without area: 1" in note for note in site.notes)
    assert any("windows left out as indoor ones, which see nothing of the open: 1" in note for note in site.notes)


def test_panels_are_named_by_facade_and_number_and_keep_their_source() -> None:
    east = np.array([[10.01, -1.0, 4.0], [10.01, 1.0, 4.0], [10.01, 1.0, 6.0], [10.01, -1.0, 6.0]])
    upper, right = WINDOW + np.array([0.0, 0.0, 4.0]), WINDOW + np.array([4.0, 0.0, 0.0])
    site = assembled(source(upper, east, right, WINDOW)).model.site
    named = {panel.id: panel.source_id for panel in site.panels}
    assert named == {"A-0000": "w3", "A-0001": "w2", "A-0002": "w0", "B-0000": "w1"}


def test_progress_is_reported_and_cancelling_stops() -> None:
    stages: list[str] = []

    class Callbacks:
        def report(self, stage: str, done: float, total: float) -> None:
            stages.append(stage)
            if stage == "grouping facades":
                raise OperationCancelled

    with pytest.raises(OperationCancelled):
        assemble(Path("house.ifc"), source(), ImportOptions(), Callbacks())
    assert stages == ["fitting panels", "looking outdoors", "grouping facades"]


# --- files ---


def test_what_is_written_reads_back_as_it_was(tmp_path: Path) -> None:
    neighbour = box_mesh(np.array([30.0, 20.0, 0.0]), np.array([40.0, 30.0, 9.0]))
    site = assembled(source(neighbours=neighbour))
    path = tmp_path / "haus.json"
    written = write_imported_site(path, site, tmp_path / "haus.ifc")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["haus-neighbours.ply", "haus.json", "haus.ply"]
    model = read_site(path)
    assert model.site == written.site
    assert model.sha256 == written.sha256
    assert model.site.building_mesh == "haus.ply"
    np.testing.assert_array_equal(panel_corners(model.site), panel_corners(site.model.site))
    np.testing.assert_allclose(model.building.corners_enu_m, HOUSE.corners_enu_m, atol=1e-5)
    np.testing.assert_allclose(model.obstacles[0].corners_enu_m, neighbour.corners_enu_m, atol=1e-5)


def test_the_imported_mesh_is_never_written_over(tmp_path: Path) -> None:
    original = tmp_path / "tower.ply"
    trimesh.Trimesh(HOUSE.vertices_enu_m, HOUSE.triangles, process=False).export(original)
    before = original.read_bytes()
    grid = PanelGrid(((-10.0, -6.0, 0.0), (10.0, -6.0, 0.0), (-10.0, -6.0, 12.0)), 3, 4)
    site = import_site(original, ImportOptions(origin=HERE, panel_grids=(grid,)), QUIET)
    written = write_imported_site(tmp_path / "tower.json", site, original)
    assert original.read_bytes() == before
    assert written.site.building_mesh == "tower-building.ply"
    assert len(read_mesh(tmp_path / "tower-building.ply").triangles) == 12


def test_a_folder_that_is_not_there_leaves_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_imported_site(tmp_path / "nowhere" / "haus.json", assembled(), tmp_path / "haus.ifc")
    assert list(tmp_path.iterdir()) == []


def test_the_site_is_never_written_over_the_imported_file(tmp_path: Path) -> None:
    path = tmp_path / "city.json"
    path.write_text("{}")
    with pytest.raises(InputError, match="written over the file it is imported from"):
        write_imported_site(path, assembled(), path)
    assert path.read_text() == "{}"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("name", "said"), [("a.dwg", "expected a file ending in .ifc"), ("a.ifc", "there is no such file")]
)
def test_files_that_are_not_there_or_of_another_kind_are_refused(tmp_path: Path, name: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        import_site(tmp_path / name, ImportOptions())


# --- the command ---


def no_window() -> int:
    raise AssertionError("the window was opened")


@pytest.fixture
def tower(tmp_path: Path) -> Path:
    path = tmp_path / "tower.obj"
    trimesh.Trimesh(HOUSE.vertices_enu_m, HOUSE.triangles, process=False).export(path)
    return path


GRID = ["--panel-grid", "-10,-6,0 10,-6,0 -10,-6,12", "--rows", "3", "--columns", "4"]


def test_a_file_of_one_building_has_none_to_choose(tmp_path: Path) -> None:
    path = tmp_path / "block.obj"
    trimesh.creation.box((4.0, 4.0, 4.0)).export(path)
    with pytest.raises(InputError, match="has no building 'TOWER' to choose"):
        import_site(path, ImportOptions(building="TOWER"))


def test_json_is_one_object_and_nothing_else(tower: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tower.with_name("site.json")
    arguments = ["site", "import", str(tower), "-o", str(out), "--origin", "-33.8,151.2,-20", *GRID, "--json"]
    assert main(arguments, no_window) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["site"] == str(out)
    assert content["panels"] == 12
    assert content["facades"] == [{"id": "A", "panels": 12}]
    assert content["notes"]
    assert content["origin"] == {"lat_deg": -33.8, "lon_deg": 151.2, "ellipsoid_height_m": -20.0}
    assert read_site(out).sha256 == content["sha256"]


def test_text_says_what_was_made_and_notes_go_to_the_error_stream(
    tower: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["site", "import", str(tower), "-o", str(tower.with_name("s.json")), "--origin=1,2,3", *GRID]
    assert main(arguments, no_window) == 0
    streams = capsys.readouterr()
    assert "12 panels on 1 facade: A 12" in streams.out
    assert "note: home:" in streams.err


def test_rows_and_columns_are_shared_or_one_for_each_grid(tower: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tower.with_name("s.json"))
    east = ["--panel-grid", "10,-6,0 10,6,0 10,-6,12", "--rows", "2", "--columns", "2"]
    base = ["site", "import", str(tower), "-o", out, "--origin", "1,2,3", "--json"]
    assert main([*base, *GRID, *east], no_window) == 0
    assert json.loads(capsys.readouterr().out)["facades"] == [{"id": "A", "panels": 12}, {"id": "B", "panels": 4}]
    assert main([*base, *GRID, *east[:2]], no_window) == 0
    assert json.loads(capsys.readouterr().out)["facades"] == [{"id": "A", "panels": 12}, {"id": "B", "panels": 12}]
    assert main([*base, *GRID, *GRID, *east], no_window) == 0
    assert main([*base, *GRID, *east[:2], *east[:2], "--rows", "5"], no_window) == 1


@pytest.mark.parametrize(
    ("extra", "status", "said"),
    [
        ([], 1, "a mesh does not tell windows from walls"),
        (["--rows", "3"], 1, "--rows goes with --panel-grid"),
        (GRID[:2], 1, "--rows: expected it once"),
        ([*GRID, "--origin", "95,0,0"], 1, "--origin: lat_deg: expected -90 to 90, got 95"),
        ([*GRID, "--crs", "EPSG:1"], 1, "not a coordinate reference system"),
        ([*GRID[:1], "1,2 3", *GRID[2:]], 2, "expected three points"),
        ([*GRID[:1], "1,2,3 4,5,6 7,8,x", *GRID[2:]], 2, "expected a number, got 'x'"),
        ([*GRID[:1], "1,2,3 4,5,6 7,8", *GRID[2:]], 2, "expected three numbers"),
        ([*GRID, "--home", "nan,0,0"], 2, "expected a number, got 'nan'"),
        ([*GRID, "--ceiling", "inf"], 2, "expected a number, got 'inf'"),
        ([*GRID, "-o", "nowhere/site.json"], 1, "there is no folder 'nowhere'"),
        (["--up", "x"], 2, "invalid choice"),
    ],
)
def test_wrong_wishes_end_with_one_clear_line_and_no_file(
    tower: Path, capsys: pytest.CaptureFixture[str], extra: list[str], status: int, said: str
) -> None:
    out = tower.with_name("s.json")
    origin = [] if "--origin" in extra or "--crs" in extra else ["--origin", "1,2,3"]
    assert main(["site", "import", str(tower), "-o", str(out), *origin, *extra], no_window) == status
    streams = capsys.readouterr()
    assert said in streams.err
    assert streams.out == ""
    assert status == 2 or streams.err.count("\n") == 1
    assert sorted(p.name for p in tower.parent.iterdir()) == ["tower.obj"]


def test_the_command_is_described_without_importing_anything_heavy() -> None:
    import subprocess
    import sys

    code = "import sys, groundstation.cli.commands.site; print(*sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(result.stdout.split())
    assert not loaded & {"numpy", "scipy", "pyproj", "shapely", "open3d", "ifcopenshell", "trimesh", "numba"}
