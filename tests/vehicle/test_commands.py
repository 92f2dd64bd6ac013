"""Commands and parameters: every way in which an answer can come, come late, or not come."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.vehicle.commands import ATTEMPT_S, N_ATTEMPTS, PROGRESS_S, Answer, CommandCall, set_mode_command
from groundstation.vehicle.parameters import N_ATTEMPTS as N_PARAMETER_ATTEMPTS
from groundstation.vehicle.parameters import ParameterCall, ParameterStatus, decoded, encoded
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, CommandAck, CommandInt, CommandLong, ParamSet, ParamValue, Received

OWN, VEHICLE = Address(255, 190), Address(1, 1)
ARM = 400


def call(command=None):
    return CommandCall("arming", command or CommandLong(1, 1, ARM, 1.0), OWN)


def answer(machine, result, time_s=0.5, source=VEHICLE, **changes):
    ack = CommandAck(**{"command": ARM, "result": result, "target_system": 255, "target_component": 190, **changes})
    return machine.receive(Received(ack, source, time_s))


def test_a_command_that_is_accepted_is_sent_once():
    machine = call()
    assert machine.start(0.0) == [CommandLong(1, 1, ARM, 1.0, confirmation=0)]
    assert answer(machine, 0) == []
    assert machine.outcome.is_accepted
    assert machine.tick(100.0) == []
    assert machine.next_deadline_s == math.inf


def test_a_refusal_says_why():
    machine = call()
    machine.start(0.0)
    answer(machine, 1)
    assert (machine.outcome.answer, machine.outcome.result) == (Answer.REFUSED, 1)
    assert machine.outcome.text == "the vehicle refused arming (not now)"


def test_each_repetition_counts_its_confirmation():
    machine = call()
    sent = machine.start(0.0)
    time_s = 0.0
    while machine.outcome is None:
        assert machine.tick(machine.next_deadline_s - 0.01) == []
        time_s = machine.next_deadline_s
        sent += machine.tick(time_s)
    assert [message.confirmation for message in sent] == list(range(N_ATTEMPTS))
    assert machine.outcome.answer is Answer.NO_ANSWER
    assert time_s == pytest.approx(N_ATTEMPTS * ATTEMPT_S)


def test_an_int_command_is_repeated_as_it_is():
    command = CommandInt(1, 1, ARM, x=5)
    machine = call(command)
    assert machine.start(0.0) + machine.tick(ATTEMPT_S) == [command, command]


def test_a_command_in_progress_is_waited_for_and_never_repeated():
    machine = call()
    machine.start(0.0)
    answer(machine, 5, 1.0, progress=40)
    assert (machine.outcome, machine.progress_percent) == (None, 40)
    assert machine.tick(PROGRESS_S) == []
    answer(machine, 5, PROGRESS_S, progress=255)
    assert (machine.outcome, machine.progress_percent) == (None, None)
    answer(machine, 0, PROGRESS_S + 5.0)
    assert machine.outcome.is_accepted


def test_a_command_in_progress_that_is_not_heard_of_again_is_no_success():
    machine = call()
    machine.start(0.0)
    answer(machine, 5, 1.0)
    assert machine.tick(1.0 + PROGRESS_S) == []
    assert machine.outcome.answer is Answer.NO_ANSWER


@pytest.mark.parametrize(
    "wrong",
    [
        {"command": 176},
        {"source": Address(2, 1)},
        {"source": Address(1, 100)},
        {"target_system": 254},
        {"target_component": 42},
    ],
    ids=["command", "system", "component", "other ground station", "other program"],
)
def test_acknowledgements_that_are_not_ours_are_passed_over(wrong):
    machine = call()
    machine.start(0.0)
    answer(machine, 0, **wrong)
    assert machine.outcome is None


def test_an_old_autopilot_does_not_say_whom_it_answers():
    machine = call()
    machine.start(0.0)
    answer(machine, 0, target_system=0, target_component=0)
    assert machine.outcome.is_accepted


def test_a_late_acknowledgement_changes_nothing():
    machine = call()
    machine.start(0.0)
    answer(machine, 4)
    answer(machine, 0)
    assert machine.outcome.answer is Answer.REFUSED


def test_modes_are_set_by_the_numbers_of_each_autopilot():
    auto = set_mode_command(Autopilot.ARDUPILOT, "AUTO", 1, 1)
    assert (auto.command, auto.param1, auto.param2, auto.param3) == (176, 1.0, 3.0, 0.0)
    mission = set_mode_command(Autopilot.PX4, "AUTO.MISSION", 1, 1)
    assert (mission.command, mission.param1, mission.param2, mission.param3) == (176, 1.0, 4.0, 4.0)
    with pytest.raises(ValueError, match=r"no mode 'AUTO\.MISSION'"):
        set_mode_command(Autopilot.ARDUPILOT, "AUTO.MISSION", 1, 1)


# Parameters

INT32, REAL32 = 6, 9


def parameter(wanted=0.0, autopilot=Autopilot.ARDUPILOT, name="WP_YAW_BEHAVIOR"):
    return ParameterCall(name, wanted, autopilot, VEHICLE)


def value_of(machine, value, time_s=0.5, param_type=REAL32, name=None, source=VEHICLE):
    message = ParamValue(name or machine.name, value, param_type, 900, 5)
    return machine.receive(Received(message, source, time_s))


def test_a_parameter_is_read_before_it_is_set_and_the_vehicles_word_ends_it():
    machine = parameter(0.0)
    machine.start(0.0)
    (setting,) = value_of(machine, 2.0)
    assert isinstance(setting, ParamSet)
    assert (setting.param_value, setting.param_type) == (0.0, REAL32)
    assert machine.outcome is None
    value_of(machine, 0.0)
    outcome = machine.outcome
    assert (outcome.status, outcome.value, outcome.former) == (ParameterStatus.SET, 0.0, 2.0)
    assert outcome.is_as_set


def test_a_parameter_that_is_right_already_is_not_sent():
    machine = parameter(2.0)
    machine.start(0.0)
    assert value_of(machine, 2.0) == []
    assert machine.outcome.status is ParameterStatus.UNCHANGED


def test_a_parameter_can_only_be_read():
    machine = parameter(None)
    machine.start(0.0)
    assert value_of(machine, 2.5) == []
    assert (machine.outcome.status, machine.outcome.value) == (ParameterStatus.READ, 2.5)


def test_a_vehicle_that_keeps_another_value_is_not_taken_for_set():
    machine = parameter(45.0)
    machine.start(0.0)
    value_of(machine, 20.0)
    value_of(machine, 30.0)
    assert (machine.outcome.status, machine.outcome.value) == (ParameterStatus.REFUSED, 30.0)
    assert not machine.outcome.is_as_set


def test_the_reading_that_comes_twice_is_no_refusal():
    machine = parameter(45.0)
    machine.start(0.0)
    value_of(machine, 20.0)
    value_of(machine, 20.0)
    assert machine.outcome is None
    value_of(machine, 45.0)
    assert machine.outcome.status is ParameterStatus.SET


def silence(machine):
    sent = []
    while machine.outcome is None:
        sent += machine.tick(machine.next_deadline_s)
    return sent


def test_a_parameter_that_the_vehicle_does_not_know_is_said_so():
    machine = parameter(0.0)
    sent = machine.start(0.0) + silence(machine)
    assert machine.outcome.status is ParameterStatus.UNKNOWN
    assert len(sent) == N_PARAMETER_ATTEMPTS


def test_a_setting_without_an_answer_is_no_success():
    machine = parameter(0.0)
    machine.start(0.0)
    sent = value_of(machine, 2.0) + silence(machine)
    assert machine.outcome.status is ParameterStatus.NO_ANSWER
    assert len(sent) == N_PARAMETER_ATTEMPTS


def test_other_parameters_and_other_vehicles_are_passed_over():
    machine = parameter(0.0)
    machine.start(0.0)
    assert value_of(machine, 0.0, name="OTHER") == value_of(machine, 0.0, source=Address(2, 1)) == []
    assert machine.outcome is None


def test_a_fraction_is_refused_where_the_vehicle_keeps_whole_numbers():
    machine = parameter(1.5)
    machine.start(0.0)
    assert value_of(machine, 2.0, param_type=INT32) == []
    assert machine.outcome.status is ParameterStatus.REFUSED


@given(
    st.integers(-(2**31), 2**31 - 1).filter(
        lambda n: not -8388607 <= n <= -4194305 and not 2139095041 <= n <= 2143289343
    )
)
def test_px4_carries_every_whole_number_in_the_bytes_of_a_float(number):
    carried = encoded(float(number), INT32, Autopilot.PX4)
    assert decoded(ParamValue("X", carried, INT32, 1, 0), Autopilot.PX4) == number


@given(st.integers(-(2**24), 2**24))
def test_ardupilot_carries_whole_numbers_as_they_are(number):
    assert encoded(float(number), INT32, Autopilot.ARDUPILOT) == number
    assert decoded(ParamValue("X", float(number), INT32, 1, 0), Autopilot.ARDUPILOT) == number
