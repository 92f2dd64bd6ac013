"""Geo-zones go up with the fence: those that apply then, read back from the simulated vehicle as they were sent."""

from datetime import timedelta

import pytest
import shapely

from groundstation.vehicle.orders import fence_messages, sortie_orders
from groundstation.vehicle.preflight import OnBoard, Verdict, preflight_checks
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions
from groundstation.vehicle.state import VehicleState
from missions.formats.encode import encode_mavlink
from missions.formats.options import ExportOptions
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import drive
from missions.mavlink.plan_json import read_plan_json
from missions.mavlink.transfer.exchange import Download, MissionType, Route
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat
from missions.simulator.autopilot.failsafe import fence_zones
from missions.simulator.build import make_airframe
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.geo.enu import enu_from_geodetic
from planning.site.zones.keep_out import at_time
from tests.planning.site.zones.zone_files import (
    ORIGIN,
    ed269,
    ed269_feature,
    ed269_volume,
    lon_lat,
    polygon,
    square,
    with_zones,
)
from tests.planning.test_zones_of_flights import NIGHT, NOON, flight
from tests.slow import slow

SCHOOL = ed269_feature(ed269_volume(polygon(square(60.0, -60.0, 10.0))), identifier="SCHOOL")
AT_NIGHT = ed269_feature(ed269_volume(polygon(square(-60.0, -60.0, 10.0))), identifier="NIGHT", applicability=NIGHT)
CIRCLE = {"type": "Circle", "center": lon_lat([(-680.0, 0.0)], ORIGIN)[0], "radius": 600}
HELIPORT = ed269_feature(ed269_volume(CIRCLE), identifier="HELI", restriction="REQ_AUTHORISATION")
SHELF = ed269_feature(
    ed269_volume(polygon(square(0.0, 0.0, 300.0)), lower=150, upper=500), identifier="SHELF", name="Control zone"
)

SURROUNDINGS = shapely.box(-1100.0, -1100.0, 1100.0, 1100.0)
"""What is looked at around the airspace."""

ZONES = ed269(SCHOOL, AT_NIGHT, HELIPORT, SHELF)


def orders_of(at=NOON, content=ZONES, **permitted):
    model, plan = at_time(with_zones(content, **permitted), at, 600.0), flight()
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    return model, plan, sortie_orders(plan, model, mission)


def areas(fences):
    """Polygons in the site's frame."""
    found = []
    for corners in fences:
        lat, lon = zip(*corners, strict=True)
        places = enu_from_geodetic(ORIGIN, list(lat), list(lon), [ORIGIN.ellipsoid_height_m] * len(lat))
        found.append(shapely.Polygon(places[:, :2]))
    return found


@pytest.mark.long
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
def test_zones_of_the_time_come_back_from_the_vehicle_as_they_were_sent(autopilot):
    model, plan, orders = orders_of()
    airframe, _ = make_airframe(plan, model, plan.sorties[0], seed=1)
    vehicle = SimulatedVehicle(autopilot, airframe, model.site.origin, model.site.home_enu_m)
    link = DirectLink(vehicle)
    run = FlightRun(orders, RunOptions(sets_parameters=True), "simulation")
    outcome = conduct(run, link, link.clock)
    assert outcome.succeeded, outcome.message
    link = DirectLink(vehicle)
    read = drive(Download(Route(link.address, vehicle.address, MissionType.FENCE)), link, link.clock)
    sent = fence_messages(orders.fences[autopilot], autopilot)
    assert [(item.command, item.param1, item.x, item.y) for item in read.items] == [
        (item.command, item.param1, item.x, item.y) for item in sent
    ]
    on_board = []
    items = list(read.items)
    while items:
        n = int(items[0].param1)
        on_board.append(tuple((item.x / 1e7, item.y / 1e7) for item in items[:n]))
        items = items[n:]
    school, heliport = sorted(areas(on_board), key=lambda area: area.area)
    assert school.hausdorff_distance(shapely.box(50.0, -70.0, 70.0, -50.0)) < 0.2
    assert heliport.buffer(0.1).covers(shapely.Point(-680.0, 0.0).buffer(599.5, 64).intersection(SURROUNDINGS))
    assert heliport.area < 1.05 * shapely.Point(-680.0, 0.0).buffer(600.0, 64).intersection(SURROUNDINGS).area
    # The simulated vehicle judges by what it holds, not by what this program knows.
    zones = fence_zones(vehicle.stores.fence.items, vehicle.place)
    assert [zone.holds(60.0, -60.0) for zone in zones].count(True) == 1
    assert [zone.holds(-680.0, 599.0) for zone in zones].count(True) == 1
    assert not any(zone.holds(x, y) for zone in zones for x, y, _ in plan.sorties[0].path_enu_m)
    assert not any(zone.holds(-60.0, -60.0) for zone in zones), "that of the night"


@pytest.mark.long
def test_only_zones_that_apply_then_and_that_are_not_permitted_go_up():
    def n_polygons(at, **permitted):
        return len(orders_of(at, **permitted)[2].fences[Autopilot.PX4])

    assert n_polygons(NOON) == 2
    assert n_polygons(NOON + timedelta(hours=10)) == 3
    assert n_polygons(None) == 3, "where no time is known, what may apply counts"
    assert n_polygons(NOON, HELI="No. 4711") == 1


def test_what_the_fence_cannot_say_stands_in_the_list_before_take_off():
    _, _, orders = orders_of()
    state = VehicleState(autopilot=Autopilot.PX4)
    checks = preflight_checks(state, orders, OnBoard(), 0.0, needs_rtk=False)
    (gap,) = (check for check in checks if check.code == "fence-gaps")
    assert gap.verdict is Verdict.WARN
    assert gap.text.startswith("SHELF: the mission passes over or under this zone")
    (shape,) = (check for check in checks if check.code == "fence-shape")
    assert shape.verdict is Verdict.OK
    assert shape.text.startswith("HELI: the fence of PX4 has room for 64 corners")
    crowd = [
        ed269_feature(ed269_volume(polygon(square(40.0 * n, 0.0, 15.0)), lower=150), identifier=f"S{n}")
        for n in range(-2, 3)
    ]
    shelves = preflight_checks(state, orders_of(content=ed269(*crowd))[2], OnBoard(), 0.0, needs_rtk=False)
    told = " ".join(check.text for check in shelves if check.code == "fence-gaps")
    assert 1 <= told.count("the mission passes") <= 3
    assert not [check for check in shelves if check.code == "geofence"] or "S" in told


def test_a_plan_file_has_the_zones_in_its_fence_and_other_files_say_that_they_have_none(tmp_path):
    model, _, orders = orders_of()
    options = ExportOptions(autopilot=Autopilot.PX4, site=model)
    encoded = encode_mavlink([orders.mission], FileFormat.MAVLINK_PLAN, options)
    (tmp_path / "m.plan").write_bytes(encoded.contents[0])
    assert read_plan_json(tmp_path / "m.plan").fences == orders.fences[Autopilot.PX4]
    assert {"zone-not-fenced", "zone-fence-coarse"} <= {finding.code for finding in encoded.findings}
    listed = encode_mavlink([orders.mission], FileFormat.MAVLINK_WPL, options)
    assert "no-fence" in {finding.code for finding in listed.findings}
