"""Mapbox Vector Tiles, version 2.1: layers of points, lines and polygons with properties, in a Protocol Buffer.

Field numbers are those of vector_tile.proto: Tile { 3 layers }, Layer { 1 name, 2 features, 3 keys, 4 values,
5 extent, 15 version }, Feature { 1 id, 2 tags, 3 type, 4 geometry }. Geometries are commands and parameters (section
4.3): MoveTo, LineTo and ClosePath, each with a count, and steps from point to point.

All geometries of a layer are decoded in one go, for a step of Python each would take seconds. Nothing in a tile is
trusted: what does not fit the format ends it, and no more is made of it than it has bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.tile_source import GZIP, MAX_VECTOR_BYTES, gunzipped
from groundstation.services.map.varints import read_varints, zigzag

EXTENT = 4096
"""Width of a tile in its own units, where it does not say (section 4.1)."""

MAX_LAYERS = 200

MAX_FEATURES = 200_000
"""Of a layer; tiles of a large city have some 20 000."""

FARTHEST = 8
"""Widths of a tile beyond which a coordinate is damage: makers of tiles keep to a margin of a tenth."""

MOVE_TO, LINE_TO, CLOSE_PATH = 1, 2, 7

Value = str | float | int | bool


class Geometry(IntEnum):
    """Section 4.3.4."""

    UNKNOWN = 0
    POINT = 1
    LINE = 2
    POLYGON = 3


@dataclass(frozen=True, slots=True, eq=False)
class VectorLayer:
    """Features of a layer of f features and p parts.

    A part is a line, a ring, or the points of a feature, as many as there are.

    Parameters
    ----------
    points
        All points, shape (n, 2), right and down, 0 to 1 within the tile.
    part_ends
        Number of the point behind each part's last, shape (p,).
    feature_ends
        Number of the part behind each feature's last, shape (f,).
    """

    name: str
    points: NDArray[np.float64]
    part_ends: NDArray[np.int64]
    feature_ends: NDArray[np.int64]
    geometries: tuple[Geometry, ...]
    properties: tuple[dict[str, Value], ...]

    def parts(self, feature: int) -> list[NDArray[np.float64]]:
        """Points of each part of a feature, shape (k, 2)."""
        first = int(self.feature_ends[feature - 1]) if feature else 0
        last = int(self.feature_ends[feature])
        starts = np.concatenate([[0], self.part_ends])
        return [self.points[starts[i] : starts[i + 1]] for i in range(first, last)]


def decode_vector_tile(data: bytes, wanted: Collection[str] | None = None) -> tuple[VectorLayer, ...]:
    """Layers of a tile, compressed by gzip or not.

    Parameters
    ----------
    wanted
        Names of layers that are decoded; None for all.

    Raises
    ------
    ValueError
        It is no vector tile of version 1 or 2, or damaged.
    """
    if data.startswith(GZIP):
        unpacked = gunzipped(data, MAX_VECTOR_BYTES)
        if unpacked is None:
            raise ValueError(f"expected a compressed tile of at most {MAX_VECTOR_BYTES} bytes")
        data = unpacked
    layers = []
    for field, value in _fields(memoryview(data)):
        if field == 3:
            layer = _layer(_bytes(value), wanted)
            if layer is not None:
                layers.append(layer)
            if len(layers) > MAX_LAYERS:
                raise ValueError(f"expected at most {MAX_LAYERS} layers")
    return tuple(layers)


def _layer(data: memoryview, wanted: Collection[str] | None) -> VectorLayer | None:
    name: str | None = None
    extent, version = EXTENT, 1
    features: list[memoryview] = []
    keys: list[str] = []
    values: list[memoryview] = []
    for field, value in _fields(data):
        match field:
            case 1:
                name = _text(value)
                if wanted is not None and name not in wanted:
                    return None
            case 2:
                features.append(_bytes(value))
            case 3:
                keys.append(_text(value))
            case 4:
                values.append(_bytes(value))
            case 5:
                extent = _number(value)
            case 15:
                version = _number(value)
    if name is None or version not in (1, 2) or not 1 <= extent <= 2**24 or len(features) > MAX_FEATURES:
        raise ValueError("expected a layer with a name, an extent and version 1 or 2")
    if wanted is not None and name not in wanted:
        return None
    return _decoded(name, extent, features, keys, [_value(value) for value in values])


def _decoded(
    name: str, extent: int, features: list[memoryview], keys: list[str], values: list[Value | None]
) -> VectorLayer:
    kinds: list[Geometry] = []
    properties: list[dict[str, Value]] = []
    geometries: list[memoryview] = []
    for feature in features:
        tags, geometry, kind = memoryview(b""), memoryview(b""), 0
        for field, value in _fields(feature):
            if field == 2:
                tags = _bytes(value)
            elif field == 3:
                kind = _number(value)
            elif field == 4:
                geometry = _bytes(value)
        if kind not in (1, 2, 3) or not len(geometry):
            # Of unknown kind: others may draw it (section 4.3.4), and there is nothing to be drawn.
            continue
        kinds.append(Geometry(kind))
        properties.append(_properties(tags, keys, values))
        geometries.append(geometry)
    points, part_ends, feature_ends = _decoded_geometries(geometries)
    scaled = points / extent
    if len(scaled) and float(np.abs(scaled).max()) > FARTHEST:
        raise ValueError("expected points in the tile or near it")
    return VectorLayer(name, scaled, part_ends, feature_ends, tuple(kinds), tuple(properties))


def _properties(tags: memoryview, keys: list[str], values: list[Value | None]) -> dict[str, Value]:
    numbers = [int(number) for number in _small_varints(tags)]
    if len(numbers) % 2:
        raise ValueError("expected pairs of keys and values")
    found: dict[str, Value] = {}
    for key, value in zip(numbers[::2], numbers[1::2], strict=True):
        if key >= len(keys) or value >= len(values):
            raise ValueError("expected keys and values that the layer has")
        known = values[value]
        if known is not None:
            found[keys[key]] = known
    return found


def _decoded_geometries(
    geometries: list[memoryview],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Points, shape (n, 2), in units of the tile, and where parts and features end."""
    joined = b"".join(geometries)
    numbers = read_varints(joined)
    # Where each feature's numbers end: whole integers end with a byte below 128, which the last byte of each has to be.
    ends_byte = np.cumsum([len(geometry) for geometry in geometries], dtype=np.int64)
    is_last = np.frombuffer(joined, np.uint8) < 0x80
    if len(ends_byte) and not bool(is_last[ends_byte - 1].all()):
        raise ValueError("expected whole integers, found one that is cut off")
    ends = np.cumsum(is_last)[ends_byte - 1] if len(ends_byte) else np.zeros(0, np.int64)
    raw: list[int] = numbers.tolist()
    starts_of: list[int] = []
    counts: list[int] = []
    part_ends: list[int] = []
    feature_ends: list[int] = []
    first_points: list[int] = []
    at = n_points = 0
    for end in ends.tolist():
        first_points.append(n_points)
        is_open = False
        while at < end:
            command, count = raw[at] & 7, raw[at] >> 3
            at += 1
            if command == CLOSE_PATH:
                if count != 1 or not is_open:
                    raise ValueError("expected one ClosePath after a line")
                continue
            if command not in (MOVE_TO, LINE_TO) or count < 1 or at + 2 * count > end:
                raise ValueError("expected commands with as many points as they say")
            if command == MOVE_TO:
                if is_open:
                    part_ends.append(n_points)
                is_open = True
            elif not is_open:
                raise ValueError("expected a MoveTo first")
            starts_of.append(at)
            counts.append(2 * count)
            n_points += count
            at += 2 * count
        if is_open:
            part_ends.append(n_points)
        feature_ends.append(len(part_ends))
    if not counts:
        return np.zeros((0, 2), np.int64), np.array(part_ends, np.int64), np.array(feature_ends, np.int64)
    sizes = np.array(counts)
    within = np.arange(int(sizes.sum())) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    steps = zigzag(numbers[np.repeat(starts_of, sizes) + within]).reshape(-1, 2)
    # Steps add up from each feature's own zero. 32 bits are all that the format has: more is damage, and wraps nothing.
    if int(np.abs(steps).max()) >= 2**32:
        raise ValueError("expected steps of 32 bits")
    places = np.cumsum(steps, axis=0)
    before = np.vstack([np.zeros((1, 2), np.int64), places])[first_points]
    n_each = np.diff(np.append(first_points, n_points))
    points = places - np.repeat(before, n_each, axis=0)
    return points, np.array(part_ends, np.int64), np.array(feature_ends, np.int64)


# Protocol Buffers: fields with a number and one of four wire types.

_VARINT, _FIXED64, _LENGTH, _FIXED32 = 0, 1, 2, 5


def _fields(data: memoryview) -> Iterator[tuple[int, int | memoryview]]:
    """Number and value of each field: whole numbers, or bytes.

    Raises
    ------
    ValueError
        It is cut off, or has a wire type that is not known.
    """
    at, end = 0, len(data)
    while at < end:
        key, at = _varint(data, at)
        kind = key & 7
        if kind == _VARINT:
            number, at = _varint(data, at)
            yield key >> 3, number
            continue
        if kind == _LENGTH:
            length, at = _varint(data, at)
        elif kind in (_FIXED32, _FIXED64):
            length = 4 if kind == _FIXED32 else 8
        else:
            raise ValueError(f"expected a wire type of Protocol Buffers, found {kind}")
        if at + length > end:
            raise ValueError("expected a longer field")
        yield key >> 3, data[at : at + length]
        at += length


def _varint(data: memoryview, at: int) -> tuple[int, int]:
    number = shift = 0
    while at < len(data) and shift < 70:
        octet = data[at]
        number |= (octet & 0x7F) << shift
        at += 1
        if octet < 0x80:
            return number, at
        shift += 7
    raise ValueError("expected an integer, found one that is cut off or too long")


def _small_varints(data: memoryview) -> Iterator[int]:
    """As `read_varints`, and faster for a few."""
    at = 0
    while at < len(data):
        number, at = _varint(data, at)
        yield number


def _bytes(value: int | memoryview) -> memoryview:
    if isinstance(value, int):
        raise ValueError("expected bytes, found a number")
    return value


def _number(value: int | memoryview) -> int:
    if not isinstance(value, int):
        raise ValueError("expected a number, found bytes")
    return value


def _text(value: int | memoryview) -> str:
    return bytes(_bytes(value)).decode()


def _value(data: memoryview) -> Value | None:
    """Value of a property (Value: 1 string, 2 float, 3 double, 4 int, 5 uint, 6 sint, 7 bool); None for others."""
    found: Value | None = None
    for field, value in _fields(data):
        match field:
            case 1:
                found = _text(value)
            case 2 | 3:
                found = float(struct.unpack("<f" if field == 2 else "<d", _bytes(value))[0])
            case 4:
                number = _number(value)
                found = number - 2**64 if number >= 2**63 else number
            case 5:
                found = _number(value)
            case 6:
                number = _number(value)
                found = (number >> 1) ^ -(number & 1)
            case 7:
                found = bool(_number(value))
    return found
