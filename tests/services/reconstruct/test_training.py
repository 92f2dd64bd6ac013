"""What is asked of a training becomes its settings, it waits where it is paused, and a scene says its light."""

import pytest

from groundstation.services.reconstruct import training as model_training
from groundstation.services.reconstruct.training import config_of_request, light_of_scene
from planning.base.errors import InputError, OperationCancelled
from reconstruction.training.parameters import TrainRequest
from reconstruction.training.timer import Timer
from tests.reconstruction.training.synthetic_data_set import write_data_set


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("training") / "glass"
    write_data_set(folder, n=6)
    return folder


def test_device_and_memory_are_those_of_the_wish():
    config = config_of_request(TrainRequest("smoke", memory_bytes=1 << 28, device="cuda"))
    assert (config.memory_bytes, config.device) == (1 << 28, "cuda")
    assert config_of_request(TrainRequest("smoke")).device == "auto"
    with pytest.raises(ValueError, match="memory_bytes: expected 1 or more"):
        config_of_request(TrainRequest("smoke", memory_bytes=0))


class Heard:
    def __init__(self):
        self.stages = []

    def report(self, stage, done, total):
        self.stages.append(stage)


def test_what_comes_before_the_joint_training_waits_and_that_time_does_not_count(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(model_training.time, "sleep", lambda seconds: now.__setitem__(0, now[0] + 50.0))
    watch, heard = Timer(lambda: now[0]), Heard()
    answers = iter([True, True, True, False])
    waiting = model_training._Waiting(heard, lambda: next(answers, False), watch)
    waiting.report("learning reflections", 3, 80)
    assert heard.stages == ["learning reflections", "paused", "paused"]
    assert (now[0], watch()) == (200.0, 0.0)
    # The joint training waits by itself, and looks at its model meanwhile.
    waiting = model_training._Waiting(heard, lambda: True, watch)
    for stage in ("training", "paused", "settling"):
        waiting.report(stage, 1, 2)
    assert now[0] == 200.0


def test_a_pause_is_broken_off_by_a_cancel(monkeypatch):
    class Cancel:
        def report(self, stage, done, total):
            if stage == "paused":
                raise OperationCancelled("enough")

    monkeypatch.setattr(model_training.time, "sleep", lambda _: None)
    with pytest.raises(OperationCancelled):
        model_training._Waiting(Cancel(), lambda: True, Timer()).report("reading rays", 0, 1)


@pytest.mark.slow
def test_a_scene_says_which_light_it_calls_for_and_why(data):
    heard = Heard()
    light, decisions = light_of_scene(data, TrainRequest("smoke"), heard)
    assert light in ("harmonics", "environment-map", "radiance-grid")
    assert [decision.effect for decision in decisions] == ["mirrored surroundings", "near-field light"]
    assert "choosing a model of mirrored light" in heard.stages


def test_a_scene_that_is_none_is_told(tmp_path):
    with pytest.raises(InputError, match=r"has no dataset\.json"):
        light_of_scene(tmp_path, TrainRequest("smoke"))
