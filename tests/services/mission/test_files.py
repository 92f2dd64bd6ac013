"""Exports and imports of plans in memory: what is said first, what is written, what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.mission import files as mission_files
from groundstation.services.mission import proof as proofs
from groundstation.services.mission.files import (
    export_paths,
    in_order_of_sorties,
    missions_as_plan,
    prepare_export,
    write_export,
    write_proved_export,
)
from groundstation.services.mission.proof import PROVED, judged, verified
from groundstation.services.mission.readiness import preflight
from missions.formats.options import ExportOptions
from missions.formats.registry import FORMATS
from missions.mission.export_choices import FileFormat, HeightReference, LinkLoss
from planning.base.errors import InputError, OperationCancelled
from planning.base.findings import Severity
from planning.coverage.reachability import find_reachable
from planning.planner import plan_flight
from planning.proof.reflight_verify import jobs_of
from planning.request import PlanRequest
from tests.missions.plans import example_plan
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK


def at_once(function, *arguments):
    """Call without a process of its own."""
    return function(*arguments)


@pytest.fixture(scope="module")
def planned():
    model = kiosk()
    return plan_flight(model, PlanRequest(n_views=12, greedy=QUICK)).plan, model


@pytest.mark.slow
@pytest.mark.parametrize("file_format", list(FileFormat))
def test_every_format_is_prepared_and_then_written(planned, tmp_path, file_format):
    plan, model = planned
    prepared = prepare_export(plan, model, file_format)
    assert prepared.can_be_written
    path = tmp_path / f"out{FORMATS[file_format].endings[0]}"
    assert not list(tmp_path.iterdir())
    assert write_export(prepared, path) == export_paths(prepared, path) == tuple(sorted(tmp_path.iterdir()))
    back, _ = missions_as_plan([path], model)
    assert len(back.viewpoints) == 12
    assert back.coverage.covered == plan.coverage.covered


def test_a_return_height_that_is_refused_is_said_and_keeps_files_from_being_written(planned):
    plan, model = planned
    options = ExportOptions(rth_height_m=5.0, link_loss=LinkLoss.GO_HOME)
    prepared = prepare_export(plan, model, FileFormat.DJI_KMZ, options)
    assert not prepared.can_be_written
    found = [f for f in prepared.findings if f.code == "return-height"]
    assert [f.severity for f in found] == [Severity.ERROR]
    assert "expected 20 to 1500 m above take-off, got 5 m" in found[0].message


def test_what_a_format_cannot_do_is_a_refusal_with_its_reason(planned):
    plan, model = planned
    options = ExportOptions(height_reference=HeightReference.ELLIPSOID)
    prepared = prepare_export(plan, model, FileFormat.MAVLINK_PLAN, options)
    assert prepared.encoded is None
    assert "no heights above the ellipsoid" in prepared.refusal
    assert export_paths(prepared, None) == ()
    with pytest.raises(ValueError, match="nothing to write"):
        write_export(prepared, None)


def test_a_plan_that_is_not_ready_is_exported_with_a_warning():
    from dataclasses import replace

    plan = replace(example_plan(), site="kiosk", home_enu_m=None, origin=None)
    model = kiosk(home_enu_m=(3.0, -40.0, 1.5))
    prepared = prepare_export(plan, model, FileFormat.KML)
    (found,) = (finding for finding in prepared.findings if finding.code == "not-ready")
    assert found.message.startswith("NOT ready to fly: ")
    assert prepared.can_be_written
    assert not prepared.is_ready_to_fly


def test_a_plan_of_a_place_that_nobody_knows_is_not_ready(planned):
    from dataclasses import replace

    plan, model = planned
    unknown = replace(model, site=replace(model.site, place_from="unknown"))
    prepared = prepare_export(plan, unknown, FileFormat.KML)
    (found,) = (finding for finding in prepared.findings if finding.code == "not-ready")
    assert found.message.startswith("NOT ready to fly: nobody has said where the site is")


def test_a_file_named_twice_is_refused(planned, tmp_path):
    plan, model = planned
    path = tmp_path / "a.kml"
    write_export(prepare_export(plan, model, FileFormat.KML), path)
    with pytest.raises(InputError, match="named twice"):
        missions_as_plan([path, tmp_path / "." / "a.kml"], model)


def test_preflight_counts_the_panels_of_every_photo(planned):
    from planning.checks import check_plan
    from tests.planning.plan_cases import seen_by_contract

    plan, model = planned
    found = preflight(plan, model)
    rules = check_plan(plan, model)
    assert found.findings[: len(rules)] == rules, "what the day brings comes behind the rules"
    assert found.is_of(plan, model)
    assert not found.is_of(plan, None)
    for view in plan.viewpoints:
        seen = seen_by_contract(model, plan.camera, (view,), 30.0, plan.constraints.occlusion == "on")
        assert found.panels_covered[view.id] == len({panel for panel, _ in seen})


def test_files_of_one_export_come_in_the_order_of_its_sorties_however_they_are_named():
    names = ["roof-10.plan", "roof-2.plan", "roof.plan", "roof-1x.plan", "attic-2.plan", "attic.plan"]
    assert [path.name for path in in_order_of_sorties([Path(name) for name in names])] == [
        "attic.plan",
        "attic-2.plan",
        "roof.plan",
        "roof-2.plan",
        "roof-10.plan",
        "roof-1x.plan",
    ]


def test_two_exports_of_one_plan_share_it_out_alike(planned, monkeypatch):
    plan, model = planned
    monkeypatch.setattr("missions.mavlink.items.photos_that_fit", lambda _autopilot: 5)
    n_shared = []
    real = mission_files.resplit_sorties
    monkeypatch.setattr(mission_files, "resplit_sorties", lambda *a: n_shared.append(1) or real(*a))
    first = prepare_export(plan, model, FileFormat.MAVLINK_PLAN)
    amsl = ExportOptions(height_reference=HeightReference.AMSL)
    second = prepare_export(plan, model, FileFormat.MAVLINK_PLAN, amsl)
    assert first.n_files == second.n_files > 1
    assert len(n_shared) == 1


@pytest.mark.long
def test_written_missions_carry_a_proof_that_the_verifier_accepts_and_that_a_moved_place_breaks(planned, tmp_path):
    plan, model = planned
    prepared = prepare_export(plan, model, FileFormat.MAVLINK_PLAN)
    _, found = write_proved_export(prepared, model, FileFormat.MAVLINK_PLAN, tmp_path / "out.plan", at_once)
    assert found is not None
    assert found.severity is Severity.OK, found
    jobs = jobs_of(tmp_path)
    assert [path.name for path in jobs[0]] == [
        "out.plan.site.json",
        "out.plan.plan.json",
        "out.plan.mission.proof",
        "out.plan",
    ]
    site, proved, proof, mission = jobs[0]
    content = json.loads(mission.read_text())
    photos = [item for item in content["mission"]["items"] if item["command"] == 16]
    photos[3]["params"][4] += 1e-5
    mission.write_text(json.dumps(content))
    assert any(claim.verdict != PROVED for claim in verified(site, proved, proof, [mission]))


@pytest.mark.long
def test_missions_whose_check_is_cancelled_are_written_and_said_to_be_unchecked(planned, tmp_path):
    plan, model = planned
    prepared = prepare_export(plan, model, FileFormat.MAVLINK_PLAN)

    def leave_at_the_check(function, *arguments):
        if function is judged:
            raise OperationCancelled("cancelled")
        return function(*arguments)

    paths, found = write_proved_export(
        prepared, model, FileFormat.MAVLINK_PLAN, tmp_path / "out.plan", leave_at_the_check
    )
    assert found is not None
    assert (found.severity, "cancelled" in found.message) == (Severity.NOTE, True)
    assert all(path.is_file() for path in (*paths, tmp_path / "out.plan.mission.proof"))


def test_formats_that_the_verifier_does_not_read_get_no_proof(planned, tmp_path):
    plan, model = planned
    prepared = prepare_export(plan, model, FileFormat.KML)
    paths, found = write_proved_export(prepared, model, FileFormat.KML, tmp_path / "out.kml", at_once)
    assert found is None
    assert list(tmp_path.iterdir()) == [*paths]


@pytest.mark.long
def test_what_a_proof_says_of_views_is_found_out_once_and_again_for_other_views(planned, tmp_path, monkeypatch):
    plan, model = planned
    found = []

    def counted(*arguments, **named):
        found.append(arguments)
        return find_reachable(*arguments, **named)

    monkeypatch.setattr(proofs, "find_reachable", counted)
    monkeypatch.setattr(proofs, "_last_known", {})
    proved = proofs.proved_as_saved(plan, model)
    assert proved.severity is Severity.OK, proved.message
    for name, heights in (("one.kmz", None), ("other.kmz", 30.0)):
        (tmp_path / name).mkdir()
        prepared = prepare_export(plan, model, FileFormat.DJI_KMZ, ExportOptions(rth_height_m=heights))
        paths, said = write_proved_export(prepared, model, FileFormat.DJI_KMZ, tmp_path / name / name, at_once)
        assert len(paths) == 1
        assert PROVED in said.message
    assert len(found) == 1
    other, whole = replace(plan, viewpoints=plan.viewpoints[::-1]), replace(model, site=replace(model.site, name="b"))
    proofs.proved_as_saved(other, model)
    proofs.proved_as_saved(other, model)
    assert len(found) == 2
    proofs.proved_as_saved(other, whole)
    assert len(found) == 3
