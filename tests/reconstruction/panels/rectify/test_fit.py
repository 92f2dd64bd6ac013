"""Planes and cylinders fitted to coarse points: known truth, outliers, and the hard cases between flat and round."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from reconstruction.panels.rectify.fit import FitParameters, fit_cylinder, fit_plane
from reconstruction.panels.rectify.surface import FacadeSurface
from tests.reconstruction.panels.rectify.test_surface import surface

Array = NDArray[np.float64]


def cloud(
    truth: FacadeSurface,
    seed: int,
    noise_m: float = 0.05,
    outliers: float = 0.0,
    half_width_m: float = 15.0,
    n: int = 3000,
) -> Array:
    rng = np.random.default_rng(seed)
    st = rng.uniform((-half_width_m, -10.0), (half_width_m, 10.0), (n, 2))
    height = rng.normal(0.0, noise_m, n)
    wild = rng.random(n) < outliers
    height[wild] = rng.uniform(-4.0, 1.0, int(wild.sum()))
    return truth.to_enu(st) + height[:, None] * truth.normals_at(st)


def outside(truth: FacadeSurface) -> Array:
    return truth.anchor_enu_m + 20.0 * truth.normal_enu


def grid_error_m(found: FacadeSurface, truth: FacadeSurface, half_width_m: float = 15.0) -> float:
    s, t = np.meshgrid(np.linspace(-half_width_m, half_width_m, 21), np.linspace(-10.0, 10.0, 11))
    return float(np.abs(found.height_m(truth.to_enu(np.column_stack([s.ravel(), t.ravel()])))).max())


@pytest.mark.few(1)
@pytest.mark.parametrize("curvature", [0.0, 1e-5, 0.002, 0.02, 0.06, -0.02, -0.06])
@pytest.mark.parametrize("outliers", [0.0, 0.3])
def test_a_surface_is_found_to_a_centimetre_among_outliers(curvature: float, outliers: float) -> None:
    truth = surface(curvature)
    found = fit_cylinder(cloud(truth, 1, outliers=outliers), outside(truth))
    assert grid_error_m(found.surface, truth) < 0.03
    assert found.surface.normal_enu @ truth.normal_enu > 0.9
    assert found.noise_m == pytest.approx(0.05, rel=0.6)


@pytest.mark.slow
def test_a_half_round_tower_is_found() -> None:
    truth = surface(0.1, lean_rad=0.0)
    found = fit_cylinder(cloud(truth, 2, half_width_m=15.0), outside(truth))
    assert 1.0 / found.surface.curvature_per_m == pytest.approx(10.0, abs=0.02)


@pytest.mark.slow
def test_curvature_and_its_standard_deviation_agree_with_the_truth_over_many_seeds() -> None:
    truth = surface(0.003)
    off = []
    for seed in range(20):
        found = fit_cylinder(cloud(truth, seed, n=800), outside(truth))
        off.append((found.surface.curvature_per_m - 0.003) / found.curvature_sigma_per_m)
    spread = float(np.sqrt(np.mean(np.square(off))))
    assert 0.6 < spread < 1.8


@pytest.mark.slow
def test_a_flat_wall_has_no_significant_curvature_and_no_radius_runs_away() -> None:
    truth = surface(0.0)
    significances = [fit_cylinder(cloud(truth, seed), outside(truth)).curvature_significance for seed in range(10)]
    assert max(significances) < 5.0
    exact = fit_cylinder(cloud(truth, 0, noise_m=0.0), outside(truth))
    assert np.isfinite(exact.surface.curvature_per_m)
    assert grid_error_m(exact.surface, truth) < 1e-6


@pytest.mark.slow
def test_a_narrow_strip_says_how_little_it_knows_of_its_curvature() -> None:
    truth = surface(0.02)
    wide = fit_cylinder(cloud(truth, 3), outside(truth))
    narrow = fit_cylinder(cloud(truth, 3, half_width_m=1.0), outside(truth))
    assert narrow.curvature_sigma_per_m > 50.0 * wide.curvature_sigma_per_m
    assert narrow.curvature_significance < 5.0


def test_a_barrel_roof_lying_on_its_side_is_found_as_a_level_cylinder() -> None:
    axes = np.eye(3)
    truth = FacadeSurface(np.array([0.0, 0.0, 8.0]), axes[2], axes[0], 0.08)
    found = fit_cylinder(cloud(truth, 4), truth.anchor_enu_m + 20.0 * truth.normal_enu)
    assert grid_error_m(found.surface, truth, 10.0) < 0.03
    assert abs(found.surface.curvature_per_m) == pytest.approx(0.08, rel=0.02)


def test_plane_has_outward_normal_and_upright_frame() -> None:
    truth = surface(0.0, lean_rad=0.0)
    found = fit_plane(cloud(truth, 5, outliers=0.4), outside(truth)).surface
    assert found.normal_enu @ truth.normal_enu > 0.9999
    assert found.up_enu[2] > 0.999
    turned = fit_plane(cloud(truth, 5), truth.anchor_enu_m - 20.0 * truth.normal_enu).surface
    assert turned.normal_enu @ truth.normal_enu < -0.9999


def test_coordinates_of_a_city_lose_nothing() -> None:
    truth = surface(0.02)
    far = FacadeSurface(truth.anchor_enu_m + np.array([5e5, 5.2e6, 0.0]), truth.right_enu, truth.up_enu, 0.02)
    found = fit_cylinder(cloud(far, 6), outside(far))
    assert grid_error_m(found.surface, far) < 0.03


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.zeros((5, 3)), np.zeros((50, 3)), np.full((50, 3), np.nan)])
def test_too_little_is_refused(points: Array) -> None:
    with pytest.raises(InfeasibleError):
        fit_cylinder(points, np.array([0.0, 0.0, 5.0]))


def test_points_on_a_line_are_refused() -> None:
    line = np.linspace(0.0, 10.0, 50)[:, None] * np.array([1.0, 2.0, 3.0])
    with pytest.raises(InfeasibleError, match="line"):
        fit_plane(line, np.array([0.0, 0.0, 50.0]))


def test_the_result_does_not_depend_on_more_points_than_are_used() -> None:
    truth = surface(0.01)
    few = fit_cylinder(cloud(truth, 7, n=20000), outside(truth), FitParameters(max_points=1000))
    assert few.n_points == 1000
    assert grid_error_m(few.surface, truth) < 0.05
