"""The tabs of the window, along the pilot's work. Every module of this package is one tab, found by itself.

A tab module has a constant `TAB`, a `TabSpec`: where the tab stands and how it is made. The module itself must import
nothing heavy: what it needs is imported when the tab is first shown.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Protocol

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QWidget

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.shared_view import Stage

CONTEXT = "Tabs"
"""Translation context of the titles and tips of all tabs: `QT_TRANSLATE_NOOP("Tabs", "Site")`."""


class Place(Enum):
    """Where a tab's widgets stand: beside and below the shared view of the site, or in place of it all."""

    AROUND_VIEW = auto()
    WHOLE_PAGE = auto()


class Tab(Protocol):
    """One tab, once it is made. Widgets that it has none of are None.

    Attributes
    ----------
    left, right, bottom
        Stand around the shared view; a tab in place of it has `left` only, as its page.
    """

    left: QWidget
    right: QWidget | None
    bottom: QWidget | None

    def shown(self) -> None:
        """The tab came to the front: take the shared view over."""

    def hidden(self) -> None:
        """Another tab came to the front: give tools and overlays back."""

    def actions(self) -> tuple[QAction, ...]:
        """What stands in the tab's menu, with shortcuts."""


@dataclass(frozen=True, slots=True)
class TabSpec:
    """How a tab is announced and made.

    Parameters
    ----------
    order
        Tabs stand in this order; shortcut Ctrl+1 is the first.
    title, tip
        English, marked with `QT_TRANSLATE_NOOP(CONTEXT, ...)`.
    make
        Called when the tab is first shown.
    implementation
        Module that `make` imports, where that takes long: it is imported on another thread before it is needed.
    """

    order: int
    name: str
    title: str
    tip: str
    place: Place
    make: Callable[[ApplicationContext, Stage], Tab]
    implementation: str = ""

    def shown_title(self) -> str:
        """Title in the user's language."""
        return QCoreApplication.translate(CONTEXT, self.title)

    def shown_tip(self) -> str:
        """Tip in the user's language."""
        return QCoreApplication.translate(CONTEXT, self.tip)


def find_tabs() -> tuple[TabSpec, ...]:
    """All tabs, in order."""
    modules = (importlib.import_module(f"{__name__}.{module.name}") for module in pkgutil.iter_modules(__path__))
    return tuple(sorted((module.TAB for module in modules), key=lambda spec: spec.order))


__all__ = ["CONTEXT", "QT_TRANSLATE_NOOP", "Place", "Tab", "TabSpec", "find_tabs"]
