"""Vector tiles: examples of the specification, published ones for damage, and what becomes of hostile ones."""

import gzip

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.map.map_style import LAYERS, ROADS, Role, ground_colour, road_class, role_of
from groundstation.services.map.tile_source import MAX_VECTOR_BYTES
from groundstation.services.map.vector_tiles import Geometry, decode_vector_tile
from tests.services.map_files import field, geometry, square, varint, vector_layer

# Worked examples of the specification 2.1, section 4.3.5, in units of the tile.
EXAMPLES = [
    (Geometry.POINT, [9, 50, 34], [[(25, 17)]]),
    (Geometry.POINT, [17, 10, 14, 3, 9], [[(5, 7), (3, 2)]]),
    (Geometry.LINE, [9, 4, 4, 18, 0, 16, 16, 0], [[(2, 2), (2, 10), (10, 10)]]),
    (
        Geometry.LINE,
        [9, 4, 4, 18, 0, 16, 16, 0, 9, 17, 17, 10, 4, 8],
        [[(2, 2), (2, 10), (10, 10)], [(1, 1), (3, 5)]],
    ),
    (Geometry.POLYGON, [9, 6, 12, 18, 10, 12, 24, 44, 15], [[(3, 6), (8, 12), (20, 34)]]),
]


@pytest.mark.parametrize(("kind", "numbers", "expected"), EXAMPLES)
def test_examples_of_the_specification(kind, numbers, expected):
    commands = b"".join(map(varint, numbers))
    (layer,) = decode_vector_tile(vector_layer("a", [(1, varint(9) + varint(2) + varint(2), {}), (kind, commands, {})]))
    assert layer.geometries[1] is kind
    assert [np.rint(part * 4096).astype(int).tolist() for part in layer.parts(1)] == [
        [list(point) for point in part] for part in expected
    ]


lines = st.lists(st.tuples(st.integers(-4000, 8000), st.integers(-4000, 8000)), min_size=2, max_size=30)


@given(st.lists(st.lists(lines, min_size=1, max_size=4), min_size=1, max_size=6), st.sampled_from([1024, 4096, 10_000]))
def test_lines_come_back_as_they_were_written(features, extent):
    written = [(2, geometry(parts), {"n": str(i)}) for i, parts in enumerate(features)]
    (layer,) = decode_vector_tile(gzip.compress(vector_layer("a", written, extent)))
    for number, parts in enumerate(features):
        assert layer.properties[number] == {"n": str(number)}
        read = layer.parts(number)
        assert [np.rint(part * extent).astype(int).tolist() for part in read] == [
            [list(point) for point in part] for part in parts
        ]


def test_layers_that_are_not_wanted_are_passed_over():
    tile = vector_layer("poi", [(1, b"\xff", {})]) + vector_layer("water", [(3, square(0, 9), {})])
    assert [layer.name for layer in decode_vector_tile(tile, {"water"})] == ["water"]
    with pytest.raises(ValueError, match="cut off"):
        decode_vector_tile(tile)


def test_features_of_unknown_kind_or_without_geometry_are_left_out():
    (layer,) = decode_vector_tile(vector_layer("a", [(0, square(0, 9), {}), (3, b"", {}), (3, square(0, 9), {})]))
    assert layer.geometries == (Geometry.POLYGON,)


@pytest.mark.parametrize(
    ("damaged", "says"),
    [
        (vector_layer("a", [(1, varint(15), {})]), "ClosePath"),
        (vector_layer("a", [(2, varint(10) + bytes(2), {})]), "MoveTo first"),
        (vector_layer("a", [(1, varint(9) + bytes(1), {})]), "as many points"),
        (vector_layer("a", [(1, varint(2**31 << 3 | 1) + bytes(9), {})]), "as many points"),
        (vector_layer("a", [(3, square(0, 9)[:-1] + varint(7), {})]), "ClosePath"),
        (vector_layer("a", [(2, geometry([[(0, 0), (2**30, 0)]]), {})]), "near it"),
        (vector_layer("a", [(2, geometry([[(0, 0), (2**60, 0)]]), {})]), "32 bits"),
        (vector_layer("a", [(2, b"\x80" * 11 + b"\x01", {})]), "at most 10 bytes"),
        (vector_layer("a", [(2, b"\x80", {}), (2, b"\x01", {})]), "cut off"),
        (vector_layer("a", [], version=3), "version 1 or 2"),
        (vector_layer("a", [], extent=0), "extent"),
        (field(3, field(15, 2)), "a name"),
        (field(3, 5), "found a number"),
        (field(3, field(1, b"a") + field(2, field(2, bytes(1)) + field(3, 1) + field(4, b"\x09\x00\x00"))), "pairs"),
        (field(3, field(1, b"a") + field(2, field(2, bytes(2)) + field(3, 1) + field(4, b"\x09\x00\x00"))), "has"),
        (field(3, b"a")[:-1], "longer field"),
        (b"\x0b", "wire type"),
        (b"\x80", "cut off"),
        (gzip.compress(bytes(MAX_VECTOR_BYTES + 1), mtime=0), "compressed"),
        (gzip.compress(b"abc", mtime=0)[:-5], "compressed"),
    ],
)
def test_damaged_tiles_are_refused(damaged, says):
    with pytest.raises(ValueError, match=says):
        decode_vector_tile(damaged)


def test_flipped_bytes_never_break_the_reader():
    features = [(2, geometry([[(i, 0), (9, i), (50, 60)]]), {"class": "street", "n": str(i)}) for i in range(20)]
    content = vector_layer("road", features) + vector_layer("water", [(3, square(0, 4096), {})])
    random = np.random.default_rng(5)
    n_read = 0
    for _ in range(300):
        damaged = bytearray(content)
        for place in random.integers(0, len(damaged), int(random.integers(1, 4))):
            damaged[place] = int(random.integers(256))
        try:
            decode_vector_tile(bytes(damaged))
            n_read += 1
        except ValueError:
            pass
    assert 0 < n_read < 300


@pytest.mark.parametrize(
    ("layer", "properties", "role"),
    [
        ("transportation", {"class": "primary"}, Role.ROAD),
        ("transportation", {"class": "rail"}, Role.RAIL),
        ("roads", {"kind": "minor_road", "kind_detail": "residential"}, Role.ROAD),
        ("roads", {"kind": "rail"}, Role.RAIL),
        ("streets", {"kind": "motorway"}, Role.ROAD),
        ("road", {"class": "major_rail", "type": "subway"}, Role.RAIL),
        ("transportation", {"class": "ferry"}, None),
        ("landuse", {"class": "school"}, Role.LAND),
        ("landuse", {"class": "unheard of"}, None),
        ("water_polygons", {}, Role.WATER),
        ("buildings", {}, Role.BUILDING),
        ("poi", {"class": "shop"}, None),
    ],
)
def test_features_of_the_common_layouts_are_known(layer, properties, role):
    assert role_of(layer, properties) is role


def test_style_is_whole():
    assert set(LAYERS.values()) == set(Role) - {Role.RAIL}
    widths = [road.width_m for road in sorted(set(ROADS.values()), key=lambda road: road.rank)]
    assert widths == sorted(widths)
    assert road_class({"kind": "major_road", "kind_detail": "trunk"}).rank > road_class({"kind": "major_road"}).rank
    assert ground_colour({"class": "wood"}) != ground_colour({"class": "sand"})
