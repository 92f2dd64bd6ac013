"""Reading TSPLIB instances and tours, with TSPLIB's own distances.

Format and distances: G. Reinelt, "TSPLIB 95", 1995, sections 1 and 2. Read are TSP, ATSP and CVRP files (capacities,
demands and depots of the latter included) with coordinates or explicit weights in any of the triangular layouts.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_lines, read_input_file
from planning.base.messages import about, say

Array = NDArray[np.float64]

MAX_POINTS = 10_000
"""Larger instances are refused: their distance matrix would take more than 0.8 GB."""

LARGEST = 1e15
"""Coordinates and distances of instances have seven digits; doubles count in ones up to here."""

TSPLIB_FILE, MAX_LINES = FileLimit("a TSPLIB file", 64 * MIB), 1_000_000

SECTIONS = (
    "NODE_COORD_SECTION",
    "EDGE_WEIGHT_SECTION",
    "DISPLAY_DATA_SECTION",
    "DEMAND_SECTION",
    "DEPOT_SECTION",
    "TOUR_SECTION",
    "FIXED_EDGES_SECTION",
    "EDGE_DATA_SECTION",
)


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """One problem as the file states it.

    Parameters
    ----------
    kind
        `TSP`, `ATSP` or `CVRP`.
    ids
        The file's own number of every point, in the order of the file; indices everywhere else refer to this order.
    cost
        Shape (n, n), TSPLIB's rounded distances from row to column, zero on the diagonal.
    demand, depots, capacity
        Shape (n,), indices and limit of a CVRP; None, empty and None otherwise.
    """

    name: str
    kind: str
    ids: tuple[int, ...]
    cost: Array
    demand: Array | None = None
    depots: tuple[int, ...] = ()
    capacity: float | None = None


@dataclass(frozen=True, slots=True)
class _Line:
    number: int
    text: str


@dataclass(frozen=True, slots=True)
class _File:
    """Header fields and section bodies of one file, each with its line number, for messages that point there."""

    path: Path
    fields: dict[str, _Line]
    sections: dict[str, tuple[int, list[_Line]]]

    def error(self, number: int, field: str, message: str) -> InputError:
        return InputError(about(f"{self.path}, line {number}: {field}", message))

    def field(self, name: str, expected: str) -> _Line:
        if name not in self.fields:
            raise InputError.say("{} is missing; expected {}", name, expected, place=self.path)
        return self.fields[name]

    def integer(self, name: str, low: int, high: float) -> int:
        line = self.field(name, "a whole number")
        try:
            value = int(line.text)
        except ValueError:
            raise self.error(line.number, name, say("expected a whole number, found '{}'", line.text)) from None
        if not low <= value <= high:
            raise self.error(line.number, name, say("expected {} to {}, found {}", low, high, value))
        return value

    def section(self, name: str) -> tuple[int, list[_Line]]:
        if name not in self.sections:
            raise InputError.say("{} is missing", name, place=self.path)
        return self.sections[name]

    def numbers(self, name: str) -> tuple[Array, NDArray[np.int64]]:
        """All numbers of a section, wherever its lines break, and the line each stands in."""
        values: list[float] = []
        lines: list[int] = []
        for line in self.section(name)[1]:
            words = line.text.split()
            try:
                values.extend(map(float, words))
            except ValueError:
                wrong = next(word for word in words if not _is_number(word))
                raise self.error(line.number, name, say("expected numbers, found '{}'", wrong)) from None
            lines.extend([line.number] * len(words))
        array = np.array(values, float)
        is_usable = np.abs(array) <= LARGEST  # neither is what is not finite
        if not is_usable.all():
            raise self.error(
                lines[int(np.argmin(is_usable))], name, say("expected finite numbers, at most {:g}", LARGEST)
            )
        return array, np.array(lines, np.int64)

    def records(self, name: str, n_records: int, width: int, what: str) -> tuple[Array, NDArray[np.int64]]:
        """Section as a table of `width` columns, shape (n_records, width), and the line each record starts in."""
        values, lines = self.numbers(name)
        if len(values) != n_records * width:
            number = int(lines[-1]) if len(lines) else self.section(name)[0]
            message = say("expected {} x {} numbers ({}), found {}", n_records, width, what, len(values))
            raise self.error(number, name, message)
        return values.reshape(n_records, width), lines[::width]

    def whole(self, name: str, values: Array, lines: NDArray[np.int64]) -> list[int]:
        """Same values as integers."""
        for value, number in zip(values, lines, strict=True):
            if value != math.floor(value):
                raise self.error(int(number), name, say("expected a whole number, found {}", value))
        return [int(value) for value in values]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _read(path: Path) -> _File:
    """Split a file into header fields and sections."""
    content = read_input_file(path, TSPLIB_FILE)
    check_lines(content, MAX_LINES, path)
    text = content.decode("utf-8-sig", "replace")
    fields: dict[str, _Line] = {}
    sections: dict[str, tuple[int, list[_Line]]] = {}
    body: list[_Line] | None = None
    for number, raw in enumerate(text.splitlines(), 1):
        key, _, value = (part.strip() for part in raw.partition(":"))
        key = key.upper()
        if key == "EOF":
            break
        if key in SECTIONS:
            if key in sections:
                raise InputError.say("expected once, found again", place=f"{path}, line {number}: {key}")
            body = []
            sections[key] = (number, body)
        elif raw[:1].isalpha() and (":" in raw or body is None):
            if ":" not in raw:
                key, _, value = raw.strip().partition(" ")
                key = key.upper()
            fields[key] = _Line(number, value.strip())
            body = None
        elif body is not None:
            body.append(_Line(number, raw))
        elif raw.strip():
            message = say("expected 'KEYWORD : value' or a section, found '{}'", raw.strip()[:40])
            raise InputError(about(f"{path}, line {number}", message))
    return _File(path, fields, sections)


def read_instance(path: Path) -> Instance:
    """Read a TSP, ATSP or CVRP file.

    Spacing around colons, line ends, a missing EOF, node numbers in any order and numbers broken over several lines
    are all accepted.

    Raises
    ------
    InputError
        The file is missing, is no TSPLIB instance, or is malformed; the message names line and field.
    """
    file = _read(path)
    kind_line = file.field("TYPE", "TSP, ATSP or CVRP")
    kind = (kind_line.text.split() or [""])[0].upper()
    if kind not in ("TSP", "ATSP", "CVRP"):
        raise file.error(kind_line.number, "TYPE", say("expected TSP, ATSP or CVRP, found '{}'", kind_line.text))
    for name in ("FIXED_EDGES_SECTION", "EDGE_DATA_SECTION"):
        if name in file.sections:
            raise file.error(
                file.sections[name][0], name, say("not supported; expected an instance without fixed edges")
            )
    n = file.integer("DIMENSION", 1, MAX_POINTS)
    weights = file.field("EDGE_WEIGHT_TYPE", "how distances are given")
    if weights.text.upper() == "EXPLICIT":
        ids, cost = tuple(range(1, n + 1)), _explicit(file, n)
    elif weights.text.upper() in DISTANCES:
        ids, cost = _from_coordinates(file, n, weights.text.upper())
    else:
        known = ", ".join([*DISTANCES, "EXPLICIT"])
        raise file.error(weights.number, "EDGE_WEIGHT_TYPE", say("expected one of {}, found '{}'", known, weights.text))
    if kind != "ATSP" and not np.array_equal(cost, cost.T):
        i, j = np.argwhere(cost != cost.T)[0]
        message = say(
            "the weights {:g} and {:g} between {} and {} differ; expected ATSP", cost[i, j], cost[j, i], ids[i], ids[j]
        )
        raise file.error(kind_line.number, "TYPE", message)
    name = file.fields["NAME"].text if "NAME" in file.fields else path.stem
    if kind != "CVRP":
        return Instance(name, kind, ids, cost)
    return Instance(name, kind, ids, cost, _demands(file, ids), _depots(file, ids), float(_capacity(file)))


def _from_coordinates(file: _File, n: int, weight_type: str) -> tuple[tuple[int, ...], Array]:
    dimensions, distance = DISTANCES[weight_type]
    table, lines = file.records(
        "NODE_COORD_SECTION", n, 1 + dimensions, say("number and {} coordinates a point", dimensions)
    )
    ids = file.whole("NODE_COORD_SECTION", table[:, 0], lines)
    _check_distinct(file, "NODE_COORD_SECTION", ids, lines)
    cost = distance(table[:, 1:])
    np.fill_diagonal(cost, 0.0)
    return tuple(ids), cost


def _check_distinct(file: _File, name: str, ids: list[int], lines: NDArray[np.int64]) -> None:
    seen: set[int] = set()
    for number, line in zip(ids, lines, strict=True):
        if number in seen:
            raise file.error(int(line), name, say("expected distinct point numbers, {} occurs twice", number))
        seen.add(number)


def _demands(file: _File, ids: tuple[int, ...]) -> Array:
    table, lines = file.records("DEMAND_SECTION", len(ids), 2, say("number and demand a point"))
    numbers = file.whole("DEMAND_SECTION", table[:, 0], lines)
    _check_distinct(file, "DEMAND_SECTION", numbers, lines)
    index = {number: i for i, number in enumerate(ids)}
    demand = np.zeros(len(ids))
    for number, line, value in zip(numbers, lines, table[:, 1], strict=True):
        if number not in index:
            raise file.error(int(line), "DEMAND_SECTION", say("there is no point {}", number))
        demand[index[number]] = value
    return demand


def _depots(file: _File, ids: tuple[int, ...]) -> tuple[int, ...]:
    values, lines = file.numbers("DEPOT_SECTION")
    numbers = file.whole("DEPOT_SECTION", values, lines)
    depots = numbers[: numbers.index(-1)] if -1 in numbers else numbers
    for number, line in zip(depots, lines, strict=False):
        if number not in ids:
            raise file.error(int(line), "DEPOT_SECTION", say("there is no point {}", number))
    if not depots:
        raise file.error(file.section("DEPOT_SECTION")[0], "DEPOT_SECTION", say("expected at least one depot"))
    return tuple(ids.index(number) for number in depots)


def _capacity(file: _File) -> int:
    return file.integer("CAPACITY", 0, math.inf)


def _explicit(file: _File, n: int) -> Array:
    """Full matrix from any EDGE_WEIGHT_FORMAT; what stands on the diagonal is dropped."""
    layout = file.field("EDGE_WEIGHT_FORMAT", "the layout of EDGE_WEIGHT_SECTION")
    name = layout.text.upper()
    if name == "FULL_MATRIX":
        rows, columns = (indices.ravel() for indices in np.indices((n, n)))
    elif name in TRIANGLES:
        upper, diagonal = TRIANGLES[name]
        rows, columns = np.triu_indices(n, 0 if diagonal else 1) if upper else np.tril_indices(n, 0 if diagonal else -1)
    else:
        known = ", ".join(["FULL_MATRIX", *TRIANGLES])
        raise file.error(layout.number, "EDGE_WEIGHT_FORMAT", say("expected one of {}, found '{}'", known, layout.text))
    values, lines = file.numbers("EDGE_WEIGHT_SECTION")
    if len(values) != len(rows):
        number = int(lines[-1]) if len(lines) else file.section("EDGE_WEIGHT_SECTION")[0]
        message = say("expected {} numbers ({} of {} points), found {}", len(rows), name, n, len(values))
        raise file.error(number, "EDGE_WEIGHT_SECTION", message)
    is_wrong = (values < 0.0) & (rows != columns)
    if is_wrong.any():
        first = int(np.argmax(is_wrong))
        message = say("expected no negative weight, found {:g}", values[first])
        raise file.error(int(lines[first]), "EDGE_WEIGHT_SECTION", message)
    cost = np.zeros((n, n))
    if name != "FULL_MATRIX":
        cost[columns, rows] = values
    cost[rows, columns] = values
    np.fill_diagonal(cost, 0.0)
    return cost


TRIANGLES = {
    "UPPER_ROW": (True, False),
    "LOWER_ROW": (False, False),
    "UPPER_DIAG_ROW": (True, True),
    "LOWER_DIAG_ROW": (False, True),
    "UPPER_COL": (False, False),
    "LOWER_COL": (True, False),
    "UPPER_DIAG_COL": (False, True),
    "LOWER_DIAG_COL": (True, True),
}
"""Layout -> (upper triangle, with diagonal). One triangle column by column reads like the other row by row."""


def read_tour(path: Path) -> tuple[int, ...]:
    """Point numbers of the first tour in a TSPLIB tour file.

    Raises
    ------
    InputError
        The file is missing, holds no tour, or names a point twice; the message names line and field.
    """
    file = _read(path)
    values, lines = file.numbers("TOUR_SECTION")
    numbers = file.whole("TOUR_SECTION", values, lines)
    tour = numbers[: numbers.index(-1)] if -1 in numbers else numbers
    if not tour:
        raise file.error(file.section("TOUR_SECTION")[0], "TOUR_SECTION", say("expected point numbers, found none"))
    _check_distinct(file, "TOUR_SECTION", tour, lines[: len(tour)])
    return tuple(tour)


def tour_order(instance: Instance, tour: tuple[int, ...]) -> NDArray[np.int64]:
    """Indices of the points that a tour's numbers name.

    Raises
    ------
    InputError
        The tour does not visit every point of the instance exactly once.
    """
    if sorted(tour) != sorted(instance.ids):
        missing = sorted(set(instance.ids) - set(tour))
        strange = sorted(set(tour) - set(instance.ids))
        raise InputError.say(
            "the tour does not fit {}: expected each of its {} points once, found {}, missing {}, unknown {}",
            instance.name,
            len(instance.ids),
            len(tour),
            missing[:5],
            strange[:5],
        )
    index = {number: i for i, number in enumerate(instance.ids)}
    return np.array([index[number] for number in tour], np.int64)


def _nint(values: Array) -> Array:
    """TSPLIB's rounding of values that are not negative: half goes up."""
    return np.floor(values + 0.5)


def _squares(points: Array) -> Array:
    """Squared Euclidean distances, axis by axis: an array of all differences would take three times the memory."""
    squares = np.zeros((len(points), len(points)))
    for axis in points.T:
        squares += (axis[:, None] - axis) ** 2
    return squares


def _euclidean(points: Array) -> Array:
    return np.asarray(np.sqrt(_squares(points)))


def _manhattan(points: Array) -> Array:
    total = np.zeros((len(points), len(points)))
    for axis in points.T:
        total += np.abs(axis[:, None] - axis)
    return total


def _maximum(points: Array) -> Array:
    largest = np.zeros((len(points), len(points)))
    for axis in points.T:
        np.maximum(largest, _nint(np.abs(axis[:, None] - axis)), out=largest)
    return largest


def _att(points: Array) -> Array:
    """Pseudo-Euclidean distance (section 2.5)."""
    exact = np.sqrt(_squares(points) / 10.0)
    rounded = _nint(exact)
    return np.where(rounded < exact, rounded + 1.0, rounded)


def _geo(points: Array) -> Array:
    """Distance on the idealised sphere, kilometres (section 2.4); coordinates are DDD.MM degrees and minutes.

    The degrees are truncated, not rounded as the report prints it: only so do the published optima come out (the
    author's own correction). The value of pi is the report's, too.
    """
    pi, radius_km = 3.141592, 6378.388
    degrees = np.trunc(points)
    angles = pi * (degrees + 5.0 * (points - degrees) / 3.0) / 180.0
    lat, lon = angles[:, 0], angles[:, 1]
    q1 = np.cos(lon[:, None] - lon[None, :])
    q2 = np.cos(lat[:, None] - lat[None, :])
    q3 = np.cos(lat[:, None] + lat[None, :])
    cosine = np.clip(0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3), -1.0, 1.0)
    return np.floor(radius_km * np.arccos(cosine) + 1.0)


DISTANCES: dict[str, tuple[int, Callable[[Array], Array]]] = {
    "EUC_2D": (2, lambda points: _nint(_euclidean(points))),
    "EUC_3D": (3, lambda points: _nint(_euclidean(points))),
    "CEIL_2D": (2, lambda points: np.ceil(_euclidean(points))),
    "CEIL_3D": (3, lambda points: np.ceil(_euclidean(points))),
    "MAN_2D": (2, lambda points: _nint(_manhattan(points))),
    "MAN_3D": (3, lambda points: _nint(_manhattan(points))),
    "MAX_2D": (2, _maximum),
    "MAX_3D": (3, _maximum),
    "ATT": (2, _att),
    "GEO": (2, _geo),
}
"""EDGE_WEIGHT_TYPE -> (number of coordinates, distances of shape (n, n) from points of shape (n, coordinates))."""
