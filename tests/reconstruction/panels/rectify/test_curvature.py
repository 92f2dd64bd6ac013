"""The effect of curvature, both ways: skipped it changes lines by less than its tolerance, used by more."""

from __future__ import annotations

import numpy as np
import pytest

from planning.base.effects import decide
from reconstruction.panels.rectify.fit import Curvature, FittedFacade, Unrolling, bent_by_px, fit_cylinder, fit_plane
from reconstruction.panels.rectify.view import surface_view
from tests.reconstruction.panels.rectify.scenes import looking_at
from tests.reconstruction.panels.rectify.test_fit import cloud, outside
from tests.reconstruction.panels.rectify.test_surface import surface

LOW, HIGH = np.array([-10.0, -7.0]), np.array([10.0, 7.0])


def fitted(curvature: float, seed: int = 0, noise_m: float = 0.02) -> FittedFacade:
    truth = surface(curvature, lean_rad=0.0)
    points = cloud(truth, seed, noise_m=noise_m, half_width_m=10.0)
    plane, cylinder = fit_plane(points, outside(truth)), fit_cylinder(points, outside(truth))
    return FittedFacade(looking_at(truth, aside_m=3.0), plane, cylinder, LOW, HIGH)


def most_bent_px(scene: FittedFacade, curvature: float) -> float:
    """How far true rows and columns are from straight ones in the rectified view that the decision leads to."""
    truth = surface(curvature, lean_rad=0.0)
    chosen = scene.cylinder if decide(Curvature(), scene).on else scene.plane
    view = surface_view(scene.photo, chosen.surface)
    lines = []
    for s in np.linspace(-9.0, 9.0, 7):
        column = truth.to_enu(np.column_stack([np.full(9, s), np.linspace(-6.0, 6.0, 9)]))
        lines.append(view.to_rectified(scene.photo.pixels(column))[:, 0])
    for t in np.linspace(-6.0, 6.0, 7):
        row = truth.to_enu(np.column_stack([np.linspace(-9.0, 9.0, 9), np.full(9, t)]))
        lines.append(view.to_rectified(scene.photo.pixels(row))[:, 1])
    return max(float(np.nanmax(line) - np.nanmin(line)) / 2.0 for line in lines)


@pytest.mark.few(1)
@pytest.mark.parametrize("curvature", [0.0, 1e-5, 0.005, 0.02, 0.05, -0.03])
def test_the_scene_decides_so_that_lines_are_straight(curvature: float) -> None:
    scene = fitted(curvature)
    decision = decide(Curvature(), scene)
    assert decision.on == (abs(curvature) > 1e-4)
    assert most_bent_px(scene, curvature) < 1.0


@pytest.mark.slow
def test_a_skipped_curvature_would_have_changed_little_and_a_used_one_changes_much() -> None:
    skipped, used = fitted(1e-5), fitted(0.02)
    assert bent_by_px(skipped) < Curvature().tolerance
    assert bent_by_px(used) > Curvature().tolerance
    flat = surface_view(used.photo, used.plane.surface)
    row = surface(0.02, lean_rad=0.0).to_enu(np.column_stack([np.linspace(-9.0, 9.0, 9), np.full(9, 6.0)]))
    y = flat.to_rectified(used.photo.pixels(row))[:, 1]
    assert np.ptp(y) / 2.0 > Curvature().tolerance


def test_a_curvature_within_its_noise_is_not_believed_and_the_user_may_overrule() -> None:
    scene = fitted(0.0, noise_m=0.3)
    decision = decide(Curvature(), scene)
    assert not decision.on
    assert decision.size == 0.0
    assert "noise" in decision.reason
    overruled = decide(Curvature(), scene, "on")
    assert (overruled.on, overruled.decided_by) == (True, "user")


@pytest.mark.parametrize(("curvature", "on"), [(0.0, False), (1e-4, False), (0.02, True)])
def test_unrolling_is_used_where_flattening_would_squeeze_columns(curvature: float, on: bool) -> None:
    face = surface(curvature)
    view = surface_view(looking_at(face), face, LOW, HIGH)
    decision = decide(Unrolling(), view)
    assert decision.on == on
    half = 0.5 * (view.high_st_m[0] - view.low_st_m[0])
    squeezed = half - (np.sin(curvature * half) / curvature if curvature else half)
    assert decision.size == pytest.approx(squeezed * view.px_per_m, abs=1e-6)
