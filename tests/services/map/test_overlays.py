"""Overlays: GeoJSON, KML, KMZ and GeoTIFF, at the date line, and damaged and hostile ones."""

import contextlib
import json
import zipfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.map import overlays as module
from groundstation.services.map.overlays import distance_m, read_overlay
from groundstation.services.map.web_mercator import geodetic_from_world, world_from_geodetic
from planning.base.errors import InputError

SQUARE = [[114.26, 22.33], [114.27, 22.33], [114.27, 22.34], [114.26, 22.34], [114.26, 22.33]]


POINT = {"type": "Point", "coordinates": [1, 2]}


def feature(kind, coordinates, **properties):
    return {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates}}


def collection(*features, **more):
    return {"type": "FeatureCollection", "features": list(features), **more}


def write(path, content):
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def kml(placemarks, head=""):
    return f'<?xml version="1.0"?>{head}<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{placemarks}</Document></kml>'


def degrees(world):
    return np.array([geodetic_from_world(*point) for point in world])


def refused(path):
    with pytest.raises(InputError) as caught:
        read_overlay(path)
    assert str(path) in str(caught.value) or path.name in str(caught.value)
    return str(caught.value)


def test_geojson_of_every_kind_is_read(tmp_path):
    found = read_overlay(
        write(
            tmp_path / "a.geojson",
            collection(
                feature("Point", [114.26, 22.33, 5.0], name="Gate <b>1</b>"),
                feature("MultiPoint", [[114.26, 22.33], [114.27, 22.34]]),
                feature("LineString", SQUARE[:3]),
                feature("MultiLineString", [SQUARE[:2], SQUARE[2:4]]),
                feature("Polygon", [SQUARE, SQUARE[::-1]], name="Area"),
                feature("MultiPolygon", [[SQUARE], [SQUARE]]),
                {"type": "Feature", "geometry": None, "properties": None},
                {
                    "type": "Feature",
                    "properties": {"name": 7},
                    "geometry": {
                        "type": "GeometryCollection",
                        "geometries": [{"type": "Point", "coordinates": [1, 2]}],
                    },
                },
            ),
        )
    )
    assert (len(found.points), len(found.lines), len(found.areas)) == (4, 3, 3)
    assert len(found.areas[0]) == 2
    assert [name for name, _ in found.labels] == ["Gate 1", "Area"]
    assert degrees(found.lines[0]) == pytest.approx(np.array(SQUARE[:3])[:, ::-1], abs=1e-9)
    assert found.name == "a.geojson"


def test_an_older_reference_system_is_followed(tmp_path):
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    content = collection(feature("Point", [691603.0, 5334760.0]), crs=crs)
    assert degrees(read_overlay(write(tmp_path / "a.json", content)).points)[0] == pytest.approx(
        (48.13722, 11.575491), abs=1e-5
    )
    crs["properties"]["name"] = "EPSG:nonsense"
    assert "not a coordinate reference system" in refused(write(tmp_path / "b.json", content))


def test_lines_go_on_across_the_date_line(tmp_path):
    content = collection(feature("LineString", [[179.9, -16.5], [-179.9, -16.5], [-179.8, -16.4]]))
    (line,) = read_overlay(write(tmp_path / "a.geojson", content)).lines
    assert np.abs(np.diff(line[:, 0])).max() < 1e-3
    assert line[1, 0] > 1.0


def test_kml_and_kmz_are_read(tmp_path):
    ring = " ".join(f"{lon},{lat},3" for lon, lat in SQUARE)
    polygon = (
        f"<Polygon><outerBoundaryIs><LinearRing><coordinates>\n{ring}\n</coordinates></LinearRing></outerBoundaryIs>"
        f"<innerBoundaryIs><LinearRing><coordinates>{ring}</coordinates></LinearRing></innerBoundaryIs></Polygon>"
    )
    content = kml(
        f"<Folder><Placemark><name>Yard</name>{polygon}</Placemark></Folder>"
        "<Placemark><MultiGeometry><Point><coordinates>114.26,22.33</coordinates></Point>"
        "<LineString><coordinates>114.26,22.33 114.27,22.34</coordinates></LineString></MultiGeometry></Placemark>"
    )
    with zipfile.ZipFile(tmp_path / "a.kmz", "w") as archive:
        archive.writestr("files/logo.png", b"x")
        archive.writestr("doc.kml", content)
    for path in (write(tmp_path / "a.kml", content), tmp_path / "a.kmz"):
        found = read_overlay(path)
        assert (len(found.points), len(found.lines), len(found.areas), len(found.areas[0])) == (1, 1, 1, 2)
        assert found.labels[0][0] == "Yard"
        assert degrees(found.points)[0] == pytest.approx((22.33, 114.26), abs=1e-9)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "a.geojson"), ("[1, 2]", "ed GeoJSON"), ("{}", "ed GeoJSON"), ('{"type": 3}', "ed GeoJSON"),
        (collection(), "nothing in it that has a place"), (collection(feature("Point", [])), "expected GeoJSON"),
        (collection(feature("Point", "ab")), "ed GeoJSON"), (collection(feature("Point", [{}, 1])), "ed GeoJSON"),
        (collection(feature("Curve", [1, 2])), "expected GeoJSON"), (collection(5), "expected GeoJSON"),
        (collection(feature("Point", [691603.0, 5334760.0])), "export it in WGS 84"),
        (collection(feature("Point", [10, 1e400])), "a.geojson"), (collection(feature("LineString", 7)), "ed GeoJSON"),
        (collection(feature("Point", [1, 10**400])), "a.geojson"),
        (collection(feature("Polygon", [SQUARE[:1]])), "nothing in it"),
    ],
)  # fmt: skip
def test_damaged_geojson_is_refused(tmp_path, content, says):
    assert says in refused(write(tmp_path / "a.geojson", content))


def test_geometries_within_geometries_end(tmp_path):
    inner = {"type": "Point", "coordinates": [1, 2]}
    for _ in range(20):
        inner = {"type": "GeometryCollection", "geometries": [inner]}
    assert "expected GeoJSON" in refused(write(tmp_path / "a.geojson", inner))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "not KML"), ("<kml>", "not KML"), ("<gpx/>", "expected KML, found 'gpx'"), (kml(""), "nothing in it"),
        (kml("<Placemark><Point><coordinates>here</coordinates></Point></Placemark>"), "lon,lat"),
        (kml("<Placemark><Point/></Placemark>"), "nothing in it"),
        (kml("", '<!DOCTYPE kml [<!ENTITY a "b">]>'), "declares a document type"),
        (kml("<Placemark><Point><coordinates>500,22</coordinates></Point></Placemark>"), "degrees"),
    ],
)  # fmt: skip
def test_damaged_kml_is_refused(tmp_path, content, says):
    assert says in refused(write(tmp_path / "a.kml", content))


def test_archives_without_kml_and_other_files_are_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.kmz", "w") as archive:
        archive.writestr("photo.jpg", b"x")
    assert "no KML in it" in refused(tmp_path / "a.kmz")
    assert "no zip archive" in refused(write(tmp_path / "b.kmz", "hello"))
    assert "expected a file of .geojson" in refused(write(tmp_path / "a.shp", "x"))
    assert "no such file" in refused(tmp_path / "none.kml")


def test_more_points_than_can_be_drawn_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "MAX_POINTS", 10)
    many = [[0.001 * i, 0.0] for i in range(11)]
    assert "more than 10 points" in refused(write(tmp_path / "a.geojson", collection(feature("LineString", many))))
    text = " ".join(f"{lon},{lat}" for lon, lat in many)
    placemark = f"<Placemark><LineString><coordinates>{text}</coordinates></LineString></Placemark>"
    assert "more than 10 points" in refused(write(tmp_path / "a.kml", kml(placemark)))


json_values = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["type", "coordinates", "features", "geometry", "geometries"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)


@given(json_values)
def test_any_json_is_an_overlay_or_refused(tmp_path_factory, content):
    path = write(tmp_path_factory.getbasetemp() / "any.geojson", content)
    with contextlib.suppress(InputError):
        read_overlay(path)


def geotiff(path, bands, crs="EPSG:25832", place=(690_000.0, 5_336_000.0), step_m=2.0, **options):
    import rasterio

    count, height, width = bands.shape
    with rasterio.open(
        path, "w", driver="GTiff", height=height, width=width, count=count, dtype=bands.dtype, crs=crs,
        transform=rasterio.Affine(step_m, 0.0, place[0], 0.0, -step_m, place[1]), **options,
    ) as target:  # fmt: skip
        target.write(bands)
    return path


def test_geotiff_lies_where_it_belongs(tmp_path):
    """A picture in UTM, brought to the map's projection: its corners by pyproj, a red quarter in its upper left."""
    from pyproj import Transformer

    bands = np.full((3, 200, 300), 90, np.uint8)
    bands[0, :100, :150] = 220
    picture = read_overlay(geotiff(tmp_path / "a.tif", bands)).picture
    lon, lat = Transformer.from_crs(25832, 4326, always_xy=True).transform(
        [690_000.0, 690_600.0], [5_336_000.0, 5_335_600.0]
    )
    corners = world_from_geodetic(lat, lon)
    size = np.subtract(picture.high, picture.low)
    assert picture.low == pytest.approx(corners[0], abs=0.05 * size.max())
    assert picture.high == pytest.approx(corners[1], abs=0.05 * size.max())
    height, width, _ = picture.rgba.shape
    assert picture.rgba[height // 4, width // 4].tolist() == [220, 90, 90, 255]
    assert picture.rgba[3 * height // 4, 3 * width // 4].tolist() == [90, 90, 90, 255]
    # The grid of UTM is turned against the map: beyond its edge there is nothing.
    assert picture.rgba[0, 0, 3] == 0


def test_heights_become_shades_and_large_pictures_are_shrunk(tmp_path):
    heights = np.tile(np.linspace(100.0, 200.0, 5000, dtype=np.float32), (1, 400, 1))
    heights[0, :100] = -9999.0
    path = geotiff(tmp_path / "a.tif", heights, nodata=-9999.0, tiled=True)
    rgba = read_overlay(path).picture.rgba
    assert max(rgba.shape) == module.MAX_PICTURE_PX
    row = rgba[len(rgba) // 2]
    assert (np.diff(row[row[:, 3] > 0][20:-20, 0].astype(int)) >= 0).all()
    seen = rgba[rgba[..., 3] > 0]
    assert seen[:, 0].min() == 0
    assert seen[:, 0].max() == 255
    # A quarter has no heights, and more is beyond the turned edge.
    assert 0.3 < len(seen) / rgba[..., 3].size < 0.75


def test_geotiff_that_cannot_be_shown_is_refused(tmp_path, monkeypatch):
    bands = np.zeros((1, 16, 16), np.uint8)
    assert "does not say where it lies" in refused(geotiff(tmp_path / "a.tif", bands, crs=None))
    assert "no such file" in refused(tmp_path / "none.tif")
    assert "not a GeoTIFF" in refused(write(tmp_path / "b.tif", "hello"))
    whole = geotiff(tmp_path / "c.tif", bands)
    content = whole.read_bytes()
    told = []
    for share in (0.2, 0.5, 0.9):
        (tmp_path / "d.tif").write_bytes(content[: int(share * len(content))])
        try:
            read_overlay(tmp_path / "d.tif")
        except InputError as error:
            told.append(str(error))
    assert told
    assert not any("exception" in text or "details" in text for text in told)
    polar = geotiff(tmp_path / "e.tif", bands, "EPSG:4326", (0.0, 90.0), 0.01)
    assert "beyond the end of web maps" in refused(polar)
    monkeypatch.setattr(module, "MAX_BLOCK_BYTES", 100)
    assert "tiled GeoTIFF" in refused(whole)


def test_swapped_axes_are_found_out_where_they_are_no_places_and_are_undone_where_they_are(tmp_path):
    wrong = [[lat, lon] for lon, lat in SQUARE]
    path = write(tmp_path / "a.geojson", {"type": "LineString", "coordinates": wrong})
    found = read_overlay(path)
    assert found.is_swapped, "114 degrees is no latitude"
    right = read_overlay(write(tmp_path / "b.geojson", {"type": "LineString", "coordinates": SQUARE}))
    assert not right.is_swapped
    np.testing.assert_allclose(found.extent(), right.extent())
    low = read_overlay(
        write(tmp_path / "c.geojson", {"type": "LineString", "coordinates": [[48.1, 11.5], [48.2, 11.5]]})
    )
    assert not low.is_swapped
    assert distance_m(low.extent(), 48.15, 11.5) > 1e6
    assert distance_m(low.swapped().extent(), 48.15, 11.5) == 0.0
    np.testing.assert_allclose(low.swapped().swapped().extent(), low.extent(), atol=1e-12)


def test_the_distance_of_an_overlay_counts_from_its_rectangle_and_over_the_date_line(tmp_path):
    line = {"type": "LineString", "coordinates": [[179.9, 0.0], [179.95, 0.0]]}
    found = read_overlay(write(tmp_path / "d.geojson", line))
    assert distance_m(found.extent(), 0.0, -179.95) == pytest.approx(0.1 * 111_319.5, rel=1e-3)
    assert distance_m(found.extent(), 0.0, 179.92) == 0.0
