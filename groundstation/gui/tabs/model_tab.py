"""The Model tab: a finished model seen from anywhere, its panels, and the record of each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.model.model_page import ModelPage
    from groundstation.gui.shared_view import Stage


def make(workspace: ApplicationContext, stage: Stage) -> ModelPage:
    """Panels, the view of the model, and records."""
    from groundstation.gui.model.model_page import ModelPage

    return ModelPage(workspace, stage)


TAB = TabSpec(
    order=70,
    name="model",
    title=QT_TRANSLATE_NOOP("Tabs", "Model"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Look at the model and the record of each panel"),
    place=Place.WHOLE_PAGE,
    make=make,
    implementation="groundstation.gui.model.model_page",
)
