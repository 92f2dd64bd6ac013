from __future__ import annotations

from dataclasses import replace

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import (
    Address,
    Heartbeat,
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    Received,
)
from missions.mavlink.transfer.exchange import Ending, MissionType, Result
from missions.mavlink.transfer.verified import Upload, UploadOutcome, UploadState
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


def asked(seq: int, time_s: float = 0.0, mission_type: int = 0) -> Received:
    return told(MissionRequestInt(OWN.system, OWN.component, seq, mission_type), time_s)


def acked(result: int, time_s: float = 0.0, mission_type: int = 0) -> Received:
    return told(MissionAck(OWN.system, OWN.component, result, mission_type), time_s)


def numbers(messages: list[Message]) -> list[int]:
    return [message.seq for message in messages if isinstance(message, MissionItemInt)]


def started(n: int = 4) -> Upload:
    upload = Upload(ROUTE, waypoints(n))
    upload.start(0.0)
    return upload


def uploaded(air: Air, n: int = 10, mission_type: MissionType = MissionType.MISSION) -> UploadOutcome:
    upload = Upload(route(mission_type), waypoints(n, mission_type=mission_type))
    air.run(upload)
    assert upload.outcome is not None
    return upload.outcome


# The way it goes


@both
@pytest.mark.parametrize("mission_type", list(MissionType))
def test_upload_without_trouble_sends_each_message_once(autopilot: Autopilot, mission_type: MissionType) -> None:
    vehicle = FakeVehicle(autopilot)
    air = Air(vehicle)
    assert uploaded(air, 10, mission_type) == UploadOutcome(Ending.DONE, Result.ACCEPTED, 9)
    assert vehicle.lists[mission_type] == list(waypoints(10, mission_type=mission_type))
    assert len(air.sent(MissionCount)) == 1
    assert len(air.sent(MissionItemInt)) == 10


def test_upload_of_nothing_waits_for_the_acknowledgement_of_the_count() -> None:
    upload = Upload(ROUTE, ())
    assert upload.start(0.0) == [MissionCount(1, 1, 0, 0)]
    assert upload.state is UploadState.CLOSING
    assert upload.receive(acked(Result.ACCEPTED)) == []
    assert upload.outcome == UploadOutcome(Ending.DONE, Result.ACCEPTED, None)


def test_states_follow_the_table() -> None:
    upload = Upload(ROUTE, waypoints(2))
    assert upload.state is UploadState.READY
    assert upload.receive(asked(0)) == []
    upload.start(0.0)
    assert upload.state is UploadState.ANNOUNCED
    assert numbers(upload.receive(asked(0))) == [0]
    assert upload.state is UploadState.SENDING
    assert numbers(upload.receive(asked(1))) == [1]
    assert upload.state is UploadState.CLOSING
    upload.receive(acked(Result.ACCEPTED))
    assert upload.state is UploadState.ENDED
    assert upload.receive(asked(1)) == []
    assert upload.tick(1e9) == []
    with pytest.raises(ValueError, match="once"):
        upload.start(0.0)


# What gets lost


@both
def test_lost_count_is_sent_again_after_silence(autopilot: Autopilot) -> None:
    air = Air(FakeVehicle(autopilot), fault=lose(True, MissionCount, 0, 1))
    assert uploaded(air).ending is Ending.DONE
    assert len(air.sent(MissionCount)) == 3


@both
def test_lost_request_is_made_up_for(autopilot: Autopilot) -> None:
    for lost in range(10):
        kind = MissionRequest if autopilot is ARDUPILOT else MissionRequestInt
        vehicle = FakeVehicle(autopilot)
        assert uploaded(Air(vehicle, fault=lose(False, kind, lost))).ending is Ending.DONE
        assert vehicle.lists[0] == list(waypoints(10))


@both
def test_lost_item_is_sent_again_before_the_vehicle_asks_again(autopilot: Autopilot) -> None:
    for lost in range(9):
        vehicle = FakeVehicle(autopilot)
        air = Air(vehicle, fault=lose(True, MissionItemInt, lost))
        upload = Upload(ROUTE, waypoints(10))
        seconds = air.run(upload)
        assert upload.outcome is not None
        assert upload.outcome.ending is Ending.DONE
        assert vehicle.lists[0] == list(waypoints(10))
        # 10 questions and answers of 0.04 s, and one wait of 0.25 to 0.5 s.
        assert 0.4 < seconds < 0.95


@both
def test_lost_last_acknowledgement_ends_unconfirmed_never_done(autopilot: Autopilot) -> None:
    air = Air(FakeVehicle(autopilot), fault=lose(False, MissionAck, *range(20)))
    assert uploaded(air) == UploadOutcome(Ending.UNCONFIRMED, None, 9)


def test_error_of_an_idle_vehicle_after_the_last_item_is_no_refusal() -> None:
    # The acknowledgement was lost; the item sent again meets a vehicle that expects none any more.
    air = Air(FakeVehicle(ARDUPILOT), fault=lose(False, MissionAck, 0))
    assert uploaded(air) == UploadOutcome(Ending.UNCONFIRMED, Result.ERROR, 9)


@both
@pytest.mark.parametrize("n_messages", [0, 1, 5, 10])
def test_link_that_dies_ends_silent(autopilot: Autopilot, n_messages: int) -> None:
    air = Air(FakeVehicle(autopilot), fault=lambda is_up, message, n: [message] if n < n_messages else [])
    upload = Upload(ROUTE, waypoints(10))
    seconds = air.run(upload)
    assert upload.outcome is not None
    assert upload.outcome.ending is (Ending.UNCONFIRMED if n_messages == 10 else Ending.SILENT)
    assert seconds < 20.0


def test_heartbeats_without_answers_do_not_keep_an_upload_waiting() -> None:
    upload = started()
    for second in range(16):
        assert upload.receive(told(Heartbeat(2, 3, 0, 0, 0), second)) == []
        upload.tick(float(second))
    assert upload.outcome == UploadOutcome(Ending.SILENT, None, None)


def test_items_that_never_arrive_end_the_upload_stalled_though_the_vehicle_keeps_asking() -> None:
    vehicle = FakeVehicle(ARDUPILOT)
    # Items reach the vehicle's partner check but never count: it hears everything but items.
    air = Air(vehicle, fault=lambda is_up, message, n: [] if isinstance(message, MissionItemInt) else [message])
    upload = Upload(ROUTE, waypoints(5))
    assert air.run(upload) < 120.0
    assert upload.outcome is not None
    assert upload.outcome.ending in (Ending.STALLED, Ending.REFUSED)


# What comes twice, late, or is none of our business


def test_acknowledgement_of_an_earlier_transfer_is_ignored_until_the_last_item_went_out() -> None:
    upload = started()
    upload.receive(acked(Result.ACCEPTED))
    upload.receive(asked(0))
    upload.receive(acked(Result.ACCEPTED))
    assert upload.outcome is None


def test_messages_of_another_list_are_ignored() -> None:
    upload = started()
    assert upload.receive(asked(0, mission_type=1)) == []
    for result in Result:
        upload.receive(acked(result, mission_type=1))
        upload.receive(acked(result, mission_type=2))
    assert upload.outcome is None
    assert upload.state is UploadState.ANNOUNCED


def test_messages_for_another_ground_station_are_ignored() -> None:
    upload = started()
    assert upload.receive(told(MissionRequestInt(254, 190, 0))) == []
    upload.receive(told(MissionAck(254, 190, Result.DENIED)))
    upload.receive(told(MissionAck(255, 191, Result.DENIED)))
    assert upload.outcome is None


def test_messages_of_another_vehicle_or_component_are_ignored() -> None:
    upload = started()
    for source in (Address(2, 1), Address(1, 154)):
        assert upload.receive(told(MissionRequestInt(255, 190, 0), source=source)) == []
        upload.receive(told(MissionAck(255, 190, Result.ERROR), source=source))
    assert upload.outcome is None


def test_messages_to_everybody_are_taken() -> None:
    upload = started()
    assert numbers(upload.receive(told(MissionRequestInt(0, 0, 0)))) == [0]


@both
def test_deprecated_requests_are_answered_with_integer_items(autopilot: Autopilot) -> None:
    upload = started()
    (answer,) = upload.receive(told(MissionRequest(255, 190, 0)))
    assert isinstance(answer, MissionItemInt)


def test_repeated_request_is_answered_again_but_not_its_copy() -> None:
    upload = started()
    assert numbers(upload.receive(asked(0, 0.0))) == [0]
    assert numbers(upload.receive(asked(0, 0.05))) == []
    assert numbers(upload.receive(asked(0, 1.0))) == [0]


@both
def test_everything_twice_does_not_double_the_stream(autopilot: Autopilot) -> None:
    vehicle = FakeVehicle(autopilot)
    air = Air(vehicle, delay_s=0.2, fault=lambda is_up, message, n: [message, message])
    assert uploaded(air, 100).ending is Ending.DONE
    assert vehicle.lists[0] == list(waypoints(100))
    assert len(air.sent(MissionItemInt)) < 250


@both
def test_messages_out_of_order_end_well(autopilot: Autopilot) -> None:
    for seed in range(5):
        vehicle = FakeVehicle(autopilot)
        air = Air(vehicle, jitter_s=0.3, seed=seed, fault=lambda is_up, message, n: [message] * (1 + n % 2))
        # A copy of the last item may be answered with an error that overtakes the acknowledgement.
        assert uploaded(air, 30).ending in (Ending.DONE, Ending.UNCONFIRMED)
        assert vehicle.lists[0] == list(waypoints(30))


@both
def test_slow_link_is_learnt_and_not_flooded(autopilot: Autopilot) -> None:
    vehicle = FakeVehicle(autopilot)
    air = Air(vehicle, delay_s=0.45)
    assert uploaded(air, 40).ending is Ending.DONE
    # The vehicle asks again by itself after 0.5 or 1 s, so each item may go out twice, not more.
    assert len(air.sent(MissionItemInt)) <= 85


# What the vehicle does


def test_invalid_sequence_in_mid_transfer_is_not_the_end() -> None:
    upload = started()
    upload.receive(asked(1))
    assert upload.receive(acked(Result.INVALID_SEQUENCE)) == []
    assert upload.outcome is None
    assert numbers(upload.receive(asked(2))) == [2]


def test_invalid_sequence_after_a_repeat_brings_the_next_item_once() -> None:
    upload = started()
    upload.receive(asked(1))
    assert numbers(upload.tick(0.6)) == [1]
    assert numbers(upload.receive(acked(Result.INVALID_SEQUENCE, 0.7))) == [2]
    assert numbers(upload.receive(acked(Result.INVALID_SEQUENCE, 0.71))) == []


def test_acknowledgement_counts_where_the_last_item_went_out_unasked() -> None:
    upload = started(3)
    upload.receive(asked(1))
    assert numbers(upload.tick(1.0)) == [1]
    assert numbers(upload.tick(3.0)) == [1, 2]
    assert upload.state is UploadState.CLOSING
    upload.receive(acked(Result.ACCEPTED, 3.1))
    assert upload.outcome is not None
    assert upload.outcome.ending is Ending.DONE


def test_request_beyond_the_end_is_ignored_at_first_and_ends_the_upload_when_it_goes_on() -> None:
    upload = started(4)
    for _ in range(5):
        assert upload.receive(asked(4)) == []
        assert upload.outcome is None
    upload.receive(asked(9))
    assert upload.outcome == UploadOutcome(Ending.OUT_OF_STEP, None, None)


def test_vehicle_may_begin_anew_at_0() -> None:
    upload = started(3)
    for seq, time_s in ((0, 0.0), (1, 1.0), (2, 2.0), (0, 3.0), (1, 4.0)):
        assert numbers(upload.receive(asked(seq, time_s))) == [seq]
    assert upload.state is UploadState.SENDING
    upload.receive(acked(Result.ACCEPTED, 4.5))
    assert upload.outcome is None
    upload.receive(asked(2, 5.0))
    upload.receive(acked(Result.ACCEPTED, 5.5))
    assert upload.outcome == UploadOutcome(Ending.DONE, Result.ACCEPTED, 2)


def test_vehicle_that_begins_anew_again_and_again_is_given_up() -> None:
    upload = started(3)
    for lap in range(7):
        upload.receive(asked(0, 2.0 * lap))
        upload.receive(asked(1, 2.0 * lap + 1.0))
    assert upload.outcome is not None
    assert upload.outcome.ending is Ending.OUT_OF_STEP


@both
def test_vehicle_that_gave_up_is_sent_everything_anew(autopilot: Autopilot) -> None:
    vehicle = FakeVehicle(autopilot)

    def fault(is_up: bool, message: Message, n: int) -> list[Message]:
        if is_up and n == 5:
            vehicle.reboot()
        return [message]

    air = Air(vehicle, fault=fault)
    assert uploaded(air).ending is Ending.DONE
    assert vehicle.lists[0] == list(waypoints(10))
    assert len(air.sent(MissionCount)) == 2


def test_cancelled_again_and_again_ends_refused() -> None:
    upload = started(3)
    for lap in range(6):
        assert upload.outcome is None
        upload.receive(asked(0, 2.0 * lap + 1.0))
        upload.receive(acked(Result.OPERATION_CANCELLED, 2.0 * lap + 1.5))
    assert upload.outcome == UploadOutcome(Ending.REFUSED, Result.OPERATION_CANCELLED, 0)


def test_second_ground_station_is_denied() -> None:
    vehicle = FakeVehicle(ARDUPILOT)
    vehicle.receive(Received(MissionCount(1, 1, 5), Address(254, 190), 0.0))
    assert uploaded(Air(vehicle)) == UploadOutcome(Ending.REFUSED, Result.DENIED, None)


def test_no_space_is_told_before_anything_was_sent() -> None:
    assert uploaded(Air(FakeVehicle(PX4, max_items=5))) == UploadOutcome(Ending.REFUSED, Result.NO_SPACE, None)


@pytest.mark.parametrize(
    "result",
    [
        r
        for r in Result
        if r not in (Result.ACCEPTED, Result.ERROR, Result.INVALID_SEQUENCE, Result.OPERATION_CANCELLED)
    ],
)
@both
def test_refused_item_is_named_with_the_vehicles_reason(autopilot: Autopilot, result: Result) -> None:
    vehicle = FakeVehicle(autopilot, refuse=lambda item: result if item.seq == 3 else Result.ACCEPTED)
    assert uploaded(Air(vehicle)) == UploadOutcome(Ending.REFUSED, result, 3)


def test_unknown_result_is_a_refusal() -> None:
    upload = started()
    upload.receive(acked(99))
    assert upload.outcome == UploadOutcome(Ending.REFUSED, 99, None)


def test_error_left_over_from_before_does_not_end_a_new_upload() -> None:
    upload = started()
    for result in (Result.ERROR, Result.OPERATION_CANCELLED):
        upload.receive(acked(result, 0.1))
    assert upload.outcome is None
    assert numbers(upload.receive(asked(0, 0.2))) == [0]


def test_a_vehicle_that_is_starting_gets_its_items_once_it_can_take_them() -> None:
    """ArduCopter 4.7.0-dev answers UNSUPPORTED to every count for some seconds after power-up."""

    class Starting(FakeVehicle):
        def on_count(self, message: MissionCount, source: Address, now_s: float) -> list[Message]:
            if now_s < 4.0:
                return [self.ack(Result.UNSUPPORTED, source, 0)]
            return super().on_count(message, source, now_s)

    air = Air(Starting(ARDUPILOT))
    assert uploaded(air).ending is Ending.DONE
    assert 3 <= len(air.sent(MissionCount)) <= 6


def test_an_item_that_is_not_supported_still_ends_the_upload_at_once() -> None:
    upload = started()
    upload.receive(asked(0, 0.1))
    upload.receive(acked(Result.UNSUPPORTED, 0.2))
    assert upload.outcome == UploadOutcome(Ending.REFUSED, Result.UNSUPPORTED, 0)


def test_vehicle_that_answers_every_count_with_an_error_ends_refused() -> None:
    class Busy(FakeVehicle):
        def on_count(self, message: MissionCount, source: Address, now_s: float) -> list[Message]:
            return [self.ack(Result.ERROR, source, 0)]

    air = Air(Busy(PX4))
    assert uploaded(air) == UploadOutcome(Ending.REFUSED, Result.ERROR, None)
    assert 5 < len(air.sent(MissionCount)) < 20


def test_cancel_tells_the_vehicle() -> None:
    assert started().cancel() == [MissionAck(1, 1, Result.OPERATION_CANCELLED, 0)]


def test_items_are_numbered_and_addressed_whatever_they_said() -> None:
    item = replace(waypoints(1)[0], seq=77, target_system=9, target_component=9, mission_type=2)
    upload = Upload(route(MissionType.FENCE), (item, item))
    assert [(i.seq, i.target_system, i.target_component, i.mission_type) for i in upload.items] == [
        (0, 1, 1, 1),
        (1, 1, 1, 1),
    ]


def test_more_items_than_the_count_can_say_are_a_wrong_call() -> None:
    with pytest.raises(ValueError, match="65535"):
        Upload(ROUTE, waypoints(1) * 65536)
