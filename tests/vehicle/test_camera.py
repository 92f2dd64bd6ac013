"""A camera that is set over MAVLink's camera protocol: acknowledged, read back, refused, silent; and in a flight."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.flying import FlightRequest, Flown, fly_plan
from groundstation.vehicle.camera import (
    ATTEMPT_S,
    N_ATTEMPTS,
    CameraSettingCall,
    decoded,
    encoded,
    settings_text,
    wanted_settings,
)
from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.parameters import ParameterStatus
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions, RunView
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.camera_definition import parse_definition
from missions.mavlink.messages import Address, Message, ParamExtAck, ParamExtSet, ParamExtValue, Received
from missions.mission.build import missions_from_plan
from missions.mission.model import Mission
from missions.simulator.autopilot.camera_parameters import CAMERA_COMPONENT, CameraParameters
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.aircraft.camera_use import controls_of
from planning.parameters import CameraSettings
from planning.plan import Plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import single_panel
from tests.missions.plans import example_plan
from tests.missions.simulator.ground import PointMass
from tests.planning.revision.cases import QUICK

CAMERA = Address(1, CAMERA_COMPONENT)
MANUAL = CameraSettings("manual", 1 / 500, 5.6, 200, white_balance="sunny")


def obedient(plan: Plan, settings: CameraSettings) -> Plan:
    controls = controls_of(plan)
    assert controls is not None
    return replace(plan, camera_settings=settings, camera_controls=replace(controls, mavlink=("parameters",)))


def mission_with(settings: CameraSettings) -> Mission:
    return missions_from_plan(obedient(example_plan("ardupilot"), settings))[0]


def values_of(settings: CameraSettings) -> dict[str, float | None]:
    return {each.name: each.value for each in wanted_settings(mission_with(settings))}


Answer = Callable[[Message], list[Message]]


def driven(call: CameraSettingCall, answer: Answer, source: Address = CAMERA) -> float:
    """Run a call against something that answers; the time it took."""
    now_s, pending = 0.0, call.start(0.0)
    while call.outcome is None:
        for message in pending:
            for reply in answer(message):
                pending = call.receive(Received(reply, source, now_s))
                break
            else:
                continue
            break
        else:
            now_s = call.next_deadline_s
            pending = call.tick(now_s)
    return now_s


def test_what_is_wanted_follows_the_settings_and_only_a_camera_that_takes_it_is_asked() -> None:
    assert values_of(MANUAL) == {
        **{"CAM_EXPMODE": 1, "CAM_SHUTTERSPD": 1 / 500, "CAM_APERTURE": 5.6, "CAM_ISO": 200, "CAM_WBMODE": 4},
    }
    usual = values_of(CameraSettings(compensation_ev=-0.5))
    assert usual == {"CAM_EXPMODE": 0, "CAM_EV": -0.5}, "kelvins and locks have no name in the protocol"
    assert wanted_settings(missions_from_plan(example_plan("ardupilot"))[0]) == ()


@pytest.mark.parametrize("settings", [MANUAL, CameraSettings(compensation_ev=-1.5, white_balance="cloudy")])
def test_the_simulated_camera_has_what_was_set_when_it_is_read_back(settings: CameraSettings) -> None:
    camera = CameraParameters()
    for name, value in values_of(settings).items():
        call = CameraSettingCall(name, value, 1)
        driven(call, camera.receive)
        assert call.outcome is not None
        assert call.outcome.is_as_set, name
        assert camera.values[name] == pytest.approx(value, rel=1e-6)


def test_a_second_time_nothing_is_sent() -> None:
    camera, sent = CameraParameters({"CAM_ISO": 200}), list[Message]()

    def answer(message: Message) -> list[Message]:
        sent.append(message)
        return camera.receive(message)  # type: ignore[arg-type]

    call = CameraSettingCall("CAM_ISO", 200, 1)
    driven(call, answer)
    assert call.outcome is not None
    assert call.outcome.status is ParameterStatus.UNCHANGED
    assert not any(isinstance(message, ParamExtSet) for message in sent)


@pytest.mark.parametrize(("name", "value"), [("CAM_SHUTTERSPD", 1 / 777), ("CAM_ISO", 12_800), ("CAM_ISO", 100.5)])
def test_values_that_the_camera_does_not_have_are_refused_and_change_nothing(name: str, value: float) -> None:
    camera = CameraParameters()
    camera.values["CAM_EXPMODE"] = 1
    before = dict(camera.values)
    call = CameraSettingCall(name, value, 1)
    driven(call, camera.receive)
    assert call.outcome is not None
    assert call.outcome.status is ParameterStatus.REFUSED
    assert camera.values == before


def test_a_camera_that_accepts_and_keeps_another_value_is_found_out() -> None:
    """Which is why it is read back."""
    camera = CameraParameters({"CAM_ISO": 100})

    def liar(message: Message) -> list[Message]:
        if isinstance(message, ParamExtSet):
            return [ParamExtAck(message.param_id, message.param_value, message.param_type, 0)]
        return camera.receive(message)  # type: ignore[arg-type]

    call = CameraSettingCall("CAM_ISO", 200, 1)
    driven(call, liar)
    assert call.outcome is not None
    assert (call.outcome.status, call.outcome.value) == (ParameterStatus.REFUSED, 100.0)


def test_a_silent_camera_is_asked_some_times_and_then_unknown() -> None:
    call = CameraSettingCall("CAM_ISO", 200, 1)
    assert driven(call, lambda _message: []) == pytest.approx(N_ATTEMPTS * ATTEMPT_S)
    assert call.outcome is not None
    assert call.outcome.status is ParameterStatus.UNKNOWN


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_lost_answers_are_asked_for_again(lost: int) -> None:
    camera, n_heard = CameraParameters(), 0

    def thin(message: Message) -> list[Message]:
        nonlocal n_heard
        n_heard += 1
        answers = camera.receive(message)  # type: ignore[arg-type]
        return [] if n_heard == lost else answers

    call = CameraSettingCall("CAM_EV", 1.0, 1)
    driven(call, thin)
    assert call.outcome is not None
    assert call.outcome.is_as_set
    assert camera.values["CAM_EV"] == 1.0


def test_answers_of_others_and_about_others_are_passed_over() -> None:
    call = CameraSettingCall("CAM_ISO", 200, 1)
    call.start(0.0)
    content = encoded(200.0, 5)
    assert call.receive(Received(ParamExtValue("CAM_ISO", content, 5, 1, 0), Address(2, 100), 0.1)) == []
    assert call.receive(Received(ParamExtValue("CAM_EV", content, 5, 1, 0), CAMERA, 0.1)) == []
    assert call.outcome is None
    (asked,) = call.receive(Received(ParamExtValue("CAM_ISO", encoded(100.0, 5), 5, 1, 0), CAMERA, 0.1))
    assert isinstance(asked, ParamExtSet)
    assert asked.target_component == CAMERA_COMPONENT, "whoever answered"
    assert call.receive(Received(ParamExtAck("CAM_ISO", content, 5, 0), Address(1, 101), 0.2)) == []
    assert call.outcome is None


def test_a_camera_at_work_is_waited_for() -> None:
    call = CameraSettingCall("CAM_ISO", 200, 1)
    call.start(0.0)
    call.receive(Received(ParamExtValue("CAM_ISO", encoded(100.0, 5), 5, 1, 0), CAMERA, 0.1))
    call.receive(Received(ParamExtAck("CAM_ISO", encoded(200.0, 5), 5, 3), CAMERA, 0.9))
    assert call.next_deadline_s == pytest.approx(0.9 + ATTEMPT_S)


@given(st.sampled_from(range(1, 11)), st.integers(0, 100))
def test_numbers_come_back_in_every_type(kind: int, value: int) -> None:
    assert decoded(encoded(float(value), kind), kind) == value


@pytest.mark.parametrize(("value", "kind"), [(256.0, 1), (-1.0, 5), (0.5, 5), (1.0, 11), (float("nan"), 5)])
def test_numbers_that_a_type_does_not_hold_are_refused(value: float, kind: int) -> None:
    with pytest.raises(ValueError, match="does not fit the type"):
        encoded(value, kind)


def test_a_value_of_the_cameras_own_kind_is_no_number() -> None:
    assert decoded(b"fancy", 11) is None
    assert decoded(struct.pack("<f", 0.002), 9) == pytest.approx(0.002)


def flown(settings: CameraSettings) -> tuple[Flown, tuple[str, ...]]:
    """A short flight of the simulated vehicle, and what was noted about its camera."""
    model = single_panel()
    plan = plan_flight(model, PlanRequest(n_views=2, greedy=QUICK, profile_id="ardupilot")).plan
    done = fly_plan(obedient(plan, settings), model, FlightRequest())
    return done, tuple(note.text for sortie in done.sorties for note in sortie.notes if note.code == "camera")


@pytest.mark.slow
def test_the_simulated_vehicles_camera_is_set_before_take_off() -> None:
    done, (text,) = flown(MANUAL)
    assert text == ("the camera is set, and read back: manual exposure, 1/500 s, f/5.6, ISO 200, white balance for sun")
    assert done.error is None


@pytest.mark.slow
def test_what_the_camera_does_not_take_is_told_and_the_flight_goes_on() -> None:
    done, (text,) = flown(replace(MANUAL, shutter_s=1 / 777))
    assert "the camera does not take this, set it by hand: 1/777 s" in text
    assert done.error is None


def test_settings_are_put_into_words() -> None:
    settings = CameraSettings(compensation_ev=0.5, white_balance="auto")
    assert settings_text(wanted_settings(mission_with(settings))) == (
        "automatic exposure, exposure compensation +0.5 EV, automatic white balance"
    )


# A camera with a definition file of its own: other names, values that are numbers of options, other types

OTHER = b"""<?xml version="1.0"?>
<mavlinkcamera>
 <definition version="3"><model>Q7</model><vendor>Acme</vendor></definition>
 <parameters>
  <parameter name="EXP_MODE" type="uint8" default="0"><description>Exposure mode</description>
   <options><option name="Program" value="0"/><option name="Manual" value="3"/></options></parameter>
  <parameter name="SHUT" type="uint16" default="2"><description>Shutter speed of the mechanical shutter</description>
   <options><option name="1/60" value="1"/><option name="1/500 s" value="2"/><option name="1/1000" value="3"/></options>
  </parameter>
  <parameter name="CAM_ISO" type="int32" default="100"><description>ISO</description>
   <options><option name="ISO 100" value="1"/><option name="ISO 200" value="2"/></options></parameter>
  <parameter name="FNO" type="float" default="4" min="2.8" max="11"><description>Aperture</description></parameter>
  <parameter name="WB_MODE" type="int8" default="0"><description>White balance</description>
   <options><option name="Auto" value="0"/><option name="Daylight" value="-2"/></options></parameter>
  <parameter name="CAM_EV" type="float" readonly="1"><description>EV</description></parameter>
 </parameters>
</mavlinkcamera>
"""


def other_camera() -> CameraParameters:
    values = {"EXP_MODE": 0, "SHUT": 1, "CAM_ISO": 1, "FNO": 4.0, "WB_MODE": 0}
    kinds = {"EXP_MODE": 1, "SHUT": 3, "CAM_ISO": 6, "WB_MODE": 2}
    return CameraParameters(dict(values), OTHER, takes_all=True, kinds=kinds)


def test_a_definition_says_what_the_camera_calls_it() -> None:
    found = wanted_settings(mission_with(MANUAL), parse_definition(OTHER, "camera"))
    assert [(each.name, each.value) for each in found] == [
        ("EXP_MODE", 3.0), ("SHUT", 2.0), ("FNO", 5.6), ("CAM_ISO", 2.0), ("WB_MODE", -2.0),
    ]  # fmt: skip
    odd = replace(MANUAL, shutter_s=1 / 777, white_balance="cloudy")
    by_name = {each.name: each.value for each in wanted_settings(mission_with(odd), parse_definition(OTHER, "camera"))}
    assert by_name["SHUT"] is None
    assert by_name["WB_MODE"] is None
    automatic = wanted_settings(mission_with(CameraSettings(compensation_ev=1.0)), parse_definition(OTHER, "camera"))
    assert [(each.name, each.value) for each in automatic] == [("EXP_MODE", 0.0), ("", None)], "EV is to be read only"


RANGED = OTHER.replace(
    b" <parameters>",
    b""" <parameters><parameter name="CAM_MODE" type="uint8" default="1"><options><option name="Photo" value="0"/>
   <option name="Video" value="1"><parameterranges><parameterrange parameter="CAM_ISO" condition="EXP_MODE=3">
    <roption name="ISO 100" value="1"/></parameterrange></parameterranges></option></options></parameter>""",
)
"""Its ISO 200 is for photos alone, as long as the exposure is manual."""


def test_a_value_that_the_mode_does_not_allow_is_not_set() -> None:
    ranged, mission = parse_definition(RANGED, "camera"), mission_with(MANUAL)

    def iso(**values: float) -> float | None:
        return {each.name: each.value for each in wanted_settings(mission, ranged, values)}["CAM_ISO"]

    assert iso() is None, "made for video, and nobody has asked the camera"
    assert iso(CAM_MODE=1.0) is None
    assert iso(CAM_MODE=0.0) == 2.0
    assert ranged.rulers_of(["CAM_ISO"]) == ("CAM_MODE", "EXP_MODE")


@pytest.mark.few(1)
@pytest.mark.parametrize(("mode", "iso"), [(0, 2), (1, 1)])
def test_in_a_flight_the_camera_is_asked_for_its_mode_before_it_is_set(mode: int, iso: int) -> None:
    camera = other_camera()
    camera.definition, camera.uri = RANGED, "mftp:///camera/definition.xml"
    camera.values["CAM_MODE"], camera.kinds["CAM_MODE"] = mode, 1
    told = prepared(camera)[-1]
    assert camera.values["CAM_ISO"] == iso
    assert ("the camera does not take this, set it by hand: ISO 200" in told) == (mode == 1)
    assert camera.values["SHUT"] == 2


@pytest.mark.few(1)
@pytest.mark.parametrize("uri", ["mftp:///camera/definition.xml", "mftp://[;comp=1]/camera/definition.xml"])
def test_in_a_flight_the_definition_is_fetched_and_the_camera_set_by_it(uri: str) -> None:
    camera = other_camera()
    camera.uri = uri
    notes = prepared(camera)
    assert camera.values == {"EXP_MODE": 3, "SHUT": 2, "CAM_ISO": 2, "FNO": pytest.approx(5.6), "WB_MODE": -2}
    assert notes == [
        "the camera's definition was fetched (Acme Q7): 6 parameters",
        "the camera is set, and read back: manual exposure, 1/500 s, f/5.6, ISO 200, white balance for sun",
    ]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("uri", "definition", "told"),
    [
        ("https://acme.example/q7.xml", OTHER, "is not on board (https://acme.example/q7.xml); name its file"),
        ("mftp:///camera/other.xml", OTHER, "could not be fetched (refused)"),
        ("mftp:///camera/definition.xml", b"<mavlinkcamera", "is not taken"),
        ("mftp:///camera/definition.xml", b" " * (2 << 20), "could not be fetched (refused)"),
    ],
)
def test_without_a_definition_that_is_one_the_standard_names_are_tried(uri: str, definition: bytes, told: str) -> None:
    camera = CameraParameters(definition=definition, uri=uri)
    notes = prepared(camera)
    assert told in notes[0]
    assert notes[1].startswith("the camera is set, and read back: manual exposure")
    assert camera.values["CAM_SHUTTERSPD"] == pytest.approx(1 / 500)


def prepared(camera: CameraParameters) -> list[str]:
    """What is noted of the camera before take-off."""
    model = single_panel()
    plan = obedient(plan_flight(model, PlanRequest(n_views=2, greedy=QUICK, profile_id="ardupilot")).plan, MANUAL)
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    orders = sortie_orders(plan, model, mission)
    vehicle = SimulatedVehicle(
        Autopilot.ARDUPILOT, PointMass(), model.site.origin, model.site.home_enu_m, camera=camera
    )
    link = DirectLink(vehicle)
    run = FlightRun(orders, RunOptions(sets_parameters=True, starts_itself=False), "simulation")

    def show(view: RunView) -> None:
        if view.on_board.camera is not None:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        conduct(run, link, link.clock, show=show)
    return [note.text for note in run.notes if note.code == "camera"]
