from __future__ import annotations

from dataclasses import replace

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import (
    Address,
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionRequestInt,
    MissionRequestList,
    Received,
)
from missions.mavlink.transfer.exchange import Download, DownloadOutcome, DownloadState, Ending, MissionType, Result
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

both = pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])


def told(message: Message, time_s: float = 0.0, source: Address = VEHICLE) -> Received:
    return Received(message, source, time_s)


def counted(count: int, time_s: float = 0.0, mission_type: int = 0) -> Received:
    return told(MissionCount(OWN.system, OWN.component, count, mission_type), time_s)


def item(seq: int, time_s: float = 0.0) -> Received:
    ours = replace(waypoints(seq + 1)[seq], target_system=OWN.system, target_component=OWN.component)
    return told(ours, time_s)


def acked(result: int, time_s: float = 0.0) -> Received:
    return told(MissionAck(OWN.system, OWN.component, result), time_s)


def loaded(autopilot: Autopilot, n: int = 10, mission_type: int = 0) -> FakeVehicle:
    vehicle = FakeVehicle(autopilot)
    vehicle.lists[mission_type] = list(waypoints(n, mission_type=mission_type))
    return vehicle


def downloaded(air: Air, mission_type: MissionType = MissionType.MISSION) -> DownloadOutcome:
    download = Download(route(mission_type))
    air.run(download)
    assert download.outcome is not None
    return download.outcome


def seqs(outcome: DownloadOutcome) -> list[int]:
    return [each.seq for each in outcome.items]


def started() -> Download:
    download = Download(ROUTE)
    download.start(0.0)
    return download


@both
@pytest.mark.parametrize("mission_type", list(MissionType))
def test_download_asks_for_each_item_once_and_acknowledges(autopilot: Autopilot, mission_type: MissionType) -> None:
    air = Air(loaded(autopilot, 10, mission_type))
    outcome = downloaded(air, mission_type)
    assert (outcome.ending, outcome.count, seqs(outcome)) == (Ending.DONE, 10, list(range(10)))
    assert [request.seq for request in air.sent(MissionRequestInt)] == list(range(10))
    assert air.sent(MissionAck) == [MissionAck(1, 1, Result.ACCEPTED, mission_type)]


def test_empty_list_is_done_with_the_count() -> None:
    download = started()
    assert download.receive(counted(0)) == [MissionAck(1, 1, Result.ACCEPTED, 0)]
    assert download.outcome == DownloadOutcome(Ending.DONE, (), 0, None)


def test_states_follow_the_table() -> None:
    download = Download(ROUTE)
    assert download.state is DownloadState.READY
    assert download.receive(counted(2)) == []
    assert download.start(0.0) == [MissionRequestList(1, 1, 0)]
    assert download.state is DownloadState.LISTING
    assert download.receive(item(0)) == []
    assert download.receive(counted(2)) == [MissionRequestInt(1, 1, 0, 0)]
    assert download.state is DownloadState.FETCHING
    assert download.receive(item(0)) == [MissionRequestInt(1, 1, 1, 0)]
    assert download.receive(item(1)) == [MissionAck(1, 1, Result.ACCEPTED, 0)]
    assert download.state is DownloadState.ENDED
    assert download.tick(1e9) == []
    with pytest.raises(ValueError, match="once"):
        download.start(0.0)


@both
@pytest.mark.parametrize(
    ("is_up", "kind"),
    [(True, MissionRequestList), (True, MissionRequestInt), (False, MissionCount), (False, MissionItemInt)],
)
def test_whatever_is_lost_is_asked_for_again(autopilot: Autopilot, is_up: bool, kind: type[Message]) -> None:
    for lost in range(1 if kind in (MissionRequestList, MissionCount) else 10):
        outcome = downloaded(Air(loaded(autopilot), fault=lose(is_up, kind, lost)))
        assert (outcome.ending, seqs(outcome)) == (Ending.DONE, list(range(10)))


def test_lost_acknowledgement_does_no_harm() -> None:
    assert downloaded(Air(loaded(PX4), fault=lose(True, MissionAck, 0))).ending is Ending.DONE


def test_copies_and_items_out_of_turn_are_ignored() -> None:
    download = started()
    download.receive(counted(3))
    assert download.receive(item(2)) == []
    assert download.receive(item(0)) == [MissionRequestInt(1, 1, 1, 0)]
    assert download.receive(item(0)) == []
    assert download.receive(counted(3)) == []
    assert download.outcome is None


@both
def test_everything_twice_and_out_of_order_ends_well(autopilot: Autopilot) -> None:
    for seed in range(5):
        air = Air(loaded(autopilot), jitter_s=0.3, seed=seed, fault=lambda is_up, message, n: [message, message])
        outcome = downloaded(air)
        assert (outcome.ending, seqs(outcome)) == (Ending.DONE, list(range(10)))


def test_messages_of_other_lists_vehicles_and_stations_are_ignored() -> None:
    download = started()
    download.receive(counted(5, mission_type=1))
    download.receive(told(MissionCount(254, 190, 5)))
    download.receive(told(MissionCount(255, 190, 5), source=Address(2, 1)))
    assert download.state is DownloadState.LISTING


def test_list_that_changes_meanwhile_is_read_from_the_start() -> None:
    download = started()
    download.receive(counted(3))
    download.receive(item(0))
    assert download.receive(counted(2)) == [MissionRequestList(1, 1, 0)]
    download.receive(counted(2))
    for seq in range(2):
        download.receive(item(seq))
    assert download.outcome is not None
    assert (download.outcome.ending, seqs(download.outcome)) == (Ending.DONE, [0, 1])


def test_list_that_never_stops_changing_is_given_up() -> None:
    download = started()
    for lap in range(12):
        download.receive(counted(3 + lap % 2, float(lap)))
    for lap in range(12):
        download.receive(counted(3 + lap % 2, 12.0 + lap))
        download.receive(counted(4 + lap % 2, 12.5 + lap))
    assert download.outcome is not None
    assert download.outcome.ending is Ending.OUT_OF_STEP


def test_list_that_was_cut_meanwhile_is_read_from_the_start() -> None:
    download = started()
    download.receive(counted(3))
    assert download.receive(acked(Result.INVALID_SEQUENCE)) == [MissionRequestList(1, 1, 0)]


def test_busy_vehicle_is_asked_again_until_the_other_upload_is_over() -> None:
    vehicle = loaded(ARDUPILOT)
    vehicle.receive(told(MissionCount(1, 1, 10), source=Address(254, 190)))
    outcome = downloaded(Air(vehicle))
    assert (outcome.ending, outcome.count) == (Ending.DONE, 10)


@pytest.mark.parametrize("result", [Result.DENIED, Result.ERROR, Result.UNSUPPORTED])
def test_vehicle_that_stays_busy_ends_refused(result: Result) -> None:
    download = started()
    for second in range(12):
        download.receive(acked(result, float(second)))
    assert download.outcome == DownloadOutcome(Ending.REFUSED, (), None, result)


def test_refusal_ends_at_once() -> None:
    download = started()
    download.receive(acked(Result.INVALID))
    assert download.outcome == DownloadOutcome(Ending.REFUSED, (), None, Result.INVALID)


def test_acknowledgements_left_over_from_an_upload_are_ignored() -> None:
    download = started()
    for result in (Result.ACCEPTED, Result.INVALID_SEQUENCE, Result.OPERATION_CANCELLED, Result.ERROR):
        assert download.receive(acked(result)) == []
    assert download.state is DownloadState.LISTING
    assert download.outcome is None


@both
@pytest.mark.parametrize("n_messages", [0, 1, 5])
def test_link_that_dies_ends_silent_with_what_came(autopilot: Autopilot, n_messages: int) -> None:
    air = Air(loaded(autopilot), fault=lambda is_up, message, n: [message] if n < n_messages else [])
    outcome = downloaded(air)
    assert outcome.ending is Ending.SILENT
    assert len(outcome.items) == max(0, n_messages - 1)


def test_items_that_never_come_end_the_download_stalled() -> None:
    download = started()
    download.receive(counted(3))
    for half_second in range(200):
        download.receive(counted(3, half_second / 2))
        download.tick(half_second / 2)
    assert download.outcome == DownloadOutcome(Ending.STALLED, (), 3, None)


def test_cancel_tells_the_vehicle() -> None:
    assert started().cancel() == [MissionAck(1, 1, Result.OPERATION_CANCELLED, 0)]
