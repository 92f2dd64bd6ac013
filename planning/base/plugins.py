"""Plug-ins: what other packages add to Reflight by entry points (`importlib.metadata`).

A package names what it adds in its `pyproject.toml`, under one of four groups; the name of the entry point is the name
on the command line, and what it stands for is documented by the registry of its kind:

    [project.entry-points."reflight.mission_formats"]
    flight-table = "my_package:FLIGHT_TABLE"

Nothing is looked for before a registry is asked for something that it does not have itself, and nothing is imported
before a list of the registry is shown. A plug-in that cannot be used is left out, and said by name:
`new_plugin_problems`.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from typing import TYPE_CHECKING, TypeVar

from planning.base.errors import GroundStationError, InputError, PluginError
from planning.base.messages import glue, say

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

T = TypeVar("T")
R = TypeVar("R")

NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")
"""Names that can be typed on every command line without quotes."""


class PluginGroup(StrEnum):
    """Groups of entry points, by what their plug-ins add."""

    AIRCRAFT = "reflight.aircraft"
    MISSION_FORMATS = "reflight.mission_formats"
    MODEL_FORMATS = "reflight.model_formats"
    TRAINING_METHODS = "reflight.training_methods"


@dataclass(frozen=True, slots=True)
class Plugin:
    """An entry point of an installed package; `package` is its name and version."""

    group: PluginGroup
    name: str
    package: str
    entry_point: EntryPoint = field(repr=False)

    def __str__(self) -> str:
        return say("the plug-in '{}' of {}", self.name, self.package)


@dataclass(frozen=True, slots=True)
class PluginProblem:
    """A plug-in that was left out, and why."""

    plugin: Plugin
    reason: str

    def __str__(self) -> str:
        return say("{} is left out: {}; update it, or remove it", self.plugin, self.reason)


_PROBLEMS: list[PluginProblem] = []
_REPORTED: list[PluginProblem] = []
"""Of this process, as its plug-ins are: each is imported once."""


@cache
def installed_plugins(group: PluginGroup) -> tuple[Plugin, ...]:
    """The plug-ins of a group, by name; none of them is imported."""
    from importlib.metadata import entry_points

    found = (Plugin(group, each.name, _package(each), each) for each in entry_points(group=group))
    return tuple(sorted(found, key=lambda plugin: (plugin.name, plugin.package)))


def _package(entry_point: EntryPoint) -> str:
    known = entry_point.dist
    return say("an unknown package") if known is None else f"{known.metadata['Name']} {known.version}"


def load_plugins(group: PluginGroup, take: Callable[[Plugin, object], T], taken: Collection[str]) -> dict[str, T]:
    """What the plug-ins of a group add, by name; those that cannot be used become problems.

    Parameters
    ----------
    take
        Makes of a plug-in and what its entry point stands for what the registry holds. Whatever it raises, the plug-in
        is left out.
    taken
        Names that the registry has itself: no plug-in takes the place of another thing.
    """
    found: dict[str, T] = {}
    for plugin in installed_plugins(group):
        try:
            if not NAME.fullmatch(plugin.name):
                raise InputError.say("its name has other characters than a-z, 0-9, dot, hyphen and underscore")
            if plugin.name in taken or plugin.name in found:
                raise InputError.say("there is another one of that name")
            found[plugin.name] = take(plugin, plugin.entry_point.load())
        except (Exception, SystemExit) as error:  # it is the code of others
            leave_out(plugin, error)
    return found


def leave_out(plugin: Plugin, error: BaseException) -> None:
    """Note that a plug-in cannot be used."""
    if all(problem.plugin != plugin for problem in _PROBLEMS):
        _PROBLEMS.append(PluginProblem(plugin, _reason(error)))


def _reason(error: BaseException) -> str:
    if isinstance(error, GroundStationError):
        return glue(error)
    text = " ".join(str(error).split())
    return text if text and isinstance(error, ValueError) else f"{type(error).__name__}: {text}"


def expect_type(found: object, expected: type[T]) -> T:
    """What an entry point stands for.

    Raises
    ------
    InputError
        It is of another type.
    """
    if not isinstance(found, expected):
        raise InputError.say(
            "expected its entry point to stand for a {}, got {}", expected.__name__, type(found).__name__
        )
    return found


def guarded(plugin: Plugin, call: Callable[..., R], returns: type[R]) -> Callable[..., R]:
    """A function of a plug-in whose mistakes are told as those of the plug-in.

    Raises
    ------
    PluginError
        When called: it failed by another error than those that Reflight knows, or returned something else.
    """

    @functools.wraps(call)
    def guarded_call(*values: object, **named: object) -> R:
        try:
            found = call(*values, **named)
        except (GroundStationError, OSError):
            raise
        except Exception as error:
            raise _failure(plugin, error) from error
        if not isinstance(found, returns):
            raise _failure(
                plugin, TypeError(say("expected a {} from it, got {}", returns.__name__, type(found).__name__))
            )
        return found

    return guarded_call


def guarded_question(plugin: Plugin, call: Callable[..., bool]) -> Callable[..., bool]:
    """A question that every plug-in is asked: one that fails at it says no, and is noted as a problem."""

    @functools.wraps(call)
    def doubted_call(*values: object) -> bool:
        try:
            return bool(call(*values))
        except Exception as error:  # it is the code of others
            leave_out(plugin, error)
            return False

    return doubted_call


def with_plugin_named(error: BaseException) -> BaseException:
    """The error to tell: one that nobody expected, and that went through the code of a plug-in, names the plug-in."""
    if isinstance(error, (GroundStationError, OSError)) or not isinstance(error, Exception):
        return error
    plugins = [plugin for group in PluginGroup for plugin in installed_plugins(group)]
    modules = {plugin.entry_point.module.partition(".")[0]: plugin for plugin in plugins}
    traceback = error.__traceback__
    while traceback is not None:
        module = str(traceback.tb_frame.f_globals.get("__name__", "")).partition(".")[0]
        if module in modules:
            found = _failure(modules[module], error)
            found.__cause__ = error
            return found
        traceback = traceback.tb_next
    return error


def _failure(plugin: Plugin, error: Exception) -> PluginError:
    return PluginError.say("{} failed: {}: {}; update it, or remove it", plugin, type(error).__name__, error)


def plugin_problems() -> tuple[PluginProblem, ...]:
    """All plug-ins that were left out so far."""
    return tuple(_PROBLEMS)


def plugin_problem(group: PluginGroup, name: str) -> PluginProblem | None:
    """Why the plug-in of that name was left out, for a message; None where there is no such plug-in."""
    found = next((each for each in _PROBLEMS if (each.plugin.group, each.plugin.name) == (group, name)), None)
    if found is not None and found not in _REPORTED:
        _REPORTED.append(found)
    return found


def new_plugin_problems() -> tuple[PluginProblem, ...]:
    """Those of `plugin_problems` that nobody has asked for before: each is told to the user once."""
    untold = tuple(problem for problem in _PROBLEMS if problem not in _REPORTED)
    _REPORTED.extend(untold)
    return untold
