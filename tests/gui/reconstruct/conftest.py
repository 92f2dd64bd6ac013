"""A window with the Reconstruct tab, whose process is a list of what it was told until a test wants the real one."""

import pytest

from tests.gui.driving import close_controller, turn_until
from tests.reconstruction.training.synthetic_data_set import write_data_set


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reconstruct") / "glass.photos"
    write_data_set(folder, n=6)
    return folder


@pytest.fixture(scope="module")
def controller(application, worker, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.mktemp("config")))
        from groundstation.gui.window.project_controller import ProjectController

        controller = ProjectController(application, worker=worker)
        controller.window.setGeometry(0, 0, 1280, 720)
        yield controller
        close_controller(controller)


class RecordedProcess:
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
def page(application, controller, monkeypatch):
    """The tab, with nothing chosen yet."""
    from groundstation.gui.reconstruct import reconstruct_controller
    from groundstation.gui.reconstruct.reconstruct_page import ReconstructPage

    monkeypatch.setattr(reconstruct_controller, "ModelProcess", lambda _listener: RecordedProcess())
    page = ReconstructPage(controller.context, controller.window.shared_view)
    page.told = page.controller._process
    page.messages = []
    controller.context.messageShown.connect(page.messages.append)
    page.left.resize(1270, 600)
    page.left.show()
    yield page
    controller.context.messageShown.disconnect(page.messages.append)
    turn_until(application, lambda: not controller.context.jobs())
    page.pane.close_pictures()
    page.left.hide()
    page.controller.phase = reconstruct_controller.Phase.IDLE
    page.controller.setParent(None)


@pytest.fixture
def chosen(application, page, data, tmp_path):
    """The tab with a data set."""
    page.controller.read(data)
    turn_until(application, lambda: page.controller.card is not None and not page._context.jobs())
    page.controller.choose_out(tmp_path / "model")
    turn_until(application, lambda: not page._context.jobs())
    return page
