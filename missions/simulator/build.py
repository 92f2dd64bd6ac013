"""The simulated aircraft of a plan: which effects its flight calls for, and the airframe that has just these."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from missions.mavlink.autopilots import Autopilot, facts
from missions.simulator.airframe.multirotor import Multirotor
from missions.simulator.airframe.state import (
    Air,
    ExactReceiver,
    Gimbal,
    Pack,
    Parts,
    PositionError,
    RateGimbal,
    Receiver,
    SteadyPack,
)
from missions.simulator.conditions import Conditions
from missions.simulator.effects.barometer import BarometerDrift, DriftingBarometer
from missions.simulator.effects.battery import BatterySag, SaggingPack
from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.gimbal import GimbalLag, LaggingGimbal
from missions.simulator.effects.gnss import GnssNoise, NoisyReceiver, fix_of
from missions.simulator.effects.link_loss import LinkLoss
from missions.simulator.effects.multipath import GlassSky, Multipath, ReflectedReceiver
from missions.simulator.effects.shutter import PhotoTiming
from missions.simulator.effects.wind import GustyAir, Wind
from missions.simulator.scene import FlightScene, flight_scene
from planning.base.effects import Decision, Effect, EffectSetting, decide
from planning.base.errors import InputError
from planning.base.messages import glue, say
from planning.geo.frames import Vec3
from planning.motion.timing import motion_limits
from planning.parameters import FlightRules
from planning.plan import Plan, Sortie
from planning.site.ground import Ground, ground_of
from planning.site.records import SiteModel

PAD_M = 2.0
"""Around home it is as high as home: aircraft stand and land on their pad."""

EFFECTS: tuple[Effect[FlightScene], ...] = (
    Wind(),
    GnssNoise(),
    Multipath(),
    BarometerDrift(),
    GimbalLag(),
    PhotoTiming(),
    BatterySag(),
    LinkLoss(),
)
"""All effects, in the order in which they are shown. The place of each seeds its random numbers: add at the end."""


def decide_effects(scene: FlightScene, settings: Mapping[str, EffectSetting] | None = None) -> tuple[Decision, ...]:
    """Ask the scene about every effect; `settings`, by name, overrule it.

    Raises
    ------
    InputError
        A setting names no effect.
    """
    settings = settings or {}
    known = [effect.name for effect in EFFECTS]
    for name in settings:
        if name not in known:
            raise InputError.say("there is no effect '{}' of the flight; known are: {}", name, ", ".join(known))
    return tuple(decide(effect, scene, settings.get(effect.name, "auto")) for effect in EFFECTS)


def effects_table(decisions: tuple[Decision, ...], translate: Callable[[str], str] = str) -> str:
    """Decisions as lines of aligned columns, the costs last."""
    rows: list[tuple[str, ...]] = [
        (
            d.effect,
            glue(say("on") if d.on else say("off"), "" if d.decided_by == "scene" else say(", asked for")),
            say("{:.3g} {}", d.size, d.unit),
            f"{d.tolerance:.3g}",
            f"{d.cost_s:.1f} s",
            d.reason,
        )
        for d in decisions
    ]
    rows.insert(0, (say("effect"), say("state"), say("size"), say("tolerance"), say("cost"), say("why")))
    rows = [tuple(map(translate, row)) for row in rows]
    widths = [max(len(row[i]) for row in rows) for i in range(6)]
    return "\n".join("  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in rows)


def make_airframe(
    plan: Plan,
    site_model: SiteModel,
    sortie: Sortie | None = None,
    *,
    conditions: Conditions | None = None,
    settings: Mapping[str, EffectSetting] | None = None,
    home_enu_m: Vec3 | None = None,
    seed: int = 0,
    autopilot: Autopilot | None = None,
) -> tuple[Multirotor, tuple[Decision, ...]]:
    """Airframe at home, ready to fly a sortie of a plan, and what was decided about each effect.

    Parameters
    ----------
    sortie
        One of the plan's; None: effects are decided for all of them together.
    conditions
        None: as in `Conditions`, with the plan's wind.
    settings
        `on`, `off` or `auto` by the effect's name.
    home_enu_m
        None: the plan's, else the site's.
    seed
        The same seed gives the same flight.
    autopilot
        Whose jerk it flies with where the aircraft states none; None: without a limit.

    Raises
    ------
    InputError
        A setting names no effect.
    InfeasibleError
        The wind carries the aircraft away.
    """
    conditions = Conditions(wind_m_s=plan.rules.wind_m_s) if conditions is None else conditions
    scene = flight_scene(plan, site_model, conditions, sortie)
    decisions = decide_effects(scene, settings)
    low, high = plan.camera.gimbal_pitch_deg
    home = home_enu_m or plan.home_enu_m or site_model.site.home_enu_m
    # The wind is simulated, and the mission says how fast to fly: only the aircraft's own limits count here.
    limits = motion_limits(plan.aircraft, FlightRules())
    if autopilot is not None and plan.aircraft.max_jerk_m_s3 is None:
        limits = replace(limits, jerk_m_s3=facts(autopilot).own_jerk_m_s3 or math.inf)
    pitches = math.radians(low), math.radians(high)
    terrain_z_m = _terrain_below(ground_of(site_model.site), home)
    return Multirotor(limits, pitches, home, _parts(scene, decisions, seed), terrain_z_m=terrain_z_m), decisions


def _terrain_below(ground: Ground, home_enu_m: Vec3) -> Callable[[float, float], float] | None:
    """The ground as the airframe meets it: terrain where it is known, home's height around home and elsewhere."""
    if ground.terrain is None:
        return None

    def height_m(x: float, y: float) -> float:
        if math.hypot(x - home_enu_m[0], y - home_enu_m[1]) <= PAD_M:
            return home_enu_m[2]
        found = float(ground.heights_m(np.array([[x, y]]))[0])
        return found if math.isfinite(found) else home_enu_m[2]

    return height_m


def _parts(scene: FlightScene, decisions: tuple[Decision, ...], seed: int) -> Parts:
    """The parts of an aircraft: those of effects that are on, ideal ones for the others."""
    on = {decision.effect for decision in decisions if decision.on}
    place = {effect.name: i for i, effect in enumerate(EFFECTS)}
    facts, conditions, aircraft = effect_facts(), scene.conditions, scene.aircraft
    by_gnss = conditions.height_by_gnss

    def rng(name: str) -> np.random.Generator:
        return np.random.default_rng([seed, place[name]])

    air: Air | None = None
    if Wind.name in on:
        air = GustyAir(conditions.wind_enu_m_s, scene.height_m, facts.wind, rng(Wind.name))
    errors: list[PositionError] = []
    own = facts.receivers[conditions.fix]
    receiver: Receiver = ExactReceiver(fix_of(own))
    if GnssNoise.name in on:
        noisy = NoisyReceiver(own, gives_height=by_gnss, rng=rng(GnssNoise.name))
        receiver = noisy
        errors.append(noisy)
    if Multipath.name in on:
        sky = GlassSky(scene.site_model, facts.multipath)
        mirrored = ReflectedReceiver(sky, conditions.fix, receiver, gives_height=by_gnss, rng=rng(Multipath.name))
        receiver = mirrored
        errors.append(mirrored)
    if BarometerDrift.name in on:
        errors.append(DriftingBarometer(facts.barometer, gives_height=not by_gnss, rng=rng(BarometerDrift.name)))
    rate_rad_s = math.radians(aircraft.max_gimbal_rate_deg_s)
    gimbal: Gimbal = RateGimbal(rate_rad_s)
    if GimbalLag.name in on:
        gimbal = LaggingGimbal(rate_rad_s, facts.gimbal.lag_s)
    pack: Pack = SteadyPack(facts.battery.capacity_mah, facts.battery.nominal_v, aircraft.endurance_s)
    if BatterySag.name in on:
        pack = SaggingPack(facts.battery, aircraft.endurance_s)
    opens = PhotoTiming.name in on
    return Parts(
        gimbal=gimbal,
        pack=pack,
        receiver=receiver,
        air=air,
        errors=tuple(errors),
        latency_s=conditions.photo_latency_s if opens else 0.0,
        exposure_s=conditions.exposure_s if opens else 0.0,
    )
