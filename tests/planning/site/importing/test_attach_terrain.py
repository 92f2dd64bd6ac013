"""Terrain attached to sites: home on it, trees and neighbours as obstacles, what is not known never clear."""

from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.geo.solids import Solids
from planning.site.bundled import ORIGIN
from planning.site.free_space import free_space
from planning.site.importing.attach_terrain import TerrainRequest, attach_terrain, unknown_accuracy_m, without_terrain
from planning.site.importing.elevation import HeightOptions
from planning.site.records import RallyPoint
from planning.site.terrain import surfaces
from tests.planning.plan_cases import kiosk
from tests.planning.site.importing.height_files import transform_at, write_heights

UTM50 = "EPSG:32650"


def ground(x, y):
    return 0.1 * (y + 30.0) - 1.0


def surface(x, y):
    """The kiosk's roof, a tree that the site knows nothing of, and one that it knows."""
    z = ground(x, y)
    z = np.where((np.abs(x) < 6.0) & (y > 0.0) & (y < 8.0), 9.0, z)
    z = np.where((x - 19.5) ** 2 + (y + 12.5) ** 2 < 2.0, 11.0, z)
    return np.where((x - 20.0) ** 2 + (y - 25.0) ** 2 < 16.0, ground(x, y) + 12.0, z)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("heights")
    place = {"origin": ORIGIN, "crs": UTM50, "transform": transform_at(ORIGIN, UTM50), "size": (200, 200)}
    write_heights(folder / "dtm.tif", ground, **place)
    write_heights(folder / "dsm.tif", surface, **place)
    holed = lambda x, y: np.where((np.abs(x) < 6.0) & (y > 0.0) & (y < 8.0), np.nan, ground(x, y))  # noqa: E731
    write_heights(folder / "below.tif", holed, **place)
    half = lambda x, y: np.where(x > 10.0, np.nan, surface(x, y))  # noqa: E731
    write_heights(folder / "half.tif", half, **place)
    return folder


def attached(files, model=None, name="dtm.tif", **request):
    ellipsoid = HeightOptions(vertical="ellipsoid")
    wanted = {"ground": (files / name,), "options": ellipsoid, "accuracy_m": 0.0, **request}
    return attach_terrain(kiosk() if model is None else model, TerrainRequest(**wanted), "kiosk")


def test_home_and_rally_points_on_level_ground_are_put_on_the_terrain(files):
    model = kiosk(rally_points=(RallyPoint("a", (10.0, -30.0, 0.0)), RallyPoint("roof", (0.0, 4.0, 9.0))))
    found = attached(files, model)
    site = found.model.site
    assert site.home_enu_m == pytest.approx((0.0, -30.0, -1.0), abs=2e-3)
    assert [point.position_enu_m[2] for point in site.rally_points] == pytest.approx([-1.0, 9.0], abs=2e-3)
    assert found.home_moved_m == pytest.approx(-1.0, abs=2e-3)
    assert "home was put on the terrain, -1.00 m from where it was" in found.notes
    again = attach_terrain(
        found.model, TerrainRequest((files / "dtm.tif",), options=HeightOptions(vertical="ellipsoid")), "k"
    )
    assert again.model.site.home_enu_m == pytest.approx(site.home_enu_m, abs=1e-3)


def test_the_terrain_can_be_brought_to_home(files):
    found = attached(files, shift_m="home")
    assert found.model.site.home_enu_m == (0.0, -30.0, 0.0)
    there = surfaces(found.model.site.terrain).ground.heights_m(np.array([[0.0, -30.0], [0.0, 10.0]]))
    assert there == pytest.approx([0.0, 4.0], abs=2e-3)
    assert any("shifted by +1.00 m" in note for note in found.notes)


def test_what_the_surface_shows_above_the_ground_is_an_obstacle_unless_the_site_has_it(files):
    found = attached(files, surface=(files / "dsm.tif",))
    names = [obstacle.id for obstacle in found.model.site.obstacles]
    assert names == ["tree", "surface"]
    assert found.n_unknown_boxes == 0
    solids = Solids.of(found.model.obstacles[1].corners_enu_m)
    height = ground(20.0, 25.0) + 12.0
    inside = solids.clearance_m(np.array([[20.0, 25.0, z] for z in (ground(20.0, 25.0), height - 0.6, height + 0.6)]))
    assert (inside < 0.0).tolist() == [True, True, False]
    low, high = solids.bvh.corners.min(axis=(0, 1)), solids.bvh.corners.max(axis=(0, 1))
    assert low[:2] == pytest.approx([16.0, 21.0], abs=1.6)
    assert high[:2] == pytest.approx([24.0, 29.0], abs=1.6)
    assert found.model.obstacles[1] is found.meshes["kiosk.surface.ply"]
    free = without_terrain(found.model)
    assert [obstacle.id for obstacle in free.site.obstacles] == ["tree"]
    assert free.site.terrain is None


def test_no_place_of_the_surface_is_flown_nearer_than_the_distance(files):
    found = attached(files, surface=(files / "dsm.tif",))
    space = free_space(found.model, 5.0)
    points = np.random.default_rng(0).uniform(space.low_enu_m, space.high_enu_m, (3000, 3))
    points = points[space.is_allowed(points)]
    tree = np.array(
        [[20.0 + r * np.cos(t), 25.0 + r * np.sin(t)] for r in (0.0, 2.0, 3.9) for t in np.linspace(0, 6.28, 16)]
    )
    for z in np.linspace(5.0, ground(20.0, 25.0) + 11.6, 8):
        crown = np.c_[tree, np.full(len(tree), z)]
        assert np.linalg.norm(points[:, None] - crown, axis=2).min() >= 5.0


def test_where_the_surface_is_not_known_nothing_is_clear(files):
    found = attached(files, surface=(files / "half.tif",))
    assert [obstacle.id for obstacle in found.model.site.obstacles] == ["tree", "surface-unknown"]
    space = free_space(found.model, 5.0)
    points = np.random.default_rng(0).uniform(space.low_enu_m, space.high_enu_m, (4000, 3))
    allowed = points[space.is_allowed(points)]
    assert len(allowed) > 100
    assert allowed[:, 0].max() < 10.5 - 5.0
    assert any(note.startswith("the surface is not known on ") for note in found.notes)


def test_ground_below_the_building_is_taken_from_beside_it(files):
    found = attached(files, name="below.tif")
    assert found.ground.unknown_share == 0.0
    assert "below the building the files have no heights; those beside it were taken" in found.notes
    there = surfaces(found.model.site.terrain).ground.heights_m(np.array([[0.0, 4.0]]))[0]
    assert ground(0.0, 0.0) - 0.1 <= there <= ground(0.0, 8.0) + 0.1
    # Without a building there is nothing that a hole could be below.
    bare = replace(kiosk(), building=kiosk().building.__class__(np.zeros((0, 3)), np.zeros((0, 3), np.int64)))
    assert attached(files, model=bare, name="below.tif").ground.unknown_share > 0.0


def test_where_only_the_surface_is_known_it_counts_as_ground(files, tmp_path):
    place = {"origin": ORIGIN, "crs": UTM50, "transform": transform_at(ORIGIN, UTM50), "size": (200, 200)}
    write_heights(tmp_path / "west.tif", lambda x, y: np.where(x > 12.0, np.nan, ground(x, y)), **place)
    found = attached(tmp_path, name="west.tif", surface=(files / "dsm.tif",))
    assert found.ground.unknown_share == 0.0
    upper = surfaces(found.model.site.terrain).upper.heights_m(np.array([[20.0, 25.0]]))[0]
    assert upper >= ground(20.0, 25.0) + 12.0


@pytest.mark.parametrize("field", ["step_m", "taller_than_m"])
def test_lengths_that_are_none_are_refused(files, field):
    with pytest.raises(ValueError, match="expected more than 0 m"):
        TerrainRequest((files / "dtm.tif",), **{field: 0.0})


def test_a_far_site_is_told_which_tile_it_needs(files):
    far = kiosk(origin=replace(ORIGIN, lat_deg=-33.9, lon_deg=151.2))
    with pytest.raises(InputError, match=r"dtm\.tif: has no heights below the airspace of the site.*S34E151"):
        attached(files, far)


HIGH = replace(ORIGIN, ellipsoid_height_m=0.0)


def filled(folder, surface, **profile):
    """A file of heights that says of no value that it means none, and a kiosk whose zero lies at 0 m."""
    place = {"origin": HIGH, "crs": UTM50, "transform": transform_at(HIGH, UTM50), "size": (200, 200)}
    write_heights(folder / "filled.tif", surface, **place, nodata=None, **profile)
    return kiosk(origin=HIGH)


def zeros_where(hole, height):
    """A height above the ellipsoid, and exactly zero where `hole` says so: on the raster itself."""

    def rewritten(folder):
        import rasterio

        with rasterio.open(folder / "filled.tif", "r+") as file:
            z = file.read(1)
            rows, columns = np.indices(z.shape)
            z[:] = height(columns - 100.0, 100.0 - rows)
            z[hole(columns - 100.0, 100.0 - rows)] = 0.0
            file.write(z, 1)

    return rewritten


def attached_filled(folder, hole, height, **profile):
    model = filled(folder, lambda x, y: 0.0 * x + 1.0, **profile)
    zeros_where(hole, height)(folder)
    return attached(folder, model, "filled.tif")


def test_a_hole_of_zeros_in_a_hill_is_not_known_and_said(tmp_path):
    found = attached_filled(tmp_path, lambda x, y: np.hypot(x - 20.0, y - 20.0) < 8.0, lambda x, y: 66.9 + 0.01 * x)
    assert any("its zeros count as not known" in note and "filled.tif" in note for note in found.notes)
    there = surfaces(found.model.site.terrain).ground.heights_m(np.array([[20.0, 20.0], [-20.0, -20.0]]))
    assert np.isnan(there).tolist() == [True, False]


def test_a_file_of_zeros_alone_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"all its heights below the site are exactly 0 m.*nodata"):
        attached_filled(tmp_path, lambda x, y: x < 1e9, lambda x, y: 0.0 * x)


def test_a_coast_stays_sea_at_zero_and_so_does_a_file_that_says_which_value_means_none(tmp_path):
    rising = lambda x, y: np.maximum(0.2 * (y + 10.0), 0.0)  # noqa: E731
    coast = attached_filled(tmp_path, lambda x, y: y < -10.0, rising)
    assert not np.isnan(surfaces(coast.model.site.terrain).ground.z_m).any()
    model = filled(tmp_path, lambda x, y: 0.0 * x)
    zeros_where(lambda x, y: x < 1e9, rising)(tmp_path)
    with pytest.raises(InputError, match="exactly 0 m"):
        attached(tmp_path, model, "filled.tif")
    import rasterio

    with rasterio.open(tmp_path / "filled.tif", "r+") as file:
        file.nodata = -9999.0
    assert surfaces(attached(tmp_path, model, "filled.tif").model.site.terrain).ground.z_m.max() < 1.0


def test_files_of_unknown_origin_are_not_taken_for_perfect(files):
    found = attached(files, accuracy_m=None)
    assert found.model.site.terrain.accuracy_m == 0.6
    assert any("do not say how good their heights are: 0.6 m" in note for note in found.notes)
    assert unknown_accuracy_m(30.0) == 9.0
    assert attached(files, accuracy_m=0.2).model.site.terrain.accuracy_m == 0.2
