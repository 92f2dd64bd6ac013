"""Fly a plan with the simulated aircraft; `plan.py` makes the plan."""

from pathlib import Path

from groundstation.api import FlightRequest, fly_files

plan, site, out = (Path(name) for name in ("flight.plan.json", "single-panel.site.json", "flight.flight.json"))
flown = fly_files(plan, site, out, FlightRequest())
summary = flown.flight.report.summary
print(f"{summary.n_taken} photos taken, {summary.covered} hemisphere sections covered")
