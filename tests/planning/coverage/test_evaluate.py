"""What views cover, how often and how finely, against the contract's own words."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.coverage.evaluate import coverage, coverage_counts, depth, sights
from planning.coverage.model import CoverageModel
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.reachability import Reachability
from planning.coverage.sections import SectionGrid, panel_frames
from planning.geo.bvh import line_of_sight
from planning.plan import Viewpoint
from planning.site.records import panel_corners
from tests.planning.plan_cases import kiosk, seen_by_contract, solid_triangles

CAMERA = profile("m3e").camera


@functools.cache
def model(step_deg: float = 30.0, occlusion: bool = False, max_distance_m: float | None = None) -> CoverageModel:
    sight = line_of_sight(solid_triangles(kiosk())) if occlusion else None
    frames = panel_frames(panel_corners(kiosk().site))
    return CoverageModel(frames, CAMERA, SectionGrid(step_deg), max_distance_m=max_distance_m, sight=sight)


@functools.cache
def viewpoints(n: int = 60) -> tuple[Viewpoint, ...]:
    rng = np.random.default_rng(1)
    positions = rng.uniform([-30, -35, 3], [35, 0, 30], (n, 3))
    to_middle = np.array([0.0, 2.0, 4.5]) - positions
    heading = np.degrees(np.arctan2(to_middle[:, 0], to_middle[:, 1])) + rng.normal(size=n) * 10.0
    pitch = np.degrees(np.arctan2(to_middle[:, 2], np.hypot(*to_middle[:, :2].T)))
    return tuple(
        Viewpoint(f"v{i:04d}", tuple(map(float, positions[i])), float(heading[i]), float(pitch[i]))  # type: ignore[arg-type]
        for i in range(n)
    )


@pytest.mark.few(2)
@pytest.mark.parametrize("occlusion", [False, True])
@pytest.mark.parametrize("step_deg", [30.0, 15.0, 90.0])
def test_counts_are_those_of_the_contract(step_deg: float, occlusion: bool) -> None:
    counts = coverage_counts(model(step_deg, occlusion), viewpoints())
    seen = seen_by_contract(kiosk(), CAMERA, viewpoints(), step_deg, occlusion)
    found = {(int(j), int(k)): int(counts[j, k]) for j, k in zip(*np.nonzero(counts), strict=True)}
    assert found == dict(seen)
    for count in depth(model(step_deg, occlusion), counts):
        assert count.covered == sum(times >= count.n_views for times in seen.values())
        assert (count.step_deg, count.total) == (step_deg, counts.size)


def test_bound_holds_even_for_viewpoints_that_break_the_rules_it_rests_on() -> None:
    shape = (len(model().frames), model().grid.n_sections)
    nothing = Reachability(np.full(shape, UNREACHABLE, np.int8), np.full((*shape, 3), np.nan), 0.0)
    measured = coverage(model(), viewpoints(), nothing)
    assert 0 < measured.covered == measured.reachable_upper_bound < measured.total
    everything = Reachability(np.full(shape, REACHABLE, np.int8), np.full((*shape, 3), np.nan), 0.0)
    assert coverage(model(), (), everything).reachable_upper_bound == model().n_elements


def test_a_view_tells_its_nearest_and_furthest_panel() -> None:
    one = Viewpoint("v", (0.0, -12.29, 4.5), 0.0, 0.0)  # in front of the middle panel
    narrow = model()
    (seen,) = sights(narrow, (one,))
    furthest = max(np.linalg.norm(np.array([x, 0.0, z]) - one.position_enu_m) for x in (-4, 0, 4) for z in (1.5, 7.5))
    assert seen.furthest_m == pytest.approx(furthest)
    assert seen.nearest_m == pytest.approx(12.29)
    away = Viewpoint("w", (0.0, -12.0, 4.5), 180.0, 0.0)
    assert [sight.nearest_m for sight in sights(narrow, (one, away))] == [pytest.approx(12.29), np.inf]
    (nothing,) = sights(model(max_distance_m=12.0), (one,))
    assert (nothing.nearest_m, nothing.furthest_m, len(nothing.elements)) == (np.inf, 0.0, 0)


def test_no_viewpoints_cover_nothing() -> None:
    assert coverage_counts(model(), ()).sum() == 0
    assert sights(model(), ()) == ()
    assert [count.covered for count in depth(model(), coverage_counts(model(), ()), 2)] == [0, 0]
