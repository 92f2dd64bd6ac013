"""Terrain of a site from files of heights: the ground on a grid of the local frame, and what stands on it as obstacles.

The grid's nodes take the height that the source has between its four posts there, found through the geocentric frame:
no flat earth, no flat projection. Then every post of the source below the grid is held against the surface between the
nodes, and bounds are widened until they enclose it. So a coarse grid is quick and still safe: what it costs is height.

Tiles are sampled each in its own pixels, with one row or column of posts of their neighbours around them: between two
tiles there is no gap, at the 180th meridian neither, nor where tiles of other widths of pixels meet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import ANY_FILE, sha256_of_file
from planning.base.jit import chunks
from planning.base.messages import glue, say
from planning.base.progress import QUIET, Monitor
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.height_field import HeightField
from planning.site.importing.elevation import (
    NEXT_TO,
    HeightOptions,
    Raster,
    height_files,
    open_heights,
    same_grid,
    tile_names,
    unique_notes,
    with_zeros_judged,
)
from planning.site.importing.geoid_file import found_geoid, geoid_text, open_geoid
from planning.site.terrain import MAX_NODES, TerrainSource

Array = NDArray[np.float64]

USUAL_NODES = 250_000
"""Of a grid where nobody asks for a step: 500 x 500, sampled in seconds."""

NODES_PER_POST = 2
"""Steps of a grid between two posts of its source, where that is not too many nodes (docs: benchmark of terrain)."""

MAX_POSTS = 200_000_000
"""Below one grid: a square kilometre in pixels of 7 cm."""

POSTS_PER_BLOCK = 2_000_000
"""Looked at at once: some 200 MB of memory."""

OVERLAP_M = 1.0
"""Files that differ by no more where they overlap show the same ground: whole metres, or two surveys of it."""

LATTICE_M, PLACED_M = 20.0, 1e-4
"""Posts and nodes between some that lie so far apart are placed by linear interpolation, in a twentieth of the time.
The earth's curve between them is 0.01 mm; the bounds concede more."""


class Area(NamedTuple):
    """A rectangle of the local frame, ENU metres, and the level of its ground as far as it is known."""

    low_xy_m: Array
    high_xy_m: Array
    level_z_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """Heights of an area.

    Parameters
    ----------
    field
        At the nodes.
    upper_m, lower_m
        Bounds that enclose all posts, shape as `field.z_m`.
    tops_m
        Highest of the nodes of each cell and the posts in it, shape (rows - 1, columns - 1); NaN where not known.
    post_spacing_m
        Between the posts of the finest source.
    n_posts
        That were looked at.
    overlap_m
        How far files differ at most where several know the height.
    """

    field: HeightField
    upper_m: Array
    lower_m: Array
    tops_m: Array
    rasters: tuple[Raster, ...]
    post_spacing_m: float
    n_posts: int
    overlap_m: float = 0.0

    @property
    def error_m(self) -> float:
        """Greatest distance of a bound from the surface: what the step of the grid costs."""
        off = np.fmax(self.upper_m - self.field.z_m, self.field.z_m - self.lower_m)
        return float(np.nanmax(off, initial=0.0))

    @property
    def unknown_share(self) -> float:
        """Part of the nodes of which nothing is known."""
        return float(np.isnan(self.field.z_m).mean())

    def sources(self) -> tuple[TerrainSource, ...]:
        """The files, with their checksums."""
        return tuple(
            TerrainSource(
                raster.path.name, sha256_of_file(raster.path, ANY_FILE), raster.conversion.name, raster.vertical
            )
            for raster in self.rasters
        )

    def notes(self) -> tuple[str, ...]:
        """What is worth knowing about the files."""
        notes: tuple[str, ...] = unique_notes(self.rasters)
        if self.overlap_m > OVERLAP_M:
            text = say(
                "files overlap, and their heights differ by up to {:.1f} m: the higher counts below flights, the first "
                "for home",
                self.overlap_m,
            )
            notes = (*notes, text)
        return notes


def sample_heights(
    origin: Origin,
    area: Area,
    places: Sequence[Path],
    options: HeightOptions,
    step_m: float | None = None,
    monitor: Monitor = QUIET,
) -> Sampled:
    """Heights of an area from files, or from folders of them.

    Parameters
    ----------
    step_m
        Of the grid; None: half the distance of the posts, or more where that would be over `USUAL_NODES`.

    Raises
    ------
    InputError
        A file is damaged or says too little, or none covers any of the area.
    """
    monitor.report(say("looking for heights"), 0, 1)
    rasters = [_judged(each, origin, area) for each in _rasters(origin, area, places, options)]
    rasters = _with_geoid(rasters, origin, options.geoid)
    spacing_m = min(_spacing_m(raster, origin, area) for raster in rasters)
    width_m, depth_m = (float(value) for value in area.high_xy_m - area.low_xy_m)
    if step_m is None:
        step_m = max(spacing_m / NODES_PER_POST, math.sqrt(width_m * depth_m / USUAL_NODES))
    if (width_m / step_m + 2.0) * (depth_m / step_m + 2.0) > MAX_NODES:
        raise InputError.say(
            "a grid in steps of {:g} m has more than {} nodes below this airspace; allow a longer step",
            step_m,
            MAX_NODES,
        )
    columns, rows = (max(2, math.ceil(extent / step_m) + 1) for extent in (width_m, depth_m))
    west, south = (float(value) for value in area.low_xy_m)
    n_posts = (columns * step_m / spacing_m) * (rows * step_m / spacing_m)
    if n_posts > MAX_POSTS:
        raise InputError.say(
            "about {:.0f} million heights lie below the airspace, expected at most {:.0f} million; give a coarser file",
            n_posts / 1e6,
            MAX_POSTS / 1e6,
        )
    z = np.full((rows, columns), np.nan)
    field = HeightField(west, south, step_m, z)
    blocks = chunks(rows, max(2, int(rows * POSTS_PER_BLOCK / max(n_posts, 1.0))))
    tiles = [_Tile(raster, rasters) for raster in rasters]
    overlap_m = 0.0
    for number, (first, last) in enumerate(blocks):
        monitor.report(say("reading heights"), number, 2 * len(blocks))
        nodes = field.nodes_xy_m()[first:last]
        z[first:last], differ_m = _node_heights(origin, nodes, area.level_z_m, tiles)
        overlap_m = max(overlap_m, differ_m)
    if np.isnan(z).all():
        raise _nothing_there(origin, area, places)
    above, below, n_read = np.zeros_like(z), np.zeros_like(z), 0
    tops = field.cells_m(np.maximum)
    for number, (first, last) in enumerate(blocks):
        monitor.report(say("reading heights"), len(blocks) + number, 2 * len(blocks))
        # The cells between this block and the next belong to both.
        nodes = field.nodes_xy_m()[first : last + 1]
        for tile in tiles:
            for posts in tile.posts_enu_m(origin, nodes, area.level_z_m):
                n_read += len(posts)
                field.spread_departures(posts, above, below, tops)
    unknown = np.isnan(z)
    upper, lower = (np.where(unknown, np.nan, z + off) for off in (above + PLACED_M, below - PLACED_M))
    return Sampled(field, upper, lower, tops, tuple(rasters), spacing_m, n_read, overlap_m)


def _rasters(origin: Origin, area: Area, places: Sequence[Path], options: HeightOptions) -> list[Raster]:
    """Files that reach into an area."""
    corners, south_west, north_east = _corners(origin, area)
    found = []
    for place in places:
        for path in height_files(place, south_west, north_east):
            raster = open_heights(path, options)
            columns, rows = raster.pixels_at(*corners)
            if not (np.isfinite(columns).all() and np.isfinite(rows).all()):
                continue
            reaches = columns.max() > -1.0 and columns.min() < raster.width and rows.max() > -1.0
            if reaches and rows.min() < raster.height:
                found.append(raster)
    if not found:
        raise _nothing_there(origin, area, places)
    return found


def _judged(raster: Raster, origin: Origin, area: Area) -> Raster:
    columns, rows = raster.pixels_at(*_corners(origin, area)[0])
    window = (
        max(math.floor(rows.min()) - 1, 0),
        min(math.ceil(rows.max()) + 2, raster.height),
        max(math.floor(columns.min()) - 1, 0),
        min(math.ceil(columns.max()) + 2, raster.width),
    )
    return with_zeros_judged(raster, window, _spacing_m(raster, origin, area))


def _corners(origin: Origin, area: Area) -> tuple[tuple[Array, Array], tuple[float, float], tuple[float, float]]:
    """Border of an area on WGS 84, and the latitudes and longitudes that enclose it."""
    part = np.linspace(0.0, 1.0, 9)
    u = np.concatenate([part, part, np.zeros(9), np.ones(9)])
    v = np.concatenate([np.zeros(9), np.ones(9), part, part])
    xy = area.low_xy_m + np.stack([u, v], axis=1) * (area.high_xy_m - area.low_xy_m)
    lat, lon, _ = geodetic_from_enu(origin, np.c_[xy, np.full(len(xy), area.level_z_m)])
    from_origin = np.remainder(lon - origin.lon_deg + 180.0, 360.0) - 180.0
    east, west = origin.lon_deg + from_origin.max(), origin.lon_deg + from_origin.min()
    wrapped = [float(np.remainder(value + 180.0, 360.0) - 180.0) for value in (west, east)]
    return (lat, lon), (float(lat.min()), wrapped[0]), (float(lat.max()), wrapped[1])


def _nothing_there(origin: Origin, area: Area, places: Sequence[Path]) -> InputError:
    _, south_west, north_east = _corners(origin, area)
    return InputError.say(
        "has no heights below the airspace of the site, which lies at {:.5f}, {:.5f} (tile {}); give files that cover "
        "it",
        origin.lat_deg,
        origin.lon_deg,
        tile_names(south_west, north_east),
        place=", ".join(str(place) for place in places),
    )


def _with_geoid(rasters: list[Raster], origin: Origin, path: Path | None) -> list[Raster]:
    """Rasters with the grid of the geoid that their heights are above, where the user or the machine has it."""
    is_stated = path is not None
    if path is None and any(raster.vertical == "EGM2008" for raster in rasters):
        path = found_geoid()
    if path is None:
        return rasters
    window = open_geoid(path, origin.lat_deg, origin.lon_deg)
    found = []
    for raster in rasters:
        is_meant = raster.conversion.is_orthometric and (is_stated or raster.vertical == window.model)
        if is_meant and window.model and raster.vertical in ("EGM96", "EGM2008") and raster.vertical != window.model:
            raise InputError.say(
                "this grid is of {}, and heights of '{}' are above {}; take the grid of that",
                window.model,
                raster.path.name,
                raster.vertical,
                place=path,
            )
        if is_meant:
            text = glue(raster.vertical, " ", geoid_text(window, origin.lat_deg, origin.lon_deg))
            raster = replace(
                raster,
                conversion=replace(raster.conversion, geoid=window),
                vertical=f"{raster.vertical} ({window.file})",
                geoid_note=text,
            )
        found.append(raster)
    return found


def _spacing_m(raster: Raster, origin: Origin, area: Area) -> float:
    """Smallest distance of neighbouring posts at the middle of an area."""
    middle = 0.5 * (area.low_xy_m + area.high_xy_m)
    place = np.array([[*middle, area.level_z_m]])
    column, row = (float(value[0]) for value in raster.pixels_at(*geodetic_from_enu(origin, place)[:2]))
    columns, rows = np.array([column, column + 1.0, column]), np.array([row, row, row + 1.0])
    x, y = raster.coordinates(columns, rows)
    lat, lon, height = raster.conversion.geodetic(np.c_[x, y, np.zeros(3)])
    points = enu_from_geodetic(origin, lat, lon, height)
    return float(min(np.linalg.norm(points[1] - points[0]), np.linalg.norm(points[2] - points[0])))


def _node_heights(origin: Origin, nodes_xy_m: Array, level_z_m: float, tiles: Sequence[_Tile]) -> tuple[Array, float]:
    """ENU heights at nodes, shape (rows, columns, 2), from the first of some tiles that knows one; NaN from none.

    And how far others that know one differ from it at most.
    """
    heights, differ_m = np.full(nodes_xy_m.shape[:2], np.nan), 0.0
    for tile in tiles:
        found = tile.heights_m(origin, nodes_xy_m, level_z_m)
        differ_m = max(differ_m, float(np.nanmax(np.abs(found - heights), initial=0.0)))
        heights = np.where(np.isnan(heights), found, heights)
    return heights, differ_m


class _Tile:
    """A raster among others: heights between its posts, and between them and those of its neighbours."""

    def __init__(self, raster: Raster, all_rasters: Sequence[Raster]) -> None:
        self.raster = raster
        self._neighbours = [other for other in all_rasters if other is not raster and same_grid(other, raster)]
        self._read: tuple[tuple[int, int, int, int], Array] | None = None

    def heights_m(self, origin: Origin, nodes_xy_m: Array, level_z_m: float) -> Array:
        """ENU z of the ground at nodes, shape (rows, columns, 2), where it is about level; NaN where not known."""
        raster, unknown = self.raster, np.full(nodes_xy_m.shape[:2], np.nan)
        lattice, at = _lattice_of(nodes_xy_m)
        pixels = self._pixels(origin, lattice, level_z_m)
        window = self._window(pixels)
        if window is None:
            return unknown
        # How pixels move with a node's height, and which height a pixel's foot has below it.
        moved = (self._pixels(origin, lattice, level_z_m + 1000.0) - pixels) / 1000.0
        feet, normals = _feet(origin, raster, pixels[..., 0].ravel(), pixels[..., 1].ravel())
        upwards = np.stack([feet[:, 2], normals[:, 2]], axis=1).reshape(*pixels.shape[:2], 2)
        values = _on_grid(np.concatenate([pixels, moved, upwards], axis=2), at, nodes_xy_m.shape)
        z, heights = np.full(nodes_xy_m.shape[:2], level_z_m), self._padded(window)
        # The vertical through a node is not the normal of the ellipsoid there: twice is enough 20 km away.
        for _ in range(2):
            columns, rows = (values[..., k] + values[..., 2 + k] * (z - level_z_m) for k in (0, 1))
            raw = _between(heights, (columns - window[2]).ravel(), (rows - window[0]).ravel()).reshape(z.shape)
            found = values[..., 4] + raw * raster.conversion.height_unit_m * values[..., 5]
            z = np.where(np.isnan(found), level_z_m, found)
        return np.asarray(found)

    def posts_enu_m(self, origin: Origin, nodes_xy_m: Array, level_z_m: float) -> Iterator[Array]:
        """The raster's own posts below nodes, shape (rows, columns, 2), as ENU points of shape (n, 3), in parts."""
        window = self._window(self._pixels(origin, _lattice_of(nodes_xy_m)[0], level_z_m))
        if window is None:
            return
        first_row, last_row = max(window[0], 0), min(window[1], self.raster.height)
        first_column, last_column = max(window[2], 0), min(window[3], self.raster.width)
        if first_row >= last_row or first_column >= last_column:
            return
        n_rows = max(1, POSTS_PER_BLOCK // (last_column - first_column))
        for start, stop in chunks(last_row - first_row, n_rows):
            part = first_row + start, first_row + stop, first_column, last_column
            yield _placed(origin, self.raster, part, self.raster.read(*part))

    def _pixels(self, origin: Origin, nodes_xy_m: Array, z_m: float) -> Array:
        """Columns and rows of places at one height, both shape (rows, columns, 2)."""
        points = np.c_[nodes_xy_m.reshape(-1, 2), np.full(nodes_xy_m.size // 2, z_m)]
        columns, rows = self.raster.pixels_at(*geodetic_from_enu(origin, points)[:2])
        return np.stack([columns, rows], axis=1).reshape(nodes_xy_m.shape)

    def _window(self, pixels: Array) -> tuple[int, int, int, int] | None:
        """First and last rows and columns (ends excluded) around places, as far as the posts and one around reach."""
        columns, rows = pixels[..., 0], pixels[..., 1]
        if not np.isfinite(pixels).all():
            return None
        first_row, last_row = (
            max(math.floor(rows.min()) - 1, -1),
            min(math.ceil(rows.max()) + 2, self.raster.height + 1),
        )
        first_column = max(math.floor(columns.min()) - 1, -1)
        last_column = min(math.ceil(columns.max()) + 2, self.raster.width + 1)
        if first_row >= last_row or first_column >= last_column:
            return None
        return first_row, last_row, first_column, last_column

    def _padded(self, window: tuple[int, int, int, int]) -> Array:
        """Heights of a window that may reach one post beyond the raster, where neighbours say them."""
        if self._read is not None and self._read[0] == window:
            return self._read[1]
        first_row, last_row, first_column, last_column = window
        heights = np.full((last_row - first_row, last_column - first_column), np.nan)
        inside = (
            max(first_row, 0),
            min(last_row, self.raster.height),
            max(first_column, 0),
            min(last_column, self.raster.width),
        )
        if inside[0] < inside[1] and inside[2] < inside[3]:
            own = self.raster.read(*inside)
            heights[
                inside[0] - first_row : inside[1] - first_row, inside[2] - first_column : inside[3] - first_column
            ] = own
        rows, columns = np.meshgrid(np.arange(first_row, last_row), np.arange(first_column, last_column), indexing="ij")
        outside = (rows < 0) | (rows >= self.raster.height) | (columns < 0) | (columns >= self.raster.width)
        if outside.any():
            x, y = self.raster.coordinates(columns[outside].astype(float), rows[outside].astype(float))
            heights[outside] = self._of_neighbours(x, y)
        self._read = window, heights
        return heights

    def _of_neighbours(self, x: Array, y: Array) -> Array:
        """Heights of neighbours at places given in coordinates; NaN where none has posts on all sides."""
        found = np.full(len(x), np.nan)
        for other in self._neighbours:
            columns, rows = other.pixels(x, y)
            high_column, high_row = other.width - 1.0, other.height - 1.0
            within = (columns >= -NEXT_TO) & (columns <= high_column + NEXT_TO) & np.isnan(found)
            within &= (rows >= -NEXT_TO) & (rows <= high_row + NEXT_TO)
            if not within.any():
                continue
            # A post on the border of a neighbour has no other on its far side, and needs none.
            u, v = np.clip(columns[within], 0.0, high_column), np.clip(rows[within], 0.0, high_row)
            u, v = (np.where(np.abs(value - np.round(value)) <= NEXT_TO, np.round(value), value) for value in (u, v))
            part = int(v.min()), math.ceil(v.max()) + 1, int(u.min()), math.ceil(u.max()) + 1
            found[within] = _between(other.read(*part), u - part[2], v - part[0])
        return found


def _between(heights: Array, columns: Array, rows: Array) -> Array:
    """Bilinear interpolation; NaN beyond the grid, and wherever a post that counts is not known."""
    n_rows, n_columns = heights.shape
    with np.errstate(invalid="ignore"):
        inside = (columns >= 0.0) & (columns <= n_columns - 1.0) & (rows >= 0.0) & (rows <= n_rows - 1.0)
    left = np.where(inside, columns, 0.0).astype(np.int64)
    top = np.where(inside, rows, 0.0).astype(np.int64)
    u, v = np.where(inside, columns, 0.0) - left, np.where(inside, rows, 0.0) - top
    result = np.zeros(len(columns))
    for dv, row_weight in ((0, 1.0 - v), (1, v)):
        for du, column_weight in ((0, 1.0 - u), (1, u)):
            weight = row_weight * column_weight
            post = heights[np.minimum(top + dv, n_rows - 1), np.minimum(left + du, n_columns - 1)]
            result += np.where(weight > 0.0, weight * post, 0.0)
    return np.where(inside, result, np.nan)


def _placed(origin: Origin, raster: Raster, window: tuple[int, int, int, int], raw: Array) -> Array:
    """Posts of a window whose heights are known as ENU points, shape (n, 3).

    A post moves along the ellipsoid's normal with its height; feet and normals are interpolated between a lattice.
    """
    first_row, last_row, first_column, last_column = window
    middle = 0.5 * (first_column + last_column), 0.5 * (first_row + last_row)
    columns, rows = np.array([middle[0], middle[0] + 1.0, middle[0]]), np.array([middle[1], middle[1], middle[1] + 1.0])
    feet, _ = _feet(origin, raster, columns, rows)
    spacing = float(max(np.linalg.norm(feet[1] - feet[0]), np.linalg.norm(feet[2] - feet[0])))
    every = max(1, int(LATTICE_M / max(spacing, 1e-9)))
    at = _lattice(first_row, last_row, every), _lattice(first_column, last_column, every)
    grid_columns, grid_rows = np.meshgrid(at[1], at[0])
    feet, normals = _feet(origin, raster, grid_columns.ravel(), grid_rows.ravel())
    lattice = np.concatenate([feet, normals], axis=1).reshape(*grid_rows.shape, 6)
    own = at[0] - first_row, at[1] - first_column
    values = _on_grid(lattice, own, (last_row - first_row, last_column - first_column)).reshape(-1, 6)
    heights = raw.ravel() * raster.conversion.height_unit_m
    known = np.isfinite(heights)
    return values[known, :3] + heights[known, None] * values[known, 3:]


def _feet(origin: Origin, raster: Raster, columns: Array, rows: Array) -> tuple[Array, Array]:
    """ENU points of posts at a height of zero, and what a metre upwards adds to them; both shape (n, 3)."""
    x, y = raster.coordinates(columns, rows)
    lat, lon, zero = raster.conversion.geodetic(np.c_[x, y, np.zeros(len(x))])
    feet = enu_from_geodetic(origin, lat, lon, zero)
    return feet, (enu_from_geodetic(origin, lat, lon, zero + 1000.0) - feet) / 1000.0


def _lattice_of(nodes_xy_m: Array) -> tuple[Array, tuple[Array, Array]]:
    """Some of the nodes of a grid, shape (rows, columns, 2), in the same form, and which rows and columns they are."""
    step_m = float(nodes_xy_m[0, 1, 0] - nodes_xy_m[0, 0, 0])
    every = max(1, int(LATTICE_M / step_m))
    at = _lattice(0, nodes_xy_m.shape[0], every), _lattice(0, nodes_xy_m.shape[1], every)
    columns, rows = np.meshgrid(at[1], at[0])
    return nodes_xy_m[0, 0] + step_m * np.stack([columns, rows], axis=-1), at


def _on_grid(values: Array, at: tuple[Array, Array], shape: tuple[int, ...]) -> Array:
    """Values of a lattice at rows and columns `at`, interpolated to all nodes of a grid."""
    in_rows = _along(values, at[0], np.arange(shape[0], dtype=np.float64))
    return _along(in_rows.swapaxes(0, 1), at[1], np.arange(shape[1], dtype=np.float64)).swapaxes(0, 1)


def _lattice(first: int, last: int, every: int) -> Array:
    inner = np.arange(first, last - 1, every, dtype=np.float64)
    return np.append(inner, float(max(last - 1, first + 1)))


def _along(values: Array, knots: Array, at: Array) -> Array:
    """Linear interpolation along the first axis."""
    left = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
    part = ((at - knots[left]) / (knots[left + 1] - knots[left]))[:, None, None]
    return np.asarray((1.0 - part) * values[left] + part * values[left + 1])
