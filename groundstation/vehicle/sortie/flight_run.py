"""One sortie, from the first heartbeat to the landing, as a state machine without any link.

    CONNECTING -> PREPARING   an autopilot was heard
    PREPARING  -> UPLOADING   it sends what is watched, and its parameters are as they should be (it may be rebooted)
    UPLOADING  -> CHECKING    mission and geofence were read back and are equal
    CHECKING   -> READY       nothing on the pre-flight list is missing
    READY      -> CHECKING    something on it is no longer well while the pilot waits, such as the wind
    READY      -> STARTING    the pilot said so (or nobody was to be asked)
    STARTING   -> FLYING      armed and in the mission's mode
    FLYING     -> ENDED       landed and disarmed
    any        -> ENDED       it cannot go on: what failed, and what to do, stands in the outcome

`sortie_run.py` is what all of it runs on. Pilot's orders (pause, resume, return, land) go out beside it
at any time. Losing the link ends nothing: it is shown, and the aircraft goes on by itself. Whatever may have changed
what is on board makes it unknown until it was read again (`board.py`). Reports of photos that the radio lost are asked
for again, beside it too (`camera_reports.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from dataclasses import replace
from typing import Any

from groundstation.vehicle.camera import (
    CameraInformationCall,
    CameraSettingCall,
    WantedSetting,
    definition_place,
    settings_text,
    wanted_settings,
)
from groundstation.vehicle.commands import (
    MAV_RESULT_TEMPORARILY_REJECTED,
    MISSION_MODE,
    Answer,
    CommandCall,
    CommandOutcome,
    set_mode_command,
)
from groundstation.vehicle.failsafes import (
    FOUND_FENCE_NAMES,
    NAMES,
    failsafe_checks,
    fence_words,
    found_fence_check,
)
from groundstation.vehicle.orders import fence_messages, rally_messages
from groundstation.vehicle.parameters import ParameterCall, ParameterOutcome, ParameterReads, ParameterStatus
from groundstation.vehicle.preflight import (
    FENCE_BEFORE,
    FOREIGN_FENCE,
    HOME_HEIGHT_M,
    PreflightCheck,
    Verdict,
    is_ready,
    overruled,
    stands_above_m,
    warnings_of,
)
from groundstation.vehicle.recorder import Recorder
from groundstation.vehicle.setup import (
    ParameterChange,
    change_text,
    is_simulation,
    message_requests,
    needs_reboot,
    parameter_changes,
    simulation_names,
    wanted_parameters,
)
from groundstation.vehicle.sortie.board import READ_PAUSE_S, RESTARTED, UNREAD, BoardList, BoardReread, ListRead
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.sortie.sortie_run import SortieRun, Steps
from groundstation.vehicle.state import Landed, VehicleState, after_restart
from groundstation.vehicle.watch import STALE_S
from missions.flight.report_rules import FRESH_S
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.camera_definition import MAX_BYTES as DEFINITION_BYTES
from missions.mavlink.camera_definition import CameraDefinition, parse_definition
from missions.mavlink.ftp import FileOutcome, FileRead
from missions.mavlink.messages import Address, CommandLong
from missions.mavlink.remote_id import refusal_text
from missions.mavlink.transfer.exchange import Download, DownloadOutcome, Ending, MissionType, Route
from missions.mavlink.transfer.verified import NotVerified, Verified, VerifiedUpload
from missions.mavlink.transfer.wire_items import compare, to_wire
from planning.base.errors import InputError, LinkRejected, LinkTimeout, MissionError
from planning.base.messages import glue, joined, say

MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, MAV_CMD_MISSION_START = 246, 300
MAV_CMD_COMPONENT_ARM_DISARM = 400
REBOOT_AUTOPILOT = 1.0

ARMING_S, ARMING_PAUSE_S = 60.0, 2.0
"""How long arming is tried while the autopilot still has something to say against it."""

STARTS, LINK_BACK_S = 4, 30.0
"""How often a start is tried while the link comes and goes, and the wait for it between two."""

HOME_S = 2.0
"""Wait for a position after arming."""

MODE_S = 5.0
TAKE_OFF_S = 60.0
"""Wait for the aircraft to leave the ground once its mission was started."""

MOTORS_OFF_M = 3.0
"""Motors that stop higher than this, with nothing below, have stopped in the air."""

DISARM_S = 20.0
"""Wait for the autopilot to disarm by itself after it has landed."""

REPORTS_S = 10.0
"""Wait after the landing for reports of photos that the radio lost."""

ASK_EVERY_S = 10.0
"""How often telemetry is asked for again while no position comes before take-off."""

REBOOT_PAUSE_S, REBOOT_S = 3.0, 60.0
MAV_RESULT_FAILED = 4


def sortie_steps(run: SortieRun) -> Steps:
    """The whole sortie."""
    yield from _connect(run)
    run.phase = Phase.PREPARING
    yield from _prepare(run)
    run.phase = Phase.UPLOADING
    yield from upload(run)
    run.phase = Phase.CHECKING
    yield from _check(run)
    run.phase = Phase.READY
    while not run.may_start:
        yield None
        yield from _keep_up(run)
        run.phase = Phase.READY if is_ready(run.checks()) else Phase.CHECKING
    run.phase = Phase.STARTING
    yield from _start(run)
    run.phase = Phase.FLYING
    yield from _fly(run)


# Connecting and preparing


def _connect(run: SortieRun) -> Steps:
    deadline_s = run.now_s + run.options.connect_s
    while run.state.autopilot is None:
        if run.now_s > deadline_s:
            raise LinkTimeout(
                say(
                    "no ArduPilot or PX4 was heard within {:g} s; is the vehicle on, and the address right?",
                    run.options.connect_s,
                    place=run.link_name,
                )
            )
        yield None
    expected, found = run.options.autopilot, run.state.autopilot
    if expected is not None and found is not expected:
        raise LinkRejected(
            say("expected {}, found {}; name the other autopilot", expected.value, found.value, place=run.link_name)
        )
    if run.state.is_armed:
        raise LinkRejected(say("the vehicle is armed already; land and disarm it first", place=run.link_name))
    run.recorder = Recorder(f"{found.value}, {run.link_name}", run.state.address)


def _prepare(run: SortieRun) -> Steps:
    yield from _ask_for_telemetry(run)
    yield from _read_parameters(run)
    if not run.is_simulation and run.options.simulations_only:
        raise LinkRejected(f"{run.link_name}: {run.options.simulations_only}")
    if run.options.sets_parameters or run.is_simulation:
        yield from _set_parameters(run, run.on_board.changes or ())
    yield from _set_camera(run)
    for change in run.on_board.changes or ():
        run.note("warning-setup" if change.is_off else "parameter", change_text(change))
    run.camera_reports.ask_count()


def _read_parameters(run: SortieRun) -> Steps:
    """What the vehicle is, what it does by itself, and in what it differs from what the plan needs."""
    autopilot, address = vehicle_of(run)
    wanted = wanted_parameters(autopilot, run.orders.mission, run.orders.return_height_m)
    telling = (name for name in simulation_names(autopilot) if name not in run.unknown_names)
    names = dict.fromkeys((*telling, *wanted, *NAMES[autopilot]))
    values: dict[str, float] = yield ParameterReads(tuple(names), autopilot, address)
    # Real vehicles know none of them, and to learn that takes as long as all answers that radios lose: once is enough.
    run.unknown_names |= {name for name in simulation_names(autopilot) if name not in values}
    run.is_simulation = is_simulation(autopilot, values)
    checks = failsafe_checks(autopilot, values, run.orders)
    known = {check.text for check in run.on_board.failsafes}
    rally = [check for check in run.on_board.failsafes if check.code == "rally"]
    changes = parameter_changes(autopilot, wanted, values)
    run.on_board = replace(run.on_board, changes=changes, failsafes=(*rally, *checks))
    for check in checks:
        if check.verdict is Verdict.WARN and check.text not in known:
            run.note("warning-failsafe", check.text)
    unknown = [name for name in wanted if name not in values]
    if unknown and not run.has_told_unknown:
        run.has_told_unknown = True
        run.note("parameter", say("the vehicle does not know these parameters: {}", ", ".join(unknown)))


def _set_parameters(run: SortieRun, changes: tuple[ParameterChange, ...]) -> Steps:
    """Set what the pilot agreed to, or a simulation needs; restart the vehicle where that takes effect then only."""
    autopilot, address = vehicle_of(run)
    is_restart_due = False
    for change in changes:
        outcome: ParameterOutcome = yield ParameterCall(change.name, change.new, autopilot, address)
        if outcome.status is ParameterStatus.SET:
            is_restart_due |= change.needs_reboot
            run.note("parameter", say("{} was {:g} and is {:g} now", change.name, outcome.former, change.new))
        elif not outcome.is_as_set:
            run.note("parameter", f"{change.name}: {outcome.status.value}")
    if is_restart_due:
        yield from _reboot(run)
    if changes:
        yield from _read_parameters(run)


def _set_camera(run: SortieRun) -> Steps:
    """Set a camera that speaks the camera protocol, and believe what it says when it is read back."""
    _, address = vehicle_of(run)
    taken: list[WantedSetting] = []
    left: list[WantedSetting] = []
    definition = run.options.camera_definition
    if definition is None and wanted_settings(run.orders.mission):
        definition = yield from _camera_definition(run)
    wanted = wanted_settings(run.orders.mission, definition)
    if not wanted:
        return
    if definition is not None:
        values = yield from _camera_values(run, definition.rulers_of([each.name for each in wanted]))
        wanted = wanted_settings(run.orders.mission, definition, values)
    for each in wanted:
        if each.value is None:
            left.append(each)
            continue
        outcome: ParameterOutcome = yield CameraSettingCall(each.name, each.value, address.system)
        if outcome.status is ParameterStatus.UNKNOWN and not taken and not left:
            text = say("no camera answers by the camera protocol; set it by hand: {}", settings_text(wanted))
            run.on_board = replace(run.on_board, camera=PreflightCheck("camera", Verdict.WARN, text))
            run.note("camera", text)
            return
        (taken if outcome.is_as_set else left).append(each)
    texts = [say("the camera is set, and read back: {}", settings_text(taken))] if taken else []
    if left:
        texts.append(say("the camera does not take this, set it by hand: {}", settings_text(left)))
    text = joined("; ", texts)
    verdict = Verdict.WARN if left else Verdict.OK
    run.on_board = replace(run.on_board, camera=PreflightCheck("camera", verdict, text))
    run.note("camera", text)


def _camera_values(run: SortieRun, names: Iterable[str]) -> Generator[Any, Any, dict[str, float]]:
    """What parameters of the camera have now, as far as it answers."""
    _, address = vehicle_of(run)
    values = {}
    for name in names:
        outcome: ParameterOutcome = yield CameraSettingCall(name, None, address.system)
        if outcome.status is ParameterStatus.UNKNOWN:
            break
        if outcome.value is not None:
            values[name] = outcome.value
    return values


def _camera_definition(run: SortieRun) -> Generator[Any, Any, CameraDefinition | None]:
    """The camera's own definition file, where it has one on board; None where it is not known, which is told."""
    autopilot, address = vehicle_of(run)
    del autopilot
    source, information = yield CameraInformationCall(address.system)
    if information is None or not information.cam_definition_uri:
        return None
    place = definition_place(information, source)
    uri = "".join(letter for letter in information.cam_definition_uri if letter.isprintable())
    if place is None:
        run.note("camera", say("the camera's definition is not on board ({}); name its file to set it by that", uri))
        return None
    where, path = place
    read: FileOutcome = yield FileRead(
        Route(run.own, where), path, most_bytes=DEFINITION_BYTES, doing=say("fetching the camera's definition")
    )
    if read.ending is not Ending.DONE:
        run.note("camera", say("the camera's definition could not be fetched ({}): {}", read.ending.value, uri))
        return None
    try:
        definition = parse_definition(read.content, uri)
    except InputError as error:
        run.note("camera", say("the camera's definition is not taken: {}", error))
        return None
    name = " ".join(filter(None, (definition.vendor, definition.model)))
    run.note("camera", say("the camera's definition was fetched ({}): {} parameters", name, len(definition.parameters)))
    return definition


def _ask_for_telemetry(run: SortieRun, *, must_answer: bool = True) -> Steps:
    autopilot, address = vehicle_of(run)
    run.asked_s = run.now_s
    for command in message_requests(autopilot, address):
        outcome: CommandOutcome = yield CommandCall(say("sending telemetry"), command, run.own)
        if outcome.answer is Answer.NO_ANSWER and not must_answer:
            return
        if outcome.answer is Answer.NO_ANSWER:
            raise LinkTimeout(
                say("the vehicle is heard but does not answer; does the link go both ways?", place=run.link_name)
            )


def _reboot(run: SortieRun) -> Steps:
    """Restart the autopilot, once; its word for it may be lost, so what it sends afterwards is what tells.

    Its time since power-up goes back, or the messages that it was asked for do not come any more. How far the time has
    come says nothing: in a simulation it runs ahead of ours.
    """
    autopilot, address = vehicle_of(run)
    names = ", ".join(sorted(needs_reboot(autopilot)))
    command = CommandLong(address.system, address.component, MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, REBOOT_AUTOPILOT)
    before_s = run.state.boot_time_s or 0.0
    outcome: CommandOutcome = yield CommandCall("rebooting", command, run.own, n_attempts=1)
    if outcome.answer is Answer.REFUSED:
        raise LinkRejected(say("{}; {} take effect after a reboot only: restart the vehicle", outcome.text, names))
    run.note("reboot", say("the autopilot restarts, so that {} take effect", names))
    began_anew = yield from _wait(run, lambda state: (state.boot_time_s or before_s) < before_s, REBOOT_PAUSE_S)
    run.state = after_restart(run.state)
    is_back = yield from _wait(run, lambda state: state.heartbeat is not None and state.heartbeat.value > 1, REBOOT_S)
    if not is_back:
        raise LinkTimeout(
            say("the vehicle did not come back within {:g} s of its reboot", REBOOT_S, place=run.link_name)
        )
    if not began_anew and run.state.boot_time_s is not None and run.state.boot_time_s >= before_s:
        raise LinkRejected(
            say("the vehicle was not rebooted; {} take effect then: restart it", names, place=run.link_name)
        )
    yield from _ask_for_telemetry(run)


# Before take-off


def _check(run: SortieRun) -> Steps:
    """Wait until nothing is missing; give up at once on what will not become well by itself."""
    deadline_s = run.now_s + run.options.ready_s
    while not is_ready(checks := run.checks()):
        bad = [check.text for check in checks if check.verdict is Verdict.BAD]
        if bad and run.options.starts_itself:
            raise MissionError(say("not ready for take-off: ") + joined("; ", bad))
        if run.now_s > deadline_s and run.options.starts_itself:
            missing = [f"{check.code}: {check.text}" for check in checks if not is_ready((check,))]
            raise LinkTimeout(say("not ready for take-off after {:g} s: ", run.options.ready_s) + joined("; ", missing))
        yield None
        yield from _keep_up(run)
    if run.options.starts_itself and not run.is_simulation:
        known = {note.text for note in run.notes}
        for check in warnings_of(checks):
            if check.text not in known:
                run.note(f"warning-{check.code}", check.text)


def _keep_up(run: SortieRun) -> Steps:
    """Ask again for what does not come any more, and read again what is not known any more, where the vehicle is heard.

    A vehicle that was restarted has forgotten what it was asked to send, and its parameters may be others.
    """
    motion, reason = run.state.motion, run.on_board.reason_to_reread
    if not run.state.is_link_alive(run.now_s):
        return
    if (motion is None or motion.age_s(run.now_s) > STALE_S) and run.now_s > run.asked_s + ASK_EVERY_S:
        yield from _ask_for_telemetry(run, must_answer=False)
    if run.agreed:
        changes, run.agreed = run.agreed, ()
        yield from _set_parameters(run, changes)
    yield from _remove_found_fence(run)
    if not reason:
        return
    if reason == UNREAD:
        yield from _pause(run, READ_PAUSE_S)
    if reason == RESTARTED:
        run.state, run.unknown_names = after_restart(run.state), frozenset()
        yield from _ask_for_telemetry(run, must_answer=False)
        yield from _read_parameters(run)
    yield from read_again(run)


# Flying


def _set_mode(run: SortieRun, name: str) -> Steps:
    autopilot, address = vehicle_of(run)
    command = set_mode_command(autopilot, name, address.system, address.component)
    outcome: CommandOutcome = yield CommandCall(say("the mode {}", name), command, run.own)
    if not outcome.is_accepted:
        raise LinkRejected(f"{outcome.text}{_last_complaint(run)}")


def _arm(run: SortieRun) -> Steps:
    _, address = vehicle_of(run)
    deadline_s = run.now_s + ARMING_S
    while True:
        command = CommandLong(address.system, address.component, MAV_CMD_COMPONENT_ARM_DISARM, 1.0)
        outcome: CommandOutcome = yield CommandCall("arming", command, run.own)
        if outcome.is_accepted:
            return
        may_come = outcome.result in (MAV_RESULT_TEMPORARILY_REJECTED, MAV_RESULT_FAILED)
        if not may_come or run.now_s > deadline_s:
            raise LinkRejected(f"{outcome.text}{_last_complaint(run)}")
        yield from _pause(run, ARMING_PAUSE_S)


class _NotKnownError(LinkRejected):
    """What is on board is not known any more: it can be read again."""


def _start(run: SortieRun) -> Steps:
    """Start the mission; where a lost link leaves what is on board unknown meanwhile, begin again."""
    for attempt in range(1, STARTS + 1):
        try:
            yield from _start_once(run)
        except _NotKnownError:
            if attempt == STARTS:
                raise
            yield from _wait(run, lambda state: state.is_link_alive(run.now_s), LINK_BACK_S)
        else:
            return


def _start_once(run: SortieRun) -> Steps:
    """Start the mission as each autopilot wants it; an order of the pilot meanwhile ends that.

    What is on board is read once more before, and nothing may be said against it until the mission flies: somebody else
    may have written to the vehicle since it was read.
    """
    autopilot, address = vehicle_of(run)
    yield from _read_parameters(run)
    yield from _remove_found_fence(run)
    yield from _judge_found_fence(run)
    yield from read_again(run)
    _refuse_what_is_not_ours(run)
    if autopilot is Autopilot.ARDUPILOT:
        # AUTO cannot be armed in (without AUTO_OPTIONS), and begins to fly only when it is told to start.
        yield from _set_mode(run, "GUIDED")
        yield from _arm(run)
        if run.was_ordered_away:
            return
        yield from _wait_for_home(run)
        yield from _stop_where_doubted(run)
        yield from _set_mode(run, MISSION_MODE[autopilot])
        yield from _stop_where_doubted(run)
        command = CommandLong(address.system, address.component, MAV_CMD_MISSION_START)
        outcome: CommandOutcome = yield CommandCall(say("starting the mission"), command, run.own)
        if not outcome.is_accepted:
            raise LinkRejected(f"{outcome.text}{_last_complaint(run)}")
    else:
        # Armed first, PX4 refuses the mode for as long as it looks at the mission again from its new home. In the mode,
        # it refuses to be armed before the mission can be flown.
        yield from _set_mode(run, MISSION_MODE[autopilot])
        _refuse_what_is_not_ours(run)
        yield from _arm(run)
        # The heartbeat says so a little later, and may be lost.
        yield from _wait(run, lambda state: state.is_armed, MODE_S)
        if run.was_ordered_away:
            return
    wanted = MISSION_MODE[autopilot]
    in_mode = yield from _wait(run, lambda state: state.mode is not None and state.mode.value == wanted, MODE_S)
    if not in_mode and not run.was_ordered_away:
        found = "unknown" if run.state.mode is None else run.state.mode.value
        raise LinkRejected(say("the vehicle is in mode {} and not in {}", found, glue(wanted, _last_complaint(run))))
    run.note("started", say("sortie {}", run.orders.number))


def _refuse_what_is_not_ours(run: SortieRun, *, is_armed: bool = False) -> None:
    """Raise where what is on board is not what was uploaded, or not known; armed, where its home has moved away."""
    for ours in run.lists:
        if run.on_board.of(ours.route.mission_type) is False:
            raise LinkRejected(
                say(
                    "the {} on the vehicle is not the one that was uploaded; it was not started: upload it again",
                    ours.what,
                )
            )
    of_fence = () if run.on_board.fence_check is None else (run.on_board.fence_check,)
    checks = overruled((*of_fence, *run.on_board.failsafes), run.options.overrules)
    bad = [check.text for check in checks if check.verdict is Verdict.BAD]
    if bad:
        raise LinkRejected(say("{}; it was not started", bad[0]))
    home_m = run.state.home_altitude_amsl_m
    off_m = 0.0 if home_m is None else stands_above_m(run.state, run.orders, home_m)
    if is_armed and abs(off_m) > HOME_HEIGHT_M and "home-height" not in run.options.overrules:
        raise LinkRejected(
            say(
                "the vehicle counts its heights from {:.1f} m above the planned home; it was not started: set "
                "its home anew where it stands",
                abs(off_m),
            )
            if off_m > 0.0
            else say(
                "the vehicle counts its heights from {:.1f} m below the planned home; it was not started: set "
                "its home anew where it stands",
                abs(off_m),
            )
        )
    if run.on_board.reason_to_reread:
        raise _NotKnownError(
            say(
                "what is on the vehicle is not known ({}); it was not started: wait until it is read",
                run.on_board.reason_to_reread,
            )
        )


def _wait_for_home(run: SortieRun) -> Steps:
    """Wait for the height from which an armed vehicle counts: ArduPilot sets its home anew with arming."""
    armed_s = run.now_s
    yield from _wait(run, lambda state: state.home_heard_s > armed_s, HOME_S)


def _stop_where_doubted(run: SortieRun) -> Steps:
    """Disarm a vehicle that stands armed on the ground, where its mission may be another one by now."""
    try:
        _refuse_what_is_not_ours(run, is_armed=True)
    except LinkRejected:
        _, address = vehicle_of(run)
        command = CommandLong(address.system, address.component, MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
        yield CommandCall("disarming", command, run.own)
        raise


def _fly(run: SortieRun) -> Steps:
    """Watch until the aircraft has landed and is disarmed."""
    took_off = yield from _wait(run, lambda state: _is_flying(state) or not state.is_armed, TAKE_OFF_S)
    # Without a link nobody knows: what is heard when it is back decides.
    is_known = run.state.is_link_alive(run.now_s)
    if is_known and not (took_off and (run.state.is_armed or _is_flying(run.state))):
        raise MissionError(say("the aircraft did not take off{}", _last_complaint(run)))
    limit_s = (run.state.boot_time_s or 0.0) + 2.0 * run.orders.mission.aircraft.endurance_s
    landed_s: float | None = None
    was_up_m = 0.0
    while run.state.is_armed:
        was_up_m = _up_m(run)
        heartbeat = run.state.heartbeat
        if heartbeat is not None and heartbeat.age_s(run.now_s) > run.options.link_lost_s:
            raise LinkTimeout(
                say(
                    "the vehicle was not heard for {:g} s in flight; what was recorded ends there",
                    run.options.link_lost_s,
                )
            )
        if (run.state.boot_time_s or 0.0) > limit_s:
            raise LinkTimeout(say("the aircraft is armed for longer than any battery lasts; look at what it does"))
        landed = run.state.landed
        is_down = landed is not None and landed.value is Landed.ON_GROUND
        landed_s = (landed_s or run.now_s) if is_down else None
        if landed_s is not None and run.now_s - landed_s > DISARM_S:
            _, address = vehicle_of(run)
            command = CommandLong(address.system, address.component, MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
            yield CommandCall("disarming", command, run.own)
            landed_s = run.now_s
        yield None
    motion = run.state.motion
    if was_up_m > MOTORS_OFF_M and motion is not None and motion.age_s(run.now_s) <= FRESH_S:
        raise MissionError(
            say(
                "the motors stopped {:.0f} m above take-off: the aircraft fell; look for it{}",
                was_up_m,
                _last_complaint(run),
            )
        )
    if run.camera_reports.count is not None:
        run.camera_reports.ask_count()
    yield from _wait(run, lambda _state: run.camera_reports.is_settled, REPORTS_S)
    run.note("landed", say("{} photos were reported", len(run.state.photos)))


def _up_m(run: SortieRun) -> float:
    """Height above take-off of an aircraft in the air with nothing below it; 0 where it may stand on something."""
    motion, autopilot = run.state.motion, run.state.autopilot
    if motion is None or autopilot is None or motion.age_s(run.now_s) > STALE_S or not _is_flying(run.state):
        return 0.0
    place, around = motion.value.position_enu_m, run.orders.surroundings[autopilot]
    is_clear = motion.value.height_above_home_m > MOTORS_OFF_M and (
        around.facade_distance_m(place, place) > MOTORS_OFF_M
    )
    return motion.value.height_above_home_m if is_clear else 0.0


def _is_flying(state: VehicleState) -> bool:
    if state.landed is not None and state.landed.value in (Landed.IN_AIR, Landed.TAKING_OFF, Landed.LANDING):
        return True
    return state.motion is not None and state.is_armed and state.motion.value.height_above_home_m > 1.0


def _wait(run: SortieRun, condition: Callable[[VehicleState], bool], timeout_s: float) -> Generator[None, Any, bool]:
    """Wait for a condition; the generator's value says whether it came."""
    deadline_s = run.now_s + timeout_s
    while not condition(run.state):
        if run.now_s > deadline_s:
            return False
        yield None
    return True


def _pause(run: SortieRun, duration_s: float) -> Steps:
    until_s = run.now_s + duration_s
    while run.now_s < until_s:
        yield None


def _last_complaint(run: SortieRun) -> str:
    """The autopilot's own last words, warnings or worse, in brackets."""
    text = next((text.text for text in reversed(run.state.texts) if text.severity <= 4), "")
    if "OpenDroneID" in text:
        return say(" (remote ID: {})", refusal_text(text))
    return glue(" (", text, ")") if text else ""


# What has to be on board


def vehicle_of(run: SortieRun) -> tuple[Autopilot, Address]:
    """Kind and address of the vehicle, once one was heard."""
    autopilot, address = run.state.autopilot, run.state.address
    assert autopilot is not None
    assert address is not None
    return autopilot, address


def upload(run: SortieRun) -> Steps:
    """Geofence first: a mission is never on board without its fence."""
    autopilot, address = vehicle_of(run)
    run.lists = ()
    yield from _put_fence(run)
    yield from _put_rally_points(run)
    items = to_wire(run.orders.items[autopilot], autopilot)
    yield from _put(run, BoardList("mission", Route(run.own, address), items))
    run.forget_progress()


def _put_fence(run: SortieRun) -> Steps:
    """The sortie's fence, or none; one that somebody else put there stays on board until the pilot says otherwise."""
    autopilot, ours = vehicle_of(run)[0], _own_fence(run)
    run.on_board = replace(run.on_board, found_fence=(), fence_check=None)
    read: DownloadOutcome = yield Download(ours.route)
    if read.ending is not Ending.DONE and read.ending is not Ending.REFUSED:
        read = yield Download(ours.route)
    if read.ending is Ending.REFUSED:
        # It takes no fences at all: where the sortie has one, the upload says so.
        if ours.messages:
            yield from _put(run, ours)
    elif read.ending is not Ending.DONE and ours.messages:
        raise LinkTimeout(
            say("the geofence on board could not be read ({}): it may be somebody else's, and stays", read.ending.value)
        )
    elif read.ending is not Ending.DONE:
        text = say("the vehicle does not say whether it has a geofence; look before it takes off")
        run.note("warning-fence", text)
        run.on_board = replace(run.on_board, fence_check=PreflightCheck(FENCE_BEFORE, Verdict.WARN, text))
    elif not compare(ours.messages, read.items, autopilot, MissionType.FENCE):
        run.note("fence", say("geofence: {} items are on board already", len(read.items)))
        _know_fence(run, ours)
    elif not read.items:
        yield from _put(run, ours)
    elif any(not compare(own, read.items, autopilot, MissionType.FENCE) for own in run.options.own_fences):
        yield from _put(run, ours)
        text = say("that of an earlier flight of this ground station is cleared ({})", fence_words(read.items))
        run.note("fence", text)
        run.on_board = replace(run.on_board, fence_check=PreflightCheck(FENCE_BEFORE, Verdict.OK, text))
    else:
        run.on_board = replace(run.on_board, found_fence=read.items)
        _know_fence(run, replace(ours, messages=read.items))
        yield from _judge_found_fence(run)
        yield from _remove_found_fence(run)


def _own_fence(run: SortieRun) -> BoardList:
    autopilot, address = vehicle_of(run)
    route = Route(run.own, address, MissionType.FENCE)
    return BoardList("geofence", route, fence_messages(run.orders.fences.get(autopilot, ()), autopilot))


def _know_fence(run: SortieRun, fence: BoardList) -> None:
    """Take a fence for the one that stays on board: nobody changes it unnoticed."""
    run.lists = (*(each for each in run.lists if each.route.mission_type is not MissionType.FENCE), fence)
    run.on_board = run.on_board.known(MissionType.FENCE, True)


def _judge_found_fence(run: SortieRun) -> Steps:
    """Say what somebody else's fence means for the sortie, by the parameters as they are now."""
    autopilot, address = vehicle_of(run)
    items = run.on_board.found_fence
    if not items:
        return
    values: dict[str, float] = yield ParameterReads(FOUND_FENCE_NAMES[autopilot], autopilot, address)
    check = found_fence_check(autopilot, values, run.orders, items)
    if check != run.on_board.fence_check:
        run.note("warning-fence", check.text)
    run.on_board = replace(run.on_board, fence_check=check)


def _remove_found_fence(run: SortieRun) -> Steps:
    """Put the sortie's fence, or none, in the place of somebody else's, once the pilot has said so."""
    items, ours = run.on_board.found_fence, _own_fence(run)
    if not items or FOREIGN_FENCE not in run.options.overrules:
        return
    run.lists = tuple(each for each in run.lists if each.route.mission_type is not MissionType.FENCE)
    yield from _put(run, ours)
    text = say("one that this ground station had not put there was removed, as the pilot said ({})", fence_words(items))
    run.note("warning-fence", text)
    check = PreflightCheck(FENCE_BEFORE, Verdict.WARN, text)
    run.on_board = replace(run.on_board, found_fence=(), fence_check=check)


def _put_rally_points(run: SortieRun) -> Steps:
    """Rally points of the site; those of another place are never left on board."""
    autopilot, address = vehicle_of(run)
    route = Route(run.own, address, MissionType.RALLY)
    items = rally_messages(run.orders, autopilot) if run.orders.rally else ()
    ours = BoardList(say("list of rally points"), route, items)
    if items:
        yield from _put(run, ours)
        return
    read: DownloadOutcome = yield Download(route)
    text = ""
    if read.ending is Ending.SILENT:
        text = say("the vehicle does not say whether it has rally points; look before it returns by itself")
    elif read.items:
        yield from _put(run, ours)
        text = say("the vehicle had {} rally points of another flight; they are cleared", len(read.items))
    elif read.ending is Ending.DONE:
        run.lists = (*run.lists, ours)
        run.on_board = replace(run.on_board, rally=True)
    if text:
        run.note("warning-rally", text)
        check = PreflightCheck("rally", Verdict.WARN, text)
        run.on_board = replace(run.on_board, failsafes=(check, *run.on_board.failsafes))


def _put(run: SortieRun, ours: BoardList) -> Steps:
    outcome: Verified | NotVerified = yield VerifiedUpload(ours.route, ours.messages, vehicle_of(run)[0])
    if isinstance(outcome, NotVerified):
        raise LinkRejected(say("the {} is not on the vehicle: {}", ours.what, outcome))
    run.note("uploaded", say("{}: {} items, read back and equal", ours.what, len(outcome.items)))
    run.lists = (*run.lists, ours)
    run.on_board = run.on_board.known(ours.route.mission_type, True)


def read_again(run: SortieRun) -> Steps:
    """Read every list of ours again; what could not be read stays not known."""
    autopilot, _ = vehicle_of(run)
    run.on_board = replace(run.on_board, reason_to_reread="")
    reads: tuple[ListRead, ...] = yield BoardReread(run.lists, autopilot)
    run.note_reads(reads)


class FlightRun(SortieRun):
    """A sortie from the first heartbeat to the landing."""

    def steps(self) -> Steps:
        """See the table of phases above."""
        return sortie_steps(self)
