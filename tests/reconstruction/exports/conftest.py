"""Browsers that web pages are opened in, one of each for the tests of a file."""

import pytest

from tests.reconstruction.exports.firefox import firefox
from tests.reconstruction.exports.web_browser import chromium


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with chromium(tmp_path_factory.mktemp("chromium")) as found:
        yield found


@pytest.fixture(scope="module", params=["chromium", pytest.param("firefox", marks=pytest.mark.slow)])
def any_browser(request, tmp_path_factory):
    start = {"chromium": chromium, "firefox": firefox}[request.param]
    with start(tmp_path_factory.mktemp(request.param)) as found:
        yield found
