"""Photos with wrong poses brought onto one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from reconstruction.base.cameras import PosedPhoto
from reconstruction.metrics.sets import surface_of
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import SurfaceView, surface_view
from reconstruction.panels.solving.adjustment import moved_pose
from reconstruction.panels.solving.register import registered
from reconstruction.scenes.facades.cases import wide_camera
from reconstruction.scenes.facades.record import Disturbances, Layout, SyntheticFacade, Wall
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.synthetic_photos import simple_case

LAYOUT = Layout(5, 9, 1.5, 2.4)
MIRRORING = Disturbances(reflection=0.45, opposite="grid", tilt_deg=0.3, clutter=True, blur_px=0.6, noise_grey=3.0)
"""A bright grid is mirrored: a picture laid on another as it is would follow it."""

FRAME_BGR = (54.0, 50.0, 46.0)


@cache
def photos(curvature: float = 0.0) -> tuple[SyntheticFacade, ...]:
    lens = wide_camera(800, 600)
    cases = [
        simple_case(LAYOUT, MIRRORING, wall=Wall(curvature_per_m=curvature), intrinsics=lens, seed=1, oblique_deg=angle)
        for angle in (0.0, 9.0)
    ]
    return tuple(render_facade(replace(case, frame_bgr=FRAME_BGR)) for case in cases)


def stated(made: SyntheticFacade, position_m: float, turn_deg: float, seed: int) -> PosedPhoto:
    covariance = np.diag([position_m**2] * 3 + [np.radians(turn_deg) ** 2] * 3)
    off = np.random.default_rng(seed).multivariate_normal(np.zeros(6), covariance)
    return replace(made.photo, pose=replace(moved_pose(made.photo.pose, off), covariance=covariance))


def views_of(made: Sequence[SyntheticFacade], posed: Sequence[PosedPhoto]) -> list[SurfaceView]:
    low = np.array([made[0].columns_m[0] - 2.0, made[0].rows_m[0] - 2.0])
    high = np.array([made[0].columns_m[-1] + 2.0, made[0].rows_m[-1] + 2.0])
    first = surface_view(posed[0], surface_of(made[0].case), low, high)
    return [replace(first, photo=photo, low_st_m=low, high_st_m=high) for photo in posed]


def off_px(made: Sequence[SyntheticFacade], views: Sequence[Rectification]) -> float:
    """How far the corners of panels lie apart in two rectified pictures, nine in ten of them at most."""
    corners = [np.concatenate([panel.corners_px for panel in one.panels]) for one in made]
    first, second = (view.to_rectified(points) for view, points in zip(views, corners, strict=True))
    return float(np.percentile(np.linalg.norm(first - second, axis=1), 90.0))


@pytest.mark.slow
@pytest.mark.parametrize(("curvature", "seed"), [(0.0, 0), (0.0, 1), (0.05, 2)])
def test_photos_with_wrong_poses_lie_on_one_another_to_a_pixel(curvature: float, seed: int) -> None:
    made = photos(curvature)
    views = views_of(made, [stated(one, 0.03, 0.4, 10 * seed + i) for i, one in enumerate(made)])
    placed = registered([one.image for one in made], views)
    before, after = off_px(made, views), off_px(made, [one.view for one in placed])
    assert before > 3.0
    assert after < 1.2
    assert placed[0].view is views[0]
    assert placed[1].agreement > 0.3
    assert placed[1].moved_px == pytest.approx(before, rel=0.6)


@pytest.mark.slow
def test_right_poses_stay_as_they_are() -> None:
    made = photos()
    views = views_of(
        made, [replace(one.photo, pose=replace(one.photo.pose, covariance=np.eye(6) * 1e-8)) for one in made]
    )
    placed = registered([one.image for one in made], views)
    assert off_px(made, [one.view for one in placed]) < 1.0
    assert placed[1].moved_px < 1.0


@pytest.mark.slow
def test_the_same_photos_give_the_same_and_blank_ones_no_agreement() -> None:
    made = photos()
    views = views_of(made, [stated(one, 0.03, 0.2, i) for i, one in enumerate(made)])
    blank = np.full_like(made[0].image, 128)
    first, second = (registered([made[0].image, blank], views)[1] for _ in range(2))
    assert first.agreement == second.agreement < 0.05
    assert np.isfinite(first.moved_px)
