"""Entering a flight by card in the log book, as a pilot does it after its photos were read."""

import pytest
from PySide6.QtCore import QDateTime

from groundstation.gui.photos.flight_entry import EnterFlightDialog
from groundstation.services.fly.log_book import book_path, read_book
from groundstation.services.project.document import PlanEntry
from planning.base.findings import Severity
from planning.plan import Viewpoint
from tests.gui.driving import click_on, turn_until, type_into
from tests.missions.plans import make_plan
from tests.reconstruction.synthetic_photos import ORIGIN
from tests.services.photo_cases import site_model, true_photos


@pytest.fixture
def planned(page):
    """The page with a plan whose views are where the photos were taken."""
    views = [
        Viewpoint(f"v{number:04d}", tuple(map(float, photo.pose.position_enu_m)), 0.0, 0.0)
        for number, photo in enumerate(true_photos())
    ]
    plan = make_plan([(views, {})], ORIGIN, home=site_model().site.home_enu_m)
    context = page.controller.context
    context.change("Plan", context.document.with_plan(PlanEntry("plan-1", "By card", plan)))
    page.idle()
    return page


def dialogs(page):
    return [each for each in page.controller.window.findChildren(EnterFlightDialog) if each.isVisible()]


def opened(page):
    click_on(page.controller.window, page.tab.log_book)
    turn_until(page.application, lambda: bool(dialogs(page)))
    return dialogs(page)[-1]


def test_a_flight_by_card_is_entered_with_the_times_of_its_photos_and_not_twice(planned, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    dialog = opened(planned)
    (row,) = dialog.rows
    assert row.stated.n_photos == 3
    times = [card.metadata.taken_at.astimezone().timestamp() for card in planned.tab.controller.cards]
    assert row.start.dateTime().toSecsSinceEpoch() <= min(times)
    type_into(row.battery, "B1")
    type_into(dialog.remarks, "gusts")
    click_on(dialog, dialog.enter)
    turn_until(planned.application, lambda: not dialogs(planned))
    (entry,) = read_book(book_path())
    assert (entry.battery, entry.remarks, entry.n_photos, entry.site) == ("B1", "gusts", 3, "made")
    assert entry.started_unix_s <= min(times) <= max(times) <= entry.ended_unix_s
    assert planned.messages[-1].severity is Severity.OK
    again = opened(planned)
    click_on(again, again.enter)
    assert "is in the log book already; nothing was entered" in again.state_text()
    assert len(read_book(book_path())) == 1
    again.rows[0].start.setDateTime(QDateTime.fromSecsSinceEpoch(1_782_030_600))
    click_on(again, again.enter)
    turn_until(planned.application, lambda: not dialogs(planned))
    assert [each.started_unix_s for each in read_book(book_path())][-1] == 1_782_030_600.0


def test_nothing_is_offered_without_a_plan_or_for_photos_that_were_rendered(page, folder, request):
    assert not page.tab.log_book.isEnabled()
    page = request.getfixturevalue("planned")
    assert page.tab.log_book.isEnabled()
    (folder / "scene.json").write_text("{}")
    page.tab.controller.stateChanged.emit()
    assert not page.tab.log_book.isEnabled()
    (folder / "scene.json").unlink()
