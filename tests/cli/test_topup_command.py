"""`topup`: a flight and its plan to a top-up, or to the rest of a sortie."""

import json
from dataclasses import replace

import numpy as np
import pytest

from missions.flight.flight_file import flight_of, write_flight
from missions.flight.record import FlightRecord, TakenPhoto, Track
from planning.geo.mesh import write_mesh
from planning.plan import read_plan, write_plan
from planning.site.file import read_site, write_site
from tests.missions.flight.flights import flown_as_planned, never_taken, with_photos
from tests.missions.flight.log_writers import dataflash
from tests.planning.plan_cases import kiosk
from tests.planning.revision.test_top_up import alone


@pytest.fixture
def flown(pane, tmp_path):
    """A flight file with photos of the first views of the pane's plan."""

    def write(n_photos):
        plan = read_plan(pane / "plan.json")
        by_id = {view.id: view for view in plan.viewpoints}
        views = [by_id[identifier] for identifier in plan.sorties[0].viewpoint_ids[:n_photos]]
        photos = tuple(
            TakenPhoto(i, 4.0 * i, view.position_enu_m, view.heading_deg, view.gimbal_pitch_deg)
            for i, view in enumerate(views)
        )
        nothing, nowhere = np.zeros(0), np.zeros((0, 3))
        track = Track(nothing, nowhere, nowhere, nothing, nothing, nothing, nothing)
        path = tmp_path / "flight.json"
        write_flight(path, flight_of(plan, read_site(pane / "site.json"), (FlightRecord(1, "test", track, photos),)))
        return path

    return write


@pytest.mark.long
def test_a_top_up_closes_what_is_missing_and_can_be_checked_and_exported(reflight, pane, flown, tmp_path):
    out = tmp_path / "topup.plan.json"
    done = reflight("topup", flown(2), pane / "plan.json", pane / "site.json", "-o", out, "--time-budget", 1)
    assert done.status == 0
    assert "missing sections" in done.out
    assert done.err.splitlines()[-1].startswith("next: app.py check ")
    assert read_plan(out).method == "top-up"
    assert reflight("check", out, pane / "site.json").status == 0
    mission = tmp_path / "topup.kmz"
    assert reflight("export", out, "--format", "dji-kmz", "-o", mission).status == 0
    assert mission.exists()


@pytest.mark.slow
def test_json_is_one_object_that_says_what_is_left_open(reflight, pane, flown, tmp_path):
    out = tmp_path / "topup.plan.json"
    arguments = (flown(2), pane / "plan.json", pane / "site.json", "-o", out, "--time-budget", 1, "--json")
    done = reflight("topup", *arguments)
    assert (done.status, done.err) == (0, "")
    summary = done.json
    assert summary["views"] == len(read_plan(out).viewpoints)
    assert summary["wanted"] == summary["closed"] == summary["promised"] - summary["delivered"]
    assert summary["covered_together"] >= summary["promised"]
    assert summary["left_open"] == {"unreachable": 0, "battery": 0, "spacing": 0}
    assert summary["shortest_s"] <= summary["duration_s"] + 0.1


def test_a_complete_flight_needs_no_top_up_and_writes_none(reflight, pane, flown, tmp_path):
    out = tmp_path / "topup.plan.json"
    done = reflight("topup", flown(99), pane / "plan.json", pane / "site.json", "-o", out)
    assert (done.status, done.err) == (0, "")
    assert done.out.splitlines()[-1] == "nothing is missing; no top-up is needed, and none was written"
    assert not out.exists()


@pytest.mark.slow
def test_hardly_anything_missing_writes_a_top_up_only_where_it_is_asked_for(reflight, tmp_path):
    plan, view = alone(1)
    site_path, plan_path, flight_path = (tmp_path / name for name in ("site.json", "plan.json", "flight.json"))
    write_site(site_path, kiosk().site)
    write_mesh(tmp_path / "kiosk.ply", kiosk().building)
    plan = replace(plan, site_sha256=read_site(site_path).sha256)
    write_plan(plan_path, plan)
    (sortie,) = plan.sorties
    taken = [v for v in plan.viewpoints if v.id != plan.viewpoints[view].id]
    order = {identifier: i for i, identifier in enumerate(sortie.viewpoint_ids)}
    taken.sort(key=lambda v: order[v.id])
    photos = tuple(
        TakenPhoto(i, 4.0 * i, v.position_enu_m, v.heading_deg, v.gimbal_pitch_deg) for i, v in enumerate(taken)
    )
    nothing, nowhere = np.zeros(0), np.zeros((0, 3))
    record = FlightRecord(1, "test", Track(nothing, nowhere, nowhere, nothing, nothing, nothing, nothing), photos)
    write_flight(flight_path, flight_of(plan, read_site(site_path), (record,)))
    out = tmp_path / "topup.plan.json"
    arguments = ("topup", flight_path, plan_path, site_path, "-o", out, "--time-budget", 1)
    left = reflight(*arguments)
    assert left.status == 0
    assert not out.exists()
    assert "no top-up was written; --all writes it all the same" in left.out
    told = left.out + left.err
    assert f"1 of {plan.coverage.covered} sections are missing, too few for a flight unasked" in told
    assert "min in the air (views: 1, batteries: 1)" in told
    summary = reflight(*arguments, "--json").json
    assert (summary["negligible"], summary["written"], summary["wanted"], summary["views"]) == (True, False, 1, 1)
    everything = reflight(*arguments, "--all")
    assert everything.status == 0
    assert read_plan(out).method == "top-up"


@pytest.mark.slow
def test_the_autopilots_log_serves_as_well_as_a_flight_file(reflight, pane, tmp_path):
    plan, site = read_plan(pane / "plan.json"), read_site(pane / "site.json").site
    (record,) = flown_as_planned(plan)
    whole, half = tmp_path / "whole.BIN", tmp_path / "half.BIN"
    whole.write_bytes(dataflash([record], site))
    half.write_bytes(dataflash([never_taken(record, 3, 4, 5)], site))
    out = tmp_path / "topup.plan.json"
    rest = ("-o", out, "--time-budget", 1, "--json")
    assert reflight("topup", whole, pane / "plan.json", pane / "site.json", *rest).json["wanted"] == 0
    assert not out.exists()
    summary = reflight("topup", half, pane / "plan.json", pane / "site.json", *rest).json
    assert summary["wanted"] == summary["closed"] > 0
    elsewhere = replace(site, origin=replace(site.origin, lat_deg=site.origin.lat_deg + 1.0))
    whole.write_bytes(dataflash([record], elsewhere))
    refused = reflight("topup", whole, pane / "plan.json", pane / "site.json", "-o", out)
    assert "km from the site" in refused.error


@pytest.mark.slow
def test_photos_whose_reports_were_lost_are_told_of_with_what_to_do(reflight, pane, tmp_path):
    plan, model = read_plan(pane / "plan.json"), read_site(pane / "site.json")
    (record,) = flown_as_planned(plan)
    heard = with_photos(record, lambda photos: (*photos[:2], *photos[3:]))
    write_flight(tmp_path / "flight.json", flight_of(plan, model, (heard,)))
    quick = ("-o", tmp_path / "topup.plan.json", "--time-budget", 1, "--json")
    done = reflight("topup", tmp_path / "flight.json", pane / "plan.json", pane / "site.json", *quick)
    (finding,) = [finding for finding in done.json["findings"] if finding["code"] == "reports-lost"]
    assert finding["value"] == 1
    assert ".BIN" in finding["message"]


@pytest.mark.long
def test_resume_writes_the_rest_of_the_sortie(reflight, pane, flown, tmp_path):
    out = tmp_path / "rest.plan.json"
    arguments = (flown(2), pane / "plan.json", pane / "site.json", "-o", out, "--resume")
    done = reflight("topup", *arguments)
    assert done.status == 0
    assert "rest of sortie 1 from" in done.out
    ids = read_plan(pane / "plan.json").sorties[0].viewpoint_ids
    assert read_plan(out).sorties[0].viewpoint_ids == ids[2:]
    assert reflight("check", out, pane / "site.json").status == 0
    summary = reflight("topup", *arguments, "--json").json
    assert (summary["sortie"], summary["views"], summary["first_view"]) == (1, len(ids) - 2, ids[2])


@pytest.mark.long
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--battery", 1.2), "--battery: expected a charge from 0 to 1, got 1.2"),
        (("--battery", 0.2), "the battery is at 20%; a reserve of 25% and 30 s for take-off and landing leave nothing"),
        (("--batteries", 0), "--batteries: expected 1 to 100, got 0"),
        (("--time-budget", 0), "--time-budget: expected more than 0 s"),
        (("--seed", -1), "--seed: expected 0 to"),
        (("--sortie", 1), "--sortie: is for --resume"),
        (("--resume", "--batteries", 2), "--batteries: is not for --resume"),
        (("--resume", "--sortie", 5), "sortie: expected 1 to 1, got 5"),
        (("--resume", "--battery", 0.251), "change the battery"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line_and_writes_nothing(reflight, pane, flown, tmp_path, options, words):
    out = tmp_path / "topup.plan.json"
    done = reflight("topup", flown(2), pane / "plan.json", pane / "site.json", "-o", out, *options)
    assert words in done.error
    assert not out.exists()


def test_a_flight_of_another_plan_and_a_wrong_file_are_refused(reflight, pane, flown, changed, tmp_path):
    out = tmp_path / "topup.plan.json"
    other = changed(pane / "plan.json", "seed", 5)
    assert "flight of another plan" in reflight("topup", flown(2), other, pane / "site.json", "-o", out).error
    # The bundled sites stand at one origin: the name tells them apart.
    renamed = changed(pane / "site.json", "name", "court")
    assert "site ('court')" in reflight("topup", flown(2), pane / "plan.json", renamed, "-o", out).error
    swapped = reflight("topup", pane / "plan.json", flown(2), pane / "site.json", "-o", out)
    assert "reflight-flight/1" in swapped.error
    missing = reflight("topup", tmp_path / "no.json", pane / "plan.json", pane / "site.json", "-o", out)
    assert "no.json" in missing.error
    over = reflight("topup", flown(2), pane / "plan.json", pane / "site.json", "-o", pane / "plan.json")
    assert "plan.json" in over.error
    assert json.loads((pane / "plan.json").read_text())["method"] == "greedy"
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "FLIGHT: is missing: a flight file or a log, or --photos with the photos themselves"),
        (("--learn", 3), "FLIGHT: is missing"),
        (("--photos", "card", "--resume"), "--resume: is not for --photos"),
        (("--photos", "card", "--target", "reachable"), "--target: is not for --photos"),
        (
            ("--photos", "card", "--battery", 0.5, "--batteries", 2),
            "--batteries: the battery on board flies one sortie",
        ),
        (("--photos", "card", "--learn", 0), "--learn: expected more than 0"),
        (("--photos", "no-such-folder"), "no-such-folder"),
    ],
)
def test_what_does_not_belong_to_photos_or_to_a_flight_is_said(reflight, pane, tmp_path, arguments, message):
    done = reflight("topup", pane / "plan.json", pane / "site.json", "-o", tmp_path / "p.json", *arguments)
    assert done.status == 1
    assert message in done.err


def test_learning_belongs_to_photos(reflight, pane, flown, tmp_path):
    done = reflight("topup", flown(2), pane / "plan.json", pane / "site.json", "-o", tmp_path / "p.json", "--learn", 3)
    assert done.status == 1
    assert "--learn: belongs to --photos" in done.err
