"""The Reconstruct tab: train a model of a data set, and look at it from anywhere while it learns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.reconstruct.reconstruct_page import ReconstructPage
    from groundstation.gui.shared_view import Stage


def make(workspace: ApplicationContext, stage: Stage) -> ReconstructPage:
    """What to train, the view of the model, and its curves."""
    from groundstation.gui.reconstruct.reconstruct_page import ReconstructPage

    return ReconstructPage(workspace, stage)


TAB = TabSpec(
    order=60,
    name="reconstruct",
    title=QT_TRANSLATE_NOOP("Tabs", "Reconstruct"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Turn the photos into a model"),
    place=Place.WHOLE_PAGE,
    make=make,
    implementation="groundstation.gui.reconstruct.reconstruct_page",
)
