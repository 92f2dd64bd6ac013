"""MAVSDK's client flies a whole mission of ours on the simulated vehicle: upload, arm, start, land, disarm."""

from __future__ import annotations

import queue
from typing import Any

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import mission_items
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.simulator.vehicle import SimulatedVehicle
from tests.missions.mavlink.transfer.fake_vehicle import ARDUPILOT, PX4
from tests.missions.plans import make_plan, ring
from tests.missions.simulator.ground import PointMass
from tests.slow import slow

mavsdk = pytest.importorskip("mavsdk", reason="MAVSDK is not installed")
action = pytest.importorskip("mavsdk.plugins.action")
mission_raw = pytest.importorskip("mavsdk.plugins.mission_raw")
telemetry = pytest.importorskip("mavsdk.plugins.telemetry")

from tests.missions.mavlink.test_mavsdk_transfer import WAIT_S, served, software, theirs  # noqa: E402

FLIGHT_S = 240.0
"""Of real time; the flight itself takes three minutes, 50 times as fast."""


def heard(changes: queue.SimpleQueue[Any], wanted: Any) -> list[Any]:
    """What was told until the wanted value came."""
    told = [changes.get(timeout=FLIGHT_S)]
    while told[-1] != wanted:
        told.append(changes.get(timeout=FLIGHT_S))
    return told


@pytest.mark.long
@pytest.mark.parametrize("autopilot", [ARDUPILOT, slow(PX4)])
def test_mavsdks_client_flies_our_mission_to_the_end_on_our_vehicle(autopilot: Autopilot) -> None:
    plan = make_plan([(ring(4), {})])
    (mission,) = missions_from_plan(plan)
    items = to_wire(mission_items(mission, autopilot, HeightReference.ABOVE_TAKEOFF), autopilot)
    airframe = PointMass(plan.home_enu_m)
    vehicle = SimulatedVehicle(autopilot, airframe, mission.origin, plan.home_enu_m, is_ready=True)
    armed: queue.SimpleQueue[bool] = queue.SimpleQueue()
    landed: queue.SimpleQueue[Any] = queue.SimpleQueue()
    progress: queue.SimpleQueue[int] = queue.SimpleQueue()
    with served(vehicle, "tcpin", 50.0) as url, software(mavsdk.ComponentType.GROUND_STATION, url) as sdk:
        system = sdk.first_autopilot(WAIT_S)
        assert system is not None
        pilot, raw, eyes = action.Action(system), mission_raw.MissionRaw(system), telemetry.Telemetry(system)
        eyes.subscribe_armed(lambda is_armed, _: armed.put(is_armed))
        eyes.subscribe_landed_state(lambda state, _: landed.put(state))
        raw.subscribe_mission_progress(lambda now, _: progress.put(now.current))
        assert raw.upload_mission(theirs(items, MissionType.MISSION)) == mission_raw.MissionRawResult.SUCCESS
        assert pilot.arm() == action.ActionResult.SUCCESS
        heard(armed, True)
        assert raw.start_mission() == mission_raw.MissionRawResult.SUCCESS
        heard(landed, telemetry.LandedState.IN_AIR)
        heard(landed, telemetry.LandedState.ON_GROUND)
        heard(armed, False)
    told = [progress.get() for _ in range(progress.qsize())]
    # After the landing both autopilots stand at the mission's beginning again.
    to_the_end = told[: told.index(len(items) - 1) + 1]
    assert to_the_end == sorted(to_the_end)
    assert len(vehicle.shots) == len(plan.viewpoints)
