"""What the verifier's geometry says is true in exact arithmetic, wherever boxes, legs, panels and views lie."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.proof import reflight_verify as verifier
from planning.proof.separation import _least_norm
from tests.planning.proof.claims import Case as JudgedCase
from tests.planning.proof.claims import can_see
from tests.planning.proof.exact import Point, Triangle, fractions, segment_triangle_d2
from tests.planning.proof.judge import Panel as JudgedPanel
from tests.planning.proof.judge import UndecidedError, ring_and_sector
from tests.planning.proof.scenes import kept_hut

FAR_M = 9e4
"""Nearly as far from the origin as coordinates may be: rounding is largest there."""


@dataclass
class Opened:
    """The hut as the verifier and as the judge have it."""

    case: verifier.Case
    judged: JudgedCase


@pytest.fixture(scope="module")
def hut(tmp_path_factory: pytest.TempPathFactory) -> Opened:
    files, _ = kept_hut()
    folder = tmp_path_factory.mktemp("hut")
    (folder / "shop.ply").write_bytes(files["shop.ply"])
    case = verifier.Case(folder, [files[name] for name in ("site.json", "plan.json", "plan.proof")])
    return Opened(case, JudgedCase(files))


seeds = st.integers(0, 2**32)


def _point(random: Random, size: float, centre: Sequence[float] = (0.0, 0.0, 0.0)) -> Point:
    x, y, z = (c + random.uniform(-size, size) for c in centre)
    return x, y, z


def _triangle(random: Random, centre: Sequence[float]) -> Triangle:
    corners = [_point(random, 10.0 ** random.uniform(-3, 1), centre) for _ in range(3)]
    if random.random() < 0.2:
        corners[2] = corners[random.randrange(2)]
    return corners[0], corners[1], corners[2]


@given(seeds)
def test_what_is_separated_keeps_its_distance(seed: int) -> None:
    random = Random(seed)
    centre = _point(random, random.choice((0.0, 50.0, FAR_M)))
    triangles = [_triangle(random, centre) for _ in range(random.randint(1, 12))]
    a, b = _point(random, 12.0, centre), _point(random, 12.0, centre)
    exact = [segment_triangle_d2(a, b, triangle) for triangle in triangles]
    nearest = math.sqrt(min(exact))
    vectors = [_between([a, b], triangle) for triangle in triangles]
    vectors += [[random.gauss(0, 1) for _ in range(3)] for _ in range(20)]
    directions = []
    for vector in vectors:
        size = math.hypot(*vector)
        if size > 0.0:
            directions.append(tuple(0.9999999999999 * x / size for x in vector))
    gap = nearest + random.choice((-1e-3, -1e-6, -2e-7, -1e-7, -1e-9, 0.0, 1e-12, 1e-7)) * random.random()
    if gap > 0.0 and verifier.Solids(triangles).clear([a, b], directions, gap):
        assert min(exact) >= Fraction(gap) ** 2


def _between(leg: list[Point], triangle: Triangle) -> list[float]:
    """The vector from the nearest point of a triangle to that of a leg."""
    found = np.zeros(3)
    _least_norm((np.array(leg)[:, None] - np.array(triangle)).reshape(-1, 3), found)
    vector: list[float] = found.tolist()
    return vector


@given(seeds)
def test_a_distance_from_a_triangle_is_never_too_small(seed: int) -> None:
    random = Random(seed)
    centre = _point(random, random.choice((0.0, FAR_M)))
    triangle, p = _triangle(random, centre), _point(random, 12.0, centre)
    away, least = verifier.distance(p, triangle), math.sqrt(segment_triangle_d2(p, p, triangle))
    assert away >= least - 1e-8
    if math.dist(triangle[0], triangle[1]) > 1e-3 and triangle[2] not in triangle[:2]:
        assert away <= least + 1e-4


@pytest.mark.long
@given(seeds)
def test_a_box_is_excluded_only_where_no_place_in_it_sees_the_section(hut: Opened, seed: int) -> None:
    random, case, judged = Random(seed), hut.case, hut.judged
    size = 10.0 ** random.uniform(-2.0, 1.0)
    centre = [random.uniform(low, high) for low, high in zip(case.low, case.high, strict=True)]
    kept = case.low, case.high
    low = tuple(max(c - size, m) for c, m in zip(centre, kept[0], strict=True))
    high = tuple(min(c + size, m) for c, m in zip(centre, kept[1], strict=True))
    n_patches, n_triangles = len(case.proof["patches"]), len(case.solids.triangles)
    leaves = ["p", "c", *(f"d{k}." for k in range(n_triangles)), *(f"q{k}." for k in range(n_patches))]
    places = [_inside(random, low, high) for _ in range(4)]
    case.low, case.high = low, high
    try:
        for element in range(len(case.panes) * case.n):
            if any(_is_excluded(case, element, leaf) for leaf in leaves):
                assert not any(can_see(judged, element, place) for place in places), (element, low, high)
    finally:
        case.low, case.high = kept


def _inside(random: Random, low: Sequence[float], high: Sequence[float]) -> Point:
    """A place in a box, often on its border."""
    shares = [random.choice((0.0, 1.0, random.random())) for _ in range(3)]
    x, y, z = (a if s == 0.0 else b if s == 1.0 else a + s * (b - a) for a, b, s in zip(low, high, shares, strict=True))
    return x, y, z


def _is_excluded(case: verifier.Case, element: int, leaf: str) -> bool:
    try:
        case._exclude(element, leaf)
    except verifier.Refused:
        return False
    return True


@given(seeds)
def test_random_patches_hide_only_what_is_hidden(hut: Opened, seed: int) -> None:
    random, case = Random(seed), hut.case
    n = len(case.solids.triangles)
    patch = [float(random.randrange(n)) for _ in range(random.choice((1, 2, 2, 4, 12)))]
    if random.random() < 0.4:
        start = random.randrange(4, n, 2)
        patch = [float(k) for k in range(start, min(start + random.choice((2, 4, 12)), n))]
    panel = random.randrange(len(case.panes))
    kept = case.proof["patches"]
    case.proof["patches"] = [patch]
    case.shadows.clear()
    size = 10.0 ** random.uniform(-2.0, 0.5)
    try:
        for _ in range(30):
            centre = [random.uniform(low, high) for low, high in zip(case.low, case.high, strict=True)]
            low, high = [c - size for c in centre], [c + size for c in centre]
            corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
            try:
                is_hidden = case._is_hidden(panel, 0, corners)
            except verifier.Refused:
                return
            if is_hidden:
                eye = case.panes[panel].target
                for _ in range(3):
                    place = _inside(random, low, high)
                    triangles = [case.solids.triangles[int(k)] for k in patch]
                    assert any(segment_triangle_d2(place, eye, triangle) < 1e-20 for triangle in triangles)
    finally:
        case.proof["patches"] = kept
        case.shadows.clear()


@given(seeds)
def test_a_place_lies_in_a_section_exactly(hut: Opened, seed: int) -> None:
    random, case = Random(seed), hut.case
    centre = _point(random, random.choice((0.0, 100.0, FAR_M)))
    corners = _pane(random, centre)
    try:
        pane = verifier.Pane(corners)
    except verifier.Refused:
        return
    panel = JudgedPanel.of(corners)
    kept = case.panes[0], case.occlusion
    case.panes[0], case.occlusion = pane, "off"
    try:
        for place in _near_borders(random, case, pane):
            claimed = [element for element in range(case.n) if case.lies_in(place, element, [])]
            assert len(claimed) <= 1
            if claimed:
                try:
                    pair = ring_and_sector(panel, fractions(place), Fraction(90) / case.rings)
                except UndecidedError:
                    pair = None
                assert pair == divmod(claimed[0], 4 * case.rings)
    finally:
        case.panes[0], case.occlusion = kept


def _pane(random: Random, centre: Point) -> list[Point]:
    """A panel of any shape that may be one: tilted, thin, warped, nearly level."""
    u = [random.gauss(0, 1) for _ in range(3)]
    v = [random.gauss(0, 1) for _ in range(3)]
    if random.random() < 0.3:
        u[2] = v[2] = 0.0
        v[2] = random.choice((0.0, 1e-5, 1e-7))
    wide, high = (10.0 ** random.uniform(-2, 1.5) for _ in range(2))
    if random.random() < 0.3:
        v = [x + 10.0 ** random.uniform(-9, -1) * y for x, y in zip(u, v, strict=True)]
    found = []
    for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
        x, y, z = (c + a * wide * p + b * high * q for c, p, q in zip(centre, u, v, strict=True))
        found.append((x, y, z))
    return found


def _near_borders(random: Random, case: verifier.Case, pane: verifier.Pane) -> list[Point]:
    """Places in front of a panel, on borders between sections but for next to nothing."""
    found = []
    for _ in range(6):
        theta = math.radians(90.0 / case.rings * random.randint(0, case.rings)) + random.choice(
            (0.0, 1e-9, -1e-9, 1e-7, 0.3)
        )
        phi = math.radians(90.0 / case.rings * random.randint(0, 4 * case.rings)) + random.choice(
            (0.0, 1e-9, -1e-9, 1e-7, 0.2)
        )
        away = 10.0 ** random.uniform(-3, 2.5)
        d = [
            away * (math.cos(theta) * n + math.sin(theta) * (math.cos(phi) * t + math.sin(phi) * b))
            for n, t, b in zip(pane.n, pane.t, pane.b, strict=True)
        ]
        x, y, z = (c + e for c, e in zip(pane.c, d, strict=True))
        found.append((x, y, z))
    return found
