"""Exact geometry for judging proofs: rational numbers, and enclosures 200 bits wide where a number is irrational.

Nothing here shares code or method with the planner or with the verifiers. Points are tuples of binary64 numbers as they
stand in files, taken as the rational numbers that they are; within one question all of them become integers in a common
unit. An answer is True, False, or None where 200 bits do not tell.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TypeAlias

Point: TypeAlias = tuple[float, float, float]
Triangle: TypeAlias = tuple[Point, Point, Point]
Number: TypeAlias = int | Fraction
Vector: TypeAlias = tuple[Number, Number, Number]

BITS = 200


def minus(a: Vector, b: Vector) -> Vector:
    """Difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a: Vector, b: Vector) -> Number:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def fractions(point: Iterable[float]) -> Vector:
    """A point in exact numbers."""
    return _fractions(tuple(point))


@lru_cache(maxsize=100_000)
def _fractions(point: tuple[float, ...]) -> Vector:
    x, y, z = (Fraction(value) for value in point)
    return x, y, z


def in_one_unit(points: Sequence[Point]) -> tuple[list[tuple[int, int, int]], int]:
    """Points as integers, and how many of the unit make one metre."""
    ratios = [[float(value).as_integer_ratio() for value in point] for point in points]
    unit = max(below for point in ratios for _, below in point)
    return [tuple(above * (unit // below) for above, below in point) for point in ratios], unit  # type: ignore[misc]


# Squared distances. All are quotients of integers.


def _point_segment_d2(p: Vector, a: Vector, b: Vector) -> Fraction:
    ab, ap = minus(b, a), minus(p, a)
    along, length = dot(ap, ab), dot(ab, ab)
    if along <= 0:
        return Fraction(dot(ap, ap))
    if along >= length:
        bp = minus(p, b)
        return Fraction(dot(bp, bp))
    return Fraction(dot(ap, ap) * length - along * along, length)


def _segment_segment_d2(a: Vector, b: Vector, c: Vector, d: Vector) -> Fraction:
    ab, cd, ca = minus(b, a), minus(d, c), minus(a, c)
    aa, bb, ab_cd = dot(ab, ab), dot(cd, cd), dot(ab, cd)
    of_ab, of_cd = dot(ab, ca), dot(cd, ca)
    den = aa * bb - ab_cd * ab_cd
    if den > 0:
        s, t = ab_cd * of_cd - of_ab * bb, aa * of_cd - ab_cd * of_ab
        if 0 <= s <= den and 0 <= t <= den:
            normal = cross(ab, cd)
            return Fraction(dot(ca, normal) ** 2, dot(normal, normal))
    ends = ((a, c, d), (b, c, d), (c, a, b), (d, a, b))
    return min(_point_segment_d2(*each) for each in ends)


def _holds(triangle: Sequence[Vector], normal: Vector, p: Vector, scale: Number) -> bool:
    """Whether p / scale, a point of the plane, lies in the closed triangle."""
    for i in range(3):
        a, b = triangle[i], triangle[(i + 1) % 3]
        at = tuple(p[k] - scale * a[k] for k in range(3))
        if dot(cross(minus(b, a), at), normal) < 0:  # type: ignore[arg-type]
            return False
    return True


def _point_triangle_d2(p: Vector, triangle: Sequence[Vector], normal: Vector) -> Fraction:
    length2 = dot(normal, normal)
    if length2 > 0:
        height = dot(minus(p, triangle[0]), normal)
        foot = tuple(p[k] * length2 - height * normal[k] for k in range(3))
        if _holds(triangle, normal, foot, length2):  # type: ignore[arg-type]
            return Fraction(height * height, length2)
    return min(_point_segment_d2(p, triangle[i], triangle[(i + 1) % 3]) for i in range(3))


@lru_cache(maxsize=300_000)
def segment_triangle_d2(a: Point, b: Point, triangle: Triangle) -> Fraction:
    """Exact squared distance of a closed segment to a closed triangle, either of which may be degenerate, m2."""
    (p, q, *corners), unit = in_one_unit((a, b, *triangle))
    normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
    above, below = dot(minus(p, corners[0]), normal), dot(minus(q, corners[0]), normal)
    if above * below <= 0 and above != below:
        at = tuple(p[k] * abs(below) + q[k] * abs(above) for k in range(3))
        if _holds(corners, normal, at, abs(above) + abs(below)):  # type: ignore[arg-type]
            return Fraction(0)
    of_ends = min(_point_triangle_d2(p, corners, normal), _point_triangle_d2(q, corners, normal))
    of_edges = min(_segment_segment_d2(p, q, corners[i], corners[(i + 1) % 3]) for i in range(3))
    return Fraction(min(of_ends, of_edges)) / unit**2


def meets(a: Point, b: Point, triangle: Triangle) -> bool:
    """Whether a closed segment touches a closed triangle."""
    return segment_triangle_d2(a, b, triangle) == 0


# Solids.


def closed_parts(triangles: Sequence[Triangle]) -> list[list[Triangle]]:
    """Parts of which each edge lies in an even number of triangles; vertices are the same where they are equal."""
    owner: dict[frozenset[Point], list[int]] = {}
    proper = [triangle for triangle in triangles if len(set(triangle)) == 3]
    for i, triangle in enumerate(proper):
        for k in range(3):
            owner.setdefault(frozenset((triangle[k], triangle[(k + 1) % 3])), []).append(i)
    label = list(range(len(proper)))

    def root(i: int) -> int:
        while label[i] != i:
            i = label[i]
        return i

    for owners in owner.values():
        for i in owners[1:]:
            label[root(i)] = root(owners[0])
    parts: dict[int, list[int]] = {}
    for i in range(len(proper)):
        parts.setdefault(root(i), []).append(i)
    odd = {root(owners[0]) for owners in owner.values() if len(owners) % 2}
    return [[proper[i] for i in members] for start, members in parts.items() if start not in odd]


def is_inside(p: Point, part: Sequence[Triangle]) -> bool:
    """Whether a point lies in a closed part, its skin included: parity of a ray that meets no edge."""
    if any(segment_triangle_d2(p, p, triangle) == 0 for triangle in part):
        return True
    at = fractions(p)
    exact = [tuple(fractions(corner) for corner in triangle) for triangle in part]
    for attempt in itertools.count(1):
        ray: Vector = (Fraction(1009 + attempt, 1000), Fraction(337 * attempt, 997), Fraction(211, 499 + attempt))
        crossings = [_ray_crosses(at, ray, triangle) for triangle in exact]
        if None not in crossings:
            return sum(1 for crossing in crossings if crossing) % 2 == 1
    raise AssertionError


def _ray_crosses(p: Vector, ray: Vector, triangle: Sequence[Vector]) -> bool | None:
    """Whether a ray goes through a triangle; None where it touches its border or runs in its plane."""
    a, b, c = (minus(corner, p) for corner in triangle)
    sides = [dot(ray, cross(a, b)), dot(ray, cross(b, c)), dot(ray, cross(c, a))]
    if all(side > 0 for side in sides) or all(side < 0 for side in sides):
        normal = cross(minus(b, a), minus(c, a))
        return dot(a, normal) * dot(ray, normal) > 0
    if any(side > 0 for side in sides) and any(side < 0 for side in sides):
        return False
    return None


def segment_meets_prism(
    a: Point, b: Point, polygon: Sequence[tuple[float, float]], floor_m: float, ceiling_m: float
) -> bool:
    """Whether a closed segment touches a closed vertical prism over a polygon (even-odd, border included)."""
    p, q = fractions(a), fractions(b)
    low, high = Fraction(floor_m), Fraction(ceiling_m)
    start, end = Fraction(0), Fraction(1)
    rise = q[2] - p[2]
    if rise == 0:
        if not low <= p[2] <= high:
            return False
    else:
        first, last = sorted(((low - p[2]) / rise, (high - p[2]) / rise))
        start, end = max(start, first), min(end, last)
        if start > end:
            return False
    flat = [(Fraction(x), Fraction(y)) for x, y in polygon]
    u = tuple(p[k] + start * (q[k] - p[k]) for k in range(2))
    v = tuple(p[k] + end * (q[k] - p[k]) for k in range(2))
    return _in_polygon(u, flat) or any(  # type: ignore[arg-type]
        _cross_flat(u, v, flat[i], flat[(i + 1) % len(flat)])  # type: ignore[arg-type]
        for i in range(len(flat))
    )


Flat: TypeAlias = tuple[Number, Number]


def _turn(a: Flat, b: Flat, c: Flat) -> Number:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _on_flat(p: Flat, a: Flat, b: Flat) -> bool:
    between = all(min(a[k], b[k]) <= p[k] <= max(a[k], b[k]) for k in range(2))
    return between and _turn(a, b, p) == 0


def _cross_flat(a: Flat, b: Flat, c: Flat, d: Flat) -> bool:
    """Whether two closed segments of the plane have a common point."""
    if any(_on_flat(p, *segment) for p, segment in ((a, (c, d)), (b, (c, d)), (c, (a, b)), (d, (a, b)))):
        return True
    return _turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0


def _in_polygon(p: Flat, polygon: Sequence[Flat]) -> bool:
    edges = list(zip(polygon, (*polygon[1:], polygon[0]), strict=True))
    if any(_on_flat(p, a, b) for a, b in edges):
        return True
    inside = False
    for a, b in edges:
        if (a[1] > p[1]) != (b[1] > p[1]):
            at = a[0] + Fraction(p[1] - a[1]) / Fraction(b[1] - a[1]) * (b[0] - a[0])
            inside ^= p[0] < at
    return inside


# Irrational numbers, between two rational ones.


@dataclass(frozen=True, slots=True)
class Enclosure:
    """A real number between two rational ones."""

    low: Fraction
    high: Fraction

    @classmethod
    def of(cls, value: float | Fraction | Enclosure) -> Enclosure:
        """A number as an enclosure."""
        return value if isinstance(value, Enclosure) else cls(Fraction(value), Fraction(value))

    def __add__(self, other: float | Fraction | Enclosure) -> Enclosure:
        b = Enclosure.of(other)
        return _rounded(self.low + b.low, self.high + b.high)

    def __neg__(self) -> Enclosure:
        return Enclosure(-self.high, -self.low)

    def __sub__(self, other: float | Fraction | Enclosure) -> Enclosure:
        return self + -Enclosure.of(other)

    def __mul__(self, other: float | Fraction | Enclosure) -> Enclosure:
        b = Enclosure.of(other)
        ends = [x * y for x in (self.low, self.high) for y in (b.low, b.high)]
        return _rounded(min(ends), max(ends))

    def __truediv__(self, other: float | Fraction | Enclosure) -> Enclosure:
        b = Enclosure.of(other)
        if b.low <= 0 <= b.high:
            raise ZeroDivisionError
        return self * _rounded(1 / b.high, 1 / b.low)

    def __abs__(self) -> Enclosure:
        if self.low >= 0:
            return self
        return -self if self.high <= 0 else Enclosure(Fraction(0), max(-self.low, self.high))

    def root(self, degree: int = 2) -> Enclosure:
        """Square or cube root of a number that is not negative."""
        return _rounded(_root(max(self.low, Fraction(0)), degree, 0), _root(self.high, degree, 1))

    def most(self, other: float | Fraction | Enclosure) -> Enclosure:
        """The larger one of two."""
        b = Enclosure.of(other)
        return Enclosure(max(self.low, b.low), max(self.high, b.high))

    def least(self, other: float | Fraction | Enclosure) -> Enclosure:
        """The smaller one of two."""
        return -((-self).most(-Enclosure.of(other)))

    def is_at_most(self, other: float | Fraction | Enclosure) -> bool | None:
        """Whether this number is not above another one; None where that is not known."""
        b = Enclosure.of(other)
        if self.high <= b.low:
            return True
        return False if self.low > b.high else None


def _rounded(low: Fraction, high: Fraction) -> Enclosure:
    """Outward to multiples of 2^-BITS, unless an end is short already."""
    unit = 1 << BITS
    if low.denominator > unit:
        low = Fraction(math.floor(low * unit), unit)
    if high.denominator > unit:
        high = Fraction(math.ceil(high * unit), unit)
    return Enclosure(low, high)


def _root(value: Fraction, degree: int, up: int) -> Fraction:
    unit = 1 << BITS
    whole = math.floor(value * unit**degree) if not up else math.ceil(value * unit**degree)
    low, high = 0, 1 << (whole.bit_length() // degree + 1)
    if degree == 2:
        low = math.isqrt(whole)
    else:
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if middle**degree <= whole else (low, middle)
    exact = low**degree == whole and whole == value * unit**degree
    return Fraction(low + (0 if exact else up), unit)


def _arctan_of_inverse(n: int, unit: int) -> int:
    """atan(1 / n) in units, a little short or long."""
    term, total, k = unit // n, 0, 1
    while term:
        total += term // k if k % 4 == 1 else -(term // k)
        term //= n * n
        k += 2
    return total


@lru_cache(maxsize=1)
def pi() -> Enclosure:
    """Pi, by Machin's formula."""
    unit = 1 << (BITS + 40)
    value = 4 * (4 * _arctan_of_inverse(5, unit) - _arctan_of_inverse(239, unit))
    return _rounded(Fraction(value - 10_000, unit), Fraction(value + 10_000, unit))


@lru_cache(maxsize=100_000)
def sine_cosine(angle_deg: Fraction) -> tuple[Enclosure, Enclosure]:
    """Sine and cosine of an angle in degrees; exact at multiples of 90."""
    turns = angle_deg % 360
    quarter, rest = divmod(turns, 90)
    if rest == 0:
        sine, cosine = Enclosure.of(0), Enclosure.of(1)
    else:
        x = pi() * (rest / 180)
        sine, cosine = _series(x, 1), _series(x, 0)
    for _ in range(int(quarter)):
        sine, cosine = cosine, -sine
    return sine, cosine


def _series(x: Enclosure, first: int) -> Enclosure:
    """x^k / k! with alternating signs from k = `first` on in steps of 2, for 0 <= x < 2."""
    term = x if first else Enclosure.of(1)
    total, k, square = Enclosure.of(0), first, x * x
    while True:
        total += term
        term = -(term * square) * Fraction(1, (k + 1) * (k + 2))
        k += 2
        size = max(abs(term.low), abs(term.high))
        if size < Fraction(1, 1 << (BITS - 8)):
            return _rounded(total.low - size, total.high + size)


def sine_cosine_deg(angle_deg: float) -> tuple[Enclosure, Enclosure]:
    """`sine_cosine` of a number in a file."""
    return sine_cosine(Fraction(angle_deg))


def twice_counted(names: Iterable[str]) -> list[str]:
    """Names that occur more than once."""
    return [name for name, n in Counter(names).items() if n > 1]
