"""Heights above terrain as both verifiers have them: those of exact arithmetic, of the planner, and of each other."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.height_field import HeightField
from planning.proof import reflight_verify as verifier
from planning.site.terrain import NOT_KNOWN, grid_text
from tests.planning.proof.attack import same
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.tampering import sealed
from tests.planning.proof.verifiers import QtScript, by_module, load, write

Place = tuple[float, float, float]


@pytest.fixture(scope="module")
def page() -> QtScript:
    return QtScript()


def _record(heights_mm: np.ndarray, west_south_m: tuple[float, float], step_m: float) -> dict[str, Any]:
    rows, columns = heights_mm.shape
    text = grid_text(heights_mm.astype(float))
    return {
        "west_south_m": list(west_south_m),
        "step_m": step_m,
        "columns": float(columns),
        "rows": float(rows),
        "upper": text,
        "accuracy_m": 0.0,
    }


def _exactly_above(heights_mm: np.ndarray, record: dict[str, Any], a: Place, b: Place, way: Fraction) -> Fraction:
    """Height above the bilinear surface of a place on a leg."""
    x, y, z = (Fraction(p) + (Fraction(q) - Fraction(p)) * way for p, q in zip(a, b, strict=True))
    u, v = (
        (c - Fraction(low)) / Fraction(record["step_m"]) for c, low in zip((x, y), record["west_south_m"], strict=True)
    )
    column, row = min(int(u), heights_mm.shape[1] - 2), min(int(v), heights_mm.shape[0] - 2)
    u, v = u - column, v - row
    (z00, z10), (z01, z11) = (
        [Fraction(int(mm), 1000) for mm in heights_mm[row + k, column : column + 2]] for k in (0, 1)
    )
    return z - (z00 * (1 - u) * (1 - v) + z10 * u * (1 - v) + z01 * (1 - u) * v + z11 * u * v)


def _case(seed: int) -> tuple[np.ndarray, dict[str, Any], Place, Place]:
    random = Random(seed)
    columns, rows = random.randint(2, 7), random.randint(2, 7)
    rough_mm = random.choice((0, 50, 2000, 30_000))
    heights = np.array([[random.randint(-rough_mm, rough_mm) for _ in range(columns)] for _ in range(rows)])
    corner, step = (random.uniform(-9e4, 9e4), random.uniform(-500.0, 500.0)), random.choice((0.5, 1.0, 7.3))
    record = _record(heights, corner, step)

    def place() -> Place:
        on_line = random.random() < 0.3
        shares = [random.randint(0, n - 1) if on_line else random.uniform(0.0, n - 1.0) for n in (columns, rows)]
        return (
            min(max(corner[0] + shares[0] * step, corner[0]), corner[0] + (columns - 1) * step),
            min(max(corner[1] + shares[1] * step, corner[1]), corner[1] + (rows - 1) * step),
            random.uniform(-20.0, 60.0),
        )

    a, b = place(), place()
    return heights, record, a, (*a[:2], b[2]) if random.random() < 0.1 else b


@given(st.integers(0, 2**32))
def test_clearance_is_the_least_height_above_the_surface(seed: int) -> None:
    heights, record, a, b = _case(seed)
    try:
        found = verifier.Terrain(record).clearance(a, b)
    except verifier.Refused:  # the last digit of a place on the border
        return
    on_the_way = [_exactly_above(heights, record, a, b, Fraction(k, 64)) for k in range(65)]
    # Far from the origin places have 1e-11 m, and slopes of 30 m in 0.5 m make 1e-9 m of them.
    assert found <= float(min(on_the_way)) + 1e-8
    field = HeightField(*record["west_south_m"], record["step_m"], heights / 1000.0)
    planned = field.leg_heights_m(np.array([a]), np.array([b]))[0][0]
    assert found == pytest.approx(planned, abs=1e-6) or planned == -np.inf


@given(st.integers(0, 2**32))
def test_the_nodes_below_a_box_bound_the_ground_below_its_places(seed: int) -> None:
    heights, record, a, b = _case(seed)
    nodes = verifier.Terrain(record).nodes(*_box(a, b))
    if verifier.UNKNOWN_M not in nodes:
        for way in (Fraction(k, 16) for k in range(17)):  # a diagonal of the box
            z = Fraction(a[2]) + (Fraction(b[2]) - Fraction(a[2])) * way
            ground = z - _exactly_above(heights, record, a, b, way)
            assert min(nodes) - 1e-8 <= float(ground) <= max(nodes) + 1e-8


def _box(a: Place, b: Place) -> tuple[Place, Place]:
    low, high = (tuple(f(p, q) for p, q in zip(a, b, strict=True)) for f in (min, max))
    return low, high  # type: ignore[return-value]


def test_beyond_the_grid_nothing_is_known() -> None:
    terrain = verifier.Terrain(_record(np.arange(12).reshape(3, 4), (10.0, 20.0), 2.0))
    assert terrain.nodes((10.0, 20.0, 0.0), (16.0, 24.0, 0.0)) == [mm / 1000.0 for mm in range(12)]
    assert terrain.nodes((12.5, 22.0, 0.0), (13.5, 22.0, 0.0)) == [0.005, 0.006]
    for low, high in (((9.9, 20.0), (11.0, 21.0)), ((10.0, 20.0), (11.0, 24.1)), ((90.0, 90.0), (99.0, 99.0))):
        assert terrain.nodes(low, high)[-1] == verifier.UNKNOWN_M


@pytest.mark.parametrize("asked", ["clearance", "nodes"])
@given(seed=st.integers(0, 2**32))
def test_the_page_has_the_same_heights(page: QtScript, asked: str, seed: int) -> None:
    _, record, a, b = _case(seed)
    if asked == "nodes":
        a, b = _box(a, b)
        b = (b[0] + record["step_m"] * (seed % 3), b[1], b[2])
    call = f"((all) => new Terrain(all.get('record')).{asked}(all.get('a'), all.get('b')))(readJson(bytes, 'it'))"
    found = page.call(call, json.dumps({"record": record, "a": a, "b": b}).encode())
    try:
        assert json.loads(found or "null") == getattr(verifier.Terrain(record), asked)(a, b)
    except verifier.Refused:
        assert found is None


@pytest.mark.parametrize(
    ("upper_mm", "facts", "excluded"),
    [(14_000, {}, True), (13_995, {}, False), (13_990, {"accuracy_m": 0.01}, True), (14_000, {"use": "off"}, False)],
)
def test_a_box_is_excluded_where_it_lies_too_low_above_the_terrain(
    tmp_path: Path, upper_mm: int, facts: dict[str, Any], excluded: bool
) -> None:
    files = _hut_on(upper_mm, everywhere_mm=upper_mm, **facts)
    write(files, tmp_path)
    case = verifier.Case(tmp_path, [files[name] for name in ("site.json", "plan.json", "plan.proof")])
    case.low, case.high = (-20.0, -20.0, 10.0), (18.0, 16.0, 18.999)
    told = verifier.judged(lambda: str(case._exclude(0, "t")))[0]
    assert told == ("proved" if excluded else "not proved")


def _hut_on(
    upper_mm: int | None, level_within_m: float | None = None, everywhere_mm: float = 500.0, **facts: Any
) -> dict[str, bytes]:
    """The hut above terrain with one height but at nodes below its flight, which keeps 6 m above level ground.

    `level_within_m` is what the proof says of the terrain; the plan promises 5.9 m then, less than the terrain leaves.
    """
    hut, _ = kept_hut()
    site, shape = json.loads(hut["site.json"]), (60, 60)
    heights = np.full(shape, everywhere_mm)
    heights[19:24, 24:36] = np.nan if upper_mm is None else upper_mm
    record = {**_record(np.zeros((2, 2)), (-29.0, -29.0), 1.0), "columns": 60, "rows": 60, "upper": grid_text(heights)}
    site["terrain"] = {**record, "ground": record["upper"], "lower": record["upper"], **facts}
    changed = {**hut, "site.json": json.dumps(site).encode()}
    if level_within_m is not None:
        plan, proof = json.loads(hut["plan.json"]), json.loads(hut["plan.proof"])
        plan["constraints"]["min_height_above_ground_m"] = 5.9
        changed["plan.json"] = json.dumps(plan).encode()
        changed["plan.proof"] = json.dumps({**proof, "level_within_m": level_within_m}).encode()
    return sealed(changed)


@pytest.mark.long
@pytest.mark.parametrize(
    ("files", "expected"),
    [
        (_hut_on(500), "proved"),
        (_hut_on(3000), "false"),
        (_hut_on(500, accuracy_m=3.0), "false"),
        (_hut_on(None), "not proved"),
        (_hut_on(3000, use="off"), "proved"),
        (_hut_on(500, columns=59), "not proved"),
        (_hut_on(500, upper="x"), "not proved"),
        (_hut_on(500, step_m=0.1), "not proved"),
        (_hut_on(500, heights="x"), "not proved"),
        (_hut_on(500, 0.501), "proved"),
        (_hut_on(500, 0.499), "not proved"),
        (_hut_on(520, 0.53), "not proved"),
        (_hut_on(-100, 0.501), "proved"),
        (_hut_on(-600, 0.501), "not proved"),
        (_hut_on(None, 0.501), "not proved"),
        (_hut_on(500, 0.501, use="on"), "not proved"),
        (_hut_on(500, 0.501, west_south_m=[-29.0, -21.5]), "not proved"),
        (_hut_on(500, 0.501, west_south_m=[-39.0, -29.0]), "proved"),
        (_hut_on(500, 0.501, west_south_m=[-39.1, -29.0]), "not proved"),
    ],
    ids=[
        "high enough",
        "too low",
        "not known that well",
        "not known",
        "not used",
        *["damaged"] * 2,
        "too small",
        "odd",
        "as level as stated",
        "less level than stated",
        "too far from level",
        "a dip, and level",
        "too low to be level",
        "not known, and called level",
        "held to, and called level",
        "too small in the south to be level",
        "just large enough to be level",
        "too small in the east to be level",
    ],
)
def test_heights_count_from_the_terrain(page: QtScript, tmp_path: Path, files: dict[str, bytes], expected: str) -> None:
    claims = by_module(load(), files, tmp_path)
    assert {claim.id: claim.verdict for claim in claims}["airspace"] == expected
    assert same(claims, page(files))


def test_a_node_that_is_not_known_is_the_least_integer() -> None:
    assert NOT_KNOWN == -(2**31)
