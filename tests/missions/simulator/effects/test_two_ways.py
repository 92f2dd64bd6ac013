"""Every effect, both ways: what is skipped would change the result by less than its tolerance, what is used by more."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from missions.mavlink.link import memory_pair
from missions.mavlink.messages import MissionCurrent
from missions.simulator.airframe.multirotor import Multirotor
from missions.simulator.airframe.state import ExactReceiver, RateGimbal, SteadyPack
from missions.simulator.build import EFFECTS, decide_effects, effects_table, make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.effects.link_loss import LossyLink, through_air
from missions.simulator.scene import flight_scene
from planning.base.effects import EffectSetting
from planning.base.errors import InfeasibleError, InputError
from planning.geo.frames import Vec3
from planning.plan import Plan
from planning.site.records import SiteModel
from tests.missions.simulator.flying import Shot, bundled, fly, rms
from tests.slow import slow

NAMES = tuple(effect.name for effect in EFFECTS)
SEEDS = range(4)

CALM = Conditions()
BREEZE = Conditions(wind_m_s=3.0)
WINDY = Conditions(wind_m_s=8.0, wind_from_deg=160.0)
DARK = Conditions(wind_m_s=8.0, exposure_s=0.1)
FLOAT = Conditions(fix="rtk-float", height_source="gnss")
SINGLE = Conditions(fix="single")
WEATHER = Conditions(height_source="barometer")


@dataclass(frozen=True)
class Outcome:
    """What came out of a flight."""

    shots: list[Shot]
    flown_s: float
    remaining: float


def only(*on: str) -> Mapping[str, EffectSetting]:
    return {name: "on" if name in on else "off" for name in NAMES}


def outcome(
    model: SiteModel, plan: Plan, conditions: Conditions, settings: Mapping[str, EffectSetting], seed: int
) -> Outcome:
    sortie = plan.sorties[0]
    made, _ = make_airframe(plan, model, sortie, conditions=conditions, settings=settings, seed=seed)
    shots, flown_s = fly(made, plan, sortie)
    return Outcome(shots, flown_s, made.battery.remaining)


def position_error_m(name: str, plan: Plan, model: SiteModel, conditions: Conditions) -> float:
    flown = [outcome(model, plan, conditions, only(name), seed) for seed in SEEDS]
    return rms([shot.error_m for one in flown for shot in one.shots])


def pitch_error_deg(name: str, plan: Plan, model: SiteModel, conditions: Conditions) -> float:
    return max(shot.pitch_error_deg for shot in outcome(model, plan, conditions, only(name), 0).shots)


def blur(name: str, plan: Plan, model: SiteModel, conditions: Conditions) -> float:
    """With the wind on both times: exposure alone blurs nothing at rest."""
    distance_m = float(flight_scene(plan, model, conditions, plan.sorties[0]).glass_distance_m.min())
    angle = plan.camera.pixel_angle_rad
    shots = [s for seed in SEEDS for s in outcome(model, plan, conditions, only(name, "wind"), seed).shots]
    return rms([blur_px(s.pose.velocity_enu_m_s, 0.0, s.exposure_s, distance_m, angle) for s in shots])


def battery_share(name: str, plan: Plan, model: SiteModel, conditions: Conditions) -> float:
    wind = {"wind": "on"} if conditions.wind_m_s else {}
    off = outcome(model, plan, conditions, {**only(), **wind}, 0)  # type: ignore[dict-item]
    on = outcome(model, plan, conditions, {**only(name), **wind}, 0)  # type: ignore[dict-item]
    return abs(on.remaining - off.remaining)


Measure = Callable[[str, Plan, SiteModel, Conditions], float]


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("name", "site", "conditions", "settle_s", "measure", "used"),
    [
        ("wind", "office", BREEZE, 2.0, position_error_m, False),
        ("wind", "office", WINDY, 2.0, position_error_m, True),
        ("wind", "canyon", WINDY, 2.0, position_error_m, True),
        ("GNSS noise", "office", CALM, 2.0, position_error_m, False),
        ("GNSS noise", "office", FLOAT, 2.0, position_error_m, True),
        ("GNSS noise", "canyon", SINGLE, 2.0, position_error_m, True),
        ("multipath", "canyon", CALM, 2.0, position_error_m, False),
        ("multipath", "canyon", SINGLE, 2.0, position_error_m, True),
        slow("multipath", "tower", SINGLE, 2.0, position_error_m, True),
        ("barometer drift", "office", CALM, 2.0, position_error_m, False),
        ("barometer drift", "single-panel", WEATHER, 2.0, position_error_m, False),
        ("barometer drift", "tower", WEATHER, 20.0, position_error_m, True),
        ("gimbal lag", "office", CALM, 2.0, pitch_error_deg, False),
        ("gimbal lag", "office", CALM, 0.3, pitch_error_deg, True),
        ("photo latency and blur", "office", WINDY, 2.0, blur, False),
        ("photo latency and blur", "office", DARK, 2.0, blur, True),
        ("battery sag", "office", replace(CALM, wind_m_s=8.0), 2.0, battery_share, False),
        ("battery sag", "canyon", CALM, 20.0, battery_share, True),
    ],
)
def test_the_effect_is_on_just_where_it_matters(
    name: str, site: str, conditions: Conditions, settle_s: float, measure: Measure, used: bool
) -> None:
    model, plan = bundled(site, settle_s=settle_s)
    scene = flight_scene(plan, model, conditions, plan.sorties[0])
    decision = next(d for d in decide_effects(scene) if d.effect == name)
    assert decision.on is used, str(decision)
    change = measure(name, plan, model, conditions)
    if used:
        assert change > decision.tolerance, f"{change:.4g} {decision.unit}; {decision}"
    else:
        assert change < decision.tolerance, f"{change:.4g} {decision.unit}; {decision}"
    # The size that is shown to the user is the one that is flown, roughly.
    if decision.size > 0.2 * decision.tolerance:
        assert 0.4 < change / decision.size < 2.5, f"{change:.4g} {decision.unit}; {decision}"


@pytest.mark.parametrize(("loss", "used"), [(0.0, False), (0.2, True)])
def test_link_loss_loses_the_share_that_it_says(loss: float, used: bool) -> None:
    model, plan = bundled("office")
    conditions = Conditions(message_loss=loss)
    decisions = decide_effects(flight_scene(plan, model, conditions, plan.sorties[0]))
    link, other = memory_pair(clock=lambda: 0.0)
    lossy = through_air(link, decisions, conditions, lambda: 0.0, seed=1)
    assert (lossy is not link) is used
    if not used:
        return
    for i in range(1000):
        lossy.send(MissionCurrent(i))
        other.send(MissionCurrent(i))
    arrived = sum(1 for _ in iter(lambda: other.receive(0.0), None))
    got = sum(lossy.receive(0.0) is not None for _ in range(1000))
    assert 1.0 - arrived / 1000 == pytest.approx(loss, abs=0.05)
    assert 1.0 - got / 1000 == pytest.approx(loss, abs=0.05)


def test_in_an_outage_nothing_gets_through_and_afterwards_all() -> None:
    now = [0.0]
    link, other = memory_pair(clock=lambda: now[0])
    lossy = LossyLink(link, 0.0, ((10.0, 20.0),), lambda: now[0], seed=0)
    through = []
    for now[0] in (5.0, 10.0, 19.9, 20.0):
        lossy.send(MissionCurrent(1))
        through.append(other.receive(0.0) is not None)
    assert through == [True, False, False, True]
    assert lossy.n_lost == 2


def test_what_is_off_is_not_there() -> None:
    model, plan = bundled("office")
    made, decisions = make_airframe(plan, model, plan.sorties[0], settings=only())
    assert not any(decision.on for decision in decisions)
    parts = made._parts
    assert (parts.air, parts.errors, parts.latency_s, parts.exposure_s) == (None, (), 0.0, 0.0)
    assert type(parts.gimbal) is RateGimbal
    assert type(parts.pack) is SteadyPack
    assert type(parts.receiver) is ExactReceiver
    assert made.estimate is made.truth


@pytest.mark.slow
def test_all_effects_asked_for_in_a_calm_scene_change_next_to_nothing() -> None:
    model, plan = bundled("office")
    flown = [outcome(model, plan, CALM, only(*NAMES), seed) for seed in SEEDS]
    assert rms([shot.error_m for one in flown for shot in one.shots]) < 0.05
    assert all(shot.exposure_s == CALM.exposure_s for one in flown for shot in one.shots)


def track(made: Multirotor, plan: Plan) -> np.ndarray:
    shots, _ = fly(made, plan, plan.sorties[0])
    return np.array([shot.pose.position_enu_m for shot in shots])


@pytest.mark.slow
def test_the_same_seed_flies_the_same_flight_and_another_does_not() -> None:
    model, plan = bundled("office")
    hard = replace(WINDY, fix="single", exposure_s=0.02)
    flights = [
        track(make_airframe(plan, model, plan.sorties[0], conditions=hard, seed=seed)[0], plan) for seed in (4, 4, 5)
    ]
    assert np.array_equal(flights[0], flights[1])
    assert np.abs(flights[0] - flights[2]).max() > 0.1


def test_an_effect_does_not_change_the_random_numbers_of_another() -> None:
    model, plan = bundled("office")
    alone = track(make_airframe(plan, model, plan.sorties[0], conditions=SINGLE, settings=only("GNSS noise"))[0], plan)
    also = only("GNSS noise", "battery sag", "gimbal lag")
    together = track(make_airframe(plan, model, plan.sorties[0], conditions=SINGLE, settings=also)[0], plan)
    assert np.array_equal(alone, together)


def test_the_user_overrules_and_sees_it_in_the_table() -> None:
    model, plan = bundled("office")
    _, decisions = make_airframe(plan, model, settings={"wind": "on", "battery sag": "off"})
    lines = effects_table(decisions).splitlines()
    assert len(lines) == 1 + len(EFFECTS)
    assert lines[1].split()[:4] == ["wind", "on,", "asked", "for"]
    assert sum("asked for" in line for line in lines) == 2


def test_a_wish_for_an_unknown_effect_is_refused() -> None:
    model, plan = bundled("office")
    with pytest.raises(InputError, match=r"no effect 'rain'.*wind, GNSS noise"):
        make_airframe(plan, model, settings={"rain": "on"})


def test_a_storm_is_refused() -> None:
    model, plan = bundled("office")
    with pytest.raises(InfeasibleError, match="20 m/s carries the aircraft away"):
        make_airframe(plan, model, conditions=Conditions(wind_m_s=20.0))


def blur_px(
    velocity_enu_m_s: Vec3, turn_rate_rad_s: float, exposure_s: float, distance_m: float, pixel_angle_rad: float
) -> float:
    """Length of the trail of a point at a distance, pixels at the image centre.

    exposure * (speed / distance + rate of turn) / pixel angle: the worst direction of both.
    """
    angle_rad = exposure_s * (math.hypot(*velocity_enu_m_s) / distance_m + abs(turn_rate_rad_s))
    return angle_rad / pixel_angle_rad
