"""`logbook`: every flight of this user or of a project, the use of batteries, both as tables, and flights by hand."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, print_json, run_job, show, tell
from groundstation.cli.options import above_zero, add_time, count, planned_time
from planning.base.errors import InputError
from planning.base.files import check_ending
from planning.base.messages import say

if TYPE_CHECKING:
    from groundstation.services.fly.log_book import BookEntry, StatedSortie
    from planning.base.findings import Finding

EPILOG = """A flight over a link is entered when it ends. Name the battery in the settings of the Fly tab, and its
cycles are counted. Flights of missions that were sent by card are entered with 'logbook add'.

examples:
  logbook
  logbook --project tower -o tower.csv
  logbook add office.plan.json --photos DCIM/100MEDIA --battery B1 --battery B2
"""

ADD_EPILOG = """Options that may be repeated count for the sorties in their order; --minutes once counts for all.
With --photos, --at moves the times of a camera whose clock was wrong.
What a flight takes of its battery is reckoned from its minutes and the aircraft's endurance.

examples:
  logbook add office.plan.json --at 2026-06-21T10:30 --battery B1 --battery B2
  logbook add office.plan.json --at 2026-06-21T10:30 --sortie 2 --minutes 14 --remarks "gusts at the north side"
  logbook add office.plan.json --photos DCIM/100MEDIA
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
    actions = parser.add_subparsers(title="actions", metavar="ACTION")
    _add_adding(actions)


def _add_adding(actions: Any) -> None:
    command = actions.add_parser(
        "add",
        help="enter a flight of a plan that this program did not watch",
        description="Enter a flight that was flown by a card or another program, as the pilot states it.",
        epilog=ADD_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run_add)
    add = command.add_argument
    add("plan", type=Path, metavar="PLAN", help="plan file")
    add("--site", type=Path, metavar="SITE", help="site file (default: the one beside the plan it was made for)")
    add_time(command)
    add("--photos", type=Path, metavar="DIR", help="folder of the flight's photos, whose times are taken")
    add("--sortie", type=count, action="append", default=[], metavar="N", help="that was flown (default: all)")
    add(
        "--minutes", type=above_zero, action="append", default=[], metavar="M", help="of a sortie (default: as planned)"
    )
    add("--battery", action="append", default=[], metavar="NAME", help="of a sortie; its cycles are counted")
    add("--aircraft", default="", metavar="NAME", help="what was flown (default: the plan's)")
    add("--remarks", default="", metavar="TEXT", help="the pilot's")
    # What stands before the action counts, too.
    add("--project", type=Path, default=argparse.SUPPRESS, metavar="DIR", help="enter it in the book of a project, too")
    add("--json", action="store_true", default=argparse.SUPPRESS, help="print one JSON object instead of text")


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


def run_add(options: argparse.Namespace) -> int:
    """Enter a flight and print it; returns the exit status."""
    from groundstation.services.fly.connection import flights_folder
    from groundstation.services.fly.log_book import book_path, enter_stated
    from groundstation.services.project.project_file import is_project
    from planning.base.json_file import plain_values

    books = [book_path()]
    if options.project is not None:
        if not is_project(options.project):
            raise InputError.say(
                "expected the folder of a project, found none of that name; check the path", place=options.project
            )
        books.append(book_path(flights_folder(options.project)))
    entries = _stated(options)
    enter_stated(entries, books)
    if options.json:
        print_json({"entered": plain_values(entries)})
        return 0
    for each in entries:
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(each.started_unix_s))
        values = (each.sortie, when, each.duration_s / 60.0, each.aircraft, each.battery or "-")
        show(say("entered: sortie {}, {}, {:.1f} min, {}, battery {}", *values))
    return 0


def _stated(options: argparse.Namespace) -> tuple[BookEntry, ...]:
    """The flight as the options and its photos say it."""
    from dataclasses import replace

    from groundstation.services.fly.log_book import flight_of_photos, sorties_as_planned, stated_entry
    from groundstation.services.fly.options import flight_settings_path, read_flight_settings
    from groundstation.services.mission.export import find_site
    from groundstation.services.project.input_files import read_input_plan
    from planning.photos.folder import read_photos

    plan, at = read_input_plan(options.plan), planned_time(options)
    site_model = find_site(plan, options.plan, options.site)
    if site_model is None:
        text = "the site that this plan was made for is not beside it; name its file, too"
        raise InputError.say(text, place=options.plan)
    wrong = next((number for number in options.sortie if number > len(plan.sorties)), None)
    if wrong is not None:
        raise InputError.say("the plan has no sortie {}; it has {}", wrong, counted(len(plan.sorties), "sortie"))
    findings: tuple[Finding, ...] = ()
    if options.photos is not None:
        photos = read_photos(options.photos).photos
        stated, findings = run_job(
            "logbook", lambda context: flight_of_photos(plan, site_model, photos, str(options.photos), context)
        )
        moved_s = 0.0 if at is None else at.timestamp() - stated[0].started_unix_s
        stated = tuple(replace(each, started_unix_s=each.started_unix_s + moved_s) for each in stated)
    elif at is None:
        raise InputError.say("state the take-off with --at, such as 2026-06-21T10:30, or name the --photos")
    else:
        stated = sorties_as_planned(plan, at.timestamp(), options.sortie)
    if options.sortie:
        stated = tuple(each for each in stated if each.number in options.sortie)
    operator = read_flight_settings(flight_settings_path()).operator
    told = {"aircraft": options.aircraft, "remarks": options.remarks, "operator": operator, "findings": findings}
    return tuple(stated_entry(each, plan, site_model.site, **told) for each in _as_typed(stated, options))


def _as_typed(stated: tuple[StatedSortie, ...], options: argparse.Namespace) -> tuple[StatedSortie, ...]:
    """Minutes and batteries as they were typed, in the order of the sorties."""
    from dataclasses import replace

    if not stated:
        raise InputError.say(
            "the photos show none of these sorties; state the take-off with --at", place=options.photos
        )
    minutes = options.minutes * len(stated) if len(options.minutes) == 1 else options.minutes
    for name, typed in (("--minutes", minutes), ("--battery", options.battery)):
        if len(typed) > len(stated):
            raise InputError.say("named {} times, and {} to be entered", len(typed), len(stated), place=name)
    times = {number: 60.0 * value for number, value in enumerate(minutes)}
    batteries = dict(enumerate(options.battery))
    typed_so: list[StatedSortie] = []
    for number, each in enumerate(stated):
        start_s = each.started_unix_s
        if options.photos is None and typed_so:  # one that took longer than planned puts off the next
            start_s = max(start_s, typed_so[-1].started_unix_s + typed_so[-1].duration_s)
        battery, duration_s = batteries.get(number, "").strip(), times.get(number, each.duration_s)
        typed_so.append(replace(each, started_unix_s=start_s, duration_s=duration_s, battery=battery))
    return tuple(typed_so)
