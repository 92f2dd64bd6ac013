"""The Site tab: open or import a site, look at it, draw and edit what is on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.shared_view import Stage
    from groundstation.gui.site.site_panels import SiteTab


def make(workspace: ApplicationContext, stage: Stage) -> SiteTab:
    """Tree, tools and properties of the site."""
    from groundstation.gui.site.site_panels import SiteTab

    return SiteTab(workspace, stage)


TAB = TabSpec(
    order=10,
    name="site",
    title=QT_TRANSLATE_NOOP("Tabs", "Site"),
    tip=QT_TRANSLATE_NOOP("Tabs", "The building, its glass, and where you may fly"),
    place=Place.AROUND_VIEW,
    make=make,
    implementation="groundstation.gui.site.site_panels",
)
