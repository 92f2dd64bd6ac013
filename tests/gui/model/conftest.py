"""A window with the Model tab, whose process is a list of what it was told."""

import pytest

from reconstruction.objects.store import write_scene
from tests.gui.driving import close_controller, turn_until
from tests.gui.reconstruct.conftest import RecordedProcess
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


@pytest.fixture(scope="module")
def controller(application, worker, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.mktemp("config")))
        from groundstation.gui.window.project_controller import ProjectController

        controller = ProjectController(application, worker=worker)
        controller.window.setGeometry(0, 0, 1280, 720)
        yield controller
        close_controller(controller)


@pytest.fixture
def page(application, controller, monkeypatch):
    """The tab, with nothing open yet."""
    from groundstation.gui.model import model_controller
    from groundstation.gui.model.model_page import ModelPage

    monkeypatch.setattr(model_controller, "ModelProcess", lambda _listener: RecordedProcess())
    page = ModelPage(controller.context, controller.window.shared_view)
    page.told = page.controller._process
    page.messages = []
    controller.context.messageShown.connect(page.messages.append)
    page.left.resize(1270, 600)
    page.left.show()
    yield page
    controller.context.messageShown.disconnect(page.messages.append)
    turn_until(application, lambda: not controller.context.jobs())
    page.left.hide()
    page.controller.setParent(None)


@pytest.fixture
def scene(tmp_path):
    """A folder with a scene of four panels on two facades."""
    write_scene(synthetic_scene(((3, 2), (2, 1))), tmp_path / "made.gsscene")
    return tmp_path / "made.gsscene"


@pytest.fixture
def opened(application, page, scene):
    """The tab with that scene."""
    page.controller.open(scene)
    turn_until(application, lambda: page.controller.card is not None and not page._context.jobs())
    return page
