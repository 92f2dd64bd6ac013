"""The list before take-off: what is well, what is still to come, and what grounds the flight."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.setup import ParameterChange, change_text
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.watch import FIX_3D, RTK_FLOAT, STALE_S
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.remote_id import refusal_text
from missions.mavlink.transfer.exchange import MissionType
from missions.mission.model import altitude_amsl_m as home_altitude_amsl_m
from planning.base.findings import Severity
from planning.base.messages import glue, joined, say
from planning.geo.frames import Vec3
from planning.insight.flight_profile import LOW_M
from planning.site.records import MIN_HEIGHT_ABOVE_GROUND_M

HOME_M = 3.0
"""How far from the planned home the aircraft may stand: it climbs where it is, and the plan's column has that room."""

HOME_HEIGHT_M = 1.0
"""How much higher or lower than the planned home it may stand: every height of the flight is counted from there."""

PRE_ARM = say("pre-arm checks")
"""Name of that bit in `data/vehicle.toml`."""

HEIGHT_ROUNDING_M = 1e-3
"""Heights of plans are rounded to less than this."""

REMOTE_ID_S = 3.0
"""The module speaks once a second, and ArduPilot does not arm where it was silent for so long."""

MAX_TOLD = 3
"""Zones that a line of the list names: the check before has said all."""

_FIX_NAMES = (
    say("no fix"),
    say("no fix"),
    say("2-D"),
    say("3-D"),
    say("differential"),
    say("RTK float"),
    say("RTK fixed"),
    say("static"),
)  # by GPS_FIX_TYPE


def fix_name(fix_type: int) -> str:
    """What a receiver's kind of fix is called; its number where MAVLink has no such kind."""
    return _FIX_NAMES[fix_type] if 0 <= fix_type < len(_FIX_NAMES) else str(fix_type)


class Verdict(Enum):
    """What a check came to."""

    OK = "ok"
    WAIT = "wait"
    """Not known yet, or not yet well; it may become so by itself."""
    WARN = "warn"
    """It may be flown so; the pilot should know."""
    BAD = "bad"
    """It will not become well by itself."""


@dataclass(frozen=True, slots=True)
class PreflightCheck:
    """One line of the list; `value` and `limit` where something was measured, in `unit`."""

    code: str
    verdict: Verdict
    text: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""


@dataclass(frozen=True, slots=True)
class OnBoard:
    """What was read back from the vehicle and compared: None while that is not done, or not known any more.

    Parameters
    ----------
    reason_to_reread
        Why what was equal is not known any more (`board.py`); empty where nothing speaks against it.
    changes
        Parameters that should be set for the plan; None while they were not read.
    failsafes
        What the vehicle will do by itself, by its parameters (`failsafes.py`); empty while they were not read.
    camera
        Whether the camera took its settings; None where it is one that takes none.
    found_fence
        Items of a fence that this ground station did not put there, and that stays on board.
    fence_check
        What there is to say of the fence that was on board before; None where nothing was.
    """

    mission: bool | None = None
    fence: bool | None = None
    rally: bool | None = None
    reason_to_reread: str = ""
    changes: tuple[ParameterChange, ...] | None = None
    failsafes: tuple[PreflightCheck, ...] = ()
    camera: PreflightCheck | None = None
    found_fence: tuple[MissionItemInt, ...] = ()
    fence_check: PreflightCheck | None = None

    def of(self, mission_type: MissionType) -> bool | None:
        """Whether a list is the one that was uploaded."""
        return {MissionType.MISSION: self.mission, MissionType.FENCE: self.fence, MissionType.RALLY: self.rally}[
            mission_type
        ]

    def known(self, mission_type: MissionType, is_equal: bool | None) -> OnBoard:
        """With what is known now of a list."""
        match mission_type:
            case MissionType.MISSION:
                return replace(self, mission=is_equal)
            case MissionType.FENCE:
                return replace(self, fence=is_equal)
            case MissionType.RALLY:
                return replace(self, rally=is_equal)


def preflight_checks(
    state: VehicleState,
    orders: SortieOrders,
    on_board: OnBoard,
    now_s: float,
    *,
    needs_rtk: bool,
    overrules: frozenset[str] = frozenset(),
) -> tuple[PreflightCheck, ...]:
    """All checks, in the order in which they are shown.

    Parameters
    ----------
    overrules
        Codes that the pilot overruled.
    """
    checks = (
        _link(state, now_s),
        _position(state, now_s),
        _gnss(state, now_s, needs_rtk),
        _home(state, orders, now_s),
        _home_height(state, orders),
        _battery(state, orders, now_s),
        *_sensors(state),
        *_remote_id(state, now_s),
        _wind(state, orders),
        *_low_flight(orders),
        _board("mission", "mission", on_board.mission, on_board.reason_to_reread),
        *_geofence(state, orders, on_board),
        *(
            [_board("rally", say("list of rally points"), on_board.rally, on_board.reason_to_reread)]
            if orders.rally
            else []
        ),
        *_parameters(on_board.changes),
        *([] if on_board.camera is None else [on_board.camera]),
        *on_board.failsafes,
    )
    return overruled(checks, overrules)


class Remedy(Enum):
    """What the pilot can do about a check from here."""

    SET_PARAMETERS = "set-parameters"
    RAISE = "raise"
    """Fly the same places from where the aircraft stands."""
    PLAN_FROM_HERE = "plan-from-here"
    """Make the place where the aircraft stands the site's home."""
    OVERRULE = "overrule"


FOREIGN_FENCE = "foreign-fence"
"""Code of the check of a fence that somebody else put on board: overruled, it is removed."""

FENCE_BEFORE = "fence-before"
"""Code of the line on what became of the fence that was on board before."""

OVERRULABLE = frozenset(("return", "home-height", "parameters", FOREIGN_FENCE))
"""Codes of checks that ground a flight until the pilot overrules them by typing the code."""


def overruled(checks: Iterable[PreflightCheck], codes: frozenset[str]) -> tuple[PreflightCheck, ...]:
    """Checks with those that the pilot overruled told as warnings."""
    return tuple(
        replace(check, verdict=Verdict.WARN, text=say("{} (overruled)", check.text))
        if check.verdict is Verdict.BAD and check.code in codes & OVERRULABLE
        else check
        for check in checks
    )


def remedies(check: PreflightCheck, on_board: OnBoard) -> tuple[Remedy, ...]:
    """What can be done about a check, the best first; nothing about one that is well, or that time mends."""
    if check.verdict not in (Verdict.WARN, Verdict.BAD):
        return ()
    ways: list[Remedy] = []
    if check.code in ("parameters", "return") and on_board.changes:
        ways.append(Remedy.SET_PARAMETERS)
    if check.verdict is Verdict.BAD:
        ways += {"home": [Remedy.PLAN_FROM_HERE], "home-height": [Remedy.RAISE, Remedy.PLAN_FROM_HERE]}.get(
            check.code, []
        )
        ways += [Remedy.OVERRULE] if check.code in OVERRULABLE else []
    return tuple(ways)


def warnings_of(checks: Iterable[PreflightCheck]) -> tuple[PreflightCheck, ...]:
    """What the pilot has to know, and confirms by starting."""
    return tuple(check for check in checks if check.verdict is Verdict.WARN)


def is_ready(checks: tuple[PreflightCheck, ...]) -> bool:
    """Whether nothing is missing."""
    return all(check.verdict in (Verdict.OK, Verdict.WARN) for check in checks)


def _link(state: VehicleState, now_s: float) -> PreflightCheck:
    if state.heartbeat is None or state.autopilot is None:
        return PreflightCheck("link", Verdict.WAIT, say("no autopilot was heard yet"))
    if not state.is_link_alive(now_s):
        return PreflightCheck("link", Verdict.WAIT, say("no heartbeat for {:.0f} s", state.heartbeat.age_s(now_s)))
    number = state.address.system if state.address is not None else 0
    if state.impostor:
        text = say(
            "{} go by the number {} on this link: switch one off, or give each a number of its own "
            "(SYSID_THISMAV, MAV_SYS_ID)",
            state.impostor,
            number,
        )
        return PreflightCheck("link", Verdict.BAD, text)
    if state.others:
        others = ", ".join(map(str, sorted(state.others)))
        text = say("{} answers, vehicle {}; others are on the link, too: {}", state.autopilot.product, number, others)
        return PreflightCheck("link", Verdict.WARN, text)
    return PreflightCheck("link", Verdict.OK, say("{} answers", state.autopilot.product))


def _position(state: VehicleState, now_s: float) -> PreflightCheck:
    if state.estimator is None and state.motion is None:
        return PreflightCheck("position", Verdict.WAIT, say("the autopilot does not know where it is yet"))
    if state.estimator is not None and state.estimator.value.problem:
        return PreflightCheck("position", Verdict.WAIT, say("the autopilot has {}", state.estimator.value.problem))
    if state.motion is None or state.motion.age_s(now_s) > STALE_S:
        return PreflightCheck("position", Verdict.WAIT, say("the autopilot sends no position"))
    if state.estimator is None:
        text = say("the autopilot says where it is, but not how sure of it: compare it with the map")
        return PreflightCheck("position", Verdict.WARN, text)
    return PreflightCheck("position", Verdict.OK, say("the autopilot knows where it is"))


def _gnss(state: VehicleState, now_s: float, needs_rtk: bool) -> PreflightCheck:
    if state.fix is None or state.fix.age_s(now_s) > STALE_S:
        return PreflightCheck("gnss", Verdict.WAIT, say("the GNSS receiver is silent"))
    fix, wanted = state.fix.value, RTK_FLOAT if needs_rtk else FIX_3D
    text = say("fix: {}, {} satellites", fix_name(fix.fix_type), fix.n_satellites)
    if fix.horizontal_accuracy_m is not None:
        text += say(", {:.2f} m", fix.horizontal_accuracy_m)
    verdict = Verdict.OK if fix.fix_type >= wanted else Verdict.WAIT
    if verdict is Verdict.WAIT:
        text += say("; {} is needed", fix_name(wanted))
    return PreflightCheck("gnss", verdict, text, float(fix.fix_type), float(wanted))


def _home(state: VehicleState, orders: SortieOrders, now_s: float) -> PreflightCheck:
    # Autopilots set home anew when they are armed: where the aircraft stands is what counts.
    if state.motion is None:
        return PreflightCheck("home", Verdict.WAIT, say("where the aircraft stands is not known yet"))
    x, y, _ = state.motion.value.position_enu_m
    away_m = math.dist((x, y), orders.home_enu_m[:2])
    low, high = orders.site.airspace.min_enu_m, orders.site.airspace.max_enu_m
    place = f"{orders.home.lat_deg:.7f}, {orders.home.lon_deg:.7f}"
    # A home on the border is inside; an aircraft on it stands a little to either side.
    if away_m > HOME_M and not (low[0] <= x <= high[0] and low[1] <= y <= high[1]):
        text = say(
            "the aircraft stands {:.0f} m from the planned home, outside the airspace; put it at {}", away_m, place
        )
        return PreflightCheck("home", Verdict.BAD, text, away_m, HOME_M, "m")
    if away_m > HOME_M:
        text = say("the aircraft stands {:.1f} m from the planned home; put it at {}, or plan from here", away_m, place)
        return PreflightCheck("home", Verdict.BAD, text, away_m, HOME_M, "m")
    return PreflightCheck("home", Verdict.OK, say("{:.1f} m from the planned home", away_m), away_m, HOME_M, "m")


def stands_above_m(state: VehicleState, orders: SortieOrders, altitude_amsl_m: float) -> float:
    """How far above the planned home an altitude lies that the vehicle tells, by its receiver's own geoid."""
    geoid_m = None if state.fix is None else state.fix.value.geoid_m
    if geoid_m is None:
        return altitude_amsl_m - home_altitude_amsl_m(orders.home)
    return altitude_amsl_m + geoid_m - orders.home.height_ellipsoid_m


def stands_enu_m(state: VehicleState, orders: SortieOrders) -> Vec3 | None:
    """Where the aircraft stands, its height by its own altitude; None where that is not known."""
    if state.motion is None or state.home_altitude_amsl_m is None:
        return None
    x, y, _ = state.motion.value.position_enu_m
    stands_m = state.home_altitude_amsl_m + state.motion.value.height_above_home_m
    return (x, y, orders.home_enu_m[2] + stands_above_m(state, orders, stands_m))


def _home_height(state: VehicleState, orders: SortieOrders) -> PreflightCheck:
    """Where the aircraft stands, and from where it counts its heights: both are the height of the planned home."""
    if state.motion is None or state.home_altitude_amsl_m is None:
        return PreflightCheck("home-height", Verdict.WAIT, say("how high the aircraft stands is not known yet"))
    stands_m = state.home_altitude_amsl_m + state.motion.value.height_above_home_m
    above_m = stands_above_m(state, orders, stands_m)
    accuracy_m = None if state.fix is None else state.fix.value.vertical_accuracy_m
    accuracy = "" if accuracy_m is None else say(" (its GNSS height is good to {:.1f} m)", accuracy_m)
    if abs(above_m) > HOME_HEIGHT_M:
        if above_m < 0.0:
            text = say(
                "the aircraft stands {:.1f} m lower than the planned home{}, and all of the flight would be: "
                "raise it by {:.1f} m, or plan from here",
                -above_m,
                accuracy,
                -above_m,
            )
        else:
            text = say(
                "the aircraft stands {:.1f} m higher than the planned home{}, and all of the flight would be: "
                "lower it by {:.1f} m, or plan from here",
                above_m,
                accuracy,
                above_m,
            )
        return PreflightCheck("home-height", Verdict.BAD, text, above_m, HOME_HEIGHT_M, "m")
    counted_m = state.home_position_amsl_m
    off_m = 0.0 if counted_m is None else stands_above_m(state, orders, counted_m)
    if abs(off_m) > HOME_HEIGHT_M:
        # ArduPilot sets its home anew when it is armed, and that is looked at again; PX4 takes off at once.
        text = (
            say(
                "the vehicle's own home lies {:.1f} m higher than the planned one: set it anew where it stands",
                abs(off_m),
            )
            if off_m > 0.0
            else say(
                "the vehicle's own home lies {:.1f} m lower than the planned one: set it anew where it stands",
                abs(off_m),
            )
        )
        verdict = Verdict.WARN if state.autopilot is Autopilot.ARDUPILOT else Verdict.BAD
        return PreflightCheck("home-height", verdict, text, off_m, HOME_HEIGHT_M, "m")
    text = (
        say("{:.1f} m above the planned home{}", abs(above_m), accuracy)
        if above_m >= 0.0
        else say("{:.1f} m below the planned home{}", abs(above_m), accuracy)
    )
    if accuracy_m is not None and accuracy_m > HOME_HEIGHT_M:
        text = say("{}, which is less sure than the {:g} m allowed: look whether it stands there", text, HOME_HEIGHT_M)
        return PreflightCheck("home-height", Verdict.WARN, text, above_m, HOME_HEIGHT_M, "m")
    return PreflightCheck("home-height", Verdict.OK, text, above_m, HOME_HEIGHT_M, "m")


def _slower(orders: SortieOrders, autopilot: Autopilot) -> str:
    """Why a sortie takes more of a battery than its plan says; empty where that does not show."""
    needed, planned = orders.battery_needed_by(autopilot), orders.battery_needed
    if f"{needed:.0%}" == f"{planned:.0%}":
        return ""
    takes, reckons = _minutes(orders.duration_s(autopilot)), _minutes(orders.mission.duration_s)
    return say(" ({} flies it in {} min, the plan reckons with {} min)", autopilot.product, takes, reckons)


def _minutes(duration_s: float) -> str:
    minutes, seconds = divmod(round(duration_s), 60)
    return f"{minutes}:{seconds:02d}"


def _battery(state: VehicleState, orders: SortieOrders, now_s: float) -> PreflightCheck:
    level = None if state.battery is None else state.battery.value.remaining
    if level is None:
        return PreflightCheck("battery", Verdict.WAIT, say("the battery's charge is not known"))
    needed = orders.battery_needed_by(state.autopilot)
    why = "" if state.autopilot is None else _slower(orders, state.autopilot)
    if level < needed:
        advice = (
            say("put in a full one")
            if needed <= 1.0
            else say("none holds that much: plan it again, in shorter sorties")
        )
        text = say(
            "the battery holds {:.0%}; the sortie and the reserve take {}: {}",
            level,
            glue(f"{needed:.0%}", why),
            advice,
        )
        return PreflightCheck("battery", Verdict.BAD, text, level, needed)
    text = say("{:.0%}; the sortie and the reserve take {}", level, glue(f"{needed:.0%}", why))
    return PreflightCheck("battery", Verdict.OK, text, level, needed)


def _sensors(state: VehicleState) -> Iterator[PreflightCheck]:
    """What the autopilot says of its own sensors; only its pre-arm checks decide whether it can be armed."""
    if state.sensor_problems is None:
        return
    problems = state.sensor_problems.value
    if PRE_ARM in problems:
        texts = (text.text for text in reversed(state.texts) if text.text.startswith("PreArm"))
        reason = next(texts, say("it does not say why"))
        if "OpenDroneID" in reason:
            reason = say("remote ID: {}", refusal_text(reason))
        yield PreflightCheck("sensors", Verdict.WAIT, say("the autopilot cannot be armed yet ({})", reason))
    elif problems:
        text = say(
            "it can be armed, but has trouble with: {}; find out why, or start only where the flight does without",
            joined(", ", problems),
        )
        yield PreflightCheck("sensors", Verdict.WARN, text)
    else:
        yield PreflightCheck("sensors", Verdict.OK, say("healthy"))


def _remote_id(state: VehicleState, now_s: float) -> Iterator[PreflightCheck]:
    """What the module for remote identification says; vehicles without one have no such line."""
    told = state.remote_id
    if told is None:
        return
    if told.age_s(now_s) > REMOTE_ID_S:
        text = say("the module has been silent for {:.0f} s; it may not let the aircraft arm", told.age_s(now_s))
        yield PreflightCheck("remote-id", Verdict.WAIT, text)
    elif told.value.problem:
        yield PreflightCheck("remote-id", Verdict.WAIT, refusal_text(told.value.problem))
    else:
        yield PreflightCheck("remote-id", Verdict.OK, say("the module is content"))


def _wind(state: VehicleState, orders: SortieOrders) -> PreflightCheck:
    limit_m_s = orders.mission.aircraft.max_wind_m_s
    if state.wind_enu_m_s is None:
        # Multirotors without an airspeed sensor know the wind only in flight.
        text = say(
            "not measured on the ground: look up, or measure it; {} flies in up to {:g} m/s",
            orders.mission.aircraft.name,
            limit_m_s,
        )
        return PreflightCheck("wind", Verdict.WARN, text, None, limit_m_s, "m/s")
    wind_m_s = math.hypot(*state.wind_enu_m_s.value[:2])
    if wind_m_s > limit_m_s:
        name = orders.mission.aircraft.name
        text = say(
            "the wind blows with {:.1f} m/s, more than the {:g} m/s of {}; wait for less", wind_m_s, limit_m_s, name
        )
        return PreflightCheck("wind", Verdict.BAD, text, wind_m_s, limit_m_s, "m/s")
    return PreflightCheck("wind", Verdict.OK, f"{wind_m_s:.1f} m/s", wind_m_s, limit_m_s, "m/s")


def _low_flight(orders: SortieOrders) -> Iterator[PreflightCheck]:
    low, usual_m = orders.low, MIN_HEIGHT_ABOVE_GROUND_M
    if low is None:
        return
    text = say("down to {:.1f} m above the ground", low.lowest_m)
    if low.below_s is not None and low.lowest_m < LOW_M:
        text = say("{}, {} min below {:g} m", text, _minutes(low.below_s), LOW_M)
    if low.lowest_m >= usual_m - HEIGHT_ROUNDING_M:
        yield PreflightCheck("low-flight", Verdict.OK, text, low.lowest_m, usual_m, "m")
        return
    text = say("{}, under the usual {:g} m: look for people, cars and cables on the whole way", text, usual_m)
    yield PreflightCheck("low-flight", Verdict.WARN, text, low.lowest_m, usual_m, "m")


def _geofence(state: VehicleState, orders: SortieOrders, on_board: OnBoard) -> Iterator[PreflightCheck]:
    """Whether the fence is on board, what was there before, and what it does not keep the vehicle out of."""
    autopilot = state.autopilot if state.autopilot is not None else next(iter(Autopilot))
    has_own, reason = bool(orders.fences.get(autopilot)), on_board.reason_to_reread
    if on_board.fence_check is not None:
        yield on_board.fence_check
    if (has_own and not on_board.found_fence) or on_board.fence is False:
        yield _board("geofence", "geofence", on_board.fence, reason)
    elif on_board.fence is None and reason and not has_own:
        yield PreflightCheck("geofence", Verdict.WAIT, say("the geofence on board is read again: {}", reason))
    elif on_board.fence and not on_board.found_fence:
        yield PreflightCheck("geofence", Verdict.OK, say("none is on board, and the sortie needs none"))
    found = orders.unfenced.get(autopilot, ())
    for severity, verdict in ((Severity.WARNING, Verdict.WARN), (Severity.NOTE, Verdict.OK)):
        told = [finding for finding in found if finding.severity is severity]
        if told:
            text = joined("; ", [glue(finding.place, ": ", finding.message) for finding in told[:MAX_TOLD]])
            if len(told) > MAX_TOLD:
                text = say("{}; and {} more", text, len(told) - MAX_TOLD)
            yield PreflightCheck("fence-gaps" if severity is Severity.WARNING else "fence-shape", verdict, text)


def _parameters(changes: tuple[ParameterChange, ...] | None) -> Iterator[PreflightCheck]:
    if changes is None:
        return
    off = [change for change in changes if change.is_off]
    if not changes:
        yield PreflightCheck("parameters", Verdict.OK, say("they are as the plan needs them"))
    elif off:
        yield PreflightCheck("parameters", Verdict.BAD, change_text(off[0]), float(len(changes)), 0.0)
    else:
        text = change_text(changes[0])
        if len(changes) > 1:
            text += say("; {} more differ", len(changes) - 1)
        yield PreflightCheck("parameters", Verdict.WARN, text, float(len(changes)), 0.0)


def _board(code: str, what: str, is_equal: bool | None, reason_to_reread: str) -> PreflightCheck:
    if is_equal is None and reason_to_reread:
        return PreflightCheck(
            code, Verdict.WAIT, say("the {} was uploaded, but {}: it is read again", what, reason_to_reread)
        )
    if is_equal is None:
        return PreflightCheck(code, Verdict.WAIT, say("the {} was not uploaded yet", what))
    if not is_equal:
        return PreflightCheck(code, Verdict.BAD, say("what the vehicle holds is not this {}: upload it again", what))
    return PreflightCheck(code, Verdict.OK, say("the {} is on board, read back and equal", what))
