"""EGM96: the grid is NGA's, the interpolation is bilinear, and what that costs is stated truly."""

from __future__ import annotations

import csv
import re
import zipfile
from pathlib import Path

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given
from scipy.interpolate import RectBivariateSpline

from planning.geo.geoid import GRID_PATH, amsl_from_ellipsoid_m, ellipsoid_from_amsl_m, grid_m, undulation_m
from tests.planning.geo.make_egm96_grid import DEFAULT_SOURCE, packed, read_gtx_m


def spline() -> RectBivariateSpline:
    """Bicubic spline through the grid, continued around the globe: close to the full model."""
    around = np.concatenate([grid_m()[:, -8:], grid_m(), grid_m()[:, :8]], axis=1)
    return RectBivariateSpline(np.arange(721) * 0.25 - 90.0, np.arange(-8, 1448) * 0.25 - 180.0, around, kx=3, ky=3)


def nga_points(shared_data: Path) -> np.ndarray:
    lines = (shared_data / "geodesy" / "egm96_nga_testpoints.csv").read_text().splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    return np.array(rows[1:], dtype=float)


def test_the_grid_is_ngas_a_smooth_surface_through_it_meets_their_points(shared_data: Path) -> None:
    lat, lon, expected = nga_points(shared_data).T
    smooth = spline()(lat, (lon + 180.0) % 360.0 - 180.0, grid=False)
    # A grid displaced by half a cell, as one in wide circulation is, would be off by decimetres here.
    assert np.abs(smooth - expected).max() < 0.003


def test_bilinear_heights_miss_ngas_points_by_centimetres_not_by_less_and_not_by_more(shared_data: Path) -> None:
    lat, lon, expected = nga_points(shared_data).T
    error = np.abs(undulation_m(lat, lon) - expected)
    assert 0.05 < error.max() < 0.06
    assert 0.02 < np.median(error) < 0.03


def test_bilinear_error_over_the_globe_is_what_the_documentation_says() -> None:
    lat, lon = np.arange(720) * 0.25 - 89.875, np.arange(1440) * 0.25 - 179.875
    error = np.abs(undulation_m(lat[:, None], lon[None, :]) - spline()(lat, lon))
    assert 0.014 < np.median(error) < 0.017
    assert 0.19 < np.percentile(error, 99.0) < 0.21
    assert 1.0 < error.max() < 1.2


def test_geographiclibs_vectors_from_its_own_finer_grid_are_met(shared_data: Path) -> None:
    rows = csv.DictReader((shared_data / "geodesy" / "geographiclib_cli_vectors.csv").read_text().splitlines())
    row = next(row for row in rows if row["name"] == "GeoidEval0")
    assert "0d1 0d1;0d4 0d4" in row["args"]
    values = undulation_m([1.0 / 60.0, 4.0 / 60.0], [1.0 / 60.0, 4.0 / 60.0])
    pattern = row["expected_regex"].replace("\\\\", "\\")  # the file escapes its backslashes
    assert re.match(pattern, "\n".join(f"{value:.4f}" for value in values))


def test_djis_own_mission_converts_with_the_same_geoid(shared_data: Path) -> None:
    with zipfile.ZipFile(shared_data / "missions" / "geoyee_m3d_curtainwall_slope_mapping2d.kmz") as archive:
        name = next(name for name in archive.namelist() if name.endswith("template.kml"))
        text = archive.read(name).decode()
    placemark = re.search(r"<Placemark>.*?</Placemark>", text, re.DOTALL)
    assert placemark is not None
    lon, lat = (float(v) for v in re.findall(r"<coordinates>\s*([-\d.]+),([-\d.]+)", placemark[0])[0])
    height, ellipsoid = (
        float(re.findall(rf"<wpml:{tag}>([-\d.]+)<", placemark[0])[0]) for tag in ("height", "ellipsoidHeight")
    )
    assert float(undulation_m(lat, lon)) == pytest.approx(ellipsoid - height, abs=0.0005)


def test_the_source_grid_is_reproduced_to_half_a_millimetre() -> None:
    if not DEFAULT_SOURCE.is_file():
        pytest.skip("Debian's proj-data is not installed, so there is no grid to compare with")
    source_m = read_gtx_m(DEFAULT_SOURCE)
    assert np.abs(source_m - grid_m()).max() <= 0.000501
    rows, columns = np.divmod(np.random.default_rng(0).integers(0, 721 * 1440, 1000), 1440)
    nodes = undulation_m(rows * 0.25 - 90.0, columns * 0.25 - 180.0)
    np.testing.assert_allclose(nodes, source_m[rows, columns], atol=0.000501)


@pytest.mark.slow
def test_packing_the_grid_again_gives_the_file_that_is_carried() -> None:
    import lzma

    assert lzma.decompress(packed(grid_m())) == lzma.decompress(GRID_PATH.read_bytes())
    assert GRID_PATH.stat().st_size < 1_000_000


def test_a_grid_of_another_shape_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.gtx"
    path.write_bytes(bytes(40))
    with pytest.raises(ValueError, match="expected a grid with the header"):
        read_gtx_m(path)


@given(lat=st.floats(-90.0, 90.0), lon=st.floats(-720.0, 720.0))
def test_interpolated_heights_lie_between_those_of_the_four_nodes_around(lat: float, lon: float) -> None:
    row, column = min(int((lat + 90.0) * 4.0), 719), int(((lon + 180.0) % 360.0) * 4.0) % 1440
    around = grid_m()[row : row + 2][:, [column, (column + 1) % 1440]]
    assert around.min() - 1e-9 <= float(undulation_m(lat, lon)) <= around.max() + 1e-9


@given(lat=st.floats(-89.9, 89.9), lon=st.sampled_from([-180.0, 180.0, 0.0, 12.25]) | st.floats(-180.0, 180.0))
def test_heights_are_continuous_everywhere_the_antimeridian_included(lat: float, lon: float) -> None:
    step_deg = 1e-7
    here, east, north = undulation_m([lat, lat, lat + step_deg], [lon - step_deg, lon + step_deg, lon - step_deg])
    assert abs(east - here) < 1e-5
    assert abs(north - here) < 1e-5


def test_longitudes_wrap_and_poles_have_one_height() -> None:
    np.testing.assert_allclose(undulation_m(48.7, [11.4, 371.4, -348.6, 731.4]), [undulation_m(48.7, 11.4)] * 4)
    np.testing.assert_allclose(undulation_m(90.0, [-180.0, -1e-14, 0.0, 33.3, 180.0]), [13.606] * 5, rtol=1e-12)
    np.testing.assert_allclose(undulation_m(-90.0, [-180.0, -180.00000000000003, 100.0]), [-29.534] * 3, rtol=1e-12)


@given(lat=st.floats(-90.0, 90.0), lon=st.floats(-180.0, 180.0), height=st.floats(-1000.0, 10_000.0))
def test_sea_level_and_ellipsoid_heights_are_inverse(lat: float, lon: float, height: float) -> None:
    there = amsl_from_ellipsoid_m(lat, lon, height)
    assert float(ellipsoid_from_amsl_m(lat, lon, there)) == pytest.approx(height, abs=1e-9)
    assert float(there) - height == pytest.approx(-float(undulation_m(lat, lon)), abs=1e-9)


def test_values_keep_their_shape_and_wrong_ones_are_refused() -> None:
    assert undulation_m(np.zeros((2, 1)), np.zeros((1, 3))).shape == (2, 3)
    assert undulation_m([], []).shape == (0,)
    with pytest.raises(ValueError, match="finite"):
        undulation_m(0.0, np.nan)
    with pytest.raises(ValueError, match=r"-90 to 90, got -90\.5"):
        undulation_m([-90.5], [0.0])
