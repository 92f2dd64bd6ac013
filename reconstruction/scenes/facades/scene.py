"""What is seen along a ray: a pane with what it mirrors, a profile, masonry, or what stands behind."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Array
from reconstruction.scenes.facades.cases import Grid
from reconstruction.scenes.facades.record import Array32, Case, Opposite, first_hits

# What stands behind and across the street of a synthetic facade, painted on a picture that hangs upright there.

HALF_WIDTH_M, BOTTOM_M, TOP_M = 90.0, -20.0, 70.0
"""Extent of a picture: to both sides of the wall's middle, and above its base. Beyond, its rim goes on."""

SCALE_PX_PER_M = 16.0
"""6 cm: the size of a pixel of the photo, as seen in the glass."""


@dataclass(frozen=True, slots=True, eq=False)
class Backdrop:
    """A painted upright picture, shape (height, width, 3), uint8, parallel to the wall."""

    picture: NDArray[np.uint8]

    def at(self, x_m: NDArray[np.float32], z_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """Colours, shape (n, 3), 0 to 255, at places in the wall frame, each shape (n,) with n below 32 767."""
        scale = np.float32(SCALE_PX_PER_M)
        u = (x_m + np.float32(HALF_WIDTH_M)) * scale - np.float32(0.5)
        v = (np.float32(TOP_M) - z_m) * scale - np.float32(0.5)
        found = cv2.remap(self.picture, u[None], v[None], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(found[0], np.float32)


def paint(rng: np.random.Generator, ground_m: float, is_empty: bool = False) -> Backdrop:
    """Sky with clouds above `ground_m`, and, unless it is to be empty, buildings with windows and trees before them."""
    picture = _sky_and_ground(rng, ground_m)
    if not is_empty:
        x = -HALF_WIDTH_M
        while x < HALF_WIDTH_M:
            width = rng.uniform(9.0, 24.0)
            _building(picture, rng, x, width, ground_m, rng.uniform(12.0, 52.0))
            x += width + rng.choice([0.0, 0.0, rng.uniform(1.0, 8.0)])
        _trees(picture, rng, ground_m)
    return Backdrop(picture)


def paint_grid(rng: np.random.Generator, ground_m: float, spacing_m: tuple[float, float]) -> Backdrop:
    """Across the street stands one long building whose bright bars, `spacing_m` apart, look like frames when mirrored.

    It begins in the middle of the wall with the same bars to both sides, so its mirror image is symmetric.
    """
    picture = _sky_and_ground(rng, ground_m)
    x0, x1 = _columns(-60.0, 60.0)
    y0, y1 = _rows(ground_m + 45.0, ground_m)
    picture[y0:y1, x0:x1] = (62, 58, 52)
    bar = 0.18
    for x in np.arange(0.0, 60.0, spacing_m[0]):
        for side in (-x, x):
            a, b = _columns(side - bar, side + bar)
            picture[y0:y1, a:b] = (225, 230, 232)
    for z in np.arange(ground_m, ground_m + 45.0, spacing_m[1]):
        a, b = _rows(z + bar, z - bar)
        picture[a:b, x0:x1] = (225, 230, 232)
    return Backdrop(picture)


def paint_roofs(rng: np.random.Generator, ground_m: float) -> Backdrop:
    """A row of tall gabled houses: long straight edges, inclined alike, between dark roofs and the sky."""
    picture = _sky_and_ground(rng, ground_m)
    pitch, x = rng.uniform(0.5, 1.2), -HALF_WIDTH_M
    while x < HALF_WIDTH_M:
        width, eaves = rng.uniform(14.0, 30.0), ground_m + rng.uniform(8.0, 25.0)
        a, b = _columns(x, x + width)
        _, low = _rows(eaves, ground_m)
        high, _ = _rows(eaves, ground_m)
        picture[high:low, a:b] = rng.uniform(110.0, 220.0)
        top, _ = _rows(eaves + 0.5 * pitch * width, ground_m)
        cv2.fillPoly(picture, [np.array([(a, high), (b, high), ((a + b) // 2, top)], np.int32)], (58, 60, 78))
        x += width
    return Backdrop(picture)


def backdrop_across(
    opposite: Opposite, rng: np.random.Generator, ground_m: float, spacing_m: tuple[float, float]
) -> Backdrop:
    """What is mirrored."""
    if opposite == "grid":
        return paint_grid(rng, ground_m, spacing_m)
    return paint_roofs(rng, ground_m) if opposite == "roofs" else paint(rng, ground_m)


def _columns(left_m: float, right_m: float) -> tuple[int, int]:
    a, b = (round((x + HALF_WIDTH_M) * SCALE_PX_PER_M) for x in (left_m, right_m))
    return max(a, 0), max(b, 0)


def _rows(top_m: float, bottom_m: float) -> tuple[int, int]:
    a, b = (round((TOP_M - z) * SCALE_PX_PER_M) for z in (top_m, bottom_m))
    return max(a, 0), max(b, 0)


def _sky_and_ground(rng: np.random.Generator, ground_m: float) -> NDArray[np.uint8]:
    height, width = round((TOP_M - BOTTOM_M) * SCALE_PX_PER_M), round(2 * HALF_WIDTH_M * SCALE_PX_PER_M)
    # Nothing in the sky is sharp, so an eighth of the size is enough to paint it.
    small = (width // 8, height // 8)
    rise = np.linspace(0.0, 1.0, small[1], dtype=np.float32)[:, None, None]
    zenith, horizon = np.array([215, 160, 105], np.float32), np.array([240, 228, 214], np.float32)
    clouds = cv2.resize(rng.random((9, 18), np.float32), small, interpolation=cv2.INTER_CUBIC)[..., None]
    clouds = np.clip(3.0 * clouds - 1.6, 0.0, 1.0)
    sky = zenith + rise * (horizon - zenith)
    sky = np.asarray(sky + clouds * (250.0 - sky), np.float32).astype(np.uint8)
    picture = np.asarray(cv2.resize(sky, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)
    first, _ = _rows(ground_m, BOTTOM_M)
    picture[first:] = (98, 102, 104)
    return picture


def _building(
    picture: NDArray[np.uint8], rng: np.random.Generator, x_m: float, width_m: float, ground_m: float, height_m: float
) -> None:
    x0, x1 = _columns(x_m, x_m + width_m)
    y0, y1 = _rows(ground_m + height_m, ground_m)
    wall = rng.uniform(60.0, 235.0) * np.array([0.92, 0.97, 1.0]) * rng.uniform(0.9, 1.0, 3)
    picture[y0:y1, x0:x1] = wall.astype(np.uint8)
    bay, storey = rng.uniform(1.6, 4.0), rng.uniform(2.8, 3.8)
    opening = rng.uniform(0.45, 0.85, 2)
    dark = wall.mean() > 110.0
    for z in np.arange(ground_m + 0.8, ground_m + height_m - storey, storey):
        for x in np.arange(x_m + 0.5, x_m + width_m - bay, bay):
            a, b = _columns(x, x + opening[0] * bay)
            c, d = _rows(z + opening[1] * storey, z)
            grey = rng.uniform(25.0, 70.0) if dark else rng.uniform(150.0, 255.0)
            picture[c:d, a:b] = (grey, grey, 0.92 * grey)


def _trees(picture: NDArray[np.uint8], rng: np.random.Generator, ground_m: float) -> None:
    for _ in range(14):
        x, radius = rng.uniform(-HALF_WIDTH_M, HALF_WIDTH_M), rng.uniform(1.5, 3.5)
        middle = ground_m + 3.0 + radius
        green = np.array([48.0, 95.0, 62.0]) * rng.uniform(0.6, 1.2)
        for _ in range(60):
            dx, dz = rng.normal(0.0, 0.45 * radius, 2)
            u, v = (x + dx + HALF_WIDTH_M) * SCALE_PX_PER_M, (TOP_M - middle - dz) * SCALE_PX_PER_M
            size = rng.uniform(0.12, 0.35) * radius * SCALE_PX_PER_M
            colour = tuple(float(value) for value in green * rng.uniform(0.7, 1.3))
            cv2.circle(picture, (round(u), round(v)), max(1, round(size)), colour, -1)


BEHIND, GLASS, FRAME, FRAME_SIDE, MASONRY, INFILL = range(6)
FACADE_KINDS = (GLASS, FRAME, FRAME_SIDE)

BLIND_KEY, PANEL_KEY = 8, 16
"""A key is the kind, plus this in a blind, plus this times the panel's number."""

BASE_ABOVE_GROUND_M = 4.0
BORDER_M = 0.7
"""Masonry to both sides of the facade and above it."""

BEHIND_M = 12.0
"""Distance of the pictures behind the facade."""

MASONRY_BGR, INFILL_BGR = (138.0, 150.0, 160.0), (112.0, 116.0, 118.0)
SIDE_SHADE = 0.55
"""Of a profile's side against its front."""

SPOT_DEG, HALO_DEG, HALO = 1.0, 7.0, 0.45
"""Radii of the sun's mirror image and of the halo around it, and the halo's strength."""

FLATTEST = -0.02
"""Mirrored rays flatter than this against the wall are taken for this flat."""


@dataclass(frozen=True, slots=True, eq=False)
class Panes:
    """What differs from pane to pane; all of shape (n_rows, n_columns, n_parts)."""

    tilt_s_rad: Array32
    tilt_h_rad: Array32
    brightness: Array32
    blind_share: Array32


Directions = tuple[Array32, Array32, Array32]
"""Of rays, wall frame, any length."""

Cells = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
"""Row, column, and part of the cell, of each sample."""


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Rays and where they fall on the wall; see `first_hits`."""

    dx: Array32
    dy: Array32
    dz: Array32
    t: Array32
    s: Array32
    h: Array32


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A case ready to be looked at. `rays` turns (x_px, y_px, 1) into directions in the wall frame."""

    case: Case
    grid: Grid
    panes: Panes
    behind: Backdrop
    across: Backdrop
    rays: Array
    origin: Array
    sun: Array

    def look(self, x_px: Array32, y_px: Array32) -> tuple[Array32, NDArray[np.int32]]:
        """Colours, shape (n, 3), and keys, shape (n,): equal for places between which nothing has an edge."""
        m = self.rays.astype(np.float32)
        dx, dy, dz = (m[i, 0] * x_px + m[i, 1] * y_px + m[i, 2] for i in range(3))
        directions = (dx, dy, dz)
        t, s, h = first_hits(self.origin, dx, dy, dz, self.case.wall.curvature_per_m)
        kind, cell = self._kinds(directions, s, h)
        colours = np.empty((len(x_px), 3), np.float32)
        keys = kind.astype(np.int32)
        self._paint_solid(colours, kind, s, h)
        is_behind = kind == BEHIND
        if is_behind.any():
            x, z = self._on_plane(directions, is_behind, np.float32(BEHIND_M))
            colours[is_behind] = self.behind.at(x, z)
        is_glass = kind == GLASS
        if is_glass.any():
            picked = Sight(*(value[is_glass] for value in (dx, dy, dz, t, s, h)))
            row, column, part = (index[is_glass] for index in cell)
            colours[is_glass], in_blind = self._glass(picked, row, column, part)
            number = self.grid.panel_numbers[row, column, part]
            keys[is_glass] += PANEL_KEY * number + BLIND_KEY * in_blind
        return colours, keys

    def _kinds(self, directions: Directions, s: Array32, h: Array32) -> tuple[NDArray[np.int64], Cells]:
        """What is hit, and the part of a cell behind it."""
        grid = self.grid
        (row, column, part), is_open = self._cell(s, h)
        kind = np.where(grid.panel_numbers[row, column, part] > 0, GLASS, INFILL)
        kind[~is_open] = FRAME
        depth = self.case.layout.frame_depth_m
        if depth > 0.0:
            front_s, front_h = self._in_front(directions, s, h, np.float32(depth))
            (front_row, front_column, front_part), front_open = self._cell(front_s, front_h)
            over_mullion = (front_column != column) & (
                grid.half_mullions_m[row, np.maximum(front_column, column)] > 0.0
            )
            over_brace = (front_column == column) & (front_part != part)
            hides = (kind == FRAME) | over_mullion | (front_row != row) | over_brace
            kind[hides] = FRAME_SIDE
            kind[~front_open & self._in_outline(front_s, front_h, 0.0)] = FRAME
            is_outside = ~self._in_outline(s, h, 0.0) & ~self._in_outline(front_s, front_h, 0.0)
        else:
            is_outside = ~self._in_outline(s, h, 0.0)
        kind[is_outside] = MASONRY
        kind[is_outside & ~self._in_outline(s, h, BORDER_M)] = BEHIND
        kind[np.isnan(s)] = BEHIND
        return kind, (row, column, part)

    def _cell(self, s: Array32, h: Array32) -> tuple[Cells, NDArray[np.bool_]]:
        """The part of the nearest cell, and whether no profile stands there."""
        grid = self.grid
        n_rows, n_columns = grid.panel_numbers.shape[:2]
        column = np.clip(np.searchsorted(grid.columns_m, s, "right") - 1, 0, n_columns - 1)
        row = np.clip(np.searchsorted(grid.rows_m, h, "right") - 1, 0, n_rows - 1)
        half = grid.half_transom_m
        is_open = s > (grid.columns_m[column] + grid.half_mullions_m[row, column])
        is_open &= s < (grid.columns_m[column + 1] - grid.half_mullions_m[row, column + 1])
        is_open &= (h > grid.rows_m[row] + half) & (h < grid.rows_m[row + 1] - half)
        is_open &= (self._top(s) - h) > half * self._slant(column)
        part = np.zeros_like(row)
        for bit in range(grid.cell_braces.shape[2]):
            index = grid.cell_braces[row, column, bit]
            for number in np.unique(index[index >= 0]):
                here, brace = np.nonzero(index == number)[0], grid.braces[number]
                signed = brace.signed_m(s[here], h[here])
                part[here] |= (signed > 0.0).astype(np.int64) << bit
                is_open[here] &= np.abs(signed) > brace.half_m
        return (row, column, part), is_open

    def _top(self, s: Array32) -> Array32:
        return np.interp(s, self.grid.columns_m, self.grid.tops_m).astype(np.float32)

    def _slant(self, column: NDArray[np.int64]) -> Array:
        """Height of the upper profile above its thickness, for each sample's column."""
        slopes = np.diff(self.grid.tops_m) / np.diff(self.grid.columns_m)
        return np.asarray(np.hypot(1.0, slopes)[column])

    def _in_outline(self, s: Array32, h: Array32, border_m: float) -> NDArray[np.bool_]:
        """Whether places lie on the facade with its outer profiles, or in a border around it down to the ground."""
        grid, layout = self.grid, self.case.layout
        side = 0.5 * layout.mullion_width_m + border_m
        above = grid.half_transom_m + border_m
        below = BASE_ABOVE_GROUND_M if border_m else grid.half_transom_m
        inside = (s >= grid.columns_m[0] - side) & (s <= grid.columns_m[-1] + side)
        inside &= (h >= grid.rows_m[0] - below) & (h <= grid.rows_m[-1] + above)
        if layout.top != "straight":
            column = np.clip(np.searchsorted(grid.columns_m, s, "right") - 1, 0, len(grid.columns_m) - 2)
            inside &= h <= self._top(s) + above * self._slant(column)
        return np.asarray(inside)

    def _in_front(self, directions: Directions, s: Array32, h: Array32, depth_m: np.float32) -> tuple[Array32, Array32]:
        """Where the rays pass the profiles' fronts, along the wall."""
        dx, dy, dz = directions
        angle = np.float32(self.case.wall.curvature_per_m) * s
        along, into = dx * np.cos(angle) + dy * np.sin(angle), dy * np.cos(angle) - dx * np.sin(angle)
        into = np.maximum(into, np.float32(1e-3) * np.abs(along))
        front_s, front_h = s - depth_m * along / into, h - depth_m * dz / into
        return np.asarray(front_s, np.float32), np.asarray(front_h, np.float32)

    def _on_plane(self, directions: Directions, chosen: NDArray[np.bool_], y_m: np.float32) -> tuple[Array32, Array32]:
        dx, dy, dz = (value[chosen] for value in directions)
        ox, oy, oz = (np.float32(value) for value in self.origin)
        t = (y_m - oy) / np.maximum(dy, np.float32(-FLATTEST))
        return np.asarray(ox + t * dx, np.float32), np.asarray(oz + t * dz, np.float32)

    def _paint_solid(self, colours: Array32, kind: NDArray[np.int64], s: Array32, h: Array32) -> None:
        frame = np.array(self.case.frame_bgr, np.float32)
        palette = np.array([(0, 0, 0), (0, 0, 0), frame, SIDE_SHADE * frame, MASONRY_BGR, INFILL_BGR], np.float32)
        colours[:] = palette[kind] * self._light(s, h)[:, None]

    def _light(self, s: Array32, h: Array32) -> Array32:
        """1, or less in the shadow that falls over the lower left part of the wall."""
        shadow = np.float32(self.case.disturbances.shadow)
        if shadow == 0.0:
            return np.ones_like(s)
        height = np.float32(self.grid.rows_m[-1])
        return np.where(h < np.float32(0.55) * height - np.float32(0.7) * s, 1 - shadow, np.float32(1.0))

    def _glass(
        self, sight: Sight, row: NDArray[np.int64], column: NDArray[np.int64], part: NDArray[np.int64]
    ) -> tuple[Array32, NDArray[np.bool_]]:
        """Colours of panes and whether a blind is seen behind them."""
        grid, panes = self.grid, self.panes
        dx, dy, dz, s, h = sight.dx, sight.dy, sight.dz, sight.s, sight.h
        across = ((s - grid.columns_m[column]) / np.diff(grid.columns_m)[column]).astype(np.float32)
        up = ((h - grid.rows_m[row]) / np.diff(grid.rows_m)[row]).astype(np.float32)
        in_blind = 1 - up < panes.blind_share[row, column, part]
        brightness = panes.brightness[row, column, part]
        inside = np.array(self.case.glass_bgr, np.float32) * brightness[:, None]
        inside[in_blind] = np.array([190.0, 200.0, 205.0], np.float32) * brightness[in_blind, None]
        inside *= self._light(s, h)[:, None]
        disturbances = self.case.disturbances
        if disturbances.reflection == 0.0:
            return inside, in_blind
        pillow = np.float32(math.radians(2.0 * disturbances.pillow_deg))
        nx, ny, nz = self._normals(
            column,
            panes.tilt_s_rad[row, column, part] + pillow * (across - np.float32(0.5)),
            panes.tilt_h_rad[row, column, part] + pillow * (up - np.float32(0.5)),
        )
        along_normal = (dx * nx + dy * ny + dz * nz) / (nx * nx + ny * ny + nz * nz)
        rx, ry, rz = (d - 2 * along_normal * n for d, n in ((dx, nx), (dy, ny), (dz, nz)))
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        cosine = np.clip(-along_normal * np.sqrt(nx * nx + ny * ny + nz * nz) / length, 0, 1)
        share = np.float32(disturbances.reflection)
        share = share + (1 - share) * (1 - cosine) ** 5
        mirrored = self._mirrored(sight, rx, np.minimum(ry, np.float32(FLATTEST) * length), rz)
        colours = inside * (1 - share)[:, None] + mirrored * share[:, None]
        if disturbances.glare > 0.0:
            colours += self._glare((rx, ry, rz), length)[:, None]
        return colours, in_blind

    def _normals(self, column: NDArray[np.int64], tilt_s: Array32, tilt_h: Array32) -> tuple[Array32, ...]:
        middles = 0.5 * (self.grid.columns_m[:-1] + self.grid.columns_m[1:])
        angles = (self.case.wall.curvature_per_m * middles).astype(np.float32)
        sin, cos = np.sin(angles)[column], np.cos(angles)[column]
        return sin + tilt_s * cos, tilt_s * sin - cos, tilt_h

    def _mirrored(self, sight: Sight, rx: Array32, ry: Array32, rz: Array32) -> Array32:
        """Colours across the street where the mirrored rays arrive."""
        ox, oy, oz = (np.float32(value) for value in self.origin)
        reach = (-np.float32(self.case.disturbances.street_m) - (oy + sight.t * sight.dy)) / ry
        return self.across.at(ox + sight.t * sight.dx + reach * rx, oz + sight.t * sight.dz + reach * rz)

    def _glare(self, mirrored: tuple[Array32, ...], length: Array32) -> Array32:
        cosine = sum(r * np.float32(part) for r, part in zip(mirrored, self.sun, strict=True)) / length
        square = 2 * np.maximum(1 - cosine, 0)
        spot = np.exp(-square / np.float32(math.radians(SPOT_DEG) ** 2))
        halo = np.exp(-square / np.float32(math.radians(HALO_DEG) ** 2))
        strength = np.float32(255.0 * self.case.disturbances.glare)
        return np.asarray(strength * (3 * spot + np.float32(HALO) * halo), np.float32)


def kinds(keys: NDArray[np.int32]) -> NDArray[np.int32]:
    """What was seen, from keys of any shape."""
    return keys % BLIND_KEY


def panel_numbers(keys: NDArray[np.int32]) -> NDArray[np.int32]:
    """Number of the panel that was seen, 0 for none, from keys of any shape."""
    return keys // PANEL_KEY


def build_scene(case: Case, grid: Grid, rng: np.random.Generator) -> Scene:
    """Paint the surroundings and choose what differs from pane to pane.

    Raises
    ------
    ValueError
        The camera stands on or behind the wall, or its picture is not straight.
    """
    intrinsics, pose = case.truth.intrinsics, case.truth.pose
    origin = case.wall.to_wall(pose.position_enu_m)[0]
    if not intrinsics.is_straight:
        raise ValueError("expected a camera without distortion")
    if case.wall.curvature_per_m * (origin[0] ** 2 + origin[1] ** 2) <= 2.0 * origin[1]:
        raise ValueError("expected a camera outside the wall")
    rays = case.wall.wall_from_enu @ pose.cam_from_enu.T @ np.linalg.inv(intrinsics.matrix)
    disturbances = case.disturbances
    away_m = -origin[1]
    # Bars whose mirror image is about 0.73 panels apart on the wall: near the truth, and no multiple of it.
    spread = 0.73 * (away_m + disturbances.street_m) / away_m
    spacing = (spread * case.layout.panel_width_m, spread * case.layout.panel_height_m)
    ground_m = -BASE_ABOVE_GROUND_M
    return Scene(
        case=case,
        grid=grid,
        panes=_panes(case, grid, rng),
        behind=paint(rng, ground_m, is_empty=not disturbances.clutter),
        across=backdrop_across(disturbances.opposite, rng, ground_m, spacing),
        rays=rays,
        origin=origin,
        sun=_sun(origin, grid, rng),
    )


def _panes(case: Case, grid: Grid, rng: np.random.Generator) -> Panes:
    shape = grid.panel_numbers.shape
    tilt = math.radians(case.disturbances.tilt_deg)
    brightness = rng.uniform(0.75, 1.25, shape)
    has_blind = rng.random(shape) < case.disturbances.blinds
    blind_share = np.where(has_blind, rng.uniform(0.1, 0.9, shape), 0.0)
    # Spandrels are opaque: darker, all alike, and with no blind.
    brightness[grid.spandrels] = 0.6
    blind_share[grid.spandrels] = 0.0
    tilts = rng.normal(0.0, 1.0, (2, *shape)) * tilt
    return Panes(*(values.astype(np.float32) for values in (*tilts, brightness, blind_share)))


def _sun(origin: Array, grid: Grid, rng: np.random.Generator) -> Array:
    """Unit vector to the sun, wall frame, so that the untilted plane mirrors it somewhere on the facade."""
    s = rng.uniform(0.6 * grid.columns_m[0], 0.6 * grid.columns_m[-1])
    h = rng.uniform(0.4, 0.9) * grid.rows_m[-1]
    to_wall = np.array([s, 0.0, h]) - origin
    mirrored = to_wall * np.array([1.0, -1.0, 1.0])
    return np.asarray(mirrored / np.linalg.norm(mirrored))
