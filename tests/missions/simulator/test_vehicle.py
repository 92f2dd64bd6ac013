"""Whole flights of our own missions, on the real airframe: photos = views, and the same flight again and again."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import mission_items
from missions.mavlink.messages import (
    Address,
    CameraFeedback,
    CameraImageCaptured,
    CommandInt,
    CommandLong,
    Heartbeat,
    Message,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionItem,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    MissionRequestList,
    MissionSetCurrent,
    ParamRequestList,
    ParamRequestRead,
    ParamSet,
    Received,
    RequestDataStream,
    SetMode,
    Timesync,
)
from missions.mavlink.wire import Encoder
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.mission.model import Mission
from missions.simulator.autopilot.instruments import camera_quaternion
from missions.simulator.autopilot.mission_store import Refused, stored
from missions.simulator.build import make_airframe
from missions.simulator.vehicle import CONTROL_STEP_S, SimulatedVehicle
from planning.geo.frames import camera_axes
from planning.parameters import GreedyParameters
from planning.plan import Plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.missions.plans import example_plan, plans
from tests.missions.simulator.flying import bundled
from tests.missions.simulator.ground import ARDUPILOT, ORIGIN, PX4, Ground, PointMass, at, item, planned
from tests.slow import slow


@cache
def planned_office() -> Plan:
    """A plan of the office as our planner makes it."""
    few = GreedyParameters(n_candidates=2000, improve=False, certify=False)
    return plan_flight(SCENES["office"](), PlanRequest(n_views=12, greedy=few, time_budget_s=5.0)).plan


PARAMETERS = {ARDUPILOT: {"WP_YAW_BEHAVIOR": 0, "MNT1_PITCH_MAX": 35.0, "MNT1_PITCH_MIN": -90.0}, PX4: {}}


def fly(
    plan: Plan, mission: Mission, autopilot: Autopilot, airframe=None, reference=HeightReference.ABOVE_TAKEOFF, **kwargs
):
    ground = Ground(
        autopilot,
        PARAMETERS[autopilot],
        PointMass(plan.home_enu_m) if airframe is None else airframe,
        origin=mission.origin,
        home_enu_m=plan.home_enu_m,
        **kwargs,
    )
    ground.fly(planned(mission_items(mission, autopilot, reference)), 7200.0)
    return ground


def check_photos(ground: Ground, plan: Plan, mission: Mission, position_m: float, angle_deg: float) -> None:
    views = {view.id: view for view in plan.viewpoints}
    wanted = [views[photo.viewpoint_id] for waypoint in mission.waypoints for photo in waypoint.photos]
    shots = ground.vehicle.shots
    assert len(shots) == len(wanted)
    for shot, view in zip(shots, wanted, strict=True):
        pose = shot.pose
        assert math.dist(pose.position_enu_m, view.position_enu_m) <= position_m
        assert abs(math.remainder(math.degrees(pose.gimbal_heading_rad) - view.heading_deg, 360.0)) <= angle_deg
        assert abs(math.degrees(pose.gimbal_pitch_rad) - view.gimbal_pitch_deg) <= angle_deg
        assert math.hypot(*pose.velocity_enu_m_s) <= 0.2
    told = ground.of(CameraFeedback if ground.vehicle.autopilot is ARDUPILOT else CameraImageCaptured)
    assert len(told) == len(wanted)
    assert ground.vehicle.scheduler.n_dropped == ground.vehicle.camera.n_lost == 0


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
@pytest.mark.parametrize("scene", ["office", "court"])
def test_views_of_a_site_are_photographed_one_by_one(autopilot: Autopilot, scene: str) -> None:
    model, plan = bundled(scene)
    (mission,) = missions_from_plan(plan)
    airframe, _ = make_airframe(plan, model, plan.sorties[0])
    ground = fly(plan, mission, autopilot, airframe)
    # Effects that the scene calls for may move it; what must hold in the end is 0.5 m, 3 deg, 2 deg.
    check_photos(ground, plan, mission, 0.5, 2.0)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, slow(PX4)])
def test_planned_office_is_flown_with_as_many_photos_as_views(autopilot: Autopilot) -> None:
    model = SCENES["office"]()
    plan = planned_office()
    for mission, sortie in zip(missions_from_plan(plan), plan.sorties, strict=True):
        airframe, _ = make_airframe(plan, model, sortie, settings=None)
        check_photos(fly(plan, mission, autopilot, airframe), plan, mission, 0.5, 2.0)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
@pytest.mark.parametrize("reference", [HeightReference.ABOVE_TAKEOFF, HeightReference.AMSL])
def test_heights_above_sea_and_above_home_lead_to_the_same_places(autopilot, reference) -> None:
    plan = example_plan()
    for mission in missions_from_plan(plan):
        check_photos(fly(plan, mission, autopilot, reference=reference), plan, mission, 0.05, 0.1)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow(ARDUPILOT), PX4])
@given(plan=plans())
@settings(max_examples=3)
def test_plans_anywhere_on_the_globe_are_flown_with_every_photo(autopilot: Autopilot, plan: Plan) -> None:
    for mission in missions_from_plan(plan):
        check_photos(fly(plan, mission, autopilot), plan, mission, 0.35, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_same_flight_says_the_same_bit_for_bit(autopilot: Autopilot) -> None:
    model, plan = bundled("office", 4)
    (mission,) = missions_from_plan(plan)
    heard = []
    for _ in range(2):
        airframe, _ = make_airframe(plan, model, plan.sorties[0], seed=5)
        ground = fly(plan, mission, autopilot, airframe)
        heard.append([(repr(each.message), each.time_s) for each in ground.heard])
    assert heard[0] == heard[1]
    assert len(heard[0]) > 1000


def test_steps_of_any_length_add_up() -> None:
    """What is left over of a step is flown with the next; one long step says what many short ones say."""
    said = []
    for pieces in ([10.0], [0.013] * 769 + [0.003], [3.7, 0.0001, 6.2999]):
        vehicle = SimulatedVehicle(ARDUPILOT, PointMass(), ORIGIN, is_ready=True)
        said.append([message for piece in pieces for message in vehicle.step(piece)])
        assert vehicle.now_s == pytest.approx(52.0, abs=CONTROL_STEP_S)
    assert said[0] == said[1] == said[2]


@pytest.mark.parametrize("duration_s", [-1.0, math.nan, math.inf])
def test_steps_that_are_no_duration_are_wrong_calls(duration_s: float) -> None:
    with pytest.raises(ValueError, match="duration_s"):
        SimulatedVehicle(ARDUPILOT, PointMass(), ORIGIN).step(duration_s)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_control_step_changes_photos_by_less_than_a_centimetre(autopilot: Autopilot) -> None:
    """What accuracy costs: ten times the decisions move no photo by more than the aircraft sways in still air."""
    model, plan = bundled("office", 5)
    (mission,) = missions_from_plan(plan)
    flights = []
    for step_s in (0.002, CONTROL_STEP_S):
        airframe, _ = make_airframe(plan, model, plan.sorties[0])
        flights.append(fly(plan, mission, autopilot, airframe, control_step_s=step_s))
    fine, usual = (ground.vehicle.shots for ground in flights)
    moved_m = [math.dist(a.pose.position_enu_m, b.pose.position_enu_m) for a, b in zip(fine, usual, strict=True)]
    assert max(moved_m) < 0.01
    times = [ground.vehicle.now_s for ground in flights]
    assert times[1] == pytest.approx(times[0], rel=0.005)


def test_camera_quaternion_turns_its_axes_as_planning_has_them() -> None:
    rng = np.random.default_rng(3)
    for heading, pitch in rng.uniform([-math.pi, -1.5], [math.pi, 1.5], (20, 2)):
        w, x, y, z = camera_quaternion(heading, pitch)
        rotation = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        enu_from_ned = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
        forward, right, up = camera_axes(heading, pitch)
        np.testing.assert_allclose(enu_from_ned @ rotation, np.stack([forward, right, -up], axis=1), atol=1e-12)


def test_second_flight_of_one_vehicle_starts_the_mission_anew() -> None:
    mission = [
        at(22, 0, 0, 20),
        item(178, 1, 2),
        at(16, 20, 0, 20, 2),
        item(203, 0, 0, 0, 0, 1),
        item(93, 1),
        at(21, 0, 0, 0),
    ]
    ground = Ground(ARDUPILOT, PARAMETERS[ARDUPILOT])
    ground.fly(mission)
    first_s, start_s = ground.vehicle.now_s - 42.0, ground.vehicle.now_s
    ground.take_off_with_mission()
    ground.until(lambda: not ground.vehicle.modes.is_armed)
    assert len(ground.vehicle.shots) == 2
    assert ground.vehicle.now_s - start_s == pytest.approx(first_s, abs=1.0)


class Swaying(PointMass):
    """Never quite still: sways by 0.25 m at 0.4 m/s."""

    @property
    def truth(self):
        pose, angle = super().truth, 1.6 * self.time_s
        if not self.position[2] > self.ground_z:
            return pose
        (x, y, z), (vx, vy, vz) = pose.position_enu_m, pose.velocity_enu_m_s
        sway, rate = 0.25 * math.sin(angle), 0.4 * math.cos(angle)
        return replace(pose, position_enu_m=(x + sway, y, z), velocity_enu_m_s=(vx + rate, vy, vz))

    estimate = truth


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_aircraft_that_sways_in_gusts_still_finishes_its_mission(autopilot: Autopilot) -> None:
    plan = example_plan()
    mission = missions_from_plan(plan)[0]
    ground = fly(plan, mission, autopilot, Swaying(plan.home_enu_m))
    assert len(ground.vehicle.shots) == mission.n_photos
    still = fly(plan, mission, autopilot)
    assert ground.vehicle.now_s <= still.vehicle.now_s + 6.0 * len(mission.waypoints) + 20.0


FIELD = {
    "int": st.one_of(st.integers(0, 255), st.integers(-(2**31), 2**31 - 1)),
    "float": st.one_of(st.floats(width=32), st.floats(-10, 10, width=32)),
    "str": st.sampled_from(("WP_YAW_BEHAVIOR", "GF_ACTION", "WPNAV_SPEED", "ATC_SLEW_YAW", "")),
}
SENT_BY_GROUND = (
    CommandLong, CommandInt, SetMode, ParamSet, ParamRequestRead, ParamRequestList, RequestDataStream, Timesync,
    MissionCount, MissionItemInt, MissionItem, MissionRequest, MissionRequestInt, MissionRequestList, MissionClearAll,
    MissionSetCurrent, MissionAck, Heartbeat,
)  # fmt: skip
COMMANDS = st.sampled_from(
    (16, 17, 18, 19, 20, 21, 22, 31, 82, 84, 92, 93, 112, 114, 115, 176, 177, 178, 179, 192, 193, 201, 203, 205, 206,
     224, 300, 400, 511, 512, 520, 1000, 1001, 2000, 2001, 5001, 5004, 5100)
)  # fmt: skip


@st.composite
def ground_messages(draw: st.DrawFn) -> Message:
    kind = draw(st.sampled_from(SENT_BY_GROUND))
    values = {name: draw(FIELD[field.type]) for name, field in kind.__dataclass_fields__.items()}
    for name in values.keys() & {"target_system", "target_component"}:
        values[name] = 1
    if "command" in values:
        values["command"] = draw(COMMANDS)
    for name in values.keys() & {"count", "seq", "mission_type"}:
        values[name] = draw(st.integers(0, 4))
    return kind(**values)


def real_vehicle(autopilot: Autopilot) -> SimulatedVehicle:
    model, plan = bundled("office", 4)
    airframe, _ = make_airframe(plan, model, plan.sorties[0])
    return SimulatedVehicle(autopilot, airframe, ORIGIN, is_ready=True)


def check_said(vehicle: SimulatedVehicle, said: list[Message]) -> None:
    """Everything fits on the wire, and the vehicle is somewhere."""
    encoder = Encoder(vehicle.address)
    for message in said:
        encoder.encode(message)
    assert all(math.isfinite(value) for value in vehicle.airframe.truth.position_enu_m)


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
@given(messages=st.lists(ground_messages(), max_size=60))
@settings(max_examples=20)
def test_whatever_is_sent_the_vehicle_answers_what_fits_on_the_wire_and_stays_somewhere(autopilot, messages) -> None:
    vehicle = real_vehicle(autopilot)
    said = vehicle.receive(Received(CommandLong(1, 1, 400, 1, 21196), Address(255, 190), 0.0))
    for message in messages:
        said += vehicle.receive(Received(message, Address(255, 190), 0.0))
        said += vehicle.step(0.1)
    said += vehicle.step(5.0)
    check_said(vehicle, said)


numbers = st.one_of(st.floats(-5, 200, width=32), st.sampled_from((0.0, 1.0, -1.0, math.nan, math.inf, 3e38)))


@st.composite
def odd_items(draw: st.DrawFn) -> MissionItemInt:
    """Items near and far, of numbers good and bad."""
    command, p = draw(COMMANDS), [draw(numbers) for _ in range(4)]
    if draw(st.booleans()):
        east, north = draw(st.floats(-200, 200)), draw(st.floats(-200, 200))
        return replace(
            at(command, east, north, draw(st.floats(-50, 150)), *p), frame=draw(st.sampled_from((0, 2, 3, 6)))
        )
    whole = st.one_of(st.integers(-3, 3), st.integers(-(2**31), 2**31 - 1))
    frame = draw(st.sampled_from((0, 2, 3, 6, 10)))
    return MissionItemInt(1, 1, 0, frame, command, 0, 1, *p, draw(whole), draw(whole), draw(numbers))


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [ARDUPILOT, slow(PX4)])
@given(odd=st.lists(odd_items(), min_size=1, max_size=12))
@settings(max_examples=12, phases=(Phase.explicit, Phase.generate))
def test_missions_of_odd_items_are_flown_or_refused_without_a_crash(autopilot: Autopilot, odd) -> None:
    kept = []
    for each in odd:
        try:
            stored(each, autopilot)
        except Refused:
            continue
        kept.append(each)
    vehicle = real_vehicle(autopilot)
    ground = Ground(autopilot, airframe=vehicle.airframe)
    assert ground.upload([at(22, 0, -45, 20), *kept]) == 0
    if autopilot is ARDUPILOT:
        assert [ground.command(176, 1, 4), ground.command(400, 1, 21196), ground.command(176, 1, 3)] == [0, 0, 0]
    ground.command(300)
    end_s = ground.vehicle.now_s + 40.0
    ground.until(lambda: ground.vehicle.now_s > end_s or not ground.vehicle.modes.is_armed)
    check_said(ground.vehicle, [each.message for each in ground.heard])
