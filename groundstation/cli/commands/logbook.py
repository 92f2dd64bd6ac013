"""`logbook`: every flight of this user or of a project, the use of batteries, and both as tables."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

from groundstation.cli.console import print_json, show, tell
from planning.base.errors import InputError
from planning.base.files import check_ending
from planning.base.messages import say

EPILOG = """A flight is entered when it ends. Name the battery in the settings of the Fly tab, and its cycles
are counted.

examples:
  logbook
  logbook --project tower -o tower.csv
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "logbook",
        help="flights with aircraft, battery, times, place and findings",
        description="Show the log book of this user, or of a project, or write it as a table.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("--project", type=Path, metavar="DIR", help="the flights of a project alone")
    add("--simulated", action="store_true", help="simulated flights, too")
    add("-o", "--out", type=Path, metavar="FILE", help="table to write (.csv)")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Show or write; returns the exit status."""
    from groundstation.services.fly.connection import flights_folder
    from groundstation.services.fly.log_book import battery_uses, book_path, read_book, write_book_csv
    from groundstation.services.project.project_file import is_project
    from planning.base.json_file import plain_values

    path = book_path(None if options.project is None else flights_folder(options.project))
    if options.project is not None and not path.exists() and not is_project(options.project):
        raise InputError.say(
            "expected the folder of a project, found none of that name; check the path", place=options.project
        )
    every = read_book(path)
    entries = [each for each in every if options.simulated or not each.is_simulated]
    uses = battery_uses(every)
    if options.out is not None:
        check_ending(options.out, (".csv",))
        write_book_csv(options.out, entries)
    if options.json:
        print_json({"flights": plain_values(entries), "batteries": plain_values(uses)})
        return 0
    if not entries:
        tell("no flights yet; simulated ones: {} (--simulated)", len(every), place=path)
    for each in entries:
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(each.started_unix_s))
        show(
            say(
                "{}  {:5.1f} min  {}, {}, photos: {} of {}",
                *(when, each.duration_s / 60.0, each.site, each.aircraft, each.n_photos, each.n_planned),
            )
        )
        if each.ended:
            show(say("    {}", each.ended))
    for use in uses:
        show(say("battery {}: flights: {}, cycles: {:.1f}", use.name, use.n_flights, use.cycles))
    if options.out is not None:
        print(options.out)
    return 0
