"""Geoid grids of GeographicLib and PROJ: read around a place as they say it, and used for what heights are above."""

import math
import struct

import numpy as np
import pytest
import rasterio
from affine import Affine
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.geo.geoid import undulation_m
from planning.site.importing import geoid_file
from planning.site.importing.elevation import HeightOptions
from planning.site.importing.geoid_file import found_geoid, open_geoid
from planning.site.importing.terrain import sample_heights
from tests.planning.site.importing.height_files import ORIGIN, write_heights
from tests.planning.site.importing.test_elevation import AREA

STEP = 0.25


def surface(lat, lon):
    """Smooth, and another one in every place; of the size of a geoid."""
    return 40.0 * np.sin(np.radians(2.0 * lat)) + 20.0 * np.cos(np.radians(3.0 * lon)) + 5.0


def pgm(path, function=surface, step=STEP, description="WGS84 EGM2008, 15-minute grid", dtype=">u2"):
    lat, lon = np.arange(90.0, -90.0 - step / 2, -step), np.arange(0.0, 360.0 - step / 2, step)
    values = np.round((function(lat[:, None], lon[None, :]) + 108.0) / 0.003)
    head = (
        "P5\n# Geoid file in PGM format for the GeographicLib::Geoid class\n"
        f"# Description {description}\n# Offset -108\n# Scale 0.003\n# Origin 90N 0E\n"
        f"{len(lon)} {len(lat)}\n65535\n"
    )
    path.write_bytes(head.encode() + values.astype(dtype).tobytes())
    return path


def gtx(path, function=surface, south=-90.0, west=-180.0, rows=721, columns=1440, step=STEP):
    lat, lon = south + step * np.arange(rows), west + step * np.arange(columns)
    values = function(lat[:, None], lon[None, :]).astype(">f4")
    path.write_bytes(struct.pack(">4d2i", south, west, step, step, rows, columns) + values.tobytes())
    return path


def tif(path, function=surface, west=-180.0, columns=1440, step=STEP):
    lat, lon = 90.0 - step * np.arange(721), west + step * np.arange(columns)
    values = function(lat[:, None], lon[None, :]).astype("float32")
    # Nodes are the centres of pixels.
    transform = Affine(step, 0.0, west - 0.5 * step, 0.0, -step, 90.0 + 0.5 * step)
    options = {"driver": "GTiff", "dtype": "float32", "count": 1, "width": columns, "height": 721, "crs": "EPSG:4979"}
    with rasterio.open(path, "w", transform=transform, **options) as target:
        target.write(values, 1)
    return path


MAKERS = {"egm2008-15.pgm": pgm, "egm08_15.gtx": gtx, "us_nga_egm08_15.tif": tif}

PLACES = [
    (47.1, 8.3), (0.0, 0.0), (-33.9, 151.2), (22.3372, 114.2636), (-16.5, 180.0), (-16.5, -180.0), (51.9, 179.999),
    (51.9, -179.999), (0.06, -0.06), (89.97, 40.0), (-89.99, -170.0), (90.0, 0.0), (31.5, 359.9),
]  # fmt: skip


@pytest.fixture(scope="module", params=MAKERS)
def grid(request, tmp_path_factory):
    return MAKERS[request.param](tmp_path_factory.mktemp("geoid") / request.param)


@pytest.mark.parametrize("place", PLACES)
def test_heights_around_a_place_are_those_of_the_grid(grid, place):
    """Bilinear: off by at most h^2 / 8 of the curvature; the surface has 0.05 m a square degree and less."""
    lat, lon = place
    window = open_geoid(grid, lat, lon)
    assert window.model == "EGM2008"
    aside = 0.09 / max(math.cos(math.radians(lat)), 0.01)
    lats = np.clip(lat + np.linspace(-0.09, 0.09, 7), -90.0, 90.0)[:, None]
    lons = lon + np.linspace(-min(aside, 9.0), min(aside, 9.0), 7)[None, :]
    np.testing.assert_allclose(window.undulation_m(lats, lons), surface(lats, lons), atol=0.004)
    assert window.heights_m.size < 200_000


def test_nodes_come_back_to_the_steps_of_the_file(grid):
    window = open_geoid(grid, 47.0, 8.0)
    assert float(window.undulation_m(47.0, 8.25)) == pytest.approx(surface(47.0, 8.25), abs=0.0016)
    assert window.step_deg == pytest.approx((STEP, STEP))
    assert math.isnan(window.undulation_m(48.0, 8.0))


def test_a_grid_of_a_country_covers_that_country_alone(tmp_path):
    path = gtx(tmp_path / "de_bkg_gcg2016.gtx", south=47.0, west=5.0, rows=33, columns=45)
    assert float(open_geoid(path, 50.0, 10.0).undulation_m(50.0, 10.0)) == pytest.approx(surface(50.0, 10.0), abs=0.004)
    assert open_geoid(path, 50.0, 10.0).model == ""
    for lat, lon in ((50.0, 20.0), (40.0, 10.0), (50.0, -170.0)):
        with pytest.raises(InputError, match="knows nothing here"):
            open_geoid(path, lat, lon)
    hole = gtx(
        tmp_path / "x.gtx",
        lambda lat, lon: np.where(lat > 50.1, -88.8888, 30.0) + 0.0 * lon,
        south=47.0,
        west=5.0,
        rows=33,
        columns=45,
    )
    with pytest.raises(InputError, match="knows nothing here"):
        open_geoid(hole, 50.3, 10.0)


def test_what_is_no_geoid_is_refused_in_words(tmp_path):
    whole = pgm(tmp_path / "a.pgm", step=5.0).read_bytes()
    for name, content, words in (
        ("b.pgm", whole[:-7], "cut off"),
        ("c.pgm", whole.replace(b"# Offset -108\n", b""), "no geoid of GeographicLib"),
        ("d.pgm", b"P5\n4 4\n255\n" + bytes(16), "no geoid of GeographicLib"),
        ("e.gtx", b"short", "cut off"),
        ("f.gtx", struct.pack(">4d2i", 900.0, 0.0, 1.0, 1.0, 9, 9) + bytes(4 * 81), "no geoid grid in the form GTX"),
        ("g.tif", b"nothing", "no GeoTIFF; expected geoid heights"),
        ("h.txt", b"", "no geoid grid; expected .pgm"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError) as caught:
            open_geoid(tmp_path / name, 47.0, 8.0)
        assert words in str(caught.value)
    mountains = gtx(tmp_path / "i.gtx", lambda lat, lon: 1500.0 + 0.0 * lat * lon, step=5.0, rows=37, columns=72)
    with pytest.raises(InputError, match="of no geoid"):
        open_geoid(mountains, 47.0, 8.0)


@settings(deadline=None)
@given(st.data())
def test_damaged_grids_are_refused_or_say_heights_of_a_geoid(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("hurt")
    name = data.draw(st.sampled_from(["a.pgm", "a.gtx"]))
    if name == "a.pgm":
        content = bytearray(pgm(folder / "whole.pgm", step=5.0).read_bytes())
    else:
        content = bytearray(gtx(folder / "whole.gtx", step=5.0, rows=37, columns=72).read_bytes())
    for place in data.draw(st.lists(st.integers(0, 300), min_size=1, max_size=5)):
        content[place] = data.draw(st.integers(0, 255))
    (folder / name).write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    try:
        window = open_geoid(folder / name, 47.0, 8.0)
    except InputError:
        return
    assert abs(float(window.undulation_m(47.0, 8.0))) <= 120.0


def heights(tmp_path, **options):
    write_heights(tmp_path / "dtm.tif", lambda x, y: 0.0 * x, geoid=True)
    found = sample_heights(ORIGIN, AREA, [tmp_path / "dtm.tif"], HeightOptions(**options))
    return float(np.nanmedian(found.field.z_m)), found


def shifted(lat, lon):
    """A geoid 1.7 m above EGM96."""
    return undulation_m(lat, lon) + 1.7


def test_terrain_above_egm2008_stands_on_its_own_geoid_where_the_user_has_the_grid(tmp_path, monkeypatch):
    monkeypatch.setattr(geoid_file, "_folders", lambda: iter(()))
    stand_in, without = heights(tmp_path, vertical="egm2008")
    (note,) = without.notes()
    assert stand_in == pytest.approx(0.0, abs=0.01)
    assert "EGM96 stands in for EGM2008: both differ by 0.5 m in the mean" in note
    assert "(--geoid)" in note
    path = pgm(tmp_path / "egm2008-15.pgm", shifted)
    exact, by_grid = heights(tmp_path, vertical="egm2008", geoid=path)
    assert exact == pytest.approx(1.7, abs=0.01)
    (note,) = by_grid.notes()
    assert note.startswith("EGM2008 by the grid 'egm2008-15.pgm' in steps of 15 minutes: here ")
    assert note.endswith("+1.70 m from EGM96")
    assert by_grid.sources()[0].vertical == "EGM2008 (egm2008-15.pgm)"
    # A national system takes the grid that the user names for it, and heights above the ellipsoid none.
    national, of_system = heights(tmp_path, vertical="EPSG:5728", geoid=path)
    assert national == pytest.approx(1.7, abs=0.01)
    assert "LN02" in of_system.sources()[0].vertical
    level, of_ellipsoid = heights(tmp_path, vertical="ellipsoid", geoid=path)
    assert level == pytest.approx(float(-undulation_m(ORIGIN.lat_deg, ORIGIN.lon_deg)), abs=0.01)
    assert of_ellipsoid.notes() == ()


def test_the_grid_of_another_geoid_is_refused_and_one_that_lies_elsewhere_too(tmp_path):
    other = pgm(tmp_path / "egm96-15.pgm", shifted, description="WGS84 EGM96, 15-minute grid")
    with pytest.raises(InputError, match=r"this grid is of EGM96, and heights of 'dtm\.tif' are above EGM2008"):
        heights(tmp_path, vertical="egm2008", geoid=other)
    assert heights(tmp_path, vertical="egm96", geoid=other)[0] == pytest.approx(1.7, abs=0.01)
    far = gtx(tmp_path / "far.gtx", south=-40.0, west=140.0, rows=33, columns=45)
    with pytest.raises(InputError, match="take one that covers the site"):
        heights(tmp_path, vertical="egm2008", geoid=far)


def test_grids_of_geographiclib_and_proj_are_found_and_used_for_egm2008_alone(tmp_path, monkeypatch):
    folder = tmp_path / "geoids"
    folder.mkdir()
    monkeypatch.setattr(geoid_file, "_folders", lambda: iter((folder,)))
    assert found_geoid() is None
    pgm(folder / "egm2008-5.pgm", shifted)
    assert found_geoid() == folder / "egm2008-5.pgm"
    assert heights(tmp_path, vertical="egm2008")[0] == pytest.approx(1.7, abs=0.01)
    assert heights(tmp_path, vertical="egm96")[0] == pytest.approx(0.0, abs=0.01)
    monkeypatch.undo()
    monkeypatch.setenv("GEOGRAPHICLIB_GEOID_PATH", str(folder))
    assert found_geoid() == folder / "egm2008-5.pgm"


def test_a_site_at_the_date_line_has_no_seam(tmp_path):
    path = pgm(tmp_path / "egm2008-15.pgm")
    window = open_geoid(path, -16.5, 180.0)
    west, east = (float(window.undulation_m(-16.5, lon)) for lon in (179.9999, -179.9999))
    assert west == pytest.approx(east, abs=1e-3)
