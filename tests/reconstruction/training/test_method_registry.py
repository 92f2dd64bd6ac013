from dataclasses import replace
from pathlib import Path

import pytest

from planning.base.errors import InputError
from reconstruction.training.config import TrainConfig, config_of
from reconstruction.training.method_registry import DEFAULT_METHOD, METHODS

HERE = Path("settings.toml")


def made(name, base=None, **content):
    return config_of({"method": name, **content}, base or TrainConfig(), HERE)


@pytest.mark.parametrize("name", METHODS)
def test_each_method_has_settings_that_are_valid_and_says_what_it_is(name):
    assert made(name).method == name
    method = METHODS[name]
    assert min(len(method.title), len(method.source), len(method.what)) > 3


def test_a_method_s_settings_give_way_to_those_beside_it():
    assert made("refglass-gs").losses.normal_prior == 1.0
    assert made("refglass-gs", losses={"normal_prior": 0.3}).losses.normal_prior == 0.3
    assert made("refglass-gs", light="environment-map").light == "environment-map"


def test_the_default_method_is_as_if_it_were_named():
    assert TrainConfig().method == DEFAULT_METHOD
    assert made(DEFAULT_METHOD) == TrainConfig()
    assert made(DEFAULT_METHOD, made("refglass-gs")) == TrainConfig()


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("refglass-gs-environment-map", {"light": "environment-map"}),
        ("refglass-gs-no-high-frequency", {"losses": replace(made("refglass-gs").losses, high_frequency=())}),
        ("refglass-gs-no-normal-prior", {"losses": replace(made("refglass-gs").losses, normal_prior=0.0)}),
    ],
)
def test_an_ablation_differs_in_its_part_and_in_nothing_else(name, change):
    assert made(name) == replace(made("refglass-gs"), method=name, **change)


def test_an_unknown_method_is_refused_with_all_that_there_are():
    with pytest.raises(InputError, match=r"settings.toml: method: expected reflight, refglass-gs, .* got 'nerf'"):
        made("nerf")
