"""The camera preview: its geometry against the pinhole model, its flight in time, and how it is used."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.gui.camera_preview.flight import camera_flight, covered_by_view, nearest_covered, site_sight
from groundstation.gui.camera_preview.photo_box import horizon_px
from groundstation.gui.view3d.orbit import photo_pinhole
from groundstation.services.units import UnitSystem
from planning.aircraft.catalogue import profiles
from planning.coverage.model import exact_sections
from planning.coverage.sections import NOT_SEEN
from planning.geo.frames import camera_axes, heading_difference_rad
from planning.parameters import Constraints, FlightRules
from planning.plan import Coverage, Plan, Sortie, Viewpoint, viewpoint_arrays
from planning.site.bundled import canyon, office
from planning.site.free_space import free_space
from planning.viewpoints.prepare import coverage_model

PROFILE = profiles()["m3e"]
CAMERA = PROFILE.camera


def made_plan(poses, occlusion="off", rules=FlightRules(), home=(0.0, -45.0, 3.0)):
    """A plan of views in one sortie, from (position, heading_deg, pitch_deg)."""
    views = tuple(Viewpoint(f"v{i:04d}", tuple(p), h, g) for i, (p, h, g) in enumerate(poses))
    path = (home, *(view.position_enu_m for view in views), home)
    sortie = Sortie(tuple(view.id for view in views), path, 1.0, 1.0)
    constraints = Constraints(occlusion=occlusion)
    return Plan(
        "s", "", "greedy", 0, CAMERA, PROFILE.aircraft, constraints, views, (sortie,), Coverage(0, 0, 0), rules=rules
    )


POSES = (
    ((0.0, -20.0, 20.0), 0.0, 0.0),
    ((10.0, -18.0, 30.0), -30.0, -20.0),
    ((-12.0, -14.0, 15.0), 25.0, 25.0),
    ((-5.0, -30.0, 60.0), 170.0, -89.0),
    ((5.0, -30.0, 40.0), -170.0, 0.0),
)


@pytest.fixture
def preview(application):
    from groundstation.gui.camera_preview import CameraPreview

    preview = CameraPreview()
    preview.resize(1000, 700)
    preview.show()
    QTest.qWaitForWindowExposed(preview)
    yield preview
    preview.close_view()
    preview.deleteLater()
    application.processEvents()


def photo(application, preview):
    for _ in range(4):
        application.processEvents()
    return preview.picture().astype(int)


@pytest.mark.slow
def test_panel_corners_are_rendered_within_a_pixel_of_where_the_camera_model_projects_them(application, preview):
    model = office()
    plan = made_plan(POSES[:3])
    panels = np.array([panel.corners_enu_m for panel in model.site.panels])
    for viewpoint in plan.viewpoints:
        n_found = 0
        for chosen in (47, 105, 150, 170, 210):
            covered = np.zeros(len(panels), bool)
            covered[chosen] = True
            preview.set_view(model, plan, viewpoint.id, covered)
            shown = photo(application, preview)
            height, width = shown.shape[:2]
            expected = projected(panels[chosen], viewpoint, width, height)
            is_inside = (expected > 3.0).all() and (expected < np.array([width, height]) - 3.0).all()
            if not is_inside:
                continue
            n_found += 1
            # The chosen panel alone is outlined brightly, 2 px wide: its outer border is a pixel outside the corners.
            bright = (shown[:, :, 0] > 170) & (shown[:, :, 2] < 90)
            rows, columns = np.nonzero(bright)
            found = np.array([columns.min(), columns.max() + 1, rows.min(), rows.max() + 1], float)
            wanted = [*np.sort(expected[:, 0])[[0, -1]], *np.sort(expected[:, 1])[[0, -1]]]
            assert found - wanted == pytest.approx([-1.0, 1.0, -1.0, 1.0], abs=1.5), (viewpoint.id, chosen)
        assert n_found >= 1, viewpoint.id


def projected(points, viewpoint, width, height):
    """Pixels by the contract's words, written out: no code shared with the view."""
    heading, pitch = math.radians(viewpoint.heading_deg), math.radians(viewpoint.gimbal_pitch_deg)
    forward, right, up = camera_axes(heading, pitch)
    v = points - np.array(viewpoint.position_enu_m)
    depth = v @ forward
    x = (v @ right) / depth * CAMERA.focal_length_mm / CAMERA.sensor_width_mm * width + width / 2
    y = height / 2 - (v @ up) / depth * CAMERA.focal_length_mm / CAMERA.sensor_height_mm * height
    return np.stack([x, y], axis=1)


@pytest.mark.slow
def test_the_picture_has_the_aspect_ratio_of_the_sensor_whatever_the_window(application, preview):
    preview.set_view(office(), made_plan(POSES), "v0000")
    for size in ((1000, 700), (400, 700), (1200, 300)):
        preview.resize(*size)
        height, width = photo(application, preview).shape[:2]
        assert width / height == pytest.approx(CAMERA.sensor_width_mm / CAMERA.sensor_height_mm, abs=1.5 / height)


def test_east_is_on_the_right_of_a_photo_to_the_north(application, preview):
    model = office()
    preview.set_view(model, made_plan((((0.0, -40.0, 20.0), 0.0, 0.0),)), "v0000")
    centroids = np.array([panel.corners_enu_m for panel in model.site.panels]).mean(axis=1)
    pixels, _ = preview.pinhole().project(centroids)
    assert np.corrcoef(pixels[:, 0], centroids[:, 0])[0, 1] > 0.99
    assert np.corrcoef(pixels[:, 1], centroids[:, 2])[0, 1] < -0.99


@pytest.mark.parametrize(("make", "occlusion"), [(office, "off"), (canyon, "on")])
def test_the_covered_panels_are_those_of_the_coverage_model(make, occlusion):
    model = make()
    poses = [*POSES[:3], ((0.0, -60.0, 20.0), 0.0, 0.0), ((30.0, -45.0, 38.0), -30.0, -10.0)]
    plan = made_plan(poses, occlusion)
    exact = coverage_model(model, free_space(model, 1.0), CAMERA, plan.constraints)
    wanted = exact_sections(exact, viewpoint_arrays(plan.viewpoints)) != NOT_SEEN
    sight = site_sight(model)
    for viewpoint, row in zip(plan.viewpoints, wanted, strict=True):
        assert (covered_by_view(sight, plan, viewpoint_arrays((viewpoint,))) == row).all()
    assert 0 < wanted.sum() < wanted.size


def test_figures_of_the_nearest_panel_are_distance_sampling_and_angle():
    model = office()
    sight = site_sight(model)
    plan = made_plan(POSES)
    eye = sight.frames.centroids[100] + np.array([0.0, -12.0, 12.0])
    chosen = np.zeros(280, bool)
    chosen[100] = True
    nearest = nearest_covered(sight, plan, eye, chosen)
    assert nearest.distance_m == pytest.approx(12.0 * math.sqrt(2.0))
    assert nearest.incidence_deg == pytest.approx(45.0)
    assert nearest.sampling_m == pytest.approx(nearest.distance_m * 17.3 / 12.29 / 5280)
    assert nearest_covered(sight, plan, eye, np.zeros(280, bool)) is None


@given(st.floats(-math.pi, math.pi), st.floats(-1.5, 0.6))
def test_the_horizon_is_where_far_points_at_eye_level_are(heading, pitch):
    eye = np.array([1.0, 2.0, 30.0])
    view = photo_pinhole(eye, heading, pitch, CAMERA, 800.0)
    far = eye + 1e6 * np.array([math.sin(heading), math.cos(heading), 0.0])
    (_, y), depth = view.project(far)
    if depth > 0.0:
        assert horizon_px(view) == pytest.approx(y, rel=1e-6, abs=1e-3)


def test_a_camera_that_looks_straight_down_has_no_horizon():
    assert horizon_px(photo_pinhole(np.zeros(3), 0.0, -math.pi / 2, CAMERA, 800.0)) > 800.0


@pytest.mark.few(1)
@pytest.mark.parametrize("turn_in_flight", [False, True])
def test_the_flight_shows_every_photo_in_its_own_pose_and_moves_no_faster_than_it_may(turn_in_flight):
    plan = made_plan(POSES, rules=FlightRules(turn_in_flight=turn_in_flight))
    flight = camera_flight(plan, plan.sorties[0])
    assert flight.profile.photo_ids == tuple(view.id for view in plan.viewpoints)
    for time_s, viewpoint in zip(flight.profile.photo_s, plan.viewpoints, strict=True):
        position, heading, pitch = flight.pose_at(float(time_s))
        assert position == pytest.approx(viewpoint.position_enu_m, abs=1e-6)
        assert float(heading_difference_rad(heading, math.radians(viewpoint.heading_deg))) == pytest.approx(0, abs=1e-9)
        assert pitch == pytest.approx(math.radians(viewpoint.gimbal_pitch_deg))
    times = np.linspace(-1.0, flight.duration_s + 1.0, 2000)
    poses = [flight.pose_at(float(t)) for t in times]
    step = times[1] - times[0]
    speed = np.linalg.norm(np.diff([pose.position_enu_m for pose in poses], axis=0), axis=1) / step
    assert speed.max() <= PROFILE.aircraft.max_speed_m_s + 1e-6
    headings = np.array([pose.heading_rad for pose in poses])
    turned = np.abs(heading_difference_rad(headings[:-1], headings[1:]))
    assert turned.max() / step <= math.radians(PROFILE.aircraft.max_yaw_rate_deg_s) * 1.02
    assert turned.sum() <= math.radians(30 + 55 + 145 + 20) + 1e-6, "headings take the short way"


def test_photos_between_two_times_are_told_once_each():
    plan = made_plan(POSES)
    flight = camera_flight(plan, plan.sorties[0])
    borders = np.linspace(-1.0, flight.duration_s + 1.0, 97)
    told = [name for a, b in itertools.pairwise(borders) for name in flight.photos_between(a, b)]
    assert told == [view.id for view in plan.viewpoints]
    assert flight.latest_photo(-1.0) is None
    assert flight.latest_photo(1e9) == plan.viewpoints[-1].id


def test_playing_shows_the_photos_in_turn_and_stops_at_the_end(application, preview):
    plan = made_plan(POSES[:3])
    preview.set_view(office(), plan, "v0001")
    assert preview.viewpoint_id() == "v0001"
    assert preview.time_s() > 0.0, "the slider stands at the photo"
    shown = []
    preview.viewpointShown.connect(shown.append)
    preview.set_time(0.0)
    preview.play(20)
    assert preview.is_playing()
    for _ in range(2000):
        preview.advance(0.04)
        if not preview.is_playing():
            break
    assert shown == ["v0000", "v0001", "v0002"]
    assert not preview.is_playing()
    preview.play(1)
    assert preview.time_s() == 0.0, "it starts again"
    preview.hide()
    assert not preview.is_playing()


def test_the_picture_changes_on_the_way_and_flashes_at_a_photo(application, preview):
    plan = made_plan(POSES[:3])
    preview.set_view(office(), plan, "v0000")
    preview.set_time(preview.time_s() - 0.01)
    assert not preview._frame.overlay._is_flashing
    first = photo(application, preview)
    preview.advance(0.02)
    assert preview._frame.overlay._is_flashing
    preview.set_time(preview.time_s() + 8.0)
    assert np.count_nonzero((photo(application, preview) != first).any(axis=2)) > 5000


def test_the_space_bar_and_the_slider_control_the_flight(application, preview):
    preview.set_view(office(), made_plan(POSES[:3]), "v0000")
    preview._play.setFocus()
    QTest.keyClick(preview._play, Qt.Key.Key_Space)
    assert preview.is_playing()
    preview.pause()
    preview._slider.setValue(150)
    assert preview.time_s() == pytest.approx(15.0)


def test_without_a_plan_or_a_site_it_says_so_and_cannot_be_played(application, preview):
    preview.set_view(None, None)
    assert "No plan yet" in preview._frame.overlay._text
    assert not preview._play.isEnabled()
    preview.set_view(office(), None)
    preview.set_view(office(), made_plan(POSES[:1]), "not there")
    assert preview.viewpoint_id() == "v0000"
    preview.set_view(office(), replace(made_plan(POSES[:1]), viewpoints=(), sorties=()))
    assert preview.viewpoint_id() == ""
    photo(application, preview)


def test_a_sortie_that_cannot_be_timed_shows_its_photos_and_says_why_it_is_not_flown(application, preview):
    plan = made_plan(POSES[:2])
    astray = replace(plan.sorties[0], path_enu_m=((0.0, 0.0, 90.0), (1.0, 0.0, 90.0)))
    preview.set_view(office(), replace(plan, sorties=(astray,)), "v0001")
    assert preview.viewpoint_id() == "v0001"
    assert not preview._play.isEnabled()
    assert "misses one of its viewpoints" in preview._clock_text.text()
    windy = replace(plan, rules=FlightRules(wind_m_s=50.0))
    preview.set_view(office(), windy, "v0001")
    assert "wind" in preview._clock_text.text()


def test_figures_follow_the_units(application, preview):
    preview.set_view(office(), made_plan(POSES), "v0000")
    assert " m away" in preview._frame.overlay._text
    preview.set_units(UnitSystem.IMPERIAL)
    assert " ft away" in preview._frame.overlay._text


def test_what_photos_need_makes_no_window_higher(application, preview):
    low, closed = preview.minimumSizeHint().height(), preview.box.sizeHint().height()
    preview.box.setValue(True)
    photo(application, preview)
    # Light and effects need room, and scroll where the window has none.
    assert preview.box.sizeHint().height() > closed
    assert preview.minimumSizeHint().height() == low
    # What does not fit beside the picture is reached by scrolling.
    preview.resize(600, low)
    for _ in range(4):
        application.processEvents()
    assert preview.box.height() >= preview.box.minimumSizeHint().height()
