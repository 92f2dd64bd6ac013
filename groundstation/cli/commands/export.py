"""`export`: a plan to mission files, or a model to the formats of other programs."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import print_findings, print_json, print_notes, run_job, tell
from groundstation.cli.options import PluginNames, add_parameter, in_words_of_options, typed_values, words
from groundstation.services.model.export import (
    EXPORTERS,
    GROUP,
    ModelExport,
    ModelExporter,
    export_model,
    model_exporter,
)
from missions.formats.options import GROUP as MISSION_GROUP
from missions.formats.options import ExportOptions
from missions.formats.registry import FORMATS, mission_format
from planning.base.messages import say
from planning.base.parameters import declared, with_values
from planning.base.plugins import PluginGroup

ALL_MODELS = PluginNames(EXPORTERS, PluginGroup.MODEL_FORMATS)
ALL_FORMATS = PluginNames((*FORMATS, *EXPORTERS), PluginGroup.MISSION_FORMATS, PluginGroup.MODEL_FORMATS)


def _line(name: str, exporter: ModelExporter) -> str:
    """What a format is for, as a line of the help."""
    ending = exporter.endings[0] if exporter.endings else "folder"
    return f"  {name:<12}  {ending:<11}  {exporter.about}\n"


EPILOG = f"""formats of models:
{"".join(_line(name, each) for name, each in EXPORTERS.items())}
examples:
  export office.plan.json --format dji-kmz -o office.kmz
  export tower.gsscene --format web -o tower.web
  export tower.gsscene --format spz --preset small -o tower.spz
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "export",
        help="write a plan as a mission for DJI or MAVLink, or a model for other programs",
        description="Write mission files of a plan, or a model in a format of other programs. Of missions the first\n"
        "sortie gets the name given, further ones NAME-2, NAME-3 and so on (KML and CSV hold all sorties).",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.more_help = ALL_FORMATS.help_on_plugins
    add = parser.add_argument
    add("plan", type=Path, metavar="PLAN|MODEL", help="plan file; or folder of a model, or of its objects")
    add(
        "--format",
        required=True,
        choices=ALL_FORMATS,
        metavar="FORMAT",
        help=f"of plans {', '.join(FORMATS)}; of models below",
    )
    add("-o", "--out", type=Path, required=True, metavar="FILE", help="file to write; web and 3d-tiles: folder")
    add("--site", type=Path, metavar="SITE", help="site file (default: the one beside the plan it was made for)")
    mission, model = parser.add_argument_group(MISSION_GROUP), parser.add_argument_group(GROUP)
    for place, record in ((mission, ExportOptions), (model, ModelExport)):
        for each in declared(record).values():
            add_parameter(place, each)
    model.add_argument("--components", type=words, metavar="LIST", help="such as A,background (default: all)")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Export and print; returns the exit status."""
    return _export_model(options) if options.format in ALL_MODELS else _export_plan(options)


def _left_out(options: argparse.Namespace) -> list[str]:
    """Notes on options that were typed and that the format has no use for."""
    name = options.format
    of_missions = {"--site": "site"} | {each.parameter.option: key for key, each in declared(ExportOptions).items()}
    of_models = {each.parameter.option: key for key, each in declared(ModelExport).items()}
    of_models["--components"] = "components"
    typed = {option: getattr(options, option[2:].replace("-", "_"), None) for option in (*of_missions, *of_models)}
    if name in ALL_MODELS:
        model = model_exporter(name)
        useful = {option for option, key in of_models.items() if model.takes(key, typed["--gaussians"])}
    else:
        mission = mission_format(name)
        useful = {option for option, key in of_missions.items() if key == "site" or mission.takes(key)}
    return [
        say("{} is left out: the format {} has no use for it", option, name)
        for option, value in typed.items()
        if value is not None and option not in useful
    ]


def _export_model(options: argparse.Namespace) -> int:
    left_out = _left_out(options)
    with in_words_of_options(ModelExport):
        typed = typed_values(options, ModelExport)
        export = with_values(ModelExport(options.format, components=options.components), typed)
    done = run_job("export", lambda context: export_model(options.plan, options.out, export, context))
    notes = [*left_out, *done.notes]
    if options.json:
        print_json({"file": str(done.path), "format": options.format, "bytes": done.n_bytes, "notes": notes})
        return 0
    tell("{:.3g} MB", done.n_bytes / 1e6, place=done.path)
    print_notes(notes)
    return 0


def _export_plan(options: argparse.Namespace) -> int:
    from groundstation.services.mission.export import export_plan
    from groundstation.services.plan.planning import finding_summary
    from planning.base.findings import Finding, Severity

    export_options = with_values(ExportOptions(), typed_values(options, ExportOptions))
    left_out = [Finding(Severity.WARNING, "option-left-out", text) for text in _left_out(options)]
    paths, found = export_plan(options.plan, options.format, options.out, options.site, export_options)
    findings = (*left_out, *found)
    if options.json:
        print_json(
            {
                "files": [str(path) for path in paths],
                "format": options.format,
                "heights": export_options.height_reference.value,
                "findings": [finding_summary(finding) for finding in findings],
            }
        )
    else:
        for path in paths:
            print(path)
        print_findings(each for each in findings if each.severity is not Severity.OK or each.code == "proof")
    return 0
