"""The joint training: it learns, goes on bit by bit, and survives what it says it survives."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from planning.base.errors import InputError, OperationCancelled, ReconstructionError
from planning.base.progress import Trace
from reconstruction.light.config import GridSettings, ReflectionConfig
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.splats.rasterising import numba_backend
from reconstruction.training import trainer as trainer_module
from reconstruction.training import training_state
from reconstruction.training.callbacks import Callbacks, HeldOut
from reconstruction.training.config import LossWeights, TrainConfig
from reconstruction.training.photos.photo_stream import PhotoStream, StreamSettings
from reconstruction.training.photos.poses import OwnPoses, PoseCorrections
from reconstruction.training.photos.transients import Transients
from reconstruction.training.start import start_model
from reconstruction.training.timer import Timer
from reconstruction.training.trainer import Trainer, strategy_of
from reconstruction.training.training_state import MOST_HALVINGS, read_checkpoint

CONFIG = TrainConfig(
    method="2dgs", iterations=12, n_splats=150, max_splats=220, densify_from=0.2, densify_until=0.9, score_every_s=1e9
)


TINY = ReflectionConfig(
    mlp=MlpShape(width=16, layers=4, position_order=3, direction_order=2),
    environment_rows=8,
    steps=8,
    batch=256,
    precision="float32",
    grid=GridSettings(most_cells=2000, far_side=8, rest=4),
)


class FakeClock:
    """Stands still but for what is put on it."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now

    def lasting(self, seconds, true=lambda *_: None):
        """A function, and the time that it takes."""

        def done(*arguments):
            self.now += seconds
            return true(*arguments)

        return done


class Cancelling:
    """Cancels at the n-th report of training."""

    def __init__(self, n):
        self.left = n

    def report(self, stage, done, total):
        self.left -= stage == "training"
        if self.left < 0:
            raise OperationCancelled("enough")


@pytest.fixture
def make(data_set, tmp_path, request):
    source = read_photo_set(data_set)

    def made(config=CONFIG, checkpoint=None, **more):
        start = start_model(source, config)
        names = [photo.name for photo in start.learned]
        photos = PhotoStream(source, names, start.model.origin_enu_m, StreamSettings(window_px=config.window_px))
        request.addfinalizer(photos.close)
        shown = PhotoStream(source, start.held_out, start.model.origin_enu_m)
        request.addfinalizer(shown.close)
        path = None if checkpoint is None else tmp_path / checkpoint
        strategy = strategy_of(config, len(start.model.splats))
        return Trainer(
            start.model,
            start.exposures,
            PoseCorrections(start.learned, start.model.origin_enu_m),
            Transients([(photo.intrinsics.width_px, photo.intrinsics.height_px) for photo in start.learned]),
            photos,
            strategy,
            config,
            shown=[HeldOut(shown.frame(0), 1.0)],
            extent_m=start.extent_m,
            checkpoint=path,
            **more,
        )

    return made


def everything(trainer):
    parts = (trainer.model, trainer.exposures, trainer.poses, trainer.transients)
    return {f"{number}.{name}": value for number, part in enumerate(parts) for name, value in part.state_dict().items()}


def assert_same(one, other):
    mine, theirs = everything(one), everything(other)
    assert mine.keys() == theirs.keys()
    assert all(torch.equal(mine[name], theirs[name]) for name in mine)


@pytest.mark.slow
def test_pictures_of_unseen_views_get_better(make):
    trainer = make(replace(CONFIG, iterations=30, densification="none"))
    trace, previews = Trace(), []
    trainer.run(Callbacks(trace=trace, preview=previews.append))
    assert trainer.at.step == 30
    first, last = trace.points[0].value, trace.points[-1].value
    assert last > first + 1.0
    assert trainer.at.history[-1][1] == last
    assert previews[0].picture.shape == (30, 40, 3)
    assert previews[-1].step == 30


@pytest.mark.slow
def test_splats_are_added_and_stay_below_their_number(make):
    trainer = make(replace(CONFIG, iterations=105, densify_from=0.0, densify_until=1.0, densification="mcmc"))
    n_before = len(trainer.model.splats)
    trainer.run(Callbacks())
    assert n_before < len(trainer.model.splats) <= 220


def test_the_rasteriser_takes_all_cores_and_the_same_bits_come_out_with_one(make, monkeypatch):
    asked, run = [], numba_backend.run_on_threads

    def told(work, ranges, threads):
        asked.append(threads)
        run(work, ranges, threads)

    monkeypatch.setattr(numba_backend, "run_on_threads", told)
    trainers = [make(replace(CONFIG, iterations=3, raster=replace(CONFIG.raster, threads=n))) for n in (0, 1, 3)]
    for trainer, threads in zip(trainers, (CONFIG.raster.threads, 1, 3), strict=True):
        asked.clear()
        trainer.run(Callbacks())
        assert set(asked) == {threads} == {trainer.config.raster.threads}
        assert_same(trainer, trainers[0])
    assert CONFIG.raster.threads == 0


def test_a_time_limit_is_gone_through_from_the_joint_training_s_own_beginning(make):
    now = [40.0]
    watch = Timer(lambda: now[0], 0.0)
    trainer = make(replace(CONFIG, iterations=100, time_limit_s=100.0), watch=watch)
    found = []
    for seconds in (40.0, 70.0, 97.0, 200.0):
        now[0] = trainer.at.spent_s = seconds
        found.append(trainer.progress)
    assert found == pytest.approx([0.0, 0.5, 0.95, 1.0])
    trainer.at.spent_s, trainer.at.step = 41.0, 60
    assert trainer.progress == pytest.approx(0.6)


def test_where_learning_light_took_all_the_time_there_is_no_step(make):
    trainer = make(replace(CONFIG, time_limit_s=30.0), watch=Timer(lambda: 40.0, 0.0))
    assert trainer.progress == 1.0


@pytest.mark.slow
def test_splats_are_added_only_between_the_shares_that_are_told(make):
    config = replace(CONFIG, iterations=220, densify_from=0.7, densify_until=0.95, densification="mcmc", max_splats=400)
    trainer, numbers = make(config), []
    trainer.run(Callbacks(visit=lambda at: numbers.append((at.step, len(at.model.splats)))))
    changes = [step for (step, n), (_, before) in zip(numbers[1:], numbers, strict=False) if n != before]
    assert changes
    assert all(0.7 * 220 < step <= 0.95 * 220 + 1 for step in changes)


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("light", [None, "harmonics", "environment-map", "mlp", "radiance-grid"])
def test_interrupted_training_goes_on_bit_by_bit(make, tmp_path, light):
    config = CONFIG if light is None else replace(CONFIG, method="refglass-gs", light=light, reflections=TINY)
    whole = make(config)
    whole.run(Callbacks())
    first = make(config, checkpoint="c")
    with pytest.raises(OperationCancelled):
        first.run(Callbacks(Cancelling(6)))
    assert 0 < first.at.step < 12
    second = make(config, checkpoint="c")
    second.restore(read_checkpoint(tmp_path / "c")["training"])
    assert second.at.step == first.at.step
    second.run(Callbacks())
    assert second.at.step == 12
    assert_same(whole, second)


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("setting", ["on", "auto", "off"])
def test_poses_are_corrected_where_they_are_to_be_and_go_on_bit_by_bit(make, tmp_path, setting):
    config = replace(CONFIG, own_poses=setting, transients=setting)
    whole, first, second = make(config), make(config, checkpoint="c"), make(config, checkpoint="c")
    whole.run(Callbacks())
    with pytest.raises(OperationCancelled):
        first.run(Callbacks(Cancelling(6)))
    second.restore(read_checkpoint(tmp_path / "c")["training"])
    second.run(Callbacks())
    assert all(torch.equal(value, second.poses.state_dict()[name]) for name, value in whole.poses.state_dict().items())
    is_on = setting == "on" or (setting == "auto" and float(whole.poses.shift_px) > OwnPoses().tolerance)
    assert bool(whole.poses.pixels.any()) is is_on


def test_an_mlp_s_weights_decay_in_the_joint_training_and_nothing_else_does(make):
    light = replace(TINY, mlp_decay=0.7)
    trainer = make(replace(CONFIG, method="refglass-gs", light="mlp", reflections=light))
    decays = [group for group in trainer.optimiser.param_groups if group["weight_decay"] != 0.0]
    assert [(group["name"], group["weight_decay"]) for group in decays] == [("light 0", 0.7)]
    hidden = trainer.model.light.light.hidden
    assert {id(value) for value in decays[0]["params"]} == {id(layer.weight) for layer in hidden}


@pytest.mark.slow
def test_with_other_seeds_trainings_differ(make):
    one, other = make(), make(replace(CONFIG, seed=1))
    one.run(Callbacks())
    other.run(Callbacks())
    assert not torch.equal(one.model.splats.sh, other.model.splats.sh)


def test_a_step_without_numbers_is_undone_and_rates_are_halved(make, monkeypatch):
    trainer = make()
    trainer.step()
    before = {name: value.clone() for name, value in everything(trainer).items()}
    true_objective = trainer_module.objective
    nan = lambda picture, *_: (picture.display.sum() * math.nan, {})  # noqa: E731
    monkeypatch.setattr(trainer_module, "objective", nan)
    trainer._survived_step()
    assert all(torch.equal(value, before[name]) for name, value in everything(trainer).items())
    assert (trainer.at.step, trainer.at.factor) == (1, 0.5)
    assert "undone" in trainer.at.notes[0]
    monkeypatch.setattr(trainer_module, "objective", true_objective)
    trainer.run(Callbacks())
    assert trainer.at.step == 12
    assert trainer.at.factor == 0.5


def test_infinite_gradients_are_noticed_though_the_loss_is_a_number(make, monkeypatch):
    trainer = make()

    def steep(picture, *_):
        light = picture.display.sum()
        # The root's slope has no end at 0.
        return torch.sqrt(light - light.detach()) + 0.0 * light, {}

    monkeypatch.setattr(trainer_module, "objective", steep)
    trainer._survived_step()
    assert trainer.at.n_undone == 1
    assert all(bool(torch.isfinite(value).all()) for value in everything(trainer).values())


def test_a_training_that_gives_no_numbers_ends_and_leaves_the_last_good_checkpoint(make, monkeypatch, tmp_path):
    trainer = make(checkpoint="c")
    trainer.step()
    trainer.save()
    monkeypatch.setattr(trainer_module, "objective", lambda picture, *_: (picture.display.sum() * math.nan, {}))
    with pytest.raises(ReconstructionError, match=r"step 2: .*last checkpoint, .* is good"):
        trainer.run(Callbacks())
    assert trainer.at.n_undone == MOST_HALVINGS + 1
    monkeypatch.undo()
    again = make(checkpoint="c")
    again.restore(read_checkpoint(tmp_path / "c")["training"])
    assert again.at.step == 1
    again.run(Callbacks())


def test_a_checkpoint_from_before_looks_had_a_date_goes_on_and_one_that_lacks_more_is_refused(make, tmp_path):
    trainer = make(checkpoint="c")
    trainer.step()
    trainer.save()
    state = read_checkpoint(tmp_path / "c")["training"]
    assert "seen_at" in state["transients"]
    undated = {name: value for name, value in state["transients"].items() if name != "seen_at"}
    again = make(checkpoint="c")
    again.restore(state | {"transients": undated})
    assert again.at.step == 1
    again.run(Callbacks())
    without = {name: value for name, value in undated.items() if name != "errors"}
    with pytest.raises(InputError):
        make().restore(state | {"transients": without})


def test_spoiled_splats_are_taken_from_the_last_checkpoint(make):
    trainer = make(checkpoint="c")
    trainer.step()
    trainer.save()
    trainer.step()
    with torch.no_grad():
        trainer.model.splats.sh[:, 0] = math.nan
    trainer.save()
    trainer._survived_step()
    assert trainer.at.step == 1
    assert "went back to step 1" in trainer.at.notes[-1]
    assert bool(torch.isfinite(trainer.model.splats.sh).all())
    assert trainer.at.factor == 0.5
    trainer.run(Callbacks())
    assert trainer.at.step == 12


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        RuntimeError("[enforce fail] DefaultCPUAllocator: can't allocate memory: you tried to allocate 9 bytes"),
    ],
)
def test_when_memory_runs_out_windows_are_halved_and_nothing_is_lost(make, monkeypatch, error):
    trainer = make()
    before = {name: value.clone() for name, value in everything(trainer).items()}
    forward = type(trainer.model).forward

    def greedy(self, view, *arguments, **more):
        if view.width_px * view.height_px > 20 * 15 and torch.is_grad_enabled():
            raise error
        return forward(self, view, *arguments, **more)

    monkeypatch.setattr(training_state, "SMALLEST_WINDOW_PX", 100)
    monkeypatch.setattr(type(trainer.model), "forward", greedy)
    trainer._survived_step()
    assert trainer.photos.window_px == 40 * 30 // 2
    assert all(torch.equal(value, before[name]) for name, value in everything(trainer).items())
    trainer.run(Callbacks())
    assert trainer.at.step == 12
    assert trainer.photos.window_px <= 20 * 15
    assert all("memory ran out at step 1:" in note for note in trainer.at.notes)


def test_without_any_memory_it_ends_in_words(make, monkeypatch):
    trainer = make()
    monkeypatch.setattr(type(trainer.model), "forward", lambda *_, **__: (_ for _ in ()).throw(MemoryError()))
    with pytest.raises(ReconstructionError, match=r"no memory for \d+ splats and windows of 1200 pixels"):
        trainer._survived_step()


def test_other_errors_are_not_swallowed(make, monkeypatch):
    trainer = make()
    monkeypatch.setattr(type(trainer.model), "forward", lambda *_, **__: (_ for _ in ()).throw(RuntimeError("size")))
    with pytest.raises(RuntimeError, match="size"):
        trainer._survived_step()


def timed(make, monkeypatch, limit_s, step_s=1.0, look_s=0.0, save_s=0.0, before_s=0.0):
    """A training whose parts take known times, and its clock, which began at 100 s."""
    clock = FakeClock()
    trainer = make(replace(CONFIG, iterations=10_000, time_limit_s=limit_s), "c", watch=Timer(clock, 100.0 - before_s))
    monkeypatch.setattr(trainer, "step", clock.lasting(step_s, trainer.step))
    monkeypatch.setattr(trainer_module, "quality_db", clock.lasting(look_s, lambda *_: 20.0))
    monkeypatch.setattr(trainer_module, "write_checkpoint", clock.lasting(save_s))
    return trainer, clock


def test_time_limits_end_it_with_rates_at_their_last(make, monkeypatch):
    trainer, _ = timed(make, monkeypatch, 8.0)
    trainer.run(Callbacks())
    assert trainer.at.step == 8
    full = {group["name"]: group["full"] for group in trainer.optimiser.param_groups}
    lr = {group["name"]: group["lr"] for group in trainer.optimiser.param_groups}
    assert lr["colours"] < 0.3 * full["colours"]


@pytest.mark.parametrize(
    ("n_steps", "expected"), [(50.0, 12288), (500.0, 24576), (1000.0, 49152), (1e5, 49152), (0.0, 12288)]
)
def test_windows_are_as_small_as_leaves_room_for_enough_steps(n_steps, expected):
    assert trainer_module.fitting_window_px(49152, n_steps) == expected
    assert trainer_module.fitting_window_px(5000, n_steps) == 5000


def test_windows_are_made_smaller_once_where_few_steps_fit_into_the_time(make, monkeypatch):
    monkeypatch.setattr(trainer_module, "LEAST_WINDOW_PX", 100)
    trainer, _ = timed(make, monkeypatch, 11.0)
    trainer.run(Callbacks())
    assert trainer.at.step == 11
    assert trainer.at.window_px == trainer.photos.window_px == 300
    assert trainer.n_pixels <= 300
    (note,) = trainer.at.notes
    assert "300 pixels" in note
    assert "11 steps with 1200" in note


def test_windows_stay_where_enough_steps_fit_into_the_time(make, monkeypatch):
    monkeypatch.setattr(trainer_module, "LEAST_WINDOW_PX", 100)
    trainer, _ = timed(make, monkeypatch, 11.0)
    monkeypatch.setattr(trainer_module, "ENOUGH_STEPS", 11)
    trainer.run(Callbacks())
    assert trainer.n_pixels == 1200
    assert not trainer.at.notes


def test_it_tells_how_long_it_will_go_on_whatever_went_before(make, monkeypatch):
    trainer, clock = timed(make, monkeypatch, 25.0, before_s=5.0)
    left = []
    trainer.run(Callbacks(visit=lambda at: left.append((at.left_s, 120.0 - clock()))))
    assert left[0][0] is None
    for told, true in left[2:-1]:
        assert told == pytest.approx(true, abs=1.1)
    assert left[-1][0] == pytest.approx(0.0, abs=0.1)


def test_what_went_before_counts_for_the_time_limit(make, monkeypatch):
    trainer, _ = timed(make, monkeypatch, 8.0, before_s=5.0)
    trainer.run(Callbacks())
    assert trainer.at.step == 3


@pytest.mark.slow
def test_looks_and_files_count_for_the_time_limit_and_have_time_in_the_end(make, monkeypatch):
    trainer, clock = timed(make, monkeypatch, 60.0, look_s=4.0, save_s=3.0)
    trainer.save()
    trainer.run(Callbacks())
    # The model is written now, for up to twice as long as a checkpoint.
    assert clock.now == 160.0 - 2 * 3.0
    assert trainer.at.spent_s == 54.0
    assert trainer.at.step == 54 - 3 - 2 * 4


@pytest.mark.slow
def test_held_out_views_in_full_have_time_in_the_end(make, monkeypatch):
    trainer, _ = timed(make, monkeypatch, 100.0, look_s=2.0)
    shown_px = trainer.shown[0].sample.facade.numel()
    assert trainer.final_scoring_s() == 0.0
    trainer._last_px = 2 * shown_px
    trainer.run(Callbacks())
    assert trainer.final_scoring_s() == 4.0
    assert trainer.at.spent_s == 100.0 - 4.0
    again, _ = timed(make, monkeypatch, 100.0, look_s=2.0)
    again._last_px = 50 * shown_px
    again.run(Callbacks())
    # Not more than its share: of so many views some are scored.
    assert again.at.spent_s == 100.0 - 5.0


def test_pauses_do_not_count(make, monkeypatch):
    trainer, clock = timed(make, monkeypatch, 8.0)
    monkeypatch.setattr(trainer_module.time, "sleep", lambda _: clock.lasting(50.0)())
    answers = iter([True, True, False] + [False] * 99)
    trainer.run(Callbacks(pause=lambda: next(answers)))
    assert trainer.at.step == 8
    assert trainer.at.spent_s == 8.0


def test_paused_it_waits_and_can_be_looked_at(make, monkeypatch):
    waits, visits = [], []
    monkeypatch.setattr(trainer_module.time, "sleep", waits.append)
    trainer = make()
    answers = iter([True, True, False] + [False] * 99)
    trainer.run(Callbacks(pause=lambda: next(answers), visit=visits.append))
    assert trainer.at.step == 12
    assert len(waits) == 2
    assert [visit.state for visit in visits] == ["training", "paused", "paused", *["training"] * 13]
    assert [visit.step for visit in visits] == [0, 0, 0, *range(1, 13), 12]
    assert visits[0].terms == {}
    assert visits[-1].terms["colour"] > 0.0
    assert visits[-1].history == tuple(trainer.at.history)


def rates_of(trainer):
    return {group["name"]: group["lr"] / group["full"] for group in trainer.optimiser.param_groups}


def stopped(make, monkeypatch, after_s, stop_at, **more):
    """A training of a step a second that is stopped at a step, and its rates at each step."""
    trainer, _ = timed(make, monkeypatch, None, before_s=after_s)
    rates, step = [], trainer.step

    def noted():
        step()
        rates.append(rates_of(trainer))

    monkeypatch.setattr(trainer, "step", noted)
    trainer.run(Callbacks(stop=lambda: trainer.at.step >= stop_at, **more))
    return trainer, rates


@pytest.mark.slow
def test_stopped_it_lets_its_rates_fall_to_their_last_within_a_twentieth_of_the_time(make, monkeypatch):
    trainer, rates = stopped(make, monkeypatch, 796.0, 4)
    # 5 % of 800 s are 40 steps of a second.
    assert trainer.at.step == 4 + 40
    last = trainer.config.rates.last
    shares = [each["colours"] / min(1.0, (step + 1) / 31) for step, each in enumerate(rates)]
    assert shares[3] > 0.99
    assert all(before > after for before, after in itertools.pairwise(shares[4:]))
    assert shares[-1] == pytest.approx(last, abs=0.01)
    # Along half a cosine, as without a stop.
    assert shares[4 + 20] == pytest.approx(last + 0.5 * (1.0 - last), abs=0.02)


@pytest.mark.slow
def test_settling_takes_a_minute_at_most(make, monkeypatch):
    trainer, _ = stopped(make, monkeypatch, 7200.0, 2)
    assert trainer.at.step == 2 + 60


@pytest.mark.long
def test_a_training_that_waits_goes_on_as_if_it_had_not(make):
    whole, part = make(), make()
    whole.run(Callbacks())
    part.run(Callbacks(), 0.5)
    assert part.at.step == CONFIG.iterations // 2
    waiting = part.qualities_db(part.shown)
    assert len(waiting) == len(part.shown)
    assert part.model.training
    part.run(Callbacks())
    assert_same(whole, part)
    assert float(np.mean(part.qualities_db(part.shown))) == pytest.approx(part.at.history[-1][1])
    assert waiting != part.qualities_db(part.shown)


def test_a_training_that_is_nearly_over_settles_no_longer_than_it_would_have_lasted(make, monkeypatch):
    trainer, _ = timed(make, monkeypatch, 1000.0, before_s=990.0)
    trainer.run(Callbacks(stop=lambda: trainer.at.step >= 4))
    assert trainer.at.step == 10


@pytest.mark.slow
def test_while_it_settles_no_splats_are_added_and_the_losses_stay_what_they_were(make, monkeypatch):
    losses = LossWeights(consistent_from=0.5, high_frequency_from=0.5)
    config = replace(CONFIG, iterations=400, densify_from=0.0, densify_until=1.0, densification="mcmc", losses=losses)
    clock = FakeClock()
    trainer = make(config, watch=Timer(clock, -700.0))
    monkeypatch.setattr(trainer, "step", clock.lasting(1.0, trainer.step))
    visits = []
    trainer.run(Callbacks(stop=lambda: trainer.at.step >= 90, visit=lambda v: visits.append((v, len(v.model.splats)))))
    settling = [(visit, n_splats) for visit, n_splats in visits if visit.state == "settling"]
    assert len(settling) > 30
    assert len({n_splats for _, n_splats in settling}) == 1
    assert {name for visit, _ in settling for name in visit.terms} == {"colour"}


@pytest.mark.slow
def test_what_is_held_out_chooses_nothing_when_it_is_stopped(make, monkeypatch):
    ends = []
    for spoiled in (False, True):
        trainer, _ = timed(make, monkeypatch, None, before_s=200.0)
        if spoiled:
            shown = trainer.shown[0]
            noise = torch.randint(0, 256, shown.sample.display.shape, dtype=torch.uint8)
            trainer.shown = (replace(shown, sample=replace(shown.sample, display=noise)),)
        trainer.run(Callbacks(stop=lambda trainer=trainer: trainer.at.step >= 3))
        ends.append(trainer)
    assert ends[0].at.step > 3
    assert_same(*ends)


def test_broken_off_while_it_settles_it_goes_on_as_if_nobody_had_stopped_it(make, tmp_path, monkeypatch):
    class Cancel:
        def report(self, stage, done, total):
            if stage == "settling" and done > 0.0:
                raise OperationCancelled("enough")

    clock = FakeClock()
    trainer = make(checkpoint="c", watch=Timer(clock, -700.0))
    monkeypatch.setattr(trainer, "step", clock.lasting(1.0, trainer.step))
    with pytest.raises(OperationCancelled):
        trainer.run(Callbacks(Cancel(), stop=lambda: trainer.at.step >= 4))
    assert trainer.at.step == 5
    again = make(checkpoint="c")
    again.restore(read_checkpoint(tmp_path / "c")["training"])
    again.run(Callbacks())
    assert again.at.step == 12


def test_every_term_of_the_objective_is_there_when_its_time_has_come(make):
    losses = LossWeights(consistent_from=0.5, high_frequency_from=0.5)
    trainer = make(replace(CONFIG, losses=losses))
    assert set(trainer.step()) == {"colour"}
    trainer.at.step = 6
    assert set(trainer.step()) == {"colour", "normal consistency"}


def test_gains_of_photos_stay_one_on_average(make):
    trainer = make(replace(CONFIG, rates=replace(CONFIG.rates, exposures=0.05)))
    trainer.run(Callbacks())
    gains = trainer.exposures.log_gains.detach()
    assert gains.abs().max() > 1e-3
    assert gains.mean().item() == pytest.approx(0.0, abs=1e-6)
