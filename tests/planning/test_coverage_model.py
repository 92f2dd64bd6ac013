"""The fast kernel against the definition, in both precisions and for every step."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.coverage.model import CoverageModel, codes_all_around, exact_coverage, exact_sections
from planning.coverage.positions import aimed_views
from planning.coverage.sections import NOT_SEEN, SectionGrid, panel_frames, sections_of
from planning.plan import ViewpointArrays
from planning.site.bundled import SCENES
from planning.site.records import panel_corners

CAMERA = profile("m3e").camera
STEPS = (90.0, 45.0, 30.0, 22.5, 18.0, 15.0, 10.0, 9.0, 5.0)


def frames_of(scene):
    return panel_frames(panel_corners(SCENES[scene]().site))


def random_views(frames, n, seed=0):
    rng = np.random.default_rng(seed)
    positions = rng.uniform([-60, -70, 3], [60, 40, 75], (n, 3))
    return aimed_views(positions, frames.centroids[rng.integers(0, len(frames), n)], CAMERA)


def degrees_from_border(views, frames, step):
    """Angle of each pair to the nearest section border, degrees."""
    rays = views.positions_enu_m[:, None] - frames.centroids[None]
    d = rays / np.linalg.norm(rays, axis=2, keepdims=True)
    theta = np.degrees(np.arccos(np.clip((d * frames.normals).sum(2), -1, 1)))
    phi = np.degrees(np.arctan2((d * frames.bitangents).sum(2), (d * frames.tangents).sum(2)))
    gaps = [np.abs(x / step - np.round(x / step)) * step for x in (theta, phi)]
    return np.minimum(gaps[0], gaps[1] * np.sin(np.radians(theta)))


@pytest.mark.few(5)
@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("scene", ["office", "library", "roof"])
def test_float64_kernel_equals_the_definition(scene, step):
    frames = frames_of(scene)
    views = random_views(frames, 400)
    model = CoverageModel(frames, CAMERA, SectionGrid(step), precision="f64")
    expected = exact_sections(model, views)
    got = codes_all_around(model, views.positions_enu_m).T.astype(np.int64) - 1
    in_front = sections_of(views.positions_enu_m, frames, model.grid)
    assert (got == in_front).mean() > 0.999999
    found = model.elements(views)
    counts = np.bincount(found.items, minlength=model.n_elements)
    np.testing.assert_array_equal(counts, exact_coverage(model, views).ravel())
    assert len(found.items) == (expected != NOT_SEEN).sum()


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("step", STEPS)
def test_float32_kernel_differs_only_within_a_thousandth_of_a_degree_of_a_border(step):
    frames = frames_of("library")
    views = random_views(frames, 1500, seed=1)
    single = CoverageModel(frames, CAMERA, SectionGrid(step))
    got = codes_all_around(single, views.positions_enu_m).T.astype(np.int64) - 1
    expected = sections_of(views.positions_enu_m, frames, single.grid)
    differs = got != expected
    assert differs.mean() < 1e-4
    on_panel_plane = np.abs(((views.positions_enu_m[:, None] - frames.centroids) * frames.normals).sum(2)) < 1e-3
    assert (degrees_from_border(views, frames, step)[differs & ~on_panel_plane] < 1e-3).all()


@given(
    offset=st.tuples(*[st.sampled_from([-20.0, -11.547005383792516, -1.0, 0.0, 1.0, 11.547005383792516, 20.0])] * 3),
    step=st.sampled_from(STEPS),
)
def test_views_on_section_borders_at_the_pole_and_on_the_plane_agree_in_float64(offset, step):
    frames = panel_frames(np.array([[[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]]))
    model = CoverageModel(frames, CAMERA, SectionGrid(step), precision="f64")
    point = np.array([offset])
    got = int(codes_all_around(model, point)[0, 0]) - 1
    expected = int(sections_of(point, frames, model.grid)[0, 0])
    # tan(30 deg) and cos^2 round either way on an exact border; both neighbours are then the definition's own error.
    if got != expected:
        views = ViewpointArrays(point, np.zeros(1), np.zeros(1))
        assert degrees_from_border(views, frames, step)[0, 0] < 1e-9


def test_view_at_the_pole_lies_in_the_first_section_in_both_precisions():
    frames = panel_frames(np.array([[[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]]))
    for precision in ("f32", "f64"):
        model = CoverageModel(frames, CAMERA, SectionGrid(30.0), precision=precision)
        assert codes_all_around(model, np.array([[0.0, -12.0, 0.0]]))[0, 0] == 1


def test_nan_positions_cover_nothing():
    frames = frames_of("office")
    views = ViewpointArrays(np.array([[np.nan, -20.0, 10.0], [0.0, np.inf, 10.0]]), np.zeros(2), np.zeros(2))
    for precision in ("f32", "f64"):
        model = CoverageModel(frames, CAMERA, SectionGrid(30.0), precision=precision)
        assert len(model.elements(views).items) == 0
        assert model.covered_count(views) == 0


def test_coverage_does_not_depend_on_where_the_local_frame_lies():
    frames = frames_of("library")
    views = random_views(frames, 500)
    far = np.array([15_000.0, -12_000.0, 300.0])
    moved = panel_frames(frames.corners + far)
    moved_views = ViewpointArrays(views.positions_enu_m + far, views.heading_rad, views.pitch_rad)
    here = CoverageModel(frames, CAMERA, SectionGrid(30.0)).covered_count(views)
    there = CoverageModel(moved, CAMERA, SectionGrid(30.0)).covered_count(moved_views)
    assert abs(here - there) <= 2


@pytest.mark.long
@pytest.mark.parametrize("options", [{"whole_panel": True}, {"max_distance_m": 30.0}, {}])
def test_elements_covered_and_counts_agree_with_each_other(options):
    frames = frames_of("office")
    views = random_views(frames, 700)
    model = CoverageModel(frames, CAMERA, SectionGrid(30.0), precision="f64", **options)
    exact = exact_coverage(model, views)
    assert model.covered_count(views) == np.count_nonzero(exact)
    np.testing.assert_array_equal(model.covered(views), exact.ravel() > 0)


def test_elements_are_the_same_for_any_number_of_threads(monkeypatch):
    frames = frames_of("office")
    views = random_views(frames, 5000)
    model = CoverageModel(frames, CAMERA, SectionGrid(30.0))
    several = model.elements(views)
    monkeypatch.setattr("planning.base.jit.n_threads", lambda: 1)
    one = model.elements(views)
    np.testing.assert_array_equal(several.starts, one.starts)
    np.testing.assert_array_equal(several.items, one.items)


def test_no_views_and_one_panel_are_fine():
    frames = frames_of("single-panel")
    model = CoverageModel(frames, CAMERA, SectionGrid(30.0))
    none = ViewpointArrays(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    assert model.covered_count(none) == 0
    assert model.elements(none).starts.tolist() == [0]
    assert model.covered_count(random_views(frames, 200)) > 0
