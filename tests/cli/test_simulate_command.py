"""`simulate`: what it prints, writes, and refuses."""

import json
import threading
from contextlib import contextmanager

import pytest

from groundstation.cli.commands.simulate import effect_settings
from missions.flight.flight_file import read_flight
from missions.flight.logs.read import read_log
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import VEHICLE, open_link
from missions.simulator.build import EFFECTS, make_airframe
from missions.simulator.server import serve
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import InputError
from planning.base.progress import StopRequest
from planning.plan import read_plan
from planning.site.file import read_site
from tests.cli.conftest import BAD_CONTENTS
from tests.slow import slow


@pytest.fixture
def fly(reflight, pane, tmp_path):
    """Simulate the pane's plan."""

    def run(*arguments):
        return reflight("simulate", pane / "plan.json", pane / "site.json", "-o", tmp_path / "f.json", *arguments)

    return run


@pytest.mark.slow
def test_a_flight_is_reported_and_written(fly, tmp_path):
    done = fly()
    assert done.status == 0
    assert "photos: 6 of 6 views" in done.out
    assert "effects:" in done.out
    flight = read_flight(tmp_path / "f.json")
    assert len(flight.sorties[0].photos) == 6
    assert flight.report.summary.n_taken == 6


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow("ardupilot"), "px4"])
def test_json_is_one_object_with_what_others_need(fly, autopilot):
    content = fly("--autopilot", autopilot, "--json", "--seed", 7).json
    assert (content["n_taken"], content["n_views"]) == (6, 6)
    assert content["covered"] == content["covered_planned"] > 0
    assert len(content["effects"]) == len(EFFECTS)
    assert content["duration_flown_s"] == pytest.approx(content["duration_predicted_s"], rel=0.1)
    assert {"flight", "link", "views", "sorties", "findings", "seconds"} <= set(content)


@pytest.mark.slow
def test_effects_can_be_overruled(fly):
    content = fly("--effects", "none", "--effects", "wind=on", "--wind", 5, "--json").json
    assert {effect["effect"] for effect in content["effects"] if effect["on"]} == {"wind"}
    assert all(effect["decided_by"] == "user" for effect in content["effects"])


def test_wishes_are_understood_together():
    assert effect_settings([]) == {}
    assert set(effect_settings(["all"]).values()) == {"on"}
    assert effect_settings(["none,gnss-noise=auto"])["GNSS noise"] == "auto"
    assert effect_settings(["GNSS noise=off"]) == {"GNSS noise": "off"}
    for bad in ("wind", "wind=yes", "rain=on", "=on", ""):
        with pytest.raises(InputError, match="names are wind, gnss-noise"):
            effect_settings([bad])


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--wind", -1), "--wind: expected 0 m/s or more"),
        (("--wind", 40), "wind"),
        (("--speedup", 0), "--speedup: expected more than 0"),
        (("--seed", -1), "--seed: expected 0 to"),
        (("--effects", "rain=on"), "names are wind"),
        (("--wind", 14), "the wind blows with"),
        (("--link", "carrier-pigeon"), "such as tcp:127.0.0.1:5760"),
        (("--link", "tcp:127.0.0.1:99999", "--wind", 3), "expected KIND:HOST:PORT"),
        (("--link", "tcp:"), "expected KIND:HOST:PORT"),
        (("--link", "serial:/dev/nothing:fast"), "expected serial:DEVICE:BAUD"),
        (("--link", "serial:/dev/nothing:57600"), "this could be a real aircraft"),
        (("--take-off",), "are for --link URL"),
        (("--set-parameters",), "are for --link URL"),
        (("--raise", 2), "are for --link URL"),
        (("--link", "tcp:127.0.0.1:1", "--overrule", "battery"), "expected one of foreign-fence, home-height, para"),
        (("--link", "tcp:127.0.0.1:5760", "--wind", 3), "are for --link sim"),
        (("--link", "tcp:127.0.0.1:1"), "cannot be opened"),
    ],
)
def test_what_cannot_be_flown_is_said_in_one_line_and_nothing_is_written(fly, tmp_path, arguments, text):
    done = fly(*arguments)
    assert text in done.error
    assert not (tmp_path / "f.json").exists()


@pytest.mark.parametrize("name", sorted(BAD_CONTENTS))
def test_files_that_are_no_plan_are_refused(reflight, pane, tmp_path, name):
    bad = tmp_path / "bad.json"
    bad.write_bytes(BAD_CONTENTS[name])
    assert "bad.json" in reflight("simulate", bad, pane / "site.json", "-o", tmp_path / "f.json").error
    assert "bad.json" in reflight("simulate", pane / "plan.json", bad, "-o", tmp_path / "f.json").error


def test_a_plan_for_another_site_is_refused(reflight, pane, changed, tmp_path):
    moved = changed(pane / "site.json", "origin", "lat_deg", 1.0)
    done = reflight("simulate", pane / "plan.json", moved, "-o", tmp_path / "f.json")
    assert "a changed site" in done.error


def test_a_plan_without_sorties_is_refused_with_what_to_do(reflight, pane, changed, tmp_path):
    plan = changed(pane / "plan.json", "sorties", [])
    error = reflight("simulate", plan, pane / "site.json", "-o", tmp_path / "flight.json").error
    assert "no sorties: nothing says which way to fly; plan again" in error


def test_the_flight_may_not_replace_the_plan(reflight, pane):
    before = (pane / "plan.json").read_bytes()
    assert (
        "would replace" in reflight("simulate", pane / "plan.json", pane / "site.json", "-o", pane / "plan.json").error
    )
    assert (pane / "plan.json").read_bytes() == before


REAL_PX4 = ("SIM_GZ_EN", "SYS_HITL")
"""Parameters that a PX4 on a board which simulates nothing does not know."""


@contextmanager
def vehicle_at_a_port(pane, autopilot, forgets=(), home_up_m=0.0):
    """A vehicle of the pane's plan that serves a port of this machine; it may not know some parameters."""
    plan, model = read_plan(pane / "plan.json"), read_site(pane / "site.json")
    x, y, z = model.site.home_enu_m
    airframe, _ = make_airframe(plan, model, plan.sorties[0], home_enu_m=(x, y, z + home_up_m))
    without = dict.fromkeys(forgets)
    vehicle = SimulatedVehicle(autopilot, airframe, model.site.origin, parameters=without, is_ready=True)
    link = open_link("tcpin:127.0.0.1:0", VEHICLE)
    stop = StopRequest()
    thread = threading.Thread(target=serve, args=(vehicle, [link], 50.0, stop))
    thread.start()
    try:
        yield vehicle, f"tcp:127.0.0.1:{link.channel.port}"
    finally:
        stop.request()
        thread.join()
        link.close()


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
def test_an_address_of_this_machine_is_no_simulation(fly, pane, tmp_path, autopilot):
    """Routers listen there: only what the vehicle says of itself counts, and nothing is set on any other."""
    forgets = ("SIM_SPEEDUP",) if autopilot is Autopilot.ARDUPILOT else REAL_PX4
    with vehicle_at_a_port(pane, autopilot, forgets) as (vehicle, url):
        before = vehicle.parameters.values()
        error = fly("--link", url).error
        assert "does not say that it is a simulation: this could be a real aircraft" in error
        assert "add --take-off" in error
        assert vehicle.parameters.values() == before
        assert not vehicle.modes.is_armed
        assert len(vehicle.stores.mission) == 0
    assert not (tmp_path / "f.json").exists()


@pytest.mark.slow
@pytest.mark.parametrize("agrees", [False, True])
def test_parameters_of_a_vehicle_that_may_be_real_are_set_where_the_pilot_agrees(fly, pane, agrees):
    with vehicle_at_a_port(pane, Autopilot.PX4, REAL_PX4) as (vehicle, url):
        before = vehicle.parameters.values()
        if not agrees:
            # As it was set, it would return 10 m above the airspace.
            assert "it returns above the airspace" in fly("--link", url, "--take-off").error
        agreed = ["--set-parameters"] if agrees else ["--overrule", "return"]
        done = fly("--link", url, "--take-off", "--json", *agreed)
        changed = {name for name, value in vehicle.parameters.values().items() if value != before[name]}
    notes = [note["text"] for note in done.json["notes"][0] if note["code"] == "parameter"]
    if agrees:
        assert "RTL_RETURN_ALT" in changed
        assert any("was 60 and is" in text for text in notes)
    else:
        assert not changed
        assert any("RTL_RETURN_ALT is 60; the plan was made for" in text for text in notes)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
def test_a_vehicle_that_stands_lower_than_planned_flies_once_its_flight_is_raised(fly, pane, tmp_path, autopilot):
    """Tried: 3 m lower and 10 m higher flew without a word."""
    with vehicle_at_a_port(pane, autopilot, home_up_m=-3.0) as (vehicle, url):
        error = fly("--link", url).error
        assert "stands 3.0 m lower than the planned home" in error
        assert "raise it by 3.0 m" in error
        assert not vehicle.modes.is_armed
    with vehicle_at_a_port(pane, autopilot, home_up_m=-3.0) as (vehicle, url):
        done = fly("--link", url, "--raise", 3.0, "--json")
    assert done.json["n_taken"] == 6
    heights_m = sorted(shot.pose.position_enu_m[2] for shot in vehicle.shots)
    planned_m = sorted(view.position_enu_m[2] for view in read_plan(pane / "plan.json").viewpoints)
    assert heights_m == pytest.approx(planned_m, abs=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
def test_a_vehicle_at_a_link_is_flown_and_logged(fly, pane, tmp_path, autopilot):
    model = read_site(pane / "site.json")
    with vehicle_at_a_port(pane, autopilot) as (_, url):
        done = fly("--link", url, "--autopilot", autopilot.value, "--logs", tmp_path / "logs", "--json")
    assert (done.json["n_taken"], done.json["link"]) == (6, url)
    (log,) = (tmp_path / "logs").iterdir()
    assert [str(log)] == done.json["logs"]
    (again,) = read_log(log, model.site).records
    assert len(again.photos) == 6
    content = json.loads((tmp_path / "f.json").read_text())
    assert {photo["source"] for photo in content["sorties"][0]["photos"]} <= {"camera-feedback", "image-captured"}
