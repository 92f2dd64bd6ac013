"""The photos of Lund to a coarse model: poses against the reference, going on, and heights that aircraft state."""

from __future__ import annotations

import json
import os
import shutil

import numpy as np
import pytest

from groundstation.services.photos.coarse import coarse_files, photos_of
from planning.base.errors import InputError, OperationCancelled
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.geoid import ellipsoid_from_amsl_m
from planning.site.file import read_site
from reconstruction.coarse.cloud import turn_upright
from reconstruction.coarse.parameters import CoarseRequest
from reconstruction.colmap.folder import read_frame, read_model
from reconstruction.colmap.georeference import angle_between_deg, fit
from tests.planning.photos.photo_writer import exif_part, gps_tags, jpeg, packet, save


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
    effects = {effect["effect"]: effect for effect in json.loads(json.dumps(made.report["effects"]))}
    assert (effects["dense depth"]["on"], effects["dense depth"]["decided_by"]) == (made.decision.on, "scene")
    lens = effects["lens found from the photos"]
    assert (lens["on"], lens["reason"]) == (False, "it was not looked for")  # none is stated
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


TAKEN_OFF_AMSL_M, FLOWN_M, APART_M = 520.0, 30.0, 8.0


def write_as_flown(photos, reference, folder):
    """The photos as of an aircraft without RTK: positions, altitudes and heights above take-off; where each was."""
    images = {image.name: image for image in read_model(reference).images.values()}
    centres = np.array([image.centre_world for image in images.values()])
    turn = turn_upright(-np.mean([image.cam_from_world[1] for image in images.values()], axis=0))
    upright = (centres - centres.mean(axis=0)) @ turn.T
    places = upright * APART_M / upright.std(axis=0).max() + (0.0, 0.0, FLOWN_M)
    origin = Origin(48.0, 11.0, float(ellipsoid_from_amsl_m(48.0, 11.0, TAKEN_OFF_AMSL_M)))
    lat, lon, _ = geodetic_from_enu(origin, places)
    for name, place, *at in zip(images, places.tolist(), lat.tolist(), lon.tolist(), strict=True):
        exif = exif_part({0x010F: "DJI", 0x0110: "FC300S"}, {}, gps_tags(*at, TAKEN_OFF_AMSL_M + place[2]))
        xmp = packet({"RelativeAltitude": f"{place[2]:+.2f}"})
        save(folder / name, jpeg(exif, xmp, base=(photos / name).read_bytes()))
    return dict(zip(images, geodetic_from_enu(origin, places).ellipsoid_height_m, strict=True))


@pytest.mark.slow
def test_a_flight_without_rtk_lies_as_high_as_its_photos_say(door, tmp_path):
    photos, reference = door
    truth = write_as_flown(photos, reference, tmp_path / "flown")
    coarse_files(CoarseRequest(tmp_path / "flown", tmp_path / "out", size_px=600))
    images = read_model(tmp_path / "out" / "sparse" / "0").images.values()
    origin = read_site(tmp_path / "out" / "site.json").site.origin
    heights = geodetic_from_enu(origin, np.array([image.centre_world for image in images])).ellipsoid_height_m
    off_m = heights - [truth[image.name] for image in images]
    assert len(off_m) >= 10
    assert np.abs(off_m).max() < 1.0


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "decided_by"), [("on", "user"), ("auto", "scene")])
def test_the_report_says_whether_a_stated_lens_was_found_anew(door, tmp_path, asked, decided_by):
    photos, reference = door
    write_as_flown(photos, reference, tmp_path / "flown")
    camera = tmp_path / "cameras.txt"  # with a third radial term, which makers' calibrations have
    camera.write_text("1 FULL_OPENCV 1296 1936 2435.38 2435.38 648 968 -0.0336 0 0 0 0.001 0 0 0\n")
    made = coarse_files(CoarseRequest(tmp_path / "flown", tmp_path / "out", camera, size_px=600, find_lens=asked))
    lens = made.report["effects"][1]
    assert (lens["effect"], lens["decided_by"]) == ("lens found from the photos", decided_by)
    assert lens["on"] == (asked == "on" or lens["size"] > lens["tolerance"])
    assert any(found.code == "lens-chosen" for found in made.findings)
