"""The log book in the window: what is shown of it, and the table that is written."""

from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.fly.log_book import book_path, enter
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.session import Session
from tests.gui.driving import choose, click_on, clicked
from tests.services.fly.test_log_book import ENTRY


@pytest.fixture
def dialog(application, tmp_path, monkeypatch):
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.fly.after_flight import LogBookDialog

    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    for entry in (ENTRY, replace(ENTRY, battery="", ended="the link was lost"), replace(ENTRY, is_simulated=True)):
        enter(entry, [book_path()])
    runner = JobRunner()
    context = ApplicationContext(Session(), runner)
    dialog = LogBookDialog(context)
    dialog.show()
    yield dialog
    dialog.close()
    context.close()
    runner.shutdown()


def test_flights_are_shown_counted_and_exported(dialog, tmp_path):
    assert len(dialog.shown_entries()) == 2
    assert dialog.batteries_text() == "Battery B1: flights: 1, cycles: 0.4"
    click_on(dialog, dialog.simulated)
    assert len(dialog.shown_entries()) == 3
    with clicked(choose(tmp_path / "mine.csv")):
        click_on(dialog, dialog.export)
    assert dialog.state_text() == f"Written: {tmp_path / 'mine.csv'}"
    assert len(Path(tmp_path / "mine.csv").read_text("utf-8-sig").splitlines()) == 4


def test_a_damaged_book_is_said(dialog, application):
    book_path().write_text("{")
    dialog._read()
    assert "log-book.json" in dialog.state_text()
    assert not dialog.export.isEnabled()
