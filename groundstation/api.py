"""The public Python API: what programs may build on, documented in docs/reference/api.md.

All else may change without notice. Names are those of the modules that they come from, and each function is the use
case that the command of the same name runs. Only programs import this module, never the command line, which has to
start fast; torch is loaded when a training begins.
"""

from __future__ import annotations

from groundstation import __version__
from groundstation.services.fly.flying import FlightRequest, Flown, fly_files
from groundstation.services.mission.export import export_plan, import_missions
from groundstation.services.mission.readiness import preflight
from groundstation.services.model.export import ModelExport, ModelExporter, ModelToExport, WrittenModel, export_model
from groundstation.services.plan.planning import plan_site
from groundstation.services.reconstruct.training import TrainedFiles, train_files
from missions.formats.options import EncodedFiles, ExportOptions
from missions.formats.registry import MissionFormat, mission_formats, read_missions
from missions.mission.export_choices import FileFormat
from missions.mission.model import Mission, ReadMission
from planning.aircraft.catalogue import Profile, profile, profiles
from planning.base.errors import GroundStationError, InfeasibleError, InputError, MissionError, OperationCancelled
from planning.base.findings import Finding, Severity
from planning.parameters import Constraints
from planning.plan import Plan, read_plan, write_plan
from planning.planner import Planned, plan_flight
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site, write_site
from planning.site.records import Site, SiteModel
from reconstruction.training.method_registry import Method, training_methods
from reconstruction.training.parameters import TrainRequest

__all__ = [
    "Constraints",
    "EncodedFiles",
    "ExportOptions",
    "FileFormat",
    "Finding",
    "FlightRequest",
    "Flown",
    "GroundStationError",
    "InfeasibleError",
    "InputError",
    "Method",
    "Mission",
    "MissionError",
    "MissionFormat",
    "ModelExport",
    "ModelExporter",
    "ModelToExport",
    "OperationCancelled",
    "Plan",
    "PlanRequest",
    "Planned",
    "Profile",
    "ReadMission",
    "Severity",
    "Site",
    "SiteModel",
    "TrainRequest",
    "TrainedFiles",
    "WrittenModel",
    "__version__",
    "export_model",
    "export_plan",
    "fly_files",
    "import_missions",
    "mission_formats",
    "plan_flight",
    "plan_site",
    "preflight",
    "profile",
    "profiles",
    "read_missions",
    "read_plan",
    "read_site",
    "train_files",
    "training_methods",
    "write_plan",
    "write_scene",
    "write_site",
]
