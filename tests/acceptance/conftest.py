"""The application on its virtual screen, and the pilot before a new window."""

import gc

import pytest

from groundstation.services.settings import Language
from tests.acceptance.pilot import Pilot
from tests.gui.conftest import (
    _garbage_stays_in_this_thread,
    _no_dialog_waits,
    application,
    worker,
)
from tests.gui.driving import close_controller, turn_until

__all__ = ["_garbage_stays_in_this_thread", "_no_dialog_waits", "application", "worker"]


@pytest.fixture
def own_garbage():
    """Garbage as in a process of the window's own: it may leave out of its searches what it has loaded, see `tests`."""
    gc.unfreeze()
    yield
    gc.freeze()


@pytest.fixture
def pilot(application, worker, tmp_path, monkeypatch, request):
    """Somebody who has just started the program for the first time, on a laptop of 1280 x 720."""
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.setenv("HOME", str(tmp_path))
    from groundstation.gui.window.project_controller import ProjectController

    language = getattr(request, "param", Language.ENGLISH)
    controller = ProjectController(application, worker=worker)
    controller.show()
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    controller.window.setGeometry(0, 0, 1280, 720)
    pilot = Pilot(application, controller, tmp_path)
    pilot.speak(language)
    yield pilot
    pilot.speak(Language.ENGLISH)
    close_controller(controller)
