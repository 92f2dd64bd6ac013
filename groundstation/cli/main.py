"""The command line: finds the commands, runs one, and turns errors into one clear line and an exit status."""

from __future__ import annotations

import argparse
import importlib
import io
import os
import pkgutil
import sys
import tempfile
import traceback
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from groundstation import __version__
from groundstation.cli import commands
from groundstation.cli.console import program_name, show, speaking, tell, tell_compiling, worded
from groundstation.cli.options import new_folder
from groundstation.services.messages import LANGUAGES
from planning.base.errors import GroundStationError, OperationCancelled, PluginError, shortened
from planning.base.messages import glue, say
from planning.base.plugins import PluginGroup, new_plugin_problems, with_plugin_named

EXIT_DONE, EXIT_FAILED, EXIT_USAGE = 0, 1, 2


ARGPARSE = (
    *(say("usage: "), say("argument %(argument_name)s: %(message)s"), say("unrecognized arguments: %s")),
    *(say("the following arguments are required: %s"), say("one of the arguments %s is required")),
    *(say("invalid choice: %(value)r (choose from %(choices)s)"), say("invalid %(type)s value: %(value)r")),
    *(say("expected one argument"), say("expected at least one argument"), say("expected at most one argument")),
    *(say("not allowed with argument %s"), say("ignored explicit argument %r")),
    say("ambiguous option: %(option)s could match %(matches)s"),
)
"""What `argparse` says of wrong usage; it looks for translations by its function `_`, which is gettext's otherwise."""

argparse._ = lambda text: worded(text) if text in ARGPARSE else text  # type: ignore[attr-defined]


class _Parser(argparse.ArgumentParser):
    more_help: Callable[[], str] | None = None
    """Makes the end of the help, where that takes time or depends on what is installed."""

    def format_help(self) -> str:
        text = super().format_help()
        return text if self.more_help is None else text + self.more_help()

    def error(self, message: str) -> NoReturn:
        self.print_usage(sys.stderr)
        self.exit(EXIT_USAGE, f"{self.prog}: {worded(message)}\n")


class _Plugins(argparse.Action):
    """Lists the plug-ins; each is tried."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from groundstation.services.plugins import plugin_rows

        rows = plugin_rows()
        for row in rows:
            group = row.plugin.group.removeprefix("reflight.").replace("_", " ")
            standing = "" if row.problem is None else say(", left out")
            show(glue(f"{group:<17} {row.plugin.name:<20} {row.plugin.package}", standing))
        if not rows:
            tell("no plug-ins are installed (entry points of {})", ", ".join(PluginGroup))
        parser.exit()


@dataclass(frozen=True, slots=True)
class WindowOptions:
    """What the window is wanted for.

    Parameters
    ----------
    open
        Project folder or site file to begin with.
    screenshots
        Folder for pictures of every tab and state; the window closes by itself then.
    site
        Site file to take the pictures of.
    """

    open: Path | None = None
    screenshots: Path | None = None
    site: Path | None = None


OpenWindow = Callable[[WindowOptions], int]
"""Opens the window and returns the exit status once it is closed."""


@cache
def build_parser() -> argparse.ArgumentParser:
    """Parser with every module of `groundstation.cli.commands` as a command; none of them imports anything heavy.

    The same one each time: making it takes longer than most of what tests ask of it.
    """
    parser = _Parser(
        prog=program_name(),
        description="Reflight plans, checks and exports the second flight over a reflective glass facade. "
        "Without a command the window opens.",
    )
    parser.add_argument(
        "--version", action="version", version=f"Reflight {__version__}", help="show the version and exit"
    )
    parser.add_argument("--plugins", action=_Plugins, nargs=0, help="list what plug-ins add, and exit")
    parser.add_argument(
        "--language",
        choices=LANGUAGES,
        default=LANGUAGES[0],
        help="language of what is printed and of the brief, not of --json and -h (default: en)",
    )
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    window = parser.add_argument_group("the window")
    window.add_argument("--open", type=Path, metavar="PATH", help="project, finished model or site to begin with")
    window.add_argument(
        "--screenshots", type=new_folder, metavar="DIR", help="save pictures of every tab and state, and end"
    )
    window.add_argument("--site", type=Path, dest="pictured_site", metavar="SITE", help="site file for --screenshots")
    subparsers = parser.add_subparsers(title="commands", metavar="COMMAND")
    for module in pkgutil.iter_modules(commands.__path__):
        importlib.import_module(f"{commands.__name__}.{module.name}").add_parser(subparsers)
    return parser


def main(arguments: Sequence[str], open_window: OpenWindow) -> int:
    """Run one command, or the window without one; returns 0 done, 1 bad input or impossible, 2 wrong usage."""
    _make_streams_safe()
    status = _run(arguments, open_window)
    try:
        sys.stdout.flush()
    except OSError as error:
        if not isinstance(error, BrokenPipeError):
            message = say("the output cannot be written ({})", error.strerror or error)
            print(f"{worded('error')}: {worded(message)}", file=sys.stderr)
        # The interpreter flushes once more when it ends, and would complain then.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_FAILED
    return status


def _make_streams_safe() -> None:
    """Let no message fail over a character that the terminal lacks, or over a stream that is closed."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, io.StringIO())
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _report_plugin_problems() -> None:
    for problem in new_plugin_problems():
        print(f"{worded('warning')}: {_in_one_line(GroundStationError(str(problem)))}", file=sys.stderr)


def _run(arguments: Sequence[str], open_window: OpenWindow) -> int:
    with ExitStack() as stack:
        try:
            return _outcome(arguments, open_window, stack)
        finally:
            _report_plugin_problems()


def _language_of(arguments: Sequence[str]) -> str:
    """The language that is asked for, before the rest is looked at: wrong usage is told in it, too."""
    for option, value in zip(arguments, (*arguments[1:], ""), strict=False):
        typed = value if option == "--language" else option.partition("--language=")[2]
        if typed in LANGUAGES:
            return typed
    return LANGUAGES[0]


def _outcome(arguments: Sequence[str], open_window: OpenWindow, stack: ExitStack) -> int:
    debug = "--debug" in arguments
    try:
        stack.enter_context(speaking(_language_of(arguments)))
        parser = build_parser()
        options = parser.parse_args(arguments)
        stack.enter_context(speaking(options.language))
        request = WindowOptions(options.open, options.screenshots, options.pictured_site)
        if request.site is not None and request.screenshots is None:
            parser.error(say("--site without a command is for --screenshots"))
        if not hasattr(options, "run"):
            return open_window(request)
        if request != WindowOptions():
            parser.error(say("--open and --screenshots are for the window, which opens without a command"))
        stack.callback(tell_compiling())
        return int(options.run(options))
    except SystemExit as stop:
        return int(stop.code or 0)
    except (OperationCancelled, KeyboardInterrupt):
        show("cancelled", file=sys.stderr)
    except BrokenPipeError:
        pass  # whoever read the output has gone (| head)
    except (GroundStationError, OSError) as error:
        if debug:
            traceback.print_exc()
        print(f"{worded('error')}: {_in_one_line(error)}", file=sys.stderr)
    except Exception as error:
        if debug:
            raise
        _report(with_plugin_named(error))
    return EXIT_FAILED


def _report(error: BaseException) -> None:
    """Say that the program is at fault, or a plug-in, and where the traceback is."""
    if isinstance(error, PluginError):
        print(f"{worded('error')}: {_in_one_line(error)}", file=sys.stderr)
        return
    with tempfile.NamedTemporaryFile("w", suffix=".txt", prefix="reflight-", delete=False) as report:
        traceback.print_exc(file=report)
    failed = say(
        "Reflight failed where it should not ({}: {}); please report it with {}",
        *(type(error).__name__, _in_one_line(error), Path(report.name)),
    )
    print(f"{worded('error')}: {worded(failed)}", file=sys.stderr)


def _in_one_line(error: BaseException) -> str:
    """Message without line ends, and without the control characters that a damaged file can bring into it."""
    text = worded(str(error))
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {worded(error.strerror)}" if error.filename else worded(error.strerror)
    return shortened("".join(c if c.isprintable() else "?" for c in " ".join(text.split())))
