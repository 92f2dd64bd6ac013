"""Cases to make facades from: one by hand, and many by a seed."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

import numpy as np

from planning.frames import aim
from reconstruction.cameras import Array, Intrinsics, Pose, PosedPhoto
from reconstruction.made_facades.layout import draw_up
from reconstruction.made_facades.record import Case, Disturbances, Layout, Top, Widths
from reconstruction.made_facades.wall import Wall

Shape = Literal["planar", "curved"]

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


def random_case(shape: Shape, seed: int, intrinsics: Intrinsics | None = None) -> Case:
    """A facade with strong reflections and all disturbances, its layout and camera chosen by `seed`."""
    rng = np.random.default_rng([seed, shape == "curved"])
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
    width_m = layout.panel_width_m * layout.n_columns
    wall = Wall(
        outward_heading_deg=rng.uniform(-180.0, 180.0),
        # An arc of 40 to 90 degrees: 30 m of facade on a radius of 20 to 45 m.
        curvature_per_m=math.radians(rng.uniform(40.0, 90.0)) / width_m if shape == "curved" else 0.0,
    )
    dark, glass = rng.random() < 0.5, rng.uniform(0.6, 1.3)
    frame = rng.uniform(35.0, 75.0) if dark else rng.uniform(170.0, 225.0)
    disturbances = Disturbances(
        reflection=rng.uniform(0.35, 0.6),
        opposite="grid" if rng.random() < 0.2 else "skyline",
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
        oblique_deg=rng.uniform(-25.0, 25.0) if shape == "planar" else rng.uniform(-8.0, 8.0),
        from_below_deg=rng.uniform(-8.0, 15.0),
        roll_deg=rng.uniform(-1.5, 1.5),
        fill=rng.uniform(0.78, 0.92),
        name=case_name(shape, seed),
    )
    colours = (frame * 1.03, frame, 0.97 * frame), (88.0 * glass, 78.0 * glass, 60.0 * glass)
    return Case(photo.name, layout, wall, photo, disturbances, *colours, seed)
