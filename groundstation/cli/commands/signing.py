"""`signing`: the key that MAVLink links are signed with."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from groundstation.cli.console import show, tell, worded
from planning.base.errors import InputError
from planning.base.messages import say

EPILOG = """A vehicle with a key takes orders from whoever knows it, and from nobody else. The key lies in the system's
key store where the package keyring is installed, else in a file that only you may read; never in a project.

examples:
  signing set                         asks for a passphrase; the same one makes the same key elsewhere
  signing give serial:/dev/ttyACM0:115200   over a cable: whoever listens learns the key
  simulate PLAN SITE -o FLIGHT --link tcp:127.0.0.1:5760 --signed
  signing withdraw serial:/dev/ttyACM0:115200
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "signing",
        help="the key that links to vehicles are signed with",
        description="Make, forget and hand out the key of MAVLink 2 signing.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("action", choices=("set", "status", "forget", "give", "withdraw"), help="what to do with the key")
    add("url", nargs="?", metavar="URL", help="with give and withdraw: link to the vehicle")


def run(options: argparse.Namespace) -> int:
    """Do it; returns the exit status."""
    from groundstation.services.fly import signing

    if (options.url is None) == (options.action in ("give", "withdraw")):
        raise InputError(say("give and withdraw want the url of a link; set, status and forget want none"))
    match options.action:
        case "set":
            signing.set_passphrase(_passphrase())
            tell("key kept; give it to a vehicle with 'signing give URL', over a cable")
        case "status":
            show(say("there is a key") if signing.has_key() else say("there is no key"))
        case "forget":
            signing.forget_passphrase()
            tell("there is no key any more; vehicles that know it keep it")
        case "give":
            vehicle = signing.give_key(options.url)
            tell("vehicle {} has the key and signs with it", vehicle.system)
        case _:
            vehicle = signing.withdraw_key(options.url)
            tell("vehicle {} was told to sign no more", vehicle.system)
    return 0


def _passphrase() -> str:
    """What is typed, twice and unseen; from a pipe, its first line."""
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    from getpass import getpass

    first = getpass(worded(say("passphrase: ")))
    if getpass(worded(say("once more: "))) != first:
        raise InputError(say("the two passphrases differ; nothing was changed"))
    return first
