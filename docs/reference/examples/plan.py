"""Plan a flight over a bundled site."""

from pathlib import Path

from groundstation.api import PlanRequest, plan_site, preflight, read_plan, read_site, write_scene

site = write_scene("single-panel", Path())
planned = plan_site(site, PlanRequest(n_views=12), Path("flight.plan.json"))
plan = read_plan(Path("flight.plan.json"))
print(f"{len(plan.viewpoints)} views cover {plan.coverage.covered} of {plan.coverage.total} hemisphere sections")
for finding in preflight(plan, read_site(site)).findings:
    print(finding.severity, finding.code, finding.message)
