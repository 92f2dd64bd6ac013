"""MAVSDK as the judge: its client against the simulated vehicle, and our client against its mission server.

Over real sockets of this machine, on ports that are free.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import FenceCircle, FencePolygon, fence_items, rally_items
from missions.mavlink.link import GROUND_HEARTBEAT, ChannelLink, drive, open_link
from missions.mavlink.messages import Heartbeat, MissionItemInt
from missions.mavlink.plan_json import plan_json_bytes
from missions.mavlink.transfer.exchange import Download, Ending, MissionType, Route
from missions.mavlink.transfer.verified import Upload
from missions.mavlink.transfer.wire_items import compare, to_wire
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.mission.model import GeoPoint
from missions.simulator.server import serve
from missions.simulator.vehicle import SimulatedVehicle
from tests.missions.mavlink.transfer.fake_vehicle import ARDUPILOT, PX4
from tests.missions.mavlink.transfer.test_simulated_vehicle import planned
from tests.missions.plans import example_plan
from tests.missions.simulator.ground import ORIGIN, PointMass
from tests.slow import slow

mavsdk = pytest.importorskip("mavsdk", reason="MAVSDK is not installed")
mission_raw = pytest.importorskip("mavsdk.plugins.mission_raw")
mission_raw_server = pytest.importorskip("mavsdk.plugins.mission_raw_server")

WAIT_S = 120.0
FENCES = (FencePolygon(((22.1, 114.1), (22.2, 114.1), (22.2, 114.2)), False), FenceCircle(22.3, 114.3, 42.5, True))
RALLY = rally_items((GeoPoint(22.31, 114.21, 85.0),), GeoPoint(22.3, 114.2, 60.0))


@contextmanager
def software(component: Any, url: str) -> Iterator[Any]:
    sdk = mavsdk.Mavsdk(mavsdk.Configuration.create_with_component_type(component))
    try:
        assert sdk.add_any_connection(url) == mavsdk.ConnectionResult.SUCCESS
        yield sdk
    finally:
        sdk.destroy()


def standing(autopilot: Autopilot) -> SimulatedVehicle:
    return SimulatedVehicle(autopilot, PointMass(), ORIGIN, is_ready=True)


@contextmanager
def served(vehicle: SimulatedVehicle, kind: str, speedup: float = 1.0) -> Iterator[str]:
    """A simulated vehicle on a socket: the address for MAVSDK."""
    is_over = threading.Event()
    with closing(open_link(f"{kind}:127.0.0.1:0", vehicle.address)) as link:
        server = threading.Thread(target=serve, args=(vehicle, [link], speedup, is_over.is_set))
        server.start()
        port = link.channel.port  # type: ignore[attr-defined]
        try:
            yield f"udpout://127.0.0.1:{port}" if kind == "udp" else f"tcpout://127.0.0.1:{port}"
        finally:
            is_over.set()
            server.join()


def theirs(items: tuple[MissionItemInt, ...], kind: MissionType) -> list[Any]:
    return [
        mission_raw.MissionItem(
            seq, item.frame, item.command, int(seq == 0), 1, item.param1, item.param2, item.param3, item.param4,
            item.x, item.y, item.z, kind,
        )
        for seq, item in enumerate(items)
    ]  # fmt: skip


def ours(items: list[Any]) -> tuple[MissionItemInt, ...]:
    names = [name for name in MissionItemInt.__dataclass_fields__ if not name.startswith("target")]
    return tuple(MissionItemInt(1, 1, **{name: getattr(item, name) for name in names}) for item in items)


@pytest.mark.long
@pytest.mark.parametrize(
    ("autopilot", "kind"), [(ARDUPILOT, "udp"), (PX4, "tcpin"), slow(ARDUPILOT, "tcpin"), slow(PX4, "udp")]
)
def test_mavsdks_client_uploads_to_our_vehicle_and_reads_back_the_same(autopilot: Autopilot, kind: str) -> None:
    lists = {
        MissionType.MISSION: to_wire(planned(autopilot, 60), autopilot),
        MissionType.FENCE: to_wire(fence_items(FENCES), autopilot, MissionType.FENCE),
        MissionType.RALLY: to_wire(RALLY, autopilot, MissionType.RALLY),
    }
    vehicle = standing(autopilot)
    with served(vehicle, kind) as url, software(mavsdk.ComponentType.GROUND_STATION, url) as sdk:
        system = sdk.first_autopilot(WAIT_S)
        assert system is not None
        plugin = mission_raw.MissionRaw(system)
        ways = {
            MissionType.MISSION: (plugin.upload_mission, plugin.download_mission),
            MissionType.FENCE: (plugin.upload_geofence, plugin.download_geofence),
            MissionType.RALLY: (plugin.upload_rally_points, plugin.download_rallypoints),
        }
        for mission_type, (upload, download) in ways.items():
            items = lists[mission_type]
            assert upload(theirs(items, mission_type)) == mission_raw.MissionRawResult.SUCCESS
            assert compare(items, ours(download()), autopilot, mission_type) == ()
        assert len(vehicle.stores.mission) == len(lists[MissionType.MISSION])
        assert plugin.clear_mission() == mission_raw.MissionRawResult.SUCCESS
        # For ArduPilot MAVSDK clears by uploading nothing but a home.
        assert len(vehicle.stores.mission) == (autopilot is ARDUPILOT)


@pytest.mark.long
@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_what_mavsdk_uploaded_our_client_reads_and_the_other_way_round(autopilot: Autopilot) -> None:
    items = to_wire(planned(autopilot, 40), autopilot)
    vehicle = standing(autopilot)
    with served(vehicle, "tcpin") as url, software(mavsdk.ComponentType.GROUND_STATION, url) as sdk:
        system = sdk.first_autopilot(WAIT_S)
        assert system is not None
        plugin = mission_raw.MissionRaw(system)
        plugin.upload_mission(theirs(items[:20], MissionType.MISSION))
        with closing(open_link(url.replace("tcpout://", "tcp:"))) as link:
            route = Route(link.address, vehicle.address)
            read = drive(Download(route), link, time.perf_counter)
            assert read.ending is Ending.DONE
            assert compare(items[:20], read.items, autopilot) == ()
            assert drive(Upload(route, items), link, time.perf_counter).ending is Ending.DONE
        assert compare(items, ours(plugin.download_mission()), autopilot) == ()


def test_mavsdk_reads_the_fences_of_our_plan_as_the_items_that_we_upload(tmp_path: Path) -> None:
    home = missions_from_plan(example_plan())[0].takeoff
    polygons = (((22.1, 114.1), (22.2, 114.1), (22.2, 114.2)), ((22.3, 114.3), (22.4, 114.3), (22.4, 114.4)))
    path = tmp_path / "m.plan"
    path.write_bytes(plan_json_bytes(planned(PX4), home, PX4, 5.0, HeightReference.ABOVE_TAKEOFF, polygons))
    with served(standing(PX4), "udp") as url, software(mavsdk.ComponentType.GROUND_STATION, url) as sdk:
        system = sdk.first_autopilot(WAIT_S)
        assert system is not None
        read = mission_raw.MissionRaw(system).import_qgroundcontrol_mission(str(path)).geofence_items
    items = to_wire(fence_items([FencePolygon(corners, False) for corners in polygons]), PX4, MissionType.FENCE)
    assert compare(items, ours(read), PX4, MissionType.FENCE) == ()


def heard(link: ChannelLink) -> Route:
    """Way to the first vehicle that shows up."""
    deadline_s = time.perf_counter() + WAIT_S
    while time.perf_counter() < deadline_s:
        link.send(GROUND_HEARTBEAT)
        received = link.receive(0.2)
        if received is not None and isinstance(received.message, Heartbeat):
            return Route(link.address, received.source)
    raise AssertionError("MAVSDK's server sent no heartbeat")


def test_our_client_uploads_to_mavsdks_server_item_by_item() -> None:
    items = to_wire(planned(PX4, 200), PX4)
    with closing(open_link("udp:127.0.0.1:0")) as link:
        port = link.channel.port  # type: ignore[attr-defined]
        with software(mavsdk.ComponentType.AUTOPILOT, f"udpout://127.0.0.1:{port}") as sdk:
            component = sdk.server_component()
            server = mission_raw_server.MissionRawServer(component)
            arrived: list[tuple[Any, Any]] = []
            is_there = threading.Event()

            def take(result: Any, plan: Any, _: Any) -> None:
                arrived.append((result, plan))
                is_there.set()

            handle = server.subscribe_incoming_mission(take)
            outcome = drive(Upload(heard(link), items), link, time.perf_counter)
            assert outcome.ending is Ending.DONE
            assert is_there.wait(WAIT_S)
            server.unsubscribe_incoming_mission(handle)
            ((result, plan),) = arrived
            assert result == mission_raw_server.MissionRawServerResult.SUCCESS
            assert [item.seq for item in plan.mission_items] == list(range(200))
            assert compare(items, ours(plan.mission_items), PX4) == ()
