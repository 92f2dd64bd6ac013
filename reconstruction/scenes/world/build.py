"""Scenes out of sites: panels become panes in their profiles, the building a wall behind them, and streets are laid.

Rooms behind the panes are drawn at random: offices over one or several panes, with furniture and blinds. Their lights
are such that a room, seen through all its panes from all sides, has the mean light asked for.
"""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from planning.coverage.sections import PanelFrames, panel_frames
from planning.geo.mesh import TriangleMesh, empty_mesh, from_corners
from planning.site.records import Site, SiteModel, panel_corners, panel_triangles, require_panels
from reconstruction.scenes.light.geometry import PaneFrames
from reconstruction.scenes.light.interiors import SLAT_SHADE, room_shares
from reconstruction.scenes.light.pane_surfaces import half_sides_m
from reconstruction.scenes.record import Body, Glass, Interiors, Layer, Panes, Scene, Sky
from reconstruction.scenes.world.ground import decide_ground, scene_ground
from reconstruction.scenes.world.look import Look
from reconstruction.scenes.world.surroundings import surround
from reconstruction.scenes.world.textures import grain, smooth_noise

Array = NDArray[np.float64]
Index = NDArray[np.int64]

MOST_PANES = 4
"""Of one room."""

SAME = 0.05
"""Of the frames of panes side by side: metres, and differences of their normals."""

GAP_M = 0.5
"""Panes further apart belong to different rooms."""

ABOVE_M, LEAST_HEIGHT_M, LEAST_WIDTH_M = 0.25, 2.7, 2.4
"""From a pane to the ceiling above it, and least sizes of a room."""

DEPTH_M = (3.5, 7.0)
LIT_LAMPS, DARK_LAMPS = 6.0, 1.1
"""How many times brighter than the ceiling lamps are: switched on, and off."""

N_BLOCKS, BLOCK_SHADES = 3, (0.2, 0.8)

N_ALONG, N_DIRECTIONS = 4, 64
"""Rays that measure the mean of a room: places along each side of its pane, and directions through each."""

PAINT_M = 0.001
"""Behind the pane: as good as on it."""

STEEPEST = 0.05
"""Least height that a room's pane rises in a metre: level panes show no room but a blind."""


def shared_rooms(panes: Panes, rng: np.random.Generator) -> Index:
    """Number of the first pane of each pane's room, shape (m,): up to `MOST_PANES` side by side in one plane."""
    frames = PaneFrames.of(panes)
    halves, middles = half_sides_m(panes, frames), frames.middles_enu_m
    off = np.einsum("mk,mk->m", middles, frames.normals)
    along, height = (np.einsum("mk,mk->m", middles, axis) for axis in (frames.rights, frames.ups))
    same = np.column_stack([frames.normals, off, height, halves[:, 1]])
    order = np.lexsort([along, *np.round(same / SAME).T])
    first = np.arange(len(along))
    room_start, wanted = -1, 0
    for before, pane in zip(np.concatenate([[-1], order[:-1]]), order, strict=True):
        is_beside = (
            before >= 0
            and np.abs(same[pane] - same[before]).max() <= SAME
            and along[pane] - along[before] - halves[pane, 0] - halves[before, 0] <= GAP_M
        )
        if not is_beside or wanted == 0:
            room_start, wanted = pane, int(rng.integers(1, MOST_PANES + 1))
        first[pane], wanted = room_start, wanted - 1
    return first


def furnished(
    panes: Panes, first: Index, is_lit: NDArray[np.bool_], lights: Array, blinds: Array, blind_lights: Array,
    rng: np.random.Generator,
) -> tuple[Interiors, Array]:  # fmt: skip
    """Rooms that have the mean lights asked for, and the mean light that then comes from behind each pane, (m, 3).

    Parameters
    ----------
    first
        Of `shared_rooms`.
    is_lit
        Whether lamps are switched on, shape (m,); as with the lights, that of a room's first pane counts.
    lights, blind_lights
        Mean light of each room, and that of each pane's blind, shape (m, 3).
    blinds
        Share of each pane that the blind covers, shape (m,).
    """
    frames = PaneFrames.of(panes)
    halves = half_sides_m(panes, frames)
    boxes = _boxes(frames, halves, first, rng)
    blocks = _furniture(boxes, first, rng)
    # They stand in the room, whichever pane it is seen through.
    beside = np.einsum("mk,mk->m", frames.middles_enu_m - frames.middles_enu_m[first], frames.rights)
    blocks[..., :2] -= beside[:, None, None]
    lamps, lights = np.where(is_lit, LIT_LAMPS, DARK_LAMPS)[first], lights[first]
    is_level = np.abs(frames.ups[:, 2]) < STEEPEST
    blinds, blind_lights = np.where(is_level, 1.0, blinds), np.where(is_level[:, None], lights, blind_lights)
    sums, counts = _shares(frames, halves, boxes, blocks, lamps, blinds)
    of_pane = _ratio(sums, counts)
    of_room = _ratio(*(np.bincount(first, each, len(first)).astype(float) for each in (sums, counts)))[first]
    walls = lights / of_room[:, None]
    covered = blinds[:, None]
    means = covered * blind_lights + (1.0 - covered) * of_pane[:, None] * walls
    return Interiors(boxes, blocks, lamps, walls, blinds, blind_lights / (1.0 - SLAT_SHADE)), means


def painted(panes: Panes, interiors: Interiors, is_painted: NDArray[np.bool_], light: Array) -> tuple[Interiors, Array]:
    """The same with some panes, mask of shape (m,), painted behind, and the mean light from behind all, (m, 3).

    Parameters
    ----------
    light
        Of the paint, shape (3,).
    """
    halves = half_sides_m(panes, PaneFrames.of(panes))
    thin = np.column_stack([-halves[:, 0], halves[:, 0], -halves[:, 1], halves[:, 1], np.full(len(halves), PAINT_M)])
    column = is_painted[:, None]
    changed = Interiors(
        np.where(column, thin, interiors.rooms_m),
        np.where(column[..., None], 0.0, interiors.furniture_m),
        np.where(is_painted, 1.0, interiors.lamps),
        np.where(column, light, interiors.lights),
        np.where(is_painted, 0.0, interiors.blinds),
        interiors.blind_lights,
    )
    return changed, np.where(column, light, panes.rooms)


def _ratio(sums: Array, counts: Array) -> Array:
    """Mean shares; 1 where nothing of a room is seen."""
    return np.divide(sums, counts, out=np.ones(len(sums)), where=sums > 0.0)


def _boxes(frames: PaneFrames, halves: Array, first: Index, rng: np.random.Generator) -> Array:
    """As in `Interiors`, around all panes of each room."""
    m = len(first)
    beside = np.einsum("mk,mk->m", frames.middles_enu_m - frames.middles_enu_m[first], frames.rights)
    # Zero beside the first panes, which reach to both sides of themselves.
    left, right = np.zeros(m), np.zeros(m)
    np.minimum.at(left, first, beside - halves[:, 0])
    np.maximum.at(right, first, beside + halves[:, 0])
    wider = 0.5 * np.maximum(LEAST_WIDTH_M - (right - left), 0.0)
    left, right = (left - wider)[first] - beside, (right + wider)[first] - beside
    height = np.maximum(2.0 * halves[:, 1] + 2.0 * ABOVE_M, LEAST_HEIGHT_M)
    ceiling = halves[:, 1] + ABOVE_M
    return np.column_stack([left, right, ceiling - height, ceiling, rng.uniform(*DEPTH_M, m)[first]])


def _furniture(boxes: Array, first: Index, rng: np.random.Generator) -> Array:
    """Desks by the window, cabinets at the back and something between, in the frames of the rooms' first panes."""
    m, n = len(boxes), N_BLOCKS
    width, depth = (boxes[:, 1] - boxes[:, 0])[:, None], boxes[:, 4:]
    across = np.minimum(rng.uniform(0.5, 1.8, (m, n)), 0.6 * width)
    left = boxes[:, :1] + rng.uniform(0.0, 1.0, (m, n)) * (width - across)
    height = rng.uniform([0.7, 0.6, 1.0], [0.8, 1.4, 2.2], (m, n))
    deep = rng.uniform(0.4, 0.8, (m, n))
    front = np.array([0.15, 0.5, 1.0]) * (depth - deep) + np.array([0.3, 0.0, 0.0])
    shade = rng.uniform(*BLOCK_SHADES, (m, n))
    blocks = np.stack([left, left + across, height, front, front + deep, shade], axis=-1)
    blocks[..., 2] *= rng.random((m, n)) < 0.8
    return np.asarray(blocks[first])


def _shares(
    frames: PaneFrames, halves: Array, boxes: Array, blocks: Array, lamps: Array, blinds: Array
) -> tuple[Array, Array]:
    """Sums of the shares of the room's light over rays from all sides that no blind stops, and their numbers, (m,)."""
    m = len(halves)
    # As light falls on a surface from all sides: radii by the square root, azimuths by the golden section.
    k = np.arange(N_DIRECTIONS)
    radius, azimuth = np.sqrt((k + 0.5) / N_DIRECTIONS), 2.0 * math.pi * (k * 0.618033988749895 % 1.0)
    local = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.sqrt(1.0 - radius**2)], axis=1)
    along = (np.arange(N_ALONG) + 0.5) / N_ALONG * 2.0 - 1.0
    axes = np.stack([frames.rights, frames.ups, -frames.normals])
    rays = np.einsum("dj,jmk->mdk", local, axes).reshape(-1, 3)
    which, no_detail = np.repeat(np.arange(m), N_DIRECTIONS), np.full(len(rays), np.inf)
    sums, counts = np.zeros(m), np.zeros(m)
    for place in np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2):
        points = frames.middles_enu_m + np.einsum("mj,jmk->mk", place * halves, axes[:2])
        shares = room_shares(
            np.repeat(points, N_DIRECTIONS, axis=0), rays, which, no_detail, frames.middles_enu_m, axes, halves,
            boxes, blocks, lamps, blinds,
        ).reshape(m, N_DIRECTIONS, 2)  # fmt: skip
        sums += shares[..., 0].sum(axis=1)
        counts += (shares[..., 1] == 0.0).sum(axis=1)
    return sums, counts


# Openings for panes in a building's mesh: no ray from outside may meet the wall before the pane.
#
# Coarse meshes have their wall in the plane of the panels, or a little before it. The wall is not moved, which would
# tear it from its neighbours: what lies in the prism that stands on a panel, from `BEHIND_M` behind it to `BEFORE_M`
# before it, is cut out of the triangles. Between panels, and where the wall stands well behind or far before them, it
# stays.

CUT_BEHIND_M = 0.05
"""Embree's float32 tells planes apart that are a hundredth of this apart."""

BEFORE_M = 0.30
"""Sills and frames of detailed models, and walls of coarse ones, stand before the glass by less."""

TOUCHING_M = 1e-6
"""Closer to a plane, a corner lies in it."""

CUT_LEAST_AREA_M2 = 1e-8


def without_openings(wall: TriangleMesh, panels: PanelFrames) -> TriangleMesh:
    """The wall without what lies in the prisms of the panels; the mesh itself where nothing does."""
    corners = wall.corners_enu_m
    if not len(corners) or not len(panels):
        return wall
    prisms = _Prisms(panels)
    is_near = _overlap(corners.min(axis=1), corners.max(axis=1), prisms.low.min(axis=0), prisms.high.max(axis=0))
    kept = [corners[~is_near]]
    everyone = np.arange(len(panels))
    is_cut = False
    for triangle in corners[is_near]:
        pieces = prisms.cut(triangle, everyone)
        is_cut |= len(pieces) != 1 or pieces[0] is not triangle
        kept += [_fan(piece) for piece in pieces]
    return from_corners(np.concatenate(kept)) if is_cut else wall


class _Prisms:
    """Six planes a panel, normals outwards: a point is inside where `normals @ point <= offsets` for all of them."""

    def __init__(self, panels: PanelFrames) -> None:
        corners, normals = panels.corners, panels.normals
        edges = np.roll(corners, -1, axis=1) - corners
        lengths = np.linalg.norm(edges, axis=2, keepdims=True)
        sides = np.cross(edges, normals[:, None]) / np.where(lengths > 0.0, lengths, 1.0)
        heights = np.einsum("mkx,mx->mk", corners, normals)
        self.normals = np.concatenate([normals[:, None], -normals[:, None], sides], axis=1)
        self.offsets = np.column_stack(
            [
                heights.max(axis=1) + BEFORE_M,
                CUT_BEHIND_M - heights.min(axis=1),
                np.einsum("mkx,mkx->mk", corners, sides),
            ]
        )
        before, behind = BEFORE_M * normals[:, None], CUT_BEHIND_M * normals[:, None]
        ends = np.concatenate([corners + before, corners - behind], axis=1)
        self.low, self.high = ends.min(axis=1), ends.max(axis=1)

    def cut(self, polygon: Array, panels: NDArray[np.int64]) -> list[Array]:
        """What of a convex polygon, shape (k, 3), lies outside all prisms of `panels`."""
        near = _overlap(self.low[panels], self.high[panels], polygon.min(axis=0), polygon.max(axis=0))
        panels = panels[near]
        # The middle one first, so that the pieces on both sides of it meet half of the others each.
        for i in np.argsort(np.abs(np.arange(len(panels)) - len(panels) // 2), kind="stable"):
            pieces = self._outside(polygon, int(panels[i]))
            if pieces is not None:
                others = np.delete(panels, i)
                return [part for piece in pieces for part in self.cut(piece, others)]
        return [polygon]

    def _outside(self, polygon: Array, panel: int) -> list[Array] | None:
        """Convex pieces of a polygon outside a prism; None where all of it is."""
        pieces, rest = [], polygon
        for normal, offset in zip(self.normals[panel], self.offsets[panel], strict=True):
            heights = rest @ normal - offset
            if (heights >= -TOUCHING_M).all():
                # A degenerate side's plane has no normal and lets everything pass.
                if normal.any():
                    return None
            elif (heights > TOUCHING_M).any():
                piece, rest = _split(rest, heights)
                pieces.append(piece)
        return [piece for piece in pieces if _area(piece) > CUT_LEAST_AREA_M2]


def _overlap(low_a: Array, high_a: Array, low_b: Array, high_b: Array) -> NDArray[np.bool_]:
    return np.asarray(((low_a <= high_b) & (high_a >= low_b)).all(axis=-1))


def _split(polygon: Array, heights: Array) -> tuple[Array, Array]:
    """Parts of a convex polygon above and below a plane."""
    above, below = [], []
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        a, b = heights[i], heights[j]
        if a >= 0.0:
            above.append(polygon[i])
        if a <= 0.0:
            below.append(polygon[i])
        if a * b < 0.0:
            crossing = polygon[i] + a / (a - b) * (polygon[j] - polygon[i])
            above.append(crossing)
            below.append(crossing)
    return np.array(above), np.array(below)


def _area(polygon: Array) -> float:
    relative = polygon - polygon[0]
    return float(0.5 * np.linalg.norm(np.cross(relative[1:-1], relative[2:]).sum(axis=0)))


def _fan(polygon: Array) -> Array:
    """Triangles of a convex polygon, shape (k - 2, 3, 3)."""
    first = np.broadcast_to(polygon[0], (len(polygon) - 2, 3))
    return np.stack([first, polygon[1:-1], polygon[2:]], axis=1)


# Mullions and transoms: a ring of profile around each pane, up to the middle of the gap to its neighbours.
#
# Where panels have a gap between them, their rings fill it and leave the glass free. Where they meet, or end, the
# ring
# covers half a profile's width of the glass along that edge, and half of it beyond an edge where no panel follows.

WIDEST_GAP_M = 0.4
"""Panels further apart have wall between them."""

LEAST_COSINE = 0.85
"""Of the angles between neighbours' normals and edges: around a sharper corner each panel has its own profile."""

BEHIND_M = 0.02
"""How far rings reach behind the glass, so that no ray passes between them."""

MITRE = 3.0
"""A corner moves this much further than its edges, at most: at sharp corners the ring is cut off."""

COVERED = 0.2
"""Share of a panel's shortest edge that its ring covers, at most."""

N_CANDIDATES = 12
"""Nearest edges that are looked at for an edge's neighbour."""


def profile_rings(panels: PanelFrames, width_m: float, depth_m: float) -> TriangleMesh:
    """Rings around panels, standing `depth_m` out before them.

    Parameters
    ----------
    width_m
        Of the profiles where no gap between panels says it.
    """
    if not len(panels):
        return empty_mesh()
    corners, normals = panels.corners, panels.normals[:, None]
    gaps, cosines = edge_gaps(panels)
    has_neighbour = np.isfinite(gaps)
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    most = COVERED * np.where(lengths > 0.0, lengths, np.inf).min(axis=1, keepdims=True)
    half_gaps = np.where(has_neighbour, 0.5 * np.where(has_neighbour, gaps, 0.0), 0.5 * width_m)
    covered = np.where(has_neighbour, np.clip(0.5 * width_m - half_gaps, 0.0, None), 0.5 * width_m)
    # On convex facades rings lean apart: their fronts reach as far over as it takes to meet.
    lean = depth_m * np.sqrt((1.0 - cosines) / (1.0 + cosines))
    outer = corners + _moved_corners(panels, half_gaps + lean)
    inner = corners - _moved_corners(panels, np.minimum(covered, most))
    front, back = depth_m * normals, -BEHIND_M * normals
    faces = [
        _bands(inner + front, outer + front),
        _bands(inner + back, inner + front),
        _bands(outer + front, outer + back)[~has_neighbour.reshape(-1)],
    ]
    return from_corners(panel_triangles(np.concatenate(faces)))


def _bands(first: Array, second: Array) -> Array:
    """Quads between two closed rings of four corners, shape (m, 4, 3) each, to (4 m, 4, 3)."""
    quads = np.stack([first, second, np.roll(second, -1, axis=1), np.roll(first, -1, axis=1)], axis=2)
    return quads.reshape(-1, 4, 3)


def edge_gaps(panels: PanelFrames) -> tuple[Array, Array]:
    """Distance from each edge to the next panel and the cosine of the angle between their normals, both shape (m, 4).

    Edges are those from a corner to the next; inf and 1 where no panel follows within `WIDEST_GAP_M`.
    """
    gaps, neighbours = edge_neighbours(panels)
    cosines = np.einsum("mx,mkx->mk", panels.normals, panels.normals[neighbours])
    return gaps, np.where(neighbours >= 0, np.clip(cosines, -1.0, 1.0), 1.0)


def edge_neighbours(panels: PanelFrames) -> tuple[Array, NDArray[np.int64]]:
    """Distance from each edge to the next panel, and which panel that is, both shape (m, 4); inf and -1 for none."""
    from scipy.spatial import KDTree

    starts = panels.corners.reshape(-1, 3)
    ends = np.roll(panels.corners, -1, axis=1).reshape(-1, 3)
    middles = 0.5 * (starts + ends)
    n_edges = len(middles)
    owners = np.repeat(np.arange(len(panels)), 4)
    # The edges of the own panel are among the nearest.
    _, others = KDTree(middles).query(middles, k=min(N_CANDIDATES, n_edges))
    others = others.reshape(n_edges, -1)
    along = (ends - starts)[others]
    towards = middles[:, None] - starts[others]
    lengths2 = np.maximum((along**2).sum(axis=2), 1e-12)
    nearest = np.clip((towards * along).sum(axis=2) / lengths2, 0.0, 1.0)
    distances = np.linalg.norm(towards - nearest[..., None] * along, axis=2)
    cosines = np.einsum("ex,ekx->ek", panels.normals[owners], panels.normals[owners[others]])
    is_neighbour = (owners[others] != owners[:, None]) & (distances <= WIDEST_GAP_M) & (cosines >= LEAST_COSINE)
    # Neighbours' edges run against each other; an edge without length, as a triangle has one, meets none.
    reversed_along = -np.einsum("ex,ekx->ek", ends - starts, along)
    own_lengths = np.linalg.norm(ends - starts, axis=1)[:, None]
    is_neighbour &= (reversed_along >= LEAST_COSINE * own_lengths * np.sqrt(lengths2)) & (own_lengths > 0.0)
    distances = np.where(is_neighbour, distances, np.inf)
    best = distances.argmin(axis=1)
    rows = np.arange(n_edges)
    gaps = distances[rows, best]
    neighbours = np.where(np.isfinite(gaps), owners[others[rows, best]], -1)
    return gaps.reshape(-1, 4), neighbours.reshape(-1, 4)


def _moved_corners(panels: PanelFrames, offsets_m: Array) -> Array:
    """How corners move when each edge moves outwards by its offset, shape (m, 4, 3)."""
    edges = np.roll(panels.corners, -1, axis=1) - panels.corners
    across = np.cross(edges, panels.normals[:, None])
    lengths = np.linalg.norm(across, axis=2, keepdims=True)
    across = np.where(lengths > 0.0, across / np.where(lengths > 0.0, lengths, 1.0), 0.0)
    pairs = np.stack([np.roll(across, 1, axis=1), across], axis=2)
    wanted = np.stack([np.roll(offsets_m, 1, axis=1), offsets_m], axis=2)
    # The shortest move that suits both edges; one is enough where they lie in a line or an edge has no length.
    moved = np.einsum("mkxp,mkp->mkx", np.linalg.pinv(pairs, rcond=1e-6), wanted)
    length = np.linalg.norm(moved, axis=2, keepdims=True)
    longest = MITRE * wanted.max(axis=2, initial=0.0)[..., None]
    return np.asarray(moved * np.minimum(1.0, longest / np.maximum(length, 1e-12)))


# Everything far away as one picture around: sky with clouds, a hazy skyline, and the ground down to the nadir.

Picture = NDArray[np.float32]

HEIGHT_PX = 1024
"""0.18 degrees a pixel."""

TILE_PX = 512

CLOUD = np.array([0.93, 0.93, 0.94], np.float32)
GROUND = np.array([0.22, 0.23, 0.19], np.float32)
"""Mean light of streets and parks in the sun."""


def panorama(rng: np.random.Generator, sky: Sky, clouds: float, skyline_deg: float) -> Picture:
    """Picture as `Sky.panorama` has it, shape (HEIGHT_PX, 2 HEIGHT_PX, 3), 0 to 1.

    Parameters
    ----------
    clouds
        Share of the sky that they cover.
    skyline_deg
        Elevation of the highest building.
    """
    elevation = np.radians(90.0 - (np.arange(HEIGHT_PX) + 0.5) * (180.0 / HEIGHT_PX))
    heading = np.radians((np.arange(2 * HEIGHT_PX) + 0.5) * (180.0 / HEIGHT_PX))
    picture = np.empty((HEIGHT_PX, 2 * HEIGHT_PX, 3), np.float32)
    half = HEIGHT_PX // 2
    horizon, zenith = np.array(sky.horizon, np.float32), np.array(sky.zenith, np.float32)
    rise = np.sin(elevation[:half]).astype(np.float32)
    picture[:half] = (horizon + rise[:, None] * (zenith - horizon))[:, None]
    # Clouds lie on a level plane, which the horizon is 0.12 heights short of reaching.
    cover = _on_plane(_noise(rng, (4, 8, 16, 32, 64)), elevation[:half], heading, 0.12, 60.0)
    threshold = np.quantile(cover[: half // 2], 1.0 - clouds) if 0.0 < clouds < 1.0 else 1.0 - clouds
    share = np.clip(4.0 * (cover - np.float32(threshold)) + 0.5, 0.0, 1.0) if clouds > 0.0 else np.zeros_like(cover)
    share *= np.clip(rise / 0.12, 0.0, 1.0)[:, None]
    picture[:half] += share[..., None] * (CLOUD - picture[:half])
    ground = GROUND * _on_plane(_blocks(rng), elevation[half:], heading, 0.02, 60.0)[..., None]
    haze = np.exp(np.sin(elevation[half:]) * 12.0).astype(np.float32)[:, None, None]
    picture[half:] = ground + 0.6 * haze * (horizon - ground)
    if skyline_deg > 0.0:
        _paint_skyline(rng, picture, sky, skyline_deg)
    return np.clip(picture, 0.0, 1.0)


def _noise(rng: np.random.Generator, sizes: tuple[int, ...]) -> Picture:
    """Octaves of smooth noise, the finer the fainter, stretched to 0 to 1."""
    value = smooth_noise(rng, TILE_PX, tuple((size, 1.0 / size) for size in sizes))
    return np.asarray((value - value.min()) / (value.max() - value.min()), np.float32)


def _blocks(rng: np.random.Generator) -> Picture:
    """A town from above: roofs lighter and darker, with streets between them; around 1, and without a seam."""
    side = 16
    n = TILE_PX // side
    value = np.repeat(np.repeat(rng.uniform(0.5, 1.6, (n, n)), side, axis=0), side, axis=1).astype(np.float32)
    street = np.arange(TILE_PX) % side < 3
    value[street], value[:, street] = 0.6, 0.6
    return np.asarray(value * (0.8 + 0.4 * _noise(rng, (16, 64, 256))), np.float32)


def _on_plane(
    tile: Picture, elevation: NDArray[np.float64], heading: NDArray[np.float64], least: float, px: float
) -> Picture:
    """What lies on a level plane above or below, `px` pixels of the tile to its height."""
    away = px / (np.tan(np.abs(elevation)) + least)
    x = (away[:, None] * np.sin(heading)).astype(np.float32)
    y = (away[:, None] * np.cos(heading)).astype(np.float32)
    return np.asarray(cv2.remap(tile, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP), np.float32)


def _paint_skyline(rng: np.random.Generator, picture: Picture, sky: Sky, highest_deg: float) -> None:
    """Two rows of buildings, the further one hazier and higher."""
    horizon, scale = HEIGHT_PX // 2, HEIGHT_PX / 180.0
    haze_colour = np.array(sky.horizon)
    for haze, part in ((0.6, 1.0), (0.3, 0.6)):
        x = 0
        while x < picture.shape[1]:
            width = max(2, round(rng.uniform(1.0, 5.0) * scale))
            height = round(highest_deg * part * rng.uniform(0.25, 1.0) * scale)
            # Walls that face us are lit where the sun stands behind us.
            towards_sun = np.cos(np.radians((x + width / 2) / scale - sky.sun_heading_deg - 180.0))
            sun = np.sin(np.radians(max(0.0, 90.0 - sky.sun_elevation_deg))) * (sky.sun_elevation_deg > 0.0)
            light = 0.35 + np.array(sky.sun) * sun * max(0.0, float(towards_sun))
            shade = rng.uniform(0.25, 0.8) * rng.uniform(0.9, 1.0, 3) * light
            block = np.broadcast_to(shade, (height + 2, width, 3)).copy()
            window = rng.random((height + 2, width)) < 0.45
            window[::3] = False
            window[:, ::3] = False
            block[window] *= rng.uniform(0.3, 0.7)
            block += haze * (haze_colour - block)
            right = min(x + width, picture.shape[1])
            picture[horizon - height : horizon + 2, x:right] = block[:, : right - x]
            x += width + round(rng.choice([0.0, 0.0, rng.uniform(0.5, 3.0)]) * scale)


OTHER_COATING = 0.12
"""How much more or less panes of another batch mirror."""

DUSTY = 0.06
"""Share of dust on panes that are hard to clean, beyond that of the others."""

DUSTY_PANES = 0.15

ROOM, LAMP, BLIND = (0.05, 0.05, 0.048), (0.3, 0.26, 0.18), (0.42, 0.41, 0.38)
"""Light of a dim room, a lit one, and a blind in daylight."""

LIT_ROOMS = 0.12

PAINT = (0.1, 0.11, 0.13)
"""Light of spandrels' paint, a dark grey, in daylight."""

SAME_ROW_M = 0.3
"""Difference of their middles' heights up to which panels are of one row."""

LEAST_AREA_M2 = 1e-10
"""Smaller triangles are left out: 10 micrometres square."""


def build_scene(model: SiteModel, look: Look | None = None, seed: int = 0, terrain: EffectSetting = "auto") -> Scene:
    """A site with all that a photo of it shows.

    The panes are the site's panels themselves. What of the building's mesh lies in their plane or up to 0.3 m before it
    is cut out behind them (`without_openings`). Buildings opposite and trees stand among the obstacles of the scene's
    site, so that flights planned on it keep away from them; the site's hash stays.

    Panes, sky and surroundings draw from generators of their own: the panes of a scene are the same with and without
    what is near.

    Parameters
    ----------
    terrain
        Whether the ground is the site's terrain; `auto`: where the glass shows the difference.

    Raises
    ------
    InputError
        The site has no panels.
    """
    require_panels(model.site)
    look = look or Look()
    panels = _lower_left_first(panel_frames(panel_corners(model.site)))
    walls, sky, around, glass, inside = (np.random.default_rng([seed, part]) for part in range(5))
    bodies = [_frames(panels, look)]
    building = without_openings(model.building, panels)
    bodies.append(Body("walls", Layer.BUILDING, building, look.wall_albedo, grain(walls, (0.9,) * 3, 0.12, 30.0)))
    bodies += [
        Body(f"obstacle-{obstacle.id}", Layer.NEAR, mesh, (0.5, 0.48, 0.45), grain(walls, (0.85,) * 3, 0.3, 15.0))
        for obstacle, mesh in zip(model.site.obstacles, model.obstacles, strict=True)
    ]
    bodies = [replace(body, mesh=_with_area(body.mesh)) for body in bodies]
    decision = decide_ground(model, terrain) if look.near else None
    if look.near:
        surroundings = surround(model, look, around, scene_ground(model, decision))
        model, bodies = surroundings.model, [*bodies, *surroundings.bodies]
    glasses = _glasses(look.glass)
    panes, interiors = _panes(panels, look, glass, inside)
    if look.spandrel_every:
        interiors, rooms = painted(panes, interiors, _spandrels(model.site, look.spandrel_every), np.array(PAINT))
        panes = replace(panes, rooms=rooms)
    return Scene(
        name=model.site.name,
        seed=seed,
        site=model,
        bodies=tuple(body for body in bodies if len(body.mesh.triangles)),
        panes=panes,
        glasses=glasses,
        sky=_sky(look, sky),
        interiors=interiors,
        terrain=decision,
    )


def _frames(panels: PanelFrames, look: Look) -> Body:
    mesh = profile_rings(panels, look.frame_width_m, look.frame_depth_m)
    return Body("profiles", Layer.BUILDING, mesh, look.frame_albedo)


def _with_area(mesh: TriangleMesh) -> TriangleMesh:
    """Without triangles that have no normal: imported meshes have some, and so have rings around three-sided panes."""
    corners = mesh.corners_enu_m
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return TriangleMesh(mesh.vertices_enu_m, mesh.triangles[np.linalg.norm(crossed, axis=1) > 2.0 * LEAST_AREA_M2])


def _lower_left_first(panels: PanelFrames) -> PanelFrames:
    """The same panels, their corners counted from the lower left one, seen from outside."""
    relative = panels.corners - panels.centroids[:, None]
    right = np.einsum("mkx,mx->mk", relative, panels.tangents)
    up = np.einsum("mkx,mx->mk", relative, panels.bitangents)
    # Shares of the extents, so that of a wide and low panel the lower left corner is found, too.
    first = (right / np.ptp(right, axis=1)[:, None] + up / np.ptp(up, axis=1)[:, None]).argmin(axis=1)
    order = (first[:, None] + np.arange(4)) % 4
    return replace(panels, corners=np.take_along_axis(panels.corners, order[..., None], axis=1))


def _glasses(glass: Glass) -> tuple[Glass, ...]:
    """As it was ordered; hard to clean; replaced by another batch."""
    other = glass.coating - OTHER_COATING if glass.coating >= OTHER_COATING else glass.coating + OTHER_COATING
    red, green, blue = glass.tint
    return (
        glass,
        replace(glass, dirt=min(glass.dirt + DUSTY, 0.99)),
        replace(glass, coating=min(other, 0.99), tint=(0.94 * red, 0.97 * green, min(1.02 * blue, 1.0))),
    )


def _panes(
    panels: PanelFrames, look: Look, rng: np.random.Generator, inside: np.random.Generator
) -> tuple[Panes, Interiors]:
    n = len(panels)
    relative = panels.corners - panels.centroids[:, None]
    halves = np.stack(
        [np.abs(np.einsum("mkx,mx->mk", relative, axis)).max(axis=1) for axis in (panels.tangents, panels.bitangents)],
        axis=1,
    )
    tilts = np.radians(look.tilt_deg) * rng.normal(size=(n, 2))
    bows = np.radians(look.bow_deg) * (1.0 + 0.3 * rng.normal(size=(n, 1))) / halves
    if look.curved_glass:
        bows = bows + facade_bows_per_m(panels)
    draws = rng.random(n)
    kinds = np.where(draws < look.replaced, 2, np.where(rng.random(n) < DUSTY_PANES, 1, 0))
    is_lit = rng.random((n, 1)) < LIT_ROOMS
    lights = np.where(is_lit, LAMP, ROOM) * rng.uniform(0.5, 1.5, (n, 1))
    drawn = np.where(rng.random((n, 1)) < look.blinds, rng.uniform(0.15, 1.0, (n, 1)), 0.0)
    blind_lights = np.array(BLIND) * rng.uniform(0.8, 1.1, (n, 1))
    panes = Panes(panels.corners, tilts, bows, kinds.astype(np.int64), np.zeros((n, 3)))
    first = shared_rooms(panes, inside)
    interiors, rooms = furnished(panes, first, is_lit[:, 0], lights, drawn[:, 0], blind_lights, inside)
    return replace(panes, rooms=rooms), interiors


def _spandrels(site: Site, every: int) -> NDArray[np.bool_]:
    """Panels in every so-manyth row of their facades, counted from the foot, shape (m,)."""
    found = []
    for facade in site.facades:
        heights = np.array([np.mean(panel.corners_enu_m, axis=0)[2] for panel in facade.panels])
        order = np.argsort(heights, kind="stable")
        rows = np.zeros(len(heights), np.int64)
        rows[order] = np.cumsum(np.diff(heights[order], prepend=heights[order[0]]) > SAME_ROW_M)
        found.append(rows % every == every - 1)
    return np.concatenate(found)


def facade_bows_per_m(panels: PanelFrames) -> NDArray[np.float64]:
    """Curvature of the facade at each panel, to the right and upwards, shape (m, 2): how neighbours turn.

    Of panels whose corners lie on a cylinder it is 1 / radius. Edges without a neighbour, or with one around a corner
    (`profiles.LEAST_COSINE`), count for nothing.
    """
    neighbours = edge_neighbours(panels)[1]
    away = panels.centroids[neighbours] - panels.centroids[:, None]
    turned = panels.normals[neighbours]
    bows = np.zeros((len(panels), 2))
    for k, axis in enumerate((panels.tangents, panels.bitangents)):
        along = np.einsum("mkx,mx->mk", away, axis)
        # Beside the panel in this direction, and not above or below it.
        lengths = np.linalg.norm(away, axis=2)
        counts = (neighbours >= 0) & (np.abs(along) > math.sqrt(0.5) * lengths)
        turns = np.einsum("mkx,mx->mk", turned, axis) * np.sign(along)
        curvatures = np.divide(turns, lengths, out=np.zeros_like(turns), where=counts)
        bows[:, k] = curvatures.sum(axis=1) / np.maximum(counts.sum(axis=1), 1)
    return bows


def _sky(look: Look, rng: np.random.Generator) -> Sky:
    clear = Sky(look.sun_heading_deg, look.sun_elevation_deg)
    return replace(clear, panorama=panorama(rng, clear, look.clouds, look.skyline_deg))
