"""Flights over links are entered in a log book of the test's own, not in that of whoever runs the tests."""

import os

import pytest


@pytest.fixture(autouse=True)
def _own_settings(tmp_path_factory, monkeypatch):
    if "REFLIGHT_CONFIG_DIR" not in os.environ:
        monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.getbasetemp() / "config"))
