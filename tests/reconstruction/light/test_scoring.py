"""Scores of views, and learning from one folder for another."""

import json
import math
import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest
import torch

from planning.base.errors import InputError, OperationCancelled
from reconstruction.base.cameras import Intrinsics
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import glass_rays, rays_of_photo
from reconstruction.light.photo_set import PanelPlanes, held_out_names, read_photo_set
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.light.shading import display_from_linear, linear_from_display
from reconstruction.light.training import ReflectionScore, ViewScore, score_views, train_reflections
from reconstruction.tradeoff.scene_downstream import downstream_psnr
from tests.reconstruction.light.synthetic_folder import far, near, write_folder

SMALL = ReflectionConfig(
    mlp=MlpShape(32, 4, 4, 3), environment_rows=16, steps=60, batch=512, warm_up=10, precision="float32"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Photos of what is far; tests must not change them."""
    made = tmp_path_factory.mktemp("scored") / "photos"
    write_folder(made, far, 10)
    return made


@pytest.fixture(scope="module")
def trained(folder):
    """An environment map of them."""
    source = read_photo_set(folder)
    return train_reflections(glass_rays(source, source.photos), source.panels, "environment-map", SMALL)


@pytest.mark.slow
def test_a_views_score_is_the_psnr_of_its_glass_pixels(folder, trained):
    source = read_photo_set(folder)
    photo = source.photos[0]
    score = score_views(trained, source, [photo.name])
    rays = rays_of_photo(source, photo)
    with torch.no_grad():
        off = trained.panels(rays).clamp(0.0, 1.0).double().numpy() - rays.colours.numpy() / 255.0
    assert score.views == (
        ViewScore(photo.name, len(rays), pytest.approx(-10 * math.log10((off**2).mean()), abs=1e-4)),
    )
    assert score.mean_db == score.worst_db


def test_mean_and_worst_of_a_score():
    score = ReflectionScore((ViewScore("a", 300, 20.0), ViewScore("b", 900, 30.0)), 1)
    assert (score.mean_db, score.worst_db) == (25.0, 20.0)


def test_views_with_little_glass_are_left_out_and_counted(tmp_path, trained):
    small = Intrinsics(12, 9, 10.8, 10.8, 6.0, 4.5)
    write_folder(tmp_path / "small", far, 3, lens=small)
    source = read_photo_set(tmp_path / "small")
    with pytest.raises(InputError, match="none of the 3 views"):
        score_views(trained, source, [photo.name for photo in source.photos])


def test_views_of_other_panels_and_views_that_are_not_there_are_refused(folder, trained):
    source = read_photo_set(folder)
    with pytest.raises(InputError, match=r"no photo 'p99\.png'"):
        score_views(trained, source, ["p00.png", "p99.png"])
    moved = replace(source, panels=PanelPlanes(source.panels.corners_enu_m + 0.01))
    with pytest.raises(InputError, match="other panels"):
        score_views(trained, moved, ["p00.png"])


def test_another_exposure_is_made_up_for(folder, trained, tmp_path):
    darker = tmp_path / "darker"
    write_folder(darker, far, 10, exposure=0.5)
    names = ["p00.png", "p01.png"]
    here, there = (score_views(trained, read_photo_set(path), names).mean_db for path in (folder, darker))
    (darker / "scene.json").unlink()
    assert there > here - 1.0
    assert score_views(trained, read_photo_set(darker), names).mean_db < here - 5.0


@pytest.mark.slow
def test_photos_that_were_exposed_one_by_one_are_as_good_where_the_folder_says_how(folder, tmp_path):
    metered = shutil.copytree(folder, tmp_path / "metered")
    captures = {}
    for number, path in enumerate(sorted((metered / "images").iterdir())):
        factor = captures[path.name] = {"exposure": (0.4, 0.6, 1.0)[number % 3]}
        shown = torch.from_numpy(cv2.imread(str(path)) / 255.0)
        darker = display_from_linear(factor["exposure"] * linear_from_display(shown))
        cv2.imwrite(str(path), (255.0 * darker).round().numpy().astype(np.uint8))
    unknown = downstream_psnr(metered, metered, "environment-map", SMALL).score.mean_db
    (metered / "scene.json").write_text(json.dumps({"exposure": 1.0, "captures": captures}))
    known = downstream_psnr(metered, metered, "environment-map", SMALL).score.mean_db
    assert known > unknown + 3.0
    assert known > downstream_psnr(folder, folder, "environment-map", SMALL).score.mean_db - 1.0


@pytest.mark.slow
def test_what_is_learned_from_the_right_photos_scores_higher_than_from_wrong_ones(folder, tmp_path):
    write_folder(tmp_path / "wrong", near, 10)
    right = downstream_psnr(folder, folder, "environment-map", SMALL)
    wrong = downstream_psnr(tmp_path / "wrong", folder, "environment-map", SMALL)
    assert right.held_out == wrong.held_out == held_out_names([f"p{k:02d}.png" for k in range(10)], 0.15, 0)
    assert right.n_views == wrong.n_views == 8
    assert right.score.mean_db > wrong.score.mean_db + 3.0
    assert right.trained.history[-1].value == pytest.approx(right.score.mean_db, abs=3.0)


@pytest.mark.slow
def test_held_out_views_are_not_learned_from(folder, tmp_path):
    spoilt = shutil.copytree(folder, tmp_path / "spoilt")
    for name in held_out_names([f"p{k:02d}.png" for k in range(10)], 0.15, 0):
        cv2.imwrite(str(spoilt / "images" / name), np.zeros((30, 40, 3), np.uint8))
    whole, without = (downstream_psnr(path, folder, "environment-map", SMALL) for path in (folder, spoilt))
    assert without.score == whole.score


def test_folders_that_do_not_serve_are_refused(folder, tmp_path):
    with pytest.raises(InputError, match="dataset"):
        downstream_psnr(tmp_path, folder, "mlp", SMALL)
    blank = shutil.copytree(folder, tmp_path / "blank")
    for path in (blank / "panels").iterdir():
        cv2.imwrite(str(path), np.zeros((30, 40), np.uint16))
    with pytest.raises(InputError, match="whole on a panel"):
        downstream_psnr(blank, folder, "mlp", SMALL)
    with pytest.raises(ValueError, match="environment-map"):
        downstream_psnr(folder, folder, "oracle", SMALL)


@pytest.mark.parametrize("last", ["reading rays", "learning reflections", "scoring views"])
def test_every_stage_can_be_cancelled(folder, last):
    class Cancelling:
        def report(self, stage, done, total):
            if stage == last:
                raise OperationCancelled

    with pytest.raises(OperationCancelled):
        downstream_psnr(folder, folder, "environment-map", replace(SMALL, steps=3), Cancelling())
