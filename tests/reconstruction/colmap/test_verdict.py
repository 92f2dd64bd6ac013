"""Refined poses that are believed, and those that are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planning.base.findings import Severity
from reconstruction.base.cameras import Pose, cam_from_enu
from reconstruction.colmap.refined_folder import judge_poses
from tests.reconstruction.colmap.models import covariance, photos, turned

SIGMA_M, SIGMA_DEG = 0.02, 1.0
GOOD = covariance(0.01, 0.1)


def flight(n=12, seed=0, heading_off_deg=0.0):
    """Photos with the poses they state, and refined ones that are all but true."""
    true = photos(n, seed)
    rng = np.random.default_rng(seed)
    stated, refined = [], []
    for photo in true:
        off = turned(photo, rng.normal(0.0, SIGMA_M, 3), rng.normal(0.0, np.radians(SIGMA_DEG), 3))
        common = cam_from_enu(-heading_off_deg, 0.0).T @ cam_from_enu(0.0, 0.0)
        rotation = off.pose.cam_from_enu @ common
        pose = Pose(off.pose.position_enu_m, rotation, covariance(SIGMA_M, SIGMA_DEG))
        stated.append(replace(photo, pose=pose))
        better = turned(photo, rng.normal(0.0, 0.01, 3), rng.normal(0.0, np.radians(0.1), 3))
        refined.append(replace(photo, pose=replace(better.pose, covariance=GOOD)))
    return stated, refined


def codes(judged):
    return [finding.code for finding in judged.findings]


def test_good_refined_poses_are_all_taken_and_their_changes_told():
    stated, refined = flight()
    judged = judge_poses(stated, refined)
    assert judged.photos == tuple(refined)
    assert judged.findings == ()
    # Three axes of 2 cm and 1 cm together, of 1 degree each.
    assert 0.02 < np.median(judged.moved_m) < 0.06
    assert 1.0 < np.median(judged.turned_deg) < 2.5


@pytest.mark.parametrize("off_m", [3.0, 0.5])
def test_a_photo_that_was_put_elsewhere_keeps_its_own_pose(off_m):
    stated, refined = flight()
    refined[4] = turned(refined[4], np.array([off_m, 0.0, 0.0]), np.zeros(3))
    judged = judge_poses(stated, refined)
    assert judged.photos[4] is stated[4]
    assert judged.is_refined == tuple(i != 4 for i in range(12))
    assert codes(judged) == ["refined-pose-contradicts"]
    assert judged.findings[0].place == stated[4].name
    assert "standard deviations" in judged.findings[0].message
    assert len(judged.moved_m) == 11


def test_what_receivers_do_not_say_of_their_errors_is_allowed_for():
    stated, refined = flight()
    refined[4] = turned(refined[4], np.array([0.1, 0.0, 0.0]), np.zeros(3))
    assert all(judge_poses(stated, refined).is_refined)


def test_a_photo_that_was_turned_keeps_its_own_pose():
    stated, refined = flight()
    refined[2] = turned(refined[2], np.zeros(3), np.radians([0.0, 8.0, 0.0]))
    judged = judge_poses(stated, refined)
    assert judged.photos[2] is stated[2]
    assert "degrees from its own" in judged.findings[0].message


@pytest.mark.parametrize("heading_off_deg", [9.0, -25.0])
def test_a_compass_that_is_wrong_in_all_photos_counts_against_none(heading_off_deg):
    stated, refined = flight(heading_off_deg=heading_off_deg)
    judged = judge_poses(stated, refined)
    assert all(judged.is_refined)
    assert codes(judged) == ["angles-off-in-common"]
    assert judged.findings[0].severity is Severity.NOTE
    told = float(judged.findings[0].message.partition("off by ")[2].split()[0])
    assert told == pytest.approx(abs(heading_off_deg), abs=1.0)


def test_a_pose_that_is_known_worse_than_before_is_not_taken():
    stated, refined = flight()
    refined[7] = replace(refined[7], pose=replace(refined[7].pose, covariance=covariance(0.05, 3.0)))
    judged = judge_poses(stated, refined)
    assert judged.photos[7] is stated[7]
    assert codes(judged) == ["refined-pose-no-better"]
    assert judged.findings[0].value == pytest.approx(2.5)
    refined[7] = replace(refined[7], pose=replace(refined[7].pose, covariance=covariance(0.05, 0.1)))
    assert all(judge_poses(stated, refined).is_refined)  # its angles are known better


def test_a_model_that_most_photos_contradict_is_refused_whole():
    stated, refined = flight()
    moved = [turned(photo, np.array([0.0, 2.0 + i, 0.0]), np.zeros(3)) for i, photo in enumerate(refined[:7])]
    judged = judge_poses(stated, [*moved, *refined[7:]])
    assert judged.photos == tuple(stated)
    assert codes(judged)[-1] == "refinement-refused"
    assert "7 of 12" in judged.findings[-1].message
    assert judged.moved_m.size == 0


def test_a_model_that_nothing_fixes_is_refused():
    stated, refined = flight()
    loose = [replace(photo, pose=replace(photo.pose, covariance=None)) for photo in refined]
    judged = judge_poses(stated, loose)
    assert judged.photos == tuple(stated)
    assert set(codes(judged)) == {"refined-pose-loose", "refinement-refused"}


def test_photos_that_are_not_in_the_model_keep_their_own_poses():
    stated, refined = flight()
    judged = judge_poses(stated, refined[3:])
    assert judged.photos == (*stated[:3], *refined[3:])
    assert judged.findings == ()
    assert judge_poses(stated, []).photos == tuple(stated)


def test_photos_that_state_no_accuracy_are_compared_with_usual_ones():
    stated, refined = flight()
    bare = [replace(photo, pose=replace(photo.pose, covariance=None)) for photo in stated]
    refined[0] = turned(refined[0], np.array([1.0, 0.0, 0.0]), np.radians([0.0, 40.0, 0.0]))
    assert all(judge_poses(bare, refined).is_refined)
    refined[0] = turned(refined[0], np.array([10.0, 0.0, 0.0]), np.zeros(3))
    assert not judge_poses(bare, refined).is_refined[0]
