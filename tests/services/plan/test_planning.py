"""Use cases around plans: planning writes what it returns, checks look at files."""

import json
import time
from dataclasses import replace

import pytest

from groundstation.services.plan.planning import (
    _shortfalls,
    check_files,
    finding_summary,
    locked_viewpoints,
    plan_document_site,
    plan_site,
    planned_summary,
)
from planning import planner
from planning.base.errors import InfeasibleError, InputError, OperationCancelled
from planning.base.findings import Finding, Severity, is_flyable
from planning.checks import check_plan
from planning.parameters import DEFAULT_SHARE, Constraints
from planning.plan import read_plan, write_plan
from planning.request import PlanRequest
from planning.site.bundled import SCENES, write_scene
from planning.site.file import read_site, write_site
from tests.planning.revision.cases import QUICK


@pytest.fixture
def site(tmp_path):
    return write_scene("single-panel", tmp_path)


def test_the_plan_returned_is_the_plan_written_and_passes_its_check(site, tmp_path):
    out = tmp_path / "plan.json"
    planned = plan_site(site, PlanRequest(n_views=4, greedy=QUICK), out)
    assert read_plan(out) == planned.plan
    assert is_flyable(check_files(out, site))


def test_without_an_output_nothing_is_written(site, tmp_path):
    before = set(tmp_path.iterdir())
    assert len(plan_site(site, PlanRequest(n_views=2, greedy=QUICK), None).plan.viewpoints) == 2
    assert set(tmp_path.iterdir()) == before


def test_impossible_wishes_and_cancelled_work_write_nothing(site, tmp_path):
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled("cancelled")

    before = set(tmp_path.iterdir())
    with pytest.raises(InfeasibleError):
        plan_site(site, PlanRequest(constraints=Constraints(min_distance_m=400.0)), tmp_path / "plan.json")
    with pytest.raises(OperationCancelled):
        plan_site(site, PlanRequest(), tmp_path / "plan.json", monitor=Cancelling())
    with pytest.raises(InputError, match="would replace"):
        plan_site(site, PlanRequest(), site)
    assert set(tmp_path.iterdir()) == before


FEWEST = 100
"""Views that are routed however late it is; 700 take long."""


@pytest.mark.slow
def test_where_the_time_is_up_the_most_telling_views_are_flown_and_the_rest_is_told(monkeypatch):
    monkeypatch.setattr(planner, "FEWEST_ROUTED", FEWEST)
    model = SCENES["library"]()
    request = PlanRequest(n_views=160, time_budget_s=5.0, greedy=QUICK)
    planned = plan_document_site(model, request, started_s=time.perf_counter() - 10.0)
    assert len(planned.plan.viewpoints) == FEWEST
    assert is_flyable(check_plan(planned.plan, model))
    told = {finding.code: finding for finding in planned.findings}
    assert told["time-budget"].severity is Severity.WARNING
    assert told["time-budget"].value == 160 - FEWEST
    assert "fewer-views" not in told, "more time would have shown more"
    # The first of 160 views are not the best 100: those that were left out show what others show, too.
    few = plan_document_site(model, replace(request, n_views=FEWEST), started_s=time.perf_counter() - 10.0)
    assert planned.plan.coverage.covered >= 0.98 * few.plan.coverage.covered


@pytest.mark.slow
def test_no_more_views_are_left_out_than_the_time_asks_for(site, monkeypatch):
    monkeypatch.setattr(planner, "FEWEST_ROUTED", FEWEST)
    request = PlanRequest(n_views=FEWEST + 50, time_budget_s=5.0, greedy=QUICK)
    planned = plan_document_site(read_site(site), request, started_s=time.perf_counter() - 10.0)
    assert len(planned.plan.viewpoints) == FEWEST, "though a third of them show all there is"


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("request_", "codes"),
    [
        (PlanRequest(n_views=3, greedy=QUICK), []),
        (PlanRequest(n_views=300, greedy=QUICK), ["fewer-views"]),
        (PlanRequest(n_batteries=9, greedy=QUICK, time_budget_s=0.5), ["fewer-sorties"]),
        (PlanRequest(n_batteries=1, greedy=QUICK, time_budget_s=0.5), []),
        (PlanRequest(share=0.5, greedy=QUICK), []),
        (PlanRequest(share=1.0, method="noto", time_budget_s=5.0), ["less-coverage"]),
    ],
)
def test_a_plan_that_falls_short_of_the_request_says_so(site, request_, codes):
    planned = plan_site(site, request_, None)
    # Whether half a second lasts to compare all viewpoints depends on the computer.
    told = [finding for finding in planned.findings if finding.code != "few-compared"]
    assert [finding.code for finding in told] == codes
    for finding in told:
        assert finding.value < finding.limit


@pytest.mark.long
def test_no_end_of_gains_is_claimed_that_the_plan_written_does_not_have(site):
    """The clock is made to have run out long before: too few candidates are compared for what the battery could do."""
    office, stop_at = SCENES["office"](), PlanRequest(least_gain_db=0.2, greedy=QUICK, time_budget_s=5.0)
    late = plan_document_site(office, stop_at, started_s=time.perf_counter() - 1000.0)
    worth = late.plan.worth
    assert late.is_cut_short
    assert worth.gain_db > 0.25, "or there is nothing to tell"
    codes = {finding.code: finding for finding in late.findings}
    assert codes["few-compared"].severity is Severity.NOTE
    told = codes["not-good-enough"]
    assert told.severity is Severity.WARNING
    assert (told.value, told.limit) == (worth.gain_db, 0.2)
    assert f"{worth.gain_db:.1f} dB" in told.message
    assert "time did not last" in told.message
    assert worth.batteries[-1].n_photos == len(late.plan.viewpoints)
    assert worth.batteries[-1].n_batteries == len(late.plan.sorties)
    reached = _shortfalls(replace(stop_at, least_gain_db=worth.gain_db + 0.1), late)
    assert "not-good-enough" not in {finding.code for finding in reached}


@pytest.mark.long
def test_the_goal_that_stands_where_none_was_set_is_not_missed_in_silence(site):
    """The time is up before anything is proved, so that far less is covered than what counts as possible."""
    request = PlanRequest(time_budget_s=5.0, greedy=QUICK)
    told = [
        {
            finding.code: finding.limit
            for finding in plan_document_site(read_site(site), each, started_s=time.perf_counter() - 10.0).findings
        }
        for each in (request, replace(request, share=DEFAULT_SHARE))
    ]
    assert told[0] == told[1]
    assert told[0]["less-coverage"] == DEFAULT_SHARE
    assert "open-undecided" in told[0]


@pytest.mark.parametrize("goal", [{"n_views": 4}, {"n_batteries": 1}, {"least_gain_db": 0.5}, {"method": "noto"}])
def test_no_share_is_wanted_where_something_else_was_asked_for(goal):
    assert PlanRequest(**goal).wanted_share is None


@pytest.mark.slow
def test_a_lower_flight_than_usual_is_allowed_and_said_and_the_plan_holds_it(site, tmp_path):
    low = replace(PlanRequest(n_views=12, greedy=QUICK), constraints=Constraints(min_height_above_ground_m=2.5))
    out = tmp_path / "low.plan.json"
    planned = plan_site(site, low, out)
    assert [finding.code for finding in planned.findings] == ["low-flight-allowed"]
    assert read_plan(out).constraints.min_height_above_ground_m == 2.5
    assert planned_summary(planned, 1.0)["lowest_height_m"] < 5.0
    found = {finding.code: finding.severity for finding in check_files(out, site)}
    assert (found["low-flight"], found["low-flight-allowed"]) == (Severity.OK, Severity.WARNING)
    usual = plan_site(site, PlanRequest(n_views=12, greedy=QUICK), tmp_path / "usual.plan.json")
    summary = planned_summary(usual, 1.0)
    assert usual.plan.constraints.min_height_above_ground_m == 5.0
    assert 5.0 <= summary["lowest_height_m"] < 10.0 < summary["below_10_m_s"] < summary["duration_s"]


@pytest.mark.slow
def test_the_lowest_height_of_the_site_holds_where_none_is_asked_for(site, tmp_path):
    model = read_site(site)
    airspace = replace(model.site.airspace, min_height_above_ground_m=9.0)
    write_site(tmp_path / "high.site.json", replace(model.site, airspace=airspace))
    planned = plan_site(tmp_path / "high.site.json", PlanRequest(n_views=6, greedy=QUICK), None)
    assert planned.plan.constraints.min_height_above_ground_m == 9.0
    assert min(viewpoint.position_enu_m[2] for viewpoint in planned.plan.viewpoints) >= 9.0
    again = plan_document_site(planned.prepared.site_model, PlanRequest(n_views=5, greedy=QUICK), planned.prepared)
    assert again.prepared is planned.prepared
    lower = Constraints(min_height_above_ground_m=6.0)
    other = plan_document_site(
        planned.prepared.site_model, PlanRequest(n_views=5, greedy=QUICK, constraints=lower), planned.prepared
    )
    assert other.prepared is not planned.prepared


def test_summaries_are_json(site):
    planned = plan_site(site, PlanRequest(n_views=3, greedy=QUICK), None)
    summary = planned_summary(planned, 1.23456)
    assert json.loads(json.dumps(summary, allow_nan=False)).keys() == summary.keys()
    assert summary["seconds"] == 1.235
    assert [count["covered"] for count in summary["depth"]] == sorted(
        (count["covered"] for count in summary["depth"]), reverse=True
    )
    assert finding_summary(Finding(Severity.WARNING, "code", "text", "place", 1.0, 2.0, "m")) == {
        "severity": "warning",
        "code": "code",
        "message": "text",
        "place": "place",
        "value": 1.0,
        "limit": 2.0,
        "unit": "m",
    }


@pytest.mark.slow
def test_planning_an_open_site_again_uses_what_the_first_plan_prepared_where_it_fits(site):
    model, request = read_site(site), PlanRequest(n_views=3, greedy=QUICK)
    first = plan_document_site(model, request)
    again = plan_document_site(model, replace(request, n_views=4), first.prepared)
    assert again.prepared is first.prepared
    for other in (replace(request, seed=1), replace(request, constraints=Constraints(min_distance_m=8.0))):
        assert plan_document_site(model, other, first.prepared).prepared is not first.prepared
    cut_short = replace(first.prepared, is_cut_short=True)
    assert plan_document_site(model, request, cut_short).prepared is not cut_short


def test_locked_viewpoints_are_read_from_a_plan_that_has_some(site, tmp_path):
    path = tmp_path / "plan.json"
    plan = plan_site(site, PlanRequest(n_views=3, greedy=QUICK), path).plan
    with pytest.raises(InputError, match=r"plan\.json: none of the viewpoints is locked"):
        locked_viewpoints(path)
    held = replace(plan.viewpoints[1], locked=True)
    write_plan(path, replace(plan, viewpoints=(plan.viewpoints[0], held, plan.viewpoints[2])))
    assert locked_viewpoints(path) == (held,)
    assert path.read_text().count('"locked":') == 1
