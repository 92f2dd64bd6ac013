"""A sortie from the first heartbeat to the landing, and everything that can come between."""

from dataclasses import dataclass, replace

import pytest

from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.preflight import is_ready
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import Phase, PilotOrder, RunOptions
from groundstation.vehicle.state import LINK_LOST_S
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, GimbalDeviceAttitudeStatus, Heartbeat, Received
from missions.mission.build import missions_from_plan
from missions.mission.model import altitude_amsl_m
from planning.base.errors import LinkError, LinkRejected, LinkTimeout, MissionError, OperationCancelled
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import single_panel
from planning.site.records import NoFlyZone
from tests.planning.revision.cases import QUICK
from tests.vehicle.toy import GROUND, STEP_S, Toy, ToyLink

BOTH = pytest.mark.parametrize("autopilot", list(Autopilot))


@pytest.fixture(scope="module")
def orders():
    """A flight of some photos before a single pane, beside a zone not to be flown over."""
    model = single_panel()
    low = model.site.airspace.min_enu_m
    corner = [(low[0] + x, low[1] + y) for x, y in ((0, 0), (3, 0), (3, 3))]
    airspace = replace(model.site.airspace, no_fly=(NoFlyZone("road", tuple(corner), -10.0, 200.0),))
    model = replace(model, site=replace(model.site, airspace=airspace))
    plan = plan_flight(model, PlanRequest(n_views=5, greedy=QUICK)).plan
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    return sortie_orders(plan, model, mission)


def toy_at_home(orders, stands_m=0.0, **faults):
    """One that stands at the planned home, `stands_m` higher."""
    home = orders.home
    faults.setdefault("home_amsl_m", altitude_amsl_m(home) + stands_m)
    return Toy((round(home.lat_deg * 1e7), round(home.lon_deg * 1e7)), **faults)


OPTIONS = RunOptions(sets_parameters=True, connect_s=10.0, ready_s=20.0)


def fly(orders, toy, options=OPTIONS, link=None, **changes):
    run = FlightRun(orders, options, "toy")
    outcome = conduct(run, link or ToyLink(toy), lambda: toy.now_s, **changes)
    return run, outcome


def codes(outcome):
    return [event.code for event in outcome.record.events]


@pytest.mark.long
@BOTH
def test_a_sortie_is_flown_and_recorded(orders, autopilot):
    toy = toy_at_home(orders, autopilot=autopilot)
    phases = []
    run, outcome = fly(orders, toy, show=lambda view: phases.append(view.phase))
    assert outcome.succeeded
    assert list(dict.fromkeys(phases)) == [phase for phase in Phase if phase in phases]
    assert phases[-1] is Phase.ENDED
    assert len(outcome.record.photos) == orders.mission.n_photos
    assert outcome.record.sortie == 1
    assert run.on_board.mission is True
    assert run.on_board.fence is True


def test_notes_say_when_since_the_run_began_whatever_the_clock_says(orders):
    toy = toy_at_home(orders)
    toy.now_s = 50_000.0
    _, outcome = fly(orders, toy)
    times_s = [note.time_s for note in outcome.notes]
    assert times_s == sorted(times_s)
    assert 0.0 <= times_s[0] < times_s[-1] == pytest.approx(toy.now_s - 50_000.0, abs=1.0)


def test_ardupilot_is_started_as_it_wants_it(orders):
    toy = toy_at_home(orders)
    fly(orders, toy)
    started = [command for command in toy.commands if command[0] in (176, 300, 400)]
    assert started == [(176, 1.0, 4.0), (400, 1.0, 0.0), (176, 1.0, 3.0), (300, 0.0, 0.0)]


def test_px4_is_started_as_it_wants_it(orders):
    toy = toy_at_home(orders, autopilot=Autopilot.PX4)
    fly(orders, toy)
    # Armed first, it may refuse the mode: it looks at the mission again from its new home.
    assert [command for command in toy.commands if command[0] in (176, 300, 400)] == [(176, 1.0, 4.0), (400, 1.0, 0.0)]


def test_without_a_heartbeat_it_says_what_to_look_for(orders):
    toy = toy_at_home(orders, silent=(0.0, 1000.0))
    _, outcome = fly(orders, toy)
    assert isinstance(outcome.error, LinkTimeout)
    assert "no ArduPilot or PX4 was heard within 10 s" in str(outcome.error)


def test_another_autopilot_than_expected_is_refused(orders):
    _, outcome = fly(orders, toy_at_home(orders), replace(OPTIONS, autopilot=Autopilot.PX4))
    assert "expected px4, found ardupilot" in str(outcome.error)


def test_a_vehicle_that_is_armed_already_is_left_alone(orders):
    toy = toy_at_home(orders, is_armed=True)
    _, outcome = fly(orders, toy)
    assert "armed already" in str(outcome.error)
    assert toy.commands == []


def test_a_link_that_goes_one_way_is_told_so(orders):
    toy = toy_at_home(orders)
    toy.hear = lambda message: None
    _, outcome = fly(orders, toy)
    assert "does the link go both ways" in str(outcome.error)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("fault", "text"),
    [({"battery": 10}, "battery holds 10%"), ({"fix_type": 2}, "fix: 2-D"), ({"refuses": {400: 3}}, "not supported")],
)
def test_what_grounds_a_flight_is_said(orders, fault, text):
    toy = toy_at_home(orders, **fault)
    _, outcome = fly(orders, toy)
    assert not outcome.succeeded
    assert text in str(outcome.error)
    assert not toy.is_flying


def test_an_aircraft_far_from_the_planned_home_is_not_started(orders):
    toy = toy_at_home(orders)
    toy.place = (toy.home[0] + 500, toy.home[1], 0)
    _, outcome = fly(orders, toy)
    assert isinstance(outcome.error, MissionError)
    assert "5.5 m from the planned home" in str(outcome.error)


@pytest.mark.long
@pytest.mark.few(2)
@BOTH
@pytest.mark.parametrize("stands_m", [-3.0, 10.0])
def test_an_aircraft_at_another_height_than_planned_is_not_started(orders, autopilot, stands_m):
    toy = toy_at_home(orders, stands_m, autopilot=autopilot)
    _, outcome = fly(orders, toy)
    assert f"stands {abs(stands_m):.1f} m" in str(outcome.error)
    assert not toy.has_flown
    toy = toy_at_home(orders, stands_m, autopilot=autopilot)
    _, outcome = fly(orders, toy, replace(OPTIONS, overrules=frozenset({"home-height"})))
    assert outcome.succeeded, "the pilot knows better"


def test_a_home_that_moves_with_arming_stops_the_motors_again(orders):
    toy = toy_at_home(orders, moves_home_m=-5.0)
    _, outcome = fly(orders, toy)
    assert "counts its heights from 5.0 m below the planned home" in str(outcome.error)
    assert not toy.has_flown
    assert not toy.is_armed


def test_arming_is_tried_again_while_the_autopilot_settles(orders):
    toy = toy_at_home(orders, refuses={400: 4}, refusals={400: 3})
    _, outcome = fly(orders, toy)
    assert outcome.succeeded
    assert sum(command[0] == 400 for command in toy.commands) == 4


@pytest.mark.slow
def test_arming_that_stays_refused_is_told_with_the_autopilots_own_words(orders):
    _, outcome = fly(orders, toy_at_home(orders, refuses={400: 4}))
    assert isinstance(outcome.error, LinkRejected)
    assert "refused arming (failed) (PreArm: test says no)" in str(outcome.error)


@pytest.mark.slow
def test_an_aircraft_that_does_not_take_off_is_no_success(orders):
    _, outcome = fly(orders, toy_at_home(orders, takes_off=False))
    assert "did not take off" in str(outcome.error)


@pytest.mark.slow
def test_a_vehicle_that_keeps_its_motors_running_is_disarmed(orders):
    toy = toy_at_home(orders, disarms_itself=False)
    _, outcome = fly(orders, toy)
    assert outcome.succeeded
    assert (400, 0.0, 0.0) in toy.commands


@pytest.mark.slow
def test_parameters_are_set_where_that_is_allowed_and_only_told_where_not(orders):
    toy = toy_at_home(orders, parameters={"WPNAV_SPEED": 500.0, "CAM1_TYPE": 1.0, "MNT1_TYPE": 1.0})
    fly(orders, toy)
    assert toy.parameters["WPNAV_SPEED"] == 100.0 * orders.mission.speed_m_s
    toy = toy_at_home(orders, parameters={"WPNAV_SPEED": 500.0})
    _, outcome = fly(orders, toy, replace(OPTIONS, sets_parameters=False))
    assert toy.parameters["WPNAV_SPEED"] == 500.0
    told = [note.text for note in outcome.notes if note.code == "parameter"]
    assert any("WPNAV_SPEED is 500" in text for text in told)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("autopilot", "parameters", "name"),
    [
        (Autopilot.ARDUPILOT, {"CAM1_TYPE": 0.0, "MNT1_TYPE": 1.0}, "CAM1_TYPE is 0"),
        (Autopilot.PX4, {"TRIG_MODE": 0.0, "MNT_MODE_IN": 4.0}, "TRIG_MODE is 0"),
        (Autopilot.PX4, {"TRIG_MODE": 1.0, "MNT_MODE_IN": -1.0}, "MNT_MODE_IN is -1"),
        (Autopilot.PX4, {"TRIG_MODE": 1.0, "MNT_MODE_IN": 0.0}, ""),
    ],
)
def test_a_camera_or_gimbal_that_is_switched_off_is_warned_of(orders, autopilot, parameters, name):
    toy = toy_at_home(orders, autopilot=autopilot, parameters=parameters)
    _, outcome = fly(orders, toy, replace(OPTIONS, sets_parameters=False))
    warned = [note.text for note in outcome.notes if note.code == "warning-setup"]
    assert [text.startswith(name) for text in warned] == ([True] if name else [])
    assert all("restart the vehicle" in text for text in warned)


def test_what_the_list_before_take_off_warns_of_is_told_where_nobody_confirms_it(orders):
    _, outcome = fly(orders, toy_at_home(orders))
    (warned,) = (note.text for note in outcome.notes if note.code == "warning-wind")
    assert warned.startswith("not measured on the ground: look up, or measure it; ")


def test_a_camera_that_was_just_set_up_takes_effect_after_a_reboot(orders):
    toy = toy_at_home(orders, parameters={"CAM1_TYPE": 0.0, "MNT1_TYPE": 0.0})
    _, outcome = fly(orders, toy)
    assert outcome.succeeded
    assert sum(command[0] == 246 for command in toy.commands) == 1


@pytest.mark.slow
def test_a_sped_up_simulation_that_forgets_what_it_was_asked_to_send_was_rebooted(orders):
    """ArduCopter 4.7.0-dev at ten times real time: when it is back, its time is beyond that before the reboot."""
    new = {"CAM1_TYPE": 0.0, "MNT1_TYPE": 0.0}
    toy = toy_at_home(orders, parameters=new, clock_rate=10.0, forgets_requests=True)
    _, outcome = fly(orders, toy)
    assert outcome.succeeded
    assert len(outcome.record.photos) == orders.mission.n_photos


def test_a_vehicle_that_is_not_rebooted_is_told(orders):
    toy = toy_at_home(orders, parameters={"CAM1_TYPE": 0.0, "MNT1_TYPE": 0.0})
    obey = toy.obey
    toy.obey = lambda command: 0 if command.command == 246 else obey(command)
    _, outcome = fly(orders, toy)
    assert "the vehicle was not rebooted" in str(outcome.error)
    assert not toy.is_flying


def test_losing_the_link_in_flight_is_shown_and_survived(orders):
    toy = toy_at_home(orders)
    shown = []

    def show(view):
        if view.phase is Phase.FLYING and toy.silent == (0.0, 0.0):
            toy.silent = (toy.now_s + 1.0, toy.now_s + 2.0 + 2.0 * LINK_LOST_S)
        shown.append((view.phase, view.is_link_alive, "link-lost" in view.watch.codes()))

    run, outcome = fly(orders, toy, show=show)
    assert outcome.succeeded
    assert (Phase.FLYING, False, True) in shown
    assert {"link-lost", "link-found", "mission-reread"} <= set(codes(outcome))
    assert run.on_board.mission is True
    texts = [event.text for event in outcome.record.events if event.code == "mission-reread"]
    assert texts == 2 * ["the mission on board is the one that was uploaded"], "at Start, and when it was heard again"


def test_a_mission_that_was_changed_behind_our_back_is_told(orders):
    toy = toy_at_home(orders)

    def show(view):
        if view.phase is Phase.FLYING and toy.silent == (0.0, 0.0):
            toy.silent = (toy.now_s + 1.0, toy.now_s + 2.0 + LINK_LOST_S)
            toy.items[3] = replace(toy.items[3], z=99.0)

    run, outcome = fly(orders, toy, show=show)
    assert run.on_board.mission is False
    assert any("another mission" in event.text for event in outcome.record.events)


def test_a_vehicle_that_stays_away_in_flight_is_no_success_but_leaves_its_record(orders):
    toy = toy_at_home(orders)

    def show(view):
        if view.phase is Phase.FLYING and len(view.state.photos) == 2:
            toy.silent = (toy.now_s, 1e9)

    _, outcome = fly(orders, toy, replace(OPTIONS, link_lost_s=30.0), show=show)
    assert "not heard for 30 s in flight" in str(outcome.error)
    assert len(outcome.record.photos) == 2


def test_a_broken_link_is_opened_again(orders):
    toy = toy_at_home(orders)
    opened = []

    def reopen():
        opened.append(toy.now_s)
        if len(opened) < 3:
            raise LinkError("not yet")
        return ToyLink(toy)

    link = ToyLink(toy, breaks_at_s=20.0)
    _, outcome = fly(orders, toy, link=link, reopen=reopen, wait=toy.step)
    assert outcome.succeeded
    assert link.is_closed
    assert len(opened) == 3


def test_a_broken_link_that_cannot_be_opened_again_is_an_error(orders):
    toy = toy_at_home(orders)
    with pytest.raises(LinkError, match="cable"):
        fly(orders, toy, link=ToyLink(toy, breaks_at_s=5.0))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("order", "mode"), [(PilotOrder.PAUSE, "BRAKE"), (PilotOrder.RETURN, "RTL"), (PilotOrder.LAND, "LAND")]
)
def test_orders_of_the_pilot_go_out_and_are_answered(orders, order, mode):
    toy = toy_at_home(orders)
    run = FlightRun(orders, OPTIONS, "toy")
    modes = []

    def show(view):
        modes.append(toy.mode)
        if view.phase is Phase.FLYING and len(view.state.photos) == 1 and mode not in modes and not run._orders:
            run.order(order)
        if toy.mode == "BRAKE" and len(modes) % 50 == 0:
            run.order(PilotOrder.RESUME)

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert outcome.succeeded
    assert mode in modes
    assert run.answers[0].is_accepted
    assert run.answers[0].text == f"{order.value}: done"
    n_photos = orders.mission.n_photos if order is PilotOrder.PAUSE else 1
    assert len(outcome.record.photos) == n_photos


def test_a_refused_order_is_not_taken_for_done(orders):
    toy = toy_at_home(orders)
    run = FlightRun(orders, OPTIONS, "toy")

    def show(view):
        if view.phase is Phase.FLYING and not run.answers and 176 not in toy.refuses:
            toy.refuses[176] = 2
            run.order(PilotOrder.RETURN)

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert run.answers[0].text == "the vehicle refused returning home (denied)"
    assert outcome.succeeded


def test_without_a_vehicle_nothing_can_be_ordered(orders):
    with pytest.raises(ValueError, match="no vehicle"):
        FlightRun(orders, OPTIONS, "toy").order(PilotOrder.LAND)


@pytest.mark.slow
def test_a_run_waits_for_the_pilot_where_it_must_not_start_by_itself(orders):
    toy = toy_at_home(orders)
    run = FlightRun(orders, replace(OPTIONS, starts_itself=False), "toy")
    ready_s = []

    def show(view):
        if view.phase is Phase.READY:
            assert is_ready(view.checks)
            ready_s.append(view.time_s)
            if view.time_s > ready_s[0] + 10.0:
                run.begin()

    outcome = conduct(run, ToyLink(toy), lambda: toy.now_s, show=show)
    assert outcome.succeeded
    assert ready_s[-1] - ready_s[0] > 9.0


def test_what_is_no_longer_well_takes_readiness_back_until_it_is_well_again(orders):
    """The charge falls below what the sortie needs while the pilot waits; then a fuller battery is put in."""
    toy = toy_at_home(orders)
    run = FlightRun(orders, replace(OPTIONS, starts_itself=False), "toy")
    phases = []

    def show(view):
        assert is_ready(view.checks) or view.phase is not Phase.READY
        if phases[-1:] != [view.phase]:
            phases.append(view.phase)
        if view.phase is Phase.READY:
            toy.battery = 3 if phases.count(Phase.READY) == 1 else 99
            if phases.count(Phase.READY) == 2:
                run.begin()
        elif view.phase is Phase.CHECKING and phases.count(Phase.READY) == 1:
            toy.battery = 99

    assert conduct(run, ToyLink(toy), lambda: toy.now_s, show=show).succeeded
    since = phases[phases.index(Phase.READY) :]
    assert since[:4] == [Phase.READY, Phase.CHECKING, Phase.READY, Phase.STARTING]


def test_a_photo_that_stays_away_is_warned_of_in_flight(orders):
    toy = toy_at_home(orders, drops_photo=2)
    _, outcome = fly(orders, toy)
    assert len(outcome.record.photos) == orders.mission.n_photos - 1
    assert "warning-photo-missing" in codes(outcome)


def test_a_cancelled_sortie_is_cancelled_and_its_link_closed(orders):
    toy = toy_at_home(orders)
    link = ToyLink(toy)

    class Cancelling:
        def report(self, stage, done, total):
            if stage == "photos" and done >= 1:
                raise OperationCancelled("by the test")

    with pytest.raises(OperationCancelled):
        fly(orders, toy, link=link, monitor=Cancelling())
    assert link.is_closed
    assert toy.is_flying, "nothing is ordered without the pilot"


# Vehicles that are not what they seem


@dataclass
class TwoToys:
    """A link on which two vehicles go by one number."""

    toys: tuple[Toy, Toy]
    address: Address = GROUND

    def send(self, message):
        for toy in self.toys:
            toy.hear(message)

    def receive(self, timeout_s):
        if not any(toy.out for toy in self.toys):
            for toy in self.toys:
                toy.step(min(max(timeout_s, 0.001), STEP_S))
        said = sorted((toy for toy in self.toys if toy.out), key=lambda toy: len(toy.out))
        return Received(said[-1].out.popleft(), Address(1, 1), said[-1].now_s) if said else None

    def close(self):
        pass


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("differs", "words"),
    [
        ({"autopilot": Autopilot.PX4}, "different kinds"),
        ({"boot_s": -3000.0}, "times since power-up differ"),
        ({"place": (10_000_000, 20_000_000, 0)}, "at different places"),
    ],
)
def test_two_vehicles_with_one_number_are_noticed_and_neither_is_started(orders, differs, words):
    one, other = toy_at_home(orders), toy_at_home(orders, **{k: v for k, v in differs.items() if k == "autopilot"})
    for name, value in differs.items():
        setattr(other, name, value)
    run = FlightRun(orders, OPTIONS, "toys")
    outcome = conduct(run, TwoToys((one, other)), lambda: one.now_s)
    assert words in run.state.impostor
    assert not outcome.succeeded
    assert not one.has_flown
    assert not other.has_flown


def test_another_vehicle_with_its_own_number_is_told_and_left_alone(orders):
    toy = toy_at_home(orders)
    link = ToyLink(toy)
    receive = link.receive

    def receive_both(timeout_s):
        received = receive(timeout_s)
        if received is not None and isinstance(received.message, Heartbeat) and toy.now_s > 3.0:
            toy.other_heard = not getattr(toy, "other_heard", False)
            return replace(received, source=Address(2, 1)) if toy.other_heard else received
        return received

    link.receive = receive_both
    texts = []
    fly(orders, toy, link=link, show=lambda view: texts.extend(check.text for check in view.checks))
    assert any("others are on the link, too: 2" in text for text in texts)


def test_motors_that_stop_unheard_have_not_stopped_in_the_air(orders):
    # Who was not heard for seconds may have landed meanwhile: its last height says nothing any more.
    toy = toy_at_home(orders)

    def show(view):
        if view.phase is Phase.FLYING and len(view.state.photos) == 3 and toy.silent == (0.0, 0.0):
            toy.silent = (toy.now_s, toy.now_s + 4.0)
            # Of all streams, the heartbeat is the first to come back.
            toy.is_armed = toy.tells_all = False

    _, outcome = fly(orders, toy, show=show)
    assert outcome.succeeded, outcome.error


def test_motors_that_stop_in_the_air_are_no_landing(orders):
    toy = toy_at_home(orders)

    def show(view):
        if view.phase is Phase.FLYING and len(view.state.photos) == 3:
            toy.is_armed = toy.is_flying = False

    _, outcome = fly(orders, toy, show=show)
    assert isinstance(outcome.error, MissionError)
    assert "the motors stopped" in str(outcome.error)
    assert "the aircraft fell" in str(outcome.error)
    assert outcome.record.is_disarmed is True
    assert "landed" not in codes(outcome)


def test_positions_that_stop_in_flight_are_warned_of_within_three_seconds(orders):
    toy = toy_at_home(orders)
    since = []
    warned = []

    def show(view):
        if view.phase is Phase.FLYING and view.state.photos:
            toy.tells_all = False
            since.append(view.time_s)
        if "position-lost" in view.watch.codes():
            warned.append(view.time_s)

    fly(orders, toy, show=show)
    assert 0.0 < warned[0] - since[0] <= 3.0


def test_a_stuck_gimbal_is_warned_of_at_the_second_photo(orders):
    toy = toy_at_home(orders)
    toy.say = lambda message, say=toy.say: say(
        replace(message, q=(0.9239, 0.0, -0.3827, 0.0)) if isinstance(message, GimbalDeviceAttitudeStatus) else message
    )
    n_photos = []

    def show(view):
        if "gimbal" in view.watch.codes():
            n_photos.append(len(view.state.photos))

    fly(orders, toy, show=show)
    assert n_photos[0] in (2, 3)
