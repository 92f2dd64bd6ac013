"""`sun`: when facades have even light, when the sun is in photos, and when to fly."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any

from groundstation.cli.console import print_json, run_job, show
from groundstation.cli.options import effect_settings, number
from planning.base.errors import InputError
from planning.base.messages import say

CLOCK = re.compile(r"([01]?\d|2[0-4]):([0-5]\d)")

DESCRIPTION = """\
Say when each facade has even light on a day, and for a plan also which take-off times spoil the fewest photos: by the
sun or its mirror image in the picture, by facades that are in the sun in part, and by sun that blinds the pilot who
watches the aircraft from home. Sorties are put in order by that. Times are good to 2 minutes where panes stand as the
site has them; a pane that leans by 0.1 degrees more shifts its glare by 0.8 minutes.

FILES are a site file, or a plan file and its site file. Clouds are not known.
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "sun",
        help="when facades have even light and no photo shows the sun",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("files", type=Path, nargs="+", metavar="FILE", help="SITE, or PLAN SITE")
    add("--day", metavar="DATE", help="such as 2026-06-21 (default: today)")
    zone = parser.add_mutually_exclusive_group()
    zone.add_argument("--zone", metavar="NAME", help="time zone, such as Europe/Berlin (default: this computer's)")
    zone.add_argument("--utc-offset", type=number, metavar="HOURS", help="time zone, as hours ahead of UTC")
    add("--from", dest="first", default="00:00", metavar="HH:MM", help="no flight before (default: 00:00)")
    add("--until", dest="last", default="24:00", metavar="HH:MM", help="no flight after (default: 24:00)")
    add("--pause", type=number, default=5.0, metavar="MIN", help="between two sorties (default: 5)")
    add(
        "--shortest",
        type=number,
        default=10.0,
        metavar="S",
        help="glare that lasts so long is found for certain; less takes longer (default: 10)",
    )
    add(
        "--effects",
        action="append",
        default=[],
        metavar="SETTING",
        help="auto, none, all, or NAME=on|off|auto; names are sun-in-panes, cast-shadows and measured-tilts-of-panes",
    )
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Look at the day; returns the exit status."""
    from datetime import date

    from groundstation.services.mission.sunlight import (
        SunRequest,
        local_zone,
        sun_lines,
        sun_report,
        sun_summary,
        zone_named,
        zone_of_offset,
    )
    from groundstation.services.project.input_files import read_input_plan, read_input_site
    from planning.insight.sunlight import MIRRORS, SHADOWS, TILTS

    if len(options.files) > 2:
        raise InputError(
            say("expected a site file, or a plan file and its site file, got {} files", len(options.files))
        )
    try:
        day = date.today() if options.day is None else date.fromisoformat(options.day)
    except ValueError as error:
        raise InputError(say("expected a day such as 2026-06-21, got '{}'", options.day, place="--day")) from error
    zone = local_zone(day)
    if options.zone is not None:
        zone = zone_named(options.zone)
    elif options.utc_offset is not None:
        zone = zone_of_offset(options.utc_offset)
    first, last = _minute("--from", options.first), _minute("--until", options.last)
    if first >= last:
        raise InputError(
            say("expected an earlier time than --until {}, got {}", options.last, options.first, place="--from")
        )
    if options.pause < 0.0:
        raise InputError(say("expected 0 or more, got {:g}", options.pause, place="--pause"))
    if not 1.0 <= options.shortest <= 600.0:
        raise InputError(say("expected 1 to 600 seconds, got {:g}", options.shortest, place="--shortest"))
    effects = tuple(effect_settings(options.effects, [MIRRORS, SHADOWS, TILTS]).items())
    request = SunRequest(day, zone, first, last, 60.0 * options.pause, options.shortest, effects)
    plan = read_input_plan(options.files[0]) if len(options.files) == 2 else None
    site_model = read_input_site(options.files[-1])
    report = run_job("sun", lambda context: sun_report(site_model, plan, request, context))
    if options.json:
        print_json(sun_summary(report))
        return 0
    for line in sun_lines(report):
        show(line)
    return 0


def _minute(option: str, text: str) -> int:
    found = CLOCK.fullmatch(text)
    minute = 60 * int(found[1]) + int(found[2]) if found is not None else -1
    if not 0 <= minute <= 24 * 60:
        raise InputError(say("expected a time of day such as 08:30, got '{}'", text, place=option))
    return minute
