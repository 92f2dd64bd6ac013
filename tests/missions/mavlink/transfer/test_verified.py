from __future__ import annotations

import math
from dataclasses import replace

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import (
    Address,
    Message,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionItemInt,
    MissionRequestList,
    Received,
)
from missions.mavlink.transfer.exchange import Ending, MissionType, Result
from missions.mavlink.transfer.verified import NotVerified, Verified, VerifiedState, VerifiedUpload
from missions.mavlink.transfer.wire_items import compare
from tests.missions.mavlink.transfer.fake_vehicle import ARDUPILOT, PX4, Air, FakeVehicle, lose, route, waypoints

both = pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
OLD, NEW = waypoints(8, z=50.0), waypoints(10)


def put(
    air: Air, items: tuple[MissionItemInt, ...] = NEW, mission_type: MissionType = MissionType.MISSION
) -> Verified | NotVerified:
    assert isinstance(air.vehicle, FakeVehicle)
    machine = VerifiedUpload(route(mission_type), items, air.vehicle.autopilot)
    air.run(machine)
    assert machine.state is VerifiedState.ENDED
    assert machine.outcome is not None
    return machine.outcome


def old(autopilot: Autopilot) -> FakeVehicle:
    return FakeVehicle(autopilot, {0: list(OLD), 1: [], 2: []})


def stored_by_ardupilot(item: MissionItemInt) -> MissionItemInt:
    """Heights in whole centimetres, whole seconds, no radius."""
    return replace(item, z=math.trunc(item.z * 100.0) / 100.0, param1=float(int(item.param1)), param2=0.0)


@both
@pytest.mark.parametrize("mission_type", list(MissionType))
def test_equal_read_back_is_the_only_success(autopilot: Autopilot, mission_type: MissionType) -> None:
    items = waypoints(10, mission_type=mission_type)
    air = Air(FakeVehicle(autopilot))
    outcome = put(air, items, mission_type)
    assert isinstance(outcome, Verified)
    assert outcome.n_uploads == 1
    assert compare(items, outcome.items, autopilot, mission_type) == ()
    assert len(air.sent(MissionRequestList)) == 1


def test_known_rounding_is_forgiven() -> None:
    items = tuple(replace(item, z=item.z + 0.3456, param1=2.9, param2=1.5) for item in NEW)
    assert isinstance(put(Air(FakeVehicle(ARDUPILOT, change=stored_by_ardupilot)), items), Verified)


@both
def test_lost_acknowledgement_is_settled_by_reading_back(autopilot: Autopilot) -> None:
    air = Air(old(autopilot), fault=lose(False, MissionAck, *range(50)))
    assert isinstance(put(air), Verified)


@both
def test_acknowledged_mission_that_is_not_there_is_never_a_success(autopilot: Autopilot) -> None:
    class Liar(FakeVehicle):
        def keep(self, item: MissionItemInt) -> None:
            self.arrived.append(OLD[self.expected % len(OLD)])
            if self.is_ardupilot:
                self.lists[0][self.expected : self.expected + 1] = [self.arrived[-1]]

    outcome = put(Air(Liar(autopilot)))
    assert isinstance(outcome, NotVerified)
    assert outcome.n_uploads == 3
    assert outcome.on_board is not None
    assert {difference.field for difference in outcome.differences} >= {"z"}
    assert "accepted every item; 10 items are on the vehicle, and not those that were sent (item" in str(outcome)


@both
@pytest.mark.parametrize("dead_s", [3.0, 10.0, 20.0])
@pytest.mark.parametrize("n_messages", range(1, 10, 2))
def test_link_that_dies_and_comes_back_ends_equal(autopilot: Autopilot, n_messages: int, dead_s: float) -> None:
    air = Air(old(autopilot))
    since: list[float] = []

    def fault(is_up: bool, message: Message, n: int) -> list[Message]:
        now_s = air.log[-1][0]
        if n == n_messages:
            since.append(now_s)
        return [] if since and now_s < since[0] + dead_s else [message]

    air.fault = fault
    outcome = put(air)
    assert isinstance(outcome, Verified)
    assert len(outcome.items) == 10


@both
def test_accepted_upload_that_cannot_be_read_back_is_not_known_to_be_there(autopilot: Autopilot) -> None:
    outcome = put(Air(old(autopilot), fault=lambda is_up, message, n: [message] if n < 12 else []))
    assert isinstance(outcome, NotVerified)
    assert outcome.upload is not None
    assert outcome.upload.ending is Ending.DONE
    assert outcome.on_board is None
    words = "the vehicle accepted every item; what is on the vehicle now could not be read: do not fly before it was"
    assert str(outcome) == words


@both
def test_dead_link_says_that_what_is_on_board_is_not_known(autopilot: Autopilot) -> None:
    for n_messages in (0, 1, 5):
        air = Air(old(autopilot), fault=lambda is_up, message, n, last=n_messages: [message] if n < last else [])
        outcome = put(air)
        assert isinstance(outcome, NotVerified)
        assert outcome.on_board is None
        assert "could not be read" in str(outcome)
        assert "stopped answering" in str(outcome)


def test_refused_upload_leaves_no_mix_on_ardupilot() -> None:
    vehicle = old(ARDUPILOT)
    vehicle.refuse = lambda item: Result.UNSUPPORTED if item.seq == 3 else Result.ACCEPTED
    outcome = put(Air(vehicle))
    assert isinstance(outcome, NotVerified)
    assert outcome.upload is not None
    assert (outcome.upload.ending, outcome.upload.result, outcome.upload.seq) == (Ending.REFUSED, Result.UNSUPPORTED, 3)
    assert outcome.on_board == ()
    assert vehicle.lists[0] == []
    assert str(outcome) == "the vehicle refused the upload at item 3 (UNSUPPORTED); nothing is on the vehicle now"


def test_refused_upload_that_cannot_be_cleared_tells_the_mix_that_is_on_board() -> None:
    vehicle = old(ARDUPILOT)
    vehicle.refuse = lambda item: Result.INVALID_PARAM1 if item.seq == 3 else Result.ACCEPTED
    vehicle.may_clear = False
    outcome = put(Air(vehicle))
    assert isinstance(outcome, NotVerified)
    assert outcome.on_board is not None
    assert [item.z for item in outcome.on_board] == [item.z for item in (*NEW[:3], *OLD[3:])]
    assert outcome.differences


def test_refused_upload_leaves_px4_with_its_old_mission_and_says_so() -> None:
    vehicle = old(PX4)
    vehicle.refuse = lambda item: Result.UNSUPPORTED if item.seq == 3 else Result.ACCEPTED
    air = Air(vehicle)
    outcome = put(air)
    assert isinstance(outcome, NotVerified)
    assert outcome.on_board is not None
    assert [item.z for item in outcome.on_board] == [item.z for item in OLD]
    assert air.sent(MissionClearAll) == []


def test_nan_that_ardupilot_refuses_is_told() -> None:
    items = (*NEW[:4], replace(NEW[4], param1=math.nan), *NEW[5:])
    vehicle = old(ARDUPILOT)
    vehicle.refuse = lambda item: Result.INVALID_PARAM1 if math.isnan(item.param1) else Result.ACCEPTED
    outcome = put(Air(vehicle), items)
    assert isinstance(outcome, NotVerified)
    assert "refused the upload at item 4 (INVALID_PARAM1)" in str(outcome)


@pytest.mark.parametrize("result", [Result.NO_SPACE, Result.DENIED])
def test_what_was_refused_before_any_item_is_not_cleared(result: Result) -> None:
    vehicle = old(ARDUPILOT)
    if result is Result.NO_SPACE:
        vehicle.max_items = 5
    else:
        vehicle.receive(Received(MissionCount(1, 1, 8), Address(254, 190), 0.0))
    air = Air(vehicle)
    outcome = put(air)
    assert isinstance(outcome, NotVerified)
    assert air.sent(MissionClearAll) == []
    assert outcome.on_board is not None
    assert len(outcome.on_board) == 8
    assert result.name in str(outcome)


def test_mix_of_a_broken_upload_is_cleared_and_sent_again() -> None:
    vehicle = old(ARDUPILOT)
    # The items from number 3 on get lost until the vehicle has given up; then the link is good again.
    air = Air(vehicle)

    def fault(is_up: bool, message: Message, n: int) -> list[Message]:
        is_broken = is_up and 4 <= n < 24
        return [] if is_broken else [message]

    air.fault = fault
    outcome = put(air)
    assert isinstance(outcome, Verified)
    assert len(vehicle.lists[0]) == 10


def test_acknowledgement_left_over_from_before_at_the_last_item_is_no_success() -> None:
    vehicle = old(ARDUPILOT)

    def fault(is_up: bool, message: Message, n: int) -> list[Message]:
        # As the last item goes up it is lost, and an old acknowledgement comes down in its stead.
        if is_up and isinstance(message, MissionItemInt) and message.seq == 9 and n < 20:
            return []
        if not is_up and getattr(message, "seq", None) == 9 and n < 20:
            return [message, MissionAck(255, 190, Result.ACCEPTED, 0)]
        return [message]

    outcome = put(Air(vehicle, fault=fault))
    assert isinstance(outcome, Verified)
    assert compare(NEW, tuple(vehicle.lists[0]), ARDUPILOT) == ()


@both
def test_no_items_clear_the_list_and_prove_it(autopilot: Autopilot) -> None:
    vehicle = old(autopilot)
    outcome = put(Air(vehicle), ())
    assert outcome == Verified((), 0)
    assert vehicle.lists[0] == []


def test_vehicle_that_keeps_its_home_counts_as_cleared() -> None:
    class KeepsHome(FakeVehicle):
        def receive(self, received: Received) -> list[Message]:
            answers = super().receive(received)
            if isinstance(received.message, MissionClearAll):
                self.lists[0] = [OLD[0]]
            return answers

    assert isinstance(put(Air(KeepsHome(ARDUPILOT)), ()), Verified)
    outcome = put(Air(KeepsHome(PX4)), ())
    assert isinstance(outcome, NotVerified)
    assert "could not be cleared" in str(outcome)


def test_clearing_that_was_refused_is_no_success() -> None:
    vehicle = old(ARDUPILOT)
    vehicle.may_clear = False
    outcome = put(Air(vehicle), ())
    assert isinstance(outcome, NotVerified)
    assert outcome.on_board is not None
    assert len(outcome.on_board) == 8


def test_mission_shifted_by_a_forgotten_home_is_found() -> None:
    class ShiftsByOne(FakeVehicle):
        def keep(self, item: MissionItemInt) -> None:
            super().keep(replace(NEW[min(self.expected + 1, 9)], seq=self.expected))

    outcome = put(Air(ShiftsByOne(ARDUPILOT)))
    assert isinstance(outcome, NotVerified)
    assert outcome.differences[0].seq == 1


@both
def test_cancel_is_told_to_the_vehicle(autopilot: Autopilot) -> None:
    machine = VerifiedUpload(route(MissionType.MISSION), NEW, autopilot)
    assert (machine.progress, machine.next_deadline_s) == (("uploading", 0, 10), math.inf)
    machine.start(0.0)
    assert machine.cancel() == [MissionAck(1, 1, Result.OPERATION_CANCELLED, 0)]
    with pytest.raises(ValueError, match="once"):
        machine.start(0.0)


# Loss: the demand is that 200 items with 30 % loss each way end equal, ten times of ten.


@pytest.mark.few(5)
@both
@pytest.mark.parametrize("seed", range(10))
def test_two_hundred_items_at_30_percent_loss_each_way_end_equal(autopilot: Autopilot, seed: int) -> None:
    items = waypoints(200)
    vehicle = old(autopilot)
    outcome = put(Air(vehicle, loss=0.3, seed=seed), items)
    assert isinstance(outcome, Verified)
    assert compare(items, tuple(vehicle.lists[0]), autopilot) == ()


@pytest.mark.few(8)
@both
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("loss", [0.5, 0.7, 0.95])
def test_worse_loss_ends_equal_or_says_clearly_that_it_did_not(autopilot: Autopilot, loss: float, seed: int) -> None:
    items = waypoints(60)
    vehicle = old(autopilot)
    outcome = put(Air(vehicle, loss=loss, seed=seed), items)
    on_board = tuple(vehicle.lists[0])
    if isinstance(outcome, Verified):
        assert compare(items, on_board, autopilot) == ()
    else:
        assert outcome.on_board is None or outcome.differences
