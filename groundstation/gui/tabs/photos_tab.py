"""The Photos tab: its place in the window; what it will do is not built yet, and it says so."""

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
        QCoreApplication.translate("Tabs", "Reading photos in this window is not built yet."),
        QCoreApplication.translate(
            "Tabs", "Keep the photos of each flight in the project's folder 'photos'; they will be read from there."
        ),
    )


TAB = TabSpec(
    order=50,
    name="photos",
    title=QT_TRANSLATE_NOOP("Tabs", "Photos"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Read the photos and find the glass panels"),
    place=Place.WHOLE_PAGE,
    make=make,
)
