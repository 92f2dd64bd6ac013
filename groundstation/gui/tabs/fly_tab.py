"""The Fly tab: connect, check, upload, start, and watch coverage grow photo by photo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.fly.fly_page import FlyPage
    from groundstation.gui.shared_view import Stage


def make(workspace: ApplicationContext, stage: Stage) -> FlyPage:
    """Connection, pre-flight list, readouts, photos and report."""
    from groundstation.gui.fly.fly_page import FlyPage

    return FlyPage(workspace, stage)


TAB = TabSpec(
    order=40,
    name="fly",
    title=QT_TRANSLATE_NOOP("Tabs", "Fly"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Upload, rehearse and watch the flight"),
    place=Place.AROUND_VIEW,
    make=make,
    implementation="groundstation.gui.fly.fly_page",
)
