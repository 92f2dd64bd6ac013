"""The Photos tab: read the photos of a flight, find the glass panels in them, and correct what was found."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.gui.tabs import QT_TRANSLATE_NOOP, Place, TabSpec

if TYPE_CHECKING:
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.photos.photos_page import PhotosPage
    from groundstation.gui.shared_view import Stage


def make(workspace: ApplicationContext, stage: Stage) -> PhotosPage:
    """Strip, map and findings of the photos, and the grid over the one that is chosen."""
    from groundstation.gui.photos.photos_page import PhotosPage

    return PhotosPage(workspace, stage)


TAB = TabSpec(
    order=50,
    name="photos",
    title=QT_TRANSLATE_NOOP("Tabs", "Photos"),
    tip=QT_TRANSLATE_NOOP("Tabs", "Read the photos and find the glass panels"),
    place=Place.WHOLE_PAGE,
    make=make,
    implementation="groundstation.gui.photos.photos_page",
)
