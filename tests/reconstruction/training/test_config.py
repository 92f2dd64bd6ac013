"""Settings of a training: checked, read from files, and their schedules."""

from dataclasses import replace
from pathlib import Path

import pytest

from planning.base.errors import InputError
from reconstruction.training.config import LossWeights, Rates, TrainConfig, config_of
from reconstruction.training.method_registry import METHODS
from reconstruction.training.parameters import LIGHTS, PRESETS, TrainRequest
from reconstruction.training.presets import preset, with_request

HERE = Path("settings.toml")


def test_what_a_file_does_not_say_is_the_presets():
    content = {"max_splats": 50_000, "losses": {"normal_prior": 0.5}, "reflections": {"mlp": {"width": 64}}}
    config = config_of(content, preset("1h"), HERE)
    assert config.max_splats == 50_000
    assert config.losses == replace(preset("1h").losses, normal_prior=0.5)
    assert config.reflections.mlp == replace(preset("1h").reflections.mlp, width=64)
    assert config.iterations == preset("1h").iterations


def test_stages_of_the_high_frequency_loss_are_read():
    content = {"losses": {"high_frequency": [{"threshold": 0.3, "weight": 2.0}]}}
    (stage,) = config_of(content, TrainConfig(), HERE).losses.high_frequency
    assert (stage.threshold, stage.weight) == (0.3, 2.0)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"max_splat": 5}, "max_splat: no such setting"),
        ({"losses": {"dsim": 0.1}}, r"losses\.dsim: no such setting"),
        ({"reflections": {"mlp": {"wide": 1}}}, r"reflections\.mlp\.wide: no such setting"),
        ({"iterations": "many"}, "iterations: expected whole number"),
        ({"iterations": 0}, "iterations: expected 1 or more"),
        ({"method": "nerf"}, "method"),
        ({"losses": {"dssim": 1.5}}, "dssim: expected 0 to 1"),
        ({"rates": {"means": -1.0}}, "means: expected 0 or more"),
        ({"n_splats": 50_000, "max_splats": 100}, "max_splats: expected n_splats"),
        ({"losses": 3}, "losses"),
    ],
)
def test_wrong_settings_are_refused_with_file_and_key(content, message):
    with pytest.raises(InputError, match=rf"settings\.toml: .*{message}"):
        config_of(content, TrainConfig(), HERE)


@pytest.mark.parametrize(
    "wrong",
    [
        {"degree": 4},
        {"held_out": 0.0},
        {"time_limit_s": 0.0},
        {"light_share": 2.0},
        {"checkpoint_every_s": float("nan")},
    ],
)
def test_wrong_calls_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        TrainConfig(**wrong)


def test_names_for_the_command_line_are_those_of_the_settings():
    assert {preset(name).method for name in PRESETS} <= set(METHODS)
    assert {preset(name).light for name in PRESETS} <= {light.value for light in LIGHTS}
    for light in LIGHTS:
        assert config_of({"light": light.value}, TrainConfig(), HERE).light == light.value
    with pytest.raises(InputError, match="--preset"):
        preset("soon")


def test_presets_take_longer_one_after_the_other():
    limits = [preset(name).time_limit_s for name in ("10min", "1h", "overnight")]
    assert limits == [600.0, 3600.0, 36_000.0]


def test_asking_for_steps_takes_the_time_limit_away_and_shortens_what_goes_before():
    config = with_request(preset("10min"), TrainRequest(iterations=100, seed=7))
    assert (config.iterations, config.time_limit_s, config.seed) == (100, None, 7)
    assert config.reflections.steps < preset("10min").reflections.steps
    both = with_request(preset("10min"), TrainRequest(iterations=100, time_limit_s=5.0))
    assert (both.iterations, both.time_limit_s) == (100, 5.0)


def test_rates_rise_and_fall():
    rates = Rates(warm_up=9, last=0.2, means_last=0.01)
    assert rates.share(0, 0.0) == pytest.approx(0.1)
    assert rates.share(9, 0.0) == pytest.approx(1.0)
    assert rates.share(100, 0.5) == pytest.approx(0.6)
    assert rates.share(100, 1.0) == pytest.approx(0.2)
    assert rates.means_share(100, 0.5) == pytest.approx(0.1)
    assert rates.means_share(100, 1.0) == pytest.approx(0.01)


def test_degree_rises_with_the_training():
    config = TrainConfig(degree_every=0.1)
    assert [config.degree_at(p) for p in (0.0, 0.1, 0.25, 0.9)] == [0, 1, 2, 3]
    assert TrainConfig(degree_every=0.0).degree_at(0.0) == 3


def test_defaults_are_the_papers_where_it_says_them():
    losses = LossWeights()
    assert (losses.dssim, losses.normal_consistency) == (0.2, 0.05)
