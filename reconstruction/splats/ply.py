"""Splats as PLY files: what other programs read and show, and what we read back bit by bit.

Files of kind `2dgs` have two sizes per splat, those of kind `3dgs` three: of discs the third is next to nothing, for
programs that know ellipsoids only. Columns stand in the order that programs go by that do not look at names; ours come
after them. Other programs show the diffuse colour alone: none of them can render mirrored light. Attributes that only
one method has are not in the files.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_input_file, real_path
from planning.base.json_file import part_file
from planning.base.messages import say
from reconstruction.light.shading import BASE_REFLECTANCE, REFLECTIVITY
from reconstruction.splats.harmonic_colour import N_HARMONICS
from reconstruction.splats.rasterising.raster_types import FLAT, SOLID
from reconstruction.splats.splats import NO_PANEL, SHAPES, Splats, normals_of

# PLY files of points, read and written in blocks: memory does not grow with the file, and no header is trusted.
#
# Only what point clouds and splats need: binary, little-endian, one element `vertex` without lists, first in the
# file.

SPLATS_FILE = FileLimit("a PLY file", 65536 * MIB)
"""Read in blocks, so that its length costs no memory."""

MAX_HEADER_BYTES = 64 * 1024
"""A header of splats has about 2 kB."""

MAX_COLUMNS = 512

MAX_ROWS = 200_000_000
"""More than any graphics card holds."""

AT_ONCE = 65_536
"""Rows of a block: 18 MB of splats."""

TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "<i2"),
    **dict.fromkeys(("ushort", "uint16"), "<u2"),
    **dict.fromkeys(("int", "int32"), "<i4"),
    **dict.fromkeys(("uint", "uint32"), "<u4"),
    **dict.fromkeys(("float", "float32"), "<f4"),
    **dict.fromkeys(("double", "float64"), "<f8"),
}

NAMES = {"<f4": "float", "u1": "uchar", "<i4": "int"}
"""Of the types that are written."""

BINARY = "binary_little_endian"


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """What a file says about its vertices.

    Parameters
    ----------
    n_rows
        The file is long enough for them.
    columns
        Names and NumPy types, in the file's order.
    comments
        Without the word `comment`.
    start
        Offset of the first row.
    """

    n_rows: int
    columns: tuple[tuple[str, str], ...]
    comments: tuple[str, ...]
    start: int

    @property
    def row_type(self) -> np.dtype[Any]:
        """Of one row."""
        return np.dtype(list(self.columns))

    @property
    def names(self) -> frozenset[str]:
        """Of the columns."""
        return frozenset(name for name, _ in self.columns)


def read_header(path: Path) -> PlyHeader:
    """Header of a PLY file, checked against the file's length.

    Raises
    ------
    InputError
        The file is missing, is no PLY file, is damaged or cut off, or is of a kind that is not read.
    """
    with open_input_file(path, SPLATS_FILE) as stream:
        lines = _header_lines(stream, path)
        return _parsed(lines, stream.tell(), os.fstat(stream.fileno()).st_size, path)


def read_blocks(path: Path, header: PlyHeader, at_once: int = AT_ONCE) -> Iterator[NDArray[Any]]:
    """Rows in blocks, structured arrays with the columns of the header; all of them have their full length.

    Raises
    ------
    InputError
        The file cannot be read, or got shorter meanwhile.
    """
    row = header.row_type
    with open_input_file(path, SPLATS_FILE) as stream:
        stream.seek(header.start)
        for first in range(0, header.n_rows, at_once):
            block = np.fromfile(stream, row, min(at_once, header.n_rows - first))
            if len(block) < min(at_once, header.n_rows - first):
                raise InputError(say("ends after {} of its {} points", first + len(block), header.n_rows, place=path))
            yield block


def write_blocks(path: Path, n_rows: int, row: np.dtype[Any], comments: Sequence[str], blocks: Iterable[Any]) -> None:
    """Write a file, whole or not at all.

    Parameters
    ----------
    row
        Type of a row, with columns of float32, int32 and uint8.
    blocks
        Structured arrays of that type, `n_rows` rows in all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    lines = ["ply", f"format {BINARY} 1.0", *(f"comment {comment}" for comment in comments), f"element vertex {n_rows}"]
    lines += [f"property {NAMES[row[name].str.replace('|', '')]} {name}" for name in row.names or ()]
    header = ("\n".join([*lines, "end_header"]) + "\n").encode("ascii", "replace")
    try:
        with part_file(real_path(path)) as part:
            n_written = 0
            with part.open("wb") as stream:
                stream.write(header)
                for block in blocks:
                    stream.write(np.ascontiguousarray(block, row).tobytes())
                    n_written += len(block)
            if n_written != n_rows:
                raise ValueError(f"blocks: expected {n_rows} rows in all, got {n_written}")
    except OSError as error:
        raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error


def _header_lines(stream: BinaryIO, path: Path) -> list[str]:
    if stream.readline(16).strip() != b"ply":
        raise InputError(say("is no PLY file (it does not start with 'ply')", place=path))
    lines: list[str] = []
    while stream.tell() < MAX_HEADER_BYTES:
        line = stream.readline(MAX_HEADER_BYTES)
        if not line.endswith(b"\n"):
            break
        text = line.decode("utf-8", "replace").strip()
        if text == "end_header":
            return lines
        lines.append(text)
    raise InputError(say("its header does not end within {} bytes; the file is damaged", MAX_HEADER_BYTES, place=path))


def _parsed(lines: list[str], start: int, size: int, path: Path) -> PlyHeader:
    columns: list[tuple[str, str]] = []
    comments: list[str] = []
    elements: list[tuple[str, int]] = []
    kind = ""
    for number, line in enumerate(lines, 2):
        words = line.split()
        match words:
            case [] | ["obj_info", *_]:
                pass
            case ["comment", *_]:
                comments.append(line[len("comment") :].strip())
            case ["format", found, "1.0"]:
                kind = found
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 19:
                elements.append((name, int(count)))
            case ["property", type_name, name] if type_name in TYPES and elements:
                if len(elements) == 1:
                    columns.append((name, TYPES[type_name]))
            case ["property", "list", _, _, _] if len(elements) > 1:
                pass  # of faces, which come after the vertices and are not read
            case _:
                raise InputError(say("line {} of its header is not understood: '{}'", number, line[:80], place=path))
    if kind != BINARY:
        raise InputError(
            say("expected a PLY file of format {}, found '{}'; save it as that", BINARY, kind or "none", place=path)
        )
    if not elements or elements[0][0] != "vertex":
        raise InputError(
            say("its first element is '{}', not 'vertex'", elements[0][0] if elements else "none", place=path)
        )
    _check_columns([name for name, _ in columns], path)
    header = PlyHeader(elements[0][1], tuple(columns), tuple(comments), start)
    needed = header.n_rows * header.row_type.itemsize
    if header.n_rows > MAX_ROWS:
        raise InputError(say("says that it has {} points; at most {} are read", header.n_rows, MAX_ROWS, place=path))
    if size - start < needed:
        raise InputError(
            say(
                "says that it has {} points, {} bytes, and {} bytes follow its header; the file is cut off or damaged",
                header.n_rows,
                needed,
                size - start,
                place=path,
            )
        )
    return header


def _check_columns(names: list[str], path: Path) -> None:
    if not names or len(names) > MAX_COLUMNS:
        raise InputError(say("its points have {} properties; expected 1 to {}", len(names), MAX_COLUMNS, place=path))
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise InputError(say("its points have the property '{}' twice", double[:40], place=path))


Kind = Literal["2dgs", "3dgs"]

FORMAT = "reflight-splats/1"

ORIGIN = "origin_enu_m"

ELLIPSOIDS = "splats: ellipsoids"
"""Comment of our files of ellipsoids."""

THICKNESS_LOG_M = math.log(1e-6)
"""Third size of a disc where there must be one, as 2DGS recommends."""

FLATTEST_LOG = math.log(0.01)
"""Of ellipsoids, third size over the smaller of the others: where all of a file are flatter, they are discs."""

ODD = np.array([1 if m % 2 == 0 else -1 for degree in range(4) for m in range(-degree, degree + 1)], np.float32)
"""Other programs' harmonics have the phase (-1)^m, ours have not."""

PLACE = ("x", "y", "z")
NORMAL = ("nx", "ny", "nz")
MEAN_COLOUR = tuple(f"f_dc_{i}" for i in range(3))
SIZES = tuple(f"scale_{i}" for i in range(SOLID))
ROTATION = tuple(f"rot_{i}" for i in range(4))
GLASS = ("refgs_r", "refgs_f0_0", "refgs_f0_1", "refgs_f0_2")
PANEL = "panel_id"

REST_OF_DEGREE = {0: 0, 9: 1, 24: 2, 45: 3}
"""Degree of the harmonics by the number of `f_rest` columns."""

LARGEST_LOG = 20.0
"""Of a size in metres: e^20 is further than the moon."""


@dataclass(frozen=True, slots=True, eq=False)
class SplatsOfFile:
    """What a file holds.

    Parameters
    ----------
    origin_enu_m
        Of the frame of the means, in the site's; (0, 0, 0) where the file does not say.
    """

    splats: Splats
    origin_enu_m: tuple[float, float, float]


def render_mode(mode: Literal["2dgs", "mip", ""]) -> list[str]:
    """The comment by which a file says how it is to be drawn: as discs, as antialiased ellipsoids, or as usual."""
    return [f"SplatRenderMode: {mode}"] if mode else []


def write_splats(
    path: Path,
    splats: Splats,
    kind: Kind,
    origin_enu_m: Sequence[float] = (0.0, 0.0, 0.0),
    comments: Sequence[str] = (),
) -> None:
    """Write splats, whole or not at all.

    Parameters
    ----------
    kind
        Ellipsoids can only be `3dgs`.
    origin_enu_m
        Of the model's frame, in the site's, written as a comment.
    comments
        More of them, each of one line: the site and its place on Earth for example.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    if kind == "2dgs" and not splats.is_flat:
        raise ValueError("kind: expected '3dgs' for ellipsoids, got '2dgs'")
    origin = " ".join(repr(float(value)) for value in origin_enu_m)
    lines = [
        FORMAT,
        *([] if splats.is_flat else [ELLIPSOIDS]),
        *render_mode("2dgs" if kind == "2dgs" else ""),
        f"{ORIGIN}: {origin}",
        "axes: x east, y north, z up, metres, counted from the origin",
        "refgs_r and refgs_f0 are logits, as opacity is; panel_id counts from 0, -1 is no glass",
        *(" ".join(comment.split()) for comment in comments),
    ]
    write_blocks(path, len(splats), _row_type(kind), lines, _blocks(splats, kind))


def _row_type(kind: Kind) -> np.dtype[Any]:
    rest = tuple(f"f_rest_{i}" for i in range(3 * (N_HARMONICS - 1)))
    sizes = SIZES[:FLAT] if kind == "2dgs" else SIZES
    names = (*PLACE, *NORMAL, *MEAN_COLOUR, *rest, "opacity", *sizes, *ROTATION, *GLASS)
    return np.dtype([*((name, "<f4") for name in names), (PANEL, "<i4")])


def _blocks(splats: Splats, kind: Kind) -> Iterator[NDArray[Any]]:
    row = _row_type(kind)
    for start in range(0, len(splats), AT_ONCE):
        part = {name: getattr(splats, name).detach()[start : start + AT_ONCE].cpu().numpy() for name in SHAPES}
        table = np.zeros(len(part["means"]), row)
        _put(table, PLACE, part["means"])
        if splats.is_flat:
            _put(table, NORMAL, normals_of(torch.from_numpy(part["quats"])).numpy())
        sh = part["sh"] * ODD[:, None]
        _put(table, MEAN_COLOUR, sh[:, 0])
        # All of red, then of green, then of blue.
        rest = sh[:, 1:].transpose(0, 2, 1).reshape(len(sh), -1)
        _put(table, [f"f_rest_{i}" for i in range(rest.shape[1])], rest)
        table["opacity"] = part["opacity_logits"]
        _put(table, SIZES[: part["log_scales"].shape[1]], part["log_scales"])
        if kind == "3dgs" and splats.is_flat:
            table["scale_2"] = THICKNESS_LOG_M
        _put(table, ROTATION, part["quats"])
        table["refgs_r"] = part["reflectivity_logits"]
        _put(table, GLASS[1:], part["f0_logits"])
        table[PANEL] = splats.panels[start : start + AT_ONCE].cpu().numpy()
        yield table


def read_splats(path: Path) -> SplatsOfFile:
    """Read splats of ours or of another program.

    Lower degrees of harmonics, and no columns of ours, are as good: then nothing is glass. Splats of three sizes are
    ellipsoids, unless all of them are as good as flat.

    Raises
    ------
    InputError
        The file is missing or damaged, has no splats, or numbers that are not finite.
    """
    header = read_header(path)
    degree = _checked(header, path)
    n = header.n_rows
    shapes = SHAPES | {"log_scales": (SOLID if "scale_2" in header.names else FLAT,)}
    values = {name: np.zeros((n, *shape), np.float32) for name, shape in shapes.items()}
    values["reflectivity_logits"][:] = math.log(REFLECTIVITY / (1.0 - REFLECTIVITY))
    values["f0_logits"][:] = math.log(BASE_REFLECTANCE / (1.0 - BASE_REFLECTANCE))
    panels = np.full(n, NO_PANEL, np.int32)
    first = 0
    for block in read_blocks(path, header):
        rows = slice(first, first + len(block))
        _take(block, header, degree, values, panels, rows, path)
        first += len(block)
    if ELLIPSOIDS not in header.comments and _are_discs(values["log_scales"]):
        values["log_scales"] = np.ascontiguousarray(values["log_scales"][:, :FLAT])
    tensors = {name: torch.from_numpy(value) for name, value in values.items()}
    return SplatsOfFile(Splats(tensors, torch.from_numpy(panels)), _origin(header, path))


def _checked(header: PlyHeader, path: Path) -> int:
    """Degree of the harmonics, after a look whether all columns are there."""
    needed = (*PLACE, *MEAN_COLOUR, "opacity", *SIZES[:FLAT], *ROTATION)
    missing = [name for name in needed if name not in header.names]
    if missing:
        raise InputError(say("has no '{}', so these are points and not splats", missing[0], place=path))
    n_rest = sum(name.startswith("f_rest_") for name in header.names)
    if n_rest not in REST_OF_DEGREE or not header.names.issuperset(f"f_rest_{i}" for i in range(n_rest)):
        raise InputError(say("expected 0, 9, 24 or 45 columns f_rest_0 and so on, found {}", n_rest, place=path))
    types = dict(header.columns)
    used = (*needed, *SIZES)
    wrong = [name for name in types if name in used or name.startswith("f_rest_") if types[name] != "<f4"]
    if wrong:
        raise InputError(say("'{}': expected float, found another type", wrong[0], place=path))
    if not header.n_rows:
        raise InputError(say("holds no splats", place=path))
    return REST_OF_DEGREE[n_rest]


def _take(
    block: NDArray[Any],
    header: PlyHeader,
    degree: int,
    values: dict[str, NDArray[np.float32]],
    panels: NDArray[np.int32],
    rows: slice,
    path: Path,
) -> None:
    values["means"][rows] = _columns(block, PLACE)
    values["sh"][rows, 0] = _columns(block, MEAN_COLOUR)
    n_rest = (degree + 1) ** 2 - 1
    if n_rest:
        rest = _columns(block, [f"f_rest_{i}" for i in range(3 * n_rest)])
        turned = rest.reshape(-1, 3, n_rest).transpose(0, 2, 1)
        values["sh"][rows, 1 : 1 + n_rest] = turned * ODD[1 : 1 + n_rest, None]
    values["opacity_logits"][rows] = block["opacity"]
    sizes = _columns(block, SIZES[: values["log_scales"].shape[1]])
    # Programs write the logarithm of a thickness of 0, too.
    sizes[:, FLAT:][np.isneginf(sizes[:, FLAT:])] = THICKNESS_LOG_M
    values["log_scales"][rows] = sizes
    values["quats"][rows] = _columns(block, ROTATION)
    if header.names.issuperset((*GLASS, PANEL)):
        values["reflectivity_logits"][rows] = block[GLASS[0]]
        values["f0_logits"][rows] = _columns(block, GLASS[1:])
        panels[rows] = block[PANEL]
    for name, value in values.items():
        if not np.isfinite(value[rows]).all():
            raise InputError(say("holds numbers that are not finite, among them {} of splats", name, place=path))
    if (values["log_scales"][rows] > LARGEST_LOG).any() or (panels[rows] < NO_PANEL).any():
        raise InputError(say("holds sizes or panels that cannot be; the file is damaged", place=path))


def _are_discs(log_scales: NDArray[np.float32]) -> bool:
    """Whether the third size, if there is one, says nothing."""
    if log_scales.shape[1] == FLAT:
        return True
    thickness, smaller = log_scales[:, FLAT], log_scales[:, :FLAT].min(axis=1)
    return bool((thickness <= np.maximum(smaller + FLATTEST_LOG, THICKNESS_LOG_M)).all())


def _origin(header: PlyHeader, path: Path) -> tuple[float, float, float]:
    line = next((comment for comment in header.comments if comment.startswith(f"{ORIGIN}:")), None)
    if line is None:
        return (0.0, 0.0, 0.0)
    try:
        x, y, z = (float(word) for word in line.removeprefix(f"{ORIGIN}:").split())
    except ValueError as error:
        raise InputError(
            say("expected three numbers after '{}:', found '{}'", ORIGIN, line[:80], place=path)
        ) from error
    if not all(map(math.isfinite, (x, y, z))):
        raise InputError(say("expected finite numbers, found '{}'", line[:80], place=f"{path}: {ORIGIN}"))
    return x, y, z


def _put(table: NDArray[Any], names: Sequence[str], values: NDArray[np.float32]) -> None:
    for column, name in enumerate(names):
        table[name] = values[:, column]


def _columns(block: NDArray[Any], names: Sequence[str]) -> NDArray[np.float32]:
    return np.stack([block[name] for name in names], axis=1)
