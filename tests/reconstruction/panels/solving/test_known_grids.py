"""Grids from panels files in the place of a search."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from planning.base.effects import Decision
from planning.base.errors import InputError
from reconstruction.base.cameras import PosedPhoto
from reconstruction.metrics.sets import surface_of
from reconstruction.panels.panels_file import FileCell, FileInclined, FileLine, PanelsFile, panels_record
from reconstruction.panels.rectify.fit import SurfaceFit, ViewKind
from reconstruction.panels.rectify.view import surface_view
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.record import FacadeGrid, GridLine, InclinedLine, Segmentation
from reconstruction.panels.solving.facades import Facade, grid_from_file
from reconstruction.panels.solving.find import FindParameters, find_panels
from reconstruction.scenes.facades.record import SyntheticFacade
from tests.reconstruction.panels.solving.test_find import posed
from tests.reconstruction.synthetic_photos import coarse_model, made_photos
from tests.slow import slow

WIDTH_M = 0.06
NAMES = ("a.jpg", "b.jpg")


@cache
def made(curvature: float = 0.0) -> tuple[SyntheticFacade, ...]:
    return tuple(made_photos(curvature, (0.0, 12.0)))


def named(curvature: float = 0.0) -> list[PosedPhoto]:
    found = posed(list(made(curvature)))
    return [replace(photo, name=name) for photo, name in zip(found, NAMES, strict=True)]


def whole_grid(number: int, curvature: float = 0.0) -> FacadeGrid:
    """The true grid of a synthetic photo."""
    photo = made(curvature)[number]
    view = surface_view(named(curvature)[number], surface_of(photo.case))
    columns = tuple(
        GridLine(float(view.from_surface(np.array([[s, 0.0]]))[0, 0]), WIDTH_M * view.px_per_m) for s in photo.columns_m
    )
    rows = tuple(
        GridLine(float(view.from_surface(np.array([[0.0, t]]))[0, 1]), WIDTH_M * view.px_per_m)
        for t in photo.rows_m[::-1]
    )
    return facade_grid("Z", view, rows, columns)


def recorded(number: int, grid: FacadeGrid) -> PanelsFile:
    lens = made()[number].photo.intrinsics
    return panels_record(Segmentation(NAMES[number], lens.width_px, lens.height_px, (grid,)))


def drawn_by_hand(number: int, curvature: float = 0.0) -> PanelsFile:
    """What a careful hand would write of a synthetic photo."""
    return recorded(number, whole_grid(number, curvature))


def never(photo: PosedPhoto) -> Any:
    raise AssertionError(f"{photo.name} was searched")


def errors_m(found: Any, truth: SyntheticFacade) -> np.ndarray[Any, Any]:
    corners = {(panel.row, panel.column): panel.corners_enu_m for panel in truth.panels}
    assert {(panel.row, panel.column) for panel in found.panels} <= set(corners)
    return np.concatenate([panel.corners_enu_m - corners[panel.row, panel.column] for panel in found.panels])


@pytest.mark.slow
@pytest.mark.parametrize("curvature", [slow(0.0), 0.05])
def test_given_grids_are_used_and_their_photos_not_searched(curvature: float) -> None:
    given = {name: drawn_by_hand(number, curvature) for number, name in enumerate(NAMES)}
    found = find_panels(named(curvature), coarse_model(made(curvature)[0].case.wall), never, known_grids=given)
    (facade,) = found.facades
    assert len(facade.panels) == len(made(curvature)[0].panels)
    assert np.linalg.norm(errors_m(facade, made(curvature)[0]), axis=1).max() < 0.1
    assert [line.width_m for line in facade.columns] == pytest.approx([WIDTH_M] * len(facade.columns), abs=0.01)
    # The hand decides, so that nothing is searched together.
    assert [decision.effect for decision in found.search_decisions["A"]] == ["unrolling by arc length"]


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("curvature", [0.0, 0.05])
@pytest.mark.parametrize("open_side", [-1, 0, 1])
def test_cut_cells_come_back_cut(curvature: float, open_side: int) -> None:
    photo, truth = named(curvature)[0], made(curvature)[0]
    surface = surface_of(truth.case)
    view = surface_view(photo, surface)
    whole = whole_grid(0, curvature)
    low, high = np.array([truth.columns_m[0], truth.rows_m[0]]), np.array([truth.columns_m[-1], truth.rows_m[-1]])
    first, last = view.from_surface(np.array([low, high]))
    brace = InclinedLine(tuple(first), tuple(last), 6.0, 0.2, 0.9, open_side)
    cut = facade_grid("A", view, whole.rows, whole.columns, (brace,))
    record = recorded(0, cut)
    fit = SurfaceFit(surface, 1e-4 * np.eye(5), 0.02, 100)
    facade = Facade(
        fit, low, high, Decision("curvature", bool(curvature), "user", "as made", 1.0, 0.5, "px", 0.0), (0,)
    )
    back = grid_from_file(record, photo, facade, view, "A")
    assert back is not None
    assert [panel.id for panel in back.panels] == [panel.id for panel in cut.panels]
    assert {len(panel.corners_px) for panel in back.panels} > {4}
    for one, other in zip(back.panels, cut.panels, strict=True):
        assert one.corners_px == pytest.approx(other.corners_px, abs=0.3)
    (line,) = back.inclined
    assert line.open_side == open_side
    assert line.width_px == pytest.approx(6.0, abs=0.05)


def test_an_inclined_line_needs_both_edges() -> None:
    with pytest.raises(ValueError, match="two points or more on its left edge and as many on its right one, found 2 "):
        FileInclined(((0.0, 0.0), (1.0, 1.0)), ((0.0, 1.0),))


@pytest.mark.slow
def test_a_corrected_line_and_a_panel_taken_out_arrive_in_3d() -> None:
    given = drawn_by_hand(0)
    (facade,) = given.facades
    fewer = tuple(panel for panel in facade.panels if (panel.row, panel.column) != (1, 2))
    right = facade.vertical_lines[3]
    moved = FileLine(tuple((x + 6.0, y) for x, y in right.points_px), right.confidence)
    lines = (*facade.vertical_lines[:3], moved, *facade.vertical_lines[4:])
    changed = replace(facade, panels=fewer, missing=(FileCell(1, 2),), vertical_lines=lines)
    model = coarse_model(made()[0].case.wall)
    before, after = (
        find_panels(named()[:1], model, never, known_grids={"a.jpg": replace(given, facades=(one,))}).facades[0]
        for one in (facade, changed)
    )
    assert (1, 2) in {(panel.row, panel.column) for panel in before.panels}
    assert (1, 2) not in {(panel.row, panel.column) for panel in after.panels}
    steps = np.array([line.position_m for line in after.columns]) - [line.position_m for line in before.columns]
    assert steps[3] > 0.05
    assert np.abs(np.delete(steps, 3)).max() < 0.02


@pytest.mark.slow
def test_a_file_that_says_nothing_of_a_facade_leaves_the_photo_out() -> None:
    given = drawn_by_hand(0)
    (facade,) = given.facades
    aside = replace(facade, panels=tuple(replace(panel, corners_px=((-3000.0, 0.0), (-2999.0, 0.0), (-3000.0, 1.0)))
                                         for panel in facade.panels))  # fmt: skip
    found = find_panels(
        named(),
        coarse_model(made()[0].case.wall),
        never,
        known_grids={"a.jpg": replace(given, facades=(aside,)), "b.jpg": drawn_by_hand(1)},
    )
    assert {number for _, number in found.grids} == {1}


@pytest.mark.slow
def test_files_of_other_photos_and_sizes_are_refused_in_words() -> None:
    model = coarse_model(made()[0].case.wall)
    with pytest.raises(InputError, match=r"'c\.jpg' are given, which is none of the 2 photos"):
        find_panels(named(), model, never, known_grids={"c.jpg": drawn_by_hand(0)})
    with pytest.raises(InputError, match="for 10 x 720 pixels, but it has 960 x 720"):
        find_panels(named(), model, never, known_grids={"a.jpg": replace(drawn_by_hand(0), width_px=10)})
    (facade,) = drawn_by_hand(0).facades
    bare = replace(facade, vertical_lines=(FileLine(()), *facade.vertical_lines[1:]))
    with pytest.raises(InputError, match=r"vertical_lines\[0\] of a panels file has no point on the facade"):
        find_panels(named(), model, never, known_grids={"a.jpg": replace(drawn_by_hand(0), facades=(bare,))})
    empty = PanelsFile("reflight-panels/1", "a.jpg", 960, 720, drawn_by_hand(0).pixel_convention, ())
    found = find_panels(named(), model, never, known_grids={"a.jpg": empty, "b.jpg": drawn_by_hand(1)})
    assert len(found.facades[0].panels) == len(made()[1].panels)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [slow("exact"), "tangent", slow("polynomial")])
def test_panels_are_found_through_every_view_of_a_round_wall(kind: ViewKind) -> None:
    photos = made(0.05)
    images = {name: photo.image for name, photo in zip(NAMES, photos, strict=True)}
    parameters = FindParameters(view=kind, fuse="off")
    found = find_panels(named(0.05)[:1], coarse_model(photos[0].case.wall), lambda p: images[p.name], parameters)
    (facade,) = found.facades
    assert len(facade.panels) == len(photos[0].panels)
    assert np.linalg.norm(errors_m(facade, photos[0]), axis=1).max() < 0.2
    unrolling = found.search_decisions["A"][0]
    assert (unrolling.on, unrolling.decided_by) == (kind == "exact", "user")
    assert unrolling.size > 5.0


def test_an_unknown_view_is_a_wrong_call() -> None:
    with pytest.raises(ValueError, match="view: expected one of auto, exact, tangent, polynomial"):
        FindParameters(view="round")  # type: ignore[arg-type]
