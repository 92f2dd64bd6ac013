"""docs/reference/commands.md: every command with its options, as its own help has them."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from unittest import mock

from groundstation.cli.main import build_parser

HEADER = """# Commands

Written by `make docs` (`python -m tests.docs`) from the parsers of `groundstation.cli`; do not edit by hand. Every
command is `reflight COMMAND` where the program is installed, and `.venv/bin/python app.py COMMAND` in a checkout; `-h`
says the same as this page. Exit status: 0 done; 1 the input is bad or the job cannot be done, with one line on stderr;
2 wrong usage.
"""


def page() -> str:
    """Text of the page."""
    with mock.patch.dict("os.environ", {"COLUMNS": "110"}):
        parser = build_parser()
        parts = [HEADER, _options(parser, "## Without a command: the window")]
        for name, command in _children(parser):
            parts.append(_section(name, command, "##"))
            parts += [_section(f"{name} {child}", each, "###") for child, each in _children(command)]
    return "\n".join(parts)


def _children(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            yield from sorted(action.choices.items())


def _section(name: str, parser: argparse.ArgumentParser, level: str) -> str:
    usage = " ".join(parser.format_usage().removeprefix("usage: ").split())
    usage = usage.replace(parser.prog, f"reflight {name}", 1)
    lines = [f"{level} {name}\n", _sentence(parser.description or "") + "\n"]
    if not any(_children(parser)) or parser.get_default("run") is not None:  # some do something without an action, too
        lines.append(f"```text\n{_wrapped(usage)}\n```\n")
        lines.append(_options(parser, ""))
    if parser.epilog:
        lines.append(f"```text\n{parser.epilog.strip()}\n```\n")
    return "\n".join(line for line in lines if line)


def _options(parser: argparse.ArgumentParser, title: str) -> str:
    actions = [
        action
        for action in parser._actions
        if not isinstance(action, (argparse._HelpAction, argparse._SubParsersAction))
        and action.help is not argparse.SUPPRESS
    ]
    lines = [title + "\n"] if title else []
    if actions:
        lines += ["| option | meaning |", "| --- | --- |"]
        lines += [f"| {_name(action)} | {_cell(_help(parser, action))} |" for action in actions]
    return "\n".join(lines) + "\n"


def _name(action: argparse.Action) -> str:
    values = "{" + ",".join(map(str, action.choices)) + "}" if action.choices else action.metavar
    value = " ".join(values) if isinstance(values, tuple) else values or action.dest.upper()
    if not action.option_strings:
        return _cell(f"`{value}`")
    takes = f" {value}" if action.nargs != 0 else ""
    return _cell(f"`{', '.join(action.option_strings)}{takes}`")


def _help(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    text = parser._get_formatter()._expand_help(action) if action.help else ""
    return f"{text} (required)" if action.required and action.option_strings else text


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _sentence(text: str) -> str:
    return re.sub(r"\s+", " ", text).strip()


def _wrapped(text: str, width: int = 100) -> str:
    lines, line = [], ""
    for word in re.findall(r"\[[^\]]*\]|\S+", text):
        if line and len(line) + len(word) + 1 > width:
            lines.append(line)
            line = "   "
        line = f"{line} {word}".rstrip() if line else word
    return "\n".join([*lines, line])
