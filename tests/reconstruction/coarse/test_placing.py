"""A made model in a frame of its own, brought back to where it was by what is known of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.geo.geoid import ellipsoid_from_amsl_m
from reconstruction.base.cameras import cam_from_enu
from reconstruction.coarse.build import _above_ground
from reconstruction.coarse.cloud import Cloud, FoundPlane, Up, turn_upright, up_of_cameras, up_of_planes
from reconstruction.coarse.placing import Above, Control, Measured, about_height, contradicts, in_sigmas, place_model
from reconstruction.colmap.georeference import Similarity
from reconstruction.colmap.record import ColmapModel

TRUTH = Similarity(3.7, Rotation.from_euler("zyx", [0.7, 0.4, -1.1]).as_matrix(), np.array([12.0, -5.0, 30.0]))
"""From the model to the local frame."""


def orbit(n=24, radius_m=40.0):
    """Cameras that look at the middle, and their rotations from the local frame."""
    angles = 2.0 * np.pi * np.arange(n) / n
    places = np.column_stack([radius_m * np.sin(angles), radius_m * np.cos(angles), 20.0 + 5.0 * np.cos(3.0 * angles)])
    turns = [cam_from_enu(math.degrees(angle) + 180.0, -20.0) for angle in angles]
    return places, np.array(turns)


def as_model(places, turns):
    back = TRUTH.inverse()
    return back(places), np.array([turn @ TRUTH.rotation for turn in turns])


def up_in_model(sigma_deg=0.3):
    return Up(TRUTH.rotation.T @ np.array([0.0, 0.0, 1.0]), math.radians(sigma_deg))


def noisy(places, sigma_m, seed=0, wild=()):
    rng = np.random.default_rng(seed)
    off = places + rng.normal(0.0, sigma_m, places.shape)
    off[list(wild)] += 60.0
    return [Measured(place, sigma_m**2 * np.eye(3)) for place in off]


def test_receivers_with_outliers_place_a_model_within_their_mean_error():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    placed = place_model(centres, rotations, noisy(places, 1.5, wild=(3, 11)), up_in_model())
    assert placed.scale_from == "positions"
    assert set(np.flatnonzero(~placed.is_used)) == {3, 11}
    off = np.linalg.norm(placed.enu_from_model(centres) - places, axis=1)
    assert np.median(off) < 1.0
    assert placed.enu_from_model.scale == pytest.approx(TRUTH.scale, rel=4.0 * placed.sigma_scale)
    assert 0.003 < placed.sigma_scale < 0.03
    assert placed.sigma_tilt_deg < 0.4


def test_fixed_receivers_place_it_to_centimetres():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    placed = place_model(centres, rotations, noisy(places, 0.02), up_in_model())
    assert np.linalg.norm(placed.enu_from_model(centres) - places, axis=1).max() < 0.03
    assert placed.findings == ()


def test_control_points_go_before_receivers():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    points = np.array([[-10.0, -8.0, 0.0], [10.0, -8.0, 0.5], [10.0, 8.0, 0.0], [-10.0, 8.0, 12.0]])
    control = Control(TRUTH.inverse()(points), points)
    placed = place_model(centres, rotations, noisy(places + 7.0, 2.0), up_in_model(), control)
    assert placed.scale_from == "control points"
    assert np.linalg.norm(placed.enu_from_model(centres) - places, axis=1).max() < 0.02
    assert np.abs(placed.control_residuals_m).max() < 0.01


def looking_down(n=20, side_m=40.0):
    """Cameras over a field that look straight down, all turned alike: nothing but places says what is up."""
    x, y = np.meshgrid(np.linspace(0.0, side_m, 5), np.linspace(0.0, side_m, n // 5))
    places = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 25.0)])
    return places, np.repeat(cam_from_enu(30.0, -90.0)[None], x.size, axis=0)


@pytest.mark.long
@pytest.mark.parametrize("by_control", [False, True])
def test_photos_that_look_straight_down_are_placed_by_what_is_known_of_places(by_control):
    places, turns = looking_down()
    centres, rotations = as_model(places, turns)
    up = up_of_cameras(rotations[:, 0], rotations[:, 1])
    off_deg = math.degrees(math.acos(float((TRUTH.rotation @ up.direction)[2])))
    assert off_deg > 45.0  # the pictures' own upper edge
    if by_control:
        points = np.array([[0.0, 0.0, 0.0], [40.0, 3.0, 0.5], [38.0, 35.0, 0.2], [2.0, 38.0, 0.1], [20.0, 20.0, 0.4]])
        control = Control(TRUTH.inverse()(points), points)
        placed = place_model(centres, rotations, [Measured()] * len(centres), up, control)
        assert np.abs(placed.control_residuals_m).max() < 0.01
    else:
        placed = place_model(centres, rotations, noisy(places, 0.5, wild=(4,)), up)
    off = np.linalg.norm(placed.enu_from_model(centres) - places, axis=1)
    assert np.median(off) < (0.02 if by_control else 0.6)
    assert not {"control-contradicts", "scale-unsure"} & {found.code for found in placed.findings}


def test_photos_that_look_down_in_all_directions_are_above_the_ground():
    turns = np.array([cam_from_enu(heading, -90.0) for heading in (0.0, 90.0, 180.0, 270.0)])
    up = up_of_cameras(turns[:, 0], turns[:, 1])
    np.testing.assert_allclose(up.direction, [0.0, 0.0, 1.0], atol=1e-9)


def test_people_who_look_up_at_a_house_do_not_stand_on_their_heads():
    turns = np.array([cam_from_enu(heading, 50.0) for heading in (0.0, 15.0, 30.0)])
    up = up_of_cameras(turns[:, 0], turns[:, 1])
    assert up.direction[2] > 0.5


def test_a_control_point_that_contradicts_the_others_is_left_out():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    points = np.array(
        [[-10.0, -8.0, 0.0], [10.0, -8.0, 0.5], [10.0, 8.0, 0.0], [-10.0, 8.0, 12.0], [0.0, -8.0, 3.0], [0.0, 8.0, 6.0]]
    )
    wrong = points.copy()
    wrong[4] += (0.0, 9.0, -35.0)
    placed = place_model(
        centres, rotations, [Measured()] * len(centres), up_in_model(), Control(TRUTH.inverse()(points), wrong)
    )
    assert placed.is_control_used.tolist() == [True, True, True, True, False, True]
    assert np.linalg.norm(placed.enu_from_model(centres) - places, axis=1).max() < 0.01


def test_control_points_with_east_and_north_exchanged_are_told():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    points = np.array([[-10.0, -8.0, 0.0], [10.0, -8.0, 0.5], [11.0, 8.0, 0.0], [-10.0, 8.0, 12.0], [30.0, 1.0, 2.0]])
    control = Control(TRUTH.inverse()(points), points[:, [1, 0, 2]])
    placed = place_model(centres, rotations, [Measured()] * len(centres), up_in_model(), control)
    assert "control-contradicts" in {found.code for found in placed.findings}


def test_a_stated_distance_gives_the_size_and_north_is_said_to_be_unknown():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    metres = float(np.linalg.norm(places[0] - places[6]))
    control = Control(np.zeros((0, 3)), np.zeros((0, 3)), ((0, 6, metres),))
    placed = place_model(centres, rotations, [Measured()] * len(centres), up_in_model(), control)
    assert placed.enu_from_model.scale == pytest.approx(TRUTH.scale, rel=1e-6)
    assert not math.isfinite(placed.sigma_north_deg)
    assert [found.code for found in placed.findings] == ["north-unknown"]
    up = placed.enu_from_model.rotation @ up_in_model().direction
    np.testing.assert_allclose(up, [0.0, 0.0, 1.0], atol=1e-6)


def test_a_guessed_size_is_told_and_no_size_is_refused():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    nothing = [Measured()] * len(centres)
    placed = place_model(centres, rotations, nothing, up_in_model(), above=Above(1.6 / TRUTH.scale))
    assert placed.enu_from_model.scale == pytest.approx(TRUTH.scale)
    assert "scale-guessed" in {found.code for found in placed.findings}
    with pytest.raises(InputError, match="how far apart two photos"):
        place_model(centres, rotations, nothing, up_in_model())


def test_people_stand_on_what_is_below_them_and_not_on_a_wide_terrace_above():
    rng = np.random.default_rng(0)
    lawn, terrace = rng.uniform(-6.0, 6.0, (150, 2)), rng.uniform(-40.0, 40.0, (4000, 2))
    points = np.vstack([np.column_stack([lawn, np.zeros(150)]), np.column_stack([terrace, np.full(4000, 3.0)])])
    n = len(points)
    cloud = Cloud(
        points, np.zeros((n, 3), np.uint8), np.full(n, 0.01), np.tile([0.0, 0.0, 1.0], (n, 1)), np.full(n, 2),
        np.zeros(n + 1, np.int64), np.zeros(0, np.int64), np.zeros((0, 3)),
    )  # fmt: skip
    places, turns = orbit(radius_m=20.0)
    places = np.column_stack([places[:, :2], np.full(len(places), 1.6)])
    above = _above_ground(ColmapModel({}, {}), None, cloud, places, turns, Up(np.array([0.0, 0.0, 1.0]), 0.01))
    assert above is not None
    assert above.height == pytest.approx(1.6, abs=0.1)
    under = cloud.of(points[:, 2] > 2.0)
    assert _above_ground(ColmapModel({}, {}), None, under, places, turns, Up(np.array([0.0, 0.0, 1.0]), 0.01)) is None


def test_a_guess_for_drones_is_another_one_and_less_sure():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    nothing = [Measured()] * len(centres)
    held, flown, unseen = (
        place_model(centres, rotations, nothing, up_in_model(), above=Above(10.0, *kind))
        for kind in ((False, True), (True, True), (False, False))
    )
    assert [placed.scale_from for placed in (held, flown, unseen)] == [
        "height of eyes",
        "height of flight",
        held.scale_from,
    ]
    assert flown.enu_from_model.scale == pytest.approx(25.0 * held.enu_from_model.scale)
    assert held.guessed_factor < flown.guessed_factor == unseen.guessed_factor
    assert "4: cameras are taken to be 40.0 m" in str(flown.findings[0].message)


def test_telephones_near_each_other_say_little_of_the_size():
    places, turns = orbit(radius_m=8.0)
    centres, rotations = as_model(places, turns)
    placed = place_model(centres, rotations, noisy(places, 5.0), up_in_model())
    assert "scale-unsure" in {found.code for found in placed.findings}
    assert placed.sigma_scale > 0.05


def test_level_cameras_say_what_is_up():
    _, turns = orbit()
    up = up_of_cameras(turns[:, 0], turns[:, 1])
    assert math.degrees(math.acos(min(1.0, float(up.direction[2])))) < 0.01
    ahead = np.repeat(turns[:1], 5, axis=0)
    alone = up_of_cameras(ahead[:, 0], ahead[:, 1])
    assert alone.sigma_rad > 2.0 * up.sigma_rad


def test_walls_make_up_exact():
    start = Up(np.array([0.04, -0.03, 1.0]) / np.linalg.norm([0.04, -0.03, 1.0]), math.radians(3.0))
    normals = [np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0])]
    planes = [FoundPlane(normal, 0.0, np.arange(50), 1e-3) for normal in normals]
    up = up_of_planes(start, planes)
    assert math.degrees(math.acos(min(1.0, float(up.direction[2])))) < 0.1
    assert up.n_walls == 2
    assert up.sigma_rad < start.sigma_rad


@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (1.0, 0.0, 0.0)])
def test_turning_upright(up):
    turn = turn_upright(np.array(up))
    np.testing.assert_allclose(turn @ up, [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)


def test_cameras_that_swing_below_a_kite_leave_up_to_the_ground():
    rng = np.random.default_rng(2)
    turns = []
    for heading, roll in zip(rng.uniform(0.0, 60.0, 30), rng.normal(20.0, 12.0, 30), strict=True):
        turns.append(Rotation.from_euler("z", roll, degrees=True).as_matrix() @ cam_from_enu(heading, -45.0))
    swinging = np.array(turns)
    start = up_of_cameras(swinging[:, 0], swinging[:, 1])
    assert math.degrees(math.acos(float(start.direction[2]))) > 10.0
    ground = FoundPlane(np.array([0.0, 0.0, 1.0]), 0.0, np.arange(500), 1e-3)
    up = up_of_planes(start, [ground] * 4)
    assert math.degrees(math.acos(float(up.direction[2]))) < 3.0


@pytest.mark.parametrize(("ground_amsl_m", "codes"), [(-6.0, []), (300.0, []), (-56.0, ["ground-below-sea"])])
def test_receivers_that_put_the_ground_below_the_sea_are_told(ground_amsl_m, codes):
    """As DJI's FC300S wrote heights over Florida, which are some 60 m too low."""
    origin = Origin(28.04, -82.70, float(ellipsoid_from_amsl_m(28.04, -82.70, ground_amsl_m)))
    findings = about_height(origin)
    assert [finding.code for finding in findings] == codes
    assert all("56 m below sea level" in str(finding.message) for finding in findings)


@pytest.mark.long
@pytest.mark.parametrize(("sigma_m", "is_wrong"), [(0.02, True), (1.0, False)])
def test_positions_that_are_stated_better_than_the_model_meets_them_contradict_it(sigma_m, is_wrong):
    """Strips flown to and fro, off by 0.5 m to one side and the other, as a lens with a wrong centre puts them."""
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    side = np.where(np.arange(len(places)) % 2, 0.5, -0.5)[:, None] * (1.0, 0.0, 0.0)
    measured = [Measured(place, sigma_m**2 * np.eye(3)) for place in places + side]
    placed = place_model(centres, rotations, measured, up_in_model())
    assert in_sigmas(placed, measured) == pytest.approx(0.5 / sigma_m, rel=0.1)
    assert contradicts(placed, measured) is is_wrong


def test_photos_without_positions_contradict_nothing():
    places, turns = orbit()
    centres, rotations = as_model(places, turns)
    unknown = [Measured() for _ in places]
    placed = place_model(centres, rotations, unknown, up_in_model(), above=Above(5.0))
    assert not contradicts(placed, unknown)
