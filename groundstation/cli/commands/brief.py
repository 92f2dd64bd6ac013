"""`brief`: the flight brief for the pilot, as one HTML page to be printed."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from groundstation.cli.console import print_json, run_job, tell
from groundstation.cli.options import add_day, add_parameter, flight_day, in_words_of_options, typed_values
from planning.base.messages import say
from planning.base.parameters import declared, with_values
from planning.insight.ground_risk_request import GroundRiskRequest

SUFFIXES = (".html", ".htm")


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "brief",
        help="write the flight brief: sorties, times, batteries, findings, map",
        description="Write what the pilot needs on paper as one HTML page, which any browser prints. The window makes "
        "a PDF of it (Mission, Flight brief), with the map under it where one is loaded.",
    )
    parser.set_defaults(run=run)
    parser.add_argument("plan", type=Path, metavar="PLAN", help="plan file")
    parser.add_argument("site", type=Path, metavar="SITE", help="site file")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE", help="HTML file to write")
    parser.add_argument(
        "--units", choices=("metric", "imperial"), default="metric", help="imperial is laid out for Letter"
    )
    parser.add_argument("--paper", choices=("a4", "letter"), help="paper size (default: by the units)")
    add_day(parser)
    risk = parser.add_argument_group("ground risk (SORA 2.5), in the brief where any of these is given")
    for name in ("population", "wind_m_s", "reaction_s", "speed_m_s"):
        add_parameter(risk, declared(GroundRiskRequest)[name])
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Write the brief; returns the exit status."""
    from datetime import date

    from groundstation.services.jobs.runner import JobContext
    from groundstation.services.messages import localized, on_paper, translation
    from groundstation.services.mission.brief import flight_brief
    from groundstation.services.mission.brief_html import brief_html, brief_pictures, sources_in_page
    from groundstation.services.mission.proof import proof_of_files
    from groundstation.services.mission.readiness import Readiness, preflight
    from groundstation.services.project.input_files import read_input_plan, read_input_site
    from groundstation.services.units import UnitSystem
    from planning.base.errors import InputError
    from planning.base.json_file import check_output, write_atomically

    if options.out.suffix.lower() not in SUFFIXES:
        raise InputError(
            say(
                "expected a name that ends in .html; a PDF is made from the window (Mission, Flight brief) or by "
                "printing the page in a browser",
                place=options.out,
            )
        )
    typed, risk = typed_values(options, GroundRiskRequest), None
    if typed:
        with in_words_of_options(GroundRiskRequest):
            risk = with_values(GroundRiskRequest(), typed)
    check_output(options.out, [options.plan, options.site])
    plan, site_model = read_input_plan(options.plan), read_input_site(options.site)
    units, day = UnitSystem(options.units), flight_day(options)
    words, titles = translation(options.language), translation(options.language, "Brief")

    def localize(text: str) -> str:
        return on_paper(localized(text, words, units))

    def work(context: JobContext) -> tuple[str, Readiness, int]:
        found = preflight(plan, site_model, day, context)
        proved = proof_of_files(options.plan, options.site)
        today = date.today().isoformat()
        findings = (*found.findings, *([] if proved is None else [proved]))
        brief = flight_brief(
            site_model, plan, findings, today, options.plan.name, day=day, sun=found.sun, ground_risk=risk
        ).in_words(localize)
        sources = sources_in_page(brief_pictures(site_model, plan, units, titles, found.sun, localize))
        is_letter = None if options.paper is None else options.paper == "letter"
        return brief_html(brief, units, sources, titles, is_letter=is_letter), brief.readiness, len(brief.findings)

    page, readiness, n_findings = run_job("brief", work)
    write_atomically(options.out, page.encode())
    is_flyable = readiness is not Readiness.NOT_READY
    if options.json:
        summary = {"flyable": is_flyable, "readiness": readiness.value, "findings": n_findings}
        print_json({"file": str(options.out), **summary})
    else:
        print(options.out)
        if not is_flyable:
            tell("the plan is NOT ready to fly: the brief lists why", file=sys.stderr)
    return 0
