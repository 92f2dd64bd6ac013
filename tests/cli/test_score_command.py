"""`score segmentation` and `tradeoff segment`: tables, pictures and refusals."""

import csv
import json

import cv2
import numpy as np
import pytest

from groundstation.cli.options import SETS
from reconstruction.metrics.sets import SET_NAMES

QUICK = ("--seeds", 2, "--width", 480)


@pytest.mark.slow
def test_made_photos_are_scored_and_the_worst_shown(reflight, tmp_path):
    out = tmp_path / "new" / "scores"
    done = reflight("score", "segmentation", *QUICK, "-o", out, "--json")
    assert done.status == 0
    assert (done.json["set"], done.json["photos"]) == ("made-planar", 2)
    assert 0.0 <= done.json["individual_miou"]["worst"] <= done.json["individual_miou"]["mean"] <= 1.0
    assert set(done.json["coverage_percentiles"]) == {"20", "10", "5"}
    with (out / "segmentation-scores.csv").open(newline="") as file:
        assert [row["photo"] for row in csv.DictReader(file)] == ["planar-000", "planar-001"]
    assert all(cv2.imread(path) is not None for path in done.json["pictures"])
    options = ("--seeds", 1, "--first-seed", 7, "--width", 480, "--extent-unknown")
    text = reflight("score", "segmentation", *options, "-o", out).out
    assert "planar-007" in (out / "segmentation-scores.csv").read_text()
    assert "--first-seed: expected 0 or more" in reflight("score", "segmentation", "--first-seed", -1, "-o", out).error
    assert "individual mIoU" in text
    assert "coverage, 5 % percentile" in text


@pytest.mark.slow
def test_masks_of_another_method_are_scored_on_saved_photos(reflight, tmp_path):
    photos, masks = tmp_path / "photos", tmp_path / "masks"
    done = reflight("score", "segmentation", *QUICK, "-o", tmp_path / "a", "--save-photos", photos, "--json")
    assert done.status == 0
    masks.mkdir()
    for path in photos.iterdir():
        cv2.imwrite(str(masks / path.name), np.full(cv2.imread(str(path)).shape[:2], 255, np.uint8))
    done = reflight("score", "segmentation", *QUICK, "--masks", masks, "-o", tmp_path / "b", "--json")
    assert done.json["individual_miou"] is None
    assert done.json["coverage_percentiles"]["5"] == 1.0
    assert 0.0 < done.json["overall_iou"]["mean"] < 1.0
    (masks / "planar-001.png").unlink()
    error = reflight("score", "segmentation", *QUICK, "--masks", masks, "-o", tmp_path / "c").error
    assert "planar-001" in error
    assert not (tmp_path / "c").exists()


def test_own_photos_are_scored(reflight, tmp_path):
    index = np.zeros((60, 80), np.uint16)
    index[10:50, 10:70] = 1
    for folder, picture in (("images", np.full((60, 80, 3), 90, np.uint8)), ("truth", index)):
        (tmp_path / folder).mkdir()
        cv2.imwrite(str(tmp_path / folder / "a.png"), picture)
    folders = ("--images", tmp_path / "images", "--truth", tmp_path / "truth")
    done = reflight("score", "segmentation", "--set", "folder", *folders, "-o", tmp_path / "out", "--json")
    assert done.json["panels"] == 1
    assert (
        "name both with --images and --truth"
        in reflight("score", "segmentation", "--set", "folder", "-o", tmp_path / "x").error
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--set", "cmp"), "name it with --data"),
        (("--set", "cmp", "--data", "nowhere"), "expected annotated photos"),
        (("--seeds", "0"), "--seeds: expected 1 or more"),
        (("--width", "20"), "--width: expected 160"),
        (("--masks", "nowhere"), "expected a folder of pictures, found nothing"),
        (("--detector", "eyes"), "--detector: expected one of"),
    ],
)
def test_refusals_say_what_to_do_and_leave_nothing_behind(reflight, tmp_path, arguments, words):
    out = tmp_path / "out"
    assert words in reflight("score", "segmentation", "-o", out, *arguments).error
    assert not out.exists()


@pytest.mark.slow
def test_tradeoff_writes_a_row_a_setting_and_a_picture(reflight, tmp_path):
    knobs = ("--sizes", "240,480", "--samples", "32", "--detectors", "lsd")
    done = reflight("tradeoff", "segment", "-o", tmp_path, "--seeds", 1, "--width", 480, *knobs, "--json")
    assert done.status == 0
    names = [setting["setting"] for setting in done.json["settings"]]
    assert names == ["as asked", "image size 240", "image size 480", "samples of a row 32", "detector lsd"]
    with (tmp_path / "tradeoff-segment.csv").open(newline="") as file:
        assert [row["setting"] for row in csv.DictReader(file)] == names
    assert (tmp_path / "tradeoff-segment.png").read_bytes().startswith(b"\x89PNG")
    error = reflight("tradeoff", "segment", "-o", tmp_path / "x", "--detectors", "eyes").error
    assert "--detectors: expected gradient" in error
    error = reflight("tradeoff", "segment", "-o", tmp_path / "x", "--rectified-by", "round").error
    assert "--rectified-by: expected auto, exact" in error
    own = ("--set", "cmp", "--data", tmp_path, "--views", "1,2")
    assert "--views, --rectified-by: the photos of 'cmp'" in reflight("tradeoff", "segment", "-o", tmp_path, *own).error
    assert json.dumps(done.json, allow_nan=False)


def test_sets_offered_are_the_sets_there_are():
    assert set(SETS) == set(SET_NAMES)


def test_a_folder_called_model_is_a_models_folder_unless_two_names_follow(reflight, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for line in ("model photos", "model photos --views all", "model --lpips heads.pth photos", "model model photos"):
        refused = reflight("score", *line.split())
        assert refused.status == 1
        assert "model: holds no finished model" in refused.error
    assert "other: holds no finished model" in reflight("score", "model", "other", "photos").error
