"""What is true of a plan on a site, by exact brute force: slow, for small sites only.

Files are read with the standard library and trimesh, and every number in them is the binary64 number that JSON readers
make of it. All triangles are looked at for each leg and each line of sight; nothing is left out by a bound or a tree.
"""

from __future__ import annotations

import base64
import itertools
import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, TypeAlias

from tests.planning.proof.exact import (
    BITS,
    Enclosure,
    Point,
    Triangle,
    Vector,
    closed_parts,
    cross,
    dot,
    fractions,
    is_inside,
    minus,
    segment_meets_prism,
    segment_triangle_d2,
    sine_cosine,
    sine_cosine_deg,
)

Json: TypeAlias = Mapping[str, Any]

OFFSET_M = Fraction(15, 100)
"""Lines of sight end this far in front of a panel's centroid (contract)."""

NEARLY_VERTICAL = Fraction(1, 10**6)
"""Below this horizontal length of its unit normal a panel is horizontal (contract)."""

SAME_M = Fraction(1, 1000)


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """Four corners, their mean, and the normal and tangents of any length."""

    corners: tuple[Point, Point, Point, Point]
    centroid: Vector
    normal: Vector
    t: Vector
    b: Vector

    @classmethod
    def of(cls, corners: Sequence[Sequence[float]]) -> Panel:
        """A panel from its corners."""
        points = tuple(_point(corner) for corner in corners)
        c0, c1, c2, c3 = (fractions(point) for point in points)
        n = cross(minus(c2, c0), minus(c3, c1))
        centroid = tuple(sum(values) / Fraction(4) for values in zip(c0, c1, c2, c3, strict=True))
        horizontal2 = n[0] * n[0] + n[1] * n[1]
        upright = horizontal2 >= NEARLY_VERTICAL**2 * dot(n, n)
        t: Vector = (-n[1], n[0], 0) if upright else (1, 0, 0)
        return cls(points, centroid, n, t, cross(n, t))  # type: ignore[arg-type]

    @property
    def triangles(self) -> tuple[Triangle, Triangle]:
        """The two triangles that stand for the panel."""
        a, b, c, d = self.corners
        return (a, b, c), (a, c, d)


def _point(values: Sequence[float]) -> Point:
    x, y, z = (float(value) for value in values)
    return x, y, z


def box_triangles(low: Point, high: Point) -> list[Triangle]:
    """Twelve triangles of a box."""
    corner = {
        key: tuple(high[k] if key[k] else low[k] for k in range(3)) for key in itertools.product((0, 1), repeat=3)
    }
    found: list[Triangle] = []
    for axis, side in itertools.product(range(3), (0, 1)):
        around = [(0, 0), (1, 0), (1, 1), (0, 1)]
        face = [corner[(*pair[:axis], side, *pair[axis:])] for pair in around]  # type: ignore[index]
        found += [(face[0], face[1], face[2]), (face[0], face[2], face[3])]  # type: ignore[arg-type]
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A site as the judge sees it.

    Parameters
    ----------
    site
        Content of the site file.
    meshes
        Triangles of each mesh that it names.
    """

    site: Json
    meshes: Mapping[str, tuple[Triangle, ...]]

    @property
    def panels(self) -> list[Panel]:
        """All panels, facade by facade."""
        return [_panel(repr(p["corners_enu_m"])) for facade in self.site["facades"] for p in facade["panels"]]

    @property
    def bodies(self) -> list[list[Triangle]]:
        """Meshes and boxes."""
        found = []
        if self.site.get("building_mesh") is not None:
            found.append(list(self.meshes[self.site["building_mesh"]]))
        for obstacle in self.site.get("obstacles") or ():
            if obstacle.get("box_enu_m") is not None:
                low, high = obstacle["box_enu_m"]
                found.append(box_triangles(_point(low), _point(high)))
            else:
                found.append(list(self.meshes[obstacle["mesh"]]))
        return found

    @property
    def triangles(self) -> list[Triangle]:
        """Everything solid."""
        of_panels = [triangle for panel in self.panels for triangle in panel.triangles]
        return of_panels + [triangle for body in self.bodies for triangle in body]

    @property
    def home(self) -> Point:
        """Take-off and landing."""
        return _point(self.site["home_enu_m"])

    @property
    def terrain(self) -> Json | None:
        """The terrain that heights count from."""
        found = self.site.get("terrain")
        return None if found is None or found.get("use", "auto") == "off" else found


@lru_cache(maxsize=10_000)
def _panel(corners: str) -> Panel:
    import ast

    return Panel.of(ast.literal_eval(corners))


# Where the aircraft is.


def keeps(scene: Scene, a: Point, b: Point, distance_m: Fraction) -> bool:
    """Whether every point of a segment keeps a distance from everything solid, exactly."""
    needed2 = distance_m**2
    return all(
        _are_apart(a, b, triangle, distance_m) or segment_triangle_d2(a, b, triangle) >= needed2
        for triangle in scene.triangles
    )


def _are_apart(a: Point, b: Point, triangle: Triangle, distance_m: Fraction) -> bool:
    """Whether along an axis a metre more than the distance lies between: rounding of binary64 does not matter then."""
    gap = float(distance_m) + 1.0
    for k in range(3):
        x, y, z = triangle[0][k], triangle[1][k], triangle[2][k]
        if min(a[k], b[k]) - max(x, y, z) > gap or min(x, y, z) - max(a[k], b[k]) > gap:
            return max(abs(value) for value in (a[k], b[k], x, y, z)) < 1e12
    return False


def is_in_solid(scene: Scene, p: Point) -> bool:
    """Whether a point lies in a closed part."""
    return any(_may_hold(p, part) and is_inside(p, part) for body in scene.bodies for part in _parts(tuple(body)))


@lru_cache(maxsize=1000)
def _parts(body: tuple[Triangle, ...]) -> list[list[Triangle]]:
    return closed_parts(body)


def _may_hold(p: Point, part: Sequence[Triangle]) -> bool:
    return all(
        min(corner[k] for triangle in part for corner in triangle)
        <= p[k]
        <= max(corner[k] for triangle in part for corner in triangle)
        for k in range(3)
    )


def legs(path: Sequence[Sequence[float]]) -> Iterator[tuple[Point, Point]]:
    """Legs of a path."""
    return itertools.pairwise(_point(point) for point in path)


def enters_no_fly(scene: Scene, a: Point, b: Point) -> bool:
    """Whether a leg touches a no-fly volume."""
    return any(
        segment_meets_prism(
            a, b, [(float(x), float(y)) for x, y in zone["polygon_enu_m"]], zone["floor_m"], zone["ceiling_m"]
        )
        for zone in scene.site["airspace"].get("no_fly") or ()
    )


# What a view sees.


def upper_heights(terrain: Json) -> list[list[Fraction | None]]:
    """Upper bounds of the ground by rows from the south, None where nothing is known."""
    content = zlib.decompress(base64.b64decode(terrain["upper"], validate=True))
    columns, rows = int(terrain["columns"]), int(terrain["rows"])
    if len(content) != 4 * columns * rows or min(columns, rows) < 2 or terrain["accuracy_m"] < 0:
        raise ValueError("the terrain is damaged")
    accuracy = Fraction(terrain["accuracy_m"])
    heights = [None if mm == -(2**31) else Fraction(mm, 1000) + accuracy for (mm,) in struct.iter_unpack("<i", content)]
    return [heights[k * columns : (k + 1) * columns] for k in range(rows)]


def least_above(terrain: Json, a: Point, b: Point) -> Fraction | None:
    """Least height of a leg above the terrain, exact; None where it is not known."""
    z = upper_heights(terrain)
    low, step, sizes = [Fraction(x) for x in terrain["west_south_m"]], Fraction(terrain["step_m"]), (len(z[0]), len(z))
    ends = [[(Fraction(p[i]) - low[i]) / step for p in (a, b)] for i in range(2)]
    cuts = {Fraction(0), Fraction(1)}
    for (x, y), n in zip(ends, sizes, strict=True):
        if min(x, y) < 0 or max(x, y) > n - 1:
            return None
        cuts |= {(k - x) / (y - x) for k in range(math.ceil(min(x, y)), math.floor(max(x, y)) + 1) if x != y}
    found = []
    for s, t in itertools.pairwise(sorted(cuts)):
        cell = [min(int(x + (y - x) * (s + t) / 2), n - 2) for (x, y), n in zip(ends, sizes, strict=True)]
        nodes = [height for row in z[cell[1] : cell[1] + 2] for height in row[cell[0] : cell[0] + 2]]
        if None in nodes:
            return None
        above = []
        for way in (s, (s + t) / 2, t):
            u, v = (x + (y - x) * way - k for (x, y), k in zip(ends, cell, strict=True))
            shares = ((1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v)
            ground = sum((share * (node or 0) for share, node in zip(shares, nodes, strict=True)), Fraction(0))
            above.append(Fraction(a[2]) + (Fraction(b[2]) - Fraction(a[2])) * way - ground)
        first, middle, last = above
        bend = 2 * (first + last) - 4 * middle
        slope = last - first - bend
        found += [first, last]
        if bend > 0 and 0 < -slope < 2 * bend:
            found.append(first - slope**2 / (4 * bend))
    return min(found)


class UndecidedError(Exception):
    """The enclosures are too wide to tell."""


def _decided(answer: bool | None) -> bool:
    if answer is None:
        raise UndecidedError
    return answer


_COSINE2 = {Fraction(30): Fraction(3, 4), Fraction(45): Fraction(1, 2), Fraction(60): Fraction(1, 4)}
"""Squares that are rational; of other multiples of a divisor of 90 they are not, so equality cannot be."""


@lru_cache(maxsize=1000)
def _cosine2(angle_deg: Fraction) -> Enclosure:
    if angle_deg in _COSINE2:
        return Enclosure.of(_COSINE2[angle_deg])
    _, cosine = sine_cosine(angle_deg)
    return cosine * cosine


@lru_cache(maxsize=100_000)
def ring_and_sector(panel: Panel, at: Vector, step_deg: Fraction) -> tuple[int, int] | None:
    """Ring and sector of a panel's hemisphere in which a point lies; None on or behind the panel's plane.

    With n, t and b = n x t of any length, cos2 theta = (d . n)2 / (|d|2 |n|2), and tan phi = (d . b) / (|n| d . t), so
    that squares decide everything.
    """
    d = minus(at, panel.centroid)
    along, n2 = dot(d, panel.normal), dot(panel.normal, panel.normal)
    if along <= 0:
        return None
    n_rings = round(90 / step_deg)
    borders = [_cosine2(k * step_deg) for k in range(1, n_rings)]
    ring = sum(_decided((-border * Fraction(dot(d, d) * n2)).is_at_most(-(Fraction(along) ** 2))) for border in borders)
    u, v = dot(d, panel.t), dot(d, panel.b)
    sector = 0
    if v < 0 or (v == 0 and u < 0):
        sector, u, v = 2 * n_rings, -u, -v
    rise2, run2 = Fraction(v) ** 2, Fraction(u) ** 2 * Fraction(n2)
    if u <= 0 and v > 0:
        sector, rise2, run2 = sector + n_rings, run2, rise2
    # tan2 phi >= tan2 (k step), with tan2 = 1 / cos2 - 1
    steps = sum(_decided((Enclosure.of(run2) * (Enclosure.of(1) - c)).is_at_most(c * rise2)) for c in borders)
    return ring, sector + steps if (rise2 or run2) else 0


@lru_cache(maxsize=10_000)
def axes(heading_deg: float, pitch_deg: float) -> tuple[tuple[Enclosure, ...], ...]:
    """Forward, right and up of a camera."""
    (sh, ch), (sp, cp) = sine_cosine_deg(heading_deg), sine_cosine_deg(pitch_deg)
    zero = Enclosure.of(0)
    return (cp * sh, cp * ch, sp), (ch, -sh, zero), (-(sp * sh), -(sp * ch), cp)


def _along(axis: Sequence[Enclosure], v: Vector) -> Enclosure:
    return axis[0] * Fraction(v[0]) + axis[1] * Fraction(v[1]) + axis[2] * Fraction(v[2])


def in_picture(camera: Json, view: Json, point: Vector) -> bool | None:
    """Whether a point lies in the closed picture of a view, in front of the camera."""
    sizes = tuple(Fraction(camera[name]) for name in ("sensor_width_mm", "sensor_height_mm", "focal_length_mm"))
    pose = tuple(view["position_enu_m"]), view["heading_deg"], view["gimbal_pitch_deg"]
    return _in_picture(sizes, pose, point)


@lru_cache(maxsize=100_000)
def _in_picture(sizes: tuple[Fraction, ...], pose: tuple[Point, float, float], point: Vector) -> bool | None:
    v = minus(point, fractions(pose[0]))
    forward, right, up = axes(*pose[1:])
    depth = _along(forward, v)
    answers = [None if depth.low <= 0 < depth.high else depth.low > 0]
    for axis, size in ((right, sizes[0]), (up, sizes[1])):
        half = size / (2 * sizes[2])
        answers.append(abs(_along(axis, v)).is_at_most(depth * half))
    return False if False in answers else None if None in answers else True


@lru_cache(maxsize=10_000)
def target(panel: Panel) -> Vector:
    """Where lines of sight end, to within 2^-200 m."""
    length = Enclosure.of(Fraction(dot(panel.normal, panel.normal))).root()
    scale, unit = OFFSET_M / length.low, 1 << BITS
    x, y, z = (Fraction(round((panel.centroid[k] + scale * panel.normal[k]) * unit), unit) for k in range(3))
    return x, y, z


def line_is_free(scene: Scene, panel: Panel, at: Vector) -> bool | None:
    """Whether nothing solid touches the line of sight; None where that is closer than a picometre."""
    undecided = False
    for triangle in scene.triangles:
        answer = _passes(at, panel, triangle)
        if answer is False:
            return False
        undecided |= answer is None
    return None if undecided else True


TINY = Fraction(1, 10**24)
"""Of products of lengths, m3: below it a line that is known to 2^-200 m may pass on either side."""


@lru_cache(maxsize=300_000)
def _passes(a: Vector, panel: Panel, triangle: Triangle) -> bool | None:
    """Whether a line of sight does not touch a triangle."""
    points = [fractions(corner) for corner in triangle]
    unit = max(Fraction(x).denominator for point in (a, target(panel), *points) for x in point)
    start, b, p, q, r = (_in_unit(point, unit) for point in (a, target(panel), *points))
    tiny = math.ceil(TINY * unit**3)
    normal = cross(minus(q, p), minus(r, p))
    above, below = dot(minus(start, p), normal), dot(minus(b, p), normal)
    if min(above, below) > tiny or max(above, below) < -tiny:
        return True
    ab = minus(b, start)
    sides = [dot(ab, cross(minus(x, start), minus(y, start))) for x, y in ((p, q), (q, r), (r, p))]
    if min(sides) < -tiny and max(sides) > tiny:
        return True
    crosses = min(above, below) < -tiny and max(above, below) > tiny
    return False if crosses and (min(sides) > tiny or max(sides) < -tiny) else None


@lru_cache(maxsize=100_000)
def _in_unit(point: Vector, unit: int) -> tuple[int, int, int]:
    """A point whose denominators divide a unit, as integers."""
    x, y, z = (Fraction(value) for value in point)
    return tuple(value.numerator * (unit // value.denominator) for value in (x, y, z))  # type: ignore[return-value]


def sees(scene: Scene, plan: Json, view: Json, panel: Panel) -> tuple[int, int] | None:
    """Section of a panel that a view covers, or None.

    Raises
    ------
    UndecidedError
        It lies on a border.
    """
    at = fractions(view["position_enu_m"])
    section = ring_and_sector(panel, at, Fraction(plan["constraints"]["section_step_deg"]))
    if section is None:
        return None
    answers = [in_picture(plan["camera"], view, panel.centroid)]
    farthest = plan["constraints"].get("max_distance_m")
    if farthest is not None:
        d = minus(at, panel.centroid)
        answers.append(dot(d, d) <= Fraction(farthest) ** 2)
    if plan["constraints"].get("whole_panel"):
        answers += [in_picture(plan["camera"], view, fractions(corner)) for corner in panel.corners]
    if False not in answers and plan["constraints"]["occlusion"] == "on":
        answers.append(line_is_free(scene, panel, at))
    if False in answers:
        return None
    if None in answers:
        raise UndecidedError
    return section


def most_covered(scene: Scene, plan: Json) -> int:
    """Sections that are covered, those on a border counted where any of their neighbours might be."""
    covered, undecided = set(), 0
    for j, panel in enumerate(scene.panels):
        for view in plan["viewpoints"]:
            try:
                section = sees(scene, plan, view, panel)
            except UndecidedError:
                undecided += 1
                continue
            if section is not None:
                covered.add((j, section))
    return len(covered) + undecided


# How long flying takes.


def rest_to_rest_s(length: Enclosure, speed: Enclosure, acceleration: Fraction, jerk: Fraction | None) -> Enclosure:
    """Shortest time over a straight leg from rest to rest, by the phases of the flight."""
    if length.high == 0:
        return Enclosure.of(0)
    if jerk is None:
        # Half the length is flown while the speed rises, or the highest speed is held in between.
        ramp = speed * speed / Enclosure.of(acceleration)
        short = (length / Enclosure.of(acceleration)).root() * 2
        long = length / speed + speed / Enclosure.of(acceleration)
        return _either(ramp.is_at_most(length), long, short)
    a, j = Enclosure.of(acceleration), Enclosure.of(jerk)
    least = a * a / j
    slow = (speed / j).root() * 2
    fast = speed / a + a / j
    ramp_s = _either(least.is_at_most(speed), fast, slow)
    top = ((least * least + a * length * 4).root() - least) * Fraction(1, 2)
    peaked = _either((a * least / j * 2).is_at_most(length), (top / a + a / j) * 2, (length / (j * 2)).root(3) * 4)
    return _either((speed * ramp_s).is_at_most(length), length / speed + ramp_s, peaked)


def _either(answer: bool | None, yes: Enclosure, no: Enclosure) -> Enclosure:
    if answer is None:
        return Enclosure(min(yes.low, no.low), max(yes.high, no.high))
    return yes if answer else no
