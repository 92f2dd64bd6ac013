"""Rooms for the panes of a scene, drawn at random: offices over one or several panes, with furniture and blinds.

Their lights are such that a room, seen through all its panes from all sides, has the mean light asked for.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reconstruction.scenes.light.geometry import PaneFrames
from reconstruction.scenes.light.interiors import SLAT_SHADE, room_shares
from reconstruction.scenes.light.pane_surfaces import half_sides_m
from reconstruction.scenes.record import Interiors, Panes

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
