"""The demonstration: the whole main job on the bundled sites, from site file to mission files and a flight."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from groundstation.services.fly.flying import FlightRequest, Flown, fly_files
from groundstation.services.mission.export import export_plan
from groundstation.services.mission.proof import PAGE, VERIFIER
from groundstation.services.mission.readiness import preflight
from groundstation.services.plan.planning import plan_site
from missions.formats.registry import FORMATS
from planning.base.files import make_folder
from planning.base.findings import Finding, is_flyable
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.plan import read_plan
from planning.planner import Planned
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site


@dataclass(frozen=True, slots=True)
class Demonstration:
    """What the demonstration made, and what the checks found on the plan and on its mission files.

    A plan that is not ready to fly is not flown: `flight_path` and `flown` are None then.
    """

    site_path: Path
    plan_path: Path
    planned: Planned
    findings: tuple[Finding, ...]
    mission_paths: tuple[Path, ...]
    proof_paths: tuple[Path, ...]
    export_findings: tuple[Finding, ...]
    flight_path: Path | None
    flown: Flown | None


def demonstrate(
    folder: Path, scene: str = "office", request: PlanRequest = PlanRequest(), monitor: Monitor = QUIET
) -> Demonstration:
    """Make a bundled site, plan, check, export and simulate it into `folder`.

    Raises
    ------
    InputError
        The folder cannot be made.
    """
    make_folder(folder)
    site_path = write_scene(scene, folder)
    plan_path = folder / f"{scene}.plan.json"
    planned = plan_site(site_path, request, plan_path, monitor=monitor)
    findings = preflight(read_plan(plan_path), read_site(site_path), monitor=monitor).findings
    missions: list[Path] = []
    export_findings: list[Finding] = []
    for file_format, kind in FORMATS.items():
        monitor.report(say("exporting"), len(missions), 0)
        paths, found = export_plan(plan_path, file_format, folder / f"{scene}{kind.endings[0]}", site_path)
        missions += paths
        export_findings += found
    flight_path = flown = None
    if is_flyable(findings):
        flight_path = folder / f"{scene}.flight.json"
        flown = fly_files(plan_path, site_path, flight_path, FlightRequest(), monitor=monitor)
    checkers = folder / VERIFIER.name, folder / PAGE.name
    proofs = (*sorted(folder.glob("*.proof")), *sorted(folder.glob("*.plan.json"))[1:], *checkers)
    checked = findings, tuple(missions), proofs, tuple(export_findings)
    return Demonstration(site_path, plan_path, planned, *checked, flight_path, flown)
