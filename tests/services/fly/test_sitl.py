"""A real autopilot's simulation: started from its binary, or flown where one is running."""

import os
import sys
import time
from pathlib import Path

import pytest

from groundstation.services.fly.flying import FlightRequest, fly_plan, sitl
from missions.flight.logs.read import read_log
from missions.flight.report import report_flight
from missions.mavlink.autopilots import Autopilot
from missions.mission.model import GeoPoint
from planning.base.errors import InputError, LinkError
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import single_panel

HOME = GeoPoint(22.3372, 114.2636, 62.0)

STAND_IN = """#!{python}
import socket, sys, time
print(" ".join(sys.argv[1:]), flush=True)
with open({told!r}, "w") as file:
    file.write("\\n".join(sys.argv[1:]) + "\\n" + open(sys.argv[sys.argv.index("--defaults") + 1]).read())
server = socket.create_server(("127.0.0.1", 5760))
time.sleep(600)
"""


def program(path, text):
    path.write_text(text)
    path.chmod(0o755)
    return path


def port_is_free():
    import socket

    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", 5760)) != 0


def test_the_simulation_starts_at_home_with_a_camera_and_anew_with_a_full_battery(tmp_path):
    if not port_is_free():
        pytest.skip("another simulation listens at port 5760 of this machine")
    told = tmp_path / "told"
    binary = program(tmp_path / "arducopter", STAND_IN.format(python=sys.executable, told=str(told)))
    with sitl(binary, HOME, 10.0, 1800.0, None) as restart:
        arguments = told.read_text().splitlines()
        told.unlink()
        restart(2)
        again = told.read_text().splitlines()
    assert arguments[arguments.index("--speedup") + 1] == "10"
    lat, lon, _, heading = map(float, arguments[arguments.index("--home") + 1].split(","))
    assert (lat, lon, heading) == (22.3372, 114.2636, 0.0)
    assert "CAM1_TYPE 1" in arguments
    assert "BATT_CAPACITY 14150" in arguments
    assert "-w" in arguments
    assert "-w" not in again
    deadline_s = time.monotonic() + 120.0
    while not port_is_free():
        assert time.monotonic() < deadline_s


def test_a_binary_that_ends_at_once_is_told_with_its_last_words(tmp_path):
    if not port_is_free():
        pytest.skip("another simulation listens at port 5760 of this machine")
    binary = program(tmp_path / "broken", "#!/bin/sh\necho wrong architecture\nexit 3\n")
    with pytest.raises(LinkError, match=r"status 3 \(wrong architecture\)"), sitl(binary, HOME, 1.0, 1800.0, None):
        pass


def test_what_is_no_binary_is_refused(tmp_path):
    with pytest.raises(InputError, match="name an arducopter"), sitl(tmp_path / "none", HOME, 1.0, 1800.0, None):
        pass
    with (
        pytest.raises(InputError, match=r"copter\.parm"),
        sitl(tmp_path / "none", HOME, 1.0, 1800.0, tmp_path / "no.parm"),
    ):
        pass


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [Autopilot.PX4])  # ArduPilot: test_flying_ardupilot.py
def test_a_real_autopilot_flies_as_planned(autopilot, tmp_path):
    variable = f"REFLIGHT_SITL_{autopilot.name}"
    url = os.environ.get(variable)
    if not url:
        pytest.skip(f"no simulation of {autopilot.value} to fly: {variable} does not name its link")
    model = single_panel()
    plan = plan_flight(model, PlanRequest(n_views=8, time_budget_s=2.0, profile_id=autopilot.value)).plan
    flown = fly_plan(
        plan, model, FlightRequest(link=url, autopilot=autopilot, sets_parameters=True, log_folder=Path(tmp_path))
    )
    report = flown.flight.report
    assert report.summary.n_taken == len(plan.viewpoints)
    assert max(view.position_error_m for view in report.views) < 0.5
    assert max(abs(view.heading_error_deg) for view in report.views) < 3.0
    assert max(abs(view.gimbal_pitch_error_deg) for view in report.views) < 2.0
    assert report.summary.covered >= 0.97 * report.summary.covered_planned
    (sortie,), (own,) = report.sorties, flown.sorties
    assert sortie.duration_flown_s == pytest.approx(sortie.duration_predicted_s, rel=0.1)
    assert [note.text for note in own.notes if note.code == "uploaded"][-1].endswith("read back and equal")
    logged = report_flight(plan, model, read_log(own.log, model.site).records)
    assert [view.position_error_m for view in logged.views] == pytest.approx(
        [view.position_error_m for view in report.views], abs=0.05
    )
