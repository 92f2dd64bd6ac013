"""A simulated flight, flown by the program itself: its telemetry log and its live record tell the same."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions
from missions.flight.flight_file import flight_of, flight_to_json, read_flight, write_flight
from missions.flight.logs.read import read_log
from missions.flight.report import report_flight
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from missions.simulator.build import make_airframe
from missions.simulator.conditions import Conditions
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.findings import Severity
from tests.missions.simulator.flying import planned
from tests.slow import slow


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
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
    (record,) = flights.records
    live = outcome.record
    # The embedded vehicle hands its messages over as they are; on the wire, numbers are rounded to 32 bits.
    for ours, told in zip(live.photos, record.photos, strict=True):
        assert (told.index, told.time_s, told.source) == (ours.index, ours.time_s, ours.source)
        assert told.position_enu_m == pytest.approx(ours.position_enu_m, abs=1e-5)
        assert (told.heading_deg, told.gimbal_pitch_deg) == pytest.approx((ours.heading_deg, ours.gimbal_pitch_deg))
    for name in live.track.__slots__:
        ours, told = getattr(live.track, name), getattr(record.track, name)
        np.testing.assert_allclose(told, ours, rtol=0.0, atol=1e-6, err_msg=name)
    assert record.duration_s == live.duration_s
    assert set(record.events) <= set(live.events)

    later = report_flight(plan, model, flights.records)
    assert later.summary.n_taken == 6
    assert later.summary.covered >= 0.97 * later.summary.covered_planned
    assert all(finding.severity is not Severity.ERROR for finding in later.findings)

    flight = flight_of(plan, model, flights.records, later)
    write_flight(tmp_path / "flight.json", flight)
    read = read_flight(tmp_path / "flight.json")
    assert flight_to_json(read) == flight_to_json(flight)
    again = report_flight(plan, model, [replace(record, sortie=1) for record in read.sorties])
    assert again == later
