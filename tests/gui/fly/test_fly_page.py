"""The Fly tab as a pilot uses it, in the real window, with the embedded simulation."""

import gc
import itertools
import re
import time
from dataclasses import replace

import pytest
from PySide6.QtCore import QMargins, QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QLineEdit, QMessageBox

from groundstation.gui.fly.flight_buttons import APART_PX, HELD, ICON_PX, PLACES
from groundstation.services.fly.events import LinkState, Request, ViewState
from groundstation.services.fly.flight import DONE, REFUSALS
from groundstation.services.fly.options import ConnectionChoice, LinkKind, choice_path, read_choice
from groundstation.services.messages import translation
from groundstation.services.project.document import Document, ItemKind, PlanEntry
from groundstation.services.project.steps import Act, FlightState, Step, guidance, is_done
from groundstation.services.settings import Language
from groundstation.services.units import UnitSystem
from groundstation.vehicle.preflight import Remedy
from groundstation.vehicle.sortie.run_records import Phase
from missions.mavlink.autopilots import Autopilot
from planning.base.findings import Severity
from planning.plan import viewpoint_arrays
from planning.revision.top_up import TopUpRequest, top_up
from tests.gui.driving import (
    click_on,
    clicked,
    close_controller,
    escape,
    hold_on,
    press,
    scroll_to,
    shut,
    turn_until,
    turn_until_idle,
    type_into,
)
from tests.services.live_cases import Reopening, planned, simulation
from tests.slow import slow

ONE_IN = 100
"""One turn of so many may be longer."""

GAP_S = 0.05


@pytest.fixture
def radio():
    """A link that can be unplugged; asked for before `controller`, it ends after it."""
    radio = Reopening()
    yield radio
    radio.end()


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    model, plan = planned()
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "First", plan),), "plan-1"), None)
    controller.window.show_tab("fly")
    turn_until_idle(application, controller)
    yield controller
    close_controller(controller)


@pytest.fixture
def page(controller):
    return controller.window.tab("fly")


def ask_for(page, request):
    button = page.buttons.button(request)
    (hold_on if request in HELD else click_on)(button.window(), button)


def connect(application, page, speed_up=20.0, autopilot=Autopilot.ARDUPILOT):
    page.controller.set_choice(ConnectionChoice(speed_up=speed_up, autopilot=autopilot))
    page.connection.setValue(page.controller.choice)
    page.connection.button.click()
    turn_until(application, lambda: page.buttons.button(Request.UPLOAD).isEnabled())


def take_off(application, page):
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    with clicked("Yes"):
        ask_for(page, Request.START)
    turn_until(application, lambda: n_photos(page) >= 1)


def n_photos(page):
    return 0 if page.controller.active is None else len(page.controller.active.photos)


def has_landed(page):
    return page.controller.active is not None and page.controller.active.ended is not None


@pytest.mark.alone
def test_a_flight_is_watched_to_its_report_without_a_gap_in_the_window(application, controller, page):
    """Ten times as fast; the window works no longer than 50 ms in a turn of the event loop, but for a few.

    A turn counts as long as this process worked in it, for machines are shared. The simulated vehicle is in the same
    process, ten times as fast as outside: with its work, a turn may take twice as long.
    """
    connect(application, page, speed_up=10.0)
    assert "not uploaded yet" in page.checks.text()
    assert not page.buttons.button(Request.START).isEnabled()
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    well = page.checks.text().count("\u2713") + page.checks.text().count("!")
    assert well == len(page.checks.text().splitlines())
    with clicked("Yes") as asked:
        ask_for(page, Request.START)
    assert "takes 6 photos" in asked[0]
    assert "Away from home it flies" in asked[0]
    assert "above the ground" in page.checks.text()
    turn_until(application, lambda: n_photos(page) >= 1)
    gc.collect()
    turns = []
    while not has_landed(page):
        started, worked, own = time.perf_counter(), time.process_time(), time.thread_time()
        application.processEvents()
        taken = min(time.perf_counter() - started, time.process_time() - worked)
        turns.append((taken, time.thread_time() - own))
        time.sleep(0.001)
    few = len(turns) // ONE_IN
    taken, own = (sorted(each, reverse=True) for each in zip(*turns, strict=True))
    assert own[few] < GAP_S, own[: few + 1]
    assert max(own[0], taken[few]) < 2.0 * GAP_S, taken[: few + 1]
    assert [state for _, state in page.strip.states()] == [ViewState.TAKEN] * 6
    assert "6/6" in page.readouts.text()
    assert "Photos: 6 of 6 views" in page.report.text()
    assert {row[2] for row in page.report.rows()} == {"taken"}
    assert len(page.controller.active.track_enu_m) > 20
    assert not page.report.resume.isEnabled()
    findings = "\n".join(page.findings.texts())
    assert "all 6 views have a photo" in findings
    assert "smallest distance flown" in findings
    assert page._lists.tabText(2).startswith("Findings (")
    page.report.top_up.click()
    turn_until_idle(application, controller)
    assert "Nothing is missing" in controller.window.messages.texts()
    assert controller.context.milestones.flown.is_whole


@pytest.mark.slow
def test_coverage_is_painted_on_the_panels_as_it_grows(application, controller, page):
    connect(application, page)
    take_off(application, page)
    scene = controller.window.shared_view.scene()
    turn_until(application, lambda: scene._panel_values is not None)
    _, first = scene._panel_values
    turn_until(application, lambda: n_photos(page) >= 5 and (scene._panel_values[1] > first).any())
    controller.window.show_tab("site")
    assert scene._panel_values is None  # the shared view is given back


@pytest.mark.slow
def test_pause_resume_return_then_a_top_up_and_the_rest_of_the_sortie(application, controller, page):
    connect(application, page)
    take_off(application, page)
    ask_for(page, Request.PAUSE)
    turn_until(application, lambda: page.buttons.button(Request.RESUME).isEnabled())
    ask_for(page, Request.RESUME)
    turn_until(application, lambda: page.buttons.button(Request.PAUSE).isEnabled())
    ask_for(page, Request.RETURN)
    bar, offered = controller.window.next_step, set()
    turn_until(application, lambda: has_landed(page) or offered.add(bar.button.text()))
    assert offered == {""}, "while the report is made nothing leads on yet, and no other upload above all"
    missing = {row[0] for row in page.report.rows() if row[2] != "taken"}
    assert missing
    turn_until(application, lambda: bar.text().startswith(f"Done: landed early; {6 - len(missing)} of 6 photos taken."))
    assert bar.button.text() == "Resume sortie"
    assert not is_done(Step.FLY, controller.context.milestones)
    page.report.top_up.click()
    turn_until_idle(application, controller)
    plans = controller.context.document.plans
    assert [entry.title for entry in plans] == ["First", "Top-up"]
    assert 0 < len(plans[-1].plan.viewpoints) <= 6
    assert "Fly it before the battery is changed" in controller.window.messages.texts()
    left = page.controller.active.battery
    # The plan that is shown is another one now: what is uploaded and what is seen must not differ.
    turn_until(application, lambda: "for another plan" in page._phase.text())
    assert not page.buttons.button(Request.UPLOAD).isEnabled()
    assert bar.button.text() == "Connect"
    click_on(controller.window, bar.button)
    turn_until(application, lambda: page.buttons.button(Request.UPLOAD).isEnabled())
    assert len(page.strip.states()) == len(plans[-1].plan.viewpoints)
    turn_until(application, lambda: page.controller.active.battery is not None)
    assert page.controller.active.battery == pytest.approx(left, abs=0.011)
    assert "as the flight before left it" in page.notes.texts()
    page.connection.button.click()
    turn_until(application, lambda: not page.controller.is_connected)
    first = controller.context.document.plans[0]
    controller.context.change("Show", replace(controller.context.document, current_plan_id=first.id))
    assert bar.button.text() == "Resume sortie", "what was flown of it is known still"
    click_on(controller.window, bar.button)
    turn_until_idle(application, controller)
    rest = controller.context.document.plans[-1]
    assert rest.title == "Rest of sortie 1"
    assert {view.id for view in rest.plan.viewpoints} == missing
    assert "It needs a full battery" in controller.window.messages.texts()
    connect(application, page)
    turn_until(application, lambda: page.controller.active.battery is not None)
    assert page.controller.active.battery > 0.99


@pytest.mark.slow
@pytest.mark.parametrize(("answer", "titles"), [("Yes", ["First", "Top-up"]), ("Cancel", ["First"])])
def test_hardly_anything_missing_is_asked_about_with_what_it_would_cost(application, controller, page, answer, titles):
    document = controller.context.document
    plan = document.plans[0].plan
    found = top_up(document.site, plan, viewpoint_arrays(plan.viewpoints[:1]), TopUpRequest(time_budget_s=0.5))
    button = getattr(QMessageBox.StandardButton, answer)
    with clicked(press(button)) as said:
        page.controller.after.restFound.emit(replace(found, aimed=100_000))
    assert f"{found.wanted} of 100000 sections are missing" in said[0]
    assert f"in the air (photos: {len(found.plan.viewpoints)}, batteries: {len(found.plan.sorties)})" in said[0]
    assert [entry.title for entry in controller.context.document.plans] == titles


@pytest.mark.slow
def test_losing_the_link_shows_a_band_and_is_survived(application, radio, controller, page, monkeypatch):
    monkeypatch.setattr(page.controller, "_connection", lambda *_: radio)
    connect(application, page)
    take_off(application, page)
    assert page.band.isHidden()
    radio.cut.is_unplugged.set()
    turn_until(application, page.band.isVisible)
    assert "SIGNAL LOST" in page.band.text()
    assert page.buttons.button(Request.RETURN).isEnabled()
    bar = controller.window.next_step
    assert bar.text().startswith("Done: in the air, and its signal is lost. Next: keep the aircraft in sight")
    controller.window.show_tab("site")
    assert page.band.isVisible()
    controller.window.show_tab("fly")
    radio.cut.is_unplugged.clear()
    turn_until(application, lambda: page.band.isHidden() and page.controller.active.link is LinkState.ALIVE)
    assert "link found again" in page.notes.texts()
    turn_until(application, lambda: bar.text().startswith("Done: in the air. Next: watch the flight"))


@pytest.mark.slow
def test_a_return_with_a_low_battery_is_told_with_its_reason_and_leads_to_the_rest(
    application, controller, page, monkeypatch
):
    """A pause, in which the battery that was enough for the sortie comes down to where the autopilot turns home."""
    turns_home = {"BATT_FS_LOW_ACT": 2.0, "BATT_CAPACITY": 3300.0, "BATT_LOW_MAH": 0.28 * 3300.0}
    vehicle = simulation(20.0, charge=0.345, parameters=turns_home)
    monkeypatch.setattr(page.controller, "_connection", lambda *_: vehicle)
    connect(application, page)
    take_off(application, page)
    ask_for(page, Request.PAUSE)
    turn_until(application, lambda: has_landed(page))
    bar = controller.window.next_step
    turn_until(application, lambda: bar.text().startswith("Done: landed early; "))
    assert bar.button.text() == "Resume sortie"
    assert not is_done(Step.FLY, controller.context.milestones)
    assert "Battery 1 is low" in page.notes.texts()
    assert "broken off for low battery" in "\n".join(page.findings.texts())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "address", "words"),
    [
        (LinkKind.TCP, "127.0.0.1:1", "cannot be opened"),
        (LinkKind.UDP, "nowhere", "expected KIND:HOST:PORT"),
    ],
)
def test_an_address_that_leads_nowhere_is_told_and_another_can_be_tried(
    application, controller, page, kind, address, words
):
    page.controller.set_choice(ConnectionChoice(kind, address))
    page.connection.setValue(page.controller.choice)
    page.connection.button.click()
    turn_until(application, lambda: words in controller.window.messages.texts())
    turn_until(application, lambda: not page.controller.is_connected)
    assert page.connection.button.text() == "Connect"
    assert read_choice(choice_path()) == ConnectionChoice(kind, address)
    connect(application, page)
    assert page.controller.is_connected


def test_a_flight_that_cannot_be_prepared_is_told_and_can_be_tried_again(application, controller, page):
    model, plan = planned()
    elsewhere = replace(model, site=replace(model.site, name="elsewhere"))
    controller.context.session.open(Document(elsewhere, (PlanEntry("plan-1", "First", plan),), "plan-1"), None)
    turn_until_idle(application, controller)
    page.connection.button.click()
    assert controller.context.milestones.flight is FlightState.BUSY
    turn_until_idle(application, controller)
    assert "Prepare the flight: " in controller.window.messages.texts()
    assert guidance(Step.FLY, controller.context.milestones).act is Act.CONNECT


def test_start_asks_and_a_no_leaves_the_aircraft_on_the_ground(application, page):
    connect(application, page)
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    for no in ("Cancel", escape, shut):
        with clicked(no) as asked:
            ask_for(page, Request.START)
        assert "Is everybody clear of the aircraft?" in asked[0]
        end = time.monotonic() + 0.5
        while time.monotonic() < end:
            application.processEvents()
            time.sleep(0.005)
        assert not page.controller.is_in_flight


@pytest.mark.slow
def test_closing_the_window_in_flight_asks_and_keeps_what_was_flown(application, controller, page, tmp_path):
    connect(application, page)
    take_off(application, page)
    for no in ("Cancel", escape):
        with clicked(no) as asked:
            controller.window.close()
        assert "nothing will warn you" in asked[-1]
        assert controller.window.isVisible()
        assert page.controller.is_connected
    with clicked("Cancel"):
        click_on(controller.window, page.connection.button)
    assert page.controller.is_connected
    with clicked("Yes"):
        controller.window.close()
    assert not controller.window.isVisible()
    folder = tmp_path / "data" / "flights"
    assert list(folder.glob("*.json"))
    assert list(folder.glob("*.tlog"))


@pytest.mark.slow
def test_a_click_on_a_photo_goes_to_its_view(application, controller, page):
    connect(application, page)
    turn_until(application, lambda: len(page.strip.states()) == 6)
    place = page.strip.cell(3).center()
    QTest.mouseClick(page.strip, Qt.MouseButton.LeftButton, pos=QPoint(int(place.x()), int(place.y())))
    selection = controller.context.selection
    assert (selection.kind, selection.id) == (ItemKind.VIEWPOINT, page.strip.states()[3][0])
    assert "still to come" in page.strip.words(3)


@pytest.mark.slow
def test_a_new_window_takes_the_flight_over(application, controller, page):
    """As when the language changes: the flight belongs to the context."""
    connect(application, page)
    take_off(application, page)
    controller._rebuild_window()
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    again = controller.window.tab("fly")
    assert again.controller is page.controller
    before = n_photos(again)
    turn_until(application, lambda: n_photos(again) > before)
    assert again.strip.states()[0][1] is ViewState.TAKEN


@pytest.mark.long
def test_what_was_noted_and_told_before_is_said_in_a_language_that_is_chosen_later(application, controller, page):
    connect(application, page)
    ask_for(page, Request.UPLOAD)
    on_board = DONE[Request.UPLOAD]
    turn_until(application, lambda: on_board in page.notes.texts())
    controller.context.say(Severity.ERROR, REFUSALS[Request.LOG], about="order")
    assert REFUSALS[Request.LOG] in controller.window.messages.line()
    try:
        controller.choose(language=Language.GERMAN)
        again = controller.window.tab("fly")
        assert again is not page
        german = translation("de")
        assert german(on_board) != on_board
        assert on_board not in again.notes.texts()
        assert german(on_board) in again.notes.texts()
        assert controller.window.messages.line().endswith(german(REFUSALS[Request.LOG]))
        assert german(REFUSALS[Request.LOG]) in controller.window.messages.texts()
    finally:
        controller.choose(language=Language.ENGLISH)


@pytest.mark.slow
def test_lengths_are_shown_in_feet_once_they_are_chosen(application, controller, page):
    connect(application, page)
    turn_until(application, lambda: "min 10.0 m" in page.readouts.text())
    controller.context.set_units(UnitSystem.IMPERIAL)
    assert "min 32.8 ft" in page.readouts.text()
    controller.context.set_units(UnitSystem.METRIC)


def test_without_a_plan_it_says_what_to_do_first(application, controller, page):
    controller.context.session.open(Document(planned()[0]), None)
    assert "Plan a flight first" in page._phase.text()
    assert not page.connection.button.isEnabled()


def test_the_simulation_starts_with_the_wind_that_the_plan_expects_until_another_is_chosen(controller, page):
    """As the command `simulate` does."""
    model, plan = planned()
    box = page.simulation.rows["wind_m_s"].widget

    def open_with(wind_m_s):
        entry = PlanEntry("plan-1", "First", replace(plan, rules=replace(plan.rules, wind_m_s=wind_m_s)))
        controller.context.session.open(Document(model, (entry,), "plan-1"), None)
        return box.value()

    assert open_with(6.0) == open_with(6.0) == 6.0
    assert page.controller.simulation.conditions.wind_m_s == 6.0
    assert open_with(3.0) == 3.0
    box.box().setValue(8.0)
    assert open_with(5.0) == page.controller.simulation.conditions.wind_m_s == 8.0


@pytest.mark.slow
def test_effects_of_the_simulation_are_shown_with_reason_and_overruled(application, controller, page):
    page.right.setCurrentIndex(1)
    turn_until(application, lambda: "wind" in page.simulation.effects._cards)
    assert "no wind" in page.simulation.effects.card("wind").text()
    page.simulation.rows["wind_m_s"].widget.box().setValue(8.0)
    turn_until(application, lambda: "is on" in page.simulation.effects.card("wind").text())
    card = page.simulation.effects.card("wind")
    card.setting.setCurrentIndex(card.setting.findData("off"))
    turn_until(application, lambda: "is off" in page.simulation.effects.card("wind").text())
    assert page.controller.simulation.effect_settings == {"wind": "off"}


@pytest.mark.slow
def test_what_went_wrong_is_said_as_an_error(application, controller, page):
    heard = []
    controller.context.messageShown.connect(heard.append)
    connect(application, page)
    page.controller.request(Request.START)
    turn_until(application, lambda: any(message.severity is Severity.ERROR for message in heard))
    assert "pre-flight list" in heard[-1].text


class Places:
    """Where the buttons of a flight stand in the window, looked at in every turn of the event loop."""

    def __init__(self, controller, page):
        self.window, self.page = controller.window, page
        self.first, self.moved, self.covered, self.away = self.now(), [], [], set()
        self.timer = QTimer(controller.window, interval=20)
        self.timer.timeout.connect(self.look)
        self.timer.start()

    def now(self):
        buttons = {request.name: self.page.buttons.button(request) for request in Request if request in PLACES}
        buttons["CONNECT"] = self.page.connection.button
        return {
            name: (button.mapTo(self.window, QPoint(0, 0)), button.size(), button.isVisible())
            for name, button in buttons.items()
        }

    def look(self):
        """Buttons of the flight never move; Connect, among texts that grow, only while they are laid out."""
        now, phase = self.now(), self.page._phase.text()
        away = {name for name, place in now.items() if place != self.first[name]}
        self.moved += [(name, phase) for name in away if name != "CONNECT" or name in self.away]
        self.away = away
        for request in PLACES:
            button = self.page.buttons.button(request)
            on_top = self.window.childAt(button.mapTo(self.window, button.rect().center()))
            if on_top is not button:
                self.covered.append((request, phase))


@pytest.mark.slow
def test_buttons_of_a_flight_keep_their_places_in_every_phase(application, radio, controller, page, monkeypatch):
    """Not connected, uploading, ready, starting, flying, hovering, link lost, coming home, landed."""
    monkeypatch.setattr(page.controller, "_connection", lambda *_: radio)
    turn_until_idle(application, controller)
    places = Places(controller, page)
    assert all(visible for _, _, visible in places.first.values())
    phases = set()
    page.controller.viewChanged.connect(lambda view: phases.add((view.phase, view.link)))
    connect(application, page)
    take_off(application, page)
    ask_for(page, Request.PAUSE)
    turn_until(application, lambda: page.buttons.button(Request.RESUME).isEnabled())
    radio.cut.is_unplugged.set()
    turn_until(application, lambda: page.band.isVisible())
    turn_until(application, lambda: "SIGNAL LOST for" in page.band.text())
    radio.cut.is_unplugged.clear()
    turn_until(application, lambda: page.band.isHidden() and page.buttons.button(Request.RESUME).isEnabled())
    ask_for(page, Request.RESUME)
    ask_for(page, Request.RETURN)
    turn_until(application, lambda: has_landed(page))
    click_on(controller.window, page.connection.button)
    turn_until(application, lambda: not page.controller.is_connected)
    places.look()
    assert len(phases) >= 4, "ready, flying, lost, and before the upload"
    assert places.moved == []
    assert places.covered == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("language", "scale"),
    [(Language.ENGLISH, 1.0), slow(Language.ENGLISH, 1.6), slow(Language.GERMAN, 1.0), (Language.GERMAN, 1.6)],
)
def test_return_and_land_lie_apart_from_each_other_and_from_the_rest(application, controller, scale, language):
    from groundstation.gui.widgets.theme import TOUCH_PX

    controller.choose(language=language, text_scale=scale)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    turn_until_idle(application, controller)
    page = controller.window.tab("fly")
    try:
        rooms = {request: page.buttons.button(request).geometry() for request in PLACES}
        for request in (Request.RETURN, Request.LAND):
            assert rooms[request].height() >= TOUCH_PX
            wide = rooms[request].marginsAdded(QMargins(*[APART_PX - 1] * 4))
            assert [other for other in rooms if other is not request and wide.intersects(rooms[other])] == []
        for one, other in itertools.combinations(rooms.values(), 2):
            assert not one.intersects(other)
        for request in PLACES:
            button = page.buttons.button(request)
            assert button.fontMetrics().horizontalAdvance(button.text()) + ICON_PX < button.width()
            assert not button.icon().isNull()
            right = button.mapTo(page.left.parentWidget(), button.rect().topRight()).x()
            assert right < page.left.parentWidget().width(), "not cut off at the side of the column"
    finally:
        controller.choose(language=Language.ENGLISH, text_scale=1.0)
        turn_until(application, lambda: controller.window.shared_view.scene() is not None)


@pytest.mark.slow
def test_pressing_the_keyboard_twice_gives_no_second_order(application, controller, page):
    """The button that was pressed is disabled, and Qt would give the keyboard to the next one."""
    connect(application, page)
    heard = []
    page.buttons.requested.connect(heard.append)
    controller.window.activateWindow()
    turn_until(application, controller.window.isActiveWindow)
    page.buttons.button(Request.UPLOAD).setFocus()
    for _ in range(40):
        QTest.keyClick(controller.window.focusWidget(), Qt.Key.Key_Space)
        application.processEvents()
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    QTest.keyClick(controller.window.focusWidget(), Qt.Key.Key_Space)
    assert heard == [Request.UPLOAD]


@pytest.mark.long
def test_a_double_click_on_start_asks_once_and_orders_nothing_else(application, controller, page):
    connect(application, page)
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    heard = []
    page.buttons.requested.connect(heard.append)
    start = page.buttons.button(Request.START)
    for _ in range(3):
        QTest.mouseDClick(start, Qt.MouseButton.LeftButton)
        application.processEvents()
    assert heard == [], "it is held, not clicked"
    with clicked("Yes"):
        hold_on(start.window(), start)
    for _ in range(3):
        QTest.mouseDClick(start, Qt.MouseButton.LeftButton)
        application.processEvents()
    turn_until(application, lambda: n_photos(page) >= 1)
    assert heard == [Request.START]


@pytest.mark.slow
def test_keys_of_a_flight_do_nothing_in_other_tabs_nor_what_is_not_allowed(application, controller, page):
    heard = []
    page.buttons.requested.connect(heard.append)
    controller.window.activateWindow()
    turn_until(application, controller.window.isActiveWindow)
    for tab in ("fly", "site", "fly"):
        controller.window.show_tab(tab)
        turn_until_idle(application, controller)
        for action in page.buttons.flight_actions():
            assert not action.isEnabled(), "nothing is connected"
            QTest.keySequence(controller.window, action.shortcut())
    connect(application, page)
    controller.window.show_tab("site")
    QTest.keySequence(controller.window, page.buttons.flight_actions()[0].shortcut())
    assert heard == []
    controller.window.show_tab("fly")
    QTest.keySequence(controller.window, page.buttons.flight_actions()[0].shortcut())
    assert heard == [Request.UPLOAD]


@pytest.mark.slow
def test_times_of_notes_carry_seconds_into_minutes(application, page):
    page.notes.add(59.96, Severity.NOTE, "nearly a minute")
    assert page.notes.texts().endswith("1:00.0  nearly a minute")


@pytest.mark.slow
def test_a_finding_of_the_report_leads_to_its_view(application, controller, page):
    connect(application, page)
    take_off(application, page)
    ask_for(page, Request.RETURN)
    turn_until(application, lambda: has_landed(page))
    found = next(finding for finding in page.controller.active.ended.report.findings if finding.code == "views-taken")
    row = next(n for n, text in enumerate(page.findings.texts()) if "views-taken" in text)
    page.findings.clicked.emit(page.findings.model().index(row, 0))
    selection = controller.context.selection
    assert (selection.kind, selection.id) == (ItemKind.VIEWPOINT, found.place)


def few_items(monkeypatch, limit):
    """An autopilot with room for fewer photos than a small plan has."""
    monkeypatch.setattr("groundstation.services.mission.readiness.photos_that_fit", lambda _autopilot: limit)


@pytest.mark.slow
def test_too_many_photos_for_the_autopilot_are_shared_out_on_a_yes(application, controller, page, monkeypatch):
    few_items(monkeypatch, 4)
    for no in ("Cancel", escape):
        with clicked(no) as asked:
            click_on(controller.window, page.connection.button)
        turn_until_idle(application, controller)
        assert "about 4 photos, and a sortie of this plan has 6" in asked[0]
        assert not page.controller.is_connected
        assert len(controller.context.document.plans) == 1
    with clicked("Yes"):
        connect(application, page)
    entry = controller.context.document.current
    assert entry.title == "First, shared out"
    assert [len(sortie.viewpoint_ids) <= 4 for sortie in entry.plan.sorties] == [True] * page.sortie.count()
    assert {view.id for view in entry.plan.viewpoints} == {view.id for view in planned()[1].viewpoints}
    assert page.controller.is_for_shown_plan
    assert page._phase.text() == "Connected. Upload the mission."


@pytest.mark.slow
def test_start_waits_for_rtk_only_where_it_is_needed(application, controller, page):
    from missions.simulator.conditions import Conditions

    page.controller.simulation.conditions = Conditions(fix="single")
    connect(application, page)
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    page.settings.needs_rtk.click()
    turn_until(application, lambda: not page.buttons.button(Request.START).isEnabled())
    assert "RTK" in page.checks.text()
    page.settings.needs_rtk.click()
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())


def connect_radio(application, radio, page, monkeypatch):
    """Connect the vehicle at the radio, which is not taken for a simulation, and upload to it."""
    # Answers are waited for a second of the vehicle's: on a busy computer too short for 40 times as fast.
    radio.is_simulated, radio.speed_up = False, 8.0
    monkeypatch.setattr(page.controller, "_connection", lambda *_: radio)
    page.controller.set_choice(ConnectionChoice(LinkKind.TCP, "127.0.0.1:5760"))
    page.connection.setValue(page.controller.choice)
    page.connection.button.click()
    upload(application, page)


def upload(application, page):
    turn_until(application, lambda: page.buttons.button(Request.UPLOAD).isEnabled())
    ask_for(page, Request.UPLOAD)
    turn_until(application, lambda: page.controller.active.view.phase in (Phase.CHECKING, Phase.READY))


def remedy(application, page, code, way):
    """Press the button beside a check."""
    turn_until(application, lambda: (found := page.checks.button(code, way)) is not None and found.isVisible())
    button = page.checks.button(code, way)
    scroll_to(button)
    click_on(button.window(), button)


@pytest.mark.slow
def test_parameters_of_a_real_vehicle_are_set_only_after_a_question(application, radio, controller, page, monkeypatch):
    radio.changes = {"parameters": {"SIM_SPEEDUP": None, "RTL_ALT": 2100.0, "MNT1_PITCH_MIN": -45.0}}
    connect_radio(application, radio, page, monkeypatch)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    assert "the plan was made for" in page.checks.text()
    before = radio._opened.simulated.parameters.values()
    assert before["MNT1_PITCH_MIN"] == -45.0, "an upload sets nothing"
    for no in ("Cancel", escape):
        with clicked(no) as asked:
            remedy(application, page, "parameters", Remedy.SET_PARAMETERS)
        assert "MNT1_PITCH_MIN: -45 \u2192 -90" in asked[-1]
    assert radio._opened.simulated.parameters.values() == before
    with clicked("Yes"):
        remedy(application, page, "parameters", Remedy.SET_PARAMETERS)
    turn_until(application, lambda: "they are as the plan needs them" in page.checks.text())
    assert radio._opened.simulated.parameters.values()["MNT1_PITCH_MIN"] == -90.0
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())


@pytest.mark.slow
def test_an_aircraft_at_another_height_flies_once_the_pilot_has_agreed(
    application, radio, controller, page, monkeypatch
):
    x, y, z = planned()[0].site.home_enu_m
    radio.changes = {"stands_enu_m": (x, y, z - 3.0)}
    connect_radio(application, radio, page, monkeypatch)
    turn_until(application, lambda: "stands 3.0 m lower than the planned home" in page.checks.text())
    assert not page.buttons.button(Request.START).isEnabled()
    with clicked("Cancel") as asked:
        remedy(application, page, "home-height", Remedy.RAISE)
    assert "stands 3.0 m lower than planned" in asked[-1]
    with clicked("Yes"):
        remedy(application, page, "home-height", Remedy.RAISE)
    turn_until(application, lambda: page.controller.active.sortie.orders.raised_m == pytest.approx(3.0, abs=0.1))
    upload(application, page)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())


@pytest.mark.slow
def test_home_can_be_where_the_aircraft_stands(application, radio, controller, page, monkeypatch):
    x, y, z = planned()[0].site.home_enu_m
    radio.changes = {"stands_enu_m": (x + 8.0, y, z + 2.0)}
    connect_radio(application, radio, page, monkeypatch)
    turn_until(application, lambda: "8.0 m from the planned home" in page.checks.text())
    with clicked("Yes"):
        remedy(application, page, "home", Remedy.PLAN_FROM_HERE)
    assert controller.context.document.site.site.home_enu_m == pytest.approx((x + 8.0, y, z + 2.0), abs=0.05)
    assert "plan again" in controller.window.messages.texts()


def answer(text):
    """Type a text into the dialog, and say OK."""

    def step(dialog):
        type_into(dialog.findChild(QLineEdit), text)
        press("OK")(dialog)

    return step


@pytest.mark.long
def test_a_return_through_the_building_needs_a_typed_word(application, radio, controller, page, monkeypatch):
    radio.changes = {
        "autopilot": Autopilot.PX4,
        "parameters": {"SIM_GZ_EN": None, "SYS_HITL": 0, "RTL_RETURN_ALT": 500.0},
    }
    connect_radio(application, radio, page, monkeypatch)
    turn_until(application, lambda: "it returns above the airspace" in page.checks.text())
    for typed in (answer("go on"), escape):
        with clicked(typed) as asked:
            remedy(application, page, "return", Remedy.OVERRULE)
        assert "type RETURN" in asked[-1]
        assert not page.buttons.button(Request.START).isEnabled()
    with clicked(answer("return")):
        remedy(application, page, "return", Remedy.OVERRULE)
    turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
    assert "(overruled)" in page.checks.text()


@pytest.mark.slow
def test_another_project_in_flight_leaves_the_flight_and_gets_none_of_its_picture(
    application, controller, page, tmp_path
):
    from planning.site.bundled import write_scene
    from planning.site.file import read_site

    connect(application, page)
    take_off(application, page)
    folder = tmp_path / "office"
    folder.mkdir()
    other = read_site(write_scene("office", folder))
    controller.context.session.open(Document(other), None)
    before = n_photos(page)
    turn_until(application, lambda: n_photos(page) > before)
    assert page.pictures._flight is None
    assert controller.window.shared_view.scene()._panel_values is None
    assert page._phase.text().startswith("Flying.")
    assert page.buttons.button(Request.RETURN).isEnabled()
    assert not page.buttons.button(Request.UPLOAD).isEnabled()
    ask_for(page, Request.RETURN)
    turn_until(application, lambda: has_landed(page))
    page.report.top_up.click()
    flown_over = planned()[0].site.name
    assert f"This flight was over the site {flown_over}" in controller.window.messages.texts()


@pytest.mark.slow
def test_a_long_sortie_and_a_lost_link_fit_a_small_screen(application, controller):
    page, window = controller.window.tab("fly"), controller.window
    for at in (400, 30):
        states = [ViewState.NEXT if number == at else ViewState.TO_COME for number in range(700)]
        page.strip.set_states(tuple((f"v{number:04d}", state) for number, state in enumerate(states)))
        page.band.show_lost(7.0)
        turn_until(application, lambda at=at: _is_seen(page.strip, at))
        assert not _is_seen(page.strip, 430 - at)
        assert window.minimumSizeHint().height() <= 720
        assert window.height() == 720
    page.strip.setFocus()
    for _ in range(200):
        QTest.keyClick(page.strip, Qt.Key.Key_Right)
    turn_until(application, lambda: _is_seen(page.strip, 200))
    assert not _is_seen(page.strip, 30)


def _is_seen(strip, number):
    return strip.visibleRegion().boundingRect().contains(strip.cell(number).center().toPoint())


@pytest.mark.slow
def test_connected_the_form_of_the_vehicle_makes_room_for_the_list_before_take_off(application, page):
    from PySide6.QtWidgets import QScrollArea

    place = page.connection.button.mapTo(page.left, QPoint(0, 0))
    assert page.connection.kind.isVisible()
    connect(application, page)
    area = page.checks.parentWidget()
    while not isinstance(area, QScrollArea):
        area = area.parentWidget()
    view = area.viewport()
    shown = [row for row in page.checks._rows if view.rect().contains(row.side.mapTo(view, row.side.rect().center()))]
    assert len(shown) >= 6
    assert not page.connection.kind.isVisible()
    assert page.connection.button.mapTo(page.left, QPoint(0, 0)) == place
    click_on(page.connection.button.window(), page.connection.button)
    turn_until(application, lambda: not page.controller.is_connected)
    assert page.connection.kind.isVisible()


@pytest.mark.slow
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
def test_the_battery_and_the_time_of_a_sortie_agree_from_the_mission_tab_to_the_start(
    application, controller, page, autopilot
):
    """What it uses, and with the reserve that must be left; where the autopilot is slower than the plan, that it is."""
    reserve = 100.0 * controller.context.document.current.plan.rules.battery_reserve
    connect(application, page, autopilot=autopilot)
    upload(application, page)
    told = re.search(
        r"the sortie and the reserve take (\d+)%(?: \((\S+) flies it in (\S+) min, the plan reckons with (\S+) min\))?",
        page.checks.text(),
    )
    assert told is not None, page.checks.text()
    with clicked("Cancel") as asked:
        ask_for(page, Request.START)
    controller.window.show_tab("mission")
    turn_until_idle(application, controller)
    table = controller.window.tab("mission").sorties._rows
    heads = [table.horizontalHeaderItem(column).text() for column in range(table.columnCount())]
    used, planned = (table.item(0, heads.index(head)).text() for head in ("Used", "Time"))
    takes, uses = (re.search(pattern, asked[0])[1] for pattern in (r"in about (\S+),", r"uses about (\d+)%"))
    # Each of the figures is rounded by itself.
    assert abs(int(told[1]) - int(uses) - reserve) <= 1.0
    if told[2] is None:
        assert abs(int(uses) - int(used[:-1])) <= 1
    else:
        assert told.groups()[1:] == (autopilot.product, takes, planned)
        assert f"{autopilot.product} is slower than the plan, which reckons with {planned} min" in asked[0]
        assert takes != planned


@pytest.mark.slow
@pytest.mark.parametrize(("autopilot", "name"), [(Autopilot.ARDUPILOT, "ArduPilot"), (Autopilot.PX4, "PX4")])
def test_autopilots_are_called_as_their_makers_call_them(application, controller, page, autopilot, name):
    connect(application, page, autopilot=autopilot)
    assert f"Link: {name} answers" in page.checks.text()
    labels = [label.text() for label in controller.window.findChildren(QLabel) if label.isVisible()]
    notes = [message.text for message in controller.window.messages.messages()]
    for text in (*labels, *notes, page.checks.text()):
        assert autopilot.value not in text, f"the word of files and commands is shown: {text}"


@pytest.mark.slow
def test_after_disconnecting_no_battery_and_no_height_is_shown_for_that_of_now(application, page):
    connect(application, page)
    turn_until(application, lambda: "100%" in page.readouts.text() and "RTK" in page.readouts.text())
    page.connection.button.click()
    turn_until(application, lambda: not page.controller.is_connected)
    shown = page.readouts.text()
    assert "%" not in shown, shown
    assert "RTK" not in shown, shown
    assert "0/6" in shown, "what was photographed stays"
    connect(application, page)
    turn_until(application, lambda: "100%" in page.readouts.text())


@pytest.mark.long
def test_a_flight_that_was_disconnected_in_the_air_is_not_flown(application, controller, page):
    connect(application, page, speed_up=10.0)
    take_off(application, page)
    with clicked("Yes"):
        page.connection.button.click()
    turn_until(application, lambda: has_landed(page))
    assert len(page.controller.active.ended.record.photos) < 6
    assert controller.context.milestones.flown.is_cut_short


@pytest.mark.slow
def test_the_vehicles_own_log_is_fetched_by_its_button_and_the_report_is_made_from_it(application, controller, page):
    assert not page.report.log.isEnabled()
    connect(application, page, speed_up=20.0)
    take_off(application, page)
    assert not page.report.log.isEnabled()
    turn_until(application, lambda: has_landed(page))
    turn_until(application, page.report.log.isEnabled)
    turn_until_idle(application, controller)
    live = page.controller.active.ended
    application.processEvents()
    click_on(controller.window, page.report.log)
    turn_until(application, lambda: "vehicle's log: " in page.notes.texts())
    assert "proved by its checksum" in page.notes.texts()
    turn_until(application, lambda: page.controller.active.ended is not live)
    ended = page.controller.active.ended
    assert "Photos: 6 of 6 views" in page.report.text()
    assert ended.path.with_suffix(".BIN").exists()
    assert page.controller.after.flown(page.controller.plan)[-1].photos == ended.record.photos
