"""MBTiles files: good, lying, damaged and hostile ones."""

import contextlib
import gzip
import itertools
import sqlite3

import cv2
import numpy as np
import pytest

from groundstation.services.map.tiles import MAX_TILE_BYTES, MapTiles
from groundstation.services.map.web_mercator import Tile
from planning.base.errors import InputError
from tests.services.map_files import colour_of, picture, square, tiles_around, vector_layer, write_map


@pytest.fixture
def opened():
    with contextlib.ExitStack() as stack:
        yield lambda path: stack.enter_context(contextlib.closing(MapTiles(path)))


def refused(path):
    with pytest.raises(InputError) as caught:
        MapTiles(path)
    assert str(path) in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("ending", [".png", ".jpg", ".webp"])
def test_tiles_come_back_by_their_place_counted_from_the_north(opened, tmp_path, ending):
    tiles = tiles_around(22.3372, 114.2636, (0, 3, 18), reach=1)
    source = opened(write_map(tmp_path / "hk.mbtiles", tiles, ending=ending))
    assert source.info.image_format == ending[1:]
    assert (source.info.min_zoom, source.info.max_zoom) == (0, 18)
    for tile in tiles:
        pixels = cv2.imdecode(np.frombuffer(source.image(tile), np.uint8), cv2.IMREAD_COLOR)
        assert np.abs(pixels[128, 128, ::-1].astype(int) - colour_of(tile)).max() <= 3
    assert source.image(Tile(18, 0, 0)) is None
    assert source.image(Tile(19, 0, 0)) is None


def test_metadata_is_read_and_cleaned(opened, tmp_path):
    facts = {
        "name": "Site\x07 map",
        "format": "png",
        "bounds": "114.0,22.0,115.0,23.0",
        "attribution": '<a href="https://example.org">&copy; Mappers</a>',
    }
    info = opened(write_map(tmp_path / "a.mbtiles", [Tile(4, 1, 1)], facts)).info
    assert (info.name, info.attribution) == ("Site map", "© Mappers")
    assert info.bounds_deg == (114.0, 22.0, 115.0, 23.0)


@pytest.mark.parametrize("bounds", ["", "a,b,c,d", "1,2,3", "nan,0,1,1", "10,0,5,1", "0,-91,1,1", "0,0,inf,1"])
def test_bounds_that_are_no_area_are_left_out(opened, tmp_path, bounds):
    facts = {"format": "png", "bounds": bounds}
    info = opened(write_map(tmp_path / "a.mbtiles", [Tile(4, 1, 1)], facts)).info
    assert info.bounds_deg is None
    assert info.name == "a"


def test_levels_are_those_of_the_tiles_whatever_the_metadata_says(opened, tmp_path):
    facts = {"format": "png", "minzoom": "0", "maxzoom": "99"}
    info = opened(write_map(tmp_path / "a.mbtiles", [Tile(4, 1, 1), Tile(6, 1, 1)], facts)).info
    assert (info.min_zoom, info.max_zoom) == (4, 6)


def test_vector_tiles_are_known_by_what_they_are(opened, tmp_path):
    tile = gzip.compress(vector_layer("water", [(3, square(0, 4096), {})]))
    for name, stated in (("v.mbtiles", "pbf"), ("w.mbtiles", "png")):
        source = opened(write_map(tmp_path / name, {Tile(1, 0, 0): tile}, {"format": stated}))
        assert source.info.is_vector
        assert source.image(Tile(1, 0, 0)) == tile
        assert source.info.levels == (1, 24)


def test_no_map_is_refused(tmp_path):
    assert "no such file" in refused(tmp_path / "none.mbtiles")
    assert "no such file" in refused(tmp_path)
    for name, content in {"empty": b"", "text": b"hello world " * 100, "zip": b"PK\x03\x04" * 50}.items():
        path = tmp_path / name
        path.write_bytes(content)
        assert "not a map in MBTiles format" in refused(path)
    assert "no tiles" in refused(write_map(tmp_path / "bare.mbtiles", []))
    unknown = write_map(tmp_path / "u.mbtiles", {Tile(1, 0, 0): b"GIF89a"}, {"format": "gif"})
    assert "the file says 'gif'" in refused(unknown)


def test_another_database_is_refused(tmp_path):
    path = tmp_path / "a.sqlite"
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("CREATE TABLE birds (name TEXT)")
    assert "no such table" in refused(path)


def test_levels_that_cannot_be_are_refused(tmp_path):
    path = tmp_path / "a.mbtiles"
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("CREATE TABLE metadata (name TEXT, value TEXT)")
        connection.execute("CREATE TABLE tiles (zoom_level, tile_column, tile_row, tile_data)")
        connection.execute("INSERT INTO tiles VALUES ('many', 0, 0, x'00')")
    assert "zoom levels" in refused(path)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.95])
def test_a_file_cut_off_anywhere_is_refused_or_has_holes_but_never_breaks(tmp_path, share):
    tiles = tiles_around(50.0, 8.0, (10, 12), reach=3)
    path = write_map(tmp_path / "a.mbtiles", tiles)
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * share)])
    with contextlib.suppress(InputError), contextlib.closing(MapTiles(path)) as source:
        for tile in tiles:
            source.image(tile)


def test_flipped_bytes_never_break_the_reader(tmp_path):
    tiles = tiles_around(50.0, 8.0, (10,), reach=1)
    content = bytearray(write_map(tmp_path / "a.mbtiles", tiles).read_bytes())
    random = np.random.default_rng(3)
    for trial in range(60):
        damaged = bytearray(content)
        for place in random.integers(16, len(damaged), 40):
            damaged[place] = int(random.integers(256))
        path = tmp_path / f"{trial}.mbtiles"
        path.write_bytes(damaged)
        with contextlib.suppress(InputError), contextlib.closing(MapTiles(path)) as source:
            for tile in tiles:
                source.image(tile)


def test_a_huge_tile_is_no_tile(opened, tmp_path):
    huge = picture(Tile(2, 0, 0)) + bytes(MAX_TILE_BYTES)
    source = opened(write_map(tmp_path / "a.mbtiles", {Tile(1, 0, 0): picture(Tile(1, 0, 0)), Tile(2, 0, 0): huge}))
    assert source.image(Tile(1, 0, 0)) is not None
    assert source.image(Tile(2, 0, 0)) is None


def test_a_tile_that_is_no_bytes_is_no_tile(opened, tmp_path):
    path = write_map(tmp_path / "a.mbtiles", [Tile(1, 0, 0)])
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("INSERT INTO tiles VALUES (1, 1, 1, 'text'), (1, 1, 0, NULL)")
    source = opened(path)
    assert source.image(Tile(1, 1, 0)) is None
    assert source.image(Tile(1, 1, 1)) is None


def test_a_query_that_never_ends_is_ended(tmp_path):
    path = tmp_path / "a.mbtiles"
    endless = (
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS zoom_level, 0 AS tile_column, "
    )
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("CREATE TABLE metadata (name TEXT, value TEXT)")
        connection.execute(f"CREATE VIEW tiles AS {endless} 0 AS tile_row, x'00' AS tile_data FROM n WHERE i < 0")
    ticks = itertools.count()
    with pytest.raises(InputError, match="takes more than 2 s"):
        MapTiles(path, clock=lambda: 0.1 * next(ticks))


def test_the_file_and_its_folder_are_left_as_they_were(opened, tmp_path):
    path = write_map(tmp_path / "odd name?#%.mbtiles", [Tile(1, 0, 0)])
    before = path.read_bytes()
    path.chmod(0o444)
    source = opened(path)
    assert source.image(Tile(1, 0, 0)) is not None
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_after_close_there_are_no_tiles(tmp_path):
    source = MapTiles(write_map(tmp_path / "a.mbtiles", [Tile(1, 0, 0)]))
    source.close()
    assert source.image(Tile(1, 0, 0)) is None
