"""Cut panels in 3-D: inclined lines of several photos become one, and corners know how good they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from groundstation.services.photos.panels import site_facade
from planning.base.findings import Severity
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.fit import SurfaceFit
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.search.cutting import area, clipped
from reconstruction.panels.search.record import FacadeGrid, InclinedLine
from reconstruction.panels.solving.find import reduced_panels
from reconstruction.panels.solving.record import SolvedFacade
from reconstruction.panels.solving.solve import solve_facade
from tests.reconstruction.panels.rectify.scenes import looking_at
from tests.reconstruction.panels.rectify.test_surface import surface
from tests.reconstruction.panels.solving.test_solve import COLUMNS, ROWS, RTK, WIDTH_M, found_grid, stated

Array = NDArray[np.float64]

BRACE = np.array([[COLUMNS[1], ROWS[0]], [COLUMNS[7], ROWS[3]]])
"""Ends of an inclined profile on the facade, s and t."""

BRACE_WIDTH_M = 0.1
SIGMA_PX = 0.3
PLACES = ((0.0, 0.0), (7.0, 2.0), (-6.0, -2.0))


def seen_line(grid: FacadeGrid, photo: PosedPhoto, truth: FacadeSurface, ends: Array, shift_px: float) -> InclinedLine:
    """What a photo shows of an inclined profile, shifted to its right."""
    first, last = grid.rectification.to_rectified(photo.pixels(truth.to_enu(ends)))
    along = (last - first) / np.linalg.norm(last - first)
    first, last = (point + shift_px * np.array([-along[1], along[0]]) for point in (first, last))
    width_px = BRACE_WIDTH_M / WIDTH_M * grid.columns[0].width_px
    return InclinedLine(tuple(first.tolist()), tuple(last.tolist()), width_px, SIGMA_PX, 0.95)


def solved(curvature: float = 0.0, seed: int = 0, shown_by: Sequence[int] = (0, 1, 2)) -> SolvedFacade:
    rng = np.random.default_rng(seed)
    truth = surface(curvature, lean_rad=0.0)
    of_fit = np.diag([1e-3, 1e-5, 1e-5, 1e-5, 1e-6][: 5 if curvature else 3]) ** 2
    true = [looking_at(truth, 22.0, aside, above) for aside, above in PLACES]
    told = [stated(photo, RTK, rng) for photo in true]
    grids = {}
    for i, (photo, other) in enumerate(zip(true, told, strict=True)):
        grid = found_grid(photo, other, truth, truth, SIGMA_PX, rng)
        line = seen_line(grid, photo, truth, BRACE, rng.normal(0.0, SIGMA_PX))
        grids[i] = replace(grid, inclined=(line,)) if i in shown_by else grid
    return solve_facade("A", told, grids, SurfaceFit(truth, of_fit, 0.05, 1000))


def true_pieces(row: int, column: int) -> list[Array]:
    """Pieces of a cell on both sides of the brace, s and t."""
    (s0, s1), (t0, t1) = COLUMNS[column : column + 2], ROWS[row : row + 2]
    half = WIDTH_M / 2
    box = np.array([(s0 + half, t0 + half), (s1 - half, t0 + half), (s1 - half, t1 - half), (s0 + half, t1 - half)])
    along = (BRACE[1] - BRACE[0]) / np.linalg.norm(BRACE[1] - BRACE[0])
    off = (box - BRACE[0]) @ np.array([-along[1], along[0]])
    return [clipped(box, side * off - BRACE_WIDTH_M / 2) for side in (1.0, -1.0)]


@pytest.mark.few(1)
@pytest.mark.parametrize("curvature", [0.0, 0.02])
def test_pieces_lie_where_they_are_within_the_error_of_the_poses(curvature: float) -> None:
    facade = solved(curvature)
    truth = surface(curvature, lean_rad=0.0)
    (line,) = facade.inclined
    assert line.n_photos == 3
    assert line.width_m == pytest.approx(BRACE_WIDTH_M, rel=0.05)
    cut = [panel for panel in facade.panels if panel.id[-1].isalpha()]
    assert len(cut) > 10
    for panel in cut:
        outline = panel.corners_enu_m if panel.outline_enu_m is None else panel.outline_enu_m
        found = truth.to_surface(outline)
        pieces = [piece for piece in true_pieces(panel.row, panel.column) if len(piece) > 2]
        nearest = min(pieces, key=lambda piece: float(np.linalg.norm(piece.mean(axis=0) - found.mean(axis=0))))
        assert area(found) == pytest.approx(area(nearest), rel=0.1, abs=0.02)
        assert np.linalg.norm(found.mean(axis=0) - nearest.mean(axis=0)) < 0.2


def test_corners_on_the_brace_are_less_sure_along_it_than_those_of_the_grid() -> None:
    facade = solved()
    sigmas = {panel.id: np.sqrt(np.trace(panel.covariance_m2, axis1=1, axis2=2)) for panel in facade.panels}
    whole = np.median([sigma for name, sigma in sigmas.items() if not name[-1].isalpha()])
    cut = np.median([sigma.max() for name, sigma in sigmas.items() if name[-1].isalpha()])
    assert whole < cut < 1.5 * whole
    assert all(np.linalg.eigvalsh(panel.covariance_m2).min() > -1e-12 for panel in facade.panels)


@pytest.mark.slow
def test_the_brace_lies_within_its_own_error_against_the_grid() -> None:
    errors = []
    along = (BRACE[1] - BRACE[0]) / np.linalg.norm(BRACE[1] - BRACE[0])
    across = np.array([-along[1], along[0]])
    for seed in range(8):
        facade = solved(seed=seed)
        (line,) = facade.inclined
        of_grid = [
            np.mean([one.position_m for one in lines] - true)
            for lines, true in ((facade.columns, COLUMNS), (facade.rows, ROWS))
        ]
        of_line = -line.cut().signed(BRACE.mean(axis=0)[None])[0]
        errors.append((of_line - of_grid @ across) / line.sigma_m)
    assert 0.5 < np.sqrt(np.mean(np.square(errors))) < 1.5


@pytest.mark.slow
def test_a_line_that_one_of_three_photos_shows_is_outvoted_and_one_of_two_stays() -> None:
    assert solved(shown_by=(1,)).inclined == ()
    (line,) = solved(shown_by=(0, 2)).inclined
    assert line.n_photos == 2


def test_a_site_takes_all_pieces_and_those_with_five_corners_are_told() -> None:
    facade = solved()
    ids = [panel.id for panel in site_facade(facade).panels]
    assert len(set(ids)) == len(ids) == len(facade.panels)
    n_corners = [4 if panel.outline_enu_m is None else len(panel.outline_enu_m) for panel in facade.panels]
    assert {3, 4, 5} <= set(n_corners)
    (finding,) = reduced_panels(facade)
    assert finding.severity is Severity.NOTE
    assert finding.value == sum(n > 4 for n in n_corners)
    for panel in facade.panels:
        a, b, c, d = panel.corners_enu_m
        assert np.cross(c - a, d - b) @ facade.surface.normal_enu > 0.0
