"""Learning reflections: what is near needs places, what is far does not; the same bits again; ends that are clean."""

import itertools
import math
from dataclasses import replace

import pytest
import torch

from planning.base.errors import OperationCancelled, ReconstructionError
from reconstruction.light import light_training
from reconstruction.light.config import (
    LEAST_STEPS,
    PAPER_STAGES,
    GlassLearned,
    GridSettings,
    HighFrequencyStage,
    ReflectionConfig,
)
from reconstruction.light.glass_rays import GlassRays, glass_rays
from reconstruction.light.losses import high_frequency_loss, ray_errors, ray_loss
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.light.shading import display_from_linear
from reconstruction.light.training import faster_precision, mean_square_error, new_panels, psnr_db, train_reflections
from tests.reconstruction.light.synthetic_folder import far, near, write_folder

GRID = GridSettings(most_cells=2048, levels=1, far_side=16, batch_share=1.0)
SMALL = ReflectionConfig(
    mlp=MlpShape(40, 4, 4, 3), environment_rows=16, grid=GRID, steps=150, batch=768, warm_up=20, precision="float32"
)
SHORT = replace(SMALL, steps=12, warm_up=3)
N_LEARNED = 20


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """The same of a few views of what is near."""
    return split_of(tmp_path_factory.mktemp("plain") / "photos", near, 4)


def split_of(folder, light, n_learned=N_LEARNED):
    write_folder(folder, light, n_learned + 4)
    source = read_photo_set(folder)
    learned, unseen = source.photos[:n_learned], source.photos[n_learned:]
    return glass_rays(source, learned), glass_rays(source, unseen), source.panels


def score(trained, rays):
    return psnr_db(mean_square_error(trained.panels, rays))


def weights(trained):
    return [value.clone() for value in trained.panels.state_dict().values()]


def scores(folder, light, *models):
    rays, unseen, planes = split_of(folder / "photos", light)
    return [score(train_reflections(rays, planes, model, SMALL), unseen) for model in models]


@pytest.mark.slow
def test_where_what_is_mirrored_is_near_places_are_needed(tmp_path):
    mlp, environment_map = scores(tmp_path, near, "mlp", "environment-map")
    assert mlp > environment_map + 3.0


@pytest.mark.slow
def test_where_it_is_far_directions_are_enough(tmp_path):
    mlp, environment_map, few_harmonics = scores(tmp_path, far, "mlp", "environment-map", "harmonics")
    assert environment_map > 33.0
    assert environment_map > mlp > 29.0
    assert 20.0 < few_harmonics < mlp


@pytest.mark.few(1)
@pytest.mark.parametrize("model", ["mlp", "environment-map", "harmonics", "radiance-grid"])
@pytest.mark.parametrize("precision", ["float32", "bfloat16"])
def test_the_same_seed_gives_the_same_bits_and_another_one_does_not(plain, model, precision):
    rays, unseen, planes = plain
    config = replace(SHORT, precision=precision)
    first, again, other = (
        train_reflections(rays, planes, model, replace(config, seed=seed), unseen=unseen if is_checked else None)
        for seed, is_checked in ((1, True), (1, False), (2, False))
    )
    assert all(torch.equal(a, b) for a, b in zip(weights(first), weights(again), strict=True))
    assert not all(torch.equal(a, b) for a, b in zip(weights(first), weights(other), strict=True))
    assert first.precision == precision
    assert first.n_steps == SHORT.steps
    assert all(value.dtype == torch.float32 for value in weights(first))


def test_the_history_has_times_that_rise_and_ends_with_the_result(plain):
    rays, unseen, planes = plain
    trained = train_reflections(rays, planes, "mlp", SHORT, unseen=unseen)
    times = [point.t_s for point in trained.history]
    assert times == sorted(times)
    assert len(times) == SHORT.steps
    assert trained.history[-1].value == pytest.approx(score(trained, unseen), abs=1e-3)
    assert trained.history[-1].value > trained.history[0].value
    assert train_reflections(rays, planes, "mlp", SHORT).history == ()


@pytest.mark.slow
def test_learning_leaves_the_number_of_threads_as_it_was(plain):
    rays, _, planes = plain
    before = torch.get_num_threads()
    train_reflections(rays, planes, "mlp", replace(SHORT, steps=2, threads=before + 1))
    assert torch.get_num_threads() == before


def test_a_time_limit_ends_it_with_what_there_is(plain):
    rays, unseen, planes = plain
    ticks = itertools.count()
    # Every look at the clock is half a second later than the one before.
    trained = train_reflections(
        rays, planes, "mlp", replace(SHORT, time_limit_s=2.0), unseen=unseen, clock=lambda: 0.5 * next(ticks)
    )
    assert trained.n_steps == 4
    assert trained.history[-1].t_s == 2.0


@pytest.mark.few(1)
@pytest.mark.parametrize("model", ["mlp", "environment-map", "harmonics", "radiance-grid"])
def test_who_looks_sees_ever_more_and_changes_nothing(plain, model, monkeypatch):
    monkeypatch.setattr(light_training, "LOOK_EVERY_S", 0.0)
    monkeypatch.setattr(light_training, "LOOK_SHARE", math.inf)
    rays, unseen, planes = plain
    seen = []

    def look(light):
        assert not light.panels.training
        seen.append((light.n_steps, score(light, unseen)))
        for value in light.panels.parameters():
            value.data.zero_()

    looked = train_reflections(rays, planes, model, SHORT, look=look)
    alone = train_reflections(rays, planes, model, SHORT)
    assert all(torch.equal(a, b) for a, b in zip(weights(looked), weights(alone), strict=True))
    assert [n_steps for n_steps, _ in seen] == list(range(1, SHORT.steps + 1))
    assert seen[-1] == (SHORT.steps, pytest.approx(score(alone, unseen), abs=1e-3))
    assert seen[-1][1] > seen[0][1]


def test_looks_take_a_small_share_of_the_time(plain):
    rays, _, planes = plain
    ticks, seen = itertools.count(), []

    def look(light):
        seen.append(light.seconds)
        for _ in range(12):
            next(ticks)

    # A step is a second, and a look some twelve.
    config = replace(SHORT, steps=600, batch=8, time_limit_s=600.0)
    train_reflections(rays, planes, "harmonics", config, clock=lambda: float(next(ticks)), look=look)
    assert seen[0] == light_training.LOOK_EVERY_S
    waits = [after - before for before, after in itertools.pairwise(seen)]
    assert waits
    assert min(waits) >= 12.0 / light_training.LOOK_SHARE


def test_cancelling_ends_it_at_once(plain):
    rays, _, planes = plain
    seen = []

    class Cancelling:
        def report(self, stage, done, total):
            seen.append((stage, done, total))
            if done == 3:
                raise OperationCancelled

    with pytest.raises(OperationCancelled):
        train_reflections(rays, planes, "mlp", SHORT, monitor=Cancelling())
    assert seen[-1] == ("learning reflections", 3, SHORT.steps)


def test_a_loss_that_is_no_number_is_an_error_that_says_what_to_do(plain):
    rays, _, planes = plain
    broken = replace(
        rays, table=replace(rays.table, lenses=rays.table.lenses * torch.tensor([1, 1, 1, 1, torch.nan, 1]))
    )
    with pytest.raises(ReconstructionError, match="step 1 of 12; lower the learning rates"):
        train_reflections(broken, planes, "mlp", SHORT)


@pytest.mark.slow
def test_an_mlp_whose_rates_are_too_high_dies_and_its_health_says_so(plain):
    rays, _, planes = plain
    some = replace(SMALL, steps=60)
    alive = train_reflections(rays, planes, "mlp", some)
    dead = train_reflections(rays, planes, "mlp", replace(some, warm_up=0, mlp_rate=0.3))
    assert alive.health.is_alive
    assert not dead.health.is_alive
    assert score(alive, rays) > score(dead, rays) + 2.0
    assert train_reflections(rays, planes, "environment-map", SHORT).health is None


def test_decay_shrinks_weights_of_an_mlp_s_hidden_layers_and_nothing_else(plain):
    rays, _, planes = plain
    for model in ("mlp", "environment-map"):
        panels = new_panels(rays, planes, model, SMALL, torch.Generator().manual_seed(0))
        light = panels.light
        before = {name: value.detach().clone() for name, value in light.named_parameters()}
        optimiser = torch.optim.AdamW(light.parameter_groups(replace(SMALL, mlp_decay=2.0)), weight_decay=0.0)
        for value in light.parameters():
            value.grad = torch.zeros_like(value)
        optimiser.step()
        for name, value in light.named_parameters():
            is_hidden = ".hidden." in name and name.endswith("weight")
            assert torch.allclose(value, before[name] * (1.0 - 2.0 * SMALL.mlp_rate if is_hidden else 1.0), rtol=1e-6)


@pytest.mark.slow
def test_with_decay_an_mlp_is_less_good_at_what_it_learned_from_and_not_at_the_rest(tmp_path):
    rays, unseen, planes = split_of(tmp_path / "photos", near, N_LEARNED)
    config = replace(SMALL, steps=400, passes=1000.0)
    plain, decayed = (train_reflections(rays, planes, "mlp", replace(config, mlp_decay=each)) for each in (0.0, 1.0))
    assert score(plain, rays) > score(decayed, rays) + 0.8
    assert score(decayed, unseen) > score(plain, unseen) - 0.2


def test_black_white_and_single_colours_are_learned_without_a_number_that_is_none(plain):
    rays, _, planes = plain
    for value in (0, 255):
        flat = replace(rays, colours=torch.full_like(rays.colours, value))
        for model in ("mlp", "environment-map", "harmonics"):
            trained = train_reflections(flat, planes, model, SHORT)
            assert all(weight.isfinite().all() for weight in weights(trained))


def test_panels_that_no_ray_shows_start_as_the_others_are_on_average(plain):
    rays, _, planes = plain
    some = rays[torch.nonzero(rays.panels < 3).squeeze(1)]
    panels = new_panels(some, planes, "mlp", SMALL, torch.Generator())
    means = panels.diffuse.means
    assert means.isfinite().all()
    assert ((means[5] > means[:3].min(dim=0).values) & (means[5] < means[:3].max(dim=0).values)).all()


def test_no_rays_are_a_wrong_call_and_have_no_error(plain):
    rays, _, planes = plain
    with pytest.raises(ValueError, match="at least one"):
        train_reflections(rays[:0], planes, "mlp", SHORT)
    panels = new_panels(rays, planes, "mlp", SMALL, torch.Generator())
    assert mean_square_error(panels, rays[:0]) != mean_square_error(panels, rays[:0])


@pytest.mark.slow
def test_the_vignette_is_learned_where_there_is_one(plain):
    rays, _, planes = plain
    found = []
    for loss in (0.0, 0.3):
        light = 0.4 * (1.0 - loss * rays.off_axis[:, None].expand(-1, 3))
        grey = replace(rays, colours=(255.0 * display_from_linear(light)).round().to(torch.uint8))
        trained = train_reflections(grey, planes, "harmonics", replace(SMALL, steps=80, panel_rate=0.03))
        found.append(trained.panels.corner_loss.item())
    # The harmonics of a few views explain some of it.
    assert found[0] == pytest.approx(0.0, abs=0.02)
    assert 0.2 < found[1] < 0.32


def test_the_precision_that_is_chosen_is_one_of_two_and_stays():
    shape = MlpShape(16, 2, 2, 2)
    found = faster_precision(shape, 64, 1)
    assert found in ("float32", "bfloat16")
    assert faster_precision(shape, 64, 1) == found


def test_the_high_frequency_loss_is_the_mean_of_errors_above_the_threshold():
    errors = torch.tensor([0.0, 0.1, 0.3, 0.5], requires_grad=True)
    found = high_frequency_loss(errors, 0.2)
    found.backward()
    assert found.item() == pytest.approx(0.4, rel=1e-5)
    assert errors.grad.tolist() == pytest.approx([0.0, 0.0, 0.5, 0.5], rel=1e-5)


def test_with_nothing_above_the_threshold_it_is_0_and_so_is_its_gradient():
    errors = torch.full((5,), 0.2, requires_grad=True)
    found = high_frequency_loss(errors, 0.2)
    found.backward()
    assert found.item() == 0.0
    assert errors.grad.tolist() == [0.0] * 5


def test_the_loss_of_rays_is_the_mean_per_channel_and_the_weighted_rest():
    found, truth = torch.tensor([[0.5, 0.5, 0.5], [0.0, 0.0, 0.0]]), torch.tensor([[0.5, 0.2, 0.6], [0.0, 0.0, 0.0]])
    errors = ray_errors(found, truth)
    assert errors.tolist() == pytest.approx([0.4, 0.0])
    assert ray_loss(errors, None).item() == pytest.approx(0.4 / 6)
    assert ray_loss(errors, HighFrequencyStage(0.2, 10.0)).item() == pytest.approx(0.4 / 6 + 4.0, rel=1e-5)


def test_the_papers_schedule_goes_from_its_first_values_to_its_last_in_steps():
    config = replace(SMALL, high_frequency=PAPER_STAGES)
    stages = [config.stage(progress) for progress in (0.0, 0.24, 0.25, 0.6, 0.999, 1.0)]
    assert (stages[0].threshold, stages[0].weight) == (0.2, 1.0)
    assert (stages[-1].threshold, stages[-1].weight) == (0.09, 10.0)
    assert stages[0] == stages[1] != stages[2]
    thresholds = [stage.threshold for stage in stages]
    assert thresholds == sorted(thresholds, reverse=True)
    assert SMALL.stage(0.5) is None


def test_few_rays_are_looked_at_so_often_and_many_for_so_long():
    config = ReflectionConfig(steps=1000, batch=8192, passes=9.0)
    assert config.steps_for(10**9) == 1000
    assert config.steps_for(500_000) == 550
    assert config.steps_for(10) == LEAST_STEPS
    assert replace(config, steps=50).steps_for(10) == 50


def test_rates_rise_over_the_warm_up_and_fall_to_their_last_share():
    rising = [SMALL.rate(step, step / SMALL.steps) for step in range(SMALL.warm_up)]
    assert rising == sorted(rising)
    assert rising[0] < 0.06
    assert SMALL.rate(10**6, 1.0) == pytest.approx(SMALL.last_rate)
    assert SMALL.rate(SMALL.warm_up, 0.0) == 1.0


@pytest.mark.parametrize(
    "changes",
    [
        {"steps": 0},
        {"batch": 0},
        {"threads": 0},
        {"memory_bytes": 0},
        {"mlp_rate": 0.0},
        {"mlp_decay": -0.1},
        {"mlp_decay": float("nan")},
        {"table_rate": float("nan")},
        {"passes": 0.0},
        {"panel_rate": float("inf")},
        {"last_rate": 0.0},
        {"warm_up": -1},
        {"held_out": 1.0},
        {"time_limit_s": 0.0},
    ],
)
def test_settings_that_make_no_sense_are_refused(changes):
    with pytest.raises(ValueError, match=next(iter(changes))):
        ReflectionConfig(**changes)


def test_rays_are_picked_by_rows_and_slices(plain):
    rays, _, _ = plain
    assert isinstance(rays[:5], GlassRays)
    assert torch.equal(rays[torch.tensor([3, 1])].rows, rays.rows[[3, 1]])


def test_a_radiance_grid_is_as_fine_as_its_box_in_the_end_also_where_time_ran_out(plain):
    rays, _, planes = plain
    ticks = itertools.count()
    config = replace(SHORT, grid=replace(GRID, levels=3), time_limit_s=2.0)
    trained = train_reflections(rays, planes, "radiance-grid", config, clock=lambda: 0.5 * next(ticks))
    light = trained.panels.light.light
    assert trained.n_steps == 4
    assert light.level == 0
    assert tuple(light.cells.shape) == (*reversed(trained.box.counts), 4)


def test_pose_corrections_of_a_training_are_saved_with_it_and_used_in_it(plain):
    rays, _, planes = plain
    config = replace(SHORT, learned=GlassLearned(rays=4, tilts=True, bows=True, poses=True))
    trained = train_reflections(rays, planes, "radiance-grid", config)
    assert trained.panels.light.moves.shape == (4, 6)
    for value in (trained.panels.light.moves, trained.panels.light.bows, trained.panels.light.tilts):
        assert value.detach().abs().max() > 0.0


def test_batches_and_rates_of_a_grid_are_its_own():
    config = ReflectionConfig(steps=900, batch=8000, grid=GridSettings(batch_share=0.25, rate=0.07, warm_up=5))
    assert (config.for_grid.batch, config.for_grid.steps) == (2000, 3600)
    assert (config.for_grid.table_rate, config.for_grid.warm_up) == (0.07, 5)


def test_a_grid_is_made_finer_step_by_step_over_the_first_part_of_a_training():
    grid = GridSettings(levels=3, grown=0.4)
    assert [grid.level(progress) for progress in (0.0, 0.09, 0.11, 0.25, 0.31, 0.4, 1.0)] == [3, 3, 2, 1, 0, 0, 0]
    assert GridSettings(levels=2, grown=0.0).level(0.0) == 0


@pytest.mark.parametrize(
    "changes", [{"cell": 0.0}, {"far_side": 12}, {"levels": -1}, {"reach_m": -1.0}, {"grown": 2.0}]
)
def test_settings_of_a_grid_that_make_no_sense_are_refused(changes):
    with pytest.raises(ValueError, match=next(iter(changes))):
        GridSettings(**changes)
