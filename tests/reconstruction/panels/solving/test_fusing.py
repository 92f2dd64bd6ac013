"""Photos that do not agree are searched together, and only these."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base.effects import decide
from planning.base.progress import QUIET
from reconstruction.base.cameras import PosedPhoto
from reconstruction.metrics.sets import STATED_POSE, surface_of
from reconstruction.panels.rectify.fit import SurfaceFit, Unrolling, decide_view
from reconstruction.panels.rectify.view import SurfaceView
from reconstruction.panels.search.record import FacadeGrid
from reconstruction.panels.solving.facades import Facade
from reconstruction.panels.solving.find import (
    FindParameters,
    Fusion,
    SearchedFacade,
    SeparateSearch,
    missing_share,
    search_facade,
)
from reconstruction.panels.solving.solve import solve_facade
from reconstruction.scenes.facades.cases import wide_camera
from reconstruction.scenes.facades.record import Disturbances, Layout, SyntheticFacade, Wall
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.panels.solving.test_register import stated
from tests.reconstruction.synthetic_photos import simple_case

LAYOUT = Layout(4, 7, 1.5, 2.2)
LENS = wide_camera(640, 480)


@cache
def photos() -> tuple[SyntheticFacade, ...]:
    plain = Disturbances(reflection=0.3, tilt_deg=0.3, blur_px=0.5, noise_grey=2.0)
    return tuple(
        render_facade(simple_case(LAYOUT, plain, wall=Wall(), intrinsics=LENS, seed=2, oblique_deg=angle))
        for angle in (0.0, 10.0, -10.0)
    )


@cache
def posed() -> tuple[PosedPhoto, ...]:
    found = [stated(made, 0.03, 0.3, number) for number, made in enumerate(photos())]
    return tuple(replace(photo, name=f"{number}.jpg") for number, photo in enumerate(found))


def load(photo: PosedPhoto) -> NDArray[np.uint8]:
    return photos()[int(photo.name[0])].image


@cache
def facade() -> Facade:
    made = photos()[0]
    surface = surface_of(made.case)
    fit = SurfaceFit(surface, np.diag([0.02, 2e-4, 2e-4]) ** 2, 0.05, 1000)
    low = np.array([made.columns_m[0] - 2.0, made.rows_m[0] - 2.0])
    high = np.array([made.columns_m[-1] + 2.0, made.rows_m[-1] + 2.0])
    view = SurfaceView(posed()[0], surface, low, high, 10.0)
    return Facade(fit, low, high, decide(Unrolling(), view), (0, 1, 2))


@cache
def searched(fuse: str) -> SearchedFacade:
    parameters = FindParameters(fuse=fuse)  # type: ignore[arg-type]
    return search_facade(posed(), facade(), "A", load, parameters, {}, QUIET)


def size(grid: FacadeGrid) -> tuple[int, int]:
    return len(grid.rows) - 1, len(grid.columns) - 1


def singly(grids: dict[int, FacadeGrid]) -> SeparateSearch:
    return SeparateSearch(posed(), grids, facade().fit.surface)


def bare(grid: FacadeGrid) -> FacadeGrid:
    return FacadeGrid("A", grid.rectification, (), (), ())


@pytest.mark.slow
def test_photos_that_agree_are_not_searched_together() -> None:
    found = searched("auto")
    fusion = found.decisions[1]
    assert (fusion.effect, fusion.on, fusion.decided_by) == ("photos searched together", False, "scene")
    assert fusion.size < 0.15
    assert found.findings == ()
    assert [size(grid) for grid in found.grids.values()] == [(4, 7)] * 3


@pytest.mark.slow
def test_doubt_grows_with_every_photo_that_shows_no_grid_or_another() -> None:
    grids = searched("auto").grids
    agreed = missing_share(singly(grids))
    one_bare = missing_share(singly({**grids, 0: bare(grids[0])}))
    two_bare = missing_share(singly({**grids, 0: bare(grids[0]), 1: bare(grids[1])}))
    assert agreed < 0.15
    assert one_bare == pytest.approx(agreed + 1 / 3, abs=0.1)
    assert two_bare == pytest.approx(agreed + 2 / 3, abs=0.1)
    assert missing_share(singly({number: bare(grid) for number, grid in grids.items()})) == 1.0
    moved = tuple(replace(line, position_px=line.position_px + 12.0) for line in grids[0].columns)
    inner = replace(grids[0], columns=tuple(sorted((*grids[0].columns, *moved[:-1]), key=lambda one: one.position_px)))
    assert missing_share(singly({**grids, 0: inner})) > agreed + 0.1
    decision = decide(Fusion(), singly({**grids, 0: bare(grids[0])}))
    assert decision.on
    assert "1 of them without a grid" in decision.reason
    assert not decide(Fusion(), singly({0: grids[0]})).on


@pytest.mark.slow
def test_searched_together_every_photo_has_the_lines_and_all_count_as_one_look() -> None:
    together, alone = searched("on"), searched("off")
    assert together.decisions[1].decided_by == "user"
    assert [finding.code for finding in together.findings] == ["photos-together"]
    assert [size(grid) for grid in together.grids.values()] == [(4, 7)] * 3
    fits = [solve_facade("A", posed(), found.grids, facade().fit) for found in (together, alone)]
    truth = {(panel.row, panel.column): panel.corners_enu_m for panel in photos()[0].panels}
    for solved in fits:
        assert {(panel.row, panel.column) for panel in solved.panels} == set(truth)
        errors = [panel.corners_enu_m - truth[panel.row, panel.column] for panel in solved.panels]
        assert np.abs(errors).max() < 4.0 * np.sqrt(STATED_POSE[0, 0] + STATED_POSE[3, 3] * 20.0**2)
    # Three parts of one look make one confidence again, not the three times surer one of independent photos.
    line = fits[0].columns[3]
    part = together.grids[0].columns[3].confidence
    odds = (part / (1.0 - part)) ** 3
    assert line.confidence == pytest.approx(odds / (1.0 + odds), abs=1e-6)


@pytest.mark.slow
def test_photos_without_anything_are_left_as_they_are() -> None:
    found = search_facade(
        posed(), facade(), "A", lambda photo: np.full((480, 640, 3), 99, np.uint8), FindParameters(), {}, QUIET
    )
    assert [finding.code for finding in found.findings] == ["photos-together-in-vain"]
    assert found.decisions[1].on
    assert all(not grid.panels for grid in found.grids.values())


@pytest.mark.long
def test_the_view_is_what_was_asked_for_and_its_size_is_told() -> None:
    flat = SurfaceView(posed()[0], facade().fit.surface, facade().low_st_m, facade().high_st_m, 20.0)
    round_wall = replace(flat, surface=replace(flat.surface, curvature_per_m=0.05))
    assert not decide_view([flat]).on
    told = decide_view([flat, round_wall])
    assert (told.on, told.unit, told.decided_by) == (True, "px", "scene")
    half_m = 0.5 * (flat.high_st_m[0] - flat.low_st_m[0])
    assert told.size == pytest.approx(20.0 * (half_m - np.sin(0.05 * half_m) / 0.05))
    assert (decide_view([flat], "exact").on, decide_view([round_wall], "tangent").on) == (True, False)
