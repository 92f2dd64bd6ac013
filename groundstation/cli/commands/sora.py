"""`sora`: ground risk of a plan by SORA 2.5 as a filled draft, with volumes for maps."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import print_findings, print_json, run_job, show, tell, worded
from groundstation.cli.options import add_parameter, count, in_words_of_options, new_folder, typed_values
from planning.base.messages import say
from planning.base.parameters import declared, with_values
from planning.insight.ground_risk_request import GroundRiskRequest

EPILOG = """people below (--population), as SORA 2.5 counts them per square kilometre:
  controlled  nobody who is not involved     suburban  fewer than 5000
  remote      fewer than 5                   city      fewer than 50000
  lightly     fewer than 50                  assembly  more
  sparsely    fewer than 500

examples:
  sora office.plan.json office.site.json -o sora --population controlled --wind 8
  sora office.plan.json office.site.json -o sora --population 1200 --speed 5 --reaction 2
  sora office.plan.json office.site.json -o sora --population-raster GHS_POP_E2020_R5_C19.tif
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "sora",
        help="ground risk by SORA 2.5: volumes, buffer and class, as a draft to be checked",
        description="Flight geography, contingency volume and ground-risk buffer of a plan's paths, and its ground\n"
        "risk class: each number with its formula and source. A draft that the operator has to check.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("plan", type=Path, metavar="PLAN", help="plan file")
    add("site", type=Path, metavar="SITE", help="site file")
    add("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder for table, KML and GeoJSON")
    groups: dict[str, Any] = {}
    for each in declared(GroundRiskRequest).values():
        heading = each.parameter.group
        if heading not in groups:
            groups[heading] = parser.add_argument_group(heading)
        add_parameter(groups[heading], each)
    add("--fly-aways", type=count, metavar="N", help="simulated against the buffer (default 300)")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Assess, write and print; returns the exit status."""
    from groundstation.services.mission.sora import (
        N_FLY_AWAYS,
        buffer_text,
        class_text,
        simulated_text,
        sora_draft,
        sora_summary,
        write_sora,
    )
    from groundstation.services.project.input_files import read_input_plan, read_input_site

    with in_words_of_options(GroundRiskRequest):
        request = with_values(GroundRiskRequest(), typed_values(options, GroundRiskRequest))
    plan, site_model = read_input_plan(options.plan), read_input_site(options.site)
    n, name = options.fly_aways or N_FLY_AWAYS, options.plan.name
    draft = run_job("sora", lambda context: sora_draft(plan, site_model, request, name, None, n, context))
    raster = [Path(each) for each in (request.population_raster, request.terrain_raster) if each is not None]
    sources = [options.plan, options.site, *raster]
    paths = write_sora(draft, options.out, worded, sources)
    if options.json:
        print_json({"files": [str(path) for path in paths], **sora_summary(draft)})
        return 0
    risk = draft.risk
    for line in (buffer_text(risk), class_text(risk), simulated_text(draft.fly_aways)):
        show(line)
    show(say("uninvolved people inside: {}", risk.people_allowed))
    for path in paths:
        print(path)
    print_findings(draft.findings)
    tell("a draft: check every number before you use it")
    return 0
