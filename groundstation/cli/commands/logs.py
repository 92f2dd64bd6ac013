"""`logs`: the autopilot's own logs, over the link."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import print_json, print_next, run_job, show, tell
from groundstation.cli.options import count, new_folder
from planning.base.messages import say

if TYPE_CHECKING:
    from groundstation.services.fly.onboard_logs import KeptLog

EPILOG = """Over MAVFTP: pieces that are lost are asked for again, and the whole file is proved by the vehicle's
checksum. Vehicles without it are asked by the log protocol, which has no checksums; what broke off goes on where it
ended. A telemetry radio takes an hour for some ten megabytes; use USB or Wi-Fi. Not in flight.

examples:
  logs tcp:127.0.0.1:5760 --list
  logs serial:/dev/ttyACM0:115200 -o flights
  report PLAN SITE --log flights/00000042.BIN
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "logs",
        help="fetch the autopilot's own logs after a flight",
        description="List the logs on the card of an ArduPilot or PX4, or fetch the newest ones.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("url", metavar="URL", help="link to the vehicle, such as serial:/dev/ttyACM0:115200 or udp:0.0.0.0:14550")
    add("names", nargs="*", metavar="NAME", help="of logs (default: the newest)")
    add("-o", "--out", type=new_folder, metavar="DIR", default=Path(), help="folder for the logs (default: this one)")
    add("--newest", type=count, default=1, metavar="N", help="number of logs to fetch (default: 1)")
    add("--list", action="store_true", help="list what is on the vehicle, and fetch nothing")
    add("--signed", action="store_true", help="sign the link (see 'signing')")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """List or fetch, and print; returns the exit status."""
    from groundstation.services.fly.onboard_logs import fetch_logs, list_logs
    from groundstation.services.fly.signing import link_signer

    signer = link_signer() if options.signed else None
    if options.list:
        files = run_job("logs", lambda context: list_logs(options.url, signer, context))
        if options.json:
            print_json({"logs": [{"name": each.name, "path": each.path, "bytes": each.n_bytes} for each in files]})
        else:
            for each in files:
                show(say("{:>12.3f} MB  {}", each.n_bytes / 1e6, each.name))
        return 0
    kept = run_job(
        "logs",
        lambda context: fetch_logs(options.url, options.out, options.newest, options.names, signer, context),
    )
    if options.json:
        print_json({"files": [_summary(each) for each in kept]})
        return 0
    for log in kept:
        print(log.path)
        if not log.is_checked:
            tell("  the vehicle knows no checksums: this log is not proved")
    print_next("report", "PLAN", "SITE", *(part for log in kept for part in ("--log", log.path)))
    return 0


def _summary(kept: KeptLog) -> dict[str, Any]:
    return {
        "path": str(kept.path),
        "log": kept.file.path,
        "bytes": kept.file.n_bytes,
        "is_checked": kept.is_checked,
        "was_there": kept.was_there,
    }
