"""Coverage of photos: the plan's own where the cameras are as planned, and what roll, distortion and gaps change."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.coverage.evaluate import coverage_counts
from planning.coverage.model import CoverageModel, exact_sections
from planning.coverage.sections import NOT_SEEN, SectionGrid, panel_frames
from planning.geo.bvh import line_of_sight
from planning.geo.mesh import box_mesh, empty_mesh
from planning.plan import Viewpoint, viewpoint_arrays
from planning.site.records import panel_corners
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.photos.coverage import achieved_coverage, distances_m, distances_to_building_m, photo_sections
from tests.planning.plan_cases import kiosk, solid_triangles

CAMERA = profile("m3e").camera
SITE = kiosk()
PANELS = [panel.id for panel in SITE.site.panels]


def model(**options):
    return CoverageModel(panel_frames(panel_corners(SITE.site)), CAMERA, SectionGrid(30.0), **options)


def views(n=40, seed=0):
    rng = np.random.default_rng(seed)
    return [
        Viewpoint(
            f"v{i}",
            tuple(rng.uniform((-20.0, -25.0, 2.0), (25.0, 12.0, 15.0)).tolist()),
            float(rng.uniform(-180.0, 180.0)),
            float(rng.uniform(-60.0, 30.0)),
        )
        for i in range(n)
    ]


def photo(view, roll=0.0, lens=None):
    pose = Pose.looking(np.array(view.position_enu_m), view.heading_deg, view.gimbal_pitch_deg, roll)
    return PosedPhoto(f"{view.id}.jpg", Path("x.jpg"), lens or Intrinsics.of(CAMERA), pose)


@pytest.mark.few(1)
@pytest.mark.parametrize("options", [{}, {"whole_panel": True}, {"max_distance_m": 20.0}, {"sight": True}])
def test_photos_taken_as_planned_show_what_the_plan_counts(options):
    if "sight" in options:
        options = {"sight": line_of_sight(solid_triangles(SITE))}
    wanted = views(400)
    found = photo_sections(model(**options), [photo(view) for view in wanted])
    expected = exact_sections(model(**options), viewpoint_arrays(tuple(wanted)))
    assert (expected != NOT_SEEN).sum() > 50
    np.testing.assert_array_equal(found, expected)


def test_the_plan_is_reached_by_its_own_photos_and_missed_without_some():
    wanted = views(200)
    whole = achieved_coverage(model(), [photo(view) for view in wanted], wanted, PANELS)
    np.testing.assert_array_equal(whole.counts, coverage_counts(model(), wanted))
    assert not whole.missed.any()
    assert [finding.code for finding in whole.findings] == ["sections-missed"]
    assert whole.findings[0].severity == "ok"
    part = achieved_coverage(model(), [photo(view) for view in wanted[:5]], wanted, PANELS)
    assert part.missed.sum() == (whole.counts > 0).sum() - part.covered
    messages = [finding.message for finding in part.findings if finding.code == "panel-not-photographed"]
    assert messages == [f"no photo shows panel '{PANELS[index]}'" for index in part.unseen_panels]


def test_without_a_plan_and_without_photos_everything_is_open():
    nothing = achieved_coverage(model(), [])
    assert nothing.covered == 0
    assert len(nothing.unseen_panels) == len(PANELS) == len(nothing.findings)
    assert not nothing.missed.any()


def test_a_rolled_camera_shows_other_panels():
    (view,) = [Viewpoint("a", (0.0, -8.0, 4.5), 0.0, 0.0)]
    upright = (photo_sections(model(), [photo(view)]) != NOT_SEEN).sum()
    quarter = (photo_sections(model(), [photo(view, roll=90.0)]) != NOT_SEEN).sum()
    slightly = (photo_sections(model(), [photo(view, roll=1.0)]) != NOT_SEEN).sum()
    narrow = replace(CAMERA, sensor_height_mm=2.0)
    banner = Intrinsics.of(replace(narrow, image_height_px=609))
    assert slightly == upright
    assert quarter <= upright
    level, upended = ((photo_sections(model(), [photo(view, roll, banner)]) != NOT_SEEN)[0] for roll in (0.0, 90.0))
    assert level.any()
    assert upended.any()
    assert (level != upended).any()


def test_distances_are_to_the_nearest_panel_in_the_picture():
    both = [photo(Viewpoint("a", (0.0, -8.0, 4.5), heading, 0.0)) for heading in (0.0, 180.0)]
    facing, away = distances_m(model(), both)
    assert facing == pytest.approx(8.0, abs=1e-6)
    assert away is None


def test_distance_to_a_building_is_that_straight_ahead():
    building = box_mesh(np.array([-10.0, 0.0, 0.0]), np.array([10.0, 8.0, 30.0]))
    shots = [
        photo(Viewpoint("north", (0.0, -20.0, 10.0), 0.0, 0.0)),
        photo(Viewpoint("aslant", (0.0, -20.0, 25.0), 0.0, -30.0)),
        photo(Viewpoint("south", (0.0, -20.0, 10.0), 180.0, 0.0)),
    ]
    straight, aslant, past = distances_to_building_m(building, shots)
    assert straight == pytest.approx(20.0, abs=1e-4)
    assert aslant == pytest.approx(20.0 / np.cos(np.radians(30.0)), abs=1e-4)
    assert past is None
    assert distances_to_building_m(empty_mesh(), shots) == [None] * 3
    assert distances_to_building_m(building, []) == []
