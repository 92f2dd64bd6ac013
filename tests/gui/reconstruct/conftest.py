"""A window with the Reconstruct tab, whose process is a list of what it was told until a test wants the real one."""

import gc

import pytest

from tests.gui.driving import close_desk, turn_until
from tests.reconstruction.training.made_data_set import write_data_set


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reconstruct") / "glass.photos"
    write_data_set(folder, n=6)
    return folder


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


class Told:
    """What a process was told; it answers nothing by itself."""

    is_running = True

    def __init__(self):
        self.messages = []

    def send(self, message):
        self.messages.append(message)

    def close(self):
        self.messages.append("closed")

    def of(self, kind):
        return [message for message in self.messages if isinstance(message, kind)]


@pytest.fixture
def page(application, desk, monkeypatch):
    """The tab, with nothing chosen yet."""
    from groundstation.gui.reconstruct import reconstruct_controller as reconstruct_desk
    from groundstation.gui.reconstruct.reconstruct_page import ReconstructPage

    monkeypatch.setattr(reconstruct_desk, "ModelProcess", lambda _listener: Told())
    page = ReconstructPage(desk.workspace, desk.window.stage)
    page.told = page.desk._process
    page.messages = []
    desk.workspace.messageShown.connect(page.messages.append)
    page.left.resize(1270, 600)
    page.left.show()
    yield page
    desk.workspace.messageShown.disconnect(page.messages.append)
    turn_until(application, lambda: not desk.workspace.jobs())
    page.pane.close_pictures()
    page.left.hide()
    page.desk.phase = reconstruct_desk.Phase.IDLE
    page.desk.setParent(None)


@pytest.fixture
def chosen(application, page, data, tmp_path):
    """The tab with a data set."""
    page.desk.read(data)
    turn_until(application, lambda: page.desk.card is not None and not page._workspace.jobs())
    page.desk.choose_out(tmp_path / "model")
    turn_until(application, lambda: not page._workspace.jobs())
    return page
