"""Cases to make facades from: one by hand, and many by a seed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import aim
from reconstruction.base.cameras import Array, Intrinsics, Pose, PosedPhoto
from reconstruction.scenes.facades.record import BraceEnds, Case, Disturbances, Layout, Opposite, Top, Wall, Widths

# Lines and panels of a synthetic facade along its wall.

LEAST_PIECE = 0.04
"""Of a cell's area: smaller pieces that inclined profiles leave are closed, no panels. Nobody builds such panes."""

ALTERNATING = (1.0, 0.6)
RANDOM_WIDTHS = (0.6, 1.4)
"""Widths of columns as multiples of the nominal one."""


@dataclass(frozen=True, slots=True)
class Brace:
    """An inclined profile: where across_s s + across_h h = offset_m, to `half_m` on both sides; a unit normal."""

    across_s: float
    across_h: float
    offset_m: float
    half_m: float

    def signed_m(self, s_m: Array, h_m: Array) -> Array:
        """Distance of places along the wall from the profile's middle, positive on the side of the normal."""
        return np.asarray(self.across_s * s_m + self.across_h * h_m - self.offset_m)


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """A layout drawn up, metres along the wall from its middle and above its base.

    Parameters
    ----------
    columns_m, rows_m
        Middles of the lines, shapes (n_columns + 1,) and (n_rows + 1,), rising. Rows count spandrels.
    tops_m
        Height of the upper edge at the columns' lines, shape (n_columns + 1,); straight between them.
    half_mullions_m
        Half widths of the mullions' pieces, shape (n_rows, n_columns + 1); 0 where a piece is missing.
    half_transom_m
        Of all horizontal profiles, and of the one along the upper edge.
    spandrels
        Rows that are spandrels.
    panel_numbers
        Shape (n_rows, n_columns, n_parts): from 1, row by row from below; 0 for what is no panel. A cell without braces
        has only its part 0; bit k of a part's number says on which side of the cell's k-th brace it lies.
    braces, cell_braces
        Inclined profiles, and those that cross each cell, shape (n_rows, n_columns, k), -1 for none.
    """

    columns_m: Array
    rows_m: Array
    tops_m: Array
    half_mullions_m: Array
    half_transom_m: float
    spandrels: NDArray[np.bool_]
    panel_numbers: NDArray[np.int32]
    braces: tuple[Brace, ...]
    cell_braces: NDArray[np.int64]

    def corners(self, row: int, column: int, part: int = 0) -> Array:
        """Corners of a part of a cell's glass along the wall, shape (k, 2), counter-clockwise from its lower left."""
        polygon = self._glass(row, column)
        for bit, index in enumerate(self.cell_braces[row, column]):
            if index >= 0:
                brace = self.braces[index]
                side = 1.0 if part >> bit & 1 else -1.0
                polygon = clip(polygon, side * brace.signed_m(polygon[:, 0], polygon[:, 1]) - brace.half_m)
        return polygon

    def _glass(self, row: int, column: int) -> Array:
        """Of a whole cell, without its braces."""
        left = self.columns_m[column] + self.half_mullions_m[row, column]
        right = self.columns_m[column + 1] - self.half_mullions_m[row, column + 1]
        bottom, top = self.rows_m[row] + self.half_transom_m, self.rows_m[row + 1] - self.half_transom_m
        box = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
        (s0, s1), (t0, t1) = self.columns_m[column : column + 2], self.tops_m[column : column + 2]
        if self.rows_m[row + 1] < min(t0, t1):
            return box
        slope = (t1 - t0) / (s1 - s0)
        # The upper profile is as wide as the others across its own direction.
        edge = t0 - self.half_transom_m * np.hypot(1.0, slope)
        return clip(box, edge + slope * (box[:, 0] - s0) - box[:, 1])


def clip(polygon: Array, signed: Array) -> Array:
    """The part of a convex polygon, shape (k, 2), where a linear function, given at its corners, is not negative."""
    kept = []
    for a, b, at_a, at_b in zip(polygon, np.roll(polygon, -1, 0), signed, np.roll(signed, -1), strict=True):
        if at_a >= 0.0:
            kept.append(a)
        if (at_a > 0.0) != (at_b > 0.0) and at_a * at_b < 0.0:
            kept.append(a + (b - a) * at_a / (at_a - at_b))
    return np.array(kept).reshape(-1, 2)


def grid_of_layout(layout: Layout, rng: np.random.Generator) -> Grid:
    """Draw up a layout; `rng` decides random widths and what is missing."""
    n_columns = layout.n_columns
    widths = np.full(n_columns, layout.panel_width_m)
    if layout.widths == "alternating":
        widths *= np.resize(ALTERNATING, n_columns)
    elif layout.widths == "random":
        widths *= rng.uniform(*RANDOM_WIDTHS, n_columns)
    columns = np.concatenate([[0.0], np.cumsum(widths)])
    heights, spandrels = [layout.panel_height_m], [False]
    if layout.spandrel_height_m > 0.0:
        heights, spandrels = [layout.spandrel_height_m, layout.panel_height_m], [True, False]
    rows = np.concatenate([[0.0], np.cumsum(heights * layout.n_rows)])
    n_rows = len(rows) - 1
    half_mullions = np.full((n_rows, n_columns + 1), 0.5 * layout.mullion_width_m)
    half_mullions[:, 1:-1][rng.random((n_rows, n_columns - 1)) < layout.missing_profiles] = 0.0
    n_missing = min(layout.n_missing_mullions, n_columns - 1)
    half_mullions[:, 1 + rng.choice(n_columns - 1, n_missing, replace=False) if n_missing else []] = 0.0
    is_panel = rng.random((n_rows, n_columns)) >= layout.missing_panels
    braces = tuple(
        _brace(ends, columns - 0.5 * columns[-1], rows, 0.5 * layout.brace_width_m) for ends in layout.braces
    )
    cell_braces = _crossing(layout, braces, columns - 0.5 * columns[-1], rows)
    n_parts = 2 ** cell_braces.shape[2]
    grid = Grid(
        columns - 0.5 * columns[-1],
        rows,
        _tops(layout, columns, rows),
        half_mullions,
        0.5 * layout.transom_width_m,
        np.array(spandrels * layout.n_rows),
        np.zeros((n_rows, n_columns, n_parts), np.int32),
        braces,
        cell_braces,
    )
    for row, column in np.argwhere(is_panel):
        (s0, s1), (h0, h1) = grid.columns_m[column : column + 2], rows[row : row + 2]
        for part in range(2 ** int((cell_braces[row, column] >= 0).sum())):
            is_pane = area(grid.corners(row, column, part)) >= LEAST_PIECE * (s1 - s0) * (h1 - h0)
            grid.panel_numbers[row, column, part] = is_pane
    has_panel = grid.panel_numbers > 0
    grid.panel_numbers[has_panel] = np.arange(1, has_panel.sum() + 1)
    return grid


def area(polygon: Array) -> float:
    """Of a simple polygon, shape (k, 2), counter-clockwise; 0 for fewer than three corners."""
    x, y = polygon[:, 0], polygon[:, 1]
    return float(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) if len(polygon) > 2 else 0.0


def _brace(ends: BraceEnds, columns: Array, rows: Array, half_m: float) -> Brace:
    r0, c0, r1, c1 = ends
    s0, s1 = np.interp([c0, c1], np.arange(len(columns)), columns)
    h0, h1 = np.interp([r0, r1], np.arange(len(rows)), rows)
    across = np.array([h0 - h1, s1 - s0]) / np.hypot(s1 - s0, h1 - h0)
    return Brace(float(across[0]), float(across[1]), float(across @ (s0, h0)), half_m)


def _crossing(layout: Layout, braces: tuple[Brace, ...], columns: Array, rows: Array) -> NDArray[np.int64]:
    """Braces that cross each cell, shape (n_rows, n_columns, k): those with corners on both sides, between its ends."""
    found: list[list[list[int]]] = [[[] for _ in columns[1:]] for _ in rows[1:]]
    s, h = np.meshgrid(columns, rows)
    for index, (brace, (r0, c0, r1, c1)) in enumerate(zip(braces, layout.braces, strict=True)):
        signed = brace.signed_m(s, h)
        for row in range(max(0, int(min(r0, r1))), min(len(rows) - 1, math.ceil(max(r0, r1)))):
            for column in range(max(0, int(min(c0, c1))), min(len(columns) - 1, math.ceil(max(c0, c1)))):
                corners = signed[row : row + 2, column : column + 2]
                if corners.min() < -brace.half_m and corners.max() > brace.half_m:
                    found[row][column].append(index)
    most = max((len(cell) for row in found for cell in row), default=0)
    crossing = np.full((len(rows) - 1, len(columns) - 1, most), -1, np.int64)
    for i, j in np.ndindex(crossing.shape[:2]):
        crossing[i, j, : len(found[i][j])] = found[i][j]
    return crossing


def _tops(layout: Layout, columns: Array, rows: Array) -> Array:
    low, high = float(rows[-1 - layout.n_sloped_rows]), float(rows[-1])
    if layout.top == "sloped":
        return np.asarray(low + (high - low) * columns / columns[-1])
    if layout.top == "gable":
        away = np.abs(columns - columns[len(columns) // 2])
        return np.asarray(high + (low - high) * away / away.max())
    if layout.top == "triangles":
        low = float(rows[-2])
        return np.where(np.arange(len(columns)) % 2, high, low)
    return np.full(len(columns), float(high))


Shape = Literal["planar", "curved", "irregular"]
SHAPES: tuple[Shape, ...] = ("planar", "curved", "irregular")

WIDE_FOCAL_RATIO = 12.29 / 17.3
"""Focal length of the DJI M3E's wide camera as a share of the picture's width."""


def wide_camera(width_px: int = 1600, height_px: int = 1200) -> Intrinsics:
    """A straight camera with the field of view of the DJI M3E."""
    focal = WIDE_FOCAL_RATIO * width_px
    return Intrinsics(width_px, height_px, focal, focal, width_px / 2, height_px / 2)


def photo_of(
    wall: Wall,
    layout: Layout,
    intrinsics: Intrinsics,
    *,
    seed: int = 0,
    oblique_deg: float = 0.0,
    from_below_deg: float = 0.0,
    roll_deg: float = 0.0,
    fill: float = 0.85,
    name: str = "made",
) -> PosedPhoto:
    """A camera that looks at the middle of a facade and sees all of it.

    Parameters
    ----------
    seed
        Of the case, which decides random widths.
    oblique_deg
        Direction from the facade's middle to the camera, to the right against the normal.
    from_below_deg
        How far the camera looks up.
    fill
        Share of the picture's width or height, whichever is reached first, that the facade takes.
    """
    outline = _outline_enu_m(wall, layout, seed)
    target = wall.points_enu_m(np.zeros(1), np.array([outline[:, 2].mean() - wall.base_enu_m[2]]))[0]
    heading = math.radians(wall.outward_heading_deg - oblique_deg)
    pitch = -math.radians(from_below_deg)
    towards = np.array([math.cos(pitch) * math.sin(heading), math.cos(pitch) * math.cos(heading), math.sin(pitch)])
    low, high = 1.0, 2000.0
    for _ in range(60):
        distance = 0.5 * (low + high)
        photo = _looking_at(target, target + distance * towards, intrinsics, roll_deg, name)
        low, high = (low, distance) if _fits(photo, outline, fill) else (distance, high)
    return _looking_at(target, target + high * towards, intrinsics, roll_deg, name)


def _outline_enu_m(wall: Wall, layout: Layout, seed: int) -> Array:
    grid = grid_of_layout(layout, np.random.default_rng(seed))
    s = np.linspace(grid.columns_m[0], grid.columns_m[-1], 33)
    return np.concatenate([wall.points_enu_m(s, np.full_like(s, h)) for h in (grid.rows_m[0], grid.rows_m[-1])])


def _looking_at(target: Array, position: Array, intrinsics: Intrinsics, roll_deg: float, name: str) -> PosedPhoto:
    heading_rad, pitch_rad = aim(target - position)
    pose = Pose.looking(position, math.degrees(heading_rad), math.degrees(pitch_rad), roll_deg)
    return PosedPhoto(name, Path(f"{name}.png"), intrinsics, pose)


def _fits(photo: PosedPhoto, outline: Array, fill: float) -> bool:
    pixels = photo.pixels(outline)
    if np.isnan(pixels).any():
        return False
    half = 0.5 * np.array([photo.intrinsics.width_px, photo.intrinsics.height_px])
    return bool((np.abs(pixels - half) <= fill * half).all())


def case_name(shape: Shape, seed: int) -> str:
    """Name of a random case."""
    return f"{shape}-{seed:03d}"


def with_inclined_lines(layout: Layout, seed: int, rng: np.random.Generator) -> Layout:
    """The layout with inclined lines of one of six kinds, by the seed.

    A gable, a sloped upper edge, large braces both ways, diagonals of all cells one way, a diagrid on the cells' nodes,
    and a single large diagonal.
    """
    kind = seed % 6
    if kind < 2:
        n_sloped = int(rng.integers(2, max(3, layout.n_rows - 2)))
        top: Top = "gable" if kind == 0 else "sloped"
        return replace(layout, top=top, n_sloped_rows=n_sloped)
    if kind in (3, 4):
        layout = replace(layout, widths="uniform", spandrel_height_m=0.0)
    rows = layout.n_rows * (2 if layout.spandrel_height_m > 0.0 else 1)
    columns = layout.n_columns
    if kind == 2:
        bay = int(rng.integers(3, 7))
        starts = range(0, columns - bay + 1, bay)
        braces = [(0, c, rows, c + bay) for c in starts] + [(rows, c, 0, c + bay) for c in starts]
    elif kind == 3:
        braces = _diagonals(rows, columns, 1, 1)
    elif kind == 4:
        braces = _diagonals(rows, columns, 2, 1) + [(rows - a, b, rows - c, d) for a, b, c, d in
                                                    _diagonals(rows, columns, 2, 1)]  # fmt: skip
    else:
        braces = [(0, 0, rows, columns)] if rng.random() < 0.5 else [(rows, 1, 0, columns - 2)]
    return replace(layout, braces=tuple(braces), brace_width_m=rng.uniform(0.06, 0.12))


def _diagonals(rows: int, columns: int, step: int, rise: int) -> list[tuple[int, int, int, int]]:
    """Lines from node to node through the whole grid, `rise` rows a column, `step` columns apart."""
    found = []
    for start in range(-(rows // rise // step) * step, columns, step):
        first = max(0, start)
        last = min(columns, start + rows // rise)
        if last > first:
            found.append(((first - start) * rise, first, (last - start) * rise, last))
    return found


def _opposite(shape: Shape, share: float) -> Opposite:
    """A bright grid in one case of five; of the irregular ones, as many with inclined roof edges."""
    if share < 0.2:
        return "grid"
    return "roofs" if shape == "irregular" and share < 0.4 else "skyline"


def random_case(shape: Shape, seed: int, intrinsics: Intrinsics | None = None) -> Case:
    """A facade with strong reflections and all disturbances, its layout and camera chosen by `seed`."""
    rng = np.random.default_rng([seed, SHAPES.index(shape)])
    widths: tuple[Widths, ...] = ("uniform", "alternating", "random")
    tops: tuple[Top, ...] = ("straight",)
    layout = Layout(
        n_rows=int(rng.integers(5, 13)),
        n_columns=int(rng.integers(8, 21)),
        panel_width_m=rng.uniform(1.1, 1.8),
        panel_height_m=rng.uniform(1.8, 3.2),
        widths=widths[rng.integers(len(widths))],
        spandrel_height_m=float(rng.choice([0.0, 0.9])),
        mullion_width_m=rng.uniform(0.05, 0.1),
        transom_width_m=rng.uniform(0.05, 0.1),
        frame_depth_m=float(rng.choice([0.0, 0.03])),
        missing_profiles=float(rng.choice([0.0, 0.03])),
        missing_panels=float(rng.choice([0.0, 0.03])),
        top=tops[0],
    )
    if shape == "irregular":
        layout = with_inclined_lines(layout, seed, rng)
    is_curved = shape == "curved" or (shape == "irregular" and seed % 3 == 2)
    width_m = layout.panel_width_m * layout.n_columns
    wall = Wall(
        outward_heading_deg=rng.uniform(-180.0, 180.0),
        # An arc of 40 to 90 degrees: 30 m of facade on a radius of 20 to 45 m.
        curvature_per_m=math.radians(rng.uniform(40.0, 90.0)) / width_m if is_curved else 0.0,
    )
    dark, glass = rng.random() < 0.5, rng.uniform(0.6, 1.3)
    frame = rng.uniform(35.0, 75.0) if dark else rng.uniform(170.0, 225.0)
    disturbances = Disturbances(
        reflection=rng.uniform(0.35, 0.6),
        opposite=_opposite(shape, rng.random()),
        street_m=rng.uniform(20.0, 45.0),
        tilt_deg=rng.uniform(0.15, 0.5),
        pillow_deg=rng.uniform(0.0, 0.4),
        blinds=rng.uniform(0.0, 0.5),
        glare=rng.uniform(0.0, 1.0),
        shadow=rng.uniform(0.0, 0.5),
        clutter=True,
        blur_px=rng.uniform(0.4, 1.0),
        noise_grey=rng.uniform(1.0, 5.0),
        yaw_error_deg=0.0,
    )
    photo = photo_of(
        wall,
        layout,
        intrinsics or wide_camera(),
        seed=seed,
        oblique_deg=rng.uniform(-8.0, 8.0) if is_curved else rng.uniform(-25.0, 25.0),
        from_below_deg=rng.uniform(-8.0, 15.0),
        roll_deg=rng.uniform(-1.5, 1.5),
        fill=rng.uniform(0.78, 0.92),
        name=case_name(shape, seed),
    )
    colours = (frame * 1.03, frame, 0.97 * frame), (88.0 * glass, 78.0 * glass, 60.0 * glass)
    return Case(photo.name, layout, wall, photo, disturbances, *colours, seed)
