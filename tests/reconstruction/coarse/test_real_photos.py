"""The photos of Lund, without any metadata, to a coarse model: poses against the reference, and going on."""

from __future__ import annotations

import os
import shutil

import numpy as np
import pytest

from groundstation.services.photos.coarse import coarse_files, photos_of
from planning.base.errors import InputError, OperationCancelled
from planning.site.file import read_site
from reconstruction.coarse.parameters import CoarseRequest
from reconstruction.colmap.folder import read_frame, read_model
from reconstruction.colmap.georeference import angle_between_deg, fit


@pytest.fixture
def door(shared_data, tmp_path):
    pytest.importorskip("pycolmap", reason="pycolmap is not installed (pip install .[colmap])")
    source = shared_data / "multiview" / "lund_door"
    photos = tmp_path / "door"
    photos.mkdir()
    for path in source.glob("*.JPG"):
        shutil.copy(path, photos)
    return photos, source / "colmap_ground_truth"


@pytest.mark.slow
def test_poses_meet_the_reference_and_nothing_is_done_twice(door, tmp_path):
    photos, reference = door
    made = coarse_files(CoarseRequest(photos, tmp_path / "out", size_px=800))
    assert made.report["registered"] == 12
    truth = {image.name: image for image in read_model(reference).images.values()}
    found = {image.name: image for image in read_model(tmp_path / "out" / "sparse" / "0").images.values()}
    names = sorted(truth)
    a = np.array([found[name].centre_world for name in names])
    b = np.array([truth[name].centre_world for name in names])
    similarity = fit(a, b)
    off = np.linalg.norm(similarity(a) - b, axis=1)
    assert np.median(off) < 0.005 * np.linalg.norm(np.ptp(b, axis=0))
    angles = [
        angle_between_deg(found[name].cam_from_world @ similarity.rotation.T, truth[name].cam_from_world)
        for name in names
    ]
    assert np.median(angles) < 0.3
    site = read_site(tmp_path / "out" / "site.json")
    assert site.site.place_from == "unknown"
    assert read_frame(tmp_path / "out" / "sparse" / "0") is not None
    assert photos_of(tmp_path / "out") == photos.resolve()

    class Stages(list):
        def report(self, stage, done, total):
            self.append(str(stage))

    # Copies have the time of copying; what they show counts.
    for path in photos.iterdir():
        os.utime(path, (1.0, 1.0))
    stages = Stages()
    again = coarse_files(CoarseRequest(photos, tmp_path / "out", size_px=800), stages)
    assert again.report["registered"] == 12
    assert not {"finding features", "matching photos", "building the model"} & set(stages)


@pytest.mark.slow
def test_a_cancelled_run_writes_no_site_and_goes_on(door, tmp_path):
    photos, _ = door

    class Cancelling:
        def report(self, stage, done, total):
            if stage == "matching photos":
                raise OperationCancelled("enough")

    with pytest.raises(OperationCancelled):
        coarse_files(CoarseRequest(photos, tmp_path / "out", size_px=400), Cancelling())
    assert not (tmp_path / "out" / "site.json").exists()
    assert coarse_files(CoarseRequest(photos, tmp_path / "out", size_px=400)).report["registered"] >= 10


def test_too_few_photos_are_refused_in_one_line(door, tmp_path):
    photos, _ = door
    for path in sorted(photos.iterdir())[2:]:
        path.unlink()
    with pytest.raises(InputError, match="at least 3 photos, got 2"):
        coarse_files(CoarseRequest(photos, tmp_path / "out"))
