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
from tests.planning.proof.verifiers import QtScript, by_module, load

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
def test_the_page_has_the_same_clearance(page: QtScript, seed: int) -> None:
    _, record, a, b = _case(seed)
    content = json.dumps({"record": record, "a": a, "b": b}).encode()
    asked = "((all) => new Terrain(all.get('record')).clearance(all.get('a'), all.get('b')))(readJson(bytes, 'it'))"
    found = page.call(asked, content)
    try:
        assert json.loads(found or "null") == verifier.Terrain(record).clearance(a, b)
    except verifier.Refused:
        assert found is None


def _hut_on(upper_mm: int | None, **facts: Any) -> dict[str, bytes]:
    """The hut above terrain with one height but at a node below its flight; the flight keeps 5 m above level ground."""
    hut, _ = kept_hut()
    site, shape = json.loads(hut["site.json"]), (60, 60)
    heights = np.full(shape, 500.0)
    heights[19:24, 24:36] = np.nan if upper_mm is None else upper_mm
    record = {**_record(np.zeros((2, 2)), (-29.0, -29.0), 1.0), "columns": 60, "rows": 60, "upper": grid_text(heights)}
    site["terrain"] = {**record, "ground": record["upper"], "lower": record["upper"], **facts}
    return sealed({**hut, "site.json": json.dumps(site).encode()})


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
    ],
)
def test_heights_count_from_the_terrain(page: QtScript, tmp_path: Path, files: dict[str, bytes], expected: str) -> None:
    claims = by_module(load(), files, tmp_path)
    assert {claim.id: claim.verdict for claim in claims}["airspace"] == expected
    assert same(claims, page(files))


def test_a_node_that_is_not_known_is_the_least_integer() -> None:
    assert NOT_KNOWN == -(2**31)
