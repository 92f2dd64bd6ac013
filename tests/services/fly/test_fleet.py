"""What flights of one plan share: places, photos, starts, and the order in which all return."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from groundstation.services.fly.announce import Announcements, aged_warnings, fleet_warnings
from groundstation.services.fly.events import LinkState, LiveView, Readouts, Request
from groundstation.services.fly.fleet import Fleet, ReturnAll, Traffic, distances_m
from groundstation.services.fly.options import ConnectionChoice, LinkKind, beside
from groundstation.vehicle.preflight import OnBoard
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import Landed, Motion, Timed, VehicleState
from groundstation.vehicle.surroundings import Surroundings
from groundstation.vehicle.watch import STALE_S, FlightWarning
from missions.mavlink.autopilots import Autopilot
from planning.base.findings import Severity
from planning.base.messages import plain
from tests.services.live_cases import planned, sortie


def in_air(place, time_s=0.0, is_armed=True, landed=Landed.IN_AIR):
    return VehicleState(
        autopilot=Autopilot.ARDUPILOT,
        heartbeat=Timed(1, time_s),
        armed=Timed(is_armed, time_s),
        landed=Timed(landed, time_s),
        motion=Timed(Motion(tuple(map(float, place)), (0.0, 0.0, 0.0), 10.0), time_s),
    )


@cache
def around():
    model, plan = planned()
    return Surroundings.of_sortie(model, plan, 1)


class Hands:
    """A clock that is set."""

    now_s = 0.0

    def __call__(self):
        return self.now_s


@pytest.mark.long
def test_traffic_tells_the_others_and_how_long_ago_they_were_heard():
    clock = Hands()
    traffic = Traffic(clock)
    traffic.tell(1, 1, in_air((0, 0, 20)), around(), 0.0)
    assert traffic.others(1) == ()
    traffic.tell(2, 2, in_air((3, 4, 20)), around(), 0.0)
    assert [(other.number, other.age_s) for other in traffic.others(1)] == [(2, 0.0)]
    assert traffic.least_m() == (5.0, (1, 2))
    clock.now_s = 4.0
    traffic.tell(2, 2, in_air((3, 4, 20)), around(), 4.0)
    assert traffic.others(1)[0].age_s == 4.0, "the same message again is no news"
    traffic.tell(1, 1, in_air((0, 0, 29), time_s=4.0), around(), 4.0)
    assert traffic.least_m()[0] == 5.0, "it was further then"
    traffic.tell(2, 2, in_air((3, 4, 0), time_s=5.0, landed=Landed.ON_GROUND), around(), 5.0)
    assert traffic.others(1) == ()


@pytest.mark.long
def test_what_was_heard_long_ago_counts_for_no_distance():
    clock = Hands()
    traffic = Traffic(clock)
    traffic.tell(1, 1, in_air((0, 0, 20)), around(), 0.0)
    clock.now_s = STALE_S + 1.0
    traffic.tell(2, 2, in_air((1, 0, 20), time_s=clock.now_s), around(), clock.now_s)
    assert traffic.least_m() is None


@cache
def fleet():
    """The plan of one sortie twice, so that its legs are as near to each other as they can be."""
    _, plan = planned()
    one = plan.sorties[0]
    twice = replace(plan, sorties=(one, one), rules=replace(plan.rules, at_once=2, apart_m=12.0))
    return Fleet(replace(sortie().case, plan=twice), Path())


@pytest.mark.long
def test_a_start_waits_until_the_other_is_out_of_the_way_and_longer_for_a_slow_autopilot():
    found, usual = fleet(), {1: 1.0, 2: 1.0}
    assert found.wait_s(2, {}, usual) == 0.0
    now_s = found.wait_s(2, {1: 0.0}, usual)
    assert now_s > 0.0
    assert found.wait_s(2, {1: 10.0}, usual) == pytest.approx(now_s - 10.0)
    assert found.wait_s(2, {1: now_s}, usual) == 0.0
    assert found.wait_s(2, {1: math.inf}, usual) == math.inf, "nobody saw it start"
    slow_s = found.wait_s(2, {1: 0.0}, {1: 1.3, 2: 1.3})
    assert 1.2 * now_s < slow_s < 1.3 * now_s + 1.0


def view(state, left_s=100.0, may=(Request.PAUSE, Request.RETURN), warnings=(), **changes):
    return LiveView(
        **{
            "link": LinkState.ALIVE,
            "silent_s": 0.0,
            "phase": Phase.FLYING,
            "state": state,
            "checks": (),
            "warnings": warnings,
            "on_board": OnBoard(),
            "doing": ("", 0.0, 0.0),
            "may": frozenset(may),
            "readouts": Readouts(battery_left_s=left_s),
            "view_states": (),
            **changes,
        }
    )


def test_all_return_one_after_the_other_the_least_battery_first():
    up, down = in_air((0, 0, 20)), in_air((0, 0, 0), is_armed=False, landed=Landed.ON_GROUND)
    views = {1: view(up, 300.0), 2: view(up, 100.0), 3: view(up, 200.0), 4: view(down)}
    order, asked = ReturnAll.of(views)
    assert asked == ((2, Request.RETURN), (3, Request.PAUSE), (1, Request.PAUSE))
    assert order.waiting == (3, 1)
    assert order.after(views) == (order, ())
    landed = {**views, 2: view(down)}
    order, asked = order.after(landed)
    assert (order.waiting, asked) == ((1,), ((3, Request.RETURN),))
    assert order.without(1).after(landed) == (ReturnAll(), ())
    empty = FlightWarning("battery", Severity.ERROR, "", 0.0, 0.1, 0.2, "")
    order, asked = order.after({**landed, 1: view(up, 0.0, warnings=(empty,))})
    assert (order, asked) == (ReturnAll(), ((1, Request.RETURN),)), "a battery waits for nobody"


def test_warnings_of_several_aircraft_are_told_apart_and_spoken_each():
    state = in_air((0, 0, 20), time_s=50.0)
    low = FlightWarning("battery", Severity.ERROR, "low", 40.0, 0.1, 0.2, "")
    one, two = (aged_warnings(view(state, warnings=(low,), silent_s=2.0), number) for number in (1, 2))
    assert [each.age_s for each in (*one, *two)] == [12.0, 12.0]
    warnings = tuple(each.warning for each in (*one, *two))
    assert [each.code for each in warnings] == ["1:battery", "2:battery"]
    assert plain(warnings[1].text) == "aircraft 2: low"
    first = Announcements().next(warnings, 0.0)
    said = Announcements().with_spoken(first, 0.0)
    assert {first.code, said.next(warnings, 0.0).code} == {"1:battery", "2:battery"}
    assert aged_warnings(view(state, warnings=(low,)))[0].warning is low


def test_that_two_are_near_each_other_is_said_once():
    near = FlightWarning("aircraft-apart", Severity.ERROR, "near", 0.0, 9.0, 11.0, "m")
    views = {number: view(in_air((0, 0, 20)), warnings=(near,)) for number in (1, 2, 3)}
    assert [each.warning.code for each in fleet_warnings({2: views[2], 1: views[1]})] == ["1:aircraft-apart"]
    assert len(fleet_warnings(views)) == 3, "of three, each may be near to another one"


def test_distances_are_to_the_nearest_that_flies():
    states = {1: in_air((0, 0, 20)), 2: in_air((0, 30, 20)), 3: in_air((0, 10, 20))}
    grounded = in_air((0, 1, 0), is_armed=False)
    assert distances_m({**states, 4: grounded}) == {1: (10.0, 3), 2: (20.0, 3), 3: (10.0, 1)}
    assert distances_m({1: states[1]}) == {}


@pytest.mark.parametrize(
    ("kind", "address", "found"),
    [
        (LinkKind.UDP, "0.0.0.0:14550", "0.0.0.0:14560"),
        (LinkKind.TCP, "127.0.0.1:5760", "127.0.0.1:5770"),
        (LinkKind.SERIAL, "/dev/ttyUSB0:57600", "/dev/ttyUSB1:57600"),
        (LinkKind.SERIAL, "COM3:57600", "COM4:57600"),
        (LinkKind.UDP, "nonsense", "nonsense"),
    ],
)
def test_another_aircraft_has_an_address_of_its_own(kind, address, found):
    choice = ConnectionChoice(kind, address, signed=("udp:a",))
    assert beside(choice, 2).address == found
    assert beside(choice, 1).address == address
