"""Which model of light a scene calls for."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import torch

from planning.base.errors import OperationCancelled
from reconstruction.light import choose_light as choose_module
from reconstruction.light.choose_light import (
    FOLDS,
    MOST_WRONG,
    WHITE,
    Trials,
    choose_light,
    chosen,
    contenders,
    surely_more,
    trials_of,
    try_lights,
    white_of,
    with_splats,
)
from reconstruction.light.config import GridSettings, ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.radiance_grid import RadianceGrid, box_around, box_of
from reconstruction.light.training import mean_square_error, train_reflections
from reconstruction.metrics.image_metrics import psnr_db
from tests.reconstruction.light.synthetic_folder import far, near, write_folder

CONFIG = ReflectionConfig(environment_rows=32, steps=100, batch=512)


@pytest.fixture(scope="module", params=[near, far], ids=["near", "far"])
def found(request, tmp_path_factory):
    """Rays of a scene, and what was chosen."""
    folder = tmp_path_factory.mktemp("chosen") / "photos"
    write_folder(folder, request.param, 20)
    source = read_photo_set(folder)
    rays = glass_rays(source, source.photos)
    return request.param, rays, source.panels, choose_light(rays, source.panels, CONFIG)


@pytest.mark.slow
def test_near_things_call_for_a_radiance_grid_and_far_ones_for_an_environment_map(found):
    light, _, _, (name, (mirrors, is_near)) = found
    assert name == ("radiance-grid" if light is near else "environment-map")
    assert mirrors.on
    assert is_near.on == (light is near)
    assert "radiance grid" in str(is_near)
    assert is_near.unit == "dB"
    assert is_near.cost_s > 0.0


@pytest.mark.long
def test_the_choice_can_be_cancelled_and_one_photo_is_not_enough_for_one(found):
    _, rays, planes, _ = found

    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled

    with pytest.raises(OperationCancelled):
        choose_light(rays, planes, CONFIG, Cancelling())
    one = rays[torch.nonzero(rays.photos == 0).squeeze(1)]
    assert choose_light(one, planes, CONFIG) == ("environment-map", ())


@pytest.mark.slow
def test_kernels_that_are_compiled_first_do_not_count_for_the_trials(found, monkeypatch):
    _, rays, planes, (name, _) = found
    now_s = [0.0]
    march, is_compiled = RadianceGrid.forward, []

    def slow_at_first(grid, *args):
        now_s[0] += 0.0 if is_compiled else 20.0
        is_compiled.append(True)
        return march(grid, *args)

    monkeypatch.setattr(RadianceGrid, "forward", slow_at_first)
    limited = replace(CONFIG, time_limit_s=100.0)
    assert choose_light(rays, planes, limited, clock=lambda: now_s[0])[0] == name


@pytest.mark.parametrize(
    ("scores_db", "name"),
    [
        ((22.0, 24.0, 26.0), "radiance-grid"),
        ((22.0, 24.0, 24.2), "environment-map"),
        ((22.0, 24.0, 20.0), "environment-map"),
        ((30.0, 30.1, 30.2), "harmonics"),
        ((24.0, 20.0, 25.0), "radiance-grid"),
    ],
)
def test_the_cheaper_model_is_taken_where_the_other_is_no_better(scores_db, name):
    found, decisions = chosen(Trials(scores_db, 10.0))
    assert found == name
    assert all(decision.decided_by == "scene" for decision in decisions)


@pytest.mark.long
def test_the_box_holds_where_mirrored_rays_go_and_no_more_cells_than_are_allowed(found):
    _, rays, _, _ = found
    middle, table = rays.middle(), rays.table
    box = box_around(middle.points, middle.omega_r, table.normals[rays.panels], 2.0, 0.05, 0.5, 20_000)
    x, y, z = box.counts
    assert 10_000 < x * y * z < 26_000
    ends = middle.points + 1.8 * middle.omega_r
    inside = (box.turned(ends) - box.turned(torch.tensor([box.middle]))).abs() <= torch.tensor(box.halves)
    assert inside.float().mean(dim=0).min() > 0.9
    assert box.counts_at(1) == tuple(-(-n // 2) for n in box.counts)
    # Panels look south: that is where the box's own y axis points.
    assert torch.allclose(box.turned(torch.tensor([[0.0, -1.0, 0.0]])), torch.tensor([[0.0, 1.0, 0.0]]), atol=1e-6)
    assert box_of(rays, GridSettings(reach_m=30.0), len(rays)).reach == pytest.approx(30.0 / float(table.half_side_m))
    few, many = (box_of(rays, GridSettings(cell=0.01), n).counts for n in (10_000, 100_000))
    assert few[0] * few[1] * few[2] < 0.2 * many[0] * many[1] * many[2]


def test_gains_count_as_far_as_they_are_beyond_what_photos_differ_in():
    alike = np.tile([16.0, 17.0, 18.0], (4, 1))
    assert chosen(trials_of(alike, 1.0))[0] == "radiance-grid"
    # The same means, but the grid is better in one photo alone.
    apart = alike + np.array([[0.0, 0.0, 6.0], *[[0.0, 0.0, -2.0]] * 3])
    trials = trials_of(apart, 1.0)
    assert trials.scores_db == trials_of(alike, 1.0).scores_db
    assert trials.unsure_db[1] == pytest.approx(2.0)
    assert chosen(trials)[0] == "harmonics"
    assert trials_of(alike[:1], 1.0).unsure_db == (0.0, 0.0)


@pytest.mark.long
def test_looking_at_more_and_more_photos_misleads_no_more_often_than_is_said():
    rng, n_wrong, n_clear, n_drawn = np.random.default_rng(0), 0, 0, 2000
    for _ in range(n_drawn):
        # The true gain is the tolerance, or well beyond it: who says "more" or "less" of the first is wrong.
        noise = rng.normal(0.0, 1.0, (FOLDS, 6))
        looks = [noise[: number + 1].ravel() for number in range(FOLDS)]
        n_wrong += any(surely_more(0.3 + seen, 0.3, FOLDS) is not None for seen in looks)
        n_clear += surely_more(3.3 + looks[-1], 0.3, FOLDS) is True
    assert 0.25 * MOST_WRONG < n_wrong / n_drawn <= MOST_WRONG
    assert n_clear == n_drawn
    assert surely_more(-3.0 + noise[0], 0.3, FOLDS) is False
    assert surely_more(np.array([9.0]), 0.3, FOLDS) is None


@pytest.mark.long
@pytest.mark.parametrize(("spread_db", "n_folds"), [(0.05, 1), (6.0, FOLDS)])
def test_photos_are_held_back_again_only_while_those_before_do_not_tell(found, monkeypatch, spread_db, n_folds):
    _, rays, planes, _ = found
    rng, tried = np.random.default_rng(0), []
    levels = {"harmonics": 20.0, "environment-map": 23.0, "radiance-grid": 23.1}

    def named(model, *_):
        tried.append(model)
        return choose_module.TrainedReflections(model, model, CONFIG, planes, 1.0, "float32", 1, 1, 1.0, (), None)

    monkeypatch.setattr(choose_module, "_tried", named)
    monkeypatch.setattr(choose_module, "mean_square_error", lambda model, _: levels[model] + rng.normal(0.0, spread_db))
    monkeypatch.setattr(choose_module, "psnr_db", lambda score: score)
    found = try_lights(rays, planes, CONFIG)
    assert len(tried) == 3 * (n_folds + 1)
    assert len(found.unseen) == 4
    if n_folds == 1:
        assert chosen(found.trials)[0] == "environment-map"


@pytest.mark.parametrize(
    ("scores_db", "name", "others"),
    [
        ((18.9, 19.7, 20.2), "environment-map", ("radiance-grid",)),
        ((18.9, 19.7, 19.6), "environment-map", ()),
        ((18.9, 19.7, 22.0), "radiance-grid", ()),
        ((18.9, 18.9, 19.0), "harmonics", ()),
    ],
)
def test_a_grid_that_may_be_better_is_tried_with_splats_beside_the_environment_map(scores_db, name, others):
    assert contenders(Trials(scores_db, 1.0), name) == others
    near = with_splats({"environment-map": 19.5, "radiance-grid": 20.3, "harmonics": 19.4}, 10.0)
    assert near.on
    assert near.size == pytest.approx(0.8)
    assert "20.3 dB with a radiance grid, 19.5 dB with an environment map" in near.reason


@pytest.mark.long
@pytest.mark.few(1)
def test_of_few_photos_others_are_held_back_again_and_again(found):
    _, rays, planes, _ = found
    tried = try_lights(rays, planes, replace(CONFIG, steps=2))
    assert len(tried.unseen) == 4
    assert set(tried.found) == {"harmonics", "environment-map", "radiance-grid"}
    assert max(tried.trials.unsure_db) > 0.0
    assert try_lights(rays[torch.nonzero(rays.photos == 0).squeeze(1)], planes, CONFIG) is None


def overexpose(folder, times):
    """Put so many times the light into a folder's photos, with white that JPEG and smaller pictures leave of clipped
    light: a little less than white."""
    for path in (folder / "images").iterdir():
        light = times * (cv2.imread(str(path)) / 255.0) ** 2.2
        ragged = np.random.default_rng(len(str(path.name))).uniform(0.985, 1.0, light.shape)
        display = np.where(light >= 1.0, ragged, np.minimum(light, 1.0) ** (1.0 / 2.2))
        cv2.imwrite(str(path), np.round(255.0 * display).astype(np.uint8))


def test_values_next_to_white_say_at_least_where_photos_are_overexposed(tmp_path):
    write_folder(tmp_path / "dark", far, 8)
    dark = read_photo_set(tmp_path / "dark")
    white, decision = white_of(dark, dark.photos)
    assert (white, decision.on, decision.size) == (1.0, False, 0.0)
    assert white_of(dark, dark.photos, "on")[0] == WHITE
    write_folder(tmp_path / "bright", far, 8)
    overexpose(tmp_path / "bright", 4.0)
    bright = read_photo_set(tmp_path / "bright")
    white, decision = white_of(bright, bright.photos)
    assert (white, decision.on) == (WHITE, True)
    assert decision.size > 0.1
    assert white_of(bright, bright.photos, "off")[0] == 1.0


@pytest.mark.slow
def test_what_is_overexposed_is_told_better_by_at_least_and_the_rest_is_the_same(tmp_path):
    write_folder(tmp_path / "truth", near, 16)
    write_folder(tmp_path / "bright", near, 16)
    overexpose(tmp_path / "bright", 4.0)
    truth, bright = (read_photo_set(tmp_path / name) for name in ("truth", "bright"))
    rays, clipped = (glass_rays(each, each.photos) for each in (truth, bright))
    learned, plain = {}, {}
    for white in (1.0, WHITE):
        config = replace(CONFIG, steps=300, white=white)
        panels = train_reflections(clipped, bright.panels, "radiance-grid", config).panels
        # Exposed for less light, it shows what the photos could not.
        learned[white] = psnr_db(mean_square_error(panels, rays, 0.25))
        plain[white] = train_reflections(rays, truth.panels, "radiance-grid", replace(config, steps=20)).panels
    assert learned[WHITE] > learned[1.0] + 1.0
    pairs = zip(*(plain[white].state_dict().values() for white in (1.0, WHITE)), strict=True)
    assert all(torch.equal(a, b) for a, b in pairs)
