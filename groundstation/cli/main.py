"""The command line: finds the commands, runs one, and turns errors into one clear line and an exit status."""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import sys
import tempfile
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from groundstation.cli import commands
from planning.errors import GroundStationError, OperationCancelled

EXIT_DONE, EXIT_FAILED, EXIT_USAGE = 0, 1, 2


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.print_usage(sys.stderr)
        self.exit(EXIT_USAGE, f"{self.prog}: {message}\n")


def build_parser() -> argparse.ArgumentParser:
    """Parser with every module of `groundstation.cli.commands` as a command; none of them imports anything heavy."""
    parser = _Parser(
        prog="app.py",
        description="Reflight plans, checks and exports the second flight over a reflective glass facade. "
        "Without a command the window opens.",
    )
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    subparsers = parser.add_subparsers(title="commands", metavar="COMMAND")
    for module in pkgutil.iter_modules(commands.__path__):
        importlib.import_module(f"{commands.__name__}.{module.name}").add_parser(subparsers)
    return parser


def main(arguments: Sequence[str], open_window: Callable[[], int]) -> int:
    """Run one command, or the window without one; returns 0 done, 1 bad input or impossible, 2 wrong usage."""
    parser = build_parser()
    try:
        options = parser.parse_args(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        if not hasattr(options, "run"):
            return open_window()
        return int(options.run(options))
    except (OperationCancelled, KeyboardInterrupt):
        print("cancelled", file=sys.stderr)
        return EXIT_FAILED
    except GroundStationError as error:
        if options.debug:
            traceback.print_exc()
        print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
        return EXIT_FAILED
    except BrokenPipeError:
        return EXIT_FAILED
    except Exception as error:
        if options.debug:
            raise
        with tempfile.NamedTemporaryFile("w", suffix=".txt", prefix="reflight-", delete=False) as report:
            traceback.print_exc(file=report)
        print(
            f"error: Reflight failed where it should not ({type(error).__name__}: {' '.join(str(error).split())}); "
            f"please report it with {Path(report.name)}",
            file=sys.stderr,
        )
        return EXIT_FAILED
