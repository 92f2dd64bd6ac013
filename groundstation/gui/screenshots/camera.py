"""Pictures of the camera preview as photographed: a viewpoint's photo, its outlines, light and effects."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QDate, QDateTime, QTime
from PySide6.QtWidgets import QWidget

from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.window.project_controller import ProjectController

Take = Callable[[str, QWidget | None], None]
Wait = Callable[[], None]

MORNING = QDateTime(QDate(2026, 6, 21), QTime(9, 0))


def rendered_photo(controller: ProjectController, name: str, take: Take, wait_until_idle: Wait) -> None:
    """A picture of the selected viewpoint's photo with the panels' outlines; the stage shows the scene again after it.

    Parameters
    ----------
    take
        Saves a picture of a widget, the window where it is None, by a name.
    wait_until_idle
        Returns once no job runs.
    """
    stage = controller.window.stage
    stage.show_page(SharedViewPage.CAMERA)
    box = stage.camera_page().box
    box.photo.click()
    box.outlines.setChecked(True)
    while not stage.photo_controller.is_at_rest():
        wait_until_idle()
    take(name, None)
    box.outlines.setChecked(False)
    box.lines.click()
    stage.show_page(SharedViewPage.SCENE)


def camera_states(controller: ProjectController, take: Take, wait_until_idle: Wait) -> None:
    """Drive the camera preview through its states; a viewpoint is selected."""
    stage = controller.window.stage
    rendered_photo(controller, "plan-photo-outlines", take, wait_until_idle)
    stage.show_page(SharedViewPage.CAMERA)
    box, photos = stage.camera_page().box, stage.photo_controller

    def rest() -> None:
        while not photos.is_at_rest():
            wait_until_idle()

    box.photo.click()
    rest()
    take("plan-photo", None)
    effects = photos.effects_window()
    effects.show()
    take("plan-photo-effects", effects)
    effects.close()
    usual = box.light.value()
    box.light.set_time(MORNING)
    photos.look()
    rest()
    take("plan-photo-by-time", None)
    box.light.setValue(usual)
    box.lines.click()
    stage.show_page(SharedViewPage.SCENE)
