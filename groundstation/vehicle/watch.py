"""Warnings that speak before they matter: a pure fold over the states of a vehicle.

Each rule measures how far something is beyond its limit. A warning appears when that is more than nothing, and goes
when it is back by the rule's slack and at least `HOLD_S` have passed: so none flickers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from groundstation.vehicle.commands import MISSION_MODE
from groundstation.vehicle.state import LINK_LOST_S, Landed, Motion, VehicleState
from groundstation.vehicle.surroundings import Surroundings
from planning.base.findings import Severity
from planning.base.messages import say
from planning.geo.bvh import segment_segment_d2
from planning.geo.frames import Vec3

HOLD_S = 3.0
"""Shortest time for which a warning is shown."""

DISTANCE_TOLERANCE_M = 0.5
"""Of the minimum distance: plans use it to the full, and a vehicle with RTK keeps its path to some 0.3 m."""

DISTANCE_SLACK_M = 0.25
APART_TOLERANCE_M, APART_SLACK_M = 2.0 * DISTANCE_TOLERANCE_M, 2.0 * DISTANCE_SLACK_M
"""Of the distance between two aircraft: each is off its path by its own error."""

REACTION_S = 1.5
"""Of a pilot: how much longer the aircraft flies on when no mission brakes it."""

WIND_SHARE, WIND_SLACK_M_S = 0.85, 1.5
"""Of the aircraft's limit, from which the wind is spoken of; the slack is about what gusts differ by (1 sigma)."""

BATTERY_EARLY = 0.05
"""Charge above what the way home needs, at which that is said."""

BATTERY_SLACK = 0.02
AIRSPACE_EARLY_M, AIRSPACE_SLACK_M = 0.5, 0.5
OFF_PATH_M, OFF_PATH_SLACK_M = 2.0, 0.5
PHOTO_NEAR_M = 2.0
"""A photo further from its viewpoint than this is not its photo."""

PHOTO_LATE_S = 3.0
"""How much later than the next item a photo may be reported."""

GIMBAL_OFF_DEG = 5.0
"""How far from where it should a camera may look at a photo; a gimbal that works is right to a degree."""

GIMBAL_PHOTOS = 2
"""So many of the last three photos that look elsewhere are no accident."""

RTK_FLOAT, FIX_3D = 5, 3
STALE_S = 5.0
"""Positions and fixes older than this are not known any more."""

NO_POSITION_S = 1.5
"""Positions come ten times a second, heartbeats once: where one comes so long after the last position, none will."""


@dataclass(frozen=True, slots=True)
class Watched:
    """What one rule found now.

    Parameters
    ----------
    excess
        How far beyond the limit it is, in `unit`; the warning appears above 0.
    slack
        How far within the limit it must be for the warning to go.
    """

    code: str
    severity: Severity
    text: str
    excess: float
    slack: float
    value: float
    limit: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class FlightWarning:
    """A warning that is shown; `since_s` by the receiver's clock."""

    code: str
    severity: Severity
    text: str
    since_s: float
    value: float
    limit: float
    unit: str


@dataclass(frozen=True, slots=True)
class Watch:
    """The warnings of now, and what the rules remember.

    Parameters
    ----------
    passed_s
        When each viewpoint without a photo was seen to be passed.
    """

    warnings: tuple[FlightWarning, ...] = ()
    passed_s: tuple[tuple[str, float], ...] = ()

    def codes(self) -> frozenset[str]:
        """Codes of all warnings."""
        return frozenset(warning.code for warning in self.warnings)


@dataclass(frozen=True, slots=True)
class OtherAircraft:
    """Another aircraft in the air over the same site, as it was heard last.

    Parameters
    ----------
    number
        By which it is called on the screen.
    motion
        In the site's frame.
    stop_enu_m
        Where it can come to rest.
    age_s
        Since it was heard there.
    """

    number: int
    motion: Motion
    stop_enu_m: Vec3
    age_s: float


@dataclass(frozen=True, slots=True)
class WatchRules:
    """What the pilot may choose, and what is known besides the vehicle's state.

    Parameters
    ----------
    needs_rtk
        Say so when the fix is less than RTK float.
    has_other_mission
        The mission on board was read in flight, and is not the one that was uploaded.
    others
        Other aircraft in the air.
    """

    needs_rtk: bool = False
    has_other_mission: bool = False
    others: tuple[OtherAircraft, ...] = ()


def watched(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules = WatchRules()
) -> Watch:
    """Warnings after one more state.

    On the ground only link, battery and GNSS are watched; what depends on a position that is not known any more stays
    as it was.
    """
    watch = replace(watch, passed_s=tuple(_passed(watch, state, around, now_s)))
    found = {each.code: each for rule in _RULES for each in rule(watch, state, around, now_s, rules)}
    warnings = []
    for code in dict.fromkeys([*(warning.code for warning in watch.warnings), *found]):
        former = next((warning for warning in watch.warnings if warning.code == code), None)
        shown = _shown(former, found.get(code), now_s)
        if shown is not None:
            warnings.append(shown)
    return replace(watch, warnings=tuple(warnings))


def _shown(former: FlightWarning | None, found: Watched | None, now_s: float) -> FlightWarning | None:
    if found is None:
        return former if former is not None and now_s - former.since_s < HOLD_S else None
    if former is None:
        if found.excess <= 0.0:
            return None
        return FlightWarning(found.code, found.severity, found.text, now_s, found.value, found.limit, found.unit)
    if found.excess < -found.slack and now_s - former.since_s >= HOLD_S:
        return None
    return replace(former, severity=found.severity, text=found.text, value=found.value)


def stop_point(motion: Motion, deceleration_m_s2: float, reaction_s: float) -> Vec3:
    """Where an aircraft comes to rest that flies on for `reaction_s` and then brakes: v t + v^2 / (2 a) ahead."""
    speed = math.sqrt(sum(part * part for part in motion.velocity_enu_m_s))
    ahead_s = reaction_s + speed / (2.0 * deceleration_m_s2)
    x, y, z = (p + v * ahead_s for p, v in zip(motion.position_enu_m, motion.velocity_enu_m_s, strict=True))
    return (x, y, z)


def _link(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    if state.heartbeat is None:
        return
    age_s = state.heartbeat.age_s(now_s)
    text = say("no heartbeat for {:.0f} s: what is shown is old; the aircraft goes on by itself", age_s)
    yield Watched("link-lost", Severity.ERROR, text, age_s - LINK_LOST_S, LINK_LOST_S / 2.0, age_s, LINK_LOST_S, "s")


def _impostor(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    if state.impostor:
        text = say(
            "{} go by one number on this link: nothing shown here can be relied on; fly it by hand", state.impostor
        )
        yield Watched("two-vehicles", Severity.ERROR, text, 1.0, 0.0, 1.0, 0.0)


def _distance(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    motion = motion_in_air(state, now_s)
    if motion is None:
        return
    limit_m = around.space.min_distance_m - DISTANCE_TOLERANCE_M
    end = stop_of(state, motion, around)
    ahead_m = around.facade_distance_m(motion.position_enu_m, end)
    here_m = around.facade_distance_m(motion.position_enu_m, motion.position_enu_m)
    severity = Severity.ERROR if here_m < limit_m else Severity.WARNING
    text = say("the facade is {:.1f} m away and will be {:.1f} m away where the aircraft can stop", here_m, ahead_m)
    excess_m = limit_m - ahead_m
    yield Watched("facade-distance", severity, text, excess_m, DISTANCE_SLACK_M, ahead_m, limit_m, "m")


def _apart(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    """Distance to the nearest other aircraft, and whether all of them are heard."""
    motion = motion_in_air(state, now_s)
    if motion is None or not rules.others:
        return
    silent = max(rules.others, key=lambda other: other.age_s)
    text = say(
        "aircraft {} was last heard {:.0f} s ago: the distance to it is not watched", silent.number, silent.age_s
    )
    excess_s = silent.age_s - STALE_S
    yield Watched("aircraft-unheard", Severity.WARNING, text, excess_s, 0.0, silent.age_s, STALE_S, "s")
    heard = [other for other in rules.others if other.age_s <= STALE_S]
    if not heard:
        return
    limit_m = around.rules.apart_m - APART_TOLERANCE_M
    end = stop_of(state, motion, around)
    ahead_m, other = min(((ways_apart_m(motion.position_enu_m, end, each), each) for each in heard), key=lambda p: p[0])
    here_m = min(math.dist(motion.position_enu_m, each.motion.position_enu_m) for each in heard)
    severity = Severity.ERROR if here_m < limit_m else Severity.WARNING
    text = say(
        "aircraft {} is {:.1f} m away; where both can stop it may be {:.1f} m",
        *(other.number, math.dist(motion.position_enu_m, other.motion.position_enu_m), ahead_m),
    )
    yield Watched("aircraft-apart", severity, text, limit_m - ahead_m, APART_SLACK_M, ahead_m, limit_m, "m")


def stop_of(state: VehicleState, motion: Motion, around: Surroundings) -> Vec3:
    """Where an aircraft in the air can come to rest; a mission brakes by itself, else the pilot's reaction counts."""
    return stop_point(motion, around.aircraft.max_acceleration_m_s2, 0.0 if _flies_mission(state) else REACTION_S)


def ways_apart_m(start_enu_m: Vec3, end_enu_m: Vec3, other: OtherAircraft) -> float:
    """Smallest distance of a straight way to the other aircraft's way to where it can stop, whoever is where first."""
    ends = (start_enu_m, end_enu_m, other.motion.position_enu_m, other.stop_enu_m)
    return math.sqrt(segment_segment_d2(*(np.array(end, np.float64) for end in ends)))


def _wind(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    if state.wind_enu_m_s is None:
        return
    wind_m_s = math.hypot(*state.wind_enu_m_s.value[:2])
    limit_m_s = around.aircraft.max_wind_m_s
    severity = Severity.ERROR if wind_m_s > limit_m_s else Severity.WARNING
    text = say("the wind is {:.1f} m/s; {} may fly in up to {:g} m/s", wind_m_s, around.aircraft.name, limit_m_s)
    excess_m_s = wind_m_s - WIND_SHARE * limit_m_s
    yield Watched("wind", severity, text, excess_m_s, WIND_SLACK_M_S, wind_m_s, limit_m_s, "m/s")


def _battery(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    level = None if state.battery is None else state.battery.value.remaining
    if level is None:
        return
    reserve = around.rules.battery_reserve
    motion = motion_in_air(state, now_s)
    home = 0.0 if motion is None else around.way_home_s(motion.position_enu_m) / around.aircraft.endurance_s
    needed = reserve + home
    if level <= reserve:
        severity, text = (
            Severity.ERROR,
            say("the battery holds {:.0%}, less than the reserve of {:.0%}: land", level, reserve),
        )
    elif level <= needed:
        severity, text = (
            Severity.ERROR,
            say("the way home would use the reserve: {:.0%} left, {:.0%} needed", level, needed),
        )
    else:
        severity = Severity.WARNING
        text = say("the battery holds {:.0%}; at {:.0%} the aircraft must turn home", level, needed)
    yield Watched("battery", severity, text, needed + BATTERY_EARLY - level, BATTERY_SLACK, level, needed)


def _airspace(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    motion = motion_in_air(state, now_s)
    if motion is None:
        return
    end = stop_of(state, motion, around)
    room_m = around.airspace_room_m(end)
    here_m = around.airspace_room_m(motion.position_enu_m)
    severity = Severity.ERROR if here_m < 0.0 else Severity.WARNING
    text = say("the airspace ends {:.1f} m from where the aircraft can stop", max(room_m, 0.0))
    if here_m < 0.0:
        text = say("the aircraft is {:.1f} m outside the airspace", -here_m)
    # Plans use the airspace up to its faces, as they do the minimum distance.
    yield Watched("airspace", severity, text, -AIRSPACE_EARLY_M - room_m, AIRSPACE_SLACK_M, room_m, 0.0, "m")
    away_m = around.no_fly_distance_m(end)
    text = say("a no-fly zone is {:.1f} m from where the aircraft can stop", max(away_m, 0.0))
    severity = Severity.ERROR if away_m <= 0.0 else Severity.WARNING
    if math.isfinite(away_m):
        limit_m = max(0.0, around.space.no_fly_distance_m - DISTANCE_TOLERANCE_M)
        yield Watched("no-fly", severity, text, limit_m - away_m, AIRSPACE_SLACK_M, away_m, limit_m, "m")


def _gnss(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    if state.fix is None:
        return
    wanted = RTK_FLOAT if rules.needs_rtk else FIX_3D
    is_stale = state.fix.age_s(now_s) > STALE_S and state.is_link_alive(now_s)
    fix_type = 0 if is_stale else state.fix.value.fix_type
    severity = Severity.ERROR if fix_type < FIX_3D else Severity.WARNING
    text = say("the GNSS receiver has lost its fix: fly by hand or land") if fix_type < FIX_3D else say("RTK is lost")
    yield Watched("gnss", severity, text, wanted - fix_type - 0.5, 0.0, float(fix_type), float(wanted))


def _position(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    """The autopilot, or this ground station, does not know any more where an armed aircraft is."""
    if not state.is_armed or not state.is_link_alive(now_s) or state.heartbeat is None:
        return
    if state.landed is not None and state.landed.value is Landed.ON_GROUND:
        return
    silent_s = _silent_s(state)
    problem = "" if state.estimator is None else state.estimator.value.problem
    if silent_s > NO_POSITION_S:
        text = say(
            "the aircraft sends no position any more: its distance, airspace, no-fly zones and path are not "
            "watched; fly it by hand"
        )
        excess_s = silent_s - NO_POSITION_S
        yield Watched("position-lost", Severity.ERROR, text, excess_s, 0.0, silent_s, NO_POSITION_S, "s")
    elif problem:
        text = say(
            "the autopilot has {}: its place may be wrong, and so may the warnings of distance, airspace, "
            "no-fly zones and path; be ready to fly by hand",
            problem,
        )
        yield Watched("position-lost", Severity.ERROR, text, 1.0, 0.0, 1.0, 0.0)


def _silent_s(state: VehicleState) -> float:
    """How long before the last heartbeat the last position came; infinity where none did, 0 without a heartbeat."""
    if state.heartbeat is None:
        return 0.0
    return math.inf if state.motion is None else max(0.0, state.heartbeat.time_s - state.motion.time_s)


def _gimbal(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    """A camera that looks elsewhere: a gimbal that is stuck, locked, or was never commanded."""
    off_deg: list[tuple[float, str]] = []
    for photo in state.photos[-3:]:
        near = [
            (math.dist(photo.position_enu_m, expected.position_enu_m), expected)
            for expected in around.photos
            if expected.gimbal_pitch_deg is not None
        ]
        away_m, expected = min(near, key=lambda pair: pair[0], default=(math.inf, None))
        if expected is None or away_m > PHOTO_NEAR_M or photo.gimbal_pitch_deg is None:
            continue
        # Several views of one place differ by their angles: the nearest of these counts.
        there = [each.gimbal_pitch_deg for away, each in near if away <= away_m + PHOTO_NEAR_M]
        least = min(abs(photo.gimbal_pitch_deg - pitch) for pitch in there if pitch is not None)
        off_deg.append((least, expected.viewpoint_id))
    wrong = [each for each in off_deg if each[0] > GIMBAL_OFF_DEG]
    if len(wrong) >= GIMBAL_PHOTOS:
        worst, place = max(wrong)
        text = say(
            "the camera looked {:.0f} degrees off at viewpoint '{}', and elsewhere at {} of the last {} "
            "photos: the gimbal may be stuck; pause, and look",
            worst,
            place,
            len(wrong),
            len(off_deg),
        )
        excess = worst - GIMBAL_OFF_DEG
        yield Watched("gimbal", Severity.ERROR, text, excess, 0.0, worst, GIMBAL_OFF_DEG, "deg")


def _photos(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    missing = [name for name, since_s in watch.passed_s if now_s - since_s > PHOTO_LATE_S]
    if missing:
        text = say("no photo came from viewpoint '{}'; {} of this sortie are missing", missing[-1], len(missing))
        yield Watched("photo-missing", Severity.WARNING, text, float(len(missing)), 0.0, float(len(missing)), 0.0)


def _deviation(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    motion = motion_in_air(state, now_s)
    if motion is None or not _flies_mission(state):
        return
    off_m = around.off_path_m(motion.position_enu_m)
    text = say("the aircraft is {:.1f} m beside its planned path", off_m)
    yield Watched("off-path", Severity.WARNING, text, off_m - OFF_PATH_M, OFF_PATH_SLACK_M, off_m, OFF_PATH_M, "m")


def _board(
    watch: Watch, state: VehicleState, around: Surroundings, now_s: float, rules: WatchRules
) -> Iterator[Watched]:
    if rules.has_other_mission:
        text = say(
            "the vehicle has another mission now than the one that was uploaded: pause it, and look what it does"
        )
        yield Watched("other-mission", Severity.ERROR, text, 1.0, 0.0, 1.0, 0.0)


Rule = Callable[[Watch, VehicleState, Surroundings, float, WatchRules], Iterator[Watched]]

_RULES: tuple[Rule, ...] = (
    *(_link, _impostor, _position, _board, _distance, _apart, _airspace, _gnss),
    *(_battery, _wind, _deviation, _gimbal, _photos),
)


def _passed(watch: Watch, state: VehicleState, around: Surroundings, now_s: float) -> Iterator[tuple[str, float]]:
    """Viewpoints behind the current item that have no photo, and since when that is known."""
    if state.mission is None:
        return
    known = dict(watch.passed_s)
    # The item behind the trigger keeps the aircraft in place until the photo is taken: it counts as not passed yet.
    for expected in around.photos:
        if expected.trigger_seq + 1 >= state.mission.value.current:
            return
        if not any(math.dist(p.position_enu_m, expected.position_enu_m) <= PHOTO_NEAR_M for p in state.photos):
            yield expected.viewpoint_id, known.get(expected.viewpoint_id, now_s)


def motion_in_air(state: VehicleState, now_s: float) -> Motion | None:
    """Motion of a vehicle that is in the air, where it is known."""
    if state.motion is None or state.motion.age_s(now_s) > STALE_S or not state.is_armed:
        return None
    if _silent_s(state) > NO_POSITION_S:
        return None
    if state.landed is not None and state.landed.value is Landed.ON_GROUND:
        return None
    return state.motion.value


def _flies_mission(state: VehicleState) -> bool:
    autopilot, mode = state.autopilot, state.mode
    return autopilot is not None and mode is not None and mode.value == MISSION_MODE[autopilot]
