"""Modes, arming and commands, by their acknowledgements."""

from __future__ import annotations

import itertools
import math

import pytest

from missions.mavlink.messages import (
    Attitude,
    AutopilotVersion,
    CommandAck,
    CommandInt,
    CommandLong,
    ExtendedSysState,
    GlobalPositionInt,
    Heartbeat,
    SetMode,
)
from tests.missions.simulator.ground import ARDUPILOT, AUTO, GUIDED, ORIGIN, PX4, Ground, at, item

ACCEPTED, REJECTED, DENIED, UNSUPPORTED, FAILED = 0, 1, 2, 3, 4
ARM, MODE, START, PAUSE, TAKEOFF, LAND, RTL = 400, 176, 300, 193, 22, 21, 20
MISSION = [at(22, 0, 0, 20), at(16, 30, 0, 20, 2), item(93, 1), at(21, 0, 0, 0)]
PX4_MISSION = [at(22, 0, 0, 20), at(16, 30, 0, 20, 2), item(93, 1, frame=2), at(21, 0, 0, 0)]


def flying(ground: Ground, up: float = 20.0) -> Ground:
    assert [ground.command(MODE, 1, GUIDED), ground.command(ARM, 1)] == [0, 0]
    assert ground.command(TAKEOFF, 0, 0, 0, 0, 0, 0, up) == ACCEPTED
    ground.until(lambda: ground.frame.position[2] > up - 0.1)
    return ground


def test_sequence_that_flies_on_ardupilot() -> None:
    ground = Ground()
    ground.fly(MISSION)
    assert ground.reached[-1] == 4
    assert ground.frame.position[2] == 0.0


def test_auto_waits_on_the_ground_for_mission_start_and_disarms_in_the_end() -> None:
    ground = Ground()
    ground.upload(MISSION)
    assert [ground.command(MODE, 1, GUIDED), ground.command(ARM, 1), ground.command(MODE, 1, AUTO)] == [0, 0, 0]
    start_s = ground.vehicle.now_s
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    assert ground.vehicle.now_s - start_s == pytest.approx(10.0, abs=0.2)
    assert ground.frame.position[2] == 0.0


def test_auto_is_not_armable_but_with_its_options() -> None:
    ground = Ground()
    ground.upload(MISSION)
    assert [ground.command(MODE, 1, AUTO), ground.command(ARM, 1)] == [ACCEPTED, FAILED]
    assert "Arm: AUTO mode not armable" in ground.said
    ground = Ground(parameters={"AUTO_OPTIONS": 3})
    ground.upload(MISSION)
    assert [ground.command(MODE, 1, AUTO), ground.command(ARM, 1)] == [ACCEPTED, ACCEPTED]
    ground.until(lambda: ground.frame.position[2] > 10)


def test_mission_without_take_off_is_armed_refused_and_disarmed() -> None:
    ground = Ground()
    ground.upload(MISSION[1:])
    assert [ground.command(MODE, 1, GUIDED), ground.command(ARM, 1)] == [ACCEPTED, ACCEPTED]
    assert ground.command(MODE, 1, AUTO) == DENIED
    assert "Auto: Missing Takeoff Cmd" in ground.said
    ground.until(lambda: not ground.vehicle.modes.is_armed, 15.0)


@pytest.mark.parametrize(("autopilot", "ready_s"), [(ARDUPILOT, 42.0), (PX4, 10.0)])
def test_arming_waits_for_a_position_estimate(autopilot, ready_s) -> None:
    ground = Ground(autopilot, is_ready=False)
    mode = (1, GUIDED) if autopilot is ARDUPILOT else (1, 4, 3)
    ground.command(MODE, *mode)
    assert ground.command(ARM, 1) in (FAILED, REJECTED)
    assert "Arm: Need Position Estimate" in ground.said
    ground.until(lambda: ground.vehicle.now_s > ready_s)
    ground.frame.fix = type(ground.frame.fix)(1, 3, 9.0, 9.0)
    assert ground.command(ARM, 1) in (FAILED, REJECTED)
    ground.frame.fix = type(ground.frame.fix)(3, 12, 1.0, 2.0)
    assert ground.command(ARM, 1) == ACCEPTED


def test_px4_mission_start_changes_mode_and_arms_by_itself() -> None:
    ground = Ground(PX4)
    assert ground.upload(PX4_MISSION) == 0
    assert ground.command(START) == ACCEPTED
    assert (ground.vehicle.modes.mode, ground.vehicle.modes.is_armed) == ("AUTO.MISSION", True)
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    assert ground.reached == [0, 1, 2, 3]


def test_px4_armed_in_mission_mode_takes_off() -> None:
    ground = Ground(PX4)
    ground.upload(PX4_MISSION)
    assert [ground.command(MODE, 1, 4, 4), ground.command(ARM, 1)] == [ACCEPTED, ACCEPTED]
    ground.until(lambda: ground.frame.position[2] > 5)


def test_flying_vehicle_is_disarmed_only_by_force() -> None:
    ground = flying(Ground())
    assert ground.command(ARM, 0) == FAILED
    assert ground.command(ARM, 0, 21196) == ACCEPTED
    assert not ground.vehicle.modes.is_armed


def test_set_mode_is_acknowledged_by_ardupilot_only() -> None:
    ground = Ground()
    ground.link.send(SetMode(1, 1, GUIDED))
    assert ground.wait(CommandAck) == CommandAck(11, 0, target_system=255, target_component=190)
    px4 = Ground(PX4)
    px4.link.send(SetMode(1, 1, 4 << 16 | 5 << 24))
    px4.until(lambda: px4.vehicle.now_s > 12)
    assert px4.of(CommandAck) == []
    assert px4.vehicle.modes.mode == "AUTO.RTL"


def test_unknown_mode_is_denied() -> None:
    assert Ground().command(MODE, 1, 99) == DENIED
    assert Ground(PX4).command(MODE, 1, 4, 99) == DENIED


def test_pause_stops_the_mission_and_continue_flies_on() -> None:
    ground = Ground()
    assert ground.command(PAUSE, 0) == DENIED
    ground.upload([MISSION[0], at(16, 100, 0, 20, 2), MISSION[-1]])
    ground.take_off_with_mission()
    ground.until(lambda: ground.frame.position[0] > 30)
    assert ground.command(PAUSE, 0) == ACCEPTED
    ground.until(lambda: math.hypot(*ground.frame.velocity) < 0.01, 20.0)
    stopped = ground.frame.position
    ground.until(lambda: ground.vehicle.now_s > 100, 100.0)
    assert math.dist(ground.frame.position, stopped) < 0.1
    assert stopped[0] < 60
    assert ground.command(PAUSE, 1) == ACCEPTED
    ground.until(lambda: ground.frame.position[0] > 99.9)
    assert Ground(PX4).command(PAUSE, 0) == UNSUPPORTED


def test_px4_is_paused_with_a_reposition_to_nowhere_and_goes_on_in_mission_mode() -> None:
    ground = Ground(PX4)
    ground.upload([PX4_MISSION[0], at(16, 100, 0, 20, 2), PX4_MISSION[-1]])
    ground.take_off_with_mission()
    ground.until(lambda: ground.frame.position[0] > 30)
    assert ground.command(192, -1, 1, 0, math.nan, math.nan, math.nan, math.nan) == ACCEPTED
    ground.until(lambda: math.hypot(*ground.frame.velocity) < 0.01, 20.0)
    assert ground.frame.position[0] < 60
    assert ground.command(MODE, 1, 4, 4) == ACCEPTED
    ground.until(lambda: ground.frame.position[0] > 99.0)


@pytest.mark.parametrize(("command", "mode"), [(RTL, "RTL"), (LAND, "LAND"), (17, "LOITER")])
def test_commands_change_the_mode(command: int, mode: str) -> None:
    ground = flying(Ground())
    assert ground.command(command) == ACCEPTED
    assert ground.vehicle.modes.mode == mode


def test_return_climbs_flies_home_waits_and_lands() -> None:
    ground = flying(Ground(), up=8.0)
    lat, lon = at(16, 40, 0, 8).x, at(16, 40, 0, 8).y
    ground.link.send(CommandInt(1, 1, 192, 6, -1, 1, 0, 0, lat, lon, 8.0))
    assert ground.wait(CommandAck).result == ACCEPTED
    ground.until(lambda: ground.frame.position[0] > 39.9)
    assert ground.command(RTL) == ACCEPTED
    track = []
    vehicle = ground.vehicle
    ground.until(lambda: track.append((vehicle.now_s, *ground.frame.position)) or not vehicle.modes.is_armed)
    assert max(z for *_, z in track) == pytest.approx(15.0, abs=0.1)
    assert all(z > 14.5 for _, x, _, z in track if 1.0 < x < 39.0)
    assert math.dist(ground.frame.position, (0, 0, 0)) < 0.3
    below_9_s = [t for t, x, _, z in track if x < 0.5 and 0.0 < z < 9.0]
    assert below_9_s[-1] - below_9_s[0] == pytest.approx(9.0 / 0.5, abs=0.5)


def test_landed_state_goes_from_ground_to_air_to_landing_to_ground() -> None:
    ground = Ground()
    ground.fly(MISSION)
    ground.until(lambda: ground.vehicle.now_s % 1.0 > 0.5)
    ground.wait(ExtendedSysState)
    states = [each.landed_state for each in ground.of(ExtendedSysState)]
    changes = [state for i, state in enumerate(states) if i == 0 or state != states[i - 1]]
    assert changes == [1, 2, 4, 1]


def test_heartbeat_comes_every_second_and_says_mode_and_arming() -> None:
    ground = Ground()
    ground.command(MODE, 1, GUIDED)
    ground.command(ARM, 1)
    ground.until(lambda: ground.vehicle.now_s > 50)
    beats = [each for each in ground.heard if isinstance(each.message, Heartbeat)]
    gaps = [b.time_s - a.time_s for a, b in itertools.pairwise(beats)]
    assert all(gap == pytest.approx(1.0, abs=0.021) for gap in gaps)
    last = beats[-1].message
    assert (last.autopilot, last.type, last.custom_mode, bool(last.base_mode & 128)) == (3, 2, GUIDED, True)
    assert Ground(PX4).wait(Heartbeat).autopilot == 12


def test_commands_that_are_not_known_are_unsupported_and_those_to_others_left_alone() -> None:
    ground = Ground()
    assert ground.command(31999) == UNSUPPORTED
    ground.link.send(CommandLong(7, 1, ARM, 1))
    ground.link.send(CommandLong(1, 154, ARM, 1))
    ground.until(lambda: ground.vehicle.now_s > 44)
    assert len(ground.of(CommandAck)) == 1


def test_message_intervals_are_set_and_messages_asked_for() -> None:
    ground = Ground()
    assert ground.command(511, 30, 100_000) == ACCEPTED
    assert ground.command(511, 12345, 100_000) == FAILED
    assert ground.command(512, 148) == ACCEPTED
    ground.wait(AutopilotVersion)
    assert ground.command(512, 12345) == FAILED
    ground.heard.clear()
    start_s = ground.vehicle.now_s
    ground.until(lambda: ground.vehicle.now_s >= start_s + 10.0)
    assert len(ground.of(Attitude)) == pytest.approx(100, abs=2)
    assert len(ground.of(GlobalPositionInt)) == pytest.approx(40, abs=2)
    assert ground.command(511, 30, -1) == ACCEPTED
    ground.heard.clear()
    ground.until(lambda: ground.vehicle.now_s >= start_s + 15.0)
    assert ground.of(Attitude) == []


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_commands_of_numbers_that_are_none_do_no_harm(autopilot) -> None:
    ground = Ground(autopilot)
    for command in (16, 20, 21, 22, 176, 178, 179, 192, 193, 201, 203, 205, 206, 224, 300, 400, 511, 512, 1000, 2000):
        for value in (math.nan, math.inf, -math.inf, 3e38):
            ground.link.send(CommandLong(1, 1, command, *[value] * 7))
    ground.until(lambda: ground.vehicle.now_s > 45)
    assert len(ground.of(CommandAck)) == 80
    assert all(math.isfinite(value) for value in ground.frame.position)


def test_home_is_set_where_it_is_told() -> None:
    ground = Ground()
    there = at(16, 3, 4, 1)
    ground.link.send(CommandInt(1, 1, 179, 3, 0, 0, 0, 0, there.x, there.y, 1.0))
    assert ground.wait(CommandAck).result == ACCEPTED
    assert math.dist(ground.vehicle.place.home_enu_m, (3, 4, 1)) < 0.02
    assert ground.vehicle.place.origin == ORIGIN


def test_mission_above_terrain_without_terrain_data_is_never_armed() -> None:
    ground = Ground()
    ground.upload([MISSION[0], at(16, 30, 0, 20, 2, frame=10), MISSION[-1]])
    assert [ground.command(MODE, 1, GUIDED), ground.command(ARM, 1)] == [ACCEPTED, FAILED]
    assert "Arm: waiting for terrain data" in ground.said


def test_mission_start_of_a_disarmed_ardupilot_is_accepted_and_nothing_flies() -> None:
    ground = Ground()
    ground.upload(MISSION)
    assert ground.command(START) == ACCEPTED
    ground.until(lambda: ground.vehicle.now_s > 60)
    assert ground.vehicle.modes.mode == "AUTO"
    assert (ground.vehicle.modes.is_armed, ground.frame.position) == (False, (0.0, 0.0, 0.0))
