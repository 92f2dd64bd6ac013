"""Files of heights in any system, with holes, at borders of tiles, and damaged ones."""

import json
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
import rasterio
from affine import Affine
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.geo.height_field import HeightField
from planning.site.importing.elevation import HeightOptions, height_files, open_heights, tile_names
from planning.site.importing.terrain import Area, sample_heights
from tests.planning.site.importing.height_files import ORIGIN, UTM32, transform_at, write_heights, write_hgt

AREA = Area(np.array([-60.0, -60.0]), np.array([60.0, 60.0]), 0.0)
ELLIPSOID = HeightOptions(vertical="ellipsoid")
FLOAT32_M = 1e-4
"""Half a step of float32 at 540 m, 0.03 mm, and what systems of Europe leave to each other."""


def plane(x, y):
    return 3.0 + 0.2 * x - 0.1 * y


def off(sampled, surface=plane):
    xy = sampled.field.nodes_xy_m()
    return np.abs(sampled.field.z_m - surface(xy[..., 0], xy[..., 1]))


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    path = tmp_path_factory.mktemp("heights") / "tilted.tif"
    write_heights(path, plane)
    return path


@pytest.mark.long
@pytest.mark.parametrize(
    ("crs", "turn_deg", "pixel", "tolerance_m"),
    [
        (UTM32, 0.0, 1.0, FLOAT32_M),
        (UTM32, 30.0, 1.0, FLOAT32_M),
        (UTM32, -100.0, 0.8, FLOAT32_M),
        ("EPSG:3035", 0.0, 1.0, FLOAT32_M),
        ("EPSG:4326", 0.0, 1e-5, FLOAT32_M),
        ("EPSG:3857", 0.0, 1.4, FLOAT32_M),
        ("EPSG:32631", 0.0, 1.0, FLOAT32_M),
    ],
)
def test_a_tilted_plane_comes_back_from_any_system(tmp_path, crs, turn_deg, pixel, tolerance_m):
    path = tmp_path / "a.tif"
    write_heights(path, plane, crs=crs, transform=transform_at(crs=crs, pixel=pixel, turn_deg=turn_deg))
    found = sample_heights(ORIGIN, AREA, [path], ELLIPSOID)
    assert found.unknown_share == 0.0
    assert off(found).max() < tolerance_m
    assert found.error_m < 2e-4 + 4.0 * tolerance_m


def test_heights_above_sea_level_are_brought_to_the_ellipsoid_and_the_file_may_say_so(tmp_path):
    write_heights(tmp_path / "stated.tif", plane, geoid=True)
    compound = "EPSG:32632+5773"
    write_heights(
        tmp_path / "compound.tif", plane, geoid=True, crs=compound, transform=transform_at(), horizontal=UTM32
    )
    stated = sample_heights(ORIGIN, AREA, [tmp_path / "stated.tif"], HeightOptions(vertical="egm96"))
    by_itself = sample_heights(ORIGIN, AREA, [tmp_path / "compound.tif"], HeightOptions())
    assert off(stated).max() < FLOAT32_M
    assert off(by_itself).max() < FLOAT32_M
    assert stated.notes() == by_itself.notes() == ()
    assert by_itself.rasters[0].vertical == "EGM96"
    national = sample_heights(ORIGIN, AREA, [tmp_path / "stated.tif"], HeightOptions(vertical="EPSG:5728"))
    assert off(national).max() < FLOAT32_M
    assert "EGM96 stands in for 'LN02 height'" in national.notes()[0]


@pytest.mark.parametrize(("unit", "unit_m"), [("ft", 0.3048), ("us-ft", 1200.0 / 3937.0)])
def test_feet_are_feet_where_the_file_or_the_user_says_so(tmp_path, unit, unit_m):
    path = tmp_path / "feet.tif"
    write_heights(path, plane, unit_m=unit_m)
    assert off(sample_heights(ORIGIN, AREA, [path], ELLIPSOID)).max() < 2.0 * FLOAT32_M
    silent = tmp_path / "silent.tif"
    with rasterio.open(path) as source, rasterio.open(silent, "w", **source.profile) as copy:
        copy.write(source.read())
    said = sample_heights(ORIGIN, AREA, [silent], replace(ELLIPSOID, unit=unit))
    assert off(said).max() < 2.0 * FLOAT32_M


def test_pixels_that_are_points_lie_half_a_pixel_from_those_that_are_areas(tmp_path):
    pixel = 5.0
    transform = transform_at(pixel=pixel, half=40)
    write_heights(tmp_path / "area.tif", plane, transform=transform, size=(80, 80), tags={"AREA_OR_POINT": "Area"})
    # The tie point of a file of points is a post: the very same heights, with the corner of its first pixel where GDAL
    # puts it.
    write_heights(tmp_path / "point.tif", plane, transform=transform, size=(80, 80), tags={"AREA_OR_POINT": "Point"})
    ties = {}
    for name in ("area", "point"):
        found = sample_heights(ORIGIN, AREA, [tmp_path / f"{name}.tif"], ELLIPSOID)
        assert off(found).max() < FLOAT32_M
        ties[name] = model_tie_point(tmp_path / f"{name}.tif")
    assert ties["point"][0] - ties["area"][0] == pytest.approx(0.5 * pixel)
    assert ties["point"][1] - ties["area"][1] == pytest.approx(-0.5 * pixel)


def model_tie_point(path):
    """World coordinates of ModelTiepointTag (33922), read from the file's own bytes."""
    content = path.read_bytes()
    n, at = int.from_bytes(content[8:10], "little") if content[2] == 43 else 0, 0
    start = int.from_bytes(content[4:8], "little")
    n = int.from_bytes(content[start : start + 2], "little")
    for k in range(n):
        at = start + 2 + 12 * k
        if int.from_bytes(content[at : at + 2], "little") == 33922:
            place = int.from_bytes(content[at + 8 : at + 12], "little")
            return np.frombuffer(content[place : place + 48], "<f8")[3:5]
    raise AssertionError("no tie point")


@pytest.mark.parametrize("how", ["nodata", "nan", "mask", "undeclared"])
def test_what_a_file_does_not_know_is_not_known(tmp_path, how):
    path = tmp_path / "hole.tif"
    holed = lambda x, y: np.where((np.abs(x - 20.0) < 8.0) & (np.abs(y) < 8.0), np.nan, plane(x, y))  # noqa: E731
    nodata = {"nodata": -9999.0, "nan": float("nan"), "mask": None, "undeclared": None}[how]
    heights = write_heights(path, holed, nodata=nodata) if how in ("nodata", "nan") else None
    if heights is None:
        heights = write_heights(path, holed)
        with rasterio.open(path) as source:
            profile, values = {**source.profile, "nodata": None}, source.read(1)
        with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True), rasterio.open(path, "w", **profile) as file:
            file.write(np.where(np.isnan(heights), 400.0, values) if how == "mask" else values, 1)
            if how == "mask":
                file.write_mask(~np.isnan(heights))
    found = sample_heights(ORIGIN, AREA, [path], ELLIPSOID)
    xy = found.field.nodes_xy_m()
    x, y = xy[..., 0] - 20.0, xy[..., 1]
    unknown = np.isnan(found.field.z_m)
    assert unknown[(np.abs(x) < 7.0) & (np.abs(y) < 7.0)].all()
    assert not unknown[(np.abs(x) > 10.5) | (np.abs(y) > 10.5)].any()
    assert np.nanmax(off(found)) < FLOAT32_M


def tile(
    folder, south, west, size=(120, 120), name="Copernicus_DSM_COG_10_{}_00_{}_00_DEM.tif", surface=plane, origin=ORIGIN
):
    """A tile of one degree: its first post lies on its north-western corner, its last stops short of the next."""
    dx, dy = 1.0 / size[0], 1.0 / size[1]
    ns, ew = f"{'S' if south < 0 else 'N'}{abs(south):02d}", f"{'W' if west < 0 else 'E'}{abs(west):03d}"
    path = folder / name.format(ns, ew)
    transform = Affine.translation(west - 0.5 * dx, south + 1.0 + 0.5 * dy) @ Affine.scale(dx, -dy)
    write_heights(
        path, surface, origin=origin, crs="EPSG:4326", transform=transform, size=size, geoid=True,
        tags={"AREA_OR_POINT": "Point"}, nodata=None,
    )  # fmt: skip
    return path


@pytest.mark.long
@pytest.mark.parametrize(
    ("lat", "lon", "tiles"),
    [
        (47.0, 8.5, [(46, 8), (47, 8)]),
        (47.5, 9.0, [(47, 8), (47, 9)]),
        (47.0, 9.0, [(46, 8), (46, 9), (47, 8), (47, 9)]),
        (0.0, 0.0, [(-1, -1), (-1, 0), (0, -1), (0, 0)]),
        (-17.0, 180.0, [(-18, 179), (-18, -180), (-17, 179), (-17, -180)]),
        (-17.0, -180.0, [(-18, 179), (-18, -180), (-17, 179), (-17, -180)]),
    ],
)
def test_between_tiles_and_at_the_date_line_there_is_no_gap(tmp_path, lat, lon, tiles):
    # Posts are 900 m apart, so that tiles of a degree are small; the place lies on a border or a corner of them.
    origin, area = Origin(lat, lon, 500.0), Area(np.array([-1500.0, -1500.0]), np.array([1500.0, 1500.0]), 0.0)
    for south, west in tiles:
        tile(tmp_path, south, west, origin=origin)
    found = sample_heights(origin, area, [tmp_path], HeightOptions(), 100.0)
    assert len(found.rasters) == len(tiles)
    assert found.unknown_share == 0.0
    # A plane of the local frame is curved in degrees: over 925 m by s^2 / 8 R = 17 mm.
    assert off(found).max() < 0.05
    assert found.rasters[0].vertical == "EGM2008"


def test_where_tiles_of_other_widths_of_pixels_meet_there_is_no_gap_either(tmp_path):
    origin, area = Origin(50.0, 8.5, 500.0), Area(np.array([-1500.0, -1500.0]), np.array([1500.0, 1500.0]), 0.0)
    tile(tmp_path, 49, 8, origin=origin)
    tile(tmp_path, 50, 8, size=(80, 120), origin=origin)
    found = sample_heights(origin, area, [tmp_path], HeightOptions(), 100.0)
    assert found.unknown_share == 0.0
    assert off(found).max() < 0.05


def test_a_missing_neighbour_leaves_what_lies_there_unknown(tmp_path):
    origin, area = Origin(47.0, 8.5, 500.0), Area(np.array([-1500.0, -1500.0]), np.array([1500.0, 1500.0]), 0.0)
    tile(tmp_path, 47, 8, origin=origin)
    found = sample_heights(origin, area, [tmp_path], HeightOptions(), 100.0)
    # The southernmost posts lie 926 m north of the border; the next are the neighbour's.
    north_m = found.field.nodes_xy_m()[..., 1]
    assert np.isnan(found.field.z_m[north_m < 920.0]).all()
    assert not np.isnan(found.field.z_m[north_m > 930.0]).any()


@pytest.mark.parametrize(("lat", "lon", "names"), [(47.0, 9.0, ["N46E008", "N46E009", "N47E008", "N47E009"])])
def test_tiles_of_srtm_meet_on_the_row_that_they_share(tmp_path, lat, lon, names):
    origin, area = Origin(lat, lon, 500.0), Area(np.array([-300.0, -300.0]), np.array([300.0, 300.0]), 0.0)
    for name in names:
        write_hgt(tmp_path, name, plane, origin=origin)
    found = sample_heights(origin, area, [tmp_path], HeightOptions())
    assert found.unknown_share == 0.0
    assert off(found).max() < 0.52  # heights are whole metres
    assert found.post_spacing_m == pytest.approx(63.3, abs=1.0)
    assert found.rasters[0].product.accuracy_m == 9.0


def test_voids_of_srtm_are_not_known(tmp_path):
    origin, area = Origin(47.5, 8.5, 500.0), Area(np.array([-300.0, -300.0]), np.array([300.0, 300.0]), 0.0)
    write_hgt(tmp_path, "N47E008", plane, origin=origin, void=lambda lon, lat: lon > 8.5001)
    found = sample_heights(origin, area, [tmp_path], HeightOptions())
    xy = found.field.nodes_xy_m()
    assert np.isnan(found.field.z_m[xy[..., 0] > 75.0]).all()
    assert not np.isnan(found.field.z_m[xy[..., 0] < -5.0]).any()


def test_folders_are_searched_by_the_names_of_tiles(tmp_path):
    inner = tmp_path / "N47" / "AUXFILES"
    inner.mkdir(parents=True)
    wanted = [
        "Copernicus_DSM_COG_10_N47_00_E008_00_DEM.tif", "N47E008.hgt", "N47/Copernicus_DSM_10_N47_00_E009_00_DEM.tif",
        "survey.tiff",
    ]  # fmt: skip
    others = [
        "N47/AUXFILES/Copernicus_DSM_COG_10_N47_00_E008_00_EDM.tif", "N48E008.hgt", "S48E008.hgt", "N47W009.hgt",
        "Copernicus_DSM_COG_10_N47_00_E011_00_DEM.tif", "readme.txt",
    ]  # fmt: skip
    for name in (*wanted, *others):
        (tmp_path / name).touch()
    found = height_files(tmp_path, (47.4, 8.99), (47.41, 9.01))
    assert sorted(path.relative_to(tmp_path).as_posix() for path in found) == sorted(wanted)
    assert tile_names((-0.1, 179.9), (0.1, -179.9)) == "S01E179, S01W180, N00E179, N00W180"
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "N47E008.hgt").touch()
    (tmp_path / "y").mkdir()
    with pytest.raises(InputError, match=r"none of the tiles in the folder \(1\) covers the site; it needs N10E010"):
        height_files(tmp_path / "x", (10.5, 10.5), (10.6, 10.6))
    with pytest.raises(InputError, match=r"no files of heights; expected \.tif or \.hgt"):
        height_files(tmp_path / "y", (10.5, 10.5), (10.6, 10.6))


def test_blocks_never_written_are_not_known(tmp_path):
    path = tmp_path / "sparse.tif"
    options = {"driver": "GTiff", "dtype": "float32", "count": 1, "crs": UTM32, "transform": transform_at(half=256)}
    options |= {"width": 512, "height": 512, "tiled": True, "blockxsize": 256, "blockysize": 256}
    with rasterio.open(path, "w", sparse_ok=True, **options) as file:
        file.write(np.full((512, 256), 510.0, np.float32), 1, window=rasterio.windows.Window(0, 0, 256, 512))
    found = sample_heights(ORIGIN, AREA, [path], ELLIPSOID)
    east_m = found.field.nodes_xy_m()[..., 0]
    # GDAL says 0 m there.
    assert np.isnan(found.field.z_m[east_m > 1.0]).all()
    assert np.nanmax(np.abs(found.field.z_m - 10.0)) < 0.01
    assert not np.isnan(found.field.z_m[east_m < -2.0]).any()


@pytest.mark.slow
def test_huge_rasters_are_read_by_the_window(tmp_path):
    path = tmp_path / "huge.tif"
    transform = transform_at(half=60_000)
    options = {"driver": "GTiff", "dtype": "float32", "count": 1, "crs": UTM32, "transform": transform}
    options |= {"width": 120_000, "height": 120_000, "tiled": True, "blockxsize": 256, "blockysize": 256}
    with rasterio.open(path, "w", sparse_ok=True, **options) as file:
        # Six blocks that end 160 m east of the middle; the rest of the country, 57 GB, is never written.
        window = rasterio.windows.Window(59_648, 59_648, 512, 768)
        file.write(np.full((768, 512), 510.0, np.float32), 1, window=window)
    code = f"""
import numpy as np, resource, sys
from pathlib import Path
from planning.site.importing.elevation import HeightOptions
from planning.site.importing.terrain import Area, sample_heights
from planning.geo.frames import Origin
area = Area(np.array([-150.0, -60.0]), np.array([250.0, 60.0]), 0.0)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
found = sample_heights(Origin(47.1, 8.3, 500.0), area, [Path({str(path)!r})], HeightOptions(vertical="ellipsoid"))
used_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
print(used_mb, np.isnan(found.field.z_m[:, found.field.nodes_xy_m()[0, :, 0] > 165.0]).all(),
      float(np.nanmax(np.abs(found.field.z_m - 10.0))), float(np.isnan(found.field.z_m[:, :200]).mean()))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300)
    used_mb, beyond_unknown, off_m, unknown_share = done.stdout.split()
    assert float(used_mb) < 300.0
    assert (beyond_unknown, unknown_share) == ("True", "0.0")
    assert float(off_m) < 0.01


def rewritten(path, source, **changes):
    """A copy of a raster with other facts."""
    with rasterio.open(source) as file:
        profile, values = {**file.profile, **changes}, file.read()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with rasterio.open(path, "w", **profile) as file:
            file.write(np.repeat(values, profile["count"], axis=0).astype(profile["dtype"]))
    return path


@pytest.mark.parametrize(
    ("changes", "options", "expected"),
    [
        ({}, HeightOptions(), "does not say what its heights are above .* --vertical"),
        ({}, HeightOptions(vertical="sea"), "'sea' is nothing that heights are above"),
        ({}, HeightOptions(vertical="EPSG:4326"), "is nothing that heights are above"),
        ({"crs": None}, ELLIPSOID, "names no coordinate reference system; name it with --crs"),
        ({"transform": Affine.identity()}, ELLIPSOID, "does not say where it lies"),
        ({"count": 3}, ELLIPSOID, "has 3 bands"),
        ({"dtype": "uint8", "nodata": 0}, ELLIPSOID, "values of the type uint8"),
        (
            {"transform": Affine.translation(1000.0, 0.0) @ transform_at()},
            ELLIPSOID,
            "has no heights below the airspace",
        ),
        ({"crs": "EPSG:32633"}, ELLIPSOID, "has no heights below the airspace.*N47E008"),
        ({}, HeightOptions(vertical="ellipsoid", crs="EPSG:4326"), "far outside the area of use"),
    ],
)
def test_what_a_file_has_to_say_and_does_not_is_asked_for(tmp_path, tilted, changes, options, expected):
    path = rewritten(tmp_path / "a.tif", tilted, **changes)
    with pytest.raises(InputError, match=expected) as error:
        sample_heights(ORIGIN, AREA, [path], options)
    assert "a.tif" in str(error.value)


def test_files_that_are_no_heights_are_refused(tmp_path):
    (tmp_path / "a.tif").write_bytes(b"no picture at all")
    (tmp_path / "N47E008.hgt").write_bytes(bytes(1000))
    (tmp_path / "heights.hgt").write_bytes(bytes(2 * 1201 * 1201))
    (tmp_path / "N95E008.hgt").write_bytes(bytes(2 * 1201 * 1201))
    expected = {"a.tif": "is no GeoTIFF", "N47E008.hgt": "has 1000 bytes", "heights.hgt": "does not say where"}
    for name, text in {**expected, "N95E008.hgt": "not on earth", "none.tif": "no such file"}.items():
        with pytest.raises(InputError, match=text):
            open_heights(tmp_path / name, ELLIPSOID)


def test_a_step_that_makes_too_many_nodes_is_refused(tilted):
    with pytest.raises(InputError, match="allow a longer step"):
        sample_heights(ORIGIN, AREA, [tilted], ELLIPSOID, 0.01)


def test_of_files_that_overlap_the_higher_counts_and_a_great_difference_is_told(tmp_path, tilted):
    write_heights(tmp_path / "higher.tif", lambda x, y: plane(x, y) + 2.5)
    found = sample_heights(ORIGIN, AREA, [tilted, tmp_path / "higher.tif"], ELLIPSOID, 2.0)
    assert off(found).max() < FLOAT32_M
    assert found.overlap_m == pytest.approx(2.5, abs=1e-3)
    assert "differ by up to 2.5 m" in found.notes()[0]
    assert (found.upper_m - found.field.z_m)[1:-1, 1:-1].min() == pytest.approx(2.5, abs=1e-3)
    assert sample_heights(ORIGIN, AREA, [tilted, tilted], ELLIPSOID, 2.0).notes() == ()


@pytest.mark.few(2)
@pytest.mark.parametrize("step_m", [3.0, 1.0, 7.0, 20.0])
def test_bounds_enclose_every_post_whatever_the_step(tmp_path, step_m):
    path = tmp_path / "rough.tif"
    rough = lambda x, y: plane(x, y) + 4.0 * np.sin(x / 3.0) * np.cos(y / 5.0) + 6.0 * (x + y > 10.0)  # noqa: E731
    heights = write_heights(path, rough)
    found = sample_heights(ORIGIN, AREA, [path], ELLIPSOID, step_m)
    transform = transform_at()
    columns, rows = np.meshgrid(np.arange(200) + 0.5, np.arange(200) + 0.5)
    posts = posts_enu(transform, columns, rows, heights)
    inside = (np.abs(posts[:, :2]) < 60.0).all(axis=1)
    upper, lower = (replace_z(found.field, z) for z in (found.upper_m, found.lower_m))
    assert inside.sum() > 10_000
    assert (upper.heights_m(posts[inside]) >= posts[inside, 2] - 1e-9).all()
    assert (lower.heights_m(posts[inside]) <= posts[inside, 2] + 1e-9).all()
    assert found.n_posts >= inside.sum()


def replace_z(field, z):
    return HeightField(field.west_m, field.south_m, field.step_m, z)


def posts_enu(transform, columns, rows, heights):
    from pyproj import Transformer

    from planning.geo.enu import enu_from_geodetic

    x, y = transform @ (columns, rows)
    lon, lat = Transformer.from_crs(UTM32, "EPSG:4326", always_xy=True).transform(x, y)
    return enu_from_geodetic(ORIGIN, lat, lon, heights)


@given(st.data())
def test_damaged_files_are_refused_or_say_heights_and_never_more_than_they_did(tilted, tmp_path_factory, data):
    path = tmp_path_factory.mktemp("damaged") / "a.tif"
    content = bytearray(tilted.read_bytes())
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(0, len(content) - 1))]
    for _ in range(data.draw(st.integers(1, 8))):
        if content:
            # Half of the hits lie in the header and the tags, which are at the beginning or at the end.
            last = len(content) - 1
            near = st.one_of(
                st.integers(0, min(600, last)), st.integers(max(0, last - 600), last), st.integers(0, last)
            )
            content[data.draw(near)] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(content))
    try:
        found = sample_heights(ORIGIN, AREA, [path], ELLIPSOID, 5.0)
    except InputError as error:
        refusal = str(error)
    else:
        refusal = ""
    if refusal:
        assert "a.tif" in refusal
        return
    known = ~np.isnan(found.field.z_m)
    assert np.isfinite(found.upper_m[known]).all()
    assert (np.isnan(found.upper_m) == ~known).all()
    assert (np.abs(found.field.z_m[known]) < 20_000.0).all()


def test_a_system_that_is_not_known_is_told_of_the_file(tmp_path):
    """Fuzzing came upon one: the message named neither the file nor what to do, but all of the system's text."""
    path = tmp_path / "engineering.tif"
    local = 'LOCAL_CS["site grid",UNIT["metre",1]]'
    with rasterio.open(
        path, "w", driver="GTiff", width=4, height=4, count=1, dtype="float32", crs=local,
        transform=Affine(10.0, 0.0, 0.0, 0.0, -10.0, 40.0),
    ) as file:  # fmt: skip
        file.write(np.zeros((1, 4, 4), np.float32))
    with pytest.raises(InputError, match=r"engineering\.tif.*--crs"):
        sample_heights(ORIGIN, AREA, [path], ELLIPSOID)


def test_a_cut_file_is_not_read_as_far_as_it_goes(tmp_path, tilted):
    content = tilted.read_bytes()
    path = tmp_path / "cut.tif"
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(InputError, match=r"cannot be read as a GeoTIFF: it is cut off or damaged; copy or download"):
        sample_heights(ORIGIN, AREA, [path], ELLIPSOID)
    tile_path = tmp_path / "N47E008.hgt"
    tile_path.write_bytes(bytes(2 * 1201 * 1201 - 2))
    with pytest.raises(InputError, match="copy it again"):
        open_heights(tile_path, HeightOptions())


def test_sources_state_files_checksums_and_systems(tilted):
    (source,) = sample_heights(ORIGIN, AREA, [tilted], ELLIPSOID, 5.0).sources()
    assert source.file == "tilted.tif"
    assert len(source.sha256) == 64
    assert source.crs == "EPSG:32632 (WGS 84 / UTM zone 32N)"
    assert json.dumps(source.vertical) == '"the ellipsoid"'
