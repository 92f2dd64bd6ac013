"""The Mission tab: what is flown, whether it may be, and the files and papers that go with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.mission.mission_page import MissionPage
    from groundstation.gui.shared_view import Stage


def make(workspace: ApplicationContext, stage: Stage) -> MissionPage:
    """Waypoints, findings, profile, files and flight brief."""
    from groundstation.gui.mission.mission_page import MissionPage

    return MissionPage(workspace, stage)


TAB = TabSpec(
    order=30,
    name="mission",
    title=QT_TRANSLATE_NOOP("Tabs", "Mission"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Waypoints, checks, mission files and the flight brief"),
    place=Place.AROUND_VIEW,
    make=make,
    implementation="groundstation.gui.mission.mission_page",
)
