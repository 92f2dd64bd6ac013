"""Bodies that panes mirror and the site lacks: a neighbour that was never entered, a tree that has grown.

A model of what panes mirror tells by parallax how far away that is. Where two models, each of one half of the photos,
agree that there is something and the site has nothing, the site is wrong. Places that as many rays go through as end
there are empty (space carving, K. Kutulakos and S. Seitz, 2000).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.spatial import cKDTree

from planning.coverage.image_error import FAR_M
from planning.geo.mesh import TriangleMesh, box_mesh, join
from planning.site.free_space import unchecked_space
from planning.site.records import Obstacle, SiteModel

Array = NDArray[np.float64]

CELL_M, GAP_M = 2.0, 3.0
"""Side of the cells that bodies are made of, and how far they have to be from all that the site has: the median error
of distances was 2 to 3 % at 30 m (docs/concepts/worth.md)."""

LEAST_RAYS, LEAST_PHOTOS, LEAST_CELLS = 4, 2, 20
"""Of each half that end in a cell, of how many of its photos; and cells of a body: false ones had up to 16, fronts of
houses 170 and more, and single trees are lost."""

BEHIND = 0.1
"""Part of its length that a ray has to go on behind a cell to have gone through it."""


@dataclass(frozen=True, slots=True, eq=False)
class MirroredPlaces:
    """Where mirrored rays of photos end, by the model of the other half of them.

    Parameters
    ----------
    panes_enu_m, places_enu_m
        Where rays are mirrored, and where they end, shape (n, 3); far away where they do not.
    distances_m
        From the pane, shape (n,).
    photos, halves
        Number of each ray's photo, and 0 or 1 for the half that it is of, shape (n,).
    """

    panes_enu_m: Array
    places_enu_m: Array
    distances_m: Array
    photos: NDArray[np.int64]
    halves: NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class SeenBody:
    """A body that the site lacks, as far as panes mirror it: most often its front.

    Parameters
    ----------
    cells_m
        Lower corners of the cells that it is made of, each `CELL_M` wide, ENU, shape (k, 3).
    """

    cells_m: Array

    @property
    def low_enu_m(self) -> Array:
        """Lower corner of the box around it."""
        return np.asarray(self.cells_m.min(axis=0))

    @property
    def size_m(self) -> Array:
        """Of that box, east, north and up."""
        return np.asarray(np.ptp(self.cells_m, axis=0) + CELL_M)

    def mesh(self) -> TriangleMesh:
        """A closed box for each column of cells, from its lowest to its highest."""
        columns, number = np.unique(self.cells_m[:, :2], axis=0, return_inverse=True)
        boxes = []
        for k, (x, y) in enumerate(columns):
            heights = self.cells_m[number.ravel() == k, 2]
            boxes.append(box_mesh(np.array([x, y, heights.min()]), np.array([x, y, heights.max()]) + CELL_M))
        return join(boxes)


def bodies_not_in(site_model: SiteModel, seen: MirroredPlaces, flown_enu_m: Array, clear_m: float) -> list[SeenBody]:
    """Bodies that the site lacks, the largest first.

    Parameters
    ----------
    flown_enu_m
        Where the aircraft was, shape (p, 3): within `clear_m` of these places, and of home, is nothing.
    """
    kept = seen.distances_m < FAR_M
    cells = np.floor(seen.places_enu_m[kept] / CELL_M).astype(np.int64)
    agreed = [_with_enough_rays(cells, seen.photos[kept], seen.halves[kept] == half) for half in (0, 1)]
    both = np.array(sorted(agreed[0] & agreed[1]), np.int64).reshape(-1, 3)
    middles = np.asarray((both + 0.5) * CELL_M, np.float64)
    is_new = middles[:, 2] > site_model.site.airspace.ground_z_m + CELL_M
    is_new &= unchecked_space(site_model, 0.0).solids.clearance_m(middles, 2.0 * GAP_M) > GAP_M
    present = np.concatenate([np.reshape(flown_enu_m, (-1, 3)), [site_model.site.home_enu_m]])
    is_new &= cKDTree(present).query(middles)[0] > clear_m + CELL_M
    both = both[is_new]
    both = both[_n_among(both, cells) > _n_passing(both, seen)]
    if len(both) == 0:
        return []
    first = both.min(axis=0)
    grid = np.zeros(both.max(axis=0) - first + 1, np.bool_)
    grid[tuple((both - first).T)] = True
    numbers = label(grid, np.ones((3, 3, 3)))[0][tuple((both - first).T)]
    counts = np.bincount(numbers)
    largest = np.argsort(-counts, kind="stable")
    return [SeenBody(both[numbers == k] * CELL_M) for k in largest if counts[k] >= LEAST_CELLS]


def with_bodies(site_model: SiteModel, bodies: list[SeenBody]) -> SiteModel:
    """The site with bodies among its obstacles; it keeps the checksum of its file."""
    added = tuple(Obstacle(f"seen-{number:02d}", mesh=f"seen-{number:02d}") for number in range(1, len(bodies) + 1))
    site = replace(site_model.site, obstacles=(*site_model.site.obstacles, *added))
    return replace(site_model, site=site, obstacles=(*site_model.obstacles, *(body.mesh() for body in bodies)))


def _codes(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """One number for each cell, shape (n,)."""
    shifted = cells + (1 << 19)
    return np.asarray((shifted[:, 0] << 40) + (shifted[:, 1] << 20) + shifted[:, 2])


def _n_among(cells: NDArray[np.int64], visited: NDArray[np.int64]) -> NDArray[np.int64]:
    """How often each of some cells, sorted, is among those visited."""
    codes, found = _codes(cells), _codes(visited)
    place = np.minimum(np.searchsorted(codes, found), max(0, len(codes) - 1))
    return np.bincount(place[codes[place] == found], minlength=len(codes)) if len(codes) else np.zeros(0, np.int64)


def _n_passing(cells: NDArray[np.int64], seen: MirroredPlaces) -> NDArray[np.int64]:
    """How many rays go through each cell, and end well behind it."""
    lengths = np.minimum(seen.distances_m, FAR_M)
    counts = np.zeros(len(cells), np.int64)
    ways = seen.places_enu_m - seen.panes_enu_m
    directions = ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9)
    for along in np.arange(CELL_M, FAR_M, CELL_M):
        passes = along < (1.0 - BEHIND) * lengths - CELL_M
        places = seen.panes_enu_m[passes] + along * directions[passes]
        counts += _n_among(cells, np.floor(places / CELL_M).astype(np.int64))
    return counts


def _with_enough_rays(
    cells: NDArray[np.int64], photos: NDArray[np.int64], is_kept: NDArray[np.bool_]
) -> set[tuple[int, ...]]:
    """Cells in which enough rays of enough photos end."""
    found, number, counts = np.unique(cells[is_kept], axis=0, return_inverse=True, return_counts=True)
    pairs = np.unique(np.stack([number.ravel(), photos[is_kept]]), axis=1)
    n_photos = np.bincount(pairs[0], minlength=len(found))
    return {tuple(cell) for cell in found[(counts >= LEAST_RAYS) & (n_photos >= LEAST_PHOTOS)].tolist()}
