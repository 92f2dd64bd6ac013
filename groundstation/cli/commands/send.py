"""`send`: a plan or DJI missions onto a card or a remote controller, read back from there and compared."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import print_findings, print_json, show, tell
from groundstation.cli.options import add_parameter, typed_values
from missions.formats.options import GROUP, ExportOptions
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.parameters import declared, with_values

if TYPE_CHECKING:
    from groundstation.services.mission.storages import Storage

APPS = ("pilot2", "dji-fly", "flighthub")

USEFUL = ("height_reference", "link_loss", "rth_height_m")
"""Of the options for mission files, those of DJI's."""

EPILOG = """pilot2     files go where --to says; in DJI Pilot 2: Flight Route, Import Route, choose the card
dji-fly    has no import: each sortie replaces a route that DJI Fly made; the old one is copied to --backup first
flighthub  files go into the folder waylines; import them on the web page of FlightHub 2

examples:
  send --list
  send office.plan.json --to /media/me/CARD
  send office.plan.json --to RC2 --as dji-fly --route 1A2B
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "send",
        help="put a plan onto a card or a remote controller of DJI, read back and compared",
        description="Write DJI missions onto a card or a connected remote controller, read them back from there, and\n"
        "compare them byte by byte and photo by photo with the plan.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("missions", type=Path, nargs="*", metavar="PLAN|MISSION", help="plan file, or .kmz files of one flight")
    add("--list", action="store_true", help="list cards and controllers that are connected, and routes of DJI Fly")
    add("--to", metavar="FOLDER|NAME", help="folder, or name of a device in --list (default: the only one there)")
    add("--as", dest="app", choices=APPS, help="which program reads them (default: by the folders that are there)")
    add("--route", action="append", default=[], metavar="ID", help="dji-fly: route to replace; once for each sortie")
    add("--name", metavar="NAME", help="of the mission there (default: that of the file)")
    add("--replace", action="store_true", help="replace another mission of the same name")
    add("--despite-errors", action="store_true", help="send a plan that is NOT ready to fly, at the pilot's own risk")
    add("--backup", type=Path, metavar="DIR", help="for copies of what is replaced (default: the user's data folder)")
    add("--site", type=Path, metavar="SITE", help="site file (default: the one beside the plan it was made for)")
    place = parser.add_argument_group(GROUP)
    for name, each in declared(ExportOptions).items():
        if name in USEFUL:
            add_parameter(place, each)
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """List or send; returns the exit status."""
    if options.list:
        return _list(options.json)
    return _send(options)


def _list(is_json: bool) -> int:
    from groundstation.services.mission.storages import find_storages

    found = find_storages()
    if is_json:
        print_json({"storages": [_summary(storage) for storage in found]})
        return 0
    if not found:
        tell(
            "no card or remote controller is connected; on Windows and macOS a controller that is connected by USB "
            "has no path: use its card"
        )
    for storage in found:
        show(say("{} ({}): {}", storage.name, storage.app, storage.folder))
        for route in storage.routes:
            changed = time.strftime("%Y-%m-%d %H:%M", time.localtime(route.modified_s))
            n = say("not readable") if route.n_waypoints is None else say("waypoints: {}", route.n_waypoints)
            show(say("  {}  {}  {}", route.id, changed, n))
    return 0


def _summary(storage: Storage) -> dict[str, Any]:
    return {
        "name": storage.name,
        "path": str(storage.root),
        "as": storage.app.value,
        "folder": str(storage.folder),
        "free_bytes": storage.free_bytes,
        "routes": [
            {"id": each.id, "modified_s": each.modified_s, "waypoints": each.n_waypoints} for each in storage.routes
        ],
    }


def _storage(options: argparse.Namespace) -> Storage:
    """Where to: what was named, or the only thing that is connected."""
    from groundstation.services.mission.storages import App, find_storages, storage_at

    app = None if options.app is None else App(options.app)
    if options.to is not None and ("/" in options.to or "\\" in options.to or Path(options.to).is_dir()):
        return storage_at(Path(options.to), app)
    found = find_storages()
    if options.to is not None:
        fitting = [each for each in found if each.name.casefold() == options.to.casefold()]
        if not fitting:
            names = ", ".join(each.name for each in found) or "-"
            raise InputError(say("there is no folder or device '{}'; connected: {}", options.to, names))
        found = tuple(fitting)
    if len(found) != 1:
        names = ", ".join(str(each.root) for each in found) or "-"
        raise InputError(say("name with --to where the mission goes; connected: {}", names))
    return storage_at(found[0].root, app)


def _send(options: argparse.Namespace) -> int:
    from dataclasses import replace

    from groundstation.cli.console import run_job
    from groundstation.services.mission.sending import payload_of_files, send, targets_of
    from groundstation.services.plan.planning import finding_summary
    from groundstation.services.settings import data_folder

    if not options.missions:
        raise InputError(say("name a plan or missions to send, or --list"))
    storage = _storage(options)
    export_options = with_values(ExportOptions(), typed_values(options, ExportOptions))
    payload = payload_of_files(options.missions, options.site, export_options)
    if options.name is not None:
        payload = replace(payload, name=options.name)
    targets, findings = targets_of(
        payload, storage, options.route, may_replace=options.replace, despite_errors=options.despite_errors
    )
    backups = options.backup or data_folder() / "replaced"
    sent = run_job("send", lambda context: send(payload, storage, targets, backups, context))
    if options.json:
        print_json(
            {
                "to": _summary(storage),
                "files": [
                    {
                        "path": str(each.path),
                        "bytes": each.n_bytes,
                        "sha256": each.sha256,
                        "backup": None if each.backup is None else str(each.backup),
                        "was_there": each.was_there,
                    }
                    for each in sent
                ],
                "findings": [finding_summary(finding) for finding in findings],
            }
        )
        return 0
    print_findings(findings)
    for each in sent:
        print(each.path)
        if each.backup is not None:
            tell("  what it replaced is kept: {}", each.backup)
    tell("read back and compared, files: {}; take the device out by the system's eject before you pull it", len(sent))
    return 0
