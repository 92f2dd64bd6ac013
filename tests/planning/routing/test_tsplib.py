"""Reader for TSPLIB files: published optima, distances worked out by hand, every layout, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.routing.tour import tour_length
from planning.routing.tsplib import TRIANGLES, read_instance, read_tour, tour_order

BURMA14 = """\
16.47 96.10 16.47 94.44 20.09 92.54 22.39 93.37 25.23 97.24 22.00 96.05 20.47 97.02
17.20 96.29 16.30 97.38 14.05 98.12 16.53 97.38 21.52 95.59 19.41 97.13 20.09 94.55"""
"""TSPLIB's smallest instance with geographical distances; its optimum is 3323."""


def write(path: Path, *lines: str) -> Path:
    file = path / "instance.tsp"
    file.write_text("\n".join(lines))
    return file


def coordinates(path: Path, kind: str, *points: str) -> Path:
    header = ["NAME: x", "TYPE: TSP", f"DIMENSION: {len(points)}", f"EDGE_WEIGHT_TYPE: {kind}", "NODE_COORD_SECTION"]
    return write(path, *header, *(f"{i} {point}" for i, point in enumerate(points, 1)), "EOF")


def known_optima(folder: Path) -> dict[str, int]:
    lines = (folder / "solutions").read_text().splitlines()
    return {name.strip(): int(value) for name, value in (line.split(":") for line in lines)}


def test_optimal_tours_have_the_published_lengths(shared_data: Path) -> None:
    folder = shared_data / "routing" / "tsplib"
    optima = known_optima(folder)
    tours = sorted(folder.glob("*.opt.tour"))
    assert len(tours) >= 5
    for tour in tours:
        name = tour.name.removesuffix(".opt.tour")
        instance = read_instance(folder / f"{name}.tsp")
        assert tour_length(instance.cost, tour_order(instance, read_tour(tour))) == optima[name]


def test_capacities_demands_and_depots_are_read(shared_data: Path) -> None:
    instance = read_instance(shared_data / "routing" / "cvrp_x" / "X-n101-k25.vrp")
    assert instance.kind == "CVRP"
    assert instance.capacity == 206
    assert instance.depots == (0,)
    assert instance.demand is not None
    assert instance.demand[0] == 0
    # The name says 25 routes at least.
    assert math.ceil(instance.demand.sum() / instance.capacity) == 25


def test_the_published_optimum_of_burma14_is_reproduced(tmp_path: Path) -> None:
    numbers = BURMA14.split()
    points = [" ".join(numbers[i : i + 2]) for i in range(0, len(numbers), 2)]
    instance = read_instance(coordinates(tmp_path, "GEO", *points))
    optimal = tour_order(instance, (1, 2, 14, 3, 4, 5, 6, 12, 7, 13, 8, 11, 9, 10))
    assert tour_length(instance.cost, optimal) == 3323


@pytest.mark.parametrize(
    ("kind", "a", "b", "expected"),
    [
        ("EUC_2D", "0 0", "3 4", 5),
        ("EUC_2D", "0 0", "0.5 0", 1),  # a half is rounded up, not to even
        ("EUC_2D", "0 0", "0.49 0", 0),
        ("EUC_3D", "0 0 0", "2 3 6", 7),
        ("CEIL_2D", "0 0", "1 1", 2),
        ("CEIL_2D", "0 0", "3 4", 5),
        ("MAN_2D", "0 0", "1.2 1.2", 2),
        ("MAX_2D", "0 0", "1.6 2.4", 2),
        ("MAX_3D", "0 0 0", "1 2 3.5", 4),
        ("ATT", "0 0", "10 0", 4),  # sqrt(100 / 10) = 3.16, rounded 3 is too short: 4
        ("ATT", "0 0", "10 30", 10),  # sqrt(1000 / 10) = 10 exactly
        ("ATT", "0 0", "10 9", 5),  # sqrt(181 / 10) = 4.25, rounded 4 is too short: 5
        ("ATT", "0 0", "10 11", 5),  # sqrt(221 / 10) = 4.70, rounded 5
        ("GEO", "0.00 0.00", "0.00 1.00", 112),  # 6378.388 * 3.141592 / 180 = 111.32; + 1, truncated
        ("GEO", "0.00 0.00", "0.30 0.00", 56),  # 30 minutes are half a degree: 55.66; + 1, truncated
        ("GEO", "-0.30 0.00", "0.30 0.00", 112),  # minutes of southern latitudes count south
    ],
)
def test_distances_follow_the_report(tmp_path: Path, kind: str, a: str, b: str, expected: int) -> None:
    cost = read_instance(coordinates(tmp_path, kind, a, b)).cost
    assert cost.tolist() == [[0, expected], [expected, 0]]


def test_att_does_not_round_up_exact_distances(tmp_path: Path) -> None:
    points = [f"{10 * i} {30 * i}" for i in range(200)]
    cost = read_instance(coordinates(tmp_path, "ATT", *points)).cost
    i = np.arange(200)
    assert np.array_equal(cost, 10.0 * np.abs(i[:, None] - i))


def in_layout(matrix: np.ndarray, layout: str) -> list[int]:
    """Numbers of a matrix as a layout lists them, written the slow way."""
    n = len(matrix)
    cells = {
        "FULL_MATRIX": [(i, j) for i in range(n) for j in range(n)],
        "UPPER_ROW": [(i, j) for i in range(n) for j in range(i + 1, n)],
        "LOWER_ROW": [(i, j) for i in range(n) for j in range(i)],
        "UPPER_DIAG_ROW": [(i, j) for i in range(n) for j in range(i, n)],
        "LOWER_DIAG_ROW": [(i, j) for i in range(n) for j in range(i + 1)],
        "UPPER_COL": [(i, j) for j in range(n) for i in range(j)],
        "LOWER_COL": [(i, j) for j in range(n) for i in range(j + 1, n)],
        "UPPER_DIAG_COL": [(i, j) for j in range(n) for i in range(j + 1)],
        "LOWER_DIAG_COL": [(i, j) for j in range(n) for i in range(j, n)],
    }
    return [int(matrix[cell]) for cell in cells[layout]]


@given(
    layout=st.sampled_from(["FULL_MATRIX", *TRIANGLES]),
    n=st.integers(1, 7),
    width=st.integers(1, 9),
    seed=st.integers(0, 1000),
)
def test_every_layout_of_weights_gives_the_same_matrix(
    tmp_path_factory: pytest.TempPathFactory, layout: str, n: int, width: int, seed: int
) -> None:
    matrix = np.random.default_rng(seed).integers(0, 100, (n, n))
    matrix = np.tril(matrix) + np.tril(matrix, -1).T  # the diagonal of a file may hold anything
    numbers = [str(value) for value in in_layout(matrix, layout)]
    rows = [" ".join(numbers[i : i + width]) for i in range(0, len(numbers), width)]
    header = ["TYPE: TSP", f"DIMENSION: {n}", "EDGE_WEIGHT_TYPE: EXPLICIT", f"EDGE_WEIGHT_FORMAT: {layout}"]
    file = write(tmp_path_factory.mktemp("layout"), *header, "EDGE_WEIGHT_SECTION", *rows, "EOF")
    np.fill_diagonal(matrix, 0)
    assert np.array_equal(read_instance(file).cost, matrix)


@pytest.mark.parametrize(
    "text",
    [
        "NAME:x\nTYPE:TSP\nDIMENSION:3\nEDGE_WEIGHT_TYPE:EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 3 4\n3 0 8\nEOF\n",
        "NAME : x\r\nTYPE :TSP\r\nDIMENSION: 3\r\nEDGE_WEIGHT_TYPE : EUC_2D\r\nNODE_COORD_SECTION\r\n"
        "1 0 0\r\n2 3 4\r\n3 0 8",
        "\ufeffname\t:\tx\ntype\t:\ttsp (M.~Hofmeister)\nComment: a: b\nDimension\t: 3\n\nedge_weight_type: euc_2d\n"
        "NODE_COORD_SECTION :\n\n 1\t0.0e0\t0 2 3\n 4.0\n3 0 +8.\n\n",
        "TYPE: TSP\nCOMMENT : one\nCOMMENT : two\nDIMENSION 3\nEDGE_WEIGHT_TYPE EUC_2D\nDISPLAY_DATA_SECTION\n1 9 9\n"
        "NODE_COORD_SECTION\n1 0 0\n2 3 4\n3 0 8\nDISPLAY_DATA_TYPE: COORD_DISPLAY\nEOF\nanything",
    ],
)
def test_headers_are_read_however_they_are_spaced(tmp_path: Path, text: str) -> None:
    file = tmp_path / "x.tsp"
    file.write_bytes(text.encode())
    assert read_instance(file).cost.tolist() == [[0, 5, 8], [5, 0, 5], [8, 5, 0]]


def test_point_numbers_may_come_in_any_order(tmp_path: Path) -> None:
    header = ["TYPE: TSP", "DIMENSION: 3", "EDGE_WEIGHT_TYPE: EUC_2D", "NODE_COORD_SECTION"]
    instance = read_instance(write(tmp_path, *header, "30 0 8", "0 0 0", "7 3 4"))
    assert instance.ids == (30, 0, 7)
    tour = tmp_path / "x.tour"
    tour.write_text("TYPE : TOUR\nTOUR_SECTION\n0 7\n30\n-1\n-1\nEOF")
    assert tour_order(instance, read_tour(tour)).tolist() == [1, 2, 0]


GOOD = {
    "TYPE": "TYPE: TSP",
    "DIMENSION": "DIMENSION: 2",
    "EDGE_WEIGHT_TYPE": "EDGE_WEIGHT_TYPE: EUC_2D",
    "BODY": "NODE_COORD_SECTION\n1 0 0\n2 3 4",
}


@pytest.mark.parametrize(
    ("part", "replacement", "message"),
    [
        ("TYPE", "", "TYPE is missing"),
        ("TYPE", "TYPE: HCP", "line 1: TYPE: expected TSP, ATSP or CVRP, found 'HCP'"),
        ("DIMENSION", "", "DIMENSION is missing"),
        ("DIMENSION", "DIMENSION: two", "line 2: DIMENSION: expected a whole number, found 'two'"),
        ("DIMENSION", "DIMENSION: -1", "line 2: DIMENSION: expected 1 to 10000, found -1"),
        ("DIMENSION", "DIMENSION: 99999", "line 2: DIMENSION: expected 1 to 10000"),
        ("DIMENSION", "DIMENSION: 3", "line 6: NODE_COORD_SECTION: expected 3 x 3 numbers"),
        ("EDGE_WEIGHT_TYPE", "", "EDGE_WEIGHT_TYPE is missing"),
        ("EDGE_WEIGHT_TYPE", "EDGE_WEIGHT_TYPE: XRAY1", "line 3: EDGE_WEIGHT_TYPE: expected one of"),
        ("EDGE_WEIGHT_TYPE", "EDGE_WEIGHT_TYPE: EXPLICIT", "EDGE_WEIGHT_FORMAT is missing"),
        ("BODY", "", "NODE_COORD_SECTION is missing"),
        ("BODY", "NODE_COORD_SECTION\n1 0 0\n2 3 x", "line 6: NODE_COORD_SECTION: expected numbers, found 'x'"),
        ("BODY", "NODE_COORD_SECTION\n1 0 0\n2 nan 4", "line 6: NODE_COORD_SECTION: expected finite numbers"),
        ("BODY", "NODE_COORD_SECTION\n1 0 0\n1 3 4", "line 6: NODE_COORD_SECTION: expected distinct point numbers"),
        ("BODY", "NODE_COORD_SECTION\n1 0 0\n1.5 3 4", "line 6: NODE_COORD_SECTION: expected a whole number"),
        ("BODY", "NODE_COORD_SECTION\n1 0 0\n2 3 4\nNODE_COORD_SECTION", "line 7: NODE_COORD_SECTION: expected once"),
        ("BODY", "NODE_COORD_SECTION\n1 0 0\n2 3 4\nFIXED_EDGES_SECTION\n1 2", "FIXED_EDGES_SECTION: not supported"),
        ("TYPE", "[build-system]", "line 1: expected 'KEYWORD : value' or a section"),
    ],
)
def test_a_malformed_file_is_refused_with_line_and_field(
    tmp_path: Path, part: str, replacement: str, message: str
) -> None:
    file = write(tmp_path, *({**GOOD, part: replacement}.values()))
    with pytest.raises(InputError) as refused:
        read_instance(file)
    assert message in str(refused.value)
    assert str(file) in str(refused.value)


@pytest.mark.parametrize(
    ("kind", "weights", "message"),
    [
        ("TSP", "0 1\n2 0", "differ; expected ATSP"),
        ("ATSP", "0 -1\n2 0", "line 6: EDGE_WEIGHT_SECTION: expected no negative weight, found -1"),
        ("TSP", "0 1\n1", "line 7: EDGE_WEIGHT_SECTION: expected 4 numbers (FULL_MATRIX of 2 points), found 3"),
    ],
)
def test_wrong_weights_are_refused(tmp_path: Path, kind: str, weights: str, message: str) -> None:
    header = [f"TYPE: {kind}", "DIMENSION: 2", "EDGE_WEIGHT_TYPE: EXPLICIT", "EDGE_WEIGHT_FORMAT: FULL_MATRIX"]
    with pytest.raises(InputError) as refused:
        read_instance(write(tmp_path, *header, "EDGE_WEIGHT_SECTION", weights))
    assert message in str(refused.value)


def test_asymmetric_weights_keep_their_direction(tmp_path: Path) -> None:
    header = ["TYPE: ATSP", "DIMENSION: 2", "EDGE_WEIGHT_TYPE: EXPLICIT", "EDGE_WEIGHT_FORMAT: FULL_MATRIX"]
    assert read_instance(write(tmp_path, *header, "EDGE_WEIGHT_SECTION", "9 1 2 9")).cost.tolist() == [[0, 1], [2, 0]]


@pytest.mark.parametrize(
    ("numbers", "message"),
    [("1 2 2 -1", "2 occurs twice"), ("-1", "found none"), ("1 2 four", "found 'four'")],
)
def test_a_malformed_tour_is_refused(tmp_path: Path, numbers: str, message: str) -> None:
    file = write(tmp_path, "TYPE: TOUR", "TOUR_SECTION", numbers)
    with pytest.raises(InputError, match=message):
        read_tour(file)


def test_a_tour_of_another_instance_is_refused(tmp_path: Path) -> None:
    instance = read_instance(coordinates(tmp_path, "EUC_2D", "0 0", "1 1", "2 2"))
    with pytest.raises(InputError, match=r"missing \[3\], unknown \[4\]"):
        tour_order(instance, (1, 2, 4))


@given(st.binary(max_size=300))
def test_no_bytes_raise_anything_but_an_input_error(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    file = tmp_path_factory.mktemp("bytes") / "x.tsp"
    file.write_bytes(content)
    with pytest.raises(InputError):
        read_instance(file)


def test_a_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_instance(tmp_path / "none.tsp")
