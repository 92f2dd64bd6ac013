"""Our client against the simulated vehicle's side of the protocol, through air that loses messages."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.fence import FenceCircle, FencePolygon, fence_items, rally_items
from missions.mavlink.items import MissionItem, mission_items
from missions.mavlink.link import drive
from missions.mavlink.messages import Message, MissionItemInt, Received
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.verified import NotVerified, Verified, VerifiedUpload
from missions.mavlink.transfer.wire_items import compare, has_place, to_wire
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.mission.model import GeoPoint
from missions.simulator.autopilot.mission_store import MissionStores, StoredItem, stored
from missions.simulator.autopilot.mission_store import to_wire as stored_to_wire
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from tests.missions.mavlink.driving import fences_of, from_wire
from tests.missions.mavlink.transfer.fake_vehicle import ARDUPILOT, PX4, Air, route
from tests.missions.plans import example_plan
from tests.missions.simulator.ground import ORIGIN, PointMass

both = pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
HOME = StoredItem(16, 0, 0.0, 0.0, 0.0, 0.0, 223372000, 1142636000, 12.34)


@dataclass
class Stores:
    """The stores of a simulated vehicle that does nothing but keep items."""

    autopilot: Autopilot
    now_s: float = 0.0
    may_clear: bool = True
    stores: MissionStores = field(init=False)

    def __post_init__(self) -> None:
        self.stores = MissionStores(self.autopilot, lambda: HOME, lambda: self.may_clear, lambda severity, text: None)

    @property
    def next_deadline_s(self) -> float:
        return self.now_s + 0.1 if self.stores.is_receiving else math.inf

    def receive(self, received: Received) -> list[Message]:
        self.now_s = received.time_s
        return self.stores.receive(received, self.now_s)

    def tick(self, now_s: float) -> list[Message]:
        self.now_s = now_s
        return self.stores.tick(now_s)


def planned(autopilot: Autopilot, n: int | None = None) -> tuple[MissionItem, ...]:
    """Items of a real plan, repeated up to a number."""
    items = mission_items(missions_from_plan(example_plan())[0], autopilot, HeightReference.ABOVE_TAKEOFF)
    return items if n is None else (items * math.ceil(n / len(items)))[:n]


def put(
    air: Air, items: tuple[MissionItem, ...], autopilot: Autopilot, kind: MissionType = MissionType.MISSION
) -> Verified | NotVerified:
    machine = VerifiedUpload(route(kind), to_wire(items, autopilot, kind), autopilot)
    air.run(machine)
    assert machine.outcome is not None
    return machine.outcome


@both
def test_planned_mission_is_on_the_simulated_vehicle_and_comes_back_as_it_was(autopilot: Autopilot) -> None:
    items = planned(autopilot)
    outcome = put(Air(Stores(autopilot)), items, autopilot)
    assert isinstance(outcome, Verified)
    back = from_wire(outcome.items, autopilot)
    assert [item.command for item in back] == [item.command for item in items]


@both
def test_fences_and_rally_points_are_kept_beside_the_mission(autopilot: Autopilot) -> None:
    air = Air(Stores(autopilot))
    fences = (
        FencePolygon(((22.1, 114.1), (22.2, 114.1), (22.2, 114.2)), False),
        FenceCircle(22.3, 114.3, 42.5, True),
    )
    home = GeoPoint(22.3, 114.2, 60.0)
    rally = rally_items((GeoPoint(22.31, 114.21, 85.0),), home)
    for kind, items in (
        (MissionType.MISSION, planned(autopilot)),
        (MissionType.FENCE, fence_items(fences)),
        (MissionType.RALLY, rally),
    ):
        outcome = put(air, items, autopilot, kind)
        assert isinstance(outcome, Verified)
        if kind is MissionType.FENCE:
            assert fences_of(from_wire(outcome.items, autopilot, kind)) == fences


@both
def test_command_that_the_autopilot_refuses_ends_clearly_and_without_a_mix(autopilot: Autopilot) -> None:
    vehicle = Stores(autopilot)
    air = Air(vehicle)
    old = planned(autopilot)
    assert isinstance(put(air, old, autopilot), Verified)
    bad = MissionItem(220, 2, (0.0,) * 7)
    outcome = put(air, (*old[:5], bad, *old[5:]), autopilot)
    assert isinstance(outcome, NotVerified)
    assert "UNSUPPORTED" in str(outcome)
    assert len(vehicle.stores.mission) == (0 if autopilot is ARDUPILOT else len(old))


@both
def test_clearing_leaves_nothing(autopilot: Autopilot) -> None:
    vehicle = Stores(autopilot)
    air = Air(vehicle)
    put(air, planned(autopilot), autopilot)
    assert isinstance(put(air, (), autopilot), Verified)
    assert len(vehicle.stores.mission) == 0
    vehicle.may_clear = False
    assert isinstance(put(air, planned(autopilot), autopilot), Verified)
    assert isinstance(put(air, (), autopilot), NotVerified)


@pytest.mark.few(2)
@both
@pytest.mark.parametrize("seed", range(10))
def test_two_hundred_items_at_30_percent_loss_each_way_end_equal(autopilot: Autopilot, seed: int) -> None:
    items = planned(autopilot, 200)
    vehicle = Stores(autopilot)
    outcome = put(Air(vehicle, loss=0.3, seed=seed), items, autopilot)
    assert isinstance(outcome, Verified)
    assert compare(to_wire(items, autopilot), outcome.items, autopilot) == ()
    assert len(vehicle.stores.mission) == 200 + (autopilot is ARDUPILOT)


@pytest.mark.few(1)
@both
@pytest.mark.parametrize("delay_s", [0.001, 0.3])
def test_loss_on_a_fast_and_on_a_slow_link_ends_equal(autopilot: Autopilot, delay_s: float) -> None:
    for seed in range(3):
        outcome = put(Air(Stores(autopilot), 0.3, delay_s, seed=seed), planned(autopilot, 200), autopilot)
        assert isinstance(outcome, Verified)


@pytest.mark.few(1)
@both
@pytest.mark.parametrize("loss", [0.5, 0.7])
def test_worse_loss_ends_equal_or_clearly_not(autopilot: Autopilot, loss: float) -> None:
    items = planned(autopilot, 100)
    for seed in range(3):
        vehicle = Stores(autopilot)
        outcome = put(Air(vehicle, loss=loss, seed=seed), items, autopilot)
        is_there = len(vehicle.stores.mission) == 100 + (autopilot is ARDUPILOT)
        assert is_there or isinstance(outcome, NotVerified)


@both
def test_six_hundred_items_over_the_direct_link_of_the_whole_vehicle(autopilot: Autopilot) -> None:
    n = 600 if autopilot is ARDUPILOT else 499
    items = planned(autopilot, n)
    vehicle = SimulatedVehicle(autopilot, PointMass(), ORIGIN, is_ready=True)
    link = DirectLink(vehicle)
    outcome = drive(VerifiedUpload(route(MissionType.MISSION), to_wire(items, autopilot), autopilot), link, link.clock)
    assert isinstance(outcome, Verified)
    assert len(outcome.items) == n + (autopilot is ARDUPILOT)


def test_more_items_than_the_vehicle_has_room_for_change_nothing() -> None:
    vehicle = Stores(ARDUPILOT)
    air = Air(vehicle)
    put(air, planned(ARDUPILOT), ARDUPILOT)
    outcome = put(air, planned(ARDUPILOT, 700), ARDUPILOT)
    assert isinstance(outcome, NotVerified)
    assert "NO_SPACE" in str(outcome)
    assert len(vehicle.stores.mission) == len(planned(ARDUPILOT)) + 1


@st.composite
def acceptable(draw: st.DrawFn) -> tuple[Autopilot, MissionItemInt]:
    """An item that the autopilot takes, with numbers in every field, also those that the command does not use."""
    autopilot = draw(st.sampled_from(Autopilot))
    command = draw(st.sampled_from(sorted(facts(autopilot).commands)))
    frame = draw(st.sampled_from((0, 3, 6))) if has_place(command, 3) else 2
    params = [draw(st.floats(0.0, 60.0, width=32)) for _ in range(4)]
    x, y = (223372000, 1142636000) if has_place(command, frame) else (0, draw(st.integers(0, 1)))
    # The position of DO_MOUNT_CONTROL is a place to look at: lost on board, it must not be forgiven.
    if command == 203:
        x = 1
    elif command == 205:
        y = 0
    return autopilot, MissionItemInt(1, 1, 1, frame, command, 0, 1, *params, x, y, draw(st.floats(0.0, 120.0)))


@given(acceptable())
def test_rounding_table_forgives_what_the_simulated_vehicle_does_not_keep(
    given_item: tuple[Autopilot, MissionItemInt],
) -> None:
    autopilot, item = given_item
    back = stored_to_wire(stored(item, autopilot), 1, False, 0)
    assert compare((item, item), (item, back), autopilot) == ()


def test_place_that_a_mount_should_look_at_and_the_vehicle_loses_is_found() -> None:
    item = MissionItemInt(1, 1, 1, 2, 205, 0, 1, 0.0, 0.0, 0.0, 0.0, 223372000, 1142636000, 4.0)
    back = stored_to_wire(stored(item, ARDUPILOT), 1, False, 0)
    assert {each.field for each in compare((item, item), (item, back), ARDUPILOT)} == {"x", "y"}
