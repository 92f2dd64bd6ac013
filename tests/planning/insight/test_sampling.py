"""Pixel sizes on panels: by hand, and against a slow twin."""

import math

import numpy as np
import pytest

from planning.coverage.sections import NOT_SEEN, panel_frames
from planning.insight.sections import panel_sampling
from planning.site.bundled import SCENES
from planning.site.records import panel_corners
from tests.planning.insight.cases import CAMERA

FRAMES = panel_frames(panel_corners(SCENES["office"]().site))


def test_facing_a_panel_the_pixel_on_the_pane_is_as_large_as_across_and_at_60_degrees_twice_as_large():
    centre, normal = FRAMES.centroids[5], FRAMES.normals[5]
    oblique = math.cos(math.radians(60.0)) * normal + math.sin(math.radians(60.0)) * FRAMES.tangents[5]
    positions = np.stack([centre + 20.0 * normal, centre + 15.0 * oblique])
    sections = np.full((2, len(FRAMES)), NOT_SEEN, np.int16)
    sections[:, 5] = 0
    found = panel_sampling(FRAMES, CAMERA, positions, sections)
    # DJI M3E: 17.3 mm over 5280 pixels at 12.29 mm.
    pixel = 17.3 / 5280 / 12.29
    assert found.best_m[5] == pytest.approx(15.0 * pixel)
    assert found.worst_m[5] == pytest.approx(20.0 * pixel)
    assert found.best_on_pane_m[5] == pytest.approx(20.0 * pixel)
    assert found.worst_on_pane_m[5] == pytest.approx(30.0 * pixel)
    others = np.delete(np.arange(len(FRAMES)), 5)
    for values in (found.best_m, found.worst_m, found.best_on_pane_m, found.worst_on_pane_m):
        assert np.isnan(values[others]).all()


def test_sampling_of_many_views_is_that_of_a_slow_twin():
    rng = np.random.default_rng(0)
    positions = rng.uniform([-40.0, -60.0, 3.0], [40.0, -1e-9, 60.0], (30, 3))
    sections = np.where(rng.random((30, len(FRAMES))) < 0.4, 1, NOT_SEEN)
    found = panel_sampling(FRAMES, CAMERA, positions, sections)
    for panel in range(0, len(FRAMES), 17):
        across, on_pane = [], []
        for view in np.flatnonzero(sections[:, panel] >= 0):
            ray = positions[view] - FRAMES.centroids[panel]
            distance = math.dist(positions[view], FRAMES.centroids[panel])
            across.append(CAMERA.gsd_m(distance))
            on_pane.append(CAMERA.gsd_m(distance) / (ray @ FRAMES.normals[panel] / distance))
        assert found.best_m[panel] == pytest.approx(min(across), rel=1e-12)
        assert found.worst_m[panel] == pytest.approx(max(across), rel=1e-12)
        assert found.best_on_pane_m[panel] == pytest.approx(min(on_pane), rel=1e-9)
        assert found.worst_on_pane_m[panel] == pytest.approx(max(on_pane), rel=1e-9)


def test_a_view_that_grazes_the_pane_gives_a_large_but_finite_pixel():
    grazing = FRAMES.centroids[:1] + 20.0 * FRAMES.tangents[:1] + 1e-14 * FRAMES.normals[:1]
    sections = np.full((1, len(FRAMES)), NOT_SEEN)
    sections[0, 0] = 24
    found = panel_sampling(FRAMES, CAMERA, grazing, sections)
    assert np.isfinite(found.worst_on_pane_m[0])
    assert found.worst_on_pane_m[0] > 1e6 * found.worst_m[0]


def test_without_views_nothing_is_known():
    found = panel_sampling(FRAMES, CAMERA, np.zeros((0, 3)), np.zeros((0, len(FRAMES)), np.int16))
    assert np.isnan(found.best_m).all()
    assert np.isnan(found.worst_on_pane_m).all()


def test_some_panels_have_what_they_have_among_all():
    rng = np.random.default_rng(1)
    positions = rng.uniform([-40.0, -60.0, 3.0], [40.0, -1e-9, 60.0], (20, 3))
    sections = np.where(rng.random((20, len(FRAMES))) < 0.2, 3, NOT_SEEN)
    panels = np.array([7, 3, 120])
    all_of_them, some = (panel_sampling(FRAMES, CAMERA, positions, sections, which) for which in (None, panels))
    for name in ("best_m", "worst_m", "best_on_pane_m", "worst_on_pane_m"):
        np.testing.assert_array_equal(getattr(some, name), getattr(all_of_them, name)[panels])
