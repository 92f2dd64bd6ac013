"""Remote ID: operators' numbers, what is sent and how often, and a vehicle that does not arm before it is content."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.preflight import OnBoard, Verdict, preflight_checks
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.telemetry import LocalFrame, updated_state
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import (
    Address,
    Heartbeat,
    OpenDroneIdArmStatus,
    OpenDroneIdBasicId,
    OpenDroneIdOperatorId,
    OpenDroneIdSelfId,
    OpenDroneIdSystem,
    Received,
)
from missions.mavlink.remote_id import (
    EU_STATES,
    REFUSALS,
    TOKENS,
    RemoteId,
    RemoteIdSender,
    check_character,
    operator_number,
    refusal_text,
    serial_number,
)
from missions.mavlink.wire import Decoder, Encoder
from missions.mission.build import missions_from_plan
from missions.mission.model import GeoPoint
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import InputError
from tests.missions.simulator.flying import bundled
from tests.missions.simulator.ground import ORIGIN, PointMass

PLACE = GeoPoint(22.3372, 114.2636, 62.0)
NUMBER = "FIN87astrdge12k8-xyz"
OPERATOR = RemoteId("FIN87astrdge12k8", "1581F5FHB229F0020", "Test")
LETTERS = "0123456789abcdefghijklmnopqrstuvwxyz"


# Numbers


def test_easas_own_example_is_proved_and_its_secret_part_goes_no_further():
    number = operator_number(f" {NUMBER} ")
    assert (number.public, number.is_eu, number.is_proved) == ("FIN87astrdge12k8", True, True)
    assert not operator_number("FIN87astrdge12k8").is_proved
    assert check_character("87astrdge12k", "xyz") == "8"


parts = st.tuples(st.sampled_from(sorted(EU_STATES)), st.text(LETTERS, min_size=12, max_size=12))


@given(parts, st.text(LETTERS, min_size=3, max_size=3), st.integers(0, 14), st.integers(1, 35))
def test_every_single_wrong_character_is_found(made, secret, place, off):
    state, base = made
    check = check_character(base, secret)
    assert operator_number(f"{state}{base}{check}-{secret}").is_proved
    body = list(base + secret)
    body[place] = LETTERS[(LETTERS.index(body[place]) + off) % 36]
    wrong = "".join(body)
    with pytest.raises(InputError, match="its checksum is wrong"):
        operator_number(f"{state}{wrong[:12]}{check}-{wrong[12:]}")


@given(parts, st.text(LETTERS, min_size=3, max_size=3), st.integers(0, 13))
def test_neighbours_that_are_swapped_are_found_but_for_the_one_pair_of_luhns(made, secret, place):
    """As with the modulus 10, where 09 and 90 are one: here 0z and z0."""
    _, base = made
    check, body = check_character(base, secret), list(base + secret)
    pair = {body[place], body[place + 1]}
    body[place], body[place + 1] = body[place + 1], body[place]
    swapped = "".join(body)
    is_same = check_character(swapped[:12], swapped[12:]) == check
    assert is_same == (len(pair) == 1 or pair == {"0", "z"})


@pytest.mark.parametrize("typed", ["FIN87ASTRDGE12K8-XYZ", "fin87astrdge12k8-xyz", "FIN 87as trdg e12k 8-xyz"])
def test_spaces_and_sizes_of_letters_are_mended(typed):
    assert operator_number(typed) == operator_number(NUMBER)


@pytest.mark.parametrize(
    "text",
    ["FIN87astrdge12k9-xyz", "FIN 87ASTRDGE12K9-XYZ", "FIN87astrdge12k8xyz", "DEU87astrdge12k", "FIN87astrdge12k8-xy"],
)
def test_wrong_numbers_are_refused_without_telling_the_secret(text):
    with pytest.raises(InputError) as refused:
        operator_number(text)
    assert "-xyz'" not in str(refused.value).lower()


@pytest.mark.parametrize("text", ["", " ", "x" * 21, "Müller", "a\nb"])
def test_what_does_not_fit_is_refused(text):
    with pytest.raises(InputError, match="expected 1 to 20 letters and digits"):
        operator_number(text)
    if text.strip():
        with pytest.raises(InputError, match="serial number"):
            serial_number(text)


def test_numbers_of_other_states_are_taken_as_they_are():
    number = operator_number("GBR-OP-123456")
    assert (number.public, number.is_eu, number.is_proved) == ("GBR-OP-123456", False, False)


# What is sent


def asked(time_s=0.0, status=1, error="OP_ID"):
    return Received(OpenDroneIdArmStatus(status, error), Address(1, 1), time_s)


def test_nothing_is_sent_to_a_vehicle_that_never_asks():
    sender = RemoteIdSender(OPERATOR, PLACE, lambda: 1.8e9)
    assert sender.receive(Received(Heartbeat(2, 3, 0, 0, 3), Address(1, 1), 0.0)) == []
    assert [sender.tick(float(t)) for t in range(5)] == [[]] * 5
    assert not sender.is_asked


def test_the_operators_place_goes_once_a_second_and_the_rest_every_three():
    sender = RemoteIdSender(OPERATOR, PLACE, lambda: 1_546_300_800.0 + 77.9)
    sender.receive(asked())
    sent = [(0.1 * step, message) for step in range(100) for message in sender.tick(0.1 * step)]
    times = {
        kind: [t for t, message in sent if isinstance(message, kind)]
        for kind in (OpenDroneIdSystem, OpenDroneIdOperatorId, OpenDroneIdSelfId, OpenDroneIdBasicId)
    }
    gaps = {kind: [b - a for a, b in itertools.pairwise(found)] for kind, found in times.items()}
    assert all(0.95 < gap < 1.15 for gap in gaps[OpenDroneIdSystem])
    for kind in (OpenDroneIdOperatorId, OpenDroneIdSelfId, OpenDroneIdBasicId):
        assert len(times[kind]) == 4
        assert all(2.95 < gap < 3.15 for gap in gaps[kind])
    system = next(message for _, message in sent if isinstance(message, OpenDroneIdSystem))
    assert (system.operator_latitude, system.operator_longitude) == (223372000, 1142636000)
    assert (system.classification_type, system.timestamp, system.operator_altitude_geo) == (1, 77, 62.0)


def test_messages_travel_over_the_wire_as_they_are():
    system, others = OPERATOR.messages(PLACE, 1.8e9)
    encoder, decoder = Encoder(Address(255, 190)), Decoder()
    for message in (system, *others, OpenDroneIdArmStatus(1, "OP_LOC")):
        (frame,) = decoder.feed(encoder.encode(message), 0.0)
        assert frame.received.message == message
    assert [message.operator_id for message in others if isinstance(message, OpenDroneIdOperatorId)] == [
        "FIN87astrdge12k8"
    ]


def test_without_a_number_none_is_sent_and_what_does_not_fit_is_no_identity():
    _, others = RemoteId().messages(PLACE, 0.0)
    assert [type(message) for message in others] == [OpenDroneIdSelfId]
    with pytest.raises(ValueError, match="operator: expected at most 20"):
        RemoteId("x" * 21)


# What is said of refusals


def test_every_known_refusal_has_words_and_unknown_ones_are_told_as_they_are():
    for own, words in REFUSALS.items():
        assert refusal_text(f"PreArm: OpenDroneID: {own}") == words
    assert refusal_text("OP_ID OP_LOC ") == f"{TOKENS['OP_ID']}; {TOKENS['OP_LOC']}"
    assert refusal_text("LOC LOC") == TOKENS["LOC"]
    assert refusal_text("RID error 106/107") == "it says: RID error 106/107"
    assert refusal_text("") == "it does not say why"


@given(st.text(max_size=60))
def test_any_text_of_a_module_becomes_words(text):
    assert refusal_text(text)


def orders_of():
    model, plan = bundled("roof", 4)
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    return sortie_orders(plan, model, mission)


def test_the_list_before_take_off_has_a_line_for_vehicles_with_a_module_only():
    orders = orders_of()
    frame = LocalFrame.of_home(orders.site.origin, orders.home_enu_m)

    def lines(*messages, now_s=1.0):
        state = VehicleState()
        for message in (Heartbeat(2, 3, 0, 0, 3), *messages):
            state = updated_state(state, Received(message, Address(1, 1), 0.5), frame)
        checks = preflight_checks(state, orders, OnBoard(), now_s, needs_rtk=False)
        return [(check.verdict, check.text) for check in checks if check.code == "remote-id"]

    assert lines() == []
    assert lines(OpenDroneIdArmStatus(0, "")) == [(Verdict.OK, "the module is content")]
    assert lines(OpenDroneIdArmStatus(1, "OP_ID")) == [(Verdict.WAIT, TOKENS["OP_ID"])]
    assert lines(OpenDroneIdArmStatus(1, ""))[0][0] is Verdict.WAIT
    ((verdict, text),) = lines(OpenDroneIdArmStatus(0, ""), now_s=9.5)
    assert (verdict, "silent for 9 s" in text) == (Verdict.WAIT, True)


# A vehicle that has a module


def vehicle(airframe=None, origin=ORIGIN, home=None):
    parameters = {"DID_ENABLE": 1, "DID_OPTIONS": 1}
    return SimulatedVehicle(
        Autopilot.ARDUPILOT, airframe or PointMass(), origin, home, parameters=parameters, is_ready=True
    )


def test_the_simulated_module_lists_what_it_lacks_and_ends_content():
    flown = vehicle()
    told = [m for m in flown.step(2.0) if isinstance(m, OpenDroneIdArmStatus)]
    assert [(each.status, each.error) for each in told] == [(1, "ID SELF_ID OP_ID SYS OP_LOC")] * 2
    sender = RemoteIdSender(OPERATOR, PLACE, lambda: 1.8e9)
    sender.receive(asked())
    for message in sender.tick(0.0):
        flown.receive(Received(message, Address(255, 190), 0.0))
    assert [m.status for m in flown.step(1.0) if isinstance(m, OpenDroneIdArmStatus)] == [0]
    # The operator's place grows old within 3 s, the rest within 22 s.
    assert [m.error for m in flown.step(4.0) if isinstance(m, OpenDroneIdArmStatus)][-1] == "SYS"
    assert [m.error for m in flown.step(20.0) if isinstance(m, OpenDroneIdArmStatus)][-1] == "SELF_ID OP_ID SYS"


@pytest.mark.slow
@pytest.mark.parametrize("is_sent", [True, False])
def test_a_vehicle_that_demands_remote_id_flies_with_it_and_not_without(is_sent):
    model, plan = bundled("roof", 4)
    orders = orders_of()
    from missions.simulator.build import make_airframe

    airframe, _ = make_airframe(plan, model, plan.sorties[0])
    flown = vehicle(airframe, model.site.origin, model.site.home_enu_m)
    link = DirectLink(flown)
    run = FlightRun(orders, RunOptions(sets_parameters=True, ready_s=20.0), "simulation")
    companions = (RemoteIdSender(OPERATOR, orders.home, lambda: 1.8e9),) if is_sent else ()
    outcome = conduct(run, link, link.clock, companions=companions)
    assert outcome.succeeded == is_sent
    if not is_sent:
        # The list before take-off says so, or the refusal does, whichever came first.
        assert any(words in str(outcome.error) for words in (TOKENS["OP_ID"], TOKENS["ID"]))
        assert not flown.modes.is_armed


def test_an_arming_that_is_refused_is_explained():
    flown = vehicle()
    refusal = flown.modes.arm()
    assert refusal == "OpenDroneID: UA_TYPE required in BasicID"
    assert refusal_text(refusal) == REFUSALS["UA_TYPE required in BasicID"]
    assert flown.modes.arm(is_forced=True) is None
    plain = SimulatedVehicle(Autopilot.PX4, PointMass(), ORIGIN, is_ready=True)
    assert not any(isinstance(m, OpenDroneIdArmStatus) for m in plain.step(3.0))
