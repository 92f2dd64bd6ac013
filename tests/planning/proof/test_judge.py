"""The judge itself: closed forms, other programs, and what planning measured."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.bvh import segment_triangle_d2 as kernel_d2
from tests.planning.proof import claims
from tests.planning.proof.claims import CLAIMS, Case, duration_s, judged
from tests.planning.proof.exact import (
    Enclosure,
    closed_parts,
    is_inside,
    pi,
    segment_meets_prism,
    segment_triangle_d2,
    sine_cosine_deg,
)
from tests.planning.proof.judge import box_triangles, most_covered
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.verifiers import mission_names

TRIANGLE = ((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 3.0, 0.0))

coordinates = st.floats(-10.0, 10.0)
points = st.tuples(coordinates, coordinates, coordinates)


@pytest.mark.parametrize(
    ("a", "b", "d2"),
    [
        ((1.0, 1.0, 2.0), (1.0, 1.0, 5.0), Fraction(4)),  # an end above the inside
        ((1.0, 1.0, 2.0), (1.0, 1.0, -2.0), Fraction(0)),  # through it
        ((-1.0, -1.0, 0.0), (5.0, -1.0, 0.0), Fraction(1)),  # beside an edge, in the plane
        ((4.0, 3.0, -1.0), (4.0, 3.0, 1.0), Fraction(144, 25)),  # across the long edge
        ((4.0, 0.0, 0.0), (9.0, 0.0, 0.0), Fraction(0)),  # touching a corner
    ],
)
def test_squared_distances_are_exact(a: claims.Point, b: claims.Point, d2: Fraction) -> None:
    assert segment_triangle_d2(a, b, TRIANGLE) == d2


@given(points, points, points, points, points)
def test_squared_distances_are_those_of_the_kernel(
    a: claims.Point, b: claims.Point, p: claims.Point, q: claims.Point, r: claims.Point
) -> None:
    exact = math.sqrt(segment_triangle_d2(a, b, (p, q, r)))
    assert math.sqrt(kernel_d2(np.array(a), np.array(b), np.array([p, q, r]))) == pytest.approx(exact, abs=1e-6)


@given(st.floats(-720.0, 720.0))
def test_sines_enclose_those_of_forty_digits(angle_deg: float) -> None:
    with mpmath.workdps(50):
        for enclosure, function in zip(sine_cosine_deg(angle_deg), (mpmath.sin, mpmath.cos), strict=True):
            truth = function(mpmath.mpf(angle_deg) * mpmath.pi / 180)
            assert abs(mpmath.mpf(enclosure.low.numerator) / enclosure.low.denominator - truth) < 1e-45
            assert 0 <= enclosure.high - enclosure.low < Fraction(1, 10**45)


def test_roots_enclose() -> None:
    for value in (Fraction(2), Fraction(1, 3), Fraction(10**12)):
        for degree in (2, 3):
            root = Enclosure.of(value).root(degree)
            assert root.low**degree <= value <= root.high**degree
            assert root.high - root.low < Fraction(1, 10**55)
    assert pi().low < Fraction(355, 113) < pi().high + Fraction(1, 10**6)


def test_the_inside_of_a_box_is_known_from_its_outside() -> None:
    (part,) = closed_parts(box_triangles((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    assert is_inside((0.5, 0.5, 0.5), part)
    assert is_inside((1.0, 2.0, 3.0), part)
    assert not is_inside((1.0 + 1e-12, 0.5, 0.5), part)
    assert closed_parts(box_triangles((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))[:-1]) == []


def test_a_prism_is_entered_where_polygon_and_heights_are() -> None:
    notched = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)]
    assert segment_meets_prism((2.0, 0.5, 1.0), (2.0, 0.5, 9.0), notched, 0.0, 2.0)
    assert not segment_meets_prism((2.0, 3.0, 1.0), (2.0, 1.0 + 1e-12, 1.0), notched, 0.0, 2.0)
    assert segment_meets_prism((2.0, 3.0, 1.0), (2.0, 1.0, 1.0), notched, 0.0, 2.0)
    assert not segment_meets_prism((-5.0, 1.0, 3.0), (5.0, 1.0, 2.0 + 1e-12), notched, 0.0, 2.0)
    assert segment_meets_prism((-5.0, 1.0, 3.0), (5.0, 1.0, 1.0), notched, 0.0, 2.0)


def test_what_planning_says_of_the_hut_is_true() -> None:
    files, places = kept_hut()
    case = Case(files, places)
    for claim in (*CLAIMS, *(f"mission {name}" for name in mission_names(files)), "missions"):
        assert judged(case, claim) is not False, claim
    assert most_covered(case.scene, case.plan) == case.plan["coverage"]["covered"]
    (sortie,) = case.plan["sorties"]
    assert float(duration_s(case, sortie).low) == pytest.approx(sortie["duration_s"], abs=0.051)


def test_places_that_planning_found_are_places_to_see_from() -> None:
    files, places = kept_hut()
    case = Case(files, places)
    seen = [element for element, place in places if claims.can_see(case, element, place)]
    assert len(seen) == len(places) == case.plan["coverage"]["reachable_upper_bound"]


@pytest.mark.parametrize(
    ("claim", "record", "name", "value"),
    [
        ("distance", "constraints", "min_distance_m", 5.0),
        ("coverage", "coverage", "covered", 4),
        ("reachable", "coverage", "reachable_upper_bound", 29),
        ("battery", "aircraft", "endurance_s", 60.0),
        ("gimbal", "camera", "gimbal_pitch_deg", [-90.0, -40.0]),
        ("airspace", "constraints", "min_height_above_ground_m", 6.001),
        ("apart", "rules", "at_once", 2),
    ],
)
def test_what_is_stated_too_high_is_false(claim: str, record: str, name: str, value: object) -> None:
    files, places = kept_hut()
    plan = json.loads(files["plan.json"])
    plan[record][name] = value
    assert judged(Case({**files, "plan.json": json.dumps(plan).encode()}, places), claim) is False


def test_a_leg_through_the_building_or_a_volume_is_false() -> None:
    files, places = kept_hut()
    plan = json.loads(files["plan.json"])
    path = plan["sorties"][0]["path_enu_m"]
    for claim, vertex in (("distance", [0.0, 3.0, 3.5]), ("no-fly", [-16.0, 0.0, 10.0])):
        changed = [*path[:2], vertex, *path[2:]]
        plan["sorties"][0]["path_enu_m"] = changed
        assert len(list(pairwise(changed))) == len(path)
        assert judged(Case({**files, "plan.json": json.dumps(plan).encode()}, places), claim) is False
