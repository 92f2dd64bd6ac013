"""PMTiles files: a published one, the places of tiles, directories of every shape, and damaged and hostile files."""

import base64
import contextlib
import gzip
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.map.tile_source import MAX_VECTOR_BYTES, gunzipped, unzstd
from groundstation.services.map.tiles import (
    HEADER,
    MAX_DIRECTORY_BYTES,
    MapTiles,
    PmTiles,
    open_map_file,
    read_directory,
    tile_id,
)
from groundstation.services.map.varints import read_varints, zigzag
from groundstation.services.map.vector_tiles import decode_vector_tile
from groundstation.services.map.web_mercator import Tile
from planning.base.errors import InputError
from tests.services.map_files import (
    directory,
    picture,
    square,
    tiles_around,
    varint,
    vector_layer,
    write_map,
    write_pmtiles,
)

PUBLISHED = base64.b64decode(
    "UE1UaWxlcwN/AAAAAAAAABkAAAAAAAAAmAAAAAAAAAD3AAAAAAAAAAAAAAAAAAAAAAAAAAAAAACPAQAAAAAAAEUAAAAAAAAAAQAAAAAAAAAB"
    "AAAAAAAAAAEAAAAAAAAAAAICAQAAAAAAAAAAAAB/lpgAgJaYAAAAAAAAAAAAAB+LCAAAAAAAAhNjZGB0ZQQATD+JAAUAAAAfiwgAAAAAAAIT"
    "fU/LboMwELznK6w9AyWReum1P9B7hZBjFmQJe5G9RCHI/x7bSRv6UI4zOzuPdQdWGoQ3AYye216feXbY7qvJsB7RQ7GDDr1yemJN9rnwhM7f"
    "RYeEeZmyNcXDKJdEDWjRSSaXnfQ0oZKWUJwO1WtV/1C0lCN9UlYvG215GURJ4v8eoix7cgpvfVTyidGxWLT5FKsA3f0d8b1B/B6bKKPthchE"
    "WCckzxvUaxy75L0GEURTQDZiyZmDHP1Os+UI9wU8qtxvT7qAevwNSAbZLUn+QeMyxHYFSGanjzPjV0K94XJKE5oQrptsCtvlAQAAH4sIAAAA"
    "AAACE5PSr2DiEi1JLS6JT8usKCktSo03LMgtycxJLdZoUBASlGBW4uWcpvBCXopBQpSBQZwfAJf6ay0xAAAA"
)
"""js/test/data/test_fixture_1.pmtiles of github.com/protomaps/PMTiles (BSD-3-Clause), by tippecanoe: a square of one
degree in one tile."""


@pytest.fixture
def opened():
    with contextlib.ExitStack() as stack:
        yield lambda path: stack.enter_context(contextlib.closing(PmTiles(path)))


def refused(path):
    with pytest.raises(InputError) as caught:
        PmTiles(path)
    assert str(path) in str(caught.value)
    return str(caught.value)


def test_a_published_file_is_read(opened, tmp_path):
    path = tmp_path / "a.pmtiles"
    path.write_bytes(PUBLISHED)
    source = opened(path)
    info = source.info
    assert (info.name, info.image_format, info.min_zoom, info.max_zoom) == ("test_fixture_1.pmtiles", "pbf", 0, 0)
    assert info.bounds_deg == pytest.approx((0.0, 0.0, 1.0, 1.0), abs=1e-6)
    (layer,) = decode_vector_tile(source.image(Tile(0, 0, 0)))
    assert layer.name == "test_fixture_1pmtiles"
    (ring,) = layer.parts(0)
    # A degree at the equator is 1 / 360 of the world.
    assert ring.min(axis=0) == pytest.approx([0.5, 0.5 - 1 / 360], abs=2e-4)
    assert ring.max(axis=0) == pytest.approx([0.5 + 1 / 360, 0.5], abs=2e-4)


@pytest.mark.parametrize(
    ("tile", "number"),
    [((0, 0, 0), 0), ((1, 0, 0), 1), ((1, 0, 1), 2), ((1, 1, 1), 3), ((1, 1, 0), 4), ((2, 0, 0), 5),
     ((12, 3423, 1763), 19078479)],
)  # fmt: skip
def test_numbers_of_tiles_are_those_of_the_specification(tile, number):
    assert tile_id(Tile(*tile)) == number


@pytest.mark.parametrize("zoom", [1, 2, 5])
def test_the_curve_visits_every_tile_of_a_level_and_steps_to_neighbours(zoom):
    places = {tile_id(Tile(zoom, x, y)): (x, y) for x in range(2**zoom) for y in range(2**zoom)}
    first = (4**zoom - 1) // 3
    assert sorted(places) == list(range(first, first + 4**zoom))
    path = np.array([places[number] for number in sorted(places)])
    assert (np.abs(np.diff(path, axis=0)).sum(axis=1) == 1).all()


@given(st.lists(st.integers(0, 2**64 - 1), max_size=50))
def test_integers_come_back_as_they_were_written(numbers):
    assert read_varints(b"".join(map(varint, numbers))).tolist() == numbers


@given(st.lists(st.integers(-(2**62), 2**62), max_size=20))
def test_signed_integers_come_back_as_they_were_written(numbers):
    coded = np.array([(number << 1) ^ (number >> 63) for number in numbers], np.uint64)
    assert zigzag(coded).tolist() == numbers


@given(st.lists(st.tuples(st.integers(1, 9), st.integers(0, 3), st.integers(1, 50), st.integers(0, 99)), min_size=1))
def test_directories_come_back_as_they_were_written(steps):
    entries, number = [], 0
    for step, run_length, length, offset in steps:
        number += step + max(1, run_length)
        behind = entries[-1][2] + entries[-1][3] if entries else 0
        entries.append((number, run_length, length, behind if offset < 50 else offset))
    read = read_directory(directory(entries))
    columns = read.tile_ids, read.run_lengths, read.lengths, read.offsets
    assert list(zip(*(column.tolist() for column in columns), strict=True)) == entries
    for number, run_length, length, offset in entries:
        assert read.entry(number) == (run_length, length, offset)


def test_entries_end_with_their_run():
    read = read_directory(directory([(5, 3, 42, 1337), (100, 1, 1, 0)]))
    assert [read.entry(number) for number in (4, 5, 7, 8)] == [None, (3, 42, 1337), (3, 42, 1337), None]


@pytest.mark.parametrize("leaf_size", [0, 1, 7])
@pytest.mark.parametrize("compression", [1, 2])
def test_tiles_come_back_by_their_place(opened, tmp_path, leaf_size, compression):
    tiles = {tile: picture(tile) for tile in tiles_around(22.3, 114.2, (0, 3, 18), reach=1)}
    path = write_pmtiles(tmp_path / "a.pmtiles", tiles, leaf_size=leaf_size, compression=compression)
    source = opened(path)
    assert (source.info.image_format, source.info.min_zoom, source.info.max_zoom) == ("png", 0, 18)
    assert source.info.attribution == "© testers"
    for tile, content in tiles.items():
        assert source.image(tile) == content
    assert source.image(Tile(18, 0, 0)) is None
    assert source.image(Tile(19, 0, 0)) is None


def test_map_files_are_told_apart_by_what_is_in_them(tmp_path):
    tile = Tile(1, 0, 0)
    hidden = write_pmtiles(tmp_path / "a.map", {tile: picture(tile)})
    for path, kind in ((hidden, PmTiles), (write_map(tmp_path / "b.map", [tile]), MapTiles)):
        with contextlib.closing(open_map_file(path)) as source:
            assert isinstance(source, kind)
            assert source.image(tile) == picture(tile)


def test_what_is_no_map_is_refused_with_what_to_do(tmp_path):
    assert "no such file" in refused(tmp_path / "none.pmtiles")
    path = tmp_path / "a.pmtiles"
    for content, says in (
        (b"", "does not begin as one"),
        (b"PMTiles\x03" + bytes(20), "cut off"),
        (b"PMTiles\x02" + bytes(200), "version 2; convert"),
    ):
        path.write_bytes(content)
        assert says in refused(path)
    tile = Tile(1, 0, 0)
    assert "type 6" in refused(write_pmtiles(path, {tile: picture(tile)}, tile_type=6))
    assert "Brotli" in refused(write_pmtiles(path, {tile: picture(tile)}, tile_compression=3))
    assert "the file says png" in refused(write_pmtiles(path, {tile: b"GIF89a"}))
    assert "0 to 24" in refused(write_pmtiles(path, {tile._replace(zoom=30): picture(tile)}))


def changed(path, number, value):
    """The file with another number in its header."""
    head = list(HEADER.unpack(path.read_bytes()[: HEADER.size]))
    head[2 + number] = value
    path.write_bytes(HEADER.pack(*head) + path.read_bytes()[HEADER.size :])
    return path


@pytest.mark.parametrize("number", range(8))
@pytest.mark.parametrize("value", [2**40, 2**64 - 1])
def test_places_outside_the_file_are_refused_or_leave_holes(tmp_path, number, value):
    tiles = {Tile(2, x, y): picture(Tile(2, x, y)) for x in range(4) for y in range(4)}
    path = changed(write_pmtiles(tmp_path / "a.pmtiles", tiles, leaf_size=4), number, value)
    with contextlib.suppress(InputError), contextlib.closing(PmTiles(path)) as source:
        for tile, content in tiles.items():
            assert source.image(tile) in (None, content)


def test_directories_that_lead_to_themselves_end(tmp_path):
    tile = Tile(1, 0, 0)
    path = write_pmtiles(tmp_path / "a.pmtiles", {tile: picture(tile)}, leaf_size=1, compression=1)
    content = path.read_bytes()
    numbers = HEADER.unpack(content[: HEADER.size])
    # The leaf directory is replaced by one that points at itself.
    leaf = directory([(1, 0, numbers[7], 0)])
    assert len(leaf) <= numbers[7]
    path.write_bytes(content[: numbers[6]] + leaf + content[numbers[6] + len(leaf) :])
    assert "damaged" in refused(path)


def test_bombs_are_not_unpacked(opened, tmp_path):
    bomb = gzip.compress(bytes(MAX_VECTOR_BYTES + 1))
    good = gzip.compress(vector_layer("water", [(3, square(0, 9), {})]))
    tiles = {Tile(1, 0, 0): good, Tile(1, 1, 1): bomb}
    source = opened(write_pmtiles(tmp_path / "a.pmtiles", tiles, tile_type=1, tile_compression=2))
    assert source.image(Tile(1, 0, 0)) is not None
    assert source.image(Tile(1, 1, 1)) is None
    root = gzip.compress(bytes(MAX_DIRECTORY_BYTES + 1))
    head = list(HEADER.unpack(PUBLISHED[: HEADER.size]))
    head[2:4] = HEADER.size, len(root)
    (tmp_path / "b.pmtiles").write_bytes(HEADER.pack(*head) + root)
    assert "damaged" in refused(tmp_path / "b.pmtiles")


def test_compressed_parts_are_bounded_and_whole_or_nothing():
    from backports import zstd

    for pack, unpack in ((gzip.compress, gunzipped), (zstd.compress, unzstd)):
        packed = pack(b"x" * 1000)
        assert unpack(packed, 1000) == b"x" * 1000
        assert unpack(packed, 999) is None
        assert unpack(packed[:-3], 1000) is None
        assert unpack(b"nonsense", 1000) is None


def test_flipped_bytes_never_break_the_reader(tmp_path):
    tiles = {Tile(3, x, y): picture(Tile(3, x, y), size=16) for x in range(8) for y in range(4)}
    path = write_pmtiles(tmp_path / "a.pmtiles", tiles, leaf_size=5, compression=1)
    content = path.read_bytes()
    end = struct.unpack_from("<Q", content, 56)[0]
    random = np.random.default_rng(7)
    n_opened = 0
    for _ in range(150):
        damaged = bytearray(content)
        for place in random.integers(8, end, int(random.integers(1, 6))):
            damaged[place] = int(random.integers(256))
        path.write_bytes(damaged)
        with contextlib.suppress(InputError), contextlib.closing(PmTiles(path)) as source:
            n_opened += 1
            for tile in tiles:
                source.image(tile)
    assert 0 < n_opened < 150


def test_after_close_there_are_no_tiles(tmp_path):
    tile = Tile(1, 0, 0)
    source = PmTiles(write_pmtiles(tmp_path / "a.pmtiles", {tile: picture(tile)}))
    source.close()
    assert source.image(tile) is None
