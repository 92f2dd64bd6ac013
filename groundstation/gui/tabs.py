"""The tabs of the window, along the pilot's work: one row of `TABS` each.

A row says where the tab stands and which class it is. That class is imported, with all that it needs, when the tab is
first shown.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Protocol

from PySide6.QtCore import QCoreApplication
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QWidget

from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.application.translate import QT_TRANSLATE_NOOP

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.shared_view import SharedView
    from groundstation.services.project.steps import Act

CONTEXT = "Tabs"
"""Translation context of the titles and tips of all tabs."""


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

    def take_step(self, act: Act) -> None:
        """Do what leads on from here, where that is something of this tab: see `services.project.steps`."""


@dataclass(frozen=True, slots=True)
class TabSpec:
    """How a tab is announced and made.

    Parameters
    ----------
    title, tip
        English, marked with `QT_TRANSLATE_NOOP("Tabs", ...)`.
    module, class_name
        What the tab is an instance of. The window imports the module on another thread before it is needed.
    """

    name: str
    title: str
    tip: str
    place: Place
    module: str
    class_name: str

    def begin(self, context: ApplicationContext, view: SharedView) -> Tab:
        """The tab itself; a `GradualTab` is only begun."""
        kind = getattr(importlib.import_module(self.module), self.class_name)
        tab: Tab = kind(context, view, at_once=False) if issubclass(kind, GradualTab) else kind(context, view)
        return tab

    def shown_title(self) -> str:
        """Title in the user's language."""
        return QCoreApplication.translate(CONTEXT, self.title)

    def shown_tip(self) -> str:
        """Tip in the user's language."""
        return QCoreApplication.translate(CONTEXT, self.tip)


TABS = (
    TabSpec(
        "start",
        QT_TRANSLATE_NOOP("Tabs", "Start"),
        QT_TRANSLATE_NOOP("Tabs", "Where to begin: a sample, your projects, and three ways to a new one"),
        Place.WHOLE_PAGE,
        "groundstation.gui.start_page",
        "StartPage",
    ),
    TabSpec(
        "site",
        QT_TRANSLATE_NOOP("Tabs", "Site"),
        QT_TRANSLATE_NOOP("Tabs", "The building, its glass, and where you may fly"),
        Place.AROUND_VIEW,
        "groundstation.gui.site.site_panels",
        "SiteTab",
    ),
    TabSpec(
        "plan",
        QT_TRANSLATE_NOOP("Tabs", "Plan"),
        QT_TRANSLATE_NOOP("Tabs", "Choose viewpoints and routes"),
        Place.AROUND_VIEW,
        "groundstation.gui.plan.plan_page",
        "PlanPage",
    ),
    TabSpec(
        "mission",
        QT_TRANSLATE_NOOP("Tabs", "Mission"),
        QT_TRANSLATE_NOOP("Tabs", "Waypoints, checks, mission files and the flight brief"),
        Place.AROUND_VIEW,
        "groundstation.gui.mission.mission_page",
        "MissionPage",
    ),
    TabSpec(
        "fly",
        QT_TRANSLATE_NOOP("Tabs", "Fly"),
        QT_TRANSLATE_NOOP("Tabs", "Upload, rehearse and watch the flight"),
        Place.AROUND_VIEW,
        "groundstation.gui.fly.fly_page",
        "FlyPage",
    ),
    TabSpec(
        "photos",
        QT_TRANSLATE_NOOP("Tabs", "Photos"),
        QT_TRANSLATE_NOOP("Tabs", "Read the photos and find the glass panels"),
        Place.WHOLE_PAGE,
        "groundstation.gui.photos.photos_page",
        "PhotosPage",
    ),
    TabSpec(
        "reconstruct",
        QT_TRANSLATE_NOOP("Tabs", "Reconstruct"),
        QT_TRANSLATE_NOOP("Tabs", "Turn the photos into a model"),
        Place.WHOLE_PAGE,
        "groundstation.gui.reconstruct.reconstruct_page",
        "ReconstructPage",
    ),
    TabSpec(
        "model",
        QT_TRANSLATE_NOOP("Tabs", "Model"),
        QT_TRANSLATE_NOOP("Tabs", "Look at the model and the record of each panel"),
        Place.WHOLE_PAGE,
        "groundstation.gui.model.model_page",
        "ModelPage",
    ),
)
"""They stand in this order; the shortcut of the start page is Ctrl+0, of the first step Ctrl+1."""
