"""Sites from files: opening, previews of imports with and without panels, and messages in the window's words."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from groundstation.services.messages import with_window_labels
from groundstation.services.project.document import Document
from groundstation.services.site.sources import (
    bundled_site,
    grid_in_file,
    holds_many_buildings,
    open_site,
    preview_import,
    shown_site,
    site_summary,
    with_new_site,
)
from planning.base.errors import InputError, OperationCancelled
from planning.geo.frames import Origin
from planning.geo.mesh import box_mesh
from planning.request import PlanRequest
from planning.site.bundled import SCENES, write_scene
from planning.site.file import site_sha256, write_site
from planning.site.importing.options import ImportOptions
from planning.site.importing.polygons import unit_normals
from planning.site.records import panel_corners
from tests.slow import slow

ROOT = Path(__file__).resolve().parents[3]
HERE = Origin(22.3372, 114.2636, 62.0)
SOUTH = ((-18.0, 0.0, 0.0), (18.0, 0.0, 0.0), (-18.0, 0.0, 42.0))


@pytest.fixture
def tower_obj(tmp_path):
    box = box_mesh(np.array([-18.0, 0.0, 0.0]), np.array([18.0, 20.0, 42.0]))
    path = tmp_path / "tower.obj"
    trimesh.Trimesh(box.vertices_enu_m, box.triangles, process=False).export(path)
    return path


@pytest.mark.parametrize("name", [slow(name) if name == "tower" else name for name in sorted(SCENES)])
def test_bundled_sites_open_with_the_checksum_of_their_file(tmp_path, name):
    assert bundled_site(name).sha256 == open_site(write_scene(name, tmp_path)).sha256


def test_unknown_bundled_site_is_refused_with_those_there_are():
    with pytest.raises(InputError, match=r"no bundled site 'x'.*office"):
        bundled_site("x")


def test_city_models_are_not_taken_for_site_files(shared_data):
    with pytest.raises(InputError, match="found a building model; import it first"):
        open_site(shared_data / "buildings" / "cityjson" / "delft_1b.json")


def test_mesh_without_panels_can_be_looked_at_and_a_grid_picked_on_it_makes_it_a_site(tower_obj, tmp_path):
    options = ImportOptions(origin=HERE, unit="m")
    looked_at = preview_import(tower_obj, options)
    assert (looked_at.model.site.facades, looked_at.problem) == ((), "")
    assert any("there are no windows, so the site has no panels yet" in note for note in looked_at.notes)
    assert len(looked_at.source.building.triangles) == 12
    grid = grid_in_file(looked_at, SOUTH, 14, 20, 0.1)
    np.testing.assert_allclose(grid.corners, SOUTH, atol=1e-5)
    done = preview_import(tower_obj, replace(options, panel_grids=(grid,)))
    assert done.problem == ""
    assert site_summary(done.model).facades[0].n_panels == 280
    assert site_summary(done.model).size_m == pytest.approx((36.0, 20.0, 42.0), abs=1e-3)
    assert done.model.sha256 == write_site(tmp_path / "site.json", done.model.site)


@pytest.mark.slow
def test_building_that_is_no_site_yet_can_be_shown_unless_its_unit_is_wrong(tower_obj):
    looked_at = preview_import(tower_obj, ImportOptions(origin=HERE, floor_m=50.0, ceiling_m=40.0))
    assert "leave no airspace" in looked_at.problem
    assert looked_at.model is None
    shown = shown_site(looked_at)
    assert len(shown.building.triangles) == 12
    assert shown.site.facades == ()
    mesh = trimesh.load_mesh(tower_obj)
    mesh.apply_scale(1000.0)
    mesh.export(tower_obj)
    too_large = preview_import(tower_obj, ImportOptions(origin=HERE))
    assert "36000 x 20000 x 42000 m" in too_large.problem
    assert shown_site(too_large) is None


def test_grid_picked_on_a_map_lands_where_it_was_picked(tower_obj, tmp_path):
    box = box_mesh(np.array([678_052.0, 5_403_685.0, 415.0]), np.array([678_088.0, 5_403_705.0, 457.0]))
    path = tmp_path / "utm.obj"
    trimesh.Trimesh(box.vertices_enu_m, box.triangles, process=False).export(path)
    options = ImportOptions(crs="EPSG:25832")
    looked_at = preview_import(path, options)
    low, high = looked_at.source.building.vertices_enu_m[[0, 4]]
    rectangle = tuple(
        tuple(p) for p in (low.tolist(), high.tolist(), (looked_at.source.building.vertices_enu_m[1]).tolist())
    )
    done = preview_import(path, replace(options, panel_grids=(grid_in_file(looked_at, rectangle, 2, 3, 0.0),)))
    corners = panel_corners(done.model.site)
    np.testing.assert_allclose(corners[0, 0], low, atol=2e-4)
    assert unit_normals(corners)[0] @ np.array([0.0, -1.0, 0.0]) > 0.99


@pytest.mark.slow
def test_city_model_without_windows_lists_its_buildings_and_a_grid_chooses_its_own(shared_data):
    path = shared_data / "buildings" / "cityjson" / "zurich_subset_lod2.json"
    assert holds_many_buildings(path)
    looked_at = preview_import(path, ImportOptions())
    assert len(looked_at.source.choices) == 49
    assert looked_at.model.site.facades == ()
    wanted = max(looked_at.source.choices, key=lambda choice: choice.size_m[2])
    one = preview_import(path, ImportOptions(building=wanted.id))
    height_m = np.ptp(one.source.building.vertices_enu_m[:, 2])
    assert height_m == pytest.approx(wanted.size_m[2], abs=0.05)
    corners = one.source.building.corners_enu_m
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wall = corners[np.argmax(np.linalg.norm(normals[:, :2], axis=1))]
    normal = normals[np.argmax(np.linalg.norm(normals[:, :2], axis=1))]
    across = np.array([-normal[1], normal[0], 0.0]) / np.linalg.norm(normal[:2])
    middle = wall.mean(axis=0)
    rectangle = tuple(
        tuple(p.tolist())
        for p in (middle - 0.5 * across, middle + 0.5 * across, middle - 0.5 * across + np.array([0.0, 0.0, 1.0]))
    )
    grid = grid_in_file(one, rectangle, 1, 1, 0.0)
    for building in (wanted.id, None):
        done = preview_import(path, ImportOptions(building=building, panel_grids=(grid,)))
        assert done.problem == "", done.problem
        np.testing.assert_allclose(panel_corners(done.model.site)[0, 0], rectangle[0], atol=2e-3)


def test_file_without_a_place_says_which_field_to_fill_in(tower_obj):
    with pytest.raises(InputError) as caught:
        preview_import(tower_obj, ImportOptions())
    said = with_window_labels(str(caught.value), {"--origin": "Zero point", "--crs": "Coordinate system"})
    assert "give “Zero point” (of its zero point) or “Coordinate system” (of its coordinates)" in said
    assert "--" not in said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("check the corners, --units and --up, or", "check the corners, “units” and “up”, or"),
        ("--panel-grid '0,0,0 36,0,0 0,0,42' --rows 14 --columns 20 (lower", "“panel-grid” (lower"),
        ("--panel-grid 'E,N,U E,N,U E,N,U' (lower", "“panel-grid” (lower"),
        ("--gap 0.1: a gap of", "“gap”: a gap of"),
        ("(--airspace-margin, --floor, --ceiling)", "(“airspace-margin”, “floor”, “ceiling”)"),
        ("name a place with --home E,N,U", "name a place with “home”"),
        ("imported with --building ID", "imported with “building”"),
        ("of its own (see --height-reference); EGM96", "of its own (see “height-reference”); EGM96"),
        ("--rows 0 --columns 5: expected", "“rows” “columns”: expected"),
        ("name it with --crs EPSG:CODE", "name it with “crs”"),
        ("--crs, and so on", "“crs”, and so on"),
        ("no option -- here", "no option -- here"),
    ],
)
def test_options_become_labels_and_take_their_placeholders_along(text, said):
    options = set(re.findall(r"--[a-z-]+[a-z]", text))
    assert with_window_labels(text, {option: option[2:] for option in options}) == said


@pytest.mark.parametrize("n_facades", [0, 2])
def test_building_without_panels_is_summed_up(n_facades):
    model = SCENES["court"]()
    emptied = tuple(replace(facade, panels=()) for facade in model.site.facades[:n_facades])
    summary = site_summary(replace(model, site=replace(model.site, facades=emptied)))
    assert (summary.n_panels, summary.area_m2, len(summary.facades)) == (0, 0.0, n_facades)
    assert summary.size_m == pytest.approx((65.0, 55.0, 23.0))


def test_real_building_with_windows_is_summed_up(shared_data):
    preview = preview_import(shared_data / "buildings" / "ingolstadt_lod3" / "4018270.xml", ImportOptions())
    summary = site_summary(preview.model)
    assert summary.n_panels == 57
    assert [facade.n_panels for facade in summary.facades] == [len(f.panels) for f in preview.model.site.facades]
    assert 20.0 < summary.area_m2 < 300.0
    assert preview.model.sha256 == site_sha256(preview.model.site)
    assert preview.notes


def test_cancelled_import_stops(tower_obj):
    class Cancelled:
        def report(self, stage, done, total):
            raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        preview_import(tower_obj, ImportOptions(origin=HERE), Cancelled())


def test_new_site_keeps_what_was_wished_and_drops_the_plans_of_the_old_one():
    request = PlanRequest(n_views=7)
    document = with_new_site(Document(site=SCENES["roof"](), request=request), SCENES["office"]())
    assert document.request == request
    assert document.plans == ()
    assert document.site.site.name == "office"
