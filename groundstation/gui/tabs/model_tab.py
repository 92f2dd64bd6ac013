"""The Model tab: its place in the window; what it will do is not built yet, and it says so."""

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
        QCoreApplication.translate("Tabs", "Viewing models in this window is not built yet."),
        QCoreApplication.translate("Tabs", "Panels of the site can be looked at on the Site tab."),
    )


TAB = TabSpec(
    order=70,
    name="model",
    title=QT_TRANSLATE_NOOP("Tabs", "Model"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Look at the model and the record of each panel"),
    place=Place.WHOLE_PAGE,
    make=make,
)
