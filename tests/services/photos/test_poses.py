"""Poses of photos: their own, refined ones that were kept, and those of a COLMAP model."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from groundstation.services.photos.found_panels import apply_poses
from groundstation.services.photos.intake import photo_intake, with_poses
from groundstation.services.photos.poses import (
    LENS_UNKNOWN,
    ChosenPoses,
    RefineRequest,
    choose_poses,
    findings_that_hold,
)
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.photos.folder import read_photos
from reconstruction.colmap.folder import Frame, write_frame, write_model
from reconstruction.colmap.georeference import georeference, model_of
from reconstruction.colmap.pycolmap_run import RefineParameters
from reconstruction.colmap.refine import Refinement
from reconstruction.colmap.refined_folder import write_refined
from reconstruction.dataset.prepare import PrepareParameters, prepare
from reconstruction.photos.poses import pose_photos
from tests.planning.photos.photo_writer import plain_jpeg, save
from tests.reconstruction.colmap.models import covariance, turned
from tests.services.photo_cases import draft_of, site_model, true_photos, with_paths, write_photos


def picture_of(photo, suffix):
    """A file that says nothing of itself, as large as its camera."""
    return cv2.imencode(suffix, np.full((photo.intrinsics.height_px, photo.intrinsics.width_px, 3), 90, np.uint8))[
        1
    ].tobytes()


TURN_RAD = np.radians([0.0, 0.5, 0.0])
GOOD = covariance(0.01, 0.05)


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """Three photos as files, with the poses that they state."""
    folder = tmp_path_factory.mktemp("flight") / "photos"
    write_photos(folder)
    return folder, pose_photos(read_photos(folder).photos, site_model().site, folder)


def refinement(stated, left_out=0):
    """As if COLMAP had found all photos turned by half a degree, and their lenses a little longer."""
    refined = []
    for photo in stated[: len(stated) - left_out]:
        pose = replace(turned(photo, np.array([0.01, 0.0, 0.0]), TURN_RAD).pose, covariance=GOOD)
        refined.append(
            replace(photo, pose=pose, intrinsics=replace(photo.intrinsics, fx_px=photo.intrinsics.fx_px + 1))
        )
    model = model_of(refined)
    names = tuple(photo.name for photo in stated[len(stated) - left_out :])
    laid = georeference(model_of(stated), stated)
    return Refinement(tuple(refined), model, laid, 0.5, names, ())


@pytest.fixture
def kept(flight, tmp_path):
    """A folder of refined poses of these photos, of which the last found no place."""
    _, posed = flight
    write_refined(tmp_path / "kept", refinement(posed.photos, left_out=1), posed.photos, RefineParameters())
    return tmp_path / "kept"


def test_photos_keep_their_own_poses_where_nothing_else_is_wished_for(flight):
    folder, posed = flight
    found = choose_poses(posed, folder)
    assert (found.photos, found.findings, found.refined) == (posed.photos, (), None)


def test_refined_poses_that_were_kept_are_taken_without_colmap(flight, kept, monkeypatch):
    monkeypatch.setitem(sys.modules, "pycolmap", None)
    folder, posed = flight
    found = choose_poses(posed, folder, refine=RefineRequest(kept))
    assert [photo.name for photo in found.photos] == [photo.name for photo in posed.photos]
    assert found.photos[2] is posed.photos[2]
    np.testing.assert_allclose(found.photos[0].pose.covariance, GOOD)
    outcome = found.refined
    assert (outcome.n_refined, outcome.n_photos, outcome.was_kept) == (2, 3, True)
    assert outcome.moved_m == pytest.approx((0.01, 0.01))
    assert outcome.turned_deg == pytest.approx((0.5, 0.5), rel=1e-6)
    assert outcome.not_joined == (posed.photos[2].name,)
    told = found.findings[0]
    assert told.code == "poses-refined"
    assert "2 of 3 photos" in told.message
    assert "0.010 m" in told.message


def test_a_colmap_model_that_was_kept_counts_as_refined(flight, kept):
    folder, posed = flight
    by_model = choose_poses(posed, folder, kept)
    by_wish = choose_poses(posed, folder, refine=RefineRequest(kept))
    for one, other in zip(by_model.photos, by_wish.photos, strict=True):
        np.testing.assert_array_equal(one.pose.position_enu_m, other.pose.position_enu_m)


def test_of_any_other_model_photos_that_are_not_in_it_are_left_out(flight, tmp_path):
    folder, posed = flight
    write_model(tmp_path / "model", model_of(posed.photos))
    found = choose_poses(posed, folder, tmp_path / "model")
    assert found.refined is None
    for one, other in zip(found.photos, posed.photos, strict=True):
        np.testing.assert_allclose(one.pose.position_enu_m, other.pose.position_enu_m, atol=1e-6)
        # No better than adjustments usually are, however well the model lies in the site.
        sigmas = np.sqrt(np.diag(one.pose.covariance))
        np.testing.assert_allclose(sigmas, [0.02] * 3 + [np.radians(0.1)] * 3)


@pytest.mark.parametrize("size", [None, 1600])
def test_a_kept_refinement_of_the_size_wished_for_is_taken(flight, kept, size):
    folder, posed = flight
    assert choose_poses(posed, folder, refine=RefineRequest(kept, size)).refined.was_kept


def test_another_size_or_other_photos_are_computed_and_pycolmap_missing_is_said(flight, kept, monkeypatch):
    monkeypatch.setitem(sys.modules, "pycolmap", None)
    folder, posed = flight
    with pytest.raises(InputError, match=r"pip install 'reflight-groundstation\[colmap\]'"):
        choose_poses(posed, folder, refine=RefineRequest(kept, 800))
    fewer = replace(posed, photos=posed.photos[:2])
    with pytest.raises(InputError, match=r"pip install 'reflight-groundstation\[colmap\]'"):
        choose_poses(fewer, folder, refine=RefineRequest(kept))


def test_a_damaged_folder_says_what_to_remove(flight, kept):
    folder, posed = flight
    (kept / "images.bin").write_bytes(b"\x01")
    with pytest.raises(InputError, match="remove the folder"):
        choose_poses(posed, folder, refine=RefineRequest(kept))


def test_refined_poses_lie_beside_the_photos_unless_a_folder_is_named(tmp_path):
    assert RefineRequest().kept_in(tmp_path / "DCIM") == tmp_path / "DCIM.refined"
    assert RefineRequest(tmp_path / "x").kept_in(tmp_path / "DCIM") == tmp_path / "x"
    with pytest.raises(InputError, match="a whole drive"):
        RefineRequest().kept_in(Path(tmp_path.anchor))
    with pytest.raises(ValueError, match="at least 1"):
        RefineRequest(max_image_size_px=0)


def test_other_poses_change_coverage_and_findings_and_the_way_back_leads_where_it_began(flight, kept):
    folder, posed = flight
    model = site_model()
    before = photo_intake(folder, model)
    refined = with_poses(before, choose_poses(posed, folder, refine=RefineRequest(kept)), model, None)
    assert refined.photos[0].pose.heading_deg != before.photos[0].pose.heading_deg
    assert "poses-refined" in {finding.code for finding in refined.findings}
    assert refined.quality is before.quality  # no picture is looked at again
    back = with_poses(refined, ChosenPoses(refined.posed.photos), model, None)
    assert back.photos == before.photos
    assert sorted(back.findings, key=str) == sorted(before.findings, key=str)
    np.testing.assert_array_equal(back.coverage.counts, before.coverage.counts)
    with pytest.raises(ValueError, match="same photos"):
        with_poses(before, ChosenPoses(before.photos[:1]), model, None)


def test_a_model_that_says_its_frame_is_taken_as_it_is(flight, tmp_path):
    folder, posed = flight
    moved = [turned(photo, np.array([7.0, 0.0, 0.0]), TURN_RAD) for photo in posed.photos]
    write_model(tmp_path / "sparse", model_of(moved), "txt")
    write_frame(tmp_path / "sparse", Frame(0.3, 0.2))
    found = choose_poses(posed, folder, tmp_path / "sparse")
    for photo, meant in zip(found.photos, moved, strict=True):
        np.testing.assert_allclose(photo.pose.position_enu_m, meant.pose.position_enu_m, atol=1e-9)
        assert photo.pose.covariance[0, 0] == pytest.approx(0.09)


def test_photos_that_say_nothing_get_the_poses_of_a_model(flight, tmp_path):
    folder, posed = flight
    plain = tmp_path / "plain"
    for path in folder.iterdir():
        save(plain / path.name, plain_jpeg((800, 600)))
    write_model(tmp_path / "sparse", model_of(posed.photos))
    intake = photo_intake(plain, site_model(), colmap=tmp_path / "sparse")
    assert [photo.name for photo in intake.photos] == sorted(photo.name for photo in posed.photos)
    assert {finding.code for finding in intake.findings} >= {"model-as-it-is"}
    other = tmp_path / "other"
    save(other / "else.jpg", plain_jpeg())
    with pytest.raises(InputError, match="is a photo in"):
        photo_intake(other, site_model(), colmap=tmp_path / "sparse")


def test_photos_of_other_kinds_get_the_poses_of_a_model_and_need_one(flight, tmp_path):
    _, posed = flight
    pictures = tmp_path / "pictures"
    for photo in posed.photos:
        save(pictures / Path(photo.name).with_suffix(".png"), picture_of(photo, ".png"))
    as_png = [replace(photo, name=str(Path(photo.name).with_suffix(".png"))) for photo in posed.photos]
    write_model(tmp_path / "sparse", model_of(as_png))
    intake = photo_intake(pictures, site_model(), colmap=tmp_path / "sparse")
    assert [photo.name for photo in intake.photos] == sorted(photo.name for photo in as_png)
    assert all(intake.usable)
    with pytest.raises(InputError, match=r"3 of other kinds, the first .*\.png; save them as JPEG"):
        photo_intake(pictures, site_model())


def test_photos_that_lost_their_pose_have_that_of_the_model_that_others_lay_into_the_site(flight, tmp_path):
    folder, posed = flight
    mixed = tmp_path / "mixed"
    for path in folder.iterdir():
        save(mixed / path.name, path.read_bytes())
    lost = [replace(posed.photos[0], name="edited.jpg"), replace(posed.photos[1], name="edited.png")]
    for photo in lost:
        save(mixed / photo.name, picture_of(photo, Path(photo.name).suffix))
    model, site = model_of([*posed.photos, *lost]), site_model()
    write_model(tmp_path / "sparse", model)
    without = photo_intake(mixed, site)
    assert "edited.jpg" not in {photo.name for photo in without.photos}
    assert "photos-unposed" in {finding.code for finding in without.findings}
    intake = photo_intake(mixed, site, colmap=tmp_path / "sparse")
    assert {photo.name for photo in intake.photos} == {image.name for image in model.images.values()}
    assert "photos-unposed" not in {finding.code for finding in intake.findings}


def test_cameras_of_a_model_are_scaled_to_reduced_photos_but_not_to_cropped_ones(flight, tmp_path):
    _, posed = flight
    lens = posed.photos[0].intrinsics
    half, crop = (lens.width_px // 2, lens.height_px // 2), (lens.width_px, lens.height_px - 40)
    for photo, size in zip(posed.photos, (half, crop, (lens.width_px, lens.height_px)), strict=True):
        save(tmp_path / "reduced" / photo.name, plain_jpeg(size))
    write_model(tmp_path / "sparse", model_of(posed.photos))
    unposed = pose_photos(
        read_photos(tmp_path / "reduced").photos, site_model().site, tmp_path / "reduced", posed_elsewhere=True
    )
    found = choose_poses(unposed, tmp_path / "reduced", tmp_path / "sparse")
    lenses = {photo.name: photo.intrinsics for photo in found.photos}
    first, second, third = (lenses[photo.name] for photo in posed.photos)
    assert first == lens.scaled(*half)
    assert (second, third) == (lens, lens)
    (note,) = (finding for finding in found.findings if finding.code == "cameras-scaled")
    assert note.message.startswith("1 of 3 photos")


def test_images_named_from_the_root_are_photos_below_the_folder_and_none_outside_is_touched(flight, tmp_path):
    _, posed = flight
    plain, sizes = tmp_path / "plain", {}
    for photo in posed.photos:
        path = save(plain / photo.name, picture_of(photo, ".jpg"))
        sizes[path] = path.read_bytes()
    nothing = replace(posed, photos=(), metadata=(), lenses=())
    from_root = [replace(photo, name=str(plain / photo.name)) for photo in posed.photos]
    bent = replace(posed.photos[0].intrinsics, distortion=(-0.05, 0.01, 0.0, 0.0, 0.0))
    write_model(tmp_path / "sparse", model_of([replace(photo, intrinsics=bent) for photo in from_root]))
    found = choose_poses(nothing, plain, tmp_path / "sparse")
    assert [photo.name for photo in found.photos] == sorted(photo.name for photo in posed.photos)
    prepare(found.photos, site_model(), tmp_path / "dataset", PrepareParameters(n_points=50, normal_step=8))
    assert {path: path.read_bytes() for path in plain.rglob("*") if path.is_file()} == sizes
    assert (tmp_path / "dataset" / "images" / posed.photos[0].name).is_file()
    for number, name in enumerate(("../plain/a.jpg", str(tmp_path / "elsewhere" / "a.jpg"), "x/../../plain/a.jpg")):
        sparse = tmp_path / f"sparse-{number}"
        write_model(sparse, model_of([replace(posed.photos[0], name=name)]))
        with pytest.raises(InputError, match="does not lie below the folder of photos"):
            choose_poses(nothing, plain, sparse)


def test_lenses_that_were_refined_are_no_longer_called_unknown(flight, tmp_path):
    folder, posed = flight
    said = (Finding(Severity.NOTE, LENS_UNKNOWN, "bent lines"), Finding(Severity.NOTE, "height-reference", "heights"))
    posed = replace(posed, findings=said)
    assert findings_that_hold(posed, choose_poses(posed, folder)) == said
    for left_out, left in ((0, said[1:]), (1, said)):
        where = tmp_path / f"kept-{left_out}"
        write_refined(where, refinement(posed.photos, left_out), posed.photos, RefineParameters())
        assert findings_that_hold(posed, choose_poses(posed, folder, refine=RefineRequest(where))) == left


@pytest.mark.slow
def test_panels_that_were_found_are_solved_with_the_new_poses_and_keep_their_corrections(flight):
    folder, _ = flight
    model = site_model()
    intake = photo_intake(folder, model)
    draft = with_paths(draft_of(), [photo.path for photo in intake.photos])
    named = tuple(replace(photo, name=own.name) for photo, own in zip(draft.photos, intake.photos, strict=True))
    draft = replace(draft, photos=named)
    true = tuple(
        replace(photo, name=own.name, path=own.path, pose=replace(photo.pose, covariance=GOOD))
        for photo, own in zip(true_photos(), intake.photos, strict=True)
    )
    found = apply_poses(intake, draft, ChosenPoses(true), model, None)
    assert found.intake.photos == true
    assert not found.draft.unsolved
    assert found.draft.found.grids is draft.found.grids
    panels = found.draft.facade("A").panels
    assert len(panels) == len(draft.facade("A").panels)
    # Better poses make better corners.
    usual = [np.median([np.trace(p.covariance_m2[0]) for p in d.facade("A").panels]) for d in (draft, found.draft)]
    assert usual[1] < 0.5 * usual[0]
    assert apply_poses(intake, None, ChosenPoses(true), model, None).draft is None
