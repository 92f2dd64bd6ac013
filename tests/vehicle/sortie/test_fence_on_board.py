"""A fence that is on board before a sortie: ours of an earlier flight goes, others stay until the pilot says so."""

from dataclasses import replace

import pytest

from groundstation.vehicle.failsafes import found_fence_check
from groundstation.vehicle.orders import fence_messages
from groundstation.vehicle.preflight import FENCE_BEFORE, FOREIGN_FENCE, Remedy, Verdict, remedies
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import Phase
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import FenceCircle, FencePolygon, fence_items
from missions.mavlink.link import drive
from missions.mavlink.messages import MissionAck, MissionClearAll, MissionCount, MissionRequestList
from missions.mavlink.transfer.exchange import MissionType, Route
from missions.mavlink.transfer.verified import Verified, VerifiedUpload
from missions.mavlink.transfer.wire_items import to_wire
from missions.simulator.effects.link_loss import LossyLink
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import LinkRejected, LinkTimeout, MissionError
from planning.geo.enu import geodetic_from_enu
from tests.missions.simulator.ground import PointMass
from tests.vehicle.sortie.test_flight_run import BOTH, OPTIONS, fly, orders, toy_at_home
from tests.vehicle.toy import GROUND, ToyLink

__all__ = ["orders"]


class ReadyError(Exception):
    """The test has seen what it wanted."""


FENCED = {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 7.0, "GF_ACTION": 2.0, "CAM1_TYPE": 1.0, "MNT1_TYPE": 1.0}


@pytest.fixture
def bare(orders):
    """The same sortie where nothing forbids a place."""
    return replace(orders, fences={})


def square(orders, x, y, half_m, *, inside):
    """A square around a place of the site's frame, on the wire."""
    corners = [(x + i * half_m, y + j * half_m, 0.0) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    lat, lon, _ = geodetic_from_enu(orders.site.origin, corners)
    polygon = FencePolygon(tuple(zip(map(float, lat), map(float, lon), strict=True)), is_inclusion=inside)
    items = to_wire(fence_items([polygon]), Autopilot.PX4, MissionType.FENCE)
    return tuple(replace(item, seq=seq) for seq, item in enumerate(items))


def last(view_or_run, code):
    return next((check for check in view_or_run.checks() if check.code == code), None)


ELSEWHERE = (900.0, 0.0, 50.0)
AROUND = (0.0, 0.0, 400.0)


@pytest.mark.long
@BOTH
def test_a_fence_of_an_earlier_flight_of_ours_is_cleared_and_nothing_else(orders, bare, autopilot):
    earlier = square(orders, *ELSEWHERE, inside=True)
    toy = toy_at_home(orders, autopilot=autopilot, fences=list(earlier), parameters=dict(FENCED))
    cleared = []
    hear = toy.hear

    def hear_and_note(message):
        if isinstance(message, MissionClearAll):
            cleared.append(message.mission_type)
        hear(message)

    toy.hear = hear_and_note
    run, outcome = fly(bare, toy, replace(OPTIONS, own_fences=(earlier,)))
    assert outcome.succeeded, outcome.error
    assert toy.fences == []
    assert cleared == [MissionType.FENCE], "never MAV_MISSION_TYPE_ALL, which takes the mission along"
    check = last(run, FENCE_BEFORE)
    assert (check.verdict, check.text) == (
        Verdict.OK,
        "that of an earlier flight of this ground station is cleared (areas to stay in: 1, to keep out of: 0)",
    )
    assert last(run, "geofence").text == "none is on board, and the sortie needs none"


@pytest.mark.long
@BOTH
def test_a_fence_of_an_earlier_sortie_gives_way_to_this_one(orders, autopilot):
    earlier = square(orders, *ELSEWHERE, inside=False)
    toy = toy_at_home(orders, autopilot=autopilot, fences=list(earlier))
    run, outcome = fly(orders, toy, replace(OPTIONS, own_fences=(earlier,)))
    assert outcome.succeeded, outcome.error
    assert [(item.x, item.y) for item in toy.fences] == [
        (item.x, item.y) for item in fence_messages(orders.fences[autopilot], autopilot)
    ]
    assert last(run, "geofence").verdict is Verdict.OK


@pytest.mark.long
@BOTH
def test_a_fence_of_others_around_the_sortie_stays_and_is_told(orders, bare, autopilot):
    foreign = square(orders, *AROUND, inside=True)
    toy = toy_at_home(orders, autopilot=autopilot, fences=list(foreign), parameters=dict(FENCED))
    run, outcome = fly(bare, toy)
    assert outcome.succeeded, outcome.error
    assert tuple(toy.fences) == foreign
    check = last(run, FOREIGN_FENCE)
    assert check.verdict is Verdict.WARN
    assert "did not put there (areas to stay in: 1, to keep out of: 0); it stays on board" in check.text
    assert any(note.code == "warning-fence" for note in outcome.notes)


@BOTH
@pytest.mark.parametrize(("where", "inside"), [(ELSEWHERE, True), ((0.0, 0.0, 60.0), False)])
def test_a_fence_of_others_that_the_sortie_leaves_grounds_it(orders, bare, autopilot, where, inside):
    foreign = square(orders, *where, inside=inside)
    toy = toy_at_home(orders, autopilot=autopilot, fences=list(foreign), parameters=dict(FENCED))
    run, outcome = fly(bare, toy)
    assert isinstance(outcome.error, MissionError)
    assert "the take-off lies outside of it" in str(outcome.error)
    assert "the vehicle would refuse the mission or break it off" in str(outcome.error)
    assert not toy.has_flown
    assert tuple(toy.fences) == foreign, "it has not vanished"
    assert remedies(last(run, FOREIGN_FENCE), run.on_board) == (Remedy.OVERRULE,)


def test_a_fence_that_is_switched_off_is_told_and_grounds_nothing(orders, bare):
    foreign = square(orders, *ELSEWHERE, inside=True)
    parameters = {**FENCED, "FENCE_ENABLE": 0.0}
    run, outcome = fly(bare, toy_at_home(orders, fences=list(foreign), parameters=parameters))
    assert outcome.succeeded, outcome.error
    check = last(run, FOREIGN_FENCE)
    assert check.verdict is Verdict.WARN
    assert "but it is switched off (FENCE_ENABLE 0): it stays on board" in check.text
    switched = found_fence_check(Autopilot.ARDUPILOT, {**parameters, "FENCE_AUTOENABLE": 2.0}, bare, foreign)
    assert switched.verdict is Verdict.BAD, "it is switched on in flight"


@pytest.mark.long
@BOTH
def test_a_fence_of_others_never_gives_way_to_ours_unasked(orders, autopilot):
    foreign = square(orders, *AROUND, inside=True)
    toy = toy_at_home(orders, autopilot=autopilot, fences=list(foreign))
    _, outcome = fly(orders, toy)
    assert isinstance(outcome.error, MissionError)
    assert "this sortie has its own, which would replace it" in str(outcome.error)
    assert tuple(toy.fences) == foreign
    toy = toy_at_home(orders, autopilot=autopilot, fences=list(foreign))
    run, outcome = fly(orders, toy, replace(OPTIONS, overrules=frozenset((FOREIGN_FENCE,))))
    assert outcome.succeeded, outcome.error
    assert len(toy.fences) == len(fence_messages(orders.fences[autopilot], autopilot))
    assert "removed, as the pilot said" in last(run, FENCE_BEFORE).text


def test_the_pilot_s_word_before_take_off_removes_it(orders, bare):
    """As the window does it: the line is overruled in the list, then Start is pressed."""
    foreign = square(orders, *ELSEWHERE, inside=True)
    toy = toy_at_home(orders, fences=list(foreign), parameters=dict(FENCED))
    run = FlightRun(bare, replace(OPTIONS, starts_itself=False), "toy")

    def show(view):
        assert toy.now_s < 120.0, view.checks
        grounding = [check.code for check in view.checks if check.verdict is Verdict.BAD]
        if grounding and FOREIGN_FENCE not in run.options.overrules:
            assert grounding == [FOREIGN_FENCE]
            assert toy.fences
            run.options = replace(run.options, overrules=frozenset(grounding))
        if view.phase is Phase.READY and not toy.fences:
            run.begin()

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert outcome.succeeded, outcome.error
    assert toy.fences == []


def test_a_fence_that_appears_between_upload_and_start_is_not_flown_against(orders, bare):
    toy = toy_at_home(orders, parameters=dict(FENCED))
    run = FlightRun(bare, replace(OPTIONS, starts_itself=False), "toy")

    def show(view):
        assert toy.now_s < 120.0
        if view.phase is Phase.READY:
            toy.fences[:] = square(orders, *ELSEWHERE, inside=True)
            run.begin()

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert isinstance(outcome.error, LinkRejected)
    assert "the geofence on the vehicle is not the one that was uploaded" in str(outcome.error)
    assert not toy.has_flown


def test_a_fence_that_is_switched_on_before_start_grounds_it_then(orders, bare):
    foreign = square(orders, *ELSEWHERE, inside=True)
    toy = toy_at_home(orders, fences=list(foreign), parameters={**FENCED, "FENCE_ENABLE": 0.0})
    run = FlightRun(bare, replace(OPTIONS, starts_itself=False), "toy")

    def show(view):
        assert toy.now_s < 120.0
        if view.phase is Phase.READY:
            toy.parameters["FENCE_ENABLE"] = 1.0
            run.begin()

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert isinstance(outcome.error, LinkRejected)
    assert "the take-off lies outside" in str(outcome.error)
    assert not toy.has_flown


@pytest.mark.long
def test_what_cannot_be_read_is_not_overwritten_and_not_taken_for_nothing(orders, bare):
    def deaf(**faults):
        toy = toy_at_home(orders, fences=list(square(orders, *AROUND, inside=True)), **faults)
        hear = toy.hear

        def hear_but_that(message):
            if not (isinstance(message, MissionRequestList) and message.mission_type == MissionType.FENCE):
                hear(message)

        toy.hear = hear_but_that
        return toy

    toy = deaf()
    _, outcome = fly(orders, toy)
    assert isinstance(outcome.error, LinkTimeout)
    assert "could not be read (silent): it may be somebody else's, and stays" in str(outcome.error)
    assert len(toy.fences) == 4
    run, outcome = fly(bare, deaf())
    assert outcome.succeeded, outcome.error
    assert last(run, FENCE_BEFORE).verdict is Verdict.WARN
    assert "does not say whether it has a geofence" in last(run, FENCE_BEFORE).text
    assert last(run, "geofence") is None


@pytest.mark.long
def test_a_vehicle_without_fences_flies_a_sortie_that_needs_none(orders, bare):
    toy = toy_at_home(orders)
    hear = toy.hear

    def refuse(message):
        if isinstance(message, MissionRequestList | MissionCount) and message.mission_type == MissionType.FENCE:
            toy.say(MissionAck(GROUND.system, GROUND.component, 3, MissionType.FENCE))
        else:
            hear(message)

    toy.hear = refuse
    run, outcome = fly(bare, toy)
    assert outcome.succeeded, outcome.error
    assert last(run, FENCE_BEFORE) is None
    _, outcome = fly(orders, toy)
    assert "the geofence is not on the vehicle" in str(outcome.error)


@pytest.mark.parametrize("fault", ["command", "corners", "place", "radius"])
def test_items_that_are_no_fence_ground_the_sortie_and_stay(orders, bare, fault):
    items = list(square(orders, *AROUND, inside=True))
    match fault:
        case "command":
            items[1] = replace(items[1], command=16)
        case "corners":
            items[0] = replace(items[0], param1=float("nan"))
        case "place":
            items[2] = replace(items[2], x=2_000_000_000)
        case "radius":
            items = [replace(items[0], command=5003, param1=-3.0)]
    check = found_fence_check(Autopilot.PX4, FENCED, bare, items)
    assert check.verdict is Verdict.BAD
    assert "cannot be told" in check.text


def test_a_circle_of_others_counts_too(orders, bare):
    home = orders.home

    def check_of(radius_m, *, inside):
        circle = FenceCircle(home.lat_deg, home.lon_deg, radius_m, inside)
        items = to_wire(fence_items([circle]), Autopilot.PX4, MissionType.FENCE)
        return found_fence_check(Autopilot.PX4, FENCED, bare, items)

    assert check_of(5.0, inside=True).verdict is Verdict.BAD
    assert "waypoint" in check_of(5.0, inside=True).text
    assert check_of(500.0, inside=True).verdict is Verdict.WARN
    assert check_of(1.0, inside=False).verdict is Verdict.BAD


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("is_own", [True, False])
def test_through_air_that_loses_a_third_the_same_comes_of_it(orders, bare, autopilot, is_own):
    """On the simulated vehicle; its other lists stay as they are."""
    fence = square(orders, *AROUND, inside=True)
    vehicle = SimulatedVehicle(autopilot, PointMass(), bare.site.origin, bare.home_enu_m)
    direct = DirectLink(vehicle)
    put = VerifiedUpload(Route(direct.address, vehicle.address, MissionType.FENCE), fence, autopilot)
    assert isinstance(drive(put, direct, direct.clock), Verified)
    options = replace(OPTIONS, starts_itself=False, own_fences=(fence,) if is_own else ())
    run = FlightRun(bare, options, "simulation")

    def show(view):
        if view.on_board.mission is not None:
            raise ReadyError

    link = LossyLink(direct, 0.3, (), lambda: vehicle.flight_s, 5)
    with pytest.raises(ReadyError):
        conduct(run, link, direct.clock, show=show)
    assert len(vehicle.stores.fence) == (0 if is_own else 4)
    assert len(vehicle.stores.mission) > 1
    found = {check.code: check.verdict for check in run.checks()}
    assert found.get(FENCE_BEFORE) is (Verdict.OK if is_own else None)
    assert found.get(FOREIGN_FENCE) is (None if is_own else Verdict.WARN)
