"""The camera of a plan: its settings changed, and what they mean: who sets them, and what photos come of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from groundstation.services.mission.export import find_site
from groundstation.services.project.input_files import read_input_plan
from groundstation.services.project.project_file import check_not_index
from groundstation.vehicle.camera import WantedSetting, wanted_settings
from missions.formats.camera_steps import CameraSteps, camera_steps
from missions.mavlink.camera_definition import read_definition
from missions.mission.build import missions_from_plan
from planning.aircraft.camera_use import camera_use_of, controls_of
from planning.aircraft.catalogue import profile
from planning.base.effects import Decision
from planning.base.errors import GroundStationError, InputError
from planning.base.findings import Finding
from planning.base.json_file import check_output
from planning.base.parameters import with_values
from planning.base.progress import QUIET, Monitor
from planning.checks.camera import CAMERA_RULES, camera_effects
from planning.checks.case import Case
from planning.optics import CameraControls
from planning.parameters import CameraSettings
from planning.plan import Plan, write_plan
from planning.site.records import SiteModel

CODES = frozenset(("camera", "motion-blur", "rolling-shutter", "depth-of-field", "mirror-focus"))
"""Of the findings of `CAMERA_RULES`."""


@dataclass(frozen=True, slots=True)
class CameraReport:
    """What the camera settings of a plan mean.

    Parameters
    ----------
    summary, cost
        All that is set, in one line, and what its depth of field costs.
    findings
        Of the rules about the camera; empty where the site is not known.
    effects
        What the camera does to photos, and whether it shows; empty likewise.
    """

    plan: Plan
    summary: str
    cost: str
    steps: CameraSteps
    findings: tuple[Finding, ...]
    effects: tuple[Decision, ...] = ()


def with_camera(plan: Plan, settings: CameraSettings) -> Plan:
    """A plan with other settings of its camera; nothing else of it depends on them."""
    return replace(plan, camera_settings=settings, camera_controls=controls_of(plan))


def changed_settings(settings: CameraSettings, values: Mapping[tuple[str, ...], Any]) -> CameraSettings:
    """Settings with some values changed; who gives a focus distance wants the focus there, and nowhere else has one.

    Raises
    ------
    ValueError
        They do not go together.
    """
    changes = dict(values)
    focus = changes.get(("focus",), settings.focus)
    if ("focus_distance_m",) in changes and ("focus",) not in changes:
        changes["focus",] = "distance"
    elif focus != "distance":
        changes.setdefault(("focus_distance_m",), None)
    return with_values(settings, changes)


def camera_report(plan: Plan, site_model: SiteModel | None, monitor: Monitor = QUIET) -> CameraReport:
    """What a plan's camera settings mean."""
    if site_model is None:
        return _report(plan, ())
    case = Case.of(plan, site_model)
    findings = tuple(finding for rule in CAMERA_RULES for finding in rule(case))
    return replace(_report(plan, findings), effects=camera_effects(case))


def report_of_findings(plan: Plan, findings: Iterable[Finding]) -> CameraReport:
    """What a plan's camera settings mean, of findings of all rules that were made already."""
    found = tuple(finding for finding in findings if finding.code in CODES)
    return _report(plan, found)


def _report(plan: Plan, findings: tuple[Finding, ...]) -> CameraReport:
    use = camera_use_of(plan)
    return CameraReport(plan, use.summary(), use.cost(), camera_steps(plan), findings)


def settable(plan: Plan | None, profile_id: str) -> CameraControls | None:
    """What can be set on the camera of a plan; without one, on that of a profile. None where nobody knows."""
    if plan is not None:
        return controls_of(plan)
    try:
        return profile(profile_id).controls
    except GroundStationError:  # its file is gone, as the form of the plan says
        return None


def set_by_definition(plan: Plan, path: Path) -> tuple[WantedSetting, ...]:
    """Parameters of a camera that a flight of a plan would set, by the camera's definition file.

    Raises
    ------
    InputError
        The file cannot be read, is none, or nobody knows what the plan's camera can set.
    """
    definition = read_definition(path)
    settings = wanted_settings(missions_from_plan(plan)[0], definition)
    if not settings:
        raise InputError.say("the plan has no camera whose settings are known; name an aircraft profile with one")
    return settings


def camera_files(
    plan_path: Path,
    site_path: Path | None,
    values: Mapping[tuple[str, ...], Any],
    out: Path | None,
    monitor: Monitor = QUIET,
) -> CameraReport:
    """Change the camera settings of a plan file, and say what they mean.

    Parameters
    ----------
    site_path
        Its site; None: the one beside it, where there is one.
    out
        Where the plan is written; None: nowhere.

    Raises
    ------
    InputError
        A file cannot be read or written.
    ValueError
        The settings do not go together.
    """
    plan = read_input_plan(plan_path)
    plan = with_camera(plan, changed_settings(plan.camera_settings, values))
    if out is not None:
        check_not_index(out)
        check_output(out, [] if out == plan_path else [plan_path])
    report = camera_report(plan, find_site(plan, plan_path, site_path), monitor)
    if out is not None:
        write_plan(out, plan)
    return report
