"""Pictures of the Photos tab: a made flight is read, looked at in 3-D, searched and corrected."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.gui.photos.photos_page import PhotosPage
from groundstation.gui.window.project_controller import ProjectController
from groundstation.services.photos.synthetic_flight import write_made_flight
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.settings import Language, Theme
from groundstation.services.units import UnitSystem

Take = Callable[[str], None]
Wait = Callable[[], None]


def photo_states(controller: ProjectController, scratch: Path, take: Take, wait_until_idle: Wait) -> None:
    """Drive the Photos tab through its states.

    Parameters
    ----------
    scratch
        Folder for the made flight; one that is there already is taken.
    take
        Saves a picture of the window by a name.
    wait_until_idle
        Returns once no job runs.
    """
    flight = scratch / "made-flight"
    site, photos = flight / "made.site.json", flight / "photos"
    if not site.exists():
        flight.mkdir()
        site, photos = write_made_flight(flight)

    def rest() -> None:
        wait_until_idle()
        while page().store.is_busy():
            wait_until_idle()

    def page() -> PhotosPage:
        tab = controller.window.tab("photos")
        assert isinstance(tab, PhotosPage)
        return tab

    controller.open_path(site)
    wait_until_idle()
    controller.window.show_tab("photos")
    page().controller.read(photos)
    rest()
    page().strip.choose(len(page().controller.cards) - 1)
    rest()
    take("photos-read")
    model = controller.workspace.document.site
    assert model is not None
    controller.workspace.select(Item(ItemKind.PANEL, model.site.panels[len(model.site.panels) // 2].id))
    page().pane.coverage.click()
    rest()
    take("photos-coverage")
    page().pane.photo.click()
    page().details.setCurrentIndex(0)
    page().controller.find()
    rest()
    page().strip.choose(len(page().controller.cards) - 1)
    rest()
    take("photos-known")
    page().strip.choose(0)
    rest()
    _choose_line(page())
    take("photos-grid")
    page().pane.rectified.click()
    rest()
    take("photos-rectified")
    page().pane.photo.click()
    for name, changes in (
        ("dark", {"theme": Theme.DARK}),
        ("sunlight", {"theme": Theme.SUNLIGHT}),
        ("feet", {"theme": Theme.LIGHT, "units": UnitSystem.IMPERIAL}),
        ("german", {"units": UnitSystem.METRIC, "language": Language.GERMAN}),
    ):
        controller.choose(**changes)
        controller.window.show_tab("photos")
        rest()
        _choose_line(page())
        take(f"{name}-photos")
    page().pane.coverage.click()
    rest()
    take("german-photos-coverage")
    controller.choose(language=Language.ENGLISH)
    controller.window.show_tab("photos")
    page().use.click()
    wait_until_idle()
    controller.workspace.select(Item(ItemKind.PANEL, controller.workspace.document.site.site.panels[0].id))
    take("photos-used")


def _choose_line(page: PhotosPage) -> None:
    """With the keyboard, as a user does."""
    page.pane.view.setFocus()
    for _ in range(4):
        QTest.keyClick(page.pane.view, Qt.Key.Key_Tab)
