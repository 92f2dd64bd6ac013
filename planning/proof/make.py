"""Making `plan.proof`: for each claim of the verifier where it has to look, from what planning found out already.

The site and the plan are read with the verifier's own code, so that both speak of the same numbers. What cannot be
proved is left out, and the verifier then says so.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.files import read_input_file
from planning.base.jit import chunks, kernel, run_chunks, run_parallel
from planning.base.json_file import JSON_FILE
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.reachability import Reachability, convex_groups
from planning.geo.bvh import Bvh, build_bvh
from planning.geo.frames import camera_axes
from planning.geo.mesh import row_numbers
from planning.proof.boxes import CONE, CUT_X, LOW, PLANE, Panel, Shadows, Terrain, exclude, no_shadows
from planning.proof.reflight_verify import Case, Pane, Refused
from planning.proof.separation import DirectionTable, Separator
from planning.routing.rally import return_height
from planning.site.free_space import unchecked_space
from planning.site.ground import decide_terrain
from planning.site.records import SiteModel

Array = NDArray[np.float64]

PROOF_FORMAT = "reflight-proof/1"

SLACK_M = 1e-6
"""Views that see a section by less than this are left to others: the verifier keeps 1e-7 m."""

MOST_CODES = 20_000
"""Boxes of one section; more would not be read in time."""

MOST_PATCHES = (32, 512)
"""Patches that are looked at for the shadows of one panel, those that are seen largest; more where these prove less."""

RETURN_SHARES = (1.0, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5)
"""Parts of the minimum distance that returns are tried to keep, the largest first."""

SECTIONS_PER_CHUNK = 16

PAIRS_PER_CHUNK = 200_000
"""Of views and panels that are looked at together."""


def proof_path(plan_path: Path) -> Path:
    """Where the proof of a plan stands: beside it, with the ending `.proof`."""
    return plan_path.with_suffix(".proof")


def proof_of(
    site_path: Path,
    plan_path: Path,
    plan_bytes: bytes,
    site_model: SiteModel,
    reachability: Reachability | None = None,
    *,
    known: Mapping[str, Any] | None = None,
    return_height_m: float | None = None,
    monitor: Monitor = QUIET,
) -> bytes:
    """Content of the proof of a plan.

    Parameters
    ----------
    site_path
        The site's file, beside which its meshes lie.
    plan_path, plan_bytes
        Where the plan's file stands, or will stand, and what it holds.
    reachability
        What planning found out of it; None where it did not look.
    known
        A proof of the same viewpoints on the same site, from which what it says of them is taken over.
    return_height_m
        Above home, of aircraft that return by themselves; None: as high as clears everything.

    Raises
    ------
    InputError
        The site cannot be read.
    """
    monitor.report(say("writing the proof"), 0, 1)
    contents = [read_input_file(site_path, JSON_FILE), plan_bytes]
    content: dict[str, Any] = {"format": PROOF_FORMAT, "directions": []}
    for name, path, written in zip(("site", "plan"), (site_path, plan_path), contents, strict=True):
        content[name] = {"name": path.name, "sha256": hashlib.sha256(written).hexdigest()}
    content["meshes"] = []
    departure = decide_terrain(site_model.site)
    if departure.decided_by == "scene" and not departure.on:
        content["level_within_m"] = math.ceil(1000.0 * departure.size + 1.0) / 1000.0
    try:
        case = Case(site_path.parent, [*contents, _encoded(content)])
    except (Refused, ValueError, LookupError, TypeError, OSError):  # such as meshes that the verifier does not read
        return _encoded(content)
    hashes = {name: hashlib.sha256(mesh).hexdigest() for name, mesh in case.meshes.items()}
    content["meshes"] = [{"name": name, "sha256": sha256} for name, sha256 in hashes.items()]
    maker = _Maker.of(case, known)
    if return_height_m is None:
        return_height_m = return_height(unchecked_space(site_model, case.near_m)).above_home_m
    content |= maker.legs(return_height_m)
    if known is None:
        content |= maker.coverage(reachability)
        content |= maker.boxes(reachability, monitor)
    else:
        content |= {name: known[name] for name in OF_VIEWS if name in known}
    content["directions"] = maker.table.rows
    return _encoded(content)


OF_VIEWS = ("seen", "sights", "witnesses", "boxes", "patches")
"""Parts of a proof that depend on the site, the limits and the viewpoints alone."""


def _encoded(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, separators=(",", ":"), allow_nan=False).encode()


@dataclass(frozen=True, slots=True, eq=False)
class _Maker:
    case: Case
    table: DirectionTable
    solids: Separator
    no_fly: Separator

    @classmethod
    def of(cls, case: Case, known: Mapping[str, Any] | None) -> _Maker:
        table = DirectionTable(() if known is None else known.get("directions", ()))
        solids, no_fly = (np.array(each.triangles).reshape(-1, 3, 3) for each in (case.solids, case.no_fly))
        return cls(case, table, Separator(table, solids), Separator(table, no_fly))

    def legs(self, return_height_m: float) -> dict[str, Any]:
        """What separates legs, and returns from them, from everything; and the way from home to outside."""
        case = self.case
        ends = [np.array([a, b]) for _, _, a, b in case.legs]
        returns, kept_m = self._returns(case.home[2] + return_height_m)
        outside, outside_directions = self._outside()
        return {
            "legs": self._by_leg(self.solids.directions(ends, case.near_m)),
            "no_fly": self._by_leg(self.no_fly.directions(ends, 0.0)),
            "return_height_m": return_height_m,
            "return_kept_m": kept_m,
            "returns": self._by_leg(returns),
            "outside": outside,
            "outside_directions": outside_directions,
        }

    def _by_leg(self, found: list[list[int] | None]) -> list[list[list[int]]]:
        by_sortie: list[list[list[int]]] = [[] for _ in self.case.paths]
        for (s, _, _, _), each in zip(self.case.legs, found, strict=True):
            by_sortie[s].append(each or [])
        return by_sortie

    def _returns(self, level_m: float) -> tuple[list[list[int] | None], float]:
        """Directions for the sets that the verifier's `return_` looks at, and the distance that all of them keep."""
        case = self.case
        sets = []
        for _, _, a, b in case.legs:
            tops = max(a[2], level_m), max(b[2], level_m)
            sets.append(np.array([a, b, (*a[:2], tops[0]), (*b[:2], tops[1])]))
            sets.append(np.array([(*p[:2], top) for p in (a, b, case.home) for top in tops]))
            sets.append(np.array([case.home, (*case.home[:2], max(tops))]))
        kept_m, by_solids = 0.0, list[list[int] | None]()
        for share in RETURN_SHARES:
            kept_m = round(share * case.near_m, 3)
            by_solids = self.solids.directions(sets, kept_m)
            if None not in by_solids:
                break
        found = list(zip(by_solids, self.no_fly.directions(sets, 0.0), strict=True))
        joined = [_union([each for pair in found[i : i + 3] for each in pair]) for i in range(0, len(found), 3)]
        return joined, kept_m

    def _outside(self) -> tuple[list[Any], list[list[int]]]:
        """A straight way from home to outside of everything."""
        case, home = self.case, np.array(self.case.home)
        corners = np.concatenate([self.solids.triangles, self.no_fly.triangles]).reshape(-1, 3)
        far = float(np.abs(corners - home).max(initial=1.0)) + 10.0
        ways = [(0.0, 0.0, 1.0), *((math.cos(k * 0.5), math.sin(k * 0.5), h) for h in (0.0, 0.7) for k in range(13))]
        for way in ways:
            end = home + 1.01 * far * np.array(way)
            found = _union([each.directions([np.array([home, end])], 0.0)[0] for each in (self.solids, self.no_fly)])
            is_far = any(abs(value) > far for value in end - home)
            if found is not None and is_far:
                return [list(case.home), end.tolist()], [found]
        return [list(case.home)], []

    def coverage(self, reachability: Reachability | None) -> dict[str, Any]:
        """A view for each section that is covered, and places for others that can be."""
        case = self.case
        n_elements = len(case.panes) * case.n
        seen = np.full(n_elements, -1, np.int64)
        sights: list[list[int]] = [[] for _ in range(n_elements)] if case.occlusion == "on" else []
        elements, starts, views = _best_views(case)
        places = np.array([place for _, place, _, _ in case.views]).reshape(-1, 3)
        for k in range(int(np.diff(starts).max(initial=0))):
            waiting = np.flatnonzero((seen[elements] < 0) & (starts[:-1] + k < starts[1:]))
            tried = views[starts[waiting] + k]
            if case.occlusion == "off":
                seen[elements[waiting]] = tried
                break
            free = self.solids.directions(self._sights(places[tried], elements[waiting]), 0.0)
            for e, v, directions in zip(elements[waiting].tolist(), tried.tolist(), free, strict=True):
                if directions is not None:
                    seen[e], sights[e] = v, directions
        return {"seen": seen.tolist(), "sights": sights, "witnesses": self._witnesses(reachability, seen)}

    def _sights(self, places: Array, elements: NDArray[np.int64]) -> Array:
        """Lines of sight from places to the targets of sections, shape (n, 2, 3)."""
        targets = np.array([pane.target for pane in self.case.panes])
        return np.stack([places, targets[elements // self.case.n]], axis=1)

    def _witnesses(self, reachability: Reachability | None, seen: NDArray[np.int64]) -> list[list[Any]]:
        if reachability is None:
            return []
        case = self.case
        elements = np.flatnonzero((reachability.verdicts.reshape(-1) == REACHABLE) & (seen < 0))
        places = reachability.witnesses_enu_m.reshape(-1, 3)[elements]
        by = self.solids.directions(places[:, None], case.near_m)
        if case.occlusion == "on":
            free = self.solids.directions(self._sights(places, elements), 0.0)
            by = [_union(pair) for pair in zip(by, free, strict=True)]
        found = zip(elements.tolist(), places.tolist(), by, strict=True)
        return [[e, *place, directions] for e, place, directions in found if directions is not None]

    def boxes(self, reachability: Reachability | None, monitor: Monitor) -> dict[str, Any]:
        """Trees of boxes for all sections out of reach, and the patches that cast their shadows."""
        if reachability is None:
            return {"boxes": [], "patches": []}
        case = self.case
        elements = np.flatnonzero(reachability.verdicts.reshape(-1) == UNREACHABLE)
        patches = _Patches(self.solids.triangles) if case.occlusion == "on" else None
        terrain, bvh = _terrain(case), build_bvh(self.solids.triangles)
        texts: dict[int, str] = {}
        for most in MOST_PATCHES if patches is not None else (0,):
            left = elements[np.array([not texts.get(e) for e in elements.tolist()], np.bool_)]
            shadows = {panel: _shadows(case.panes[panel], patches, most) for panel in set((left // case.n).tolist())}
            parts = chunks(len(left), SECTIONS_PER_CHUNK)
            for start, stop in chunks(len(parts), 8):
                monitor.report(say("writing the proof"), start, len(parts))
                work = [(case, left[a:b], shadows, terrain, bvh) for a, b in parts[start:stop]]
                written = [text for part in run_parallel(_trees, work) for text in part]
                of_these = left[parts[start][0] : parts[stop - 1][1]].tolist()
                texts |= dict(zip(of_these, written, strict=True))
        found = [[e, texts[e]] for e in elements.tolist() if texts[e]]
        return {"boxes": found, "patches": [] if patches is None else patches.rows}


def _union(parts: Iterable[list[int] | None]) -> list[int] | None:
    """All directions of several lists; None where one is missing."""
    parts = list(parts)
    if any(part is None for part in parts):
        return None
    return list(dict.fromkeys(each for part in parts for each in part or []))


def _best_views(case: Case) -> tuple[NDArray[np.int64], ...]:
    """Sections that are surely in the picture of any view, and those views, the one with most to spare first.

    Returns
    -------
    elements, starts, views
        The views of section `elements[i]` are `views[starts[i] : starts[i + 1]]`.
    """
    panes, n_sectors = case.panes, 4 * case.rings
    points = np.array([[pane.c, *(pane.corners if case.whole else ())] for pane in panes])
    axes = np.array([[pane.n, pane.t, pane.b] for pane in panes])
    edges = np.array([case.angle(k) for k in range(n_sectors + 1)])
    places = np.array([place for _, place, _, _ in case.views]).reshape(-1, 3)
    heading, pitch = np.radians([view[2:] for view in case.views]).reshape(-1, 2).T
    looks = np.stack(camera_axes(heading, pitch), axis=1)
    limits = np.array([case.far_m, *case.half])

    def of_views(start: int, stop: int) -> tuple[NDArray[np.int64], Array, NDArray[np.int64]]:
        section, slack = _unfilled(stop - start, len(panes))
        _to_spare(points, axes, edges, limits, places[start:stop], looks[start:stop], section, slack)
        view, panel = np.nonzero(slack > SLACK_M)
        return panel * case.n + section[view, panel], slack[view, panel], start + view

    found = [(np.zeros(0, np.int64), np.zeros(0), np.zeros(0, np.int64))]
    found += run_chunks(of_views, chunks(len(places), max(1, PAIRS_PER_CHUNK // len(panes))))
    elements, slacks, views = (np.concatenate(each) for each in zip(*found, strict=True))
    order = np.lexsort((-slacks, elements))
    elements, starts = np.unique(elements[order], return_index=True)
    return elements, np.append(starts, len(order)), views[order]


def _unfilled(n_views: int, n_panels: int) -> tuple[NDArray[np.int64], Array]:
    return np.empty((n_views, n_panels), np.int64), np.empty((n_views, n_panels))


@kernel
def _to_spare(
    points: Array,
    axes: Array,
    edges: Array,
    limits: Array,
    places: Array,
    looks: Array,
    section: NDArray[np.int64],
    slack: Array,
) -> None:
    """The section in which each view stands before each pane, and by how much it keeps all that it must keep, metres.

    Parameters
    ----------
    points
        What has to be in the picture, the pane's middle first, shape (m, 1 or 5, 3).
    axes
        Normal, tangent and bitangent of each pane, shape (m, 3, 3).
    edges
        Sines and cosines of the angles between rings and between sectors, shape (4 rings + 1, 2).
    limits
        The largest distance, and how far a picture reaches to the side and upwards at a depth of 1.
    places, looks
        Of the views: positions, shape (n, 3), and unit vectors forwards, to the right and upwards, shape (n, 3, 3).
    section, slack
        Written to, shape (n, m). What is surely not seen has less than 0, and section 0.
    """
    n_sectors = len(edges) - 1
    rings = n_sectors // 4
    for i in range(len(places)):
        for j in range(len(points)):
            section[i, j] = 0
            spare = np.inf
            for k in range(points.shape[1]):
                depth = across = upwards = 0.0
                for axis in range(3):
                    d = points[j, k, axis] - places[i, axis]
                    depth += d * looks[i, 0, axis]
                    across += d * looks[i, 1, axis]
                    upwards += d * looks[i, 2, axis]
                beside = min(limits[1] * depth - abs(across), limits[2] * depth - abs(upwards))
                spare = min(spare, depth, beside)
                if spare < 0.0:
                    break
            along = u = v = away2 = 0.0
            for axis in range(3):
                d = places[i, axis] - points[j, 0, axis]
                away2 += d * d
                along += d * axes[j, 0, axis]
                u += d * axes[j, 1, axis]
                v += d * axes[j, 2, axis]
            away = math.sqrt(away2)
            slack[i, j] = min(spare, along, limits[0] - away)
            if slack[i, j] < 0.0:
                continue
            theta = math.acos(min(1.0, along / max(away, 1e-12)))
            ring = min(int(theta / (0.5 * math.pi) * rings), rings - 1)
            phi = math.atan2(v, u)
            sector = min(int((phi if phi >= 0.0 else phi + 2.0 * math.pi) / (0.5 * math.pi) * rings), n_sectors - 1)
            section[i, j] = ring * n_sectors + sector
            spare = min(
                edges[sector, 1] * v - edges[sector, 0] * u, edges[sector + 1, 0] * u - edges[sector + 1, 1] * v
            )
            if ring > 0:
                spare = min(spare, edges[ring, 1] * away - along)
            slack[i, j] = min(slack[i, j], spare, along - edges[ring + 1, 1] * away)


def compile_kernels() -> None:
    """Run every kernel on small inputs."""
    one = np.ones((1, 1, 3))
    _to_spare(one, np.eye(3)[None], np.ones((5, 2)), np.ones(3), one[0], np.eye(3)[None], *_unfilled(1, 1))


class _Patches:
    """Groups of triangles that may cast shadows, and the table of their parts that were used."""

    def __init__(self, triangles: Array) -> None:
        self.triangles = triangles
        self.vertices = row_numbers(triangles.reshape(-1, 3)).reshape(-1, 3)
        _, group, sizes = np.unique(convex_groups(triangles), return_inverse=True, return_counts=True)
        self.order = np.argsort(group, kind="stable")
        self.starts = np.cumsum([0, *sizes])
        self.corners, self.group = triangles[self.order], group[self.order]
        across = _cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.area = np.maximum(np.linalg.norm(across, axis=1), 1e-30)
        self.normals = across / self.area[:, None]
        means = np.add.reduceat(self.corners.mean(axis=1), self.starts[:-1]) / sizes[:, None]
        self.of_mean = ((means[self.group] - self.corners[:, 0]) * self.normals).sum(axis=1)
        self._numbers: dict[tuple[int, ...], int] = {}
        self._borders: dict[tuple[tuple[int, ...], bytes], tuple[Array, Array, Array] | None] = {}

    def number(self, patch: tuple[int, ...]) -> int:
        """Of a patch in the table."""
        return self._numbers.setdefault(patch, len(self._numbers))

    @property
    def rows(self) -> list[list[int]]:
        """The table."""
        return [list(patch) for patch in self._numbers]

    def border(self, patch: tuple[int, ...], turned: bytes) -> tuple[Array, Array, Array] | None:
        """Of a patch, its triangles turned or not: inward normals with a corner, starts and ends of the edges left.

        A facade's panels see most patches by the same triangles, turned the same way. None where an edge is there
        twice.
        """
        if (patch, turned) not in self._borders:
            order = np.where(np.frombuffer(turned, np.bool_)[:, None], [0, 2, 1], [0, 1, 2])
            rows = np.array(patch)[:, None]
            ring, numbers = self.triangles[rows, order], self.vertices[rows, order]
            normals = _cross(ring[:, 1] - ring[:, 0], ring[:, 2] - ring[:, 0])
            normals /= np.sqrt(np.einsum("tk,tk->t", normals, normals))[:, None]
            a, b = numbers.ravel(), np.roll(numbers, -1, axis=1).ravel()
            n = int(numbers.max()) + 1
            kept = ~np.isin(a * n + b, b * n + a)
            starts, ends = ring.reshape(-1, 3)[kept], np.roll(ring, -1, axis=1).reshape(-1, 3)[kept]
            is_once = len(np.unique(a * n + b)) == len(a)
            faces = np.concatenate([normals, ring[:, 0]], axis=1)
            self._borders[patch, turned] = (faces, starts, ends) if is_once else None
        return self._borders[patch, turned]

    def seen_from(self, pane: Pane, most: int) -> list[tuple[int, ...]]:
        """Parts of groups that face a panel's target and stand in front of it, the largest seen first."""
        eye, first = np.array(pane.target), self.starts[:-1]
        rays = self.corners - eye
        in_front = np.maximum.reduceat((rays @ np.array(pane.n)).max(axis=1), first) > 0.0
        of_eye = -(rays[:, 0] * self.normals).sum(axis=1)
        facing = (np.abs(of_eye) > 1e-3) & ((of_eye * self.of_mean < 0.0) | (np.abs(self.of_mean) < 1e-4))
        away2 = np.where(facing, np.einsum("tck,tck->tc", rays, rays).min(axis=1), np.inf)
        seen = np.bincount(self.group, facing * self.area) / np.maximum(np.minimum.reduceat(away2, first), 1e-6)
        largest = np.argsort(-np.where(in_front, seen, 0.0), kind="stable")[:most]
        parts = [slice(*self.starts[k : k + 2]) for k in largest.tolist() if in_front[k] and seen[k] > 0.0]
        return [tuple(self.order[part][facing[part]].tolist()) for part in parts]


def _shadows(pane: Pane, patches: _Patches | None, most: int) -> Shadows:
    """Shadows of the patches that are seen largest from a panel, `most` of them at most."""
    eye = np.array(pane.target)
    seen = [] if patches is None else patches.seen_from(pane, most)
    if patches is None or not seen:
        return no_shadows(eye)
    first = np.cumsum([0, *map(len, seen)])
    rays = patches.triangles[[triangle for patch in seen for triangle in patch]] - eye
    sizes = np.sqrt(np.einsum("tck,tck->tc", rays, rays))
    volumes = np.einsum("tk,tk->t", _cross(rays[:, 0], rays[:, 1]), rays[:, 2])
    # As the verifier finds them; patches whose silhouette it would refuse are left out.
    is_plain = np.logical_and.reduceat(np.abs(volumes) >= 1e-8 * sizes.prod(axis=1), first[:-1])
    borders = [
        patches.border(patch, (volumes[start:stop] < 0.0).tobytes()) if is_plain[k] else None
        for k, (patch, start, stop) in enumerate(zip(seen, first[:-1], first[1:], strict=True))
    ]
    normals = np.array([np.zeros(3) if border is None else border[0][0, :3] for border in borders])
    depths = (rays @ np.repeat(normals, np.diff(first), axis=0)[:, :, None]).min(axis=(1, 2))
    kept = np.flatnonzero(np.minimum.reduceat(depths, first[:-1]) >= 2.0 * SLACK_M)
    found = [border for k in kept.tolist() if (border := borders[k]) is not None]
    numbers = [patches.number(seen[k]) for k in kept.tolist()]
    faces, starts, ends = (
        np.concatenate([np.zeros((0, n)), *(each[k] for each in found)]) for k, n in enumerate((6, 3, 3))
    )
    starts, ends = starts - eye, ends - eye
    planes = _cross(starts, ends)
    planes /= np.sqrt(np.einsum("ek,ek->e", starts, starts) * np.einsum("ek,ek->e", ends, ends))[:, None]
    counts = [np.cumsum([0, *(len(each[k]) for each in found)]) for k in range(2)]
    return Shadows(eye, faces, counts[0], planes, counts[1], np.array(numbers, np.int64))


def _cross(a: Array, b: Array) -> Array:
    """Cross products of rows; of a few rows, `numpy.cross` takes ten times as long."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)


def _terrain(case: Case) -> Terrain:
    """The terrain that heights count from, as the search takes it."""
    if case.terrain is None:
        return Terrain(np.zeros((0, 0)), (0.0, 0.0, 1.0), 0.0)
    (columns, rows), (west, south) = case.terrain.size, case.terrain.corner
    return Terrain(np.array(case.terrain.z).reshape(rows, columns), (west, south, case.terrain.step), case.height_m)


def _trees(
    case: Case, elements: NDArray[np.int64], shadows: dict[int, Shadows], terrain: Terrain, bvh: Bvh
) -> list[str]:
    """Trees of some sections; an empty text where none was found."""
    low, high = np.array(case.low), np.array(case.high)
    codes = np.empty(MOST_CODES, np.int64)
    texts = []
    for element in elements.tolist():
        panel = element // case.n
        n = exclude(_panel(case, element), shadows[panel], terrain, bvh, low, high, case.near_m, case.far_m, codes)
        texts.append("".join(map(_letter, codes[:n].tolist())))
    return texts


def _letter(code: int) -> str:
    if code >= 0:
        return f"{'dq'[code % 2]}{code // 2}."
    return {PLANE: "p", CONE: "c", LOW: "t", CUT_X: "X", CUT_X + 1: "Y", CUT_X + 2: "Z"}[code]


def _panel(case: Case, element: int) -> Panel:
    """A section as the search takes it."""
    pane, ring, sector = case._section(element)
    n, t, b = (np.array(axis) for axis in (pane.n, pane.t, pane.b))
    (s0, c0), (s1, c1) = case.angle(sector), case.angle(sector + 1)
    axes, cosines = [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], list(case.steepest)
    if ring > 0:
        axes, cosines = [*axes, n.tolist()], [*cosines, case.angle(ring)[1]]
    sides = np.array([n, c0 * b - s0 * t, s1 * t - c1 * b])
    outer = np.array(case.angle(ring + 1))
    return Panel(np.array(pane.c), np.array([n, t, b]), sides, outer, np.array(axes), np.array(cosines))
