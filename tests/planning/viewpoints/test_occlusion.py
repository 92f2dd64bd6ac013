"""The occlusion effect decides by itself, and rightly: tested both ways."""

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.base.effects import decide
from planning.coverage.model import CoverageModel, exact_coverage
from planning.coverage.positions import aimed_views, spread_positions
from planning.coverage.sections import SectionGrid, panel_frames
from planning.geo.bvh import line_of_sight
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from planning.site.records import panel_corners
from planning.viewpoints.prepare import Occlusion, OcclusionScene, rises_above_a_panel

CAMERA = profile("m3e").camera


def occlusion_scene(name):
    model = SCENES[name]()
    space = free_space(model, 10.0)
    frames = panel_frames(panel_corners(model.site))
    places = spread_positions(space, frames, 3000, np.random.default_rng(0))
    return OcclusionScene(frames, space.solids.bvh.corners, places)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("name", "on"),
    [("office", False), ("library", False), ("roof", False), ("tower", False), ("court", True), ("canyon", True)],
)
def test_occlusion_decides_by_itself_and_the_result_changes_as_it_says(name, on):
    scene = occlusion_scene(name)
    decision = decide(Occlusion(), scene)
    assert decision.on is on
    assert decision.decided_by == "scene"
    rng = np.random.default_rng(7)
    places = scene.places_enu_m[:400]
    views = aimed_views(places, scene.frames.centroids[rng.integers(0, len(scene.frames), len(places))], CAMERA)
    model = CoverageModel(scene.frames, CAMERA, SectionGrid(30.0))
    seeing = CoverageModel(scene.frames, CAMERA, SectionGrid(30.0), sight=line_of_sight(scene.corners_enu_m))
    without, with_it = exact_coverage(model, views), exact_coverage(seeing, views)
    assert (with_it <= without).all()
    lost = 100.0 * (without - with_it).sum() / without.sum()
    if on:
        assert lost > decision.tolerance
    else:
        assert lost <= decision.tolerance


def test_user_overrules_the_scene_and_the_decision_says_so():
    scene = occlusion_scene("office")
    decision = decide(Occlusion(), scene, "on")
    assert (decision.on, decision.decided_by) == (True, "user")
    assert "as you asked" in str(decision)
    assert decision.size == 0.0


def test_skipped_occlusion_does_not_even_load_the_ray_caster(monkeypatch):
    def refuse(_corners):
        raise AssertionError("the ray caster was built for a scene that does not call for it")

    scene = occlusion_scene("library")
    monkeypatch.setattr("planning.geo.bvh.line_of_sight", refuse)
    assert not decide(Occlusion(), scene).on


@pytest.mark.long
def test_estimated_share_agrees_with_a_larger_sample_in_float64():
    scene = occlusion_scene("court")
    space = free_space(SCENES["court"](), 10.0)
    size = decide(Occlusion(), scene).size
    places = spread_positions(space, scene.frames, 8000, np.random.default_rng(99))
    targets = scene.frames.centroids + 0.15 * scene.frames.normals
    rays = places[:, None] - scene.frames.centroids[None]
    place, panel = np.nonzero(np.einsum("nmk,mk->nm", rays, scene.frames.normals) > 0)
    free = space.solids.lines_free(places[place], targets[panel])
    assert size == pytest.approx(100.0 * (~free).mean(), abs=1.0)


def test_mullions_closer_than_the_offset_do_not_count_as_rising_above_the_panel():
    scene = occlusion_scene("office")
    fin = np.array([[[0.0, 0.0, 0.0], [0.0, -0.14, 0.0], [0.0, 0.0, 42.0]]])
    assert not rises_above_a_panel(scene.frames, np.concatenate([scene.corners_enu_m, fin]))
    fin[0, 1, 1] = -0.16
    assert rises_above_a_panel(scene.frames, np.concatenate([scene.corners_enu_m, fin]))
