"""Grids of several photos with wrong poses become panels in 3-D, and their covariances tell the truth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.panels.rectify.fit import SurfaceFit, changed
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.rectify.view import surface_view
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine
from reconstruction.panels.solving.adjustment import moved_pose
from reconstruction.panels.solving.record import SolvedFacade
from reconstruction.panels.solving.solve import solve_facade
from tests.reconstruction.panels.rectify.scenes import looking_at
from tests.reconstruction.panels.rectify.test_surface import surface

Array = NDArray[np.float64]

COLUMNS = np.array([-7.0, -5.5, -4.0, -2.9, -1.4, 0.1, 1.6, 3.1, 4.2, 5.7, 7.2])
"""With two narrow ones, so that a grid moved by a panel does not fit."""

ROWS = np.array([-5.0, -2.0, 1.0, 4.0])
WIDTH_M = 0.06
RTK = np.diag([0.03**2] * 3 + [np.radians(0.3) ** 2] * 3)


def stated(photo: PosedPhoto, covariance: Array, rng: np.random.Generator) -> PosedPhoto:
    wrong = moved_pose(photo.pose, rng.multivariate_normal(np.zeros(6), covariance))
    pose = Pose(wrong.position_enu_m, wrong.cam_from_enu, covariance)
    return PosedPhoto(photo.name, photo.path, photo.intrinsics, pose)


def found_grid(
    true: PosedPhoto,
    told: PosedPhoto,
    truth: FacadeSurface,
    assumed: FacadeSurface,
    sigma_px: float,
    rng: np.random.Generator,
) -> FacadeGrid:
    """What a perfect search for lines finds in the view that the stated pose leads to."""
    view = surface_view(told, assumed, np.array([-9.0, -7.0]), np.array([9.0, 7.0]))

    def line(points: Array, across: int) -> GridLine:
        places = view.to_rectified(true.pixels(truth.to_enu(points)))
        return GridLine(
            float(places[:, across].mean()) + rng.normal(0.0, sigma_px), WIDTH_M * view.px_per_m, sigma_px, 0.9
        )

    columns = tuple(line(np.column_stack([np.full(5, s), np.linspace(-5.0, 4.0, 5)]), 0) for s in COLUMNS)
    rows = tuple(line(np.column_stack([np.linspace(-7.0, 7.2, 5), np.full(5, t)]), 1) for t in ROWS[::-1])
    panels = [
        FoundPanel(
            f"A-{r}-{c}",
            r,
            c,
            true.pixels(truth.to_enu(np.array([[COLUMNS[c], ROWS[r]], [COLUMNS[c + 1], ROWS[r + 1]]]))),
            0.9,
        )
        for r in range(3)
        for c in range(10)
    ]
    return FacadeGrid("A", view, rows, columns, tuple(panels))


def solved(
    curvature: float, seed: int, n_photos: int = 3, covariance: Array = RTK, sigma_px: float = 0.3
) -> tuple[SolvedFacade, FacadeSurface]:
    rng = np.random.default_rng(seed)
    truth = surface(curvature, lean_rad=0.0)
    n = 5 if curvature else 3
    of_fit = np.diag([0.02, 2e-4, 2e-4, 2e-4, 2e-5][:n]) ** 2
    assumed = changed(truth, rng.multivariate_normal(np.zeros(n), of_fit))
    fit = SurfaceFit(assumed, of_fit, 0.05, 1000)
    true = [looking_at(truth, 22.0, aside, above) for aside, above in ((0, 0), (7, 2), (-6, -2), (3, 4), (-3, 3))][
        :n_photos
    ]
    told = [stated(photo, covariance, rng) for photo in true]
    grids = {i: found_grid(true[i], told[i], truth, assumed, sigma_px, rng) for i in range(n_photos)}
    return solve_facade("A", told, grids, fit), truth


def corner_errors(facade: SolvedFacade, truth: FacadeSurface) -> tuple[Array, Array]:
    """Errors of all corners, shape (n, 3), and their covariances."""
    errors, covariances = [], []
    for panel in facade.panels:
        s = COLUMNS[panel.column] + WIDTH_M / 2, COLUMNS[panel.column + 1] - WIDTH_M / 2
        t = ROWS[panel.row] + WIDTH_M / 2, ROWS[panel.row + 1] - WIDTH_M / 2
        true = truth.to_enu(np.array([[s[0], t[0]], [s[1], t[0]], [s[1], t[1]], [s[0], t[1]]]))
        errors.append(panel.corners_enu_m - true)
        covariances.append(panel.covariance_m2)
    return np.concatenate(errors), np.concatenate(covariances)


@pytest.mark.few(1)
@pytest.mark.parametrize("curvature", [0.0, 0.02, -0.03])
def test_all_panels_are_found_within_the_error_of_the_poses(curvature: float) -> None:
    facade, truth = solved(curvature, 0)
    assert len(facade.panels) == 30
    assert facade.panels[0].id == "A-01-01"
    errors, _ = corner_errors(facade, truth)
    assert np.abs(errors).max() < 0.25
    normal = np.cross(
        facade.panels[0].corners_enu_m[2] - facade.panels[0].corners_enu_m[0],
        facade.panels[0].corners_enu_m[3] - facade.panels[0].corners_enu_m[1],
    )
    assert normal @ truth.normal_enu > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("curvature", [0.0, 0.02])
def test_covariances_tell_the_errors_over_many_seeds(curvature: float) -> None:
    squares = []
    for seed in range(6):
        facade, truth = solved(curvature, seed)
        errors, covariances = corner_errors(facade, truth)
        corner = 4 * (seed % 30)
        squares.append(errors[corner] @ np.linalg.pinv(covariances[corner], rcond=1e-9) @ errors[corner])
    assert 1.0 < np.mean(squares) < 6.0


@pytest.mark.slow
def test_more_photos_make_better_corners_and_smaller_covariances() -> None:
    few, many = [], []
    for seed in range(5):
        for n_photos, into in ((1, few), (5, many)):
            facade, truth = solved(0.0, seed, n_photos)
            errors, covariances = corner_errors(facade, truth)
            into.append((np.sqrt((errors**2).mean()), np.sqrt(np.trace(covariances[0]))))
    assert np.mean([error for error, _ in many]) < 0.8 * np.mean([error for error, _ in few])
    assert np.mean([sigma for _, sigma in many]) < 0.8 * np.mean([sigma for _, sigma in few])


def test_single_gnss_photos_are_brought_together_where_the_grid_is_not_regular() -> None:
    single = np.diag([0.5**2] * 3 + [np.radians(0.5) ** 2] * 3)
    facade, _ = solved(0.0, 3, 3, single)
    assert len(facade.columns) == len(COLUMNS)
    assert len(facade.rows) == len(ROWS)
    assert all(line.n_photos == 3 for line in facade.columns)


def test_a_line_that_one_photo_misses_and_a_false_one_are_outvoted() -> None:
    rng = np.random.default_rng(0)
    truth = surface(0.0, lean_rad=0.0)
    photos = [stated(looking_at(truth, 22.0, aside), RTK, rng) for aside in (0.0, 5.0, -5.0)]
    fit = SurfaceFit(truth, np.diag([0.01, 1e-4, 1e-4]) ** 2, 0.05, 1000)
    grids = {i: found_grid(photo, photo, truth, truth, 0.3, rng) for i, photo in enumerate(photos)}
    worse = grids[0]
    without = tuple(line for i, line in enumerate(worse.columns) if i != 4)
    false = GridLine(0.5 * (without[1].position_px + without[2].position_px), 1.0, 0.3, 0.6)
    grids[0] = FacadeGrid(
        "A", worse.rectification, worse.rows, tuple(sorted((*without, false), key=lambda line: line.position_px)), ()
    )
    facade = solve_facade("A", photos, grids, fit)
    assert np.allclose([line.position_m for line in facade.columns], COLUMNS, atol=0.05)
    assert facade.columns[4].n_photos == 2


def test_cells_that_are_no_panels_are_left_out_by_majority() -> None:
    rng = np.random.default_rng(0)
    truth = surface(0.0, lean_rad=0.0)
    photos = [stated(looking_at(truth, 22.0, aside), RTK, rng) for aside in (0.0, 5.0, -5.0)]
    fit = SurfaceFit(truth, np.diag([0.01, 1e-4, 1e-4]) ** 2, 0.05, 1000)

    def without(grid: FacadeGrid, cells: Sequence[tuple[int, int]]) -> FacadeGrid:
        kept = tuple(panel for panel in grid.panels if (panel.row, panel.column) not in cells)
        return FacadeGrid("A", grid.rectification, grid.rows, grid.columns, kept, tuple(cells))

    full = [found_grid(photo, photo, truth, truth, 0.3, rng) for photo in photos]
    grids = {0: without(full[0], [(1, 2)]), 1: without(full[1], [(1, 2), (0, 0)]), 2: full[2]}
    facade = solve_facade("A", photos, grids, fit)
    cells = {(panel.row, panel.column) for panel in facade.panels}
    assert (1, 2) not in cells
    assert (0, 0) in cells
    assert len(cells) == 29


def test_no_grid_is_refused() -> None:
    truth = surface(0.0)
    fit = SurfaceFit(truth, np.diag([0.01, 1e-4, 1e-4]) ** 2, 0.05, 1000)
    with pytest.raises(InfeasibleError, match="no photo shows a grid"):
        solve_facade("A", [looking_at(truth)], {}, fit)
