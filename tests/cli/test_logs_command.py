"""`logs`: what is on the vehicle's card, by command, and from there into `report`."""

import threading

import pytest

from groundstation.services.fly.flying import report_of_log
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import open_link
from missions.simulator.server import serve
from missions.simulator.vehicle import SimulatedVehicle
from planning.checks.case import Case
from tests.missions.simulator.flying import bundled
from tests.missions.simulator.ground import ORIGIN, PointMass
from tests.services.fly.test_onboard_logs import flown, url  # noqa: F401


@pytest.fixture
def idle():
    """A vehicle that never flew, served over TCP."""
    vehicle = SimulatedVehicle(Autopilot.ARDUPILOT, PointMass(), ORIGIN, is_ready=True)
    server, stop = open_link("tcpin:127.0.0.1:0", vehicle.address), threading.Event()
    thread = threading.Thread(target=serve, args=(vehicle, [server]), kwargs={"stop": stop.is_set}, daemon=True)
    thread.start()
    yield f"tcp:127.0.0.1:{server.channel.port}"
    stop.set()
    thread.join()
    server.close()


@pytest.mark.long
def test_a_vehicle_that_never_flew_has_no_logs(reflight, idle):
    assert "there are no logs on the vehicle" in reflight("logs", idle).error
    assert "there are no logs on the vehicle" in reflight("logs", idle, "--list").error


@pytest.mark.parametrize(
    ("arguments", "why"),
    [(["tcp:127.0.0.1:1"], "is the address right?"), (["nowhere"], "expected KIND:HOST:PORT")],
)
def test_links_that_lead_nowhere_are_told(reflight, arguments, why):
    assert why in reflight("logs", *arguments).error


@pytest.mark.slow
def test_a_log_goes_from_the_vehicle_into_the_report(reflight, flown, url, tmp_path):  # noqa: F811
    listed = reflight("logs", url, "--list", "--json")
    (log,) = listed.json["logs"]
    done = reflight("logs", url, "-o", tmp_path, "--json")
    (file,) = done.json["files"]
    assert (file["log"], file["bytes"], file["is_checked"]) == (log["path"], log["bytes"], True)
    model, plan = bundled("roof", 4)
    _, report, _ = report_of_log(Case.of(plan, model), tmp_path / log["name"])
    assert report.summary.n_taken == 4
    again = reflight("logs", url, log["name"], "-o", tmp_path)
    assert again.out.strip() == str(tmp_path / log["name"])
    assert "next: " in again.err
