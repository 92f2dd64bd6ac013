"""A window with the Model tab, whose process is a list of what it was told."""

import gc

import pytest

from reconstruction.objects.store import write_scene
from tests.gui.driving import close_desk, turn_until
from tests.gui.reconstruct.conftest import Told
from tests.reconstruction.objects.made_scene import made_scene


@pytest.fixture(scope="module")
def desk(application, worker, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.mktemp("config")))
        from groundstation.gui.window.project_controller import Desk

        desk = Desk(application, worker=worker)
        desk.window.setGeometry(0, 0, 1280, 720)
        yield desk
        close_desk(desk)
        gc.collect()


@pytest.fixture
def page(application, desk, monkeypatch):
    """The tab, with nothing open yet."""
    from groundstation.gui.model import model_controller as model_desk
    from groundstation.gui.model.model_page import ModelPage

    monkeypatch.setattr(model_desk, "ModelProcess", lambda _listener: Told())
    page = ModelPage(desk.workspace, desk.window.stage)
    page.told = page.desk._process
    page.messages = []
    desk.workspace.messageShown.connect(page.messages.append)
    page.left.resize(1270, 600)
    page.left.show()
    yield page
    desk.workspace.messageShown.disconnect(page.messages.append)
    turn_until(application, lambda: not desk.workspace.jobs())
    page.left.hide()
    page.desk.setParent(None)


@pytest.fixture
def scene(tmp_path):
    """A folder with a scene of four panels on two facades."""
    write_scene(made_scene(((3, 2), (2, 1))), tmp_path / "made.gsscene")
    return tmp_path / "made.gsscene"


@pytest.fixture
def opened(application, page, scene):
    """The tab with that scene."""
    page.desk.open(scene)
    turn_until(application, lambda: page.desk.card is not None and not page._workspace.jobs())
    return page
