"""One application for all window tests, on a virtual screen of its own."""

import gc

import pytest

from tests.gui.screen import the_application


@pytest.fixture(scope="session")
def application():
    """The Qt application."""
    return the_application()


@pytest.fixture(autouse=True)
def _no_dialog_waits(request):
    """A dialog that a test brings up and does not click would stand for ever: it is sent away, and the test fails."""
    if "application" not in request.fixturenames:
        yield
        return
    request.getfixturevalue("application")
    from tests.gui.driving import Guard

    guard = Guard()
    yield
    guard.end()
    assert guard.found == [], "dialogs that nobody clicked"


@pytest.fixture(scope="package", autouse=True)
def _garbage_stays_in_this_thread():
    """As in the running window (`groundstation.gui.application.interpreter`): no job's thread may free widgets."""
    gc.disable()
    yield
    gc.enable()


@pytest.fixture(params=[1.0, 1.6])
def letters(application, request):
    """Letters of usual size, and as large as they can be chosen: their size by the usual one."""
    from groundstation.gui.widgets.theme import apply_theme
    from groundstation.services.settings import Theme

    apply_theme(application, Theme.LIGHT, request.param)
    yield request.param
    apply_theme(application, Theme.LIGHT)


@pytest.fixture(scope="session")
def worker():
    """The process in which the windows of all tests plan."""
    from groundstation.services.jobs.worker import Worker

    worker = Worker()
    yield worker
    worker.close()
