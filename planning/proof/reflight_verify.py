#!/usr/bin/env python3
# Copyright the Reflight authors; Apache License 2.0, http://www.apache.org/licenses/LICENSE-2.0; no warranty of any kind.
"""Check a flight plan against its site and its proof, trusting neither the program that made them nor the proof.

    python reflight_verify.py SITE PLAN PROOF [MISSION ...] [--json]      or      python reflight_verify.py FOLDER [--json]

Each claim comes out as `proved`, `false` or `not proved`. Exit status 0: all are proved; 1: one is false; 3: otherwise.
The proof says where to look (which plane separates a leg from a building, which view sees a section, which boxes leave
no place to see it from); all that it says is checked here on the files of site and plan. The claims are the methods of
`Case`, in order; what they say in words is what is proved, of the files and in metres of the site's frame.

Arithmetic is binary64 with + - * / and square roots, which all machines round alike. What is compared keeps a slack:
coordinates are at most 1e5 m, and a comparison has seen at most some 100 roundings of lengths up to 1e6 m, 1.2e-10 m
each: less than E. Comparisons are written so that what is not a number proves nothing.
"""
from __future__ import annotations

import hashlib
import json
import re
import struct
import sys
import zlib
from math import floor, sqrt
from pathlib import Path
from typing import Any

E = 1e-7  # metres kept in comparisons of lengths
R = 1e-9  # kept in comparisons of sines, and as a part of durations
SAME_M, CLIMB_M, SIGHT_OFFSET_M, USUAL_HEIGHT_M = 1e-3, 2.0, 0.15, 5.0
MISSION_M, MISSION_DEG = 0.01, 0.01  # how far a mission file may be off the plan
PI = 3.141592653589793
FALSE, NOT_PROVED, PROVED = "false", "not proved", "proved"
Vec = tuple[float, ...]
Triangle = tuple[Vec, Vec, Vec]

class Refused(Exception):  # noqa: N818
    """Why a claim is `not proved`, or what makes it `false`."""

    def __init__(self, text: str, verdict: str = NOT_PROVED) -> None:
        super().__init__(text)
        self.verdict = verdict

def demand(holds: bool, text: str, verdict: str = NOT_PROVED) -> None:
    if not holds:
        raise Refused(text, verdict)


# Reading: what is not as expected is refused. Numbers are finite, keys occur once, meshes are binary PLY.

def read_json(content: bytes, what: str, kind: Any = float) -> Any:
    def finite(text: str) -> Any:
        demand(abs(float(text)) < 1e300, f"{what} holds the number {text[:20]}")
        return kind(text)

    def record(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        demand(len(dict(pairs)) == len(pairs), f"{what} has a key twice")
        return dict(pairs)

    def check(value: Any, depth: int) -> None:
        demand(depth <= 64, f"{what} is nested too deep")
        for each in value if type(value) is list else value.values() if type(value) is dict else ():
            check(each, depth + 1)

    try:
        text, hooks = content.decode("utf-8"), dict.fromkeys(("parse_float", "parse_int", "parse_constant"), finite)
        demand(re.search(r"\\u[dD][89a-fA-F]", text) is None, f"{what} holds characters in two halves")
        value = json.loads(text, object_pairs_hook=record, **hooks)  # type: ignore[arg-type]
        check(value, 0)
    except (ValueError, RecursionError) as error:
        raise Refused(f"{what} cannot be read as JSON") from error
    return value

def get(record: Any, name: str, kind: type, default: Any = Refused) -> Any:
    value = record.get(name) if type(record) is dict else None
    if value is None and default is not Refused:
        return default
    demand(type(value) is kind, f"'{name}' is missing or of the wrong kind")
    return value

FIELDS = {  # A field that is not known may be a misspelled one, and what it says would be missed.
    "the site": "format name origin facades building_mesh obstacles airspace home_enu_m rally_points place_from is_bare terrain zones",
    "the airspace": "min_enu_m max_enu_m ground_z_m no_fly min_height_above_ground_m", "a facade": "id panels",
    "an obstacle": "id mesh box_enu_m", "a no-fly volume": "id polygon_enu_m floor_m ceiling_m", "the constraints":
    "min_distance_m section_step_deg occlusion whole_panel max_distance_m min_height_above_ground_m wanted_gsd_mm"}

def known(record: Any, what: str) -> Any:
    demand(type(record) is dict and set(record) <= set(FIELDS[what].split()), f"{what} has a field that is not known")
    return record

def number(value: Any, name: str, low: float = -1e6, high: float = 1e6) -> float:
    demand(type(value) is float and low <= value <= high, f"'{name}' is no number from {low:g} to {high:g}")
    return float(value)

def get_number(record: Any, name: str, low: float = -1e6, high: float = 1e6, default: Any = Refused) -> Any:
    value = get(record, name, float, default)
    return value if value is default else number(value, name, low, high)

def vector(value: Any, name: str, n: int = 3, most: float = 1e5) -> Vec:
    demand(type(value) is list and len(value) == n, f"'{name}' has not {n} coordinates")
    return tuple([number(each, name, -most, most) for each in value])

def place_in(value: Any, n: int, name: str) -> int:
    demand(type(value) in (int, float) and 0 <= value < n and value == floor(value), f"'{name}' names none of {n}")
    return int(value)

PLY = (rb"ply\nformat binary_little_endian 1\.0\n(?:comment [ -~]*\n)*element vertex ([0-9]{1,8})\nproperty (float|double) x\n"
       rb"property \2 y\nproperty \2 z\nelement face ([0-9]{1,8})\nproperty list uchar u?int vertex_ind(?:ices|ex)\n")

def read_ply(content: bytes) -> list[Triangle]:
    """Triangles of a mesh as Reflight writes it; faces with more corners are fans."""
    head, _, body = content.partition(b"end_header\n")
    found = re.fullmatch(PLY, head)
    demand(found is not None, "the mesh is no binary PLY file of triangles alone")
    n_vertices, kind, n_faces = int(found[1]), found[2], int(found[3])  # type: ignore[index]
    row, triangles = struct.Struct("<3f" if kind == b"float" else "<3d"), []
    at = n_vertices * row.size
    demand(at <= len(body), "the mesh is cut off")
    vertices = [vector(list(xyz), "vertex") for xyz in row.iter_unpack(body[:at])]
    for _ in range(n_faces):
        n = body[at] if at < len(body) else 0
        demand(3 <= n and at + 1 + 4 * n <= len(body), "the mesh is cut off")
        used = [vertices[place_in(k, n_vertices, "vertex")] for k in struct.unpack_from(f"<{n}I", body, at + 1)]
        triangles += [(used[0], used[k], used[k + 1]) for k in range(1, n - 1)]
        at += 1 + 4 * n
    demand(at == len(body), "the mesh is longer than it says")
    return triangles


# Vectors; sines of degrees by their series; what separates triangles from points, legs and lines of sight.

def sub(a: Vec, b: Vec) -> Vec: return a[0] - b[0], a[1] - b[1], a[2] - b[2]
def plus(a: Vec, b: Vec, k: float = 1.0) -> Vec: return a[0] + b[0] * k, a[1] + b[1] * k, a[2] + b[2] * k
def scaled(a: Vec, k: float) -> Vec: return a[0] * k, a[1] * k, a[2] * k
def dot(a: Vec, b: Vec) -> float: return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
def cross(a: Vec, b: Vec) -> Vec: return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
def length(a: Vec) -> float: return sqrt(dot(a, a))
def is_same(a: Vec, b: Vec) -> bool: return all([abs(x - y) <= SAME_M for x, y in zip(a, b, strict=False)])

def sincos(deg: float) -> tuple[float, float]:
    """Sine and cosine, within 1e-14 up to 720 degrees."""
    quarter = floor(deg / 90.0 + 0.5)
    x, s, c = (deg - 90.0 * quarter) * (PI / 180.0), 1.0, 1.0
    for k in range(10, 0, -1):
        s = 1.0 - s * x * x / (2.0 * k * (2.0 * k + 1.0))
        c = 1.0 - c * x * x / (2.0 * k * (2.0 * k - 1.0))
    s = s * x
    return ((s, c), (c, -s), (-s, -c), (-c, s))[quarter - 4 * floor(quarter / 4.0)]

def nearest(p: Vec, triangle: Triangle) -> Vec:
    """A point of a triangle, to rounding the nearest to p."""
    edges = [(triangle[k], sub(triangle[(k + 1) % 3], triangle[k])) for k in range(3)]
    normal = cross(edges[0][1], edges[1][1])
    foot = plus(p, normal, -dot(sub(p, triangle[0]), normal) / max(dot(normal, normal), 1e-18))
    if dot(normal, normal) > 1e-18 and all([dot(cross(way, sub(foot, a)), normal) > 0.0 for a, way in edges]):
        return foot
    ends = [plus(a, w, min(max(dot(sub(p, a), w) / max(dot(w, w), 1e-30), 0.0), 1.0)) for a, w in edges]
    away = [length(sub(p, q)) for q in ends]
    return ends[0 if away[0] <= away[1] and away[0] <= away[2] else 1 if away[1] <= away[2] else 2]

def quad(a: Vec, b: Vec, c: Vec, d: Vec) -> list[Triangle]: return [(a, b, c), (a, c, d)]

def prism(outline: list[Vec], low: float, high: float) -> list[Triangle]:
    """Walls, floor and cap of a prism. Fans about any corner hold the whole polygon, whatever its shape."""
    below, above = [(x, y, low) for x, y in outline], [(x, y, high) for x, y in outline]
    walls = [quad(below[k - 1], below[k], above[k], above[k - 1]) for k in range(len(outline))]
    fans = [[(ring[0], ring[k], ring[k + 1])] for ring in (below, above) for k in range(1, len(ring) - 1)]
    return [triangle for part in walls + fans for triangle in part]

class Solids:
    """Triangles in a tree of boxes: (low, high, halves, numbers of the triangles of a leaf)."""

    def __init__(self, triangles: list[Triangle]) -> None:
        self.triangles = triangles
        self.tree = self._boxes(list(range(len(triangles))))

    def _boxes(self, numbers: list[int]) -> Any:
        corners = [corner for k in numbers for corner in self.triangles[k]] or [(0.0, 0.0, 0.0)]
        low, high = (tuple([f([c[axis] for c in corners]) for axis in range(3)]) for f in (min, max))
        if len(numbers) <= 4:
            return low, high, (), numbers
        x, y, z = sub(high, low)
        axis = 0 if x >= y and x >= z else 1 if y >= z else 2
        place = {k: self.triangles[k][0][axis] + self.triangles[k][1][axis] + self.triangles[k][2][axis] for k in numbers}
        numbers, half = sorted(numbers, key=lambda k: (place[k], k)), len(numbers) // 2
        return low, high, [self._boxes(numbers[:half]), self._boxes(numbers[half:])], ()

    def nearer(self, points: list[Vec], directions: list[Vec], gap: float) -> int:
        """A triangle that no direction separates by `gap` from the convex hull of points; -1 where there is none.

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
                        return int(k)
        return -1

class Pane:
    """A panel: centroid c, normal n, tangents t and b of its hemisphere, and where lines of sight end."""

    def __init__(self, corners: list[Vec]) -> None:
        self.corners = corners
        self.c = tuple([(corners[0][k] + corners[1][k] + (corners[2][k] + corners[3][k])) * 0.25 for k in range(3)])
        across, along = sub(corners[2], corners[0]), sub(corners[3], corners[1])
        area, sizes = cross(across, along), (length(across), length(along))
        demand(length(area) >= max(2e-4, 1e-3 * sizes[0] * sizes[1]) and max(sizes) <= 1e3, "a panel is no pane: too thin, small or large")
        self.n = scaled(area, 1.0 / length(area))
        level = sqrt(self.n[0] * self.n[0] + self.n[1] * self.n[1])
        demand(level >= 1.001e-6 or level <= 1e-12, "a panel is neither level nor tilted by 1e-6")
        self.t = (-self.n[1] / level, self.n[0] / level, 0.0) if level > 1e-9 else (1.0, 0.0, 0.0)
        self.b = cross(self.n, self.t)
        self.target = plus(self.c, self.n, SIGHT_OFFSET_M)

def origin_of(record: Any) -> Vec:
    """Latitude, longitude and height above the ellipsoid of the local frame."""
    origin, limits = get(record, "origin", dict), (("lat_deg", 90.0), ("lon_deg", 360.0), ("ellipsoid_height_m", 1e4))
    return tuple([get_number(origin, name, -most, most) for name, most in limits])

def rest_to_rest(size: float, speed: float, a: float, jerk: float) -> float:
    """At most so long takes a leg from rest to rest; the closed form of planning/motion/timing.py."""
    ramp = speed / a + a / jerk if speed * jerk >= a * a else 2.0 * sqrt(speed / jerk)
    if size >= speed * ramp:
        return size / speed + ramp
    least = a * a / jerk
    if size >= 2.0 * a * least / jerk:
        return 2.0 * ((sqrt(least * least + 4.0 * a * size) - least) / (2.0 * a) + a / jerk)
    x = size / (2.0 * jerk)
    root = max(x, 1.0)
    for _ in range(100):
        root = (2.0 * root + x / (root * root)) / 3.0  # Newton, from above, for the cube root
    return 4.0 * root

class Case:
    """Site, plan and proof. The methods from `files` on prove one claim each, and say in words what is proved."""

    def __init__(self, folder: Path, contents: list[bytes]) -> None:
        self.contents = contents
        site, plan, names = read_json(self.contents[0], "the site"), read_json(self.contents[1], "the plan"), ("site", "plan")
        for record, name in zip((site, plan), names, strict=True):
            demand(get(record, "format", str) == f"reflight-{name}/1", f"the {name} has a format that is not known")
        self.site, self.plan, self.meshes = site, plan, {}
        facades = get(known(site, "the site"), "facades", list)
        panels = [panel for facade in facades for panel in get(known(facade, "a facade"), "panels", list)]
        corners = [[vector(corner, "corner") for corner in get(panel, "corners_enu_m", list)] for panel in panels]
        demand(len(corners) > 0 and all([len(each) == 4 for each in corners]), "a panel has not four corners, or there is none")
        triangles = [triangle for each in corners for triangle in quad(*each)]
        building = [] if site.get("building_mesh") is None else [{"mesh": get(site, "building_mesh", str)}]
        for body in building + [known(each, "an obstacle") for each in get(site, "obstacles", list, [])]:
            name, box = get(body, "mesh", str, None), get(body, "box_enu_m", list, [])
            demand(len(box) == (2 if name is None else 0), "an obstacle is neither a mesh nor a box")
            if name is None:
                (x, y, below), (u, v, above) = vector(box[0], "box"), vector(box[1], "box")
                triangles += prism([(x, y), (u, y), (u, v), (x, v)], below, above)
                continue
            is_plain = re.fullmatch(r"[^/\\:\0-\x1f]+(/[^/\\:\0-\x1f]+)*", name) is not None and ".." not in name
            demand(is_plain, "a mesh has a name that is no file's")
            self.meshes[name] = (folder / name).read_bytes()
            triangles += read_ply(self.meshes[name])
        air, limits = known(get(site, "airspace", dict), "the airspace"), known(get(plan, "constraints", dict), "the constraints")
        camera, zones = get(plan, "camera", dict), [known(each, "a no-fly volume") for each in get(air, "no_fly", list, [])]
        shapes = [[vector(xy, "polygon", 2) for xy in get(zone, "polygon_enu_m", list)] for zone in zones]
        walls = [prism(s, get_number(z, "floor_m"), get_number(z, "ceiling_m")) for s, z in zip(shapes, zones, strict=True)]
        self.solids, self.no_fly = Solids(triangles), Solids([triangle for each in walls for triangle in each])
        self.panes, self.home = [Pane(each) for each in corners], vector(get(site, "home_enu_m", list), "home")
        low, self.high = [vector(get(air, name, list), name) for name in ("min_enu_m", "max_enu_m")]
        own_m = get_number(air, "min_height_above_ground_m", 0.0, default=USUAL_HEIGHT_M)
        self.height_m = get_number(limits, "min_height_above_ground_m", 0.0, default=own_m)
        self.low = (low[0], low[1], max(low[2], get_number(air, "ground_z_m") + self.height_m))
        demand(all([a < b for a, b in zip(self.low, self.high, strict=True)]), "the airspace is empty")
        self.near_m = get_number(limits, "min_distance_m", 0.01, 1e4)
        self.far_m = get_number(limits, "max_distance_m", 0.01, 1e5, default=1e6)
        self.occlusion, self.whole = get(limits, "occlusion", str), get(limits, "whole_panel", bool, False)
        demand(self.occlusion in ("on", "off"), "the plan does not say whether occlusion counts")
        step = get_number(limits, "section_step_deg", 1.0, 90.0)
        self.rings = floor(90.0 / step + 0.5)
        demand(abs(90.0 / step - self.rings) < 1e-12, "section_step_deg is no divisor of 90")
        self.n = 4 * self.rings * self.rings
        self.angles = [sincos(90.0 / self.rings * k) for k in range(4 * self.rings + 1)]
        focal_mm = get_number(camera, "focal_length_mm", 0.01)
        self.half = [get_number(camera, f"sensor_{side}_mm", 0.01) / (2.0 * focal_mm) for side in ("width", "height")]
        demand(max(self.half) <= 100.0, "the camera has no field of view")
        self.pitches = vector(get(camera, "gimbal_pitch_deg", list), "gimbal_pitch_deg", 2, 180.0)
        demand(self.pitches[0] <= self.pitches[1], "the gimbal has no range")
        self.steepest = [self._steepest(pitch) for pitch in (self.pitches[1], -self.pitches[0])]
        self.views: list[tuple[str, Vec, float, float]] = []
        for view in get(plan, "viewpoints", list):
            heading, pitch = [get_number(view, name, -360.0, 360.0) for name in ("heading_deg", "gimbal_pitch_deg")]
            self.views.append((get(view, "id", str), vector(get(view, "position_enu_m", list), "position"), heading, pitch))
        self.by_id, self.sorties = {view[0]: view for view in self.views}, get(plan, "sorties", list)
        self.paths = [[vector(p, "path_enu_m") for p in get(sortie, "path_enu_m", list)] for sortie in self.sorties]
        self.legs = [(s, k, path[k], path[k + 1]) for s, path in enumerate(self.paths) for k in range(len(path) - 1)]
        self.proof, self.shadows = read_json(self.contents[2], "the proof"), dict[tuple[int, int], Any]()
        demand(get(self.proof, "format", str) == "reflight-proof/1", "the proof has a format that is not known")
        self.directions = [vector(each, "directions", 3, 1.0) for each in get(self.proof, "directions", list)]
        demand(all([dot(n, n) <= 1.0 - 1e-14 for n in self.directions]), "a direction of the proof is too long")

    def _steepest(self, pitch_deg: float) -> float:
        """Sine of the steepest elevation upwards that comes into the picture, at least 0; 2 where nothing limits it."""
        (s, c), h = sincos(pitch_deg), self.half[1]
        if not -90.0 <= pitch_deg <= 90.0 or c - h * s <= R:
            return 2.0
        return float(max(0.0, (s + h * c) / sqrt(1.0 + h * h) + R))

    def _listed(self, name: str, *places: int) -> list[Vec]:
        """Directions that the proof names for something."""
        listed = get(self.proof, name, list)
        for place in places:
            demand(place < len(listed) and type(listed[place]) is list, f"'{name}' of the proof is too short")
            listed = listed[place]
        return [self.directions[place_in(each, len(self.directions), name)] for each in listed]

    def files(self) -> str:
        meshes = {get(each, "name", str): get(each, "sha256", str) for each in get(self.proof, "meshes", list)}
        of_site, of_plan = (get(get(self.proof, name, dict), "sha256", str) for name in ("site", "plan"))
        named = [("the site", self.contents[0], of_site), ("the plan", self.contents[1], of_plan)]
        for what, content, sha256 in named + [(f"the mesh {k}", v, meshes.get(k, "")) for k, v in self.meshes.items()]:
            demand(hashlib.sha256(content).hexdigest() == sha256, f"{what} has changed since the proof was made", FALSE)
        demand(get(self.plan, "site_sha256", str) == of_site, "the plan was made for another state of the site")
        return "site, meshes and plan are those of the proof, and the plan was made for this site"

    def sorties_(self) -> str:
        home, origin = get(self.plan, "home_enu_m", list, None), get(self.plan, "origin", dict, None)
        demand(home is None or vector(home, "home") == self.home, "plan and site have another home", FALSE)
        demand(origin is None or origin_of(self.plan) == origin_of(self.site), "plan and site have another origin", FALSE)
        flown = [each for sortie in self.sorties for each in get(sortie, "viewpoint_ids", list)]
        demand(len(flown) > 0, "there is no viewpoint")
        is_once = len(self.by_id) == len(self.views) == len(flown)
        demand(is_once and all([flown.count(each[0]) == 1 for each in self.views]), "a viewpoint is not in one sortie", FALSE)
        for s, path in enumerate(self.paths):
            demand(len(path) >= 3, f"sortie {s + 1} has no path", FALSE)
            for end, beside in ((path[0], path[1]), (path[-1], path[-2])):
                above = is_same(beside[:2], self.home) and beside[2] >= self.home[2] + CLIMB_M - SAME_M
                demand(is_same(end, self.home) and above, f"sortie {s + 1} does not go straight up from home, and down to it", FALSE)
            demand(not get(self.sorties[s], "in_passing_ids", list, []), "photos are taken in passing")
            self.photos_of(s)
        return f"{len(flown)} viewpoints, each on the path of one of {len(self.paths)} sorties from home to home"

    def photos_of(self, s: int) -> list[int]:
        """The vertex of each photo of a sortie, in order; photos at one place may share a vertex."""
        path, found = self.paths[s], [-1]
        for name in get(self.sorties[s], "viewpoint_ids", list):
            demand(type(name) is str and name in self.by_id, "an unknown viewpoint is flown", FALSE)
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
            in_column, where = is_same(a[:2], self.home) and is_same(b[:2], self.home), f"sortie {s + 1}, leg {k + 1}"
            floor_m = min(self.home[2], self.low[2]) - SAME_M if in_column else self.low[2] + E
            for p in (a, b):
                inside = all([self.low[i] <= p[i] <= self.high[i] for i in (0, 1)]) and p[2] <= self.high[2]
                verdict = NOT_PROVED if inside and floor_m <= p[2] + 2.0 * E else FALSE
                kept = inside and floor_m <= p[2]
                demand(kept, f"{where} leaves the airspace, or flies below {self.height_m:g} m above the ground", verdict)
        demand(get(self.site, "terrain", dict, None) is None, "heights above terrain are not looked at")
        return f"paths stay in the airspace and {self.height_m:g} m above the ground, but for the column above home"

    def _leaves(self, solids: Solids) -> None:
        """Home is outside: the polyline `outside` of the proof leads from it past all triangles, meeting none."""
        way = [vector(p, "outside") for p in get(self.proof, "outside", list)]
        starts = all([path[:1] == [self.home] and way[:1] == [self.home] for path in self.paths])
        low, high, end = solids.tree[0], solids.tree[1], way[-1] if way else self.home
        far = any([end[i] <= low[i] - E or end[i] >= high[i] + E for i in range(3)]) or not solids.triangles
        demand(starts and far, "no way is shown from home to outside of everything")
        for k in range(len(way) - 1):
            free = solids.nearer(way[k : k + 2], self._listed("outside_directions", k), 0.0) < 0
            demand(free, "the way from home to outside of everything is not free")

    def distance(self) -> str:
        for s, k, a, b in self.legs:
            found = self.solids.nearer([a, b], self._listed("legs", s, k), self.near_m)
            if found >= 0:
                places = (a, b, scaled(plus(a, b), 0.5))
                near = [length(sub(p, nearest(p, triangle))) for triangle in self.solids.triangles for p in places]
                verdict = FALSE if any([each <= self.near_m - E for each in near]) else NOT_PROVED
                demand(False, f"sortie {s + 1}, leg {k + 1}: {self.near_m:g} m from everything are not kept", verdict)
        self._leaves(self.solids)
        return f"every leg keeps {self.near_m:g} m from every panel, mesh and obstacle, and lies outside of them"

    def no_fly_(self) -> str:
        demand(not get(self.site, "zones", list, []), "files of geo-zones are not looked at")
        if self.no_fly.triangles:
            for s, k, a, b in self.legs:
                kept = self.no_fly.nearer([a, b], self._listed("no_fly", s, k), 0.0) < 0
                demand(kept, f"sortie {s + 1}, leg {k + 1} may enter a no-fly volume")
            self._leaves(self.no_fly)
        return "no leg enters a no-fly volume" if self.no_fly.triangles else "the site has no no-fly volumes"

    def return_(self, height_m: float | None = None) -> str:
        above_m = get_number(self.proof, "return_height_m", 0.0) if height_m is None else height_m
        kept_m, (x, y, z) = get_number(self.proof, "return_kept_m", 0.5 * self.near_m, self.near_m), self.home
        level = z + above_m
        demand(level <= self.high[2], "the height of return is above the airspace", FALSE)
        for s, k, a, b in self.legs:
            tops, by = (max(a[2], level), max(b[2], level)), self._listed("returns", s, k)
            climb: list[Vec] = [a, b, (a[0], a[1], tops[0]), (b[0], b[1], tops[1])]
            home: list[Vec] = [(p[0], p[1], top) for p in (a, b, self.home) for top in tops]
            for part in (climb, home, [self.home, (x, y, max(tops))]):
                kept = self.solids.nearer(part, by, kept_m) < 0 and self.no_fly.nearer(part, by, 0.0) < 0
                demand(kept, f"the return from sortie {s + 1}, leg {k + 1} may come nearer than {kept_m:g} m to something")
        return f"from everywhere: up to {above_m:g} m above take-off, level home and down keeps {kept_m:g} m, outside no-fly volumes"

    def battery(self) -> str:
        craft, rules = get(self.plan, "aircraft", dict), get(self.plan, "rules", dict, {})
        wind, most = get_number(rules, "wind_m_s", 0.0, default=0.0), get_number(rules, "max_speed_m_s", 0.01, default=1e6)
        speed = get_number(craft, "max_speed_m_s", 0.01) - wind
        demand(wind < get_number(craft, "max_wind_m_s", 0.0, default=10.0) and speed > 0.0, "the wind is too strong", FALSE)
        names = ("max_ascent_m_s", 4.0), ("max_descent_m_s", 3.0), ("max_acceleration_m_s2", 2.5), ("max_yaw_rate_deg_s", 60.0)
        up, down, a, yaw = [get_number(craft, name, 0.01, default=usual) for name, usual in names]
        tilt, jerk = get_number(craft, "max_gimbal_rate_deg_s", 0.01, default=60.0), get_number(craft, "max_jerk_m_s3", 0.01, default=1e30)
        stop = get_number(rules, "settle_s", 0.0, default=2.0) + get_number(rules, "photo_s", 0.0, default=1.0)
        stop = max(stop, get_number(craft, "min_photo_interval_s", 0.0, default=0.7))
        ends, reserve = [get_number(rules, n, 0.0, default=d) for n, d in (("takeoff_landing_s", 30.0), ("battery_reserve", 0.25))]
        usable, turns, longest = get_number(craft, "endurance_s", 0.0) * (1.0 - reserve), get(rules, "turn_in_flight", bool, False), 0.0
        for s, path in enumerate(self.paths):
            sizes = [length(sub(p, q)) for p, q in zip(path, path[1:], strict=False)]
            pace, total, before, first = [0.0] * len(sizes), ends, (1e9, 0.0), 0
            for at, name in zip(self.photos_of(s), self.sorties[s]["viewpoint_ids"], strict=True):
                (_, _, heading, pitch), flown = self.by_id[name], 0.0
                change = abs(heading - before[0]) - 360.0 * floor(abs(heading - before[0]) / 360.0)
                change = 180.0 if before[0] == 1e9 else min(change, 360.0 - change)
                turn = max(change / yaw, abs(pitch - before[1]) / tilt)
                for k in range(first, at):
                    flown = flown + sizes[k]
                total = total + stop + (0.0 if turns and flown > 0.0 else turn)
                pace[first:at] = [turn / flown if turns and flown > 0.0 else 0.0] * (at - first)
                before, first = (heading, pitch), max(first, at)
            for k, size in enumerate(sizes):
                if size > 0.0:
                    x, y, z = sub(path[k + 1], path[k])
                    slow = max(sqrt(x * x + y * y) / min(speed, most), abs(z) / min(up if z > 0.0 else down, most), pace[k] * size)
                    total = total + rest_to_rest(size, size / slow, a, jerk)
            total, stated = total * (1.0 + R), get_number(self.sorties[s], "duration_s", 0.0)
            longest, where = max(longest, total, stated), f"sortie {s + 1}"
            demand(longest <= usable + 0.01, f"{where} takes {longest:.1f} s, the battery with its reserve {usable:.1f} s", FALSE)
            demand(stated >= 0.9 * total, f"{where}: the stated duration is shorter than with a stop at every vertex")
        return f"each sortie ends within {usable:g} s of the battery ({100.0 * reserve:g} % kept), stopping at every vertex"

    def apart(self) -> str:
        at_once = get_number(get(self.plan, "rules", dict, {}), "at_once", default=1.0)
        demand(at_once == 1.0 and not any(["start_s" in each for each in self.sorties]), "several aircraft fly at once")
        return "one aircraft flies at a time"

    def _section(self, element: int) -> tuple[Pane, int, int]:
        return self.panes[element // self.n], element % self.n // (4 * self.rings), element % self.n % (4 * self.rings)

    def lies_in(self, place: Vec, element: int, sight: list[Vec]) -> bool:
        """Whether a place surely lies in a section, near enough, with nothing between."""
        pane, ring, sector = self._section(element)
        d, ((s0, c0), (s1, c1)) = sub(place, pane.c), self.angles[sector : sector + 2]
        away, along, u, v = length(d), dot(d, pane.n), dot(d, pane.t), dot(d, pane.b)
        kept = [away <= self.far_m - E, along >= E, c0 * v - s0 * u >= E, s1 * u - c1 * v >= E]
        kept += [ring == 0 or along <= self.angles[ring][1] * away - E, along >= self.angles[ring + 1][1] * away + E]
        return all(kept) and (self.occlusion == "off" or self.solids.nearer([place, pane.target], sight, 0.0) < 0)

    def covers(self, view: tuple[str, Vec, float, float], element: int) -> bool:
        (_, place, heading, pitch), (pane, _, _) = view, self._section(element)
        (s, c), (sp, cp) = sincos(heading), sincos(pitch)
        forward, right, up = (cp * s, cp * c, sp), (c, -s, 0.0), (-sp * s, -sp * c, cp)
        for point in [pane.c, *(pane.corners if self.whole else [])]:
            v = sub(point, place)
            depth = dot(forward, v)
            inside = self.half[0] * depth - abs(dot(right, v)) >= E and self.half[1] * depth - abs(dot(up, v)) >= E
            if not (inside and depth >= E):
                return False
        return self.lies_in(place, element, self._listed("sights", element) if self.occlusion == "on" else [])

    def coverage(self) -> str:
        stated, seen = get(self.plan, "coverage", dict), get(self.proof, "seen", list)
        total, covered = len(self.panes) * self.n, get_number(stated, "covered", 0.0)
        demand(get_number(stated, "total") == total, f"there are {total} sections, the plan states another number", FALSE)
        demand(len(seen) == total, "'seen' of the proof does not name a view for each section")
        views = [-1 if k == -1.0 else place_in(k, len(self.views), "seen") for k in seen]
        found = sum([1 for element, k in enumerate(views) if k >= 0 and self.covers(self.views[k], element)])
        demand(found >= covered, f"{found} of {covered:g} sections are shown to be covered")
        return f"at least {covered:g} of {total} sections are covered, occlusion {self.occlusion}"

    def reachable(self) -> str:
        stated, total, done, shown = get(self.plan, "coverage", dict), len(self.panes) * self.n, set(), 0
        bound = get_number(stated, "reachable_upper_bound", 0.0)
        for row in get(self.proof, "boxes", list):
            element = place_in(row[0], total, "boxes")
            self._excluded(element, row[1])
            done.add(element)
        for element, x, y, z, listed in get(self.proof, "witnesses", list):
            element, place = place_in(element, total, "witnesses"), vector([x, y, z], "witnesses")
            by = [self.directions[place_in(k, len(self.directions), "witnesses")] for k in listed]
            inside = all([a <= p <= b for a, p, b in zip(self.low, place, self.high, strict=True)])
            shown += inside and self.solids.nearer([place], by, self.near_m) < 0 and self.lies_in(place, element, by)
        demand(total - len(done) <= bound, f"{len(done)} of {total - bound:g} sections are shown to be out of reach")
        return (f"no flight in this airspace, with this gimbal and {self.near_m:g} m from everything covers more than {bound:g} of "
                f"{total} sections ({shown} not covered have a place shown)")

    def _excluded(self, element: int, text: str) -> None:
        """Whether a tree of boxes leaves no place from which a section is seen."""
        pane, ring, sector = self._section(element)
        ((s0, c0), (s1, c1)), (s, c) = self.angles[sector : sector + 2], self.angles[ring + 1]
        sides = [pane.n, plus(scaled(pane.b, c0), pane.t, -s0), plus(scaled(pane.t, s1), pane.b, -c1)]
        cones: list[tuple[Vec, float]] = [((0.0, 0.0, -1.0), self.steepest[0]), ((0.0, 0.0, 1.0), self.steepest[1])]
        cones += [(pane.n, self.angles[ring][1])] if ring > 0 else []
        boxes, at = list[tuple[Vec, Vec]]([(self.low, self.high)]), 0
        while boxes:
            (low, high), leaf = boxes.pop(), re.compile(r"[XYZpc]|[dq]([0-9]{1,7})\.").match(text, at)
            demand(leaf is not None, "a tree of the proof is damaged")
            at, kind, k = leaf.end(), leaf[0][0], int(leaf[1] or 0)  # type: ignore[union-attr, index]
            if kind in "XYZ":
                axis = "XYZ".index(kind)
                middle = ((low[axis] + high[axis]) * 0.5,)
                boxes.append((low[:axis] + middle + low[axis + 1 :], high))
                boxes.append((low, high[:axis] + middle + high[axis + 1 :]))
                continue
            corners: list[Vec] = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
            rays = [sub(corner, pane.c) for corner in corners]
            if kind == "p":  # on the far side of a plane that has the section on the other
                centre = scaled(plus(rays[0], rays[7]), 0.5)
                u, v, away, forms = dot(centre, pane.t), dot(centre, pane.b), length(centre), [(m, 0.0) for m in sides]
                side = sqrt(u * u + v * v)
                if side > E:
                    radial = plus(scaled(pane.t, u / side), pane.b, v / side)
                    forms += [(plus(scaled(pane.n, s), radial, -c), 0.0), (scaled(centre, -1.0 / away), -self.far_m)]
                holds = any([max([dot(m, d) for d in rays]) <= limit - E for m, limit in forms])
            elif kind == "c":  # in the cone below the section's ring, or where the gimbal does not reach
                holds = any([all([dot(axis, d) >= cosine * length(d) + E for d in rays]) for axis, cosine in cones])
            elif kind == "d":  # too close to a triangle: its distance is a convex function, so corners tell
                triangle = self.solids.triangles[k]
                holds = all([length(sub(corner, nearest(corner, triangle))) <= self.near_m - E for corner in corners])
            else:
                holds = self.occlusion == "on" and self._is_hidden(element // self.n, k, corners)
            demand(holds, f"box {at} of section {element} is not excluded")
        demand(at == len(text), "a tree of the proof is damaged")

    def _is_hidden(self, panel: int, k: int, corners: list[Vec]) -> bool:
        """Whether a box lies in the shadow of triangles as seen from a panel's target.

        Each triangle is turned so that it winds to the left around the directions in it, and edges in both directions
        cancel. All lie in front of the target, and so does the box, beyond their planes. A direction that the edges left
        all wind around to the left is wound around at least once, and so lies in some triangle.
        """
        eye = self.panes[panel].target
        if (panel, k) not in self.shadows:
            faces, edges = list[tuple[Vec, Vec]](), set[tuple[Vec, Vec]]()
            for each in get(self.proof, "patches", list)[k]:
                a, b, c = self.solids.triangles[place_in(each, len(self.solids.triangles), "patches")]
                u, v, w = sub(a, eye), sub(b, eye), sub(c, eye)
                volume, normal = dot(cross(u, v), w), cross(sub(b, a), sub(c, a))
                demand(abs(volume) >= R * length(u) * length(v) * length(w), "a patch is seen edge on")
                demand(length(normal) >= 1e-6 * length(sub(b, a)) * length(sub(c, a)), "a triangle of a patch is too thin")
                ring = (a, b, c) if volume > 0.0 else (a, c, b)
                faces.append((a, scaled(normal, (1.0 if volume > 0.0 else -1.0) / length(normal))))
                ahead = all([dot(faces[0][1], d) >= E for d in (u, v, w)])
                for edge in ((ring[0], ring[1]), (ring[1], ring[2]), (ring[2], ring[0])):
                    demand(ahead and edge not in edges, "a patch is not in front, or has an edge twice")
                    edges ^= {edge} if edge[::-1] not in edges else {edge[::-1]}
            ends = [(sub(a, eye), sub(b, eye)) for a, b in edges]
            self.shadows[panel, k] = faces, [scaled(cross(u, v), 1.0 / (length(u) * length(v))) for u, v in ends]
        (faces, planes), rays = self.shadows[panel, k], [sub(corner, eye) for corner in corners]
        beyond = all([dot(n, sub(corner, a)) >= R * length(sub(corner, a)) + E for a, n in faces for corner in corners])
        left = all([dot(m, d) >= R * length(d) for m in planes for d in rays])
        return beyond and left and len(planes) > 0

# Mission files. They are taken as Reflight writes them, and anything else in them proves nothing.

def enu(origin: Vec, lat_deg: float, lon_deg: float, height_m: float) -> Vec:
    """A WGS 84 place in the frame of an origin (latitude, longitude, height), within 1e-7 m."""
    def geocentric(lat: float, lon: float, height: float) -> Vec:
        (s, c), (sin_lon, cos_lon), e2 = sincos(lat), sincos(lon), 0.0066943799901413165
        n = 6378137.0 / sqrt(1.0 - e2 * s * s)
        return (n + height) * c * cos_lon, (n + height) * c * sin_lon, (n * (1.0 - e2) + height) * s

    (s, c), (sin_lon, cos_lon) = sincos(origin[0]), sincos(origin[1])
    d = sub(geocentric(lat_deg, lon_deg, height_m), geocentric(*origin))
    return dot((-sin_lon, cos_lon, 0.0), d), dot((-s * cos_lon, -s * sin_lon, c), d), dot((c * cos_lon, c * sin_lon, s), d)

def members(content: bytes, names: tuple[bytes, ...]) -> list[str]:
    """Texts of an archive that holds nothing else than these deflated members."""
    at, texts, directory = 0, list[str](), b""
    for name in names:
        mark, _, flags, method, _, _, crc, packed, size, n_name, n_extra = struct.unpack_from("<4s5H3I2H", content, at)
        start, reader = at + 30 + len(name), zlib.decompressobj(-15)
        text = reader.decompress(content[start : start + packed], 100_000_000)
        head = (mark, flags, method, n_name, n_extra) == (b"PK\3\4", 0, 8, len(name), 0) and content[at + 30 : start] == name
        whole = reader.eof and not reader.unused_data and start + packed <= len(content)
        demand(head and whole and (len(text), zlib.crc32(text)) == (size, crc), "the archive is not as Reflight writes it")
        directory += b"PK\1\2\x14\3" + content[at + 4 : at + 30] + struct.pack("<3H2I", 0, 0, 0, 0o644 << 16, at) + name
        at, texts = start + packed, [*texts, text.decode("ascii")]
    end = b"PK\5\6" + struct.pack("<4H2IH", 0, 0, len(names), len(names), len(directory), at, 0)
    demand(content[at:] == directory + end, "the archive is not as Reflight writes it")
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
    "H": f"""Document[(author=*;createTime=#;updateTime=#;)?missionConfig[flyToWaylineMode=safely;finishAction=goHome;exitOnRCLost=
(goContinue|executeLostAction);executeRCLostAction=goBack;takeOffSecurityHeight=@c;(takeOffRefPoint=*;takeOffRefPointAGLHeight=0;)?
globalTransitionalSpeed=@v;globalRTHHeight=@r;droneInfo[~]waylineAvoidLimitAreaMode=0;payloadInfo[~]]Folder[(templateType=waypoint;
templateId=0;waylineCoordinateSysParam[coordinateMode=WGS84;heightMode=(relativeToStartPoint|EGM96);]autoFlightSpeed=#;globalHeight=#;
caliFlightEnable=0;gimbalPitchMode=manual;globalWaypointHeadingParam[waypointHeadingMode=fixed;~]globalWaypointTurnMode={STOP};
globalUseStraightLine=1;|templateId=0;executeHeightMode=(relativeToStartPoint|WGS84);waylineId=0;distance=#;duration=#;autoFlightSpeed=#;)""",
    "O": f"""Placemark[Point[coordinates=@x,@y;]index=@i;(executeHeight=@z;waypointSpeed=@v;|ellipsoidHeight=@e;height=@t;)
waypointHeadingParam[waypointHeadingMode=(fixed|smoothTransition);~](waypointTurnParam[waypointTurnMode={STOP};
waypointTurnDampingDist=0;]|useGlobalHeight=0;useGlobalSpeed=1;useGlobalHeadingParam=0;useGlobalTurnParam=1;)useStraightLine=1;""",
    "G": """actionGroup[actionGroupId=#;actionGroupStartIndex=@i;actionGroupEndIndex=@i;actionGroupMode=sequence;actionTrigger[
actionTriggerType=reachPoint;]""",
    "P": ACTION.format("rotateYaw", "aircraftHeading=@h;aircraftPathMode=*;") + ACTION.format("gimbalRotate", """gimbalHeadingYawBase=north;
gimbalRotateMode=absoluteAngle;gimbalPitchRotateEnable=1;gimbalPitchRotateAngle=@p;gimbalRollRotateEnable=0;gimbalRollRotateAngle=0;
gimbalYawRotateEnable=0;gimbalYawRotateAngle=0;gimbalRotateTimeEnable=0;gimbalRotateTime=0;payloadPositionIndex=0;""")
    + f"({ACTION.format('zoom', 'focalLength=@q;isUseFocalFactor=0;payloadPositionIndex=0;')})?({HELD})?({ACTION.format('focus', '~')})?"
    + f"({HELD})?({ACTION.format('hover', 'hoverTime=@w;')})?" + ACTION.format("takePhoto", """fileSuffix=*;payloadPositionIndex=0;
useGlobalPayloadLensIndex=1;(payloadLensIndex=(visable|wide);)?"""),
    "E": """(payloadParam[payloadPositionIndex=0;focusMode=(firstPoint|custom);meteringMode=average;imageFormat=(visable|wide);])?]]$""",
    "K": "]", "C": "(waypointGimbalHeadingParam[~]isRisky=0;waypointWorkType=0;|isRisky=0;)]"}.items()}
MAVLINK_ORDER, MAVLINK = "T[VX]*[ABW]*L", {name: rule(text) for name, text in {  # rows: frame, command, seven numbers
    "T": "3 22 0 0 0 (0|nan) @y @x @z/", "L": "3 21 0 0 0 (0|nan) @y @x @z/", "V": "2 178 1 @v -1 0 0 0 0/",
    "A": """2 205 @p 0 0 0 0 0 2/2 115 @h 0 0 0 0 0 0/3 16 @s 0 0 0 @y @x @z/(2 532 5 0 0 0 0 0 0/2 93 @f -1 -1 -1 0 0 0/)?
2 203 0 0 0 0 1 0 0/2 93 @w -1 -1 -1 0 0 0/""",
    "B": """2 1000 @p 0 nan nan 12 0 0/3 16 @s 0.5 0 @h @y @x @z/(2 532 5 0 0 0 0 0 0/3 16 @f 0.5 0 @h @y @x @z/)?
2 2000 0 0 1 # 0 0 0/3 16 @w 0.5 0 @h @y @x @z/""",
    "W": "3 16 1 (0 0 0|0.5 0 nan) @y @x @z/", "X": "(2 1001 -2 -2 -1 -1 0 0 0|2 202 4 # # # 0 0 0|2 532 # # 0 0 0 0 0)/"}.items()}

ITEM_KEYS = {"AMSLAltAboveTerrain", "Altitude", "AltitudeMode", "autoContinue", "command", "doJumpId", "frame", "params", "type",
             "viewpointId"}

class Mission:
    """What a mission file flies: places (latitude, longitude, height), and photos (number of its place, heading, pitch)."""

    def __init__(self, content: bytes, kind: str) -> None:
        demand(kind in (".kmz", ".plan", ".waypoints"), "no mission file that is read here: .kmz, .plan or .waypoints")
        self.is_dji, self.is_relative, self.return_m, self.speeds, self.zooms = kind == ".kmz", True, 0.0, [0.0], list[float]()
        if not self.is_dji:
            self._take("".join([row + "/" for row in (self._plan if kind == ".plan" else self._lines)(content)]), MAVLINK, MAVLINK_ORDER)
            return
        template, lines = members(content, (b"wpmz/template.kml", b"wpmz/waylines.wpml"))
        found = [self._take(self._flat(text), KMZ, KMZ_ORDER) for text in (template, lines)]
        self.is_relative = "executeHeightMode>relativeToStartPoint<" in lines
        of_template, of_lines = ("t" if self.is_relative else "e"), "z"
        heights = [[each.get(name, "") for each in block] for block, name in zip(found, (of_template, of_lines), strict=True)]
        same = [[(k, v) for each in block for k, v in each.items() if k in "xyihpcr"] for block in found]
        demand("templateType" in template and "templateType" not in lines and heights[0] == heights[1] and same[0] == same[1]
               and "" not in heights[1], "template.kml and waylines.wpml fly different places or photos", FALSE)

    def _take(self, text: str, rules: dict[str, re.Pattern[str]], order: str) -> list[dict[str, str]]:
        """Places, photos and all else that the blocks of a text say; the blocks that say places."""
        self.places, self.photos, letters, at, said = list[Vec](), list[Vec](), "", 0, list[dict[str, str]]()
        while at < len(text):
            letter, found = next(((k, m) for k, each in rules.items() if (m := each.match(text, at))), ("", None))
            demand(found is not None, f"what follows place {len(self.places)} is not as Reflight writes it")
            at, letters = found.end(), letters + letter  # type: ignore[union-attr]
            values = {k: v for k, v in found.groupdict().items() if v is not None}  # type: ignore[union-attr]
            n = {k: number(float(v), k) for k, v in values.items()}
            if "x" in n:
                place = (n["y"], n["x"], n.get("z", 0.0))
                last = self.places[-1] if self.places and not self.is_dji else (1e9, 1e9, 1e9)
                is_new = max(abs(place[0] - last[0]), abs(place[1] - last[1])) > 1e-8 or abs(place[2] - last[2]) > SAME_M
                self.places += [place] if is_new else []
            self.photos += [(len(self.places) - 1.0, n["h"], n["p"])] if "h" in n else []
            self.speeds, self.zooms = self.speeds + [n.get("v", 0.0)], self.zooms + [n[k] for k in "q" if k in n]
            self.return_m = max(self.return_m, n.get("c", 0.0), n.get("r", 0.0))
            said += [values] if "x" in n else []
            demand(all([0.0 <= n.get(wait, 0.0) <= 60.0 for wait in "swf"]) and n.get("i", len(self.places) - 1) == len(self.places) - 1
                   and n.get("c", 1.0) > 0.0 and n.get("r", 1.0) > 0.0, "a wait, a height or the number of a waypoint is wrong")
        demand(re.fullmatch(order, letters) is not None, "its parts are not in the order in which Reflight writes them")
        return said

    def _flat(self, text: str) -> str:
        prolog = ('<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2" '
                  'xmlns:wpml="http://www.dji.com/wpmz/1.0.6">\n')
        demand(text.startswith(prolog) and text.endswith("\n</kml>\n"), "a part of the archive is not as Reflight writes it")
        text = re.sub(">\n *<", "><", text[len(prolog) : -8].strip(" "))
        text = re.sub(r"<(wpml:(?!coordinates)[a-z][A-Za-z]*|coordinates)>([^<>=;&\[\]]*)</\1>", r"\1=\2;", text)
        text = re.sub("<(wpml:[a-z][A-Za-z]*|Document|Folder|Placemark|Point)>", r"\1[", text)
        return re.sub("</(wpml:[a-z][A-Za-z]*|Document|Folder|Placemark|Point)>", "]", text).replace("wpml:", "")

    def _plan(self, content: bytes) -> list[str]:
        plan, rows = read_json(content, "the mission", lambda text: Text(text.removesuffix(".0"))), []
        mission, rally = get(plan, "mission", dict), get(get(plan, "rallyPoints", dict, {}), "points", list, [])
        modes = plan["fileType"], plan["version"], mission["version"], mission["globalPlanAltitudeMode"], rally
        numbers = [type(each) is Text for each in modes[1:4]]
        demand(modes == ("Plan", "1", "2", "1", []) and all(numbers), "no mission as Reflight writes it, or one with rally points")
        for item in get(mission, "items", list):
            params = [Text("nan") if each is None else each for each in item["params"]]
            row = [item["frame"], item["command"], *params, item.get("Altitude", params[6]), item.get("AltitudeMode", Text("1"))]
            known = all([type(each) is Text for each in row]) and set(item) <= ITEM_KEYS and len(row) == 11 and row[9:] == [row[8], "1"]
            demand(known and item["type"] == "SimpleItem" and item["autoContinue"] is True, "an item is not as Reflight writes it")
            rows.append(" ".join(row[:9]))
        return rows

    def _lines(self, content: bytes) -> list[str]:
        lines = content.decode("ascii").split("\n")
        demand(lines[0] == "QGC WPL 110" and lines[-1] == "" and lines[1].startswith("0\t1\t0\t16\t"), "no QGC WPL 110 with home")
        rows = [line.split("\t") for line in lines[2:-1]]
        known = [row[:2] == [str(n), "0"] and row[11:] == ["1"] for n, row in enumerate(rows, 1)]
        known += [re.fullmatch("[-0-9.a-z]+", each) is not None for row in rows for each in row]
        demand(all(known), "a line is not as Reflight writes it")
        return [" ".join(row[2:11]) for row in rows]

class Text(str):
    """A number of a file as it is written there."""

def flies(case: Case, mission: Mission) -> int:
    """The sortie that a mission flies."""
    (x, y, z), frame = case.home, origin_of(case.site)
    demand(abs(x) <= 2000.0 and abs(y) <= 2000.0, "home is more than 2 km from the origin")
    base = frame[2] + z + (x * x + y * y) / 12742000.0 if mission.is_relative else 0.0
    places = [enu(frame, lat, lon, base + height) for lat, lon, height in mission.places]
    craft, camera = get(case.plan, "aircraft", dict), get(case.plan, "camera", dict)
    demand(max(mission.speeds) <= get_number(craft, "max_speed_m_s") + MISSION_M, "it flies faster than planned", FALSE)
    wide, high, focal = [get_number(camera, name) for name in ("sensor_width_mm", "sensor_height_mm", "focal_length_mm")]
    of_film = focal * 43.2666 / sqrt(wide * wide + high * high)
    demand(all([abs(zoom - of_film) <= 1.0 for zoom in mission.zooms]), "it zooms", FALSE)
    if mission.is_dji:
        case.return_(mission.return_m)
    for s, path in enumerate(case.paths):
        last = len(path) - mission.is_dji  # DJI missions end above home, and return from there
        kept = [k for k in range(1, last) if k == 1 or not is_same(path[k], path[k - 1])]
        at = [sum([1 for j in kept if j <= k]) - 1.0 for k in case.photos_of(s)]
        views = [case.by_id[name] for name in case.sorties[s]["viewpoint_ids"]]
        if len(places) == len(kept) and len(views) == len(mission.photos):
            same = [length(sub(p, path[k])) <= MISSION_M for p, k in zip(places, kept, strict=True)]
            for view, k, photo in zip(views, at, mission.photos, strict=True):
                same.append(photo[0] == k and same_heading(photo[1], view[2]) and abs(photo[2] - view[3]) <= MISSION_DEG)
            if all(same):
                return s
    raise Refused("it flies no sortie of the plan: places, their order, or photos differ", FALSE)

def same_heading(a: float, b: float) -> bool:
    return abs(abs(a - b) - 360.0 * floor(abs(a - b) / 360.0 + 0.5)) <= MISSION_DEG

CLAIMS = (
    ("files", Case.files), ("sorties", Case.sorties_), ("gimbal", Case.gimbal), ("airspace", Case.airspace),
    ("distance", Case.distance), ("no-fly", Case.no_fly_), ("return", Case.return_), ("battery", Case.battery),
    ("apart", Case.apart), ("coverage", Case.coverage), ("reachable", Case.reachable))
UNREADABLE = (ValueError, LookupError, TypeError, ArithmeticError, AttributeError, OSError, RecursionError, struct.error, zlib.error)

def judged(prove: Any) -> tuple[str, str]:
    """Verdict and words of a claim. What trips over a file proves nothing."""
    try:
        return PROVED, prove()
    except Refused as refused:
        return refused.verdict, str(refused)
    except UNREADABLE as error:
        return NOT_PROVED, f"a file is not as expected ({type(error).__name__})"

def verify(site: Path, plan: Path, proof: Path, missions: list[Path]) -> list[dict[str, str]]:
    """All claims, in order: each with its id, verdict and text."""
    cases, flown = list[Case](), dict[str, list[int]]()

    def opened() -> str:
        cases.append(Case(site.parent, [each.read_bytes() for each in (site, plan, proof)]))
        return ""

    verdict, reason = judged(opened)
    found = [(name, *(judged(lambda claim=claim: claim(cases[0])) if cases else (verdict, reason))) for name, claim in CLAIMS]
    for path in missions:
        def flies_a_sortie(path: Path = path) -> str:
            demand(bool(cases), reason)
            s = flies(cases[0], Mission(path.read_bytes(), path.suffix))
            flown.setdefault(path.suffix, []).append(s)
            return f"flies sortie {s + 1}: the same places in the same order within {MISSION_M:g} m, the same photos"

        found.append((f"mission {path.name}", *judged(flies_a_sortie)))
    if missions:
        whole = bool(cases) and all([each[1] == PROVED for each in found[-len(missions) :]])
        whole = whole and all([sorted(each) == list(range(len(cases[0].paths))) for each in flown.values()])
        text = "the files of each kind fly every sortie once" if whole else "not every sortie is flown once"
        found.append(("missions", PROVED if whole else NOT_PROVED, text))
    return [{"id": name, "verdict": verdict, "text": text} for name, verdict, text in found]

def jobs_of(folder: Path) -> list[list[Path]]:
    """Site, plan, proof and missions of each proof in a folder."""
    jobs = []
    for proof in sorted(folder.glob("*.proof")):
        named = read_json(proof.read_bytes(), proof.name)
        files = [folder / Path(get(get(named, each, dict), "name", str)).name for each in ("site", "plan")]
        stem, _, kind = proof.name.removesuffix(".mission.proof").rpartition(".")
        names = re.compile(re.escape(stem) + "(-[0-9]+)?[.]" + re.escape(kind)) if proof.name.endswith(".mission.proof") else None
        jobs.append([*files, proof, *[p for p in sorted(folder.iterdir()) if names and names.fullmatch(p.name)]])
    return jobs

def main() -> int:
    """Check what the command line names; the exit status."""
    paths, as_json = [Path(each) for each in sys.argv[1:] if each != "--json"], "--json" in sys.argv
    jobs = jobs_of(paths[0]) if len(paths) == 1 else [paths]
    if not jobs or len(jobs[0]) < 3:
        print("usage: reflight_verify.py SITE PLAN PROOF [MISSION ...] [--json], or FOLDER with *.proof files", file=sys.stderr)
        return 2
    claims = [claim for job in jobs for claim in verify(job[0], job[1], job[2], job[3:])]
    lines = [f"{each['verdict']:>10}  {each['id']}: {each['text']}" for each in claims]
    print(json.dumps({"claims": claims}) if as_json else "\n".join(lines))
    verdicts = {claim["verdict"] for claim in claims}
    return 1 if FALSE in verdicts else 0 if verdicts == {PROVED} else 3

if __name__ == "__main__":
    sys.exit(main())
