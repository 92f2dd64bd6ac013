"""The Reconstruct tab: its place in the window; what it will do is not built yet, and it says so."""

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
        QCoreApplication.translate("Tabs", "Reconstruction in this window is not built yet."),
        QCoreApplication.translate(
            "Tabs",
            "Any photogrammetry program takes the photos of the second flight; their positions are in the EXIF data.",
        ),
    )


TAB = TabSpec(
    order=60,
    name="reconstruct",
    title=QT_TRANSLATE_NOOP("Tabs", "Reconstruct"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Turn the photos into a model"),
    place=Place.WHOLE_PAGE,
    make=make,
)
