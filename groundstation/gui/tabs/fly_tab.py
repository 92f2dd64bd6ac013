"""The Fly tab: its place in the window; what it will do is not built yet, and it says so."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.prepared_tab import PreparedTab
    from groundstation.gui.stage import Stage
    from groundstation.gui.workspace import Workspace


def make(_workspace: Workspace, _stage: Stage) -> PreparedTab:
    """Page that says what to do meanwhile."""
    from groundstation.gui.prepared_tab import PreparedTab

    return PreparedTab(
        QCoreApplication.translate("Tabs", "Flying from this window is not built yet."),
        QCoreApplication.translate(
            "Tabs",
            "Export the mission on the Mission tab and fly it with DJI Pilot 2, QGroundControl or Mission Planner.",
        ),
    )


TAB = TabSpec(
    order=40,
    name="fly",
    title=QT_TRANSLATE_NOOP("Tabs", "Fly"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Upload, rehearse and watch the flight"),
    place=Place.WHOLE_PAGE,
    make=make,
)
