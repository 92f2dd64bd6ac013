"""Corrections of poses: a photo that is moved has the rays that light was learned with, and splats pull it back."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.ray_table import RayTable
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.photos.poses import (
    TRIED,
    OwnPoses,
    PoseCorrections,
    moved,
    moved_view,
    one_after_other,
    pulled,
)
from tests.reconstruction.light.synthetic_folder import cameras, corners_of

MOVE = (0.2, -0.1, 0.05, 0.004, -0.006, 0.003)


def test_a_moved_photo_has_the_rays_of_its_correction(tmp_path):
    photos, planes = cameras(tmp_path, 2), PanelPlanes(corners_of())
    moves = torch.tensor([MOVE, (0.0,) * 6], dtype=torch.float64)
    numbers = torch.tensor([0, 0, 1])
    places, panels = torch.tensor([[3.0, 4.0], [30.0, 20.0], [10.0, 10.0]]).double(), torch.tensor([0, 4, 2])
    corrected = RayTable.of(photos, planes, {}).meet(numbers, places, panels, moves)
    there = RayTable.of(moved(photos, [tuple(row) for row in moves.tolist()]), planes, {}).meet(numbers, places, panels)
    # Rays are turned to first order, photos wholly: a turn of 8 milliradians differs by its square.
    np.testing.assert_allclose(there.directions, corrected.directions, atol=4e-5)
    np.testing.assert_allclose(there.points_m, corrected.points_m, atol=1e-3)
    here = RayTable.of(photos, planes, {}).meet(numbers, places, panels)
    assert (here.directions - there.directions)[:2].norm(dim=1).min() > 4e-3
    np.testing.assert_array_equal(here.points_m[2], there.points_m[2])


def test_without_corrections_photos_are_as_they_are(tmp_path):
    photos = cameras(tmp_path, 2)
    assert moved(photos, ()) == photos


small = st.floats(-0.3, 0.3, allow_subnormal=False)
moves = st.tuples(*[small] * 6)


@given(moves, moves)
def test_corrections_one_after_the_other_are_one(tmp_path_factory, first, then):
    photo = cameras(tmp_path_factory.mktemp("photos"), 1)
    twice, once = moved(moved(photo, [first]), [then])[0], moved(photo, one_after_other([first], [then]))[0]
    np.testing.assert_allclose(once.pose.position_enu_m, twice.pose.position_enu_m, atol=1e-12)
    np.testing.assert_allclose(once.pose.cam_from_enu, twice.pose.cam_from_enu, atol=1e-12)


def test_no_correction_before_or_after_leaves_the_other():
    assert one_after_other((), [MOVE]) == one_after_other([MOVE], ()) == (MOVE,)


@given(moves)
def test_a_view_is_moved_as_its_photo_is(tmp_path_factory, move):
    photo, origin = cameras(tmp_path_factory.mktemp("photos"), 1)[0], np.array([1.0, -2.0, 3.0])
    there = View.of(moved([photo], [move])[0], origin)
    found = moved_view(View.of(photo, origin), torch.tensor(move, dtype=torch.float64))
    np.testing.assert_allclose(found.cam_from_world, there.cam_from_world, atol=1e-9)


def seen_from(view, means, quats):
    """Places, and rotations as matrices, in the camera's axes."""
    matrix = view.cam_from_world.numpy()
    turns = Rotation.from_quat(quats, scalar_first=True).as_matrix()
    return means @ matrix[:3, :3].T + matrix[:3, 3], matrix[:3, :3] @ turns


@pytest.mark.parametrize(("size", "within"), [(0.0, 1e-6), (0.002, 3e-3)])
def test_splats_pull_their_camera_as_differences_say(tmp_path, size, within):
    rng = np.random.default_rng(4)
    view = View.of(cameras(tmp_path, 1)[0], np.zeros(3))
    means, quats = rng.normal(0.0, 2.0, (40, 3)), rng.normal(size=(40, 4))
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    of_places, of_turns = rng.normal(size=(40, 3)), rng.normal(size=(40, 3, 3))
    move = size * rng.normal(size=6)

    def told(at):
        places, turns = seen_from(moved_view(view, torch.tensor(at)), means, quats)
        return float((of_places * places).sum() + (of_turns * turns).sum())

    step = 1e-5
    expected = [(told(move + step * row) - told(move - step * row)) / (2.0 * step) for row in np.eye(6)]

    there, correction = moved_view(view, torch.tensor(move)), torch.tensor(move, requires_grad=True)
    position = -there.cam_from_world[:3, :3].T @ there.cam_from_world[:3, 3]
    places, turns = pulled(torch.tensor(means), torch.tensor(quats), position, correction)
    np.testing.assert_array_equal(places.detach(), means)
    np.testing.assert_array_equal(turns.detach(), quats)
    w, x, y, z = turns.unbind(dim=1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrices = torch.stack([torch.stack(row, dim=-1) for row in rows], dim=-2)
    rotation, shift = there.cam_from_world[:3, :3], there.cam_from_world[:3, 3]
    total = (torch.tensor(of_places) * (places @ rotation.T + shift)).sum()
    (total + (torch.tensor(of_turns) * (rotation @ matrices)).sum()).backward()
    np.testing.assert_allclose(correction.grad, expected, atol=within * np.abs(expected).max())


@pytest.fixture
def scene(tmp_path):
    """A model of coloured discs about the panels, and a photo's view of it."""
    rng, n = np.random.default_rng(1), 400
    values = {
        "means": torch.tensor(rng.uniform((-4.0, -0.5, 0.0), (4.0, 0.5, 4.0), (n, 3))).float(),
        "quats": torch.tensor(rng.normal(size=(n, 4))).float(),
        "log_scales": torch.full((n, 2), math.log(0.25)),
        "opacity_logits": torch.full((n,), 3.0),
        "sh": torch.zeros(n, 16, 3),
        "reflectivity_logits": torch.full((n,), -9.0),
        "f0_logits": torch.zeros(n, 3),
    }
    values["sh"][:, 0] = torch.tensor(rng.uniform(-1.5, 1.5, (n, 3))).float()
    splats = Splats(values, torch.full((n,), -1))
    photo = cameras(tmp_path, 1)[0]
    return SceneModel(splats, Sky(), None, PanelPlanes(np.zeros((0, 4, 3))), np.zeros(3), 1.0), photo


def test_a_corrected_picture_is_that_of_the_corrected_camera_bit_by_bit(scene):
    model, photo = scene
    view, move = View.of(photo, np.zeros(3)), torch.tensor(MOVE)
    with torch.no_grad():
        assert torch.equal(model(view, move=move).display, model(moved_view(view, move)).display)
        assert not torch.equal(model(view, move=move).display, model(view).display)


@pytest.mark.long
def test_a_camera_that_is_off_finds_its_place_again(scene):
    model, photo = scene
    view, poses = View.of(photo, np.zeros(3)), PoseCorrections([photo], np.array([0.0, 0.0, 2.0]))
    with torch.no_grad():
        truth = model(view).display
        poses.pixels.copy_(torch.tensor([[4.0, -4.0, 4.0, 1.0, -1.5, 2.0]]))
    optimiser = torch.optim.Adam(poses.parameters(), lr=0.1)
    losses = []
    for _ in range(60):
        optimiser.zero_grad()
        loss = (model(view, move=poses(0)).display - truth).square().mean()
        loss.backward()
        optimiser.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.03 * losses[0]
    assert poses.pixels.detach()[0, 3:].abs().max() < 0.5


def corrected(photos, turns_px):
    poses = PoseCorrections(photos, np.array([0.0, 0.0, 2.0]))
    with torch.no_grad():
        poses.pixels[:, 3:] = torch.tensor(turns_px).float()
    return poses


def test_the_shift_is_that_of_what_photos_show(tmp_path):
    photos = cameras(tmp_path, 3)
    rng = np.random.default_rng(0)
    poses = corrected(photos, rng.normal(0.0, 2.0, (3, 3)))
    with torch.no_grad():
        poses.pixels[:, :3] = torch.tensor(rng.normal(0.0, 5.0, (3, 3)))
    found = []
    for photo, there, distance in zip(photos, moved(photos, poses.moves()), poses.distances_m, strict=True):
        point = (photo.pose.position_enu_m + float(distance) * photo.pose.cam_from_enu[2])[None]
        found.append(float(np.linalg.norm(there.pixels(point) - photo.pixels(point))))
    poses.settle("on", 1.0, 1, 0.0)
    assert float(poses.shift_px) == pytest.approx(float(np.median(found)), rel=0.15)


def test_photos_that_hardly_move_are_put_back_and_others_go_on(tmp_path):
    photos = cameras(tmp_path, 3)
    little, much = 0.5 * OwnPoses().tolerance, 3.0 * OwnPoses().tolerance
    for px, is_on in ((little, False), (much, True)):
        poses = corrected(photos, [[px, 0.0, 0.0], [0.0, 0.0, px], [px, 0.0, 0.0]])
        assert poses.is_learned("auto", 0)
        poses.settle("auto", TRIED - 0.01, 1, 0.0)
        assert poses.pixels.any()
        poses.settle("auto", TRIED, 1, 0.0)
        assert poses.is_learned("auto", 0) is is_on
        assert bool(poses.pixels.any()) is is_on
        decision = poses.decision("auto", 100.0)
        assert decision.on is is_on
        assert decision.cost_s == pytest.approx(4.0)


@pytest.mark.parametrize(("looks", "is_on"), [(1, False), (100, True)])
def test_photos_that_move_as_chance_would_move_them_are_put_back(tmp_path, looks, is_on):
    photos = cameras(tmp_path, 3)
    px = 1.2 * OwnPoses().tolerance
    poses = corrected(photos, [[px, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, px]])
    poses.settle("auto", TRIED, 3 * looks, 0.1)
    assert poses.is_learned("auto", 0) is is_on
    assert bool(poses.pixels.any()) is is_on


def test_some_photos_stay_until_it_is_decided_and_tell_nothing_of_how_far_others_move(tmp_path):
    photos = cameras(tmp_path, 9)
    poses = corrected(photos, np.where(np.arange(9)[:, None] % 3 == 1, 0.0, [[3.0, 0.0, 0.0]]))
    assert [poses.is_learned("auto", number) for number in range(3)] == [True, False, True]
    assert all(poses.is_learned("on", number) for number in range(9))
    poses.settle("auto", TRIED, 9, 0.0)
    assert float(poses.shift_px) > 2.5
    assert all(poses.is_learned("auto", number) for number in range(9))


@pytest.mark.parametrize(("shift_px", "is_on"), [(0.0, False), (3.0, True)])
def test_poses_that_wander_about_where_they_are_said_to_be_are_put_back(tmp_path, shift_px, is_on):
    photos, rng, n_steps = cameras(tmp_path, 30), np.random.default_rng(4), 600
    away = shift_px * rng.choice([-1.0, 1.0], (30, 3))
    poses = corrected(photos, away)
    for step in range(n_steps):
        with torch.no_grad():
            if step % 10 == 0:  # from one look at a photo to the next
                poses.pixels[:, 3:] = torch.tensor(away + rng.normal(0.0, 1.5, (30, 3))).float()
        poses.settle("auto", TRIED * (step + 1) / n_steps, 30 * (1 + step // 10), 0.1)
    assert poses.is_learned("auto", 0) is is_on
    assert (float(poses.shift_px) > 2.0) is is_on


def test_the_user_decides_whatever_photos_do(tmp_path):
    photos = cameras(tmp_path, 2)
    poses = corrected(photos, [[0.1, 0.0, 0.0], [0.0, 0.0, 0.1]])
    poses.settle("on", 1.0, 1, 0.0)
    assert poses.is_learned("on", 1)
    assert poses.pixels.any()
    assert poses.decision("on", 1.0).on
    assert not PoseCorrections(photos, np.zeros(3)).is_learned("off", 0)
    assert not PoseCorrections(photos, np.zeros(3)).decision("auto", 1.0).on


def test_what_all_corrections_share_is_taken_away(tmp_path):
    poses = corrected(cameras(tmp_path, 3), [[1.0, 2.0, 3.0], [3.0, 2.0, 1.0], [2.0, 2.0, 2.0]])
    poses.project()
    np.testing.assert_allclose(poses.pixels.detach().mean(dim=0), 0.0, atol=1e-6)
    assert poses.pixels.any()
