"""Population rasters: people per cell and per square kilometre in every system, and what is not known is not nobody."""

import math

import numpy as np
import pytest
import rasterio
import shapely
from affine import Affine
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod, Transformer

from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.geo.frames import Origin
from planning.insight.ground_risk import assess_ground_risk
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.insight.population import open_population, people_below
from planning.site.bundled import ORIGIN
from planning.site.importing.elevation import _quiet
from tests.planning.insight.ground_risk_cases import ROUND, flown, place

MOLLWEIDE = "ESRI:54009"
ARC_S = 3.0 / 3600.0


def raster(path, values, crs="EPSG:4326", pixel=ARC_S, origin=ORIGIN, transform=None, **profile):
    """A GeoTIFF of values about a place."""
    values = np.asarray(values, profile.pop("dtype", "float64"))
    x, y = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(origin.lon_deg, origin.lat_deg)
    rows, columns = values.shape
    usual = Affine(pixel, 0.0, x - 0.5 * columns * pixel, 0.0, -pixel, y + 0.5 * rows * pixel)
    options = {"driver": "GTiff", "dtype": values.dtype, "count": 1, "width": columns, "height": rows, "crs": crs}
    options |= {"transform": usual if transform is None else transform, "nodata": -200.0, **profile}
    with rasterio.open(path, "w", **options) as target:
        target.write(values, 1)
    return path


def circle(radius_m=300.0, x=0.0, y=0.0):
    return shapely.Point(x, y).buffer(radius_m, 64)


def cell_m2(transform, crs, column, row):
    """True area of a cell on the ellipsoid, by Karney's polygons along densified sides."""
    t = np.linspace(0.0, 1.0, 20)[:-1]
    ring = [
        (column + a, row + b)
        for a, b in (
            *((s, 0.0) for s in t),
            *((1.0, s) for s in t),
            *((1.0 - s, 1.0) for s in t),
            *((0.0, 1.0 - s) for s in t),
        )
    ]
    x, y = zip(*(transform @ point for point in ring), strict=True)
    lon, lat = Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform(x, y)
    return abs(Geod(ellps="WGS84").polygon_area_perimeter(lon, lat)[0])


@pytest.mark.parametrize(
    ("crs", "pixel", "rel"), [("EPSG:4326", ARC_S, 1e-4), (MOLLWEIDE, 100.0, 1e-4), ("EPSG:32650", 100.0, 1e-4)]
)
def test_people_in_a_cell_are_divided_by_its_true_area(tmp_path, crs, pixel, rel):
    """7 people in every cell: the density is 7 over the area on the ellipsoid, whatever the map does to areas."""
    path = raster(tmp_path / "hkg_ppp_2020.tif", np.full((40, 40), 7.0), crs, pixel)
    found = people_below(open_population(path), circle(), ORIGIN)
    with rasterio.open(path) as source:
        true_m2 = cell_m2(source.transform, crs, 20, 20)
    assert found.most_per_km2 == pytest.approx(7.0 / (true_m2 / 1e6), rel=rel)
    assert found.mean_per_km2 == pytest.approx(found.most_per_km2, rel=1e-3)
    assert found.cell_m == pytest.approx(math.sqrt(true_m2), rel=rel)
    assert (found.product, found.counts, found.unknown) == ("WorldPop", "cell", 0.0)


def test_people_per_square_kilometre_are_taken_as_they_are_and_the_mean_is_by_overlap(tmp_path):
    values = np.zeros((40, 40))
    values[:, 20:] = 800.0
    path = raster(tmp_path / "hkg_pd_2020_1km.tif", values)
    found = people_below(open_population(path), circle(), ORIGIN)
    assert found.most_per_km2 == 800.0
    assert found.mean_per_km2 == pytest.approx(400.0, rel=2e-3)
    aside = people_below(open_population(path), circle(200.0, x=-250.0), ORIGIN)
    assert (aside.most_per_km2, aside.mean_per_km2) == (0.0, 0.0)
    assert aside.unknown == 0.0
    # A cell that an area reaches into by a corner counts for the maximum.
    over = people_below(open_population(path), circle(200.0, x=-190.0), ORIGIN)
    assert over.most_per_km2 == 800.0


@pytest.mark.parametrize("how", ["nodata", "negative", "nan", "edge"])
def test_what_a_raster_does_not_know_is_not_nobody(tmp_path, how):
    values = np.full((40, 40), 50.0)
    transform, nodata = None, -200.0
    if how == "edge":
        values = values[:, :20]
        transform = Affine(ARC_S, 0.0, ORIGIN.lon_deg - 20 * ARC_S, 0.0, -ARC_S, ORIGIN.lat_deg + 20 * ARC_S)
    else:
        values[:, 20:] = {"nodata": -200.0, "negative": -7.0, "nan": np.nan}[how]
        nodata = None if how == "negative" else nodata
    path = raster(tmp_path / "GHS_POP_test.tif", values, transform=transform, nodata=nodata)
    found = people_below(open_population(path), circle(), ORIGIN)
    assert found.unknown == pytest.approx(0.5, abs=0.01)
    assert found.mean_per_km2 == pytest.approx(found.most_per_km2, rel=1e-3)
    nothing = people_below(open_population(path), circle(200.0, x=300.0), ORIGIN)
    assert (nothing.most_per_km2, nothing.mean_per_km2, nothing.unknown) == (None, None, 1.0)


def test_zero_is_nobody_where_the_file_says_so_and_unknown_where_zero_is_its_nodata(tmp_path):
    empty = raster(tmp_path / "a_ppp_2020.tif", np.zeros((40, 40)))
    assert people_below(open_population(empty), circle(), ORIGIN).most_per_km2 == 0.0
    void = raster(tmp_path / "b_ppp_2020.tif", np.zeros((40, 40)), nodata=0.0)
    assert people_below(open_population(void), circle(), ORIGIN).unknown == 1.0


@pytest.mark.parametrize("lon_deg", [180.0, -180.0, 179.9995, -179.9999])
def test_a_raster_all_around_the_earth_has_no_gap_at_the_date_line(tmp_path, lon_deg):
    step = 0.01
    values = np.tile(np.where(np.arange(36000) % 2, 300.0, 100.0), (3, 1))
    origin = Origin(-16.5, lon_deg, 10.0)
    transform = Affine(step, 0.0, -180.0, 0.0, -step, -16.5 + 1.5 * step)
    path = raster(tmp_path / "fji_pd_2020_1km.tif", values, transform=transform)
    found = people_below(open_population(path), circle(400.0), origin)
    assert found.unknown == 0.0
    assert found.most_per_km2 == 300.0
    assert 100.0 < found.mean_per_km2 < 300.0


def test_a_national_raster_that_ends_at_the_date_line_knows_nothing_beyond(tmp_path):
    transform = Affine(0.001, 0.0, 179.5, 0.0, -0.001, -16.0)
    path = raster(tmp_path / "fji_ppp_2020.tif", np.ones((1000, 500)), transform=transform)
    found = people_below(open_population(path), circle(), Origin(-16.5, 180.0, 10.0))
    assert found.unknown == pytest.approx(0.5, abs=0.01)


def test_where_the_map_itself_is_torn_the_file_is_refused_in_words(tmp_path):
    """Mollweide at the date line: neighbours on the ground lie at both ends of the map."""
    origin = Origin(-16.5, 179.9999, 10.0)
    path = raster(tmp_path / "GHS_POP_x.tif", np.ones((10, 10)), MOLLWEIDE, 100.0, Origin(0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="torn here"):
        people_below(open_population(path), circle(), origin)


NAMES = [
    ("GHS_POP_E2020_GLOBE_R2023A_54009_100_V1_0_R5_C19.tif", "GHS-POP", "cell"),
    ("gbr_ppp_2020_UNadj.tif", "WorldPop", "cell"),
    ("ppp_2020_1km_Aggregated.tif", "WorldPop", "cell"),
    ("gbr_pop_2025_CN_100m_R2024B_v1.tif", "WorldPop", "cell"),
    ("gbr_pd_2020_1km_UNadj.tif", "WorldPop", "km2"),
    ("gpw_v4_population_count_rev11_2020_30_sec.tif", "GPWv4", "cell"),
    ("gpw_v4_population_density_rev11_2020_30_sec.tif", "GPWv4", "km2"),
]


@pytest.mark.parametrize(("name", "product", "counts"), NAMES)
def test_products_are_known_by_the_names_of_their_files_and_what_is_stated_counts_more(tmp_path, name, product, counts):
    path = raster(tmp_path / name, np.ones((4, 4)))
    found = open_population(path)
    assert (found.product, found.counts, found.is_stated) == (product, counts, False)
    other = "km2" if counts == "cell" else "cell"
    stated = open_population(path, other)
    assert (stated.counts, stated.is_stated) == (other, True)


@pytest.mark.parametrize(
    ("name", "profile", "words"),
    [
        ("people.tif", {}, "people in a cell or per square kilometre; say it (--population-counts"),
        ("GHS_POP_a.tif", {"crs": None}, "names no coordinate reference system"),
        ("GHS_POP_b.tif", {"transform": Affine.identity()}, "does not say where it lies"),
        ("GHS_POP_c.tif", {"count": 3}, "has 3 bands, as pictures have"),
    ],
)
def test_files_that_do_not_say_what_has_to_be_known_are_refused_in_words(tmp_path, name, profile, words):
    options = {"driver": "GTiff", "dtype": "float32", "count": 1, "width": 4, "height": 4, "crs": "EPSG:4326"}
    options |= {"transform": Affine(0.1, 0.0, 8.0, 0.0, -0.1, 47.0), **profile}
    with _quiet(), rasterio.open(tmp_path / name, "w", **options) as target:
        for band in range(1, options["count"] + 1):
            target.write(np.ones((4, 4), "float32"), band)
    with pytest.raises(InputError) as caught:
        open_population(tmp_path / name)
    assert words in str(caught.value)


def test_what_is_no_raster_is_refused(tmp_path):
    (tmp_path / "GHS_POP_b.tif").write_bytes(b"not a picture")
    with pytest.raises(InputError, match="no GeoTIFF"):
        open_population(tmp_path / "GHS_POP_b.tif")


@settings(deadline=None)
@given(st.data())
def test_damaged_files_are_refused_or_say_no_less_unknown(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("people")
    values = np.full((40, 40), 9.0)
    content = bytearray(raster(folder / "GHS_POP_whole.tif", values).read_bytes())
    for place_ in data.draw(st.lists(st.integers(0, len(content) - 1), min_size=1, max_size=8)):
        content[place_] = data.draw(st.integers(0, 255))
    path = folder / "GHS_POP_hurt.tif"
    path.write_bytes(bytes(content[: data.draw(st.integers(1, len(content)))]))
    try:
        found = people_below(open_population(path), circle(), ORIGIN)
    except InputError:
        return
    assert 0.0 <= found.unknown <= 1.0
    assert found.most_per_km2 is None or found.most_per_km2 >= 0.0


def assessed(path, **request):
    return assess_ground_risk(
        flown(ROUND), place(), GroundRiskRequest(wind_m_s=5.0, population_raster=str(path), **request)
    )


def finding(risk):
    return [found for found in risk.findings if found.code == "sora-raster"]


def test_a_raster_makes_the_class_where_nobody_stated_people(tmp_path):
    path = raster(tmp_path / "hkg_pd_2020_1km.tif", np.full((60, 60), 1200.0))
    risk = assessed(path)
    assert risk.band.word == "suburban"
    assert risk.intrinsic_class == assessed(path, population="1200").intrinsic_class
    assert risk.value_of("D_max") == 1200.0
    assert risk.value_of("D_mean") == pytest.approx(1200.0)
    assert risk.value_of("D_?") == 0.0
    (note,) = finding(risk)
    assert note.severity is Severity.NOTE
    assert "1200 per square kilometre in its fullest cell ('suburban')" in note.message


def test_what_the_pilot_states_counts_and_the_raster_contradicts_aloud(tmp_path):
    path = raster(tmp_path / "hkg_pd_2020_1km.tif", np.full((60, 60), 1200.0))
    low = assessed(path, population="remote")
    assert low.band.word == "remote"
    (warning,) = finding(low)
    assert warning.severity is Severity.WARNING
    assert "more than the 'remote' stated" in warning.message
    assert finding(assessed(path, population="city"))[0].severity is Severity.OK
    controlled = assessed(path, population="controlled")
    assert controlled.band.word == "controlled"
    assert finding(controlled)[0].severity is Severity.NOTE


def test_a_raster_with_holes_makes_no_class_and_impossible_numbers_are_an_error(tmp_path):
    values = np.full((60, 60), 1200.0)
    values[30, 30] = -200.0
    risk = assessed(raster(tmp_path / "a_pd_2020_.tif", values))
    assert risk.band is None
    assert risk.final_class is None
    assert "does not mean nobody" in finding(risk)[0].message
    # 50 000 people in a cell of 100 m are five million in a square kilometre.
    risk = assessed(raster(tmp_path / "b_ppp_2020.tif", np.full((60, 60), 50_000.0)))
    assert any(found.severity is Severity.ERROR and "live nowhere" in found.message for found in finding(risk))
    risk = assessed(raster(tmp_path / "c_pd_2020_1km.tif", np.full((6, 6), 3.0), pixel=0.1))
    assert any("larger than the whole buffer" in found.message for found in finding(risk))
