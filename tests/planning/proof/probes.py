"""Questions to the parts of the verifier, each with a definite answer: what tampered files alone seldom reach.

Limits of numbers, damaged meshes and texts, degenerate triangles, borders of angles, and flights of every length.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from random import Random
from types import ModuleType
from typing import Any

JSON_TEXTS = (
    b'{"a": [1, 2.5e3, -0, "x\\u00e9\\n\\/"], "b": null, "c": {"d": true}}',
    *(b"[1,]", b"01", b"-", b'"\\ud800"', b"NaN", b"[Infinity]", b"[1e400]", b"1e299", b"1e300", b"-1e300", b"[1] x"),
    *(b'{"a": 1, "a": 2}', b"\t[true, false]\r\n", b'{"__proto__": 1}', b'"\x01"', b"''", b"1.", b".5", b"+1", b"1E5"),
    *(
        b"[1 2]",
        b'{"a" 1}',
        b"",
        b"[" + b"9" * 400 + b"]",
        b"\xef\xbb\xbf{}",
        b'"\xc3\xa9"',
        b'"\xff"',
        b'"\xed\xa0\x80"',
        b"\x00",
    ),
    *(b'"\xf0\x9f\x98\x80"', b'"\xc0\xaf"', b'"\\ud83d\\ude00"', b"nul", b"truex", b'"\\x41"', b'"\\u12"', b"1e-400"),
    *(b"[" * depth + b"]" * depth for depth in (63, 800, 100_000)),
    *(b'{"a": ' * depth + b"1" + b"}" * depth for depth in (64, 400)),
    *(b"123456789012345678901234567890", b"0.1e1", b"[0x10]", b"1_000", "\u0663".encode(), b"\xa0[]", b"\x0b[]"),
    *(b'{"a":1,}', b"{,}", b"{1:2}", b'"', b'"\\', b"[", b"{", b'{"a', b"\x7f"),
)
"""Texts that readers of JSON take differently."""

VALUES = (
    None,
    True,
    0.0,
    -0.0,
    1e6,
    1000000.1,
    -1e6,
    -1000000.1,
    2.5,
    1,
    "1",
    [],
    {},
    math.nan,
    math.inf,
    3.0,
    4.0,
    -1.0,
)

ANGLES = (*(k * 7.5 for k in range(-60, 61)), 45.0000001, 44.9999999, 359.99999, 1e-9, 720.0)


def _ply(kind: str, vertices: bytes, faces: bytes, n_vertices: int = 4, n_faces: int = 1, more: str = "") -> bytes:
    head = f"ply\nformat binary_little_endian 1.0\n{more}element vertex {n_vertices}\n"
    head += "".join(f"property {kind} {axis}\n" for axis in "xyz")
    head += f"element face {n_faces}\nproperty list uchar int vertex_indices\nend_header\n"
    return head.encode() + vertices + faces


def meshes() -> Iterator[bytes]:
    """Meshes that are right, cut off, too long, or name what is not there."""
    import struct

    corners = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.5, 0.0, 1.0, 99999.0)
    single, double = struct.pack("<12f", *corners), struct.pack("<12d", *corners)
    quad, triangle = struct.pack("<B4I", 4, 0, 1, 2, 3), struct.pack("<B3I", 3, 0, 1, 2)
    yield _ply("float", single, quad)
    yield _ply("double", double, triangle, more="comment made by hand\n")
    yield _ply("float", single, quad + triangle, n_faces=2)
    for faces in (quad[:-1], quad + b"\0", b"", struct.pack("<B2I", 2, 0, 1), struct.pack("<B3I", 3, 0, 1, 4)):
        yield _ply("float", single, faces)
    yield _ply("float", single[:-4], triangle)
    yield _ply("float", single, triangle, n_vertices=5)
    yield _ply("float", single, b"", n_faces=0)
    for z in (1e5, -1e5, 100000.5, -100000.5, 150000.0, math.inf, math.nan):
        yield _ply("float", struct.pack("<12f", *corners[:-1], z), triangle)
    yield _ply("half", single, triangle)
    yield b"ply\nend_header\n"


def _answer(ask: Any) -> Any:
    try:
        return ask()
    except Exception as error:  # which error it is, is the answer
        return type(error).__name__, str(error)


def answers(module: ModuleType) -> Iterator[Any]:
    """Answers of a verifier, or of a mutant of it."""
    random = Random(0)
    for content in JSON_TEXTS:
        yield _answer(lambda content=content: module.read_json(content, "it"))
    for content in meshes():
        yield _answer(lambda content=content: module.read_ply(content))
    for value in VALUES:
        yield _answer(lambda value=value: module.number({"it": value}, "it"))
        yield _answer(lambda value=value: module.number({"it": value}, "it", 3.0, 4.0))
        yield _answer(lambda value=value: module.place_in(value, 4, "it"))
        for kind in (float, str, list, dict):
            yield _answer(lambda value=value, kind=kind: module.get({"a": value}, "a", kind))
            yield _answer(lambda value=value, kind=kind: module.get({"a": value}, "a", kind, None))
            yield _answer(lambda value=value, kind=kind: module.get(value, "a", kind))
        yield _answer(lambda value=value: module.number({"a": value}, "a", default=7.0))
        for most in (1e5, -1e5, 100000.1, -100000.1):
            yield _answer(lambda value=value, most=most: module.vector([most, 0.0, value], "it"))
        yield _answer(lambda value=value: module.vector([value, 1.0], "it", 2, 3.0))
        yield _answer(lambda value=value: module.vector(value, "it"))
    for record in ({"id": "A", "panels": []}, {"id": "A", "panels ": []}, {}, [], None, "id", ["id"]):
        yield _answer(lambda record=record: module.known(record, "a facade"))
    for angle in ANGLES:
        yield module.sincos(angle)
    yield from _geometry(module, random)
    for size in (1e-9, 1e-6, 0.01, 0.3, 1.0, 7.0, 150.0, 1e4):
        for speed, acceleration, jerk in ((15.0, 2.5, 1e30), (15.0, 2.5, 4.0), (0.3, 2.5, 0.5), (2.0, 0.1, 100.0)):
            yield module.rest_to_rest(size, speed, acceleration, jerk)
    origin = (22.3372, 114.2636, 62.0)
    for lat, lon, height in (
        (22.3372, 114.2636, 62.0),
        (22.338, 114.263, 80.0),
        (-89.9, 10.0, -30.0),
        (0.0, 180.0, 0.0),
    ):
        yield module.enu(origin, lat, lon, height)
    for a, b in (
        (0.0, 0.01),
        (0.0, 0.0100001),
        (-179.995, 180.0),
        (359.0, -1.0),
        (10.0, 190.0),
        (-180.0, 180.02),
        (0.0, 180.2),
    ):
        yield module.between(a, b)


def _geometry(module: ModuleType, random: Random) -> Iterator[Any]:
    """Nearest points, planes between, prisms and panels."""

    def point(size: float) -> tuple[float, float, float]:
        return random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)

    for k in range(120):
        size = 10.0 ** random.uniform(-10.0, 1.0) if k % 3 == 0 else 2.0
        triangle = [point(size) for _ in range(3)]
        if k % 5 == 0:
            triangle[2] = triangle[k % 2]
        yield module.distance(point(3.0), tuple(triangle))
        yield module.cross(triangle[0], triangle[1]), module.plus(triangle[0], triangle[1]), module.length(triangle[2])
        yield module.is_same(triangle[0], (*triangle[0][:2], triangle[0][2] + random.choice((0.001, 0.00100001, 0.0))))
    for k in range(12):
        solids = module.Solids([tuple(point(4.0) for _ in range(3)) for _ in range(3 * k)])
        yield solids.tree
        for _ in range(20):
            n = point(1.0)
            directions = [tuple(0.99 * x / math.hypot(*n) for x in n)]
            ends = [tuple(6.0 * x + y for x, y in zip(n, point(1.0), strict=True)) for _ in range(2)]
            yield solids.clear(ends, directions, random.choice((0.0, 0.5)))
    yield module.prism([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 1.0)], 1.0, 2.0)
    for k in range(60):
        tilt = random.choice((0.0, 1e-13, 5e-7, 1.0e-6, 1.002e-6, 0.3, 2.0))
        u = (1.0, 0.0, 0.0) if k % 2 else (1.0, 0.3, 0.1)
        v = (0.2, 1.0, tilt) if k % 3 else (1.0, 10.0 ** random.uniform(-5.0, 0.0), tilt)
        wide = random.choice((0.012, 0.015, 1.0, 700.0, 720.0))
        corners = [
            tuple(wide * (a * x + b * y) for x, y in zip(u, v, strict=True))
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]
        yield _answer(lambda corners=corners: vars(module.Pane(corners)))
