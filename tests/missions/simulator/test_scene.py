"""Scenes hold what effects look at; conditions that make no sense are refused."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from missions.simulator.build import decide_effects
from missions.simulator.conditions import Conditions
from missions.simulator.scene import flight_scene
from planning.plan import Sortie
from tests.missions.simulator.flying import GLASS_M, bundled


def test_a_scene_knows_distances_and_speeds_of_its_sortie() -> None:
    model, plan = bundled("office")
    scene = flight_scene(plan, model, Conditions(), plan.sorties[0])
    assert scene.glass_distance_m == pytest.approx([GLASS_M] * 10, abs=1.0)
    assert scene.gsd_m == pytest.approx(plan.camera.gsd_m(GLASS_M), rel=0.1)
    assert 0.0 < scene.hover_share < 1.0
    assert 1.0 < scene.cruise_m_s < plan.aircraft.max_speed_m_s
    assert [tuple(row) for row in scene.views_enu_m.tolist()] == [v.position_enu_m for v in plan.viewpoints]


def test_a_sortie_sees_its_own_views_in_its_own_order() -> None:
    model, plan = bundled("office")
    short = Sortie(("v0005", "v0002"), plan.sorties[0].path_enu_m, 10.0, 20.0)
    scene = flight_scene(plan, model, Conditions(), short)
    assert scene.views_enu_m.tolist() == [list(plan.viewpoints[i].position_enu_m) for i in (5, 2)]
    assert scene.duration_s == 20.0


def test_a_sortie_without_views_calls_for_nothing_but_what_the_weather_brings() -> None:
    model, plan = bundled("office")
    empty = Sortie((), plan.sorties[0].path_enu_m, 0.0, 0.0)
    for decision in decide_effects(flight_scene(plan, model, Conditions(), empty)):
        assert not decision.on
        assert math.isfinite(decision.size + decision.cost_s)


@pytest.mark.parametrize(
    ("fix", "source", "by_gnss"),
    [
        ("rtk-fixed", "auto", True),
        ("single", "auto", False),
        ("single", "gnss", True),
        ("rtk-fixed", "barometer", False),
    ],
)
def test_heights_come_from_where_they_should(fix: Any, source: Any, by_gnss: bool) -> None:
    assert Conditions(fix=fix, height_source=source).height_by_gnss is by_gnss


def test_wind_from_the_west_blows_towards_the_east() -> None:
    assert Conditions(wind_m_s=4.0, wind_from_deg=270.0).wind_enu_m_s == pytest.approx((4.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "wrong",
    [
        {"wind_m_s": -1.0},
        {"wind_m_s": math.nan},
        {"wind_from_deg": math.inf},
        {"exposure_s": -0.1},
        {"photo_latency_s": math.nan},
        {"fix": "rtk"},
        {"height_source": "radar"},
        {"message_loss": 1.0},
        {"outages_s": ((5.0, 4.0),)},
    ],
)
def test_conditions_that_make_no_sense_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=rf"{next(iter(wrong))}: expected"):
        replace(Conditions(), **wrong)


def test_photos_are_exposed_as_long_as_the_plan_says_unless_somebody_asks_for_another_time() -> None:
    usual, dark = Conditions(), Conditions(exposure_s=0.1)
    assert usual.with_shutter(None).exposure_s == 0.002
    assert usual.with_shutter(1 / 100) == Conditions(exposure_s=1 / 100)
    assert dark.with_shutter(1 / 100) is dark
