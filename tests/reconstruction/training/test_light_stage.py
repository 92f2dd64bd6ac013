"""A training that is interrupted while it learns light alone: it goes on, or says why not."""

import shutil
from dataclasses import replace

import cv2
import pytest
import torch

from planning.base.errors import InputError, OperationCancelled
from reconstruction.light import choose_light as choose_module
from reconstruction.light.config import GlassLearned, GridSettings, ReflectionConfig
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.training import start as start_module
from reconstruction.training import train
from reconstruction.training.callbacks import Callbacks
from reconstruction.training.config import TrainConfig
from reconstruction.training.timer import Timer
from reconstruction.training.train import resume_model, train_model
from reconstruction.training.training_state import read_checkpoint, write_checkpoint

TINY = ReflectionConfig(
    mlp=MlpShape(width=16, layers=4, position_order=3, direction_order=2),
    environment_rows=8,
    steps=8,
    batch=256,
    precision="float32",
    grid=GridSettings(most_cells=2000, far_side=8, rest=4),
)
CONFIG = TrainConfig(iterations=3, n_splats=150, max_splats=220, score_every_s=1e9, reflections=TINY)


class Cancelling:
    """Cancels at the n-th report of a stage."""

    def __init__(self, stage, n):
        self.stage, self.left = stage, n

    def report(self, stage, done, total):
        self.left -= stage == self.stage
        if self.left < 0:
            raise OperationCancelled("enough")


def cancelled(data_set, checkpoint, config, stage="learning reflections", n=4, **more):
    with pytest.raises(OperationCancelled):
        train_model(data_set, config, Callbacks(Cancelling(stage, n)), checkpoint, **more)


def config_of(light, **more):
    return replace(CONFIG, light=light, **more)


@pytest.mark.few(1)
@pytest.mark.parametrize("light", ["harmonics", "environment-map", "mlp", "radiance-grid"])
def test_it_goes_on_bit_by_bit(data_set, tmp_path, light):
    config, checkpoint = config_of(light), tmp_path / "c"
    whole = train_model(data_set, config)
    cancelled(data_set, checkpoint, config)
    assert read_checkpoint(checkpoint)["training"]["progress"]["step"] == 4
    again = resume_model(data_set, checkpoint)
    mine, theirs = whole.model.state_dict(), again.model.state_dict()
    assert mine.keys() == theirs.keys()
    assert all(torch.equal(mine[name], theirs[name]) for name in mine)
    # From then on the joint training has its checkpoints in the same place.
    assert "record" in read_checkpoint(checkpoint)


@pytest.mark.slow
def test_what_chose_the_light_is_not_asked_again(data_set, tmp_path, monkeypatch):
    config, checkpoint = config_of("auto"), tmp_path / "c"
    monkeypatch.setattr(choose_module, "_are_clear", lambda *_: False)
    # Three models are tried for 8 steps, on three choices of photos, after a step of each that compiles its kernels.
    cancelled(data_set, checkpoint, config, n=3 * 3 * 8 + 3 + 4)
    monkeypatch.setattr(start_module, "try_lights", lambda *_, **__: 1 / 0)
    again = resume_model(data_set, checkpoint)
    decided = [decision.effect for decision in again.record.decisions]
    assert "near-field light" in decided
    assert sorted(set(decided)) == sorted(decided)
    assert again.record.config == replace(config, own_exposures="off", outlier_photos="off")


def test_another_data_set_method_or_a_damaged_file_is_refused(data_set, tmp_path):
    config, checkpoint = config_of("mlp"), tmp_path / "c"
    cancelled(data_set, checkpoint, config)
    with pytest.raises(InputError, match="training of reflight; resume with that method"):
        resume_model(data_set, checkpoint, method="2dgs")
    other = tmp_path / "other"
    shutil.copytree(data_set, other)
    for path in sorted((other / "images").iterdir()):
        cv2.imwrite(str(path), 255 - cv2.imread(str(path)))
    with pytest.raises(InputError, match="not those that the training was begun with"):
        resume_model(other, checkpoint)
    description = other / "dataset.json"
    description.write_text(description.read_text().replace('"A-1"', '"B-1"'))
    with pytest.raises(InputError, match="shows other panels"):
        resume_model(other, checkpoint)
    content = read_checkpoint(checkpoint)
    for part, value in (("training", {}), ("training", 3), ("spent_s", "long"), ("light stage", {})):
        write_checkpoint(checkpoint, content | {part: value})
        with pytest.raises(InputError, match=checkpoint.name):
            resume_model(data_set, checkpoint)


@pytest.mark.slow
def test_light_has_its_share_of_the_time_that_is_left_and_what_went_before_counts(data_set, tmp_path):
    now = [100.0]
    config, checkpoint = config_of("mlp", time_limit_s=60.0, light_share=0.5), tmp_path / "c"
    cancelled(data_set, checkpoint, config, watch=Timer(lambda: now[0], 80.0))
    content = read_checkpoint(checkpoint)
    assert content["light stage"]["time_limit_s"] == 20.0
    assert content["spent_s"] == 20.0
    now[0] = 200.0
    again = resume_model(data_set, checkpoint, watch=Timer(lambda: now[0], 197.0))
    assert again.seconds == 23.0
    # Of a time that has run out already, light has a little, and the model is what it is then.
    late = train_model(data_set, config, watch=Timer(lambda: now[0], 100.0))
    assert late.n_steps == 0


def test_its_time_is_that_of_the_training_s_own_clock(data_set, tmp_path):
    ticks = iter(range(10**6))
    config = config_of("mlp", time_limit_s=60.0, light_share=0.5, reflections=replace(TINY, steps=10**6))
    reports = []

    class Counting:
        def report(self, stage, done, total):
            if stage == "learning reflections":
                reports.append(done)

    # Every look at this clock takes a second: 30 of them are up after a few steps, and none of the world's.
    train_model(data_set, config, Callbacks(Counting()), watch=Timer(lambda: float(next(ticks))))
    assert 5 < max(reports) < 40


def test_poses_that_were_learned_with_light_are_those_of_the_joint_training(data_set, monkeypatch):
    trainers = []
    true = train.Trainer
    monkeypatch.setattr(train, "Trainer", lambda *given, **more: trainers.append(true(*given, **more)) or trainers[-1])
    learned = replace(TINY, learned=GlassLearned(poses=True), grid=replace(TINY.grid, tilt_rate=5e-3))
    trained = train_model(data_set, config_of("radiance-grid", reflections=learned))
    (trainer,) = trainers
    moves = torch.tensor(trained.record.moves, dtype=torch.float64)
    assert moves.shape == (7, 6)
    assert (moves.abs().amax(dim=0) > 1e-3).all()
    assert moves.mean(dim=0).abs().max() < 1e-7
    told = train.read_photo_set(data_set)
    kept = trained.model.light.moves.detach()
    for number, photo in enumerate(trainer.photos.photos):
        before = told.named([photo.name])[0].pose
        assert photo.pose.position_enu_m - before.position_enu_m == pytest.approx(moves[number, :3].numpy(), abs=1e-9)
        assert float(kept[number, 0] - kept[:, 0].mean()) == pytest.approx(float(moves[number, 0]))
    (held_out,) = trained.record.held_out
    assert trainer.shown[0].sample.view.position_m.numpy() + trained.model.origin_enu_m == pytest.approx(
        told.named([held_out])[0].pose.position_enu_m, abs=1e-5
    )
