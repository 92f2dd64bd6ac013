"""Windows to panels: four corners each, outdoors only, normals outwards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from planning.base.jit import chunks
from planning.base.messages import first_few, glue, say
from planning.base.progress import Monitor
from planning.geo.bvh import OCCLUSION_OFFSET_M, LineOfSight, line_of_sight
from planning.geo.mesh import TriangleMesh
from planning.site.importing.polygons import fit_quad, plane_axes, quad_areas, start_lower_left, unit_normals
from planning.site.importing.source import SourceModel, SourceWindow
from planning.site.records import panel_triangles

Array = NDArray[np.float64]


# Which side of a window is outdoors, and how much of the outdoors it sees: by rays to the far away.

N_RAYS = 256
"""Directions per side. Against 65 536 of them the share of free ones was off by 0.5 % (69 windows of two real
buildings; 1.7 % at most), in 0.1 ms a window; 64 rays take half the time and are off by 2 % (4 %)."""

FAR_M = 1000.0
"""Length of a ray; what is not hit by then is the sky or the surroundings."""

MIN_OPEN_SHARE = 0.02
"""A window that sees less of the open is indoors: five of 256 rays may slip through the cracks of a model."""

ROOFLESS_FACTOR = 1.5
ROOFLESS_LIMIT = 0.5
"""In a model without roof or ceilings, rooms see the sky: then outdoors is what sees so many times more of it than the
inner sides of windows do (nine tenths of them), or half of everything."""

PANELS_PER_BATCH = 2000
"""Bounds the memory of one batch of rays to 50 MB."""

UNDECIDED = 0.1
"""Sides whose free shares differ by less look alike; then the one away from the building's middle is outside."""

BLIND = 0.1
"""A side that a file calls outside and that sees less is inside, if the other sees more. In 222 windows of eight real
buildings 12 were turned so, and each saw nothing at all. Everything more is believed: models without walls or roofs
leave inside as open as outside, and courts less so."""


class TurnedPanes(NamedTuple):
    """Corners turned so that their normal points outdoors, shape (m, 4, 3), and how open it is there.

    Parameters
    ----------
    corners
        On the outer face of the pane.
    open_share
        Share of the hemisphere's directions, by solid angle, in which nothing of the building is met, seen from the
        point `OCCLUSION_OFFSET_M` in front of the centroid; shape (m,), 0 to 1.
    inner_share
        The same for the other side, shape (m,).
    is_stated
        The file says which side is outside, and is believed, shape (m,).
    is_turned
        The file says so, and is not, shape (m,).
    """

    corners: Array
    open_share: Array
    inner_share: Array
    is_stated: NDArray[np.bool_]
    is_turned: NDArray[np.bool_]

    @property
    def is_decided(self) -> NDArray[np.bool_]:
        """False where both sides are equally open and the file does not say, shape (m,)."""
        return np.asarray(self.is_stated | (np.abs(self.open_share - self.inner_share) >= UNDECIDED))

    @property
    def is_outdoors(self) -> NDArray[np.bool_]:
        """Which panes face the open, shape (m,)."""
        roofless = float(np.percentile(self.inner_share, 90.0)) if len(self.inner_share) else 0.0
        least = max(MIN_OPEN_SHARE, min(ROOFLESS_FACTOR * roofless, ROOFLESS_LIMIT))
        return np.asarray(self.open_share >= np.where(self.is_stated, MIN_OPEN_SHARE, least))


def hemisphere_directions(n: int) -> Array:
    """Directions spread evenly over the hemisphere z > 0, shape (n, 3) (a Fibonacci lattice: equal solid angles)."""
    height = (np.arange(n) + 0.5) / n
    azimuth = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - height**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=-1)


def open_shares(points: Array, normals: Array, sight: LineOfSight, reach_m: float = FAR_M) -> Array:
    """Share of the hemisphere about each normal that is free for `reach_m`, shape (m,), for points of shape (m, 3)."""
    shares = np.zeros(len(points))
    for start, stop in chunks(len(points), PANELS_PER_BATCH):
        axes = np.array([np.stack([*plane_axes(normal), normal]) for normal in normals[start:stop]])
        directions = np.einsum("rk,mkj->mrj", hemisphere_directions(N_RAYS), axes)
        starts = np.repeat(points[start:stop], N_RAYS, axis=0)
        free = sight(starts + reach_m * directions.reshape(-1, 3), starts)
        shares[start:stop] = free.reshape(-1, N_RAYS).mean(axis=1)
    return shares


def turn_outwards(
    corners: Array,
    thickness_m: Array,
    middle: Array,
    sight: LineOfSight,
    is_oriented: NDArray[np.bool_] | None = None,
) -> TurnedPanes:
    """Find the outer side of every quad.

    Parameters
    ----------
    corners
        Quads on the middle planes of their panes, shape (m, 4, 3).
    thickness_m
        Of the panes, shape (m,).
    middle
        Middle of the building, shape (3,).
    sight
        Line of sight among all triangles of the building and its panes.
    is_oriented
        Which quads turn counter-clockwise as seen from the side that the file calls outside, shape (m,); else none.
    """
    normals = unit_normals(corners)
    centres = corners.mean(axis=1)
    face = 0.5 * thickness_m[:, None] * normals
    front = open_shares(centres + face + OCCLUSION_OFFSET_M * normals, normals, sight)
    back = open_shares(centres - face - OCCLUSION_OFFSET_M * normals, -normals, sight)
    is_decided = np.abs(front - back) >= UNDECIDED
    faces_away = np.einsum("mk,mk->m", centres - middle, normals) >= 0.0
    oriented = np.zeros(len(corners), bool) if is_oriented is None else is_oriented
    is_inside = (front < BLIND) & (back >= front + UNDECIDED)
    is_front = np.where(oriented, ~is_inside, np.where(is_decided, front > back, faces_away))
    turned = np.where(is_front[:, None, None], corners + face[:, None], (corners - face[:, None])[:, ::-1])
    outer, inner = np.where(is_front, front, back), np.where(is_front, back, front)
    return TurnedPanes(turned, outer, inner, oriented & ~is_inside, oriented & is_inside)


# Panels that show the same pane twice: a window inside a curtain wall panel, two skins of glass, a drawing doubled.

SAME_ANGLE_RAD = np.radians(10.0)
SAME_DEPTH_M = 0.6
"""Panels whose planes are no further apart can be one pane; the cavity of a double-skin facade is 0.2 m and more."""

SAME_SHARE = 0.5
"""Panels are the same where at least this share of the smaller one's area lies over the other."""

SAME_PLANE_M = 0.01
"""Nearer planes are one: then the smaller panel goes, else the inner one."""


def without_duplicates(corners: Array) -> NDArray[np.int64]:
    """Indices of the panels to keep, ascending, from corners of shape (m, 4, 3), counter-clockwise from outside.

    A large panel over two or more small ones that fill it goes (the frame of a curtain wall over its panes). Of two
    that show the same pane the inner one goes, or the smaller one where they lie in one plane.
    """
    kept = np.ones(len(corners), np.bool_)
    pairs = _overlapping_pairs(corners)
    areas = quad_areas(corners)
    filled, n_inside = np.zeros(len(corners)), np.zeros(len(corners), np.int64)
    for i, j, overlap, _ in pairs:
        small, large = (i, j) if areas[i] < areas[j] else (j, i)
        filled[large] += overlap
        n_inside[large] += areas[small] < SAME_SHARE * areas[large]
    kept[(n_inside >= 2) & (filled >= SAME_SHARE * areas)] = False
    for i, j, _, j_is_outside_m in pairs:
        if kept[i] and kept[j]:
            if abs(j_is_outside_m) > SAME_PLANE_M:
                kept[i if j_is_outside_m > 0.0 else j] = False
            else:
                kept[i if areas[i] < areas[j] else j] = False
    return np.flatnonzero(kept)


def coincident_pairs(corners: Array) -> list[tuple[int, int]]:
    """Pairs of panels with the same centroid to a millimetre and areas equal to 1 %."""
    areas = quad_areas(corners)
    pairs = KDTree(corners.mean(axis=1)).query_pairs(0.001) if len(corners) else set()
    return sorted((i, j) for i, j in pairs if abs(areas[i] - areas[j]) <= 0.01 * max(areas[i], areas[j]))


def _overlapping_pairs(corners: Array) -> list[tuple[int, int, float, float]]:
    """Pairs (i, j, overlapping area, distance of j outside the plane of i) that may be the same pane."""
    import shapely

    if len(corners) < 2:
        return []
    areas, normals, centres = quad_areas(corners), unit_normals(corners), corners.mean(axis=1)
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    tree = KDTree(centres)
    found = []
    for i in range(len(corners)):
        # The smaller of two is looked for around the larger, so that each pair is met once and nothing is missed.
        for j in tree.query_ball_point(centres[i], radius[i] + SAME_DEPTH_M):
            if (radius[j], j) >= (radius[i], i) or normals[i] @ normals[j] < np.cos(SAME_ANGLE_RAD):
                continue
            outside_m = float(normals[i] @ (centres[j] - centres[i]))
            if abs(outside_m) > SAME_DEPTH_M:
                continue
            axes = np.stack(plane_axes(normals[i]), axis=-1)
            a, b = (shapely.Polygon((corners[k] - centres[i]) @ axes) for k in (i, j))
            overlap = float(shapely.intersection(a, b).area)
            if overlap >= SAME_SHARE * areas[j]:
                found.append((i, j, overlap, outside_m))
    return found


OWN_REACH_M = 1.5
"""What hides a direction within this distance is the window's own frame, reveal or sill."""


MAX_NAMED = 3
"""Windows named in a note."""


@dataclass(frozen=True, slots=True, eq=False)
class Panes:
    """Panels to be, in the order of the file.

    Parameters
    ----------
    corners
        Shape (m, 4, 3), ENU metres, counter-clockwise from outside, lower left first.
    source_ids
        One for each.
    notes
        What was left out or changed, and how much of the open the panels see.
    """

    corners: Array
    source_ids: tuple[str, ...]
    notes: tuple[str, ...]


def panes_outdoors(source: SourceModel, monitor: Monitor) -> Panes:
    """Find the panels among the windows of a building."""
    monitor.report(say("fitting panels"), 0, len(source.windows))
    quads = [fit_quad(window.outline_enu_m) for window in source.windows]
    fitted = [(window, quad) for window, quad in zip(source.windows, quads, strict=True) if quad is not None]
    notes = _counted(say("windows left out as slivers or without area"), len(source.windows) - len(fitted))
    if not fitted:
        return Panes(np.zeros((0, 4, 3)), (), tuple(notes))
    windows = [window for window, _ in fitted]
    sides = _sides(windows, np.array([quad.corners for _, quad in fitted]), source.building, monitor)
    kept = np.flatnonzero(sides.is_outdoors)
    notes += _counted(say("windows left out as indoor ones, which see nothing of the open"), len(windows) - len(kept))
    if source.repeats_panes:
        n_outdoors = len(kept)
        kept = kept[without_duplicates(sides.corners[kept])]
        notes += _counted(say("windows left out because another one shows the same pane"), n_outdoors - len(kept))
    else:
        pairs = [(windows[kept[i]], windows[kept[j]]) for i, j in coincident_pairs(sides.corners[kept])]
        twice = [f"{first.source_id} = {second.source_id}" for first, second in pairs]
        notes += _counted(say("windows that lie exactly on others, where both stay"), len(twice), twice)
    odd = [windows[i].source_id for i in kept if not fitted[i][1].is_exact]
    notes += _counted(say("windows that are no quads, for which a rectangle of the same area stands in"), len(odd), odd)
    against = [windows[i].source_id for i in kept if sides.is_turned[i]]
    notes += _counted(say("windows that the file has facing into the building, turned around"), len(against), against)
    n_undecided = int((~sides.is_decided[kept]).sum())
    notes += _counted(say("windows open on both sides, taken to face away from the building"), n_undecided)
    corners = np.array([start_lower_left(quad) for quad in sides.corners[kept]]).reshape(-1, 4, 3)
    if len(corners):
        notes.append(_view(corners, sides.open_share[kept], source.building))
    return Panes(corners, tuple(windows[i].source_id for i in kept), tuple(notes))


def _sides(windows: list[SourceWindow], corners: Array, building: TriangleMesh, monitor: Monitor) -> TurnedPanes:
    triangles = np.concatenate([building.corners_enu_m, panel_triangles(corners)])
    middle = 0.5 * (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1)))
    monitor.report(say("looking outdoors"), 0, 1)
    thickness_m = np.array([window.thickness_m for window in windows])
    is_oriented = np.array([window.is_oriented for window in windows])
    return turn_outwards(corners, thickness_m, middle, line_of_sight(triangles), is_oriented)


def _view(corners: Array, open_share: Array, building: TriangleMesh) -> str:
    """How much of their hemispheres the panels see, as a note."""
    normals = unit_normals(corners)
    targets = corners.mean(axis=1) + OCCLUSION_OFFSET_M * normals
    own = 1.0 - open_shares(targets, normals, line_of_sight(building.corners_enu_m), OWN_REACH_M)
    return say(
        "{:g} m in front of the panels the building hides {:.0f} % of the directions (worst panel {:.0f} "
        "%); their own frames and reveals hide {:.0f} % (worst {:.0f} %)",
        OCCLUSION_OFFSET_M,
        100.0 * (1.0 - open_share.mean()),
        100.0 * (1.0 - open_share.min()),
        100.0 * own.mean(),
        100.0 * own.max(),
    )


def _counted(what: str, n: int, names: Sequence[str] = ()) -> list[str]:
    """A note with a count and the first few names; none where there is nothing to count."""
    if n == 0:
        return []
    return [glue(what, f": {n}", glue(" (", first_few(names, MAX_NAMED), ")") if names else "")]
