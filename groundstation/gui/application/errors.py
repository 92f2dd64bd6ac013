"""Errors of the program itself, in painting, say, or in the rows of a list: the window tells of them and goes on.

PySide takes an error in a method that Qt calls for an object. Python 3.11 makes one of what its own functions raise, a
division by zero or a number that is none, only where somebody catches it. Unless that is done before the method is
left, PySide 6.8 to 6.12 end the process there with a segmentation fault. 3.12 always makes it.
"""

from __future__ import annotations

import builtins
import inspect
import sys
import traceback
from collections.abc import Callable
from functools import cache, update_wrapper
from pathlib import Path
from types import CodeType, FunctionType, TracebackType
from typing import TYPE_CHECKING, Any

from planning.base.findings import Severity

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext

OBJECTS_SINCE = (3, 12)
"""Version of Python from which on errors are objects from the first."""


def make_errors_objects() -> None:
    """Have classes that are made from now on, other packages' too, catch the errors of what Qt calls and raise them."""
    build = builtins.__build_class__
    if sys.version_info >= OBJECTS_SINCE or hasattr(build, "__wrapped__"):
        return

    def build_class(*arguments: Any, **named: Any) -> Any:
        made = build(*arguments, **named)
        if type(made).__module__ == "Shiboken":
            _wrap_overrides(made)
        return made

    builtins.__build_class__ = update_wrapper(build_class, build)


def _wrap_overrides(made: type) -> None:
    of_qt = [base for base in made.__mro__[1:] if base.__module__.startswith("PySide6.")]
    for name, function in tuple(vars(made).items()):
        if isinstance(function, FunctionType) and name[:2] != "__" and any(hasattr(base, name) for base in of_qt):
            setattr(made, name, catching(function))


def catching(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that catches what another one raises, and raises it again. PySide counts its parameters: they stay."""
    scope: dict[str, Any] = {"_called": function}
    exec(_program(*_parameters(function.__code__)), scope)
    caught = scope["caught"]
    caught.__defaults__, caught.__kwdefaults__ = function.__defaults__, function.__kwdefaults__
    return update_wrapper(caught, function)


@cache
def _program(taken: str, given: str) -> CodeType:
    """Of the function that catches; most methods have the parameters of many others."""
    lines = (f"def caught({taken}):", " try:", f"  return _called({given})", " except BaseException:", "  raise")
    return compile("\n".join(lines), "<override>", "exec")


def _parameters(code: CodeType) -> tuple[str, str]:
    """Of a function, as they are written where it is defined and where it is called."""
    n, n_named, names = code.co_argcount, code.co_kwonlyargcount, list(code.co_varnames)
    named, others = names[n : n + n_named], names[n + n_named :]
    taken, given = names[:n], names[:n]
    if code.co_flags & inspect.CO_VARARGS:
        rest = f"*{others.pop(0)}"
        taken, given = [*taken, rest], [*given, rest]
    elif named:
        taken = [*taken, "*"]
    taken, given = [*taken, *named], [*given, *(f"{name}={name}" for name in named)]
    if code.co_flags & inspect.CO_VARKEYWORDS:
        rest = f"**{others.pop(0)}"
        taken, given = [*taken, rest], [*given, rest]
    return ", ".join(taken), ", ".join(given)


def tell_errors(context: ApplicationContext) -> None:
    """Have the user told of errors that nobody catches, of each place once: some come with every picture."""
    from PySide6.QtCore import QCoreApplication, QTimer

    told: set[tuple[str, int | None]] = set()

    def tell(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        sys.__excepthook__(kind, error, trace)
        frames = traceback.extract_tb(trace)
        place = (Path(frames[-1].filename).name, frames[-1].lineno) if frames else ("", None)
        if place in told or not issubclass(kind, Exception):
            return
        told.add(place)
        text = QCoreApplication.translate(
            "Errors",
            "The program made a mistake ({0}: {1}; {2}, line {3}). It goes on, but what you did last may not be done. "
            "Save your project, and report this line.",
        )
        words = text.format(kind.__name__, error, *place)
        QTimer.singleShot(0, context, lambda: context.say(Severity.ERROR, words))

    sys.excepthook = tell
