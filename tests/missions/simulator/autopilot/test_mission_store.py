"""The vehicle's side of the mission protocol, as measured on ArduCopter 4.5.6 and read in PX4's sources."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.messages import (
    Address,
    Message,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionItem,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    MissionRequestList,
    Received,
)
from missions.simulator.autopilot.mission_store import (
    FENCE,
    MISSION,
    RALLY,
    MissionStores,
    Refused,
    StoredItem,
    float32,
    stored,
    to_wire,
)
from tests.missions.simulator.ground import ARDUPILOT, PX4, at, item

GROUND, OTHER = Address(255, 190), Address(254, 190)
HOME_ITEM = StoredItem(16, 0, 0.0, 0.0, 0.0, 0.0, 223372000, 1142636000, 62.5)
WAYPOINT = at(16, 10, 0, 20, 2)


class Store:
    """A vehicle's stores with a clock."""

    def __init__(self, autopilot: Autopilot = ARDUPILOT, may_clear: bool = True) -> None:
        self.texts: list[str] = []
        self.stores = MissionStores(
            autopilot, lambda: HOME_ITEM, lambda: may_clear, lambda severity, text: self.texts.append(text)
        )
        self.now_s = 0.0

    def hear(self, message: Message, source: Address = GROUND) -> list[Message]:
        return self.stores.receive(Received(message, source, 0.0), self.now_s)

    def count(self, n: int, mission_type: int = MISSION, source: Address = GROUND) -> list[Message]:
        return self.hear(MissionCount(1, 1, n, mission_type), source)

    def send(self, seq: int, what: MissionItemInt = WAYPOINT, source: Address = GROUND) -> list[Message]:
        return self.hear(replace(what, seq=seq), source)

    def upload(self, items: list[MissionItemInt], mission_type: int = MISSION) -> int:
        answers = self.count(len(items), mission_type)
        for seq, each in enumerate(items):
            answers = self.send(seq, replace(each, mission_type=mission_type))
            if isinstance(answers[0], MissionAck):
                break
        (ack,) = answers
        return ack.type

    def later(self, seconds: float) -> list[Message]:
        self.now_s += seconds
        return self.stores.tick(self.now_s)

    def read(self, seq: int) -> MissionItemInt:
        (answer,) = self.hear(MissionRequestInt(1, 1, seq))
        return answer

    def norths(self) -> list[int]:
        return [each.y for each in self.stores.mission.items]


def numbered(*numbers: int) -> list[MissionItemInt]:
    """Waypoints that can be told apart by their y; home first."""
    return [item(16, frame=0), *(replace(WAYPOINT, y=number) for number in numbers)]


def test_upload_asks_for_item_after_item_and_acknowledges_the_last() -> None:
    store = Store()
    assert store.count(3) == [MissionRequest(255, 190, 0)]
    assert store.send(0) == [MissionRequest(255, 190, 1)]
    assert store.send(1) == [MissionRequest(255, 190, 2)]
    assert store.send(2) == [MissionAck(255, 190, 0)]
    assert store.texts == ["Flight plan received"]
    assert store.hear(MissionRequestList(1, 1)) == [MissionCount(255, 190, 3)]


def test_px4_asks_with_the_integer_request() -> None:
    assert Store(PX4).count(2) == [MissionRequestInt(255, 190, 0)]


@pytest.mark.parametrize(("autopilot", "retry_s", "give_up_s"), [(ARDUPILOT, 1.0, 8.0), (PX4, 0.5, 5.0)])
def test_items_are_asked_for_again_and_the_upload_given_up_in_the_end(autopilot, retry_s, give_up_s) -> None:
    store = Store(autopilot)
    store.count(3)
    store.send(0)
    assert store.later(retry_s - 0.05) == []
    (again,) = store.later(0.1)
    assert again.seq == 1
    assert store.later(retry_s - 0.1) == []
    store.now_s = 0.0
    asked = 0
    while (answers := store.later(0.1)) == [] or not isinstance(answers[0], MissionAck):
        asked += len(answers)
    assert store.now_s == pytest.approx(give_up_s, abs=0.11)
    assert asked >= give_up_s / (retry_s + 0.1) - 2
    assert not store.stores.is_receiving


def test_item_out_of_turn_is_answered_with_invalid_sequence_and_the_upload_goes_on() -> None:
    store = Store()
    store.count(3)
    assert store.send(2) == [MissionAck(255, 190, 13)]
    assert store.send(0) == [MissionRequest(255, 190, 1)]


def test_px4_leaves_an_item_out_of_turn_unanswered() -> None:
    store = Store(PX4)
    store.count(3)
    assert store.send(2) == []
    assert store.send(0) == [MissionRequestInt(255, 190, 1)]


@pytest.mark.parametrize(("autopilot", "result"), [(ARDUPILOT, 14), (PX4, 1)])
def test_second_sender_is_turned_away(autopilot: Autopilot, result: int) -> None:
    store = Store(autopilot)
    store.count(3)
    for answers in (store.count(2, source=OTHER), store.send(0, source=OTHER)):
        assert answers == [MissionAck(254, 190, result)]
    assert store.hear(MissionRequestList(1, 1), OTHER) == [MissionAck(254, 190, result)]
    assert store.send(0)[0].seq == 1


def test_same_sender_may_begin_again() -> None:
    store = Store()
    store.count(3)
    store.send(0)
    assert store.count(2) == [MissionRequest(255, 190, 0)]


@pytest.mark.parametrize(("autopilot", "limit"), [(ARDUPILOT, 650), (PX4, 500)])
def test_too_many_items_are_refused_before_the_first(autopilot: Autopilot, limit: int) -> None:
    store = Store(autopilot)
    assert limit == facts(autopilot).max_items
    assert store.count(limit + 1) == [MissionAck(255, 190, 4)]
    assert store.upload(numbered(*range(1, limit))) == 0
    if autopilot is ARDUPILOT:
        assert store.texts[0] == "Only 650 items are supported"


def test_ardupilot_keeps_home_as_item_0_whatever_is_sent() -> None:
    store = Store()
    store.upload([at(22, 0, 0, 30), WAYPOINT])
    assert store.read(0).z == HOME_ITEM.z
    assert (store.read(0).command, store.read(0).x) == (16, HOME_ITEM.x)
    assert [each.command for each in store.stores.mission.items] == [16, 16]


def test_px4_keeps_item_0_as_sent() -> None:
    store = Store(PX4)
    store.upload([at(22, 0, 0, 30), WAYPOINT])
    assert store.read(0).command == 22


def test_ardupilot_keeps_a_mix_of_both_missions_after_a_refused_upload() -> None:
    """A 5-item mission, a 6-item upload that fails at 3: new 1, 2 and old 3, 4."""
    store = Store()
    store.upload(numbered(11, 12, 13, 14))
    bad = numbered(21, 22, 23, 24, 25)
    bad[3] = item(4501)
    assert store.upload(bad) == 3
    assert store.norths()[1:] == [21, 22, 13, 14]
    assert len(store.stores.mission) == 5


def test_ardupilot_truncates_at_the_count() -> None:
    store = Store()
    store.upload(numbered(11, 12, 13, 14))
    store.count(3)
    assert store.norths()[1:] == [11, 12]
    store.later(9.0)
    assert store.texts[-1] == "Mission upload timeout"
    assert store.norths()[1:] == [11, 12]


@pytest.mark.parametrize("end", ["refused", "timeout"])
def test_px4_keeps_the_old_mission_until_the_last_item_is_there(end: str) -> None:
    store = Store(PX4)
    store.upload(numbered(11, 12, 13))
    before = store.stores.mission.items
    bad = numbered(21, 22, 23)
    if end == "refused":
        bad[2] = item(115, 90, frame=2)
        assert store.upload(bad) == 3
    else:
        store.count(4)
        store.send(0)
        store.later(6.0)
    assert store.stores.mission.items == before
    assert store.upload(numbered(21, 22)) == 0
    assert store.norths()[1:] == [21, 22]


def test_ardupilot_keeps_the_old_fence_until_the_last_corner_is_there() -> None:
    store = Store()
    corners = [replace(at(5001, east, north, 0, 3), frame=0) for east, north in ((0, 0), (9, 0), (9, 9))]
    assert store.upload(corners, FENCE) == 0
    store.count(3, FENCE)
    store.send(0, replace(corners[1], mission_type=FENCE))
    store.later(9.0)
    assert [each.x for each in store.stores.fence.items] == [each.x for each in corners]
    assert len(store.stores.mission) == 0


def test_rally_points_and_fences_take_only_their_own_commands() -> None:
    store = Store()
    assert store.upload([at(5100, 0, 0, 20)], RALLY) == 0
    assert store.upload([at(5001, 0, 0, 20)], RALLY) == 3
    assert store.upload([at(16, 0, 0, 20)], FENCE) == 3
    assert store.upload([at(5001, 0, 0, 0, frame=10)], FENCE) == 2


def test_clear_all_clears_every_kind_with_one_answer() -> None:
    store = Store()
    store.upload(numbered(11))
    store.upload([at(5100, 0, 0, 20)], RALLY)
    assert store.hear(MissionClearAll(1, 1, 255)) == [MissionAck(255, 190, 0, 255)]
    assert (len(store.stores.mission), len(store.stores.rally)) == (0, 0)


def test_count_of_nothing_clears() -> None:
    for autopilot in Autopilot:
        store = Store(autopilot)
        store.upload(numbered(11))
        assert store.count(0) == [MissionAck(255, 190, 0)]
        assert len(store.stores.mission) == 0


def test_mission_that_is_flown_is_not_cleared() -> None:
    store = Store(may_clear=False)
    store.upload(numbered(11))
    assert store.hear(MissionClearAll(1, 1)) == [MissionAck(255, 190, 1)]
    assert len(store.stores.mission) == 2


def test_unknown_kind_is_refused() -> None:
    assert Store().count(2, mission_type=7) == [MissionAck(255, 190, 3, 7)]


def test_request_behind_the_last_item_is_refused() -> None:
    store = Store()
    store.upload(numbered(11))
    assert store.hear(MissionRequestInt(1, 1, 2)) == [MissionAck(255, 190, 13)]


def test_old_request_is_answered_with_the_old_item_and_old_items_are_taken() -> None:
    """MISSION_ITEM works; its float32 degrees were off by up to 0.22 m."""
    store = Store()
    store.count(2)
    store.send(0)
    old = MissionItem(1, 1, 1, 3, 16, 0, 1, 0, 0, 0, 0, 22.3372123, 114.2636456, 20.0)
    assert store.hear(old) == [MissionAck(255, 190, 0)]
    kept = store.read(1)
    away_m = math.hypot((kept.x - 223372123) * 0.0111, (kept.y - 1142636456) * 0.0111 * math.cos(0.39))
    assert 0.0 < away_m < 1.0
    (answer,) = store.hear(MissionRequest(1, 1, 1))
    assert isinstance(answer, MissionItem)
    assert answer.x == float32(kept.x * 1e-7)


@pytest.mark.parametrize("command", sorted(facts(ARDUPILOT).rejected))
def test_ardupilot_refuses_what_it_does_not_know(command: int) -> None:
    with pytest.raises(Refused) as refused:
        stored(item(command), ARDUPILOT)
    assert refused.value.result == 3


@pytest.mark.parametrize("command", sorted(facts(ARDUPILOT).commands))
def test_ardupilot_keeps_what_it_knows(command: int) -> None:
    assert stored(item(command), ARDUPILOT).command == command


@pytest.mark.parametrize("frame", range(13))
def test_ardupilot_takes_positions_in_some_frames_and_tells_them_in_its_own(frame: int) -> None:
    taken = {0: 0, 2: 0, 3: 3, 5: 0, 6: 3, 10: 10, 11: 10}
    waypoint = at(16, 10, 0, 20, frame=frame)
    if frame in taken:
        assert stored(waypoint, ARDUPILOT).frame == taken[frame]
    else:
        with pytest.raises(Refused) as refused:
            stored(waypoint, ARDUPILOT)
        assert refused.value.result == 2
    assert stored(item(178, 1, 5, frame=frame), ARDUPILOT).frame == 0


@pytest.mark.parametrize(
    ("sent", "result"),
    [
        (item(178, 1, math.nan), 7),
        (item(1000, -10, 0, math.nan, math.nan), 8),
        (at(16, 0, 0, 20, math.nan), 6),
        (at(16, 0, 0, 20, 0, 0, 0, math.nan), None),
        (at(22, 0, 0, 20, 0, 0, 0, math.nan), None),
        (at(21, 0, 0, 20, 0, 0, 0, math.nan), None),
        (at(19, 0, 0, 20, 0, 0, 0, math.nan), 9),
        (replace(WAYPOINT, z=math.nan), 12),
        (replace(WAYPOINT, x=950_000_000), 10),
        (replace(WAYPOINT, y=1_810_000_000), 11),
        (replace(WAYPOINT, z=40_000.0), None),
    ],
)
def test_ardupilot_refuses_what_is_no_number_but_for_some_yaws(sent: MissionItemInt, result: int | None) -> None:
    if result is None:
        stored(sent, ARDUPILOT)
        return
    with pytest.raises(Refused) as refused:
        stored(sent, ARDUPILOT)
    assert refused.value.result == result


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        (at(16, 0, 0, 20, 2.9, 5, 6, 90), (2.0, 0.0, 0.0, 0.0)),
        (item(205, -45.67, 0, 30.9, 0, 0, 0, 2), (float32(-45.67), 0.0, float32(30.9), 0.0)),
        (item(1000, -45.67, 30.9, 0, 0), (-45.0, 30.0, 0.0, 0.0)),
        (item(93, 2.5, -1, -1, -1), (2.5, -1.0, -1.0, -1.0)),
        (item(115, 400, 5, 1, 0), (400.0, 5.0, 1.0, 0.0)),
        (item(115, -90), (-90.0, 0.0, 0.0, 0.0)),
    ],
)
def test_ardupilot_answers_with_what_it_kept_of_the_params(sent: MissionItemInt, kept: tuple[float, ...]) -> None:
    assert stored(sent, ARDUPILOT).params == kept


def test_ardupilot_keeps_of_the_other_fields_what_its_records_have() -> None:
    assert stored(item(205, 0, 0, 0, 0, 0, 0, 2), ARDUPILOT).z == 0.0
    gimbal = stored(item(1000, 0, 0, 0, 0, 12, 7, 1), ARDUPILOT)
    assert (gimbal.x, gimbal.y, gimbal.z) == (12, 0, 1.0)
    assert stored(item(203, 0, 0, 0, 0, 10_000_000), ARDUPILOT).x == 128
    assert stored(replace(WAYPOINT, z=20.019), ARDUPILOT).z == float32(20.01)


@pytest.mark.parametrize("frame", [10, 11])
def test_px4_refuses_terrain_frames(frame: int) -> None:
    with pytest.raises(Refused) as refused:
        stored(at(16, 0, 0, 20, frame=frame), PX4)
    assert refused.value.result == 2


def test_px4_takes_commands_without_position_in_frame_2_only() -> None:
    assert stored(item(2000, 0, 0, 1, frame=2), PX4).command == 2000
    with pytest.raises(Refused):
        stored(item(2000, 0, 0, 1, frame=3), PX4)
    with pytest.raises(Refused):
        stored(at(16, 0, 0, 20, frame=2), PX4)


def test_px4_keeps_fractions_and_nan() -> None:
    kept = stored(at(16, 0, 0, 20.019, 2.9, 0.3, 0, math.nan), PX4)
    assert kept.params[:3] == (float32(2.9), float32(0.3), 0.0)
    assert math.isnan(kept.param4)
    assert kept.z == float32(20.019)
    assert kept.frame == 6


numbers = st.floats(width=32, allow_nan=True, allow_infinity=True)


@given(
    autopilot=st.sampled_from(list(Autopilot)),
    command=st.sampled_from(sorted(facts(ARDUPILOT).commands | facts(PX4).commands | {0, 65535})),
    frame=st.integers(0, 21),
    params=st.tuples(numbers, numbers, numbers, numbers),
    x=st.integers(-(2**31), 2**31 - 1),
    y=st.integers(-(2**31), 2**31 - 1),
    z=numbers,
    mission_type=st.sampled_from((0, 1, 2)),
)
@settings(max_examples=300)
def test_whatever_comes_is_kept_or_refused_and_keeping_twice_is_keeping_once(
    autopilot, command, frame, params, x, y, z, mission_type
) -> None:
    sent = MissionItemInt(1, 1, 0, frame, command, 0, 1, *params, x, y, z, mission_type)
    try:
        once = stored(sent, autopilot)
    except Refused as refusal:
        result = refusal.result
    else:
        result = 0
        again = stored(to_wire(once, 0, False, mission_type), autopilot)
        assert repr(replace(again, z=0.0)) == repr(replace(once, z=0.0))
        # 20.02 m is 20.01 m once more: centimetres are cut off, and 20.02 is a little less in binary.
        assert again.z == pytest.approx(once.z, abs=0.0101, nan_ok=True, rel=1e-6)
    assert 0 <= result <= 15
