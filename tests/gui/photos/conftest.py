"""A window with the Photos tab, its photos read, and panels found in them."""

import pytest

from tests.gui.driving import close_controller, turn_until
from tests.gui.photos.photos_tab import PhotosTab
from tests.services.photo_cases import write_photos


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    write_photos(folder)
    damaged = sorted(folder.iterdir())[2]
    damaged.write_bytes(damaged.read_bytes()[:-4000])
    return folder


@pytest.fixture(scope="module")
def controller(application, worker, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.mktemp("config")))
        from groundstation.gui.window.project_controller import ProjectController

        controller = ProjectController(application, worker=worker)
        controller.show()
        controller.window.setGeometry(0, 0, 1280, 720)
        turn_until(application, lambda: controller.window.shared_view.scene() is not None)
        yield controller
        close_controller(controller)


@pytest.fixture
def page(application, controller, folder):
    page = PhotosTab(application, controller, folder)
    yield page
    controller.context.messageShown.disconnect(page.messages.append)


@pytest.fixture
def found(page):
    page.found()
    return page
