"""Refined poses on disk: as they were, for the photos they are of, and never half."""

from __future__ import annotations

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import georeference
from reconstruction.colmap.pycolmap_run import RefineParameters
from reconstruction.colmap.refine import Refinement
from reconstruction.colmap.refined_folder import (
    FILE,
    check_refined_folder,
    fingerprint,
    is_refined_folder,
    read_refined,
    write_refined,
)
from tests.reconstruction.colmap.models import covariance, model, photos

PARAMETERS = RefineParameters(max_image_size_px=800)
SAID = Finding(Severity.WARNING, "photos-not-refined", "1 of 6 photos found no place", "", 1.0, 0.0, "photos")


@pytest.fixture
def flight(tmp_path):
    """Six photos as files, and their refinement without the last."""
    stated = []
    for photo in photos(6, rows=2):
        path = tmp_path / "card" / photo.name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"x" * 100)
        stated.append(replace(photo, path=path))
    found = model(stated[:5])
    known = tuple(
        replace(photo, pose=replace(photo.pose, covariance=covariance(0.01 * (i + 1), 0.1)))
        for i, photo in enumerate(stated[:5])
    )
    refinement = Refinement(known, found, georeference(found, stated), 0.6, (stated[5].name,), (SAID,))
    return tmp_path / "card.refined", refinement, stated


def test_what_was_written_comes_back(flight):
    folder, refinement, stated = flight
    write_refined(folder, refinement, stated, PARAMETERS)
    assert is_refined_folder(folder)
    kept = read_refined(folder, stated)
    assert kept.photos_sha256 == fingerprint(stated)
    assert kept.parameters == PARAMETERS
    assert kept.left_out == (stated[5].name,)
    assert kept.findings == (SAID,)
    assert kept.reprojection_px == 0.6
    for one, other in zip(kept.photos, refinement.photos, strict=True):
        assert (one.name, one.path, one.intrinsics) == (other.name, other.path, other.intrinsics)
        np.testing.assert_allclose(one.pose.position_enu_m, other.pose.position_enu_m, atol=1e-9)
        np.testing.assert_allclose(one.pose.cam_from_enu, other.pose.cam_from_enu, atol=1e-12)
        np.testing.assert_array_equal(one.pose.covariance, other.pose.covariance)
    assert len(read_model(folder).points) == len(refinement.model.points)  # as any COLMAP model


def test_a_new_refinement_takes_the_place_of_the_old_and_leaves_nothing_beside_it(flight):
    folder, refinement, stated = flight
    write_refined(folder, refinement, stated, PARAMETERS)
    write_refined(folder, replace(refinement, reprojection_px=0.3), stated, PARAMETERS)
    assert read_refined(folder, stated).reprojection_px == 0.3
    assert sorted(path.name for path in folder.parent.iterdir()) == ["card", "card.refined"]


def test_other_photos_and_other_poses_have_another_fingerprint(flight):
    _, _, stated = flight
    own = fingerprint(stated)
    assert fingerprint(list(reversed(stated))) == own
    assert fingerprint(stated[1:]) != own
    moved = replace(stated[0], pose=replace(stated[0].pose, position_enu_m=stated[0].pose.position_enu_m + 0.001))
    assert fingerprint([moved, *stated[1:]]) != own
    mask = stated[0].path.with_suffix(".png")
    drawn = []
    for value in (255, 0, 255):
        cv2.imwrite(str(mask), np.full((2, 2), value, np.uint8))
        drawn.append(fingerprint([replace(stated[0], mask=mask), *stated[1:]]))
    assert drawn[0] == drawn[2]
    assert len({own, *drawn}) == 3
    mask.unlink()
    stated[0].path.write_bytes(b"another picture")
    assert fingerprint(stated) != own
    stated[0].path.unlink()
    with pytest.raises(InputError, match="cannot be read any more"):
        fingerprint(stated)


def test_a_folder_of_something_else_is_not_touched(flight):
    folder, refinement, stated = flight
    folder.mkdir()
    (folder / "holiday.txt").write_text("mine")
    with pytest.raises(InputError, match="something other than refined poses; name another folder"):
        write_refined(folder, refinement, stated, PARAMETERS)
    assert [path.name for path in folder.iterdir()] == ["holiday.txt"]
    with pytest.raises(InputError, match="expected a folder to write into"):
        check_refined_folder(folder / "none" / "refined")


def damaged(content, kind):
    if kind == "format":
        content["format"] = "reflight-plan/1"
    elif kind == "photo":
        content["photos"][0]["name"] = "other.jpg"
    elif kind == "shape":
        content["photos"][0]["covariance"] = [[1.0]]
    elif kind == "negative":
        content["photos"][0]["covariance"][0][0] = -1.0
    elif kind == "missing":
        del content["photos_sha256"]
    return content


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("format", "expected 'reflight-refined/1'"),
        ("photo", "other photos than the model"),
        ("shape", "6 rows of 6"),
        ("negative", "a matrix that is none"),
        ("missing", "photos_sha256"),
    ],
)
def test_a_damaged_file_is_refused_in_words(flight, kind, words):
    folder, refinement, stated = flight
    write_refined(folder, refinement, stated, PARAMETERS)
    path = folder / FILE
    path.write_text(json.dumps(damaged(json.loads(path.read_text()), kind)))
    with pytest.raises(InputError, match=words):
        read_refined(folder, stated)
