"""A simulated flight, flown by the program itself: its telemetry log and its live record tell the same."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.vehicle.conduct import conduct
from groundstation.vehicle.flight_run import FlightRun, RunOptions
from groundstation.vehicle.orders import sortie_orders
from missions.build import missions_from_plan
from missions.flight.flight_file import flight_of, flight_to_json, read_flight, write_flight
from missions.flight.logs.read import read_log
from missions.flight.report import report_flight
from missions.mavlink.autopilots import Autopilot
from missions.simulator.build import make_airframe
from missions.simulator.scene import Conditions
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.findings import Severity
from tests.missions.simulator.flying import planned


@pytest.mark.parametrize("autopilot", list(Autopilot))
def test_the_telemetry_log_tells_what_the_live_record_tells(tmp_path: Path, autopilot: Autopilot) -> None:
    model, plan = planned("single-panel", 6)
    site = model.site
    (mission,) = missions_from_plan(plan, site.origin, site.home_enu_m)
    airframe, _ = make_airframe(plan, model, plan.sorties[0], conditions=Conditions(wind_m_s=5.0), seed=3)
    vehicle = SimulatedVehicle(autopilot, airframe, site.origin, site.home_enu_m)
    link = DirectLink(vehicle)
    frames: list[bytes] = []
    link.observe(lambda frame, _, time_s: frames.append(struct.pack(">Q", int((1.79e9 + time_s / 50) * 1e6)) + frame))
    run = FlightRun(sortie_orders(plan, model, mission), RunOptions(sets_parameters=True), "simulation")
    outcome = conduct(run, link, link.clock)
    assert outcome.succeeded
    assert outcome.record is not None

    log = tmp_path / "flight.tlog"
    log.write_bytes(b"".join(frames))
    flights = read_log(log, site)
    live, later = (report_flight(plan, model, records) for records in ((outcome.record,), flights.records))
    assert live.summary.n_taken == later.summary.n_taken == 6
    assert later.summary.covered == pytest.approx(live.summary.covered, rel=0.01)
    assert later.summary.covered >= 0.97 * later.summary.covered_planned
    assert later.summary.duration_flown_s == pytest.approx(live.summary.duration_flown_s, abs=1.0)
    assert later.summary.least_distance_m == pytest.approx(live.summary.least_distance_m, abs=0.1)
    for first, second in zip(live.views, later.views, strict=True):
        assert second.position_error_m == pytest.approx(first.position_error_m, abs=0.03)
        assert second.heading_error_deg == pytest.approx(first.heading_error_deg, abs=0.1)
    assert all(finding.severity is not Severity.ERROR for finding in later.findings)

    flight = flight_of(plan, model, flights.records, later)
    write_flight(tmp_path / "flight.json", flight)
    read = read_flight(tmp_path / "flight.json")
    assert flight_to_json(read) == flight_to_json(flight)
    again = report_flight(plan, model, [replace(record, sortie=1) for record in read.sorties])
    assert again == later
