"""Two aircraft in the air at once, in the real window, by clicks and holds, with a simulated vehicle each."""

import os
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from groundstation.services.fly.connection import flights_folder
from groundstation.services.fly.events import Request
from groundstation.services.fly.log_book import book_path, read_book
from groundstation.services.fly.options import ConnectionChoice
from groundstation.services.project.document import Document, PlanEntry
from groundstation.vehicle import watch
from planning.base.findings import Severity
from planning.parameters import FlightRules
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import court
from tests.gui.driving import click_on, clicked, hold_on, turn_until, turn_until_idle
from tests.gui.fly.test_fly_page import ask_for, controller, page

__all__ = ["controller", "page"]

SPEED_UP = 25.0


@cache
def planned():
    """A site with two wings of glass, and a sortie for each of two aircraft."""
    from tests.planning.revision.cases import QUICK

    site, rules = court(), FlightRules(at_once=2, apart_m=12.0)
    return site, plan_flight(site, PlanRequest(n_views=45, rules=rules, greedy=QUICK, time_budget_s=3.0)).plan


@pytest.fixture
def several(application, controller, page):
    """The Fly tab with that plan."""
    model, plan = planned()
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "Two", plan),), "plan-1"), None)
    turn_until_idle(application, controller)
    return page


def choose(page, number):
    click_on(page.fleet.window(), page.fleet.button(number))
    assert page.controller.selected.number == number


def connect(application, page, number, speed_up=SPEED_UP):
    choose(page, number)
    page.controller.set_choice(ConnectionChoice(speed_up=speed_up))
    page.connection.setValue(page.controller.choice)
    click_on(page.connection.window(), page.connection.button)
    turn_until(application, lambda: page.buttons.button(Request.UPLOAD).isEnabled())


def upload(application, page, number):
    choose(page, number)
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())


def aircraft(page, number):
    return page.controller.aircraft[number - 1]


def picture(page, name):
    """For the eye, where somebody wants to look."""
    folder = os.environ.get("REFLIGHT_TEST_PICTURES")
    if folder:
        page.pictures.draw()
        page.overlay.draw()
        page.fleet.window().grab().save(str(Path(folder) / f"{name}.png"))


@pytest.mark.slow
def test_two_aircraft_fly_at_once_to_their_reports_and_are_watched_for_each_other(application, controller, several):
    page = several
    assert page.fleet.isVisible()
    flown_by = [planned()[1].sorties[each.sortie_number - 1].aircraft for each in page.controller.aircraft]
    assert flown_by == [1, 2]
    for number in (1, 2):
        connect(application, page, number)
    for number in (1, 2):
        upload(application, page, number)
    picture(page, "ready")
    first = next(n for n in (1, 2) if planned()[1].sorties[aircraft(page, n).sortie_number - 1].start_s == 0.0)
    second = 3 - first
    choose(page, first)
    with clicked("Yes") as asked:
        ask_for(page, Request.START)
    assert "TOO EARLY" not in asked[0]
    turn_until(application, lambda: aircraft(page, first).since_take_off_s() is not None)
    choose(page, second)
    turn_until(application, lambda: "start in" in page.fleet.button(second).accessibleName())
    with clicked("Cancel") as asked:
        ask_for(page, Request.START)
    assert "TOO EARLY" in asked[0]
    turn_until(application, lambda: page.controller.wait_s(aircraft(page, second)) == 0.0)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    with clicked("Yes"):
        ask_for(page, Request.START)
    turn_until(application, lambda: len(aircraft(page, second).active.photos) >= 3)
    assert " m apart" in page.fleet.button(second).accessibleName()
    assert page.buttons.button(Request.LAND).text() == f"{second}: Land"
    picture(page, "flying")
    page._shared_view.show_page(type(page._shared_view.page()).MAP)
    application.processEvents()
    picture(page, "map")
    page._shared_view.show_page(type(page._shared_view.page()).SCENE)
    turn_until(application, lambda: all(each.active.ended is not None for each in page.controller.aircraft))
    ends = {each.number: each.active.ended for each in page.controller.aircraft}
    last = max(ends.values(), key=lambda ended: len(ended.report.sorties))
    assert len(last.report.sorties) == 2
    found = {finding.code: finding for finding in last.report.findings}
    for code in ("aircraft-apart", "aircraft-apart-live"):
        assert found[code].severity is Severity.OK, found[code]
    paths = {ended.path for ended in ends.values()}
    assert len(paths) == 2
    assert all(path.exists() for path in paths)
    book = read_book(book_path(flights_folder(None)))
    assert sorted(entry.sortie for entry in book) == [1, 2]
    for number in (1, 2):
        choose(page, number)
        application.processEvents()
        assert "Photos:" in page.report.text()
        picture(page, f"report-{number}")
    noted = " ".join(text for each in page.controller.aircraft for _, _, text in each.active.notes)
    assert "where both can stop" not in noted


@pytest.mark.slow
def test_too_near_aircraft_are_warned_of_and_all_return_one_by_one(application, several, monkeypatch):
    page = several
    # As if they had to keep 300 m apart, so that nothing depends on when the second one starts.
    monkeypatch.setattr(watch, "APART_TOLERANCE_M", -300.0)
    for number in (1, 2):
        connect(application, page, number, speed_up=12.0)
        upload(application, page, number)
    for number in (1, 2):
        choose(page, number)
        turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
        with clicked("Yes"):
            ask_for(page, Request.START)
        turn_until(application, lambda n=number: aircraft(page, n).since_take_off_s() is not None)
    for number in (1, 2):
        choose(page, number)
        turn_until(application, lambda: "aircraft 1: aircraft 2 is" in page.overlay.banner.text())
        assert "aircraft 1: aircraft 2 is" in page.warnings.text()
    picture(page, "warned")
    hold_on(page.fleet.window(), page.fleet.return_all)
    turn_until(application, lambda: page.controller._returning.waiting or all_ended(page))
    (waits,) = page.controller._returning.waiting
    home = 3 - waits
    turn_until(application, lambda: "RTL" in page.fleet.button(home).text())
    turn_until(application, lambda: not aircraft(page, waits).is_in_flight or is_paused(page, waits))
    picture(page, "returning")
    turn_until(application, lambda: not aircraft(page, home).is_in_flight)
    turn_until(application, lambda: "RTL" in page.fleet.button(waits).text())
    turn_until(application, lambda: all_ended(page))
    assert "returns once the others have landed" in " ".join(text for _, _, text in aircraft(page, waits).active.notes)


def all_ended(page):
    return all(each.active.ended is not None for each in page.controller.aircraft)


def is_paused(page, number):
    return Request.RESUME in aircraft(page, number).view.may


@pytest.mark.long
def test_a_plan_for_two_shows_two_and_what_is_asked_is_asked_of_the_selected_one(application, controller, several):
    page = several
    assert page.fleet.isVisible()
    assert not page.fleet.return_all.isEnabled()
    choose(page, 2)
    assert page.sortie.currentIndex() == aircraft(page, 2).sortie_number - 1
    connect(application, page, 2)
    assert aircraft(page, 2).flight is not None
    assert aircraft(page, 1).flight is None
    choose(page, 1)
    application.processEvents()
    page.pictures.draw()
    labels = [label.text for label in page._shared_view.scene()._overlay._labels]
    assert "Aircraft 2" in labels, "drawn although another one is selected"
    assert page.connection.button.text() == "Connect"
    assert not page.buttons.button(Request.UPLOAD).isEnabled()
    page.sortie.setCurrentIndex(aircraft(page, 2).sortie_number - 1)
    page.sortie.activated.emit(page.sortie.currentIndex())
    click_on(page.connection.window(), page.connection.button)
    application.processEvents()
    assert "Aircraft 2 has sortie" in controller.window.messages.texts()
    assert aircraft(page, 1).flight is None
    controller._rebuild_window()
    page = controller.window.tab("fly")
    controller.window.show_tab("fly")
    turn_until_idle(application, controller)
    assert page.fleet.isVisible(), "in another language, too"
    model, plan = planned()
    alone = replace(plan, rules=replace(plan.rules, at_once=1), sorties=tuple(single(each) for each in plan.sorties))
    choose(page, 2)
    click_on(page.connection.window(), page.connection.button)
    turn_until(application, lambda: not page.controller.is_any_connected)
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "One", alone),), "plan-1"), None)
    turn_until_idle(application, controller)
    assert not page.fleet.isVisible()
    assert page.controller.selected.number == 1
    assert page.buttons.button(Request.LAND).text() == "Land"


def single(sortie):
    return replace(sortie, start_s=None, aircraft=None)
