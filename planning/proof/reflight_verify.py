#!/usr/bin/env python3
# Copyright the Reflight authors; Apache License 2.0, http://www.apache.org/licenses/LICENSE-2.0; no warranty at all.
"""Check a flight plan against its site and its proof, trusting neither the program that made them nor the proof.

    python reflight_verify.py SITE PLAN PROOF [MISSION ...] [--json]    or    python reflight_verify.py FOLDER [--json]

Each claim comes out as `proved`, `false` or `not proved`. Exit status 0: all are proved; 1: one is false; 3: otherwise.
The proof says where to look (which plane separates a leg from a building, which view sees a section, which boxes leave
no place to see it from); all that it says is checked here on the files of site and plan. The claims are the methods of
`Case`, in order; what they say in words is what is proved, of the files and in metres of the site's frame.

Arithmetic is binary64. What is compared keeps a slack: coordinates are at most 1e5 m, and a comparison has seen at most
some 100 roundings of lengths up to 1e6 m, 1.2e-10 m each: less than E. Sines of the library are right to 1e-15.
Comparisons are written so that what is not a number proves nothing.
"""
from __future__ import annotations

import base64
import hashlib
import json
import re
import struct
import sys
import zlib
from functools import cached_property, partial
from itertools import pairwise, product
from math import ceil, cos, floor, radians, remainder, sin, sqrt
from pathlib import Path
from typing import Any

E = 1e-7  # metres kept in comparisons of lengths
R = 1e-9  # kept in comparisons of sines, and as a part of durations
SAME_M, CLIMB_M, SIGHT_OFFSET_M, USUAL_HEIGHT_M, UNKNOWN_M = 1e-3, 2.0, 0.15, 5.0, 1e9
LEVEL_M = 0.51  # a plan may take terrain that departs less from level ground as level
MISSION_M, MISSION_DEG = 0.01, 0.01  # how far a mission file may be off the plan
FALSE, NOT_PROVED, PROVED = "false", "not proved", "proved"
Vec = tuple[float, ...]
Triangle = tuple[Vec, Vec, Vec]

class Refused(Exception):  # noqa: N818
    """Why a claim is `not proved`, or what makes it `false`."""

    def __init__(self, text: str, verdict: str = NOT_PROVED) -> None:
        super().__init__(text)
        self.verdict = verdict

def demand(holds: object, text: str, verdict: str = NOT_PROVED) -> None:
    if not holds:
        raise Refused(text, verdict)


# Reading: what is not as expected is refused. Numbers are finite, keys occur once, meshes are binary PLY.

def read_json(content: bytes, what: str) -> Any:
    """JSON with all numbers as floats. One that overflows is refused where it is used."""
    def record(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        demand(len(dict(pairs)) == len(pairs), f"{what} has a key twice")
        return dict(pairs)

    try:
        text = content.decode("utf-8")
        demand(re.search(r"\\u[dD][89a-fA-F]", text) is None, f"{what} holds characters in two halves")
        hooks = {"parse_int": float, "parse_constant": partial(demand, False)}
        return json.loads(text, object_pairs_hook=record, **hooks)  # type: ignore[arg-type]
    except (ValueError, RecursionError) as error:
        raise Refused(f"{what} cannot be read as JSON") from error

def get(record: Any, name: str, kind: type, default: Any = Refused) -> Any:
    value = record.get(name) if type(record) is dict else None
    if value is None and default is not Refused:
        return default
    demand(type(value) is kind, f"'{name}' is missing or of the wrong kind")
    return value

def number(record: Any, name: str, low: float = -1e6, high: float = 1e6, default: Any = Refused) -> Any:
    value = get(record, name, float, default)
    demand(value is default or low <= value <= high, f"'{name}' is no number from {low:g} to {high:g}")
    return value

def vector(value: Any, name: str, n: int = 3, most: float = 1e5) -> Vec:
    fits = type(value) is list and len(value) == n and all([type(x) is float and abs(x) <= most for x in value])
    demand(fits, f"'{name}' has not {n} coordinates up to {most:g}")
    return tuple(value)

def place_in(value: Any, n: int, name: str) -> int:
    demand(type(value) in (int, float) and 0 <= value < n and value == floor(value), f"'{name}' names none of {n}")
    return int(value)

FIELDS = {  # A field that is not known may be a misspelled one, and what it says would be missed.
    "the site": "format name origin facades building_mesh obstacles airspace home_enu_m rally_points place_from is_bare"
    " terrain zones",
    "the airspace": "min_enu_m max_enu_m ground_z_m no_fly min_height_above_ground_m", "a facade": "id panels",
    "an obstacle": "id mesh box_enu_m", "a no-fly volume": "id polygon_enu_m floor_m ceiling_m",
    "the terrain": "west_south_m step_m columns rows ground upper lower accuracy_m use sources", "the constraints":
    "min_distance_m section_step_deg occlusion whole_panel max_distance_m min_height_above_ground_m wanted_gsd_mm"}

def known(record: Any, what: str) -> Any:
    demand(type(record) is dict and set(record) <= set(FIELDS[what].split()), f"{what} has a field that is not known")
    return record

PLY = (rb"ply\nformat binary_little_endian 1\.0\n(?:comment [ -~]*\n)*element vertex ([0-9]{1,8})\nproperty float x\n"
       rb"property float y\nproperty float z\nelement face ([0-9]{1,8})\nproperty list uchar int vertex_indices\n")

def read_ply(content: bytes) -> list[Triangle]:
    """Triangles of a mesh as Reflight writes it."""
    head, _, body = content.partition(b"end_header\n")
    found = re.fullmatch(PLY, head)
    n = int(found[1]) if found else len(content)
    demand(found and len(body) == 12 * n + 13 * int(found[2]), "the mesh is no binary PLY file of triangles alone")
    vertices = list(struct.iter_unpack("<3f", body[: 12 * n]))
    demand(all([abs(x) <= 1e5 for xyz in vertices for x in xyz]), "'vertex' has not 3 coordinates up to 100000")
    faces = list(struct.iter_unpack("<B3I", body[12 * n :]))
    demand(all([sides == 3 and max(a, b, c) < n for sides, a, b, c in faces]), "a face of the mesh is no triangle")
    return [(vertices[a], vertices[b], vertices[c]) for _, a, b, c in faces]


# Vectors, and what separates triangles from points, legs and lines of sight.

def sub(a: Vec, b: Vec) -> Vec: return a[0] - b[0], a[1] - b[1], a[2] - b[2]
def plus(a: Vec, b: Vec, k: float = 1.0) -> Vec: return a[0] + b[0] * k, a[1] + b[1] * k, a[2] + b[2] * k
def scaled(a: Vec, k: float) -> Vec: return a[0] * k, a[1] * k, a[2] * k
def dot(a: Vec, b: Vec) -> float: return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
def cross(a: Vec, b: Vec) -> Vec: return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
def length(a: Vec) -> float: return sqrt(dot(a, a))
def is_same(a: Vec, b: Vec) -> bool: return all([abs(x - y) <= SAME_M for x, y in zip(a, b, strict=False)])
def sincos(deg: float) -> tuple[float, float]: return sin(radians(deg)), cos(radians(deg))

def distance(p: Vec, triangle: Triangle) -> float:
    """Of a point from a triangle; of one that is nearly a line, from its edges."""
    edges = [(a, sub(b, a)) for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True)]
    normal = cross(edges[0][1], edges[1][1])
    is_wide = dot(normal, normal) > 1e-6 * dot(edges[0][1], edges[0][1]) * dot(edges[1][1], edges[1][1])
    if is_wide and all([dot(cross(way, sub(p, a)), normal) > 0.0 for a, way in edges]):
        return abs(dot(sub(p, triangle[0]), normal)) / length(normal)
    shares = [min(max(dot(sub(p, a), way) / max(dot(way, way), 1e-30), 0.0), 1.0) for a, way in edges]
    return min([length(sub(p, plus(a, way, share))) for (a, way), share in zip(edges, shares, strict=True)])

def quad(a: Vec, b: Vec, c: Vec, d: Vec) -> list[Triangle]: return [(a, b, c), (a, c, d)]

def prism(outline: list[Vec], low: float, high: float) -> list[Triangle]:
    """Walls, floor and cap of a prism. Fans about any corner hold the whole polygon, whatever its shape."""
    below, above = [(x, y, low) for x, y in outline], [(x, y, high) for x, y in outline]
    walls = [quad(below[k - 1], below[k], above[k], above[k - 1]) for k in range(len(outline))]
    fans = [[(ring[0], ring[k], ring[k + 1])] for ring in (below, above) for k in range(1, len(ring) - 1)]
    return [triangle for part in walls + fans for triangle in part]

class Solids:
    """Triangles in a tree of boxes: (low, high, halves, numbers of the triangles of a leaf)."""

    def __init__(self, triangles: list[Triangle]) -> None: self.triangles = triangles
    @cached_property
    def tree(self) -> Any: return self._boxes(list(range(len(self.triangles))))

    def _boxes(self, numbers: list[int]) -> Any:
        corners = [corner for k in numbers for corner in self.triangles[k]] or [(0.0, 0.0, 0.0)]
        low, high = [tuple([f([c[axis] for c in corners]) for axis in range(3)]) for f in (min, max)]
        if len(numbers) <= 4:
            return low, high, (), numbers
        sizes, half = sub(high, low), len(numbers) // 2
        axis = sizes.index(max(sizes))
        numbers = sorted(numbers, key=lambda k: (max([corner[axis] for corner in self.triangles[k]]), k))
        return low, high, [self._boxes(numbers[:half]), self._boxes(numbers[half:])], ()

    def clear(self, points: list[Vec], directions: list[Vec], gap: float) -> bool:
        """Whether directions separate each triangle by `gap` from the convex hull of points.

        Directions are shorter than 1, so that a gap along one is a lower bound of the distance.
        """
        levels = [(n, min([dot(n, p) for p in points]) - gap - E) for n in directions]
        stack = [self.tree]
        while stack:
            low, high, halves, numbers = stack.pop()
            for (x, y, z), level in levels:
                most = (high[0] if x > 0.0 else low[0]) * x + (high[1] if y > 0.0 else low[1]) * y
                if most + (high[2] if z > 0.0 else low[2]) * z <= level:
                    break
            else:
                stack.extend(halves)
                for k in numbers:
                    if not any([max([dot(n, v) for v in self.triangles[k]]) <= level for n, level in levels]):
                        return False
        return True

class Pane:
    """A panel: centroid c, normal n, tangents t and b of its hemisphere, and where lines of sight end."""

    def __init__(self, corners: list[Vec]) -> None:
        self.corners = corners
        self.c = scaled(plus(plus(corners[0], corners[1]), plus(corners[2], corners[3])), 0.25)
        across, along = sub(corners[2], corners[0]), sub(corners[3], corners[1])
        area, sizes = cross(across, along), (length(across), length(along))
        is_wide = length(area) >= max(2e-4, 1e-3 * sizes[0] * sizes[1])
        demand(is_wide and max(sizes) <= 1e3, "a panel is no pane: too thin, small or large")
        self.n = scaled(area, 1.0 / length(area))
        level = sqrt(self.n[0] * self.n[0] + self.n[1] * self.n[1])
        is_level = level <= 1e-12
        demand(is_level or level >= 1.001e-6, "a panel is neither level nor tilted by 1e-6")
        self.t = (1.0, 0.0, 0.0) if is_level else (-self.n[1] / level, self.n[0] / level, 0.0)
        self.b = cross(self.n, self.t)
        self.target = plus(self.c, self.n, SIGHT_OFFSET_M)

class Terrain:
    """Upper bound of the ground over a grid of columns and rows, bilinear in each cell."""

    def __init__(self, record: Any) -> None:
        self.corner, self.step = vector(record["west_south_m"], "west_south_m", 2), number(record, "step_m", 0.01, 1e4)
        self.size = [place_in(record[name], 100_000, name) for name in ("columns", "rows")]
        reader, accuracy = zlib.decompressobj(), number(record, "accuracy_m", 0.0, 1e4)
        content = reader.decompress(base64.b64decode(record["upper"], validate=True), 16_000_000)
        fits = min(self.size) >= 2 and len(content) == 4 * self.size[0] * self.size[1] and reader.eof
        demand(fits, "the terrain has other heights than nodes")
        nodes = [mm for (mm,) in struct.iter_unpack("<i", content)]
        self.z: list[float] = [mm / 1000.0 + accuracy if mm > -(2**31) else UNKNOWN_M for mm in nodes]

    def nodes(self, low: Vec, high: Vec) -> list[float]:
        """Heights at the corners of all cells that a box touches; beyond the grid nothing is known."""
        first = [floor((low[i] - self.corner[i]) / self.step) for i in (0, 1)]
        last = [ceil((high[i] - self.corner[i]) / self.step) for i in (0, 1)]
        is_inside = min(first) >= 0 and all([b < n for b, n in zip(last, self.size, strict=True)])
        columns, rows = [range(max(a, 0), min(b + 1, n)) for a, b, n in zip(first, last, self.size, strict=True)]
        found = [self.z[row * self.size[0] + column] for row in rows for column in columns]
        return found if is_inside else [*found, UNKNOWN_M]

    def clearance(self, a: Vec, b: Vec) -> float:
        """Least height of a leg above the ground: in each cell a polynomial of second degree along the way."""
        ends = [((a[i] - self.corner[i]) / self.step, (b[i] - self.corner[i]) / self.step) for i in (0, 1)]
        demand(all([0.0 <= x <= self.size[i] - 1.0 for i in (0, 1) for x in ends[i]]), "a leg leaves the terrain")
        lines = [(k, x, y) for x, y in ends for k in range(floor(min(x, y)) + 1, ceil(max(x, y)))]
        cuts, least = sorted([0.0, 1.0, *[(k - x) / (y - x) for k, x, y in lines]]), UNKNOWN_M
        for s, t in pairwise(cuts):
            cell = [min(floor(x + (y - x) * (s + t) * 0.5), n - 2) for (x, y), n in zip(ends, self.size, strict=True)]
            at, above = cell[1] * self.size[0] + cell[0], list[float]()
            for way in (s, (s + t) * 0.5, t):
                u, v = [x + (y - x) * way - low for (x, y), low in zip(ends, cell, strict=True)]
                south, north = [self.z[k] + (self.z[k + 1] - self.z[k]) * u for k in (at, at + self.size[0])]
                above.append(a[2] + (b[2] - a[2]) * way - (south + (north - south) * v))
            bend = 2.0 * (above[0] + above[2]) - 4.0 * above[1]
            slope = above[2] - above[0] - bend
            lowest = above[0] - slope * slope / (4.0 * bend) if 0.0 < -slope < 2.0 * bend else least
            least = min(least, lowest, *above)
        return least

def origin_of(record: Any) -> Vec:
    """Latitude, longitude and height above the ellipsoid of the local frame."""
    origin, limits = get(record, "origin", dict), (("lat_deg", 90.0), ("lon_deg", 360.0), ("ellipsoid_height_m", 1e4))
    return tuple([number(origin, name, -most, most) for name, most in limits])

def between(a_deg: float, b_deg: float) -> float:
    """Angle between two headings, up to 180 degrees."""
    return abs(remainder(a_deg - b_deg, 360.0))

def rest_to_rest(size: float, speed: float, a: float, jerk: float) -> float:
    """At most so long takes a leg from rest to rest: up to the highest speed that has room for its ramps, and down."""
    grows = a / jerk  # a ramp to a speed takes no longer than this and speed / a, and as long as a leg half as fast
    highest = min(speed, 2.0 * size / (sqrt(grows * grows + 4.0 * size / a) + grows))
    return size / highest + highest / a + grows

class Case:
    """Site, plan and proof. The methods from `files` on prove one claim each, and say in words what is proved."""

    def __init__(self, folder: Path, contents: list[bytes]) -> None:
        names = ("site", "plan", "proof")
        self.site, self.plan, self.proof = [read_json(c, f"the {n}") for c, n in zip(contents, names, strict=True)]
        for record, name in zip((self.site, self.plan, self.proof), names, strict=True):
            demand(get(record, "format", str) == f"reflight-{name}/1", f"the {name} has a format that is not known")
        self.contents, self.meshes, self.shadows = contents, dict[str, bytes](), dict[tuple[int, int], Any]()
        self._read_site(folder)
        self._read_limits(get(self.plan, "camera", dict), known(get(self.plan, "constraints", dict), "the constraints"))
        self.views: list[tuple[str, Vec, float, float]] = []
        for view in get(self.plan, "viewpoints", list):
            heading, pitch = [number(view, name, -360.0, 360.0) for name in ("heading_deg", "gimbal_pitch_deg")]
            self.views.append((get(view, "id", str), vector(view.get("position_enu_m"), "position"), heading, pitch))
        self.by_id, self.sorties = {view[0]: view for view in self.views}, get(self.plan, "sorties", list)
        self.flown = [get(sortie, "viewpoint_ids", list) for sortie in self.sorties]
        demand(all([type(name) is str for names in self.flown for name in names]), "'viewpoint_ids' holds no names")
        self.paths = [[vector(p, "path_enu_m") for p in get(sortie, "path_enu_m", list)] for sortie in self.sorties]
        self.legs = [(s, k, a, b) for s, path in enumerate(self.paths) for k, (a, b) in enumerate(pairwise(path))]
        self.directions = [vector(each, "directions") for each in get(self.proof, "directions", list)]
        demand(all([dot(n, n) <= 1.0 for n in self.directions]), "a direction of the proof is too long")

    def _read_site(self, folder: Path) -> None:
        facades = [known(each, "a facade") for each in get(known(self.site, "the site"), "facades", list)]
        panels = [get(panel, "corners_enu_m", list) for facade in facades for panel in get(facade, "panels", list)]
        corners = [[vector(corner, "corner") for corner in each] for each in panels]
        demand({len(each) for each in corners} == {4}, "a panel has not four corners, or there is none")
        triangles = [triangle for each in corners for triangle in quad(*each)]
        building = [] if self.site.get("building_mesh") is None else [{"mesh": get(self.site, "building_mesh", str)}]
        for body in building + [known(each, "an obstacle") for each in get(self.site, "obstacles", list, [])]:
            name, box = get(body, "mesh", str, None), get(body, "box_enu_m", list, [])
            demand(len(box) == (2 if name is None else 0), "an obstacle is neither a mesh nor a box")
            if name is None:
                (x, y, below), (u, v, above) = [vector(corner, "box") for corner in box]
                triangles += prism([(x, y), (u, y), (u, v), (x, v)], below, above)
                continue
            is_plain = re.fullmatch(r"(?![.]|[^\n]*/[.])[^/\\:\0-\x1f]+(/[^/\\:\0-\x1f]+)*", name)
            demand(is_plain is not None, "a mesh has a name that is no file's")
            self.meshes[name] = (folder / name).read_bytes()
            triangles += read_ply(self.meshes[name])
        self.air, walls = known(get(self.site, "airspace", dict), "the airspace"), list[Triangle]()
        for zone in get(self.air, "no_fly", list, []):
            outline = [vector(xy, "polygon", 2) for xy in get(known(zone, "a no-fly volume"), "polygon_enu_m", list)]
            walls += prism(outline, number(zone, "floor_m"), number(zone, "ceiling_m"))
        self.solids, self.no_fly = Solids(triangles), Solids(walls)
        self.panes, self.home = [Pane(each) for each in corners], vector(self.site.get("home_enu_m"), "home")
        terrain = get(self.site, "terrain", dict, None)
        use = "off" if terrain is None else get(known(terrain, "the terrain"), "use", str, "auto")
        self.terrain, self.ground = None if use == "off" else Terrain(terrain), "level ground"
        level_within = number(self.proof, "level_within_m", 0.0, LEVEL_M, default=None)
        if self.terrain and level_within is None:
            self.ground = "the terrain"
        elif self.terrain:
            ends = [vector(self.air.get(name), name) for name in ("min_enu_m", "max_enu_m")]
            departs = max([abs(z - number(self.air, "ground_z_m")) for z in self.terrain.nodes(*ends)])
            demand(use == "auto" and departs <= level_within - E, "the terrain is not as level as the proof says")
            self.terrain, self.ground = None, f"level ground, within {level_within:g} m of which the terrain lies"

    def _read_limits(self, camera: Any, limits: Any) -> None:
        low, self.high = [vector(self.air.get(name), name) for name in ("min_enu_m", "max_enu_m")]
        own_m = number(self.air, "min_height_above_ground_m", 0.0, default=USUAL_HEIGHT_M)
        self.height_m = number(limits, "min_height_above_ground_m", 0.0, default=own_m)
        ground_m = min(self.terrain.z) if self.terrain else number(self.air, "ground_z_m")
        self.low = (low[0], low[1], max(low[2], ground_m + self.height_m))
        demand(all([a < b for a, b in zip(self.low, self.high, strict=True)]), "the airspace is empty")
        self.near_m = number(limits, "min_distance_m", 0.01, 1e4)
        self.far_m = number(limits, "max_distance_m", 0.01, 1e5, default=1e6)
        self.occlusion, self.whole = get(limits, "occlusion", str), get(limits, "whole_panel", bool, False)
        demand(self.occlusion in ("on", "off"), "the plan does not say whether occlusion counts")
        step = number(limits, "section_step_deg", 1.0)
        self.rings = floor(90.0 / step + 0.5)
        demand(abs(90.0 / step - self.rings) < R, "section_step_deg is no divisor of 90")
        self.n = 4 * self.rings * self.rings
        focal_mm = number(camera, "focal_length_mm", 0.01)
        self.half = [number(camera, f"sensor_{side}_mm", 0.01) / (2.0 * focal_mm) for side in ("width", "height")]
        demand(max(self.half) <= 100.0, "the camera has no field of view")
        self.pitches = vector(camera.get("gimbal_pitch_deg"), "gimbal_pitch_deg", 2, 180.0)
        demand(self.pitches[0] <= self.pitches[1], "the gimbal has no range")
        self.steepest = [self._steepest(pitch) for pitch in (self.pitches[1], -self.pitches[0])]

    def _steepest(self, pitch_deg: float) -> float:
        """Sine of the steepest elevation upwards that comes into the picture, at least 0; 2 where nothing limits it."""
        (s, c), h = sincos(pitch_deg), self.half[1]
        is_limited = pitch_deg >= -90.0 and c - h * s > R
        return max(0.0, (s + h * c) / sqrt(1.0 + h * h) + R) if is_limited else 2.0

    def _named(self, numbers: list[Any]) -> list[Vec]:
        """Directions that the proof names for something."""
        return [self.directions[place_in(each, len(self.directions), "the proof")] for each in numbers]

    def files(self) -> str:
        meshes = {each["name"]: each["sha256"] for each in get(self.proof, "meshes", list)}
        of_site, of_plan = [self.proof[name]["sha256"] for name in ("site", "plan")]
        named = [("the site", self.contents[0], of_site), ("the plan", self.contents[1], of_plan)]
        for what, content, sha256 in named + [(f"the mesh {k}", v, meshes.get(k)) for k, v in self.meshes.items()]:
            demand(hashlib.sha256(content).hexdigest() == sha256, f"{what} has changed since the proof was made", FALSE)
        demand(set(meshes) == set(self.meshes), "the site names other meshes than the proof", FALSE)
        demand(self.plan["site_sha256"] == of_site, "the plan was made for another state of the site")
        return "site, meshes and plan are those of the proof, and the plan was made for this site"

    def sorties_(self) -> str:
        home, origin = self.plan.get("home_enu_m"), self.plan.get("origin")
        demand(home is None or vector(home, "home") == self.home, "plan and site have another home", FALSE)
        is_there = origin is None or origin_of(self.plan) == origin_of(self.site)
        demand(is_there, "plan and site have another origin", FALSE)
        flown = [name for names in self.flown for name in names]
        demand(len(flown) > 0, "there is no viewpoint")
        is_once = len(self.views) == len(flown) == len(self.by_id) and set(flown) == set(self.by_id)
        demand(is_once, "a viewpoint is not in one sortie", FALSE)
        for s, path in enumerate(self.paths):
            demand(len(path) >= 3, f"sortie {s + 1} has no path", FALSE)
            for end, beside in ((path[0], path[1]), (path[-1], path[-2])):
                is_above = is_same(beside[:2], self.home) and beside[2] >= self.home[2] + CLIMB_M - SAME_M
                why = f"sortie {s + 1} does not go straight up from home, and down to it"
                demand(is_same(end, self.home) and is_above, why, FALSE)
            demand(not get(self.sorties[s], "in_passing_ids", list, []), "photos are taken in passing")
            self.photos_of(s)
        return f"{len(flown)} viewpoints, each on the path of one of {len(self.paths)} sorties from home to home"

    def photos_of(self, s: int) -> list[int]:
        """The vertex of each photo of a sortie, in order; photos at one place may share a vertex."""
        path, found = self.paths[s], [-1]
        for name in self.flown[s]:
            demand(name in self.by_id, "an unknown viewpoint is flown", FALSE)
            place, last = self.by_id[name][1], found[-1]
            ahead = [k for k in range(last + 1, len(path)) if is_same(path[k], place)][:1]
            shared = [last] if ahead != [last + 1] and last >= 0 and is_same(path[last], place) else ahead
            demand(len(shared) == 1, f"{name} is not on the path of sortie {s + 1}, in order", FALSE)
            found += shared
        return found[1:]

    def gimbal(self) -> str:
        low, high = self.pitches
        for name, _, heading, pitch in self.views:
            demand(low <= pitch <= high and -180.0 < heading <= 180.0, f"{name} has angles out of range", FALSE)
        return f"all photos have a gimbal pitch from {low:g} to {high:g} degrees"

    def airspace(self) -> str:
        for s, k, a, b in self.legs:
            in_column, lowest = is_same(a[:2], self.home) and is_same(b[:2], self.home), min(a[2], b[2])
            spare = lowest - min(self.home[2], self.low[2]) + SAME_M if in_column else lowest - self.low[2] - E
            inside = max(a[2], b[2]) <= self.high[2]
            inside = inside and all([self.low[i] <= p[i] <= self.high[i] for p in (a, b) for i in (0, 1)])
            if self.terrain and inside and not in_column:
                spare = min(spare, self.terrain.clearance(a, b) - self.height_m - E)
            is_false = not inside or -1e6 < spare < -2.0 * E
            why = f"sortie {s + 1}, leg {k + 1} leaves the airspace, or is lower than {self.height_m:g} m over ground"
            demand(inside and spare >= 0.0, why, FALSE if is_false else NOT_PROVED)
        return f"outside the column above home, paths stay in the airspace and {self.height_m:g} m above {self.ground}"

    def _leaves(self, solids: Solids) -> None:
        """Home is outside: the polyline `outside` of the proof leads from it past all triangles, meeting none."""
        way = [vector(p, "outside") for p in get(self.proof, "outside", list)]
        starts = all([path[:1] == way[:1] == [self.home] for path in self.paths])
        low, high, _, _ = solids.tree
        far = any([way[-1][i] <= low[i] - E or way[-1][i] >= high[i] + E for i in range(3)])
        demand(starts and far, "no way is shown from home to outside of everything")
        for ends, by in zip(pairwise(way), self.proof["outside_directions"], strict=True):
            free = solids.clear(list(ends), self._named(by), 0.0)
            demand(free, "the way from home to outside of everything is not free")

    def distance(self) -> str:
        for s, k, a, b in self.legs:
            if not self.solids.clear([a, b], self._named(self.proof["legs"][s][k]), self.near_m):
                places = (a, b, scaled(plus(a, b), 0.5))
                is_near = any([distance(p, each) <= self.near_m - E for each in self.solids.triangles for p in places])
                why = f"sortie {s + 1}, leg {k + 1}: {self.near_m:g} m from everything are not kept"
                raise Refused(why, FALSE if is_near else NOT_PROVED)
        self._leaves(self.solids)
        return f"every leg keeps {self.near_m:g} m from every panel, mesh and obstacle, and lies outside of them"

    def no_fly_(self) -> str:
        for s, k, a, b in self.legs:
            kept = self.no_fly.clear([a, b], self._named(self.proof["no_fly"][s][k]), 0.0)
            demand(kept, f"sortie {s + 1}, leg {k + 1} may enter a no-fly volume")
        self._leaves(self.no_fly)
        return "no leg enters a no-fly volume of the site"

    def zones(self) -> str:
        demand(not get(self.site, "zones", list, []), "files of geo-zones are not looked at")
        return "the site names no files of geo-zones"

    def return_(self, height_m: float | None = None) -> str:
        above_m = number(self.proof, "return_height_m", 0.0) if height_m is None else height_m
        kept_m, (x, y, z) = number(self.proof, "return_kept_m", 0.5 * self.near_m, self.near_m), self.home
        level = z + above_m
        demand(level <= self.high[2], "the height of return is above the airspace", FALSE)
        for s, k, a, b in self.legs:
            tops, by = (max(a[2], level), max(b[2], level)), self._named(self.proof["returns"][s][k])
            climb: list[Vec] = [a, b, (a[0], a[1], tops[0]), (b[0], b[1], tops[1])]
            home: list[Vec] = [(p[0], p[1], top) for p in (a, b, self.home) for top in tops]
            for part in (climb, home, [self.home, *[(x, y, top) for top in tops]]):
                kept = self.solids.clear(part, by, kept_m) and self.no_fly.clear(part, by, 0.0)
                why = f"the return from sortie {s + 1}, leg {k + 1} may come nearer than {kept_m:g} m to something"
                demand(kept, why)
        return (f"from everywhere: up to {above_m:g} m above take-off, level home and down keeps {kept_m:g} m, outside "
                "no-fly volumes")

    def battery(self) -> str:
        craft, rules = get(self.plan, "aircraft", dict), get(self.plan, "rules", dict, {})
        usual = {"max_wind_m_s": 10.0, "max_ascent_m_s": 4.0, "max_descent_m_s": 3.0, "max_acceleration_m_s2": 2.5,
                 "max_yaw_rate_deg_s": 60.0, "max_gimbal_rate_deg_s": 60.0, "max_jerk_m_s3": 1e30}
        windy, up, down, a, yaw, tilt, jerk = [number(craft, k, 0.01, default=usual[k]) for k in usual]
        usual = {"wind_m_s": 0.0, "settle_s": 2.0, "photo_s": 1.0, "takeoff_landing_s": 30.0, "battery_reserve": 0.25}
        wind, settle, photo, ends, reserve = [number(rules, k, 0.0, default=usual[k]) for k in usual]
        speed, most = number(craft, "max_speed_m_s", 0.01) - wind, number(rules, "max_speed_m_s", 0.01, default=1e6)
        demand(wind < windy and speed > 0.0, "the wind is too strong", FALSE)
        stop = max(settle + photo, number(craft, "min_photo_interval_s", 0.0, default=0.7))
        usable = number(craft, "endurance_s", 0.0) * (1.0 - reserve)
        for s, path in enumerate(self.paths):
            views = [self.by_id[name] for name in self.flown[s]]
            total, least, (before, tilted) = ends, ends, (views[0][2] + 180.0, 0.0)
            for _, _, heading, pitch in views:  # where it turns on its way, that takes no longer
                total = total + stop + max(between(heading, before) / yaw, abs(pitch - tilted) / tilt)
                least, before, tilted = least + stop, heading, pitch
            for p, q in pairwise(path):
                (x, y, z), size = sub(q, p), length(sub(q, p))
                pace = max(sqrt(x * x + y * y) / min(speed, most), abs(z) / min(up if z > 0.0 else down, most))
                total = total + (rest_to_rest(size, size / pace, a, jerk) if size > 0.0 else 0.0)
                least = least + pace
            total, stated = total * (1.0 + R), number(self.sorties[s], "duration_s", 0.0)
            verdict = FALSE if max(least * (1.0 - R), stated) > usable + 0.01 else NOT_PROVED
            why = f"sortie {s + 1} takes up to {max(total, stated):.1f} s, the battery with its reserve {usable:.1f} s"
            demand(max(total, stated) <= usable + 0.01, why, verdict)
        kept = f"({100.0 * reserve:g} % kept), stopping at every vertex"
        return f"each sortie ends within {usable:g} s of the battery {kept}"

    def apart(self) -> str:
        at_once = number(get(self.plan, "rules", dict, {}), "at_once", default=1.0)
        demand(at_once == 1.0 and not any(["start_s" in each for each in self.sorties]), "several aircraft fly at once")
        return "one aircraft flies at a time"

    def angle(self, k: int) -> tuple[float, float]: return sincos(90.0 / self.rings * k)

    def _section(self, element: int) -> tuple[Pane, int, int]:
        return self.panes[element // self.n], *divmod(element % self.n, 4 * self.rings)

    def lies_in(self, place: Vec, element: int, sight: list[Any]) -> bool:
        """Whether a place surely lies in a section, near enough, with nothing between."""
        pane, ring, sector = self._section(element)
        d, ((s0, c0), (s1, c1)) = sub(place, pane.c), (self.angle(sector), self.angle(sector + 1))
        away, along, u, v = length(d), dot(d, pane.n), dot(d, pane.t), dot(d, pane.b)
        kept = [away <= self.far_m - E, c0 * v - s0 * u >= E, s1 * u - c1 * v >= E]
        kept += [ring == 0 or along <= self.angle(ring)[1] * away - E, along >= self.angle(ring + 1)[1] * away + E]
        if not all(kept) or self.occlusion == "off":
            return all(kept)
        return self.solids.clear([place, pane.target], self._named(sight), 0.0)

    def covers(self, view: tuple[str, Vec, float, float], element: int) -> bool:
        (_, place, heading, pitch), pane = view, self.panes[element // self.n]
        (s, c), (sp, cp) = sincos(heading), sincos(pitch)
        forward, right, up = (cp * s, cp * c, sp), (c, -s, 0.0), (-sp * s, -sp * c, cp)
        rays = [sub(point, place) for point in [pane.c, *(pane.corners if self.whole else [])]]
        axes = zip((right, up), self.half, strict=True)
        spare = [dot(forward, v) * half - abs(dot(axis, v)) for axis, half in axes for v in rays]
        sight = self.proof["sights"][element] if self.occlusion == "on" else []
        return min(spare) >= E and self.lies_in(place, element, sight)

    def coverage(self) -> str:
        stated, seen = get(self.plan, "coverage", dict), get(self.proof, "seen", list)
        total, covered = len(self.panes) * self.n, number(stated, "covered", 0.0)
        demand(number(stated, "total") == total, f"there are {total} sections, the plan states another number", FALSE)
        views = [(e, place_in(k, len(self.views), "seen")) for e, k in enumerate(seen) if k != -1.0]
        found = sum([self.covers(self.views[view], element) for element, view in views])
        demand(found >= covered, f"{found} of {covered:g} sections are shown to be covered")
        return f"at least {covered:g} of {total} sections are covered, occlusion {self.occlusion}"

    def reachable(self) -> str:
        total, most, done, shown = len(self.panes) * self.n, len(self.panes) * len(self.views), set(), 0
        bound = number(get(self.plan, "coverage", dict), "reachable_upper_bound")
        for row in get(self.proof, "boxes", list):
            done.add(place_in(row[0], total, "boxes"))
            self._exclude(int(row[0]), row[1])
        for element, x, y, z, by in get(self.proof, "witnesses", list):
            place = vector([x, y, z], "witnesses")
            inside = all([a <= p <= b for a, p, b in zip(self.low, place, self.high, strict=True)])
            inside = inside and (not self.terrain or self.terrain.clearance(place, place) >= self.height_m + E)
            inside = inside and self.solids.clear([place], self._named(by), self.near_m)
            shown += inside and self.lies_in(place, place_in(element, total, "witnesses"), by)
        demand(total - len(done) <= bound, f"{len(done)} of {total - bound:g} sections are shown to be out of reach")
        return (f"no flight in this airspace, {self.height_m:g} m above {self.ground}, with this gimbal and "
                f"{self.near_m:g} m from everything covers more than {bound:g} of {total} sections ({shown} not "
                f"covered have a place shown), {len(self.views)} photos no more than {min(bound, most):g}")

    def _exclude(self, element: int, text: str) -> None:
        """A tree of boxes leaves no place from which a section is seen.

        What rules out a box is that a function is negative in it. All of them are convex, so the corners tell.
        """
        pane, ring, sector = self._section(element)
        (s0, c0), (s1, c1), (s, c) = [self.angle(k) for k in (sector, sector + 1, ring + 1)]
        sides = [pane.n, plus(scaled(pane.b, c0), pane.t, -s0), plus(scaled(pane.t, s1), pane.b, -c1)]
        cones: list[tuple[Vec, float]] = [((0.0, 0.0, -1.0), self.steepest[0]), ((0.0, 0.0, 1.0), self.steepest[1])]
        cones += [(pane.n, self.angle(ring)[1])]
        boxes, at = list[tuple[Vec, Vec]]([(self.low, self.high)]), 0
        while boxes:
            (low, high), leaf = boxes.pop(), re.compile(r"[XYZpct]|[dq]([0-9]{1,7})\.").match(text, at)
            demand(leaf is not None, "a tree of the proof is damaged")
            at, kind, k = leaf.end(), leaf[0][0], leaf[1]  # type: ignore[union-attr, index]
            if kind in "XYZ":
                axis = "XYZ".index(kind)
                middle = ((low[axis] + high[axis]) * 0.5,)
                boxes.append((low[:axis] + middle + low[axis + 1 :], high))
                boxes.append((low, high[:axis] + middle + high[axis + 1 :]))
                continue
            corners: list[Vec] = list(product(*zip(low, high, strict=True)))
            rays = [sub(corner, pane.c) for corner in corners]
            if kind == "p":  # on the far side of a plane that has the section on the other
                forms, centre = [(m, 0.0) for m in sides], plus(rays[0], rays[7])
                u, v = dot(centre, pane.t), dot(centre, pane.b)
                side = sqrt(u * u + v * v)
                if side > E:
                    radial = plus(scaled(pane.t, u / side), pane.b, v / side)
                    forms.append((plus(scaled(pane.n, s), radial, -c), 0.0))
                    forms.append((scaled(centre, -1.0 / length(centre)), -self.far_m))
                holds = any([max([dot(m, d) for d in rays]) <= limit - E for m, limit in forms])
            elif kind == "c":  # in the cone below the section's ring, or where the gimbal does not reach
                holds = any([all([dot(axis, d) >= cosine * length(d) + E for d in rays]) for axis, cosine in cones])
            elif kind == "t":  # too low above the terrain
                heights = self.terrain.nodes(low, high) if self.terrain else [-UNKNOWN_M]
                holds = high[2] <= min(heights) + self.height_m - SAME_M
            elif kind == "d":  # too close to a triangle
                holds = all([distance(corner, self.solids.triangles[int(k)]) <= self.near_m - E for corner in corners])
            else:
                holds = self.occlusion == "on" and self._is_hidden(element // self.n, int(k), corners)
            demand(holds, f"box {at} of section {element} is not excluded")

    def _is_hidden(self, panel: int, patch: int, corners: list[Vec]) -> bool:
        """Whether a box lies in the shadow of triangles as seen from a panel's target.

        Each triangle is turned so that it winds to the left around the directions in it, and edges in both
        directions cancel. All lie in front of the target, and so does the box, beyond their planes. A direction that
        the edges left all wind around to the left is wound around at least once, and so lies in some triangle.
        """
        eye = self.panes[panel].target
        if (panel, patch) not in self.shadows:
            faces, edges = list[tuple[Vec, Vec]](), set[tuple[Vec, Vec]]()
            for each in self.proof["patches"][patch]:
                a, b, c = self.solids.triangles[place_in(each, len(self.solids.triangles), "patches")]
                u, v, w = sub(a, eye), sub(b, eye), sub(c, eye)
                volume, normal = dot(cross(u, v), w), cross(sub(b, a), sub(c, a))
                is_wide = length(normal) >= 1e-6 * length(sub(b, a)) * length(sub(c, a))
                is_wide = is_wide and abs(volume) >= R * length(u) * length(v) * length(w)
                demand(is_wide, "a triangle of a patch is too thin, or is seen edge on")
                b, c, sign = (b, c, 1.0) if volume > 0.0 else (c, b, -1.0)
                faces.append((a, scaled(normal, sign / length(normal))))
                ahead = all([dot(faces[0][1], d) >= E for d in (u, v, w)])
                for edge in ((a, b), (b, c), (c, a)):
                    demand(ahead and edge not in edges, "a patch is not in front, or has an edge twice")
                    edges ^= {edge} if edge[::-1] not in edges else {edge[::-1]}
            ends = [(sub(a, eye), sub(b, eye)) for a, b in edges]
            self.shadows[panel, patch] = faces, [scaled(cross(u, v), 1.0 / (length(u) * length(v))) for u, v in ends]
        (faces, planes), rays = self.shadows[panel, patch], [sub(corner, eye) for corner in corners]
        beyond = all([dot(n, sub(corner, a)) >= R * length(sub(corner, a)) + E for a, n in faces for corner in corners])
        left = all([dot(m, d) >= R * length(d) for m in planes for d in rays])
        return beyond and left and planes != []


# Mission files. They are taken as Reflight writes them, and anything else in them proves nothing.

def enu(origin: Vec, lat_deg: float, lon_deg: float, height_m: float) -> Vec:
    """A WGS 84 place in the frame of an origin (latitude, longitude, height), within 1e-7 m."""
    def geocentric(lat: float, lon: float, height: float) -> Vec:
        (s, c), (sin_lon, cos_lon), e2 = sincos(lat), sincos(lon), 0.0066943799901413165
        n = 6378137.0 / sqrt(1.0 - e2 * s * s)
        return (n + height) * c * cos_lon, (n + height) * c * sin_lon, (n * (1.0 - e2) + height) * s

    (s, c), (sin_lon, cos_lon) = sincos(origin[0]), sincos(origin[1])
    d, north, up = sub(geocentric(lat_deg, lon_deg, height_m), geocentric(*origin)), -s, c
    east = dot((-sin_lon, cos_lon, 0.0), d)
    return east, dot((north * cos_lon, north * sin_lon, c), d), dot((up * cos_lon, up * sin_lon, s), d)

def members(content: bytes, names: tuple[bytes, ...]) -> list[str]:
    """Texts of an archive that holds nothing else than these deflated members."""
    at, texts, directory, damaged = 0, list[str](), b"", "the archive is not as Reflight writes it"
    for name in names:
        mark, _, flags, method, _, _, crc, packed, size, n_name, n_extra = struct.unpack_from("<4s5H3I2H", content, at)
        start, reader = at + 30 + len(name), zlib.decompressobj(-15)
        text = reader.decompress(content[start : start + packed], 100_000_000)
        head = (mark, flags, method, n_name, n_extra, content[at + 30 : start]) == (b"PK\3\4", 0, 8, len(name), 0, name)
        whole = reader.eof and not reader.unused_data and (len(text), zlib.crc32(text)) == (size, crc)
        demand(head and whole, damaged)
        directory += b"PK\1\2\x14\3" + content[at + 4 : at + 30] + struct.pack("<3H2I", 0, 0, 0, 0o644 << 16, at) + name
        at, texts = start + packed, [*texts, text.decode("ascii")]
    end = b"PK\5\6" + struct.pack("<4H2IH", 0, 0, len(names), len(names), len(directory), at, 0)
    demand(content[at:] == directory + end, damaged)
    return texts

def rule(text: str) -> re.Pattern[str]:
    """A rule of a file: `@x` is a number named x, `#` any number, `*` a value, `~` values; (a|b)? as in expressions."""
    text = text.replace("\n", "").replace("[", r"\[").replace("]", r"\]").replace(".", "[.]").replace("(", "(?:")
    text = text.replace("#", NUMBER).replace("*", r"[^;\[\]]*").replace("~", r"[^\[\]]*")
    for name in dict.fromkeys(re.findall("@([a-z])", text)):
        text = text.replace(f"@{name}", f"(?P<{name}>{NUMBER})", 1).replace(f"@{name}", f"(?P={name})")
    return re.compile(text)

NUMBER, STOP = r"-?[0-9]+(?:\.[0-9]+)?", "toPointAndStopWithDiscontinuityCurvature"
ACTION = "action[actionId=#;actionActuatorFunc={};actionActuatorFuncParam[{}]]"
HELD = ACTION.format("setFocusType", "cameraFocusType=manual;payloadPositionIndex=0;")
KMZ_ORDER, KMZ = "H(O(GP+K)?C)*E", {name: rule(text) for name, text in {
    "H": f"""Document[(author=*;createTime=#;updateTime=#;)?missionConfig[flyToWaylineMode=safely;finishAction=goHome;
exitOnRCLost=(goContinue|executeLostAction);executeRCLostAction=goBack;takeOffSecurityHeight=@c;(takeOffRefPoint=*;
takeOffRefPointAGLHeight=0;)?globalTransitionalSpeed=@v;globalRTHHeight=@r;droneInfo[~]waylineAvoidLimitAreaMode=0;
payloadInfo[~]]Folder[(templateType=waypoint;templateId=0;waylineCoordinateSysParam[coordinateMode=WGS84;heightMode=
(relativeToStartPoint|EGM96);]autoFlightSpeed=#;globalHeight=#;caliFlightEnable=0;gimbalPitchMode=manual;
globalWaypointHeadingParam[waypointHeadingMode=fixed;~]globalWaypointTurnMode={STOP};globalUseStraightLine=1;|
templateId=0;executeHeightMode=(relativeToStartPoint|WGS84);waylineId=0;distance=#;duration=#;autoFlightSpeed=#;)""",
    "O": f"""Placemark[Point[coordinates=@x,@y;]index=@i;(executeHeight=@z;waypointSpeed=@v;|ellipsoidHeight=@e;
height=@t;)waypointHeadingParam[waypointHeadingMode=(fixed|smoothTransition);~](waypointTurnParam[
waypointTurnMode={STOP};waypointTurnDampingDist=0;]|useGlobalHeight=0;useGlobalSpeed=1;useGlobalHeadingParam=0;
useGlobalTurnParam=1;)
useStraightLine=1;""",
    "G": """actionGroup[actionGroupId=#;actionGroupStartIndex=@i;actionGroupEndIndex=@i;actionGroupMode=sequence;
actionTrigger[actionTriggerType=reachPoint;]""",
    "P": ACTION.format("rotateYaw", "aircraftHeading=@h;aircraftPathMode=*;") + ACTION.format("gimbalRotate", """
gimbalHeadingYawBase=north;gimbalRotateMode=absoluteAngle;gimbalPitchRotateEnable=1;gimbalPitchRotateAngle=@p;
gimbalRollRotateEnable=0;gimbalRollRotateAngle=0;gimbalYawRotateEnable=0;gimbalYawRotateAngle=0;
gimbalRotateTimeEnable=0;gimbalRotateTime=0;payloadPositionIndex=0;""")
    + f"({ACTION.format('zoom', 'focalLength=@q;isUseFocalFactor=0;payloadPositionIndex=0;')})?({HELD})?"
    + f"({ACTION.format('focus', '~')})?({HELD})?({ACTION.format('hover', 'hoverTime=@w;')})?"
    + ACTION.format("takePhoto", "fileSuffix=*;payloadPositionIndex=0;useGlobalPayloadLensIndex=1;"
                    "(payloadLensIndex=(visable|wide);)?"),
    "E": """(payloadParam[payloadPositionIndex=0;focusMode=(firstPoint|custom);meteringMode=average;imageFormat=
(visable|wide);])?]]$""",
    "K": "]", "C": "(waypointGimbalHeadingParam[~]isRisky=0;waypointWorkType=0;|isRisky=0;)]"}.items()}
MAVLINK_ORDER, MAVLINK = "T[VX]*[ABW]*L", {name: rule(text) for name, text in {  # rows: frame, command, seven numbers
    "T": "3 22 0 0 0 (0|nan) @y @x @z/", "L": "3 21 0 0 0 (0|nan) @y @x @z/", "V": "2 178 1 @v -1 0 0 0 0/",
    "A": """2 205 @p 0 0 0 0 0 2/2 115 @h 0 0 0 0 0 0/3 16 @s 0 0 0 @y @x @z/(2 532 5 0 0 0 0 0 0/2 93 @f -1 -1 -1 0 0
 0/)?2 203 0 0 0 0 1 0 0/2 93 @w -1 -1 -1 0 0 0/""",
    "B": """2 1000 @p 0 nan nan 12 0 0/3 16 @s 0.5 0 @h @y @x @z/(2 532 5 0 0 0 0 0 0/3 16 @f 0.5 0 @h @y @x @z/)?
2 2000 0 0 1 # 0 0 0/3 16 @w 0.5 0 @h @y @x @z/""",
    "X": "(2 1001 -2 -2 -1 -1 0 0 0|2 202 4 # # # 0 0 0|2 532 # # 0 0 0 0 0)/",
    "W": "3 16 1 (0 0 0|0.5 0 nan) @y @x @z/"}.items()}
ITEM_KEYS = {"AMSLAltAboveTerrain", "Altitude", "AltitudeMode", "autoContinue", "command", "doJumpId", "frame",
             "params", "type", "viewpointId"}

def rows_of_plan(content: bytes) -> list[str]:
    plan, rows = read_json(content, "the mission"), []
    mission, rally = get(plan, "mission", dict), get(get(plan, "rallyPoints", dict, {}), "points", list, [])
    modes = plan["fileType"], plan["version"], mission["version"], mission["globalPlanAltitudeMode"], rally
    demand(modes == ("Plan", 1.0, 2.0, 1.0, []), "no mission as Reflight writes it, or one with rally points")
    for item in get(mission, "items", list):
        row = [item["frame"], item["command"], *item["params"]]
        again = item.get("Altitude", row[8]), item.get("AltitudeMode", 1.0), item["type"], item["autoContinue"]
        is_known = set(item) <= ITEM_KEYS and len(row) == 9 and again == (row[8], 1.0, "SimpleItem", True)
        is_known = is_known and {type(x) for x in (*row, *again[:2])} <= {float, type(None)}
        demand(is_known and item["autoContinue"] is True, "an item is not as Reflight writes it")
        rows.append(" ".join(["nan" if x is None else repr(x).removesuffix(".0") for x in row]))
    return rows

def rows_of_lines(content: bytes) -> list[str]:
    head, home, *lines, last = content.decode("ascii").split("\n")
    demand((head, home[:9], last) == ("QGC WPL 110", "0\t1\t0\t16\t", ""), "no QGC WPL 110 with home")
    rows = [re.fullmatch(rf"{n}\t0\t((?:[-0-9.a-z]+\t){{9}})1", line) for n, line in enumerate(lines, 1)]
    demand(None not in rows, "a line is not as Reflight writes it")
    return [row[1].strip().replace("\t", " ") for row in rows]  # type: ignore[index]

def flat(text: str) -> str:
    """XML in one line: name=value; and name[...]."""
    prolog = ('<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2" '
              'xmlns:wpml="http://www.dji.com/wpmz/1.0.6">\n')
    is_kml = text.startswith(prolog) and text.endswith("\n</kml>\n")
    demand(is_kml, "a part of the archive is not as Reflight writes it")
    text = re.sub(">\n *<", "><", text[len(prolog) : -8].strip(" "))
    text = re.sub(r"<(wpml:(?!coordinates)[a-z][A-Za-z]*|coordinates)>([^<>=;&\[\]]*)</\1>", r"\1=\2;", text)
    text = re.sub("<(wpml:[a-z][A-Za-z]*|Document|Folder|Placemark|Point)>", r"\1[", text)
    return re.sub("</(wpml:[a-z][A-Za-z]*|Document|Folder|Placemark|Point)>", "]", text).replace("wpml:", "")

class Mission:
    """What a mission file flies: places (latitude, longitude, height) and photos (number of place, heading, pitch).

    Heights of return are those at which an aircraft flies home by itself; there are none where it does not.
    """

    def __init__(self, content: bytes, kind: str) -> None:
        demand(kind in (".kmz", ".plan", ".waypoints"), "no mission file that is read here: .kmz, .plan or .waypoints")
        self.is_dji, self.is_relative, self.speeds, self.zooms = kind == ".kmz", True, [0.0], list[float]()
        if self.is_dji:
            template, lines = members(content, (b"wpmz/template.kml", b"wpmz/waylines.wpml"))
            self.is_relative = "executeHeightMode>relativeToStartPoint<" in lines
            prepared, flown = [self._flown(flat(text), KMZ, KMZ_ORDER) for text in (template, lines)]
            is_one = ["templateType" in text for text in (template, lines)] == [True, False] and prepared == flown
            demand(is_one, "template.kml and waylines.wpml fly different places or photos", FALSE)
        else:
            rows = (rows_of_plan if kind == ".plan" else rows_of_lines)(content)
            flown = self._flown("/".join([*rows, ""]), MAVLINK, MAVLINK_ORDER)
        self.places, self.photos, self.returns = flown

    def _flown(self, text: str, rules: dict[str, re.Pattern[str]], order: str) -> tuple[list[Vec], list[Vec], Any]:
        """Places, photos and heights of return that the blocks of a text say."""
        places, photos, returns, letters, at = list[Vec](), list[Vec](), list[float](), "", 0
        while at < len(text):
            letter, found = next(((k, m) for k, each in rules.items() if (m := each.match(text, at))), ("", None))
            demand(found is not None, f"what follows place {len(places)} is not as Reflight writes it")
            at, letters = found.end(), letters + letter  # type: ignore[union-attr]
            n = {k: float(v) for k, v in found.groupdict().items() if v is not None}  # type: ignore[union-attr]
            if "x" in n:
                place = n["y"], n["x"], n["z"] if "z" in n else n["t" if self.is_relative else "e"]
                shifts = [sub(place, last) for last in places[-1:] if not self.is_dji]  # MAVLink repeats one to wait
                is_again = [max(abs(x), abs(y)) <= 1e-8 and abs(z) <= SAME_M for x, y, z in shifts]
                places += [] if any(is_again) else [place]
            photos += [(len(places) - 1.0, n["h"], n["p"])] if "h" in n else []
            returns, self.zooms = returns + [n[k] for k in "cr" if k in n], self.zooms + [n[k] for k in "q" if k in n]
            self.speeds = self.speeds + [n.get("v", 0.0)]
            waits = [n[k] for k in "swf" if k in n]
            is_right = all([0.0 <= wait <= 60.0 for wait in waits]) and n.get("i", len(places) - 1) == len(places) - 1
            demand(is_right and all([abs(x) <= 1e6 for x in n.values()]), "a wait or a number is wrong")
        demand(re.fullmatch(order, letters) is not None, "its parts are not in the order in which Reflight writes them")
        demand(all([height > 0.0 for height in returns]), "a height of return is not above take-off")
        return places, photos, returns

def flies(case: Case, mission: Mission) -> int:
    """The sortie that a mission flies."""
    (x, y, z), frame = case.home, origin_of(case.site)
    demand(abs(x) <= 2000.0 and abs(y) <= 2000.0, "home is more than 2 km from the origin")
    base = frame[2] + z + (x * x + y * y) / 12742000.0 if mission.is_relative else 0.0
    places = [enu(frame, lat, lon, base + height) for lat, lon, height in mission.places]
    demand(max(mission.speeds) <= number(case.plan["aircraft"], "max_speed_m_s") + MISSION_M, "it is too fast", FALSE)
    of_film = 43.2666 / (2.0 * sqrt(case.half[0] * case.half[0] + case.half[1] * case.half[1]))
    demand(all([abs(zoom - of_film) <= 1.0 for zoom in mission.zooms]), "it zooms", FALSE)
    if mission.is_dji:
        case.return_(max(mission.returns))
    for s, path in enumerate(case.paths):
        last = len(path) - mission.is_dji  # DJI missions end above home, and return from there
        kept = [k for k in range(1, last) if k == 1 or not is_same(path[k], path[k - 1])]
        at = [sum([1 for j in kept if j <= k]) - 1.0 for k in case.photos_of(s)]
        views = [case.by_id[name] for name in case.flown[s]]
        if len(places) == len(kept) and len(views) == len(mission.photos):
            same = [length(sub(p, path[k])) <= MISSION_M for p, k in zip(places, kept, strict=True)]
            for (_, _, heading, pitch), k, photo in zip(views, at, mission.photos, strict=True):
                same.append(photo[0] == k and max(between(photo[1], heading), abs(photo[2] - pitch)) <= MISSION_DEG)
            if all(same):
                return s
    raise Refused("it flies no sortie of the plan: places, their order, or photos differ", FALSE)

CLAIMS = (
    ("files", Case.files), ("sorties", Case.sorties_), ("gimbal", Case.gimbal), ("airspace", Case.airspace),
    ("distance", Case.distance), ("no-fly", Case.no_fly_), ("zones", Case.zones), ("return", Case.return_),
    ("battery", Case.battery), ("apart", Case.apart), ("coverage", Case.coverage), ("reachable", Case.reachable))
def judged(prove: Any) -> tuple[str, str]:
    """Verdict and words of a claim. What trips over a file proves nothing."""
    try:
        return PROVED, prove()
    except Refused as refused:
        return refused.verdict, str(refused)
    except Exception as error:
        return NOT_PROVED, f"a file is not as expected ({type(error).__name__})"

def verify(site: Path, plan: Path, proof: Path, missions: list[Path]) -> list[dict[str, str]]:
    """All claims, in order: each with its id, verdict and text."""
    cases, flown = list[Case](), dict[str, list[int]]()

    def opened() -> str:
        cases.append(Case(site.parent, [each.read_bytes() for each in (site, plan, proof)]))
        return ""

    def flies_a_sortie(path: Path) -> str:
        s = flies(cases[0], Mission(path.read_bytes(), path.suffix))
        flown.setdefault(path.suffix, []).append(s)
        return f"flies sortie {s + 1}: the same places in the same order within {MISSION_M:g} m, the same photos"

    def flown_once() -> str:
        whole = all([verdict == PROVED for _, verdict, _ in found[len(CLAIMS) :]])
        whole = whole and all([sorted(each) == list(range(len(cases[0].paths))) for each in flown.values()])
        demand(whole, "not every sortie is flown once")
        return "the files of each kind fly every sortie once"

    unread, found = judged(opened), list[tuple[str, str, str]]()
    claims = [(name, partial(claim, *cases)) for name, claim in CLAIMS]
    claims += [(f"mission {path.name}", partial(flies_a_sortie, path)) for path in missions]
    for name, claim in claims + [("missions", flown_once)] * bool(missions):
        found.append((name, *(judged(claim) if cases else unread)))
    return [{"id": name, "verdict": verdict, "text": text} for name, verdict, text in found]

def jobs_of(folder: Path) -> list[list[Path]]:
    """Site, plan, proof and missions of each proof in a folder: X.kmz and X-2.kmz are those of X.kmz.mission.proof."""
    jobs = []
    for proof in sorted(folder.glob("*.proof")):
        named = read_json(proof.read_bytes(), proof.name)
        files = [folder / Path(named[each]["name"]).name for each in ("site", "plan")]
        stem, _, kind = proof.name.removesuffix(".mission.proof").rpartition(".")
        names = re.compile(f"{re.escape(stem)}(-[0-9]+)?[.]{re.escape(kind)}" if kind != "proof" else "(?!)")
        jobs.append([*files, proof, *[path for path in sorted(folder.iterdir()) if names.fullmatch(path.name)]])
    return jobs

def main() -> int:
    """Check what the command line names; the exit status."""
    paths, as_json = [Path(each) for each in sys.argv[1:] if each != "--json"], "--json" in sys.argv
    jobs = jobs_of(paths[0]) if len(paths) == 1 else [paths]
    if not jobs or len(jobs[0]) < 3:
        print("usage: reflight_verify.py SITE PLAN PROOF [MISSION ...] [--json], or FOLDER", file=sys.stderr)
        return 2
    claims = [claim for site, plan, proof, *missions in jobs for claim in verify(site, plan, proof, missions)]
    lines = [f"{each['verdict']:>10}  {each['id']}: {each['text']}" for each in claims]
    print(json.dumps({"claims": claims}) if as_json else "\n".join(lines))
    verdicts = {claim["verdict"] for claim in claims}
    return 1 if FALSE in verdicts else 0 if verdicts == {PROVED} else 3

if __name__ == "__main__":
    sys.exit(main())
