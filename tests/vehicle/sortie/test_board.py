"""What is on board may change between upload and take-off: it is noticed, read again, and never flown unseen."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.vehicle.preflight import OnBoard, Verdict
from groundstation.vehicle.sortie.board import CHANGED, RESTARTED, WRITTEN, reason_to_reread, with_lists_unknown
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import LINK_LOST_S, VehicleState
from groundstation.vehicle.telemetry import LocalFrame, updated_state
from missions.mavlink.messages import (
    Address,
    Attitude,
    Heartbeat,
    MissionAck,
    MissionChanged,
    MissionClearAll,
    MissionCount,
    MissionCurrent,
    MissionRequestInt,
    Received,
)
from planning.base.errors import LinkRejected
from planning.geo.frames import Origin
from tests.vehicle.sortie.test_flight_run import BOTH, OPTIONS, fly, orders, toy_at_home
from tests.vehicle.toy import ToyLink

__all__ = ["orders"]

OTHER_STATION = Address(252, 190)
VEHICLE = Address(1, 1)
FRAME = LocalFrame(Origin(47.0, 8.0, 400.0), 400.0)


class EnoughError(Exception):
    """The test has seen what it wanted."""


def foreign(items):
    """Somebody else's mission: the same number of items, one of them 40 m further east."""
    return [replace(item, x=item.x + 4000) if n == 2 else item for n, item in enumerate(items)]


def emptied(items):
    return items[:1]


def raised(items):
    return [replace(item, z=item.z + 1.0) if item.command == 16 else item for item in items]


SWAPS = pytest.mark.parametrize("swap", [foreign, emptied, raised, lambda items: []])


def start_after(orders, toy, change, wait_s=3.0):
    """A pilot who starts once the list is well and some time has passed, and what changed as it became well."""
    run = FlightRun(orders, replace(OPTIONS, starts_itself=False), "toy")
    ready_s = []

    def show(view):
        if view.phase is Phase.READY:
            if not ready_s:
                change()
            ready_s.append(view.time_s)
            if view.time_s > ready_s[0] + wait_s:
                run.begin()
        if toy.now_s > 300.0:
            pytest.fail(f"nothing came of it in phase {view.phase}: {view.checks}")

    return run, conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)


@pytest.mark.long
@pytest.mark.few(3)
@BOTH
@SWAPS
def test_a_mission_that_is_another_at_start_is_not_flown(orders, autopilot, swap):
    """Nobody says that it was changed: not the vehicle, not its count."""
    toy = toy_at_home(orders, autopilot=autopilot, tells_total=False)

    def change():
        toy.items[:] = swap(toy.items)

    run, outcome = start_after(orders, toy, change)
    assert isinstance(outcome.error, LinkRejected)
    assert "not the one that was uploaded; it was not started: upload it again" in str(outcome.error)
    assert not toy.has_flown
    assert not toy.is_armed
    assert run.on_board.mission is False


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["fences", "rally"])
def test_a_fence_or_rally_points_that_are_others_at_start_ground_it_too(orders, name):
    toy = toy_at_home(orders)

    def change():
        kept = getattr(toy, name)
        kept[:] = kept[:-1] if kept else [replace(toy.items[1], mission_type=2)]

    _, outcome = start_after(orders, toy, change)
    assert isinstance(outcome.error, LinkRejected)
    assert not toy.has_flown


@BOTH
def test_a_flight_that_starts_itself_flies_nothing_else_either(orders, autopilot):
    """Another ground station writes the moment the upload was read back."""
    toy = toy_at_home(orders, autopilot=autopilot, tells_total=False)
    hear = toy.hear

    def hear_and_swap(message):
        hear(message)
        if isinstance(message, MissionAck) and message.mission_type == 0 and not toy.is_swapped:
            toy.is_swapped, toy.items[:] = True, foreign(toy.items)

    toy.is_swapped, toy.hear = False, hear_and_swap
    _, outcome = fly(orders, toy)
    assert "not the one that was uploaded" in str(outcome.error)
    assert toy.is_swapped
    assert not toy.has_flown


def test_what_changes_while_the_motors_are_started_stops_them(orders):
    toy = toy_at_home(orders, refuses={400: 4}, refusals={400: 2})
    obey = toy.obey

    def obey_and_swap(command):
        if command.command == 400 and command.param1 == 1.0:
            toy.items[:] = emptied(toy.items)
            toy.say(MissionChanged(0, 5, 252, 190))
        return obey(command)

    toy.obey = obey_and_swap
    _, outcome = fly(orders, toy)
    assert "not the one that was uploaded" in str(outcome.error)
    assert (400, 0.0, 0.0) in toy.commands, "disarmed at once"
    assert not toy.has_flown
    assert not toy.is_armed


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize(
    ("event", "reason"),
    [("restart", RESTARTED), ("silence", "not heard"), ("changed", CHANGED), ("count", CHANGED), ("id", CHANGED)],
)
def test_what_may_have_changed_it_makes_it_unknown_until_it_is_read_again(orders, autopilot, event, reason):
    """Nothing has changed, so it is found equal, and may be flown."""
    toy = toy_at_home(orders, autopilot=autopilot)

    def change():
        match event:
            case "restart":
                toy.boot_s, toy.silent = toy.now_s, (toy.now_s, toy.now_s + 1.0)
                toy.tells_all = False
            case "silence":
                toy.silent = (toy.now_s, toy.now_s + LINK_LOST_S + 2.0)
            case "changed":
                toy.say(MissionChanged(0, 5, 252, 190))
            case "count":
                toy.say(MissionCurrent(0, len(toy.items) + 3))
            case "id":
                toy.say(MissionCurrent(0, len(toy.items), mission_id=7))

    run = FlightRun(orders, replace(OPTIONS, starts_itself=False), "toy")
    ready_s = []

    def show(view):
        if view.phase is Phase.READY:
            if not ready_s:
                change()
            ready_s.append(view.time_s)
        mission = next(check for check in view.checks if check.code == "mission")
        if view.on_board.mission is None and view.on_board.reason_to_reread:
            assert mission.verdict is Verdict.WAIT
            assert "is read again" in mission.text
        if ready_s and toy.now_s > ready_s[0] + 20.0 and view.phase is Phase.READY:
            run.begin()
        assert toy.now_s < 300.0

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert outcome.succeeded, outcome.error
    assert any(reason in note.text for note in outcome.notes if note.code == "board-doubted")
    # Reading at Start follows in any case.
    assert sum(note.code == "mission-reread" for note in outcome.notes) >= 2


@pytest.mark.long
def test_a_vehicle_that_forgot_its_mission_in_a_restart_is_told_before_start(orders):
    toy = toy_at_home(orders)
    texts = []

    def change():
        toy.boot_s, toy.silent = toy.now_s, (toy.now_s, toy.now_s + 1.0)
        toy.items.clear()

    run = FlightRun(orders, replace(OPTIONS, starts_itself=False), "toy")
    ready_s = []

    def show(view):
        if view.phase is Phase.READY and not ready_s:
            ready_s.append(toy.now_s)
            change()
        texts.extend(check.text for check in view.checks if check.verdict is Verdict.BAD)
        if ready_s and toy.now_s > ready_s[0] + 30.0:
            raise EnoughError
        assert view.phase is not Phase.STARTING

    with pytest.raises(EnoughError):
        conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert "what the vehicle holds is not this mission: upload it again" in texts


def test_another_mission_in_flight_is_warned_of(orders):
    toy = toy_at_home(orders)
    warned = []

    def show(view):
        if view.phase is Phase.FLYING and len(view.state.photos) == 1 and not warned:
            toy.items[-2] = replace(toy.items[-2], z=99.0)
            toy.say(MissionChanged(0, 5, 252, 190))
        warned.extend(warning.text for warning in view.watch.warnings if warning.code == "other-mission")

    fly(orders, toy, show=show)
    assert "another mission now" in warned[0]


# The rules, one by one


def heard(state, message, source=VEHICLE, time_s=1.0):
    return updated_state(state, Received(message, source, time_s), FRAME)


ALIVE = heard(VehicleState(), Heartbeat(2, 3, 0, 0, 3))
TOLD = heard(heard(ALIVE, MissionCurrent(0, 12, 0, 0, 5, 6, 7)), Attitude(60_000, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("message", "source", "is_transferring", "reason"),
    [
        (MissionCurrent(3, 12, 0, 0, 5, 6, 7), VEHICLE, False, ""),
        (MissionCurrent(0, 13, 0, 0, 5, 6, 7), VEHICLE, False, CHANGED),
        (MissionCurrent(0, 65535, 0, 0, 5, 6, 7), VEHICLE, False, CHANGED),
        (MissionCurrent(0, 12, 0, 0, 5, 9, 7), VEHICLE, False, CHANGED),
        (MissionCurrent(0, 13, 0, 0, 5, 6, 7), VEHICLE, True, ""),
        (MissionChanged(0, 5, 252, 190), VEHICLE, False, CHANGED),
        (MissionChanged(0, 5, 252, 190), Address(7, 1), False, ""),
        (MissionCount(1, 1, 5), OTHER_STATION, False, WRITTEN),
        (MissionCount(1, 1, 5), Address(255, 190), True, WRITTEN),
        (MissionCount(0, 0, 5), OTHER_STATION, True, WRITTEN),
        (MissionCount(7, 1, 5), OTHER_STATION, False, ""),
        (MissionClearAll(1, 1, 255), OTHER_STATION, False, WRITTEN),
        (MissionRequestInt(252, 190, 0), VEHICLE, False, WRITTEN),
        (MissionRequestInt(255, 190, 0), VEHICLE, True, ""),
        (MissionAck(252, 190, 0), VEHICLE, False, WRITTEN),
        (MissionAck(252, 190, 14), VEHICLE, False, ""),
        (MissionCount(252, 190, 5), VEHICLE, False, ""),
        (Attitude(61_000, 0.0, 0.0, 0.0), VEHICLE, False, ""),
        (Attitude(58_000, 0.0, 0.0, 0.0), VEHICLE, False, ""),
        (Attitude(300, 0.0, 0.0, 0.0), VEHICLE, True, RESTARTED),
    ],
)
def test_each_sign_is_taken_for_what_it_is(message, source, is_transferring, reason):
    after = heard(TOLD, message, source)
    assert reason_to_reread(TOLD, after, Received(message, source, 1.0), is_transferring=is_transferring) == reason


@given(st.lists(st.sampled_from([True, False, None]), min_size=3, max_size=3), st.booleans())
def test_doubt_takes_what_was_equal_and_leaves_what_is_known_to_be_another(flags, was_doubted):
    board = OnBoard(*flags, reason_to_reread=CHANGED if was_doubted else "")
    after = with_lists_unknown(board, RESTARTED)
    for name in ("mission", "fence", "rally"):
        former = getattr(board, name)
        assert getattr(after, name) is (None if former else former)
    assert after.reason_to_reread == (RESTARTED if True in flags or was_doubted else "")
