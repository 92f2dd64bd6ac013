from __future__ import annotations

import pytest

from missions.mavlink.messages import Message, MissionAck, MissionClearAll, Received
from missions.mavlink.transfer.exchange import Ending, MissionType, Result
from missions.mavlink.transfer.verified import Clear, ClearOutcome, ClearState
from tests.missions.mavlink.transfer.fake_vehicle import (
    ARDUPILOT,
    OWN,
    PX4,
    ROUTE,
    VEHICLE,
    Air,
    FakeVehicle,
    lose,
    route,
    waypoints,
)


def cleared(air: Air) -> ClearOutcome:
    clear = Clear(ROUTE)
    air.run(clear)
    assert clear.outcome is not None
    return clear.outcome


def acked(result: int, time_s: float, mission_type: int = 0) -> Received:
    return Received(MissionAck(OWN.system, OWN.component, result, mission_type), VEHICLE, time_s)


def started() -> Clear:
    clear = Clear(ROUTE)
    clear.start(0.0)
    return clear


@pytest.mark.parametrize("mission_type", list(MissionType))
def test_only_the_list_that_was_meant_is_cleared(mission_type: MissionType) -> None:
    vehicle = FakeVehicle(PX4, {kind: list(waypoints(3, mission_type=kind)) for kind in range(3)})
    Air(vehicle).run(Clear(route(mission_type)))
    assert [len(vehicle.lists[kind]) for kind in range(3)] == [0 if kind == mission_type else 3 for kind in range(3)]


@pytest.mark.parametrize(("is_up", "kind"), [(True, MissionClearAll), (False, MissionAck)])
def test_lost_question_or_answer_is_asked_again(is_up: bool, kind: type[Message]) -> None:
    air = Air(FakeVehicle(ARDUPILOT), fault=lose(is_up, kind, 0, 1))
    assert cleared(air) == ClearOutcome(Ending.DONE, Result.ACCEPTED)
    assert len(air.sent(MissionClearAll)) == 3


def test_vehicle_in_its_mission_does_not_clear() -> None:
    assert cleared(Air(FakeVehicle(ARDUPILOT, may_clear=False))) == ClearOutcome(Ending.REFUSED, Result.ERROR)


def test_refusal_of_another_kind_ends_at_once() -> None:
    clear = started()
    clear.receive(acked(Result.INVALID, 0.1))
    assert clear.outcome == ClearOutcome(Ending.REFUSED, Result.INVALID)


def test_a_vehicle_that_is_starting_is_asked_again_and_one_that_never_can_refuses() -> None:
    """ArduCopter 4.7.0-dev answers UNSUPPORTED for some seconds after power-up."""
    clear = started()
    clear.receive(acked(Result.UNSUPPORTED, 0.1))
    assert clear.outcome is None
    for second in range(1, 12):
        clear.receive(acked(Result.UNSUPPORTED, float(second)))
    assert clear.outcome == ClearOutcome(Ending.REFUSED, Result.UNSUPPORTED)


def test_acknowledgements_of_other_lists_and_of_an_upload_before_are_ignored() -> None:
    clear = started()
    clear.receive(acked(Result.ACCEPTED, 0.1, mission_type=1))
    clear.receive(acked(Result.INVALID_SEQUENCE, 0.1))
    clear.receive(acked(Result.OPERATION_CANCELLED, 0.1))
    assert clear.state is ClearState.ASKED


def test_dead_link_ends_silent() -> None:
    air = Air(FakeVehicle(ARDUPILOT), loss=1.0)
    clear = Clear(ROUTE)
    assert 14.0 < air.run(clear) < 16.0
    assert clear.outcome == ClearOutcome(Ending.SILENT, None)
    with pytest.raises(ValueError, match="once"):
        clear.start(0.0)
