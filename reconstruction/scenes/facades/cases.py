"""Cases to make facades from: one by hand, and many by a seed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from planning.geo.frames import aim
from reconstruction.base.cameras import Array, Intrinsics, Pose, PosedPhoto
from reconstruction.scenes.facades.layout import draw_up
from reconstruction.scenes.facades.record import Case, Disturbances, Layout, Opposite, Top, Widths
from reconstruction.scenes.facades.wall import Wall

Shape = Literal["planar", "curved", "irregular"]
SHAPES: tuple[Shape, ...] = ("planar", "curved", "irregular")

WIDE_FOCAL_RATIO = 12.29 / 17.3
"""Focal length of the DJI M3E's wide camera as a share of the picture's width."""

STRONG = Disturbances(
    reflection=0.45,
    tilt_deg=0.35,
    pillow_deg=0.25,
    blinds=0.3,
    glare=0.8,
    shadow=0.4,
    clutter=True,
    blur_px=0.6,
    noise_grey=3.0,
)
"""Everything at once, as on a sunny day in a street."""


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
    grid = draw_up(layout, np.random.default_rng(seed))
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


def simple_case(
    layout: Layout | None = None,
    disturbances: Disturbances | None = None,
    *,
    wall: Wall | None = None,
    intrinsics: Intrinsics | None = None,
    seed: int = 0,
    oblique_deg: float = 0.0,
    from_below_deg: float = 0.0,
    roll_deg: float = 0.0,
    fill: float = 0.85,
) -> Case:
    """A facade seen straight from the front and without any disturbance, but for what is asked for."""
    layout, wall = layout or Layout(), wall or Wall()
    photo = photo_of(
        wall,
        layout,
        intrinsics or wide_camera(),
        seed=seed,
        oblique_deg=oblique_deg,
        from_below_deg=from_below_deg,
        roll_deg=roll_deg,
        fill=fill,
    )
    return Case("made", layout, wall, photo, disturbances or Disturbances(), seed=seed)


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
