"""The Fly tab's widgets put together: signals go to the controller, what the flight tells comes back here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QAction, QCloseEvent, QColor, QKeySequence
from PySide6.QtWidgets import (
    QApplication,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QMainWindow,
    QPushButton,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.application.translate import translated
from groundstation.gui.fly.after_flight import LogBookDialog
from groundstation.gui.fly.connection_box import ConnectionBox
from groundstation.gui.fly.fleet_box import FleetBox, FleetTexts
from groundstation.gui.fly.flight_buttons import APART_PX, FlightButtons, PreflightList
from groundstation.gui.fly.flight_overlay import FlightOverlay
from groundstation.gui.fly.flight_settings_page import SettingsPage
from groundstation.gui.fly.fly_controller import BEFORE_FLIGHT, FlyController
from groundstation.gui.fly.joystick_controller import JoystickController
from groundstation.gui.fly.live_aircraft import ActiveFlight
from groundstation.gui.fly.live_pictures import LivePictures, PhotoStrip, ScrolledStrip
from groundstation.gui.fly.questions import FlightQuestions
from groundstation.gui.fly.readouts_view import ReadoutsView, ReportView
from groundstation.gui.fly.simulation_controller import SimulationPage
from groundstation.gui.fly.speech import Voice, WarningSpeaker
from groundstation.gui.shared_view import SharedView, SharedViewPage
from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.scrolling import scrolled
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.events import FlightEnded, LinkState, LiveView, PhotoCounted, Request
from groundstation.services.fly.joystick import JoystickAction
from groundstation.services.fly.options import FlightSettings
from groundstation.services.fly.sortie import is_same_place, take_off_of
from groundstation.services.plan.places import item_of_place
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.project.steps import Act
from groundstation.services.units import UnitSystem, minutes_text
from groundstation.vehicle.preflight import PreflightCheck, Remedy
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity
from planning.revision.top_up import TopUp

# Where a flight stands, in the window's language.


class FlightTexts(QObject):
    """Says what a controller is doing."""

    def __init__(self, context: ApplicationContext, controller: FlyController, parent: QObject) -> None:
        super().__init__(parent)
        self._context, self._controller = context, controller

    def connected_to(self) -> str:
        """The other end of the link; empty where there is none."""
        controller = self._controller
        if not controller.is_connected:
            return ""
        if controller.choice.url:
            is_signed = controller.choice.is_signed
            return self.tr("{0}, signed").format(controller.choice.url) if is_signed else controller.choice.url
        return self.tr("Simulation, {0:g} times as fast").format(controller.choice.speed_up)

    def where_it_stands(self) -> str:
        """What is going on, or what to do first."""
        controller, active = self._controller, self._controller.active
        if self._context.document.site is None and not controller.is_connected:
            return self.tr("Open or import a site first, on the Site tab.")
        if (controller.plan is None or not controller.plan.sorties) and not controller.is_connected:
            return self.tr("Plan a flight first, on the Plan tab.")
        if controller.is_preparing:
            return self.tr("The flight is being prepared ...")
        if not controller.is_connected or active is None:
            return self.tr("Not connected.")
        if active.link is LinkState.OPENING or active.view is None:
            return self.tr("The link is being opened ...")
        if active.link is LinkState.SILENT:
            if active.link_problem:
                return str(self._context.localized(active.link_problem))
            return self.tr("The link is open; no vehicle was heard yet.")
        return self._phase_text(active.view)

    def _phase_text(self, view: LiveView) -> str:
        texts = {
            None: self.tr("Connected. Upload the mission."),
            Phase.CONNECTING: self.tr("Connecting ..."),
            Phase.PREPARING: self.tr("The vehicle is being prepared ..."),
            Phase.UPLOADING: self.tr("Uploading ..."),
            Phase.CHECKING: self.tr("On board. Waiting for the list."),
            Phase.READY: self.tr("Ready for take-off."),
            Phase.STARTING: self.tr("Starting ..."),
            Phase.FLYING: self.tr("Flying."),
            Phase.ENDED: self.tr("Landed."),
        }
        text = texts[view.phase]
        if not self._controller.is_for_shown_plan and not view.state.is_armed:
            return self.tr("This connection is for another plan. Disconnect, and connect for the plan that is shown.")
        if view.fetching is not None:
            what, done, total = view.fetching
            return self.tr("{0} ({1:.1f} of {2:.1f} MB)").format(self._context.localized(what), done / 1e6, total / 1e6)
        what, done, total = view.doing
        if view.phase is Phase.UPLOADING and total > 0.0:
            return self.tr("{0} {1} ({2:.0f} of {3:.0f})").format(text, self._context.localized(what), done, total)
        if view.phase is Phase.FLYING and view.state.mode is not None:
            return self.tr("{0} Mode: {1}").format(text, view.state.mode.value)
        return text


# A band across the whole window while the link is lost, whatever tab is in front.

FONT_SCALE = 1.3


class LinkBand(QLabel):
    """Says that the link is lost, since when, and that the aircraft goes on by itself."""

    def __init__(self) -> None:
        super().__init__()
        self.setWordWrap(True)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        font = self.font()
        font.setPointSizeF(FONT_SCALE * font.pointSizeF())
        font.setBold(True)
        self.setFont(font)
        self.setContentsMargins(8, 6, 8, 6)
        self.hide()

    def put_into(self, window: QWidget) -> None:
        """Stand above the messages of a main window, where it moves no button, or on top of any other."""
        centre = window.centralWidget() if isinstance(window, QMainWindow) else None
        page = window if centre is None else centre
        layout = page.layout()
        if isinstance(layout, QVBoxLayout):
            layout.insertWidget(layout.count() - 1, self)
        else:
            self.setParent(page)

    def show_lost(self, silent_s: float | None, number: int | None = None) -> None:
        """Appear; `silent_s` since the vehicle was last heard, `number` of one of several aircraft."""
        look = colours()
        self.setStyleSheet(f"background: {look.error}; color: {look.base};")
        if silent_s is None:
            text = self.tr("SIGNAL LOST. The link is opened again; the aircraft continues by itself.")
        else:
            text = self.tr("SIGNAL LOST for {0:.0f} s. What is shown is old; the aircraft continues by itself.").format(
                silent_s
            )
        if number is not None:
            text = self.tr("Aircraft {0}: {1}").format(number, text)
        if self.text() != text:
            self.setText(text)
        self.setVisible(True)


# Warnings of now, above everything that was noted in the flight: answers, warnings, texts of the autopilot.

MAX_NOTES = 300


class WarningsView(QWidget):
    """Shows the warnings that hold; the most severe first."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._warnings: tuple[FlightWarning, ...] = ()
        self._units = UnitSystem.METRIC
        self._labels: list[QLabel] = []
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(4, 0, 4, 0)
        self._calm = QLabel(self.tr("No warnings."))
        self._calm.setProperty("role", "muted")
        self._layout.addWidget(self._calm)
        self._layout.addStretch(1)

    def set_warnings(self, warnings: tuple[FlightWarning, ...]) -> None:
        """Show these."""
        if warnings != self._warnings:
            self._warnings = warnings
            self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def text(self) -> str:
        """All warnings, a line each."""
        return "\n".join(label.text() for label in self._labels[: len(self._warnings)])

    def _fill(self) -> None:
        ordered = sorted(self._warnings, key=lambda warning: warning.severity is not Severity.ERROR)
        while len(self._labels) < len(ordered):
            label = QLabel()
            label.setWordWrap(True)
            self._layout.insertWidget(1 + len(self._labels), label)
            self._labels.append(label)
        for number, label in enumerate(self._labels):
            label.setVisible(number < len(ordered))
            if number < len(ordered):
                warning = ordered[number]
                label.setText(self._warning_text(warning))
                role = warning.severity.value
                if label.property("role") != role:
                    label.setProperty("role", role)
                    label.style().polish(label)
        self._calm.setVisible(not ordered)

    def _warning_text(self, warning: FlightWarning) -> str:
        shown_text = translated(warning.text, self._units)
        if warning.severity is Severity.ERROR:
            return self.tr("Danger: {0}").format(shown_text)
        return self.tr("Warning: {0}").format(shown_text)


class FlightNotes(QListWidget):
    """What happened, the latest at the end."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWordWrap(True)
        self.setAccessibleName(self.tr("What happened in the flight"))
        self.setToolTip(self.tr("Minutes and seconds after take-off, as in the plan and the report"))

    def add(self, time_s: float | None, severity: Severity, text: str) -> None:
        """Note something; `time_s` after take-off."""
        minutes, tenths = divmod(round(10.0 * (time_s or 0.0)), 600)
        when = "" if time_s is None else f"{minutes}:{tenths / 10.0:04.1f}  "
        row = QListWidgetItem(f"{when}{text}")
        colour = {Severity.ERROR: colours().error, Severity.WARNING: colours().warning}.get(severity)
        if colour:
            row.setForeground(QColor(colour))
        self.addItem(row)
        while self.count() > MAX_NOTES:
            self.takeItem(0)
        self.scrollToBottom()

    def texts(self) -> str:
        """All notes, a line each."""
        return "\n".join(self.item(row).text() for row in range(self.count()))


_HELD_BY = {JoystickAction.RETURN: Request.RETURN, JoystickAction.LAND: Request.LAND}


class FlyPage(GradualTab):
    """The tab."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView, *, at_once: bool = True) -> None:
        self._context, self._shared_view = context, shared_view
        super().__init__(shared_view, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        context, shared_view = self._context, self._shared_view
        self.controller, self.questions = FlyController.of(context), FlightQuestions()
        self._words = FlightTexts(context, self.controller, self)
        self._fleet_words = FleetTexts(context, self.controller, self)
        self.connection, self.sortie = ConnectionBox(), ChoiceBox()
        self.buttons, self.checks = FlightButtons(), PreflightList()
        self.readouts, self.warnings = ReadoutsView(), WarningsView()
        yield
        self.simulation, self.settings, self.strip = SimulationPage(), SettingsPage(), PhotoStrip()
        self.findings = FindingsList()
        self.notes, self.report, self.band = FlightNotes(), ReportView(), LinkBand()
        self.fleet = FleetBox()
        self.pictures, self.overlay = LivePictures(shared_view, self), FlightOverlay(shared_view, self)
        self.lists = QPushButton(self.tr("Lists"))
        self.lists.setCheckable(True)
        self.lists.setToolTip(self.tr("Show what stands beside and below the view, which has their room in flight"))
        self.lists.hide()
        shared_view.add_overlay_bar(self.lists)
        self._view_actions = self._make_view_actions()
        self._is_shown = False
        self._voice = Voice(self)
        self._speaker = WarningSpeaker(self._voice, self)
        self.joystick = JoystickController(self)
        self._book = QAction(self.tr("Log book ..."), self)
        self._book.setToolTip(self.tr("Flights with aircraft, battery, times and findings; cycles of batteries"))
        self._book.triggered.connect(lambda _checked=False: self.show_book())
        self._phase = QLabel()
        self._phase.setWordWrap(True)
        self._phase.setProperty("role", "heading")
        yield
        self.left = self._make_left()
        yield
        self.right: QWidget | None = self._make_right()
        self.bottom: QWidget | None = self._make_bottom()
        yield
        self.band.put_into(shared_view.window())
        self._connect()
        self.connection.setValue(self.controller.choice)
        self.settings.set_voice(has_voice=self._voice.is_there())
        self.settings.setValue(self.controller.settings)
        self._take_settings(self.controller.settings)
        self.settings.joystick.setValue(self.controller.joystick)
        self.joystick.set_buttons(self.controller.joystick)
        self._show_units(context.units)
        self._show_document()
        self._show_all()
        self._show_fleet()
        yield

    # A tab

    def shown(self) -> None:
        """Draw the flight into the shared view."""
        self._is_shown = True
        self.pictures.show(self._pictured())
        self._make_room()
        self.controller.simulation.look(self.controller.plan, self.controller.number)
        self.controller.signing.look(self.controller.choice)

    def hidden(self) -> None:
        """Give the shared view back; the flight goes on."""
        self._is_shown = False
        self.pictures.hide()
        self._make_room()

    def actions(self) -> tuple[QAction, ...]:
        """For the tab's menu."""
        return (*self.buttons.flight_actions(), self._book, *self._view_actions)

    def take_step(self, act: Act) -> None:
        """Connect, upload, start, and what comes after the flight, each as its own button does."""
        match act:
            case Act.CONNECT:
                self._connect_vehicle()
            case Act.UPLOAD:
                self.buttons.button(Request.UPLOAD).click()
            case Act.TAKE_OFF:
                self.buttons.button(Request.START).click()
            case Act.NEXT_SORTIE:
                self.controller.choose_next_sortie()
            case Act.RESUME_SORTIE:
                self.controller.after.resume_sortie()
            case Act.TOP_UP:
                self.controller.after.top_up()
            case _:
                pass

    def n_photos(self) -> int:
        """Views of the sortie that have a photo."""
        return 0 if self.controller.active is None else len(self.controller.active.photos)

    # How it is put together

    def _make_view_actions(self) -> tuple[QAction, ...]:
        """What lies over the view, by the keyboard."""
        found = []
        for text, key, slot in (
            (self.tr("Lists beside the view"), "Ctrl+Shift+D", self.lists.toggle),
            (self.tr("Camera picture large"), "Ctrl+Shift+K", self.overlay.toggle_camera),
            (self.tr("Mute warnings"), "Ctrl+Shift+T", lambda: self._mute(self.settings.value().speaks)),
        ):
            action = QAction(text, self)
            action.setShortcut(QKeySequence(key))
            action.setEnabled(False)
            action.triggered.connect(lambda _checked=False, slot=slot: slot())
            found.append(action)
        return tuple(found)

    def _make_left(self) -> QWidget:
        left = QWidget()
        layout = QVBoxLayout(left)
        layout.setContentsMargins(3, 6, 3, 6)
        self.sortie.setAccessibleName(self.tr("Sortie to be flown"))
        rest = QWidget()
        below = QVBoxLayout(rest)
        below.setContentsMargins(0, 0, 0, 0)
        for widget in (self.connection, self.sortie, self._phase, self.checks):
            below.addWidget(widget)
        below.addStretch(1)
        # At the top and never scrolled: texts below grow and shrink with the phase, and must not move a button.
        layout.addWidget(self.fleet)
        layout.addWidget(self.buttons)
        layout.addSpacing(APART_PX - layout.spacing())
        area = scrolled(rest)
        area.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        layout.addWidget(area, 1)
        return left

    def _make_right(self) -> QWidget:
        flight = QWidget()
        layout = QVBoxLayout(flight)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.readouts)
        layout.addWidget(self.warnings, 1)
        detail = QTabWidget()
        detail.addTab(scrolled(flight), self.tr("Flight"))
        detail.addTab(scrolled(self.simulation), self.tr("Simulation"))
        detail.addTab(scrolled(self.settings), self.tr("Settings"))
        return detail

    def _make_bottom(self) -> QWidget:
        flight = QWidget()
        layout = QVBoxLayout(flight)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addWidget(ScrolledStrip(self.strip))
        layout.addWidget(self.notes, 1)
        self._lists = QTabWidget()
        self._lists.addTab(flight, self.tr("Photos"))
        self._lists.addTab(self.report, self.tr("Report"))
        self._lists.addTab(self.findings, self.tr("Findings"))
        self.findings.set_placeholder(self.tr("After the landing, what the report found stands here."))
        return self._lists

    def _connect(self) -> None:
        controller, context = self.controller, self._context
        self.connection.valueChanged.connect(controller.set_choice)
        self.connection.valueChanged.connect(controller.signing.look)
        controller.signing.serve(self.connection, self._shared_view.window())
        self.connection.connectRequested.connect(self._connect_vehicle)
        self.connection.disconnectRequested.connect(self._disconnect)
        self.sortie.activated.connect(lambda index: controller.set_sortie(index + 1))
        self.buttons.requested.connect(self._request)
        self.checks.remedyRequested.connect(self._mend)
        self.simulation.valueChanged.connect(self._simulation_chosen)
        self.settings.valueChanged.connect(self._settings_chosen)
        self.settings.passwordTyped.connect(controller.set_corrections_password)
        self.overlay.banner.muteToggled.connect(self._mute)
        self.settings.joystick.valueChanged.connect(controller.set_joystick)
        self.settings.joystick.valueChanged.connect(self.joystick.set_buttons)
        self.settings.joystick.learningChanged.connect(lambda is_on: self.joystick.learn(is_learning=is_on))
        self.joystick.learned.connect(self.settings.joystick.learn)
        self.joystick.foundChanged.connect(lambda is_found: self.settings.joystick.set_found(is_found=is_found))
        self.joystick.pressed.connect(self._joystick_pressed)
        self.joystick.released.connect(self._joystick_released)
        self.findings.placePicked.connect(self._go_to_place)
        self.strip.picked.connect(self._go_to)
        self.report.picked.connect(self._go_to)
        self.report.topUpRequested.connect(controller.after.top_up)
        controller.after.restFound.connect(self._rest_found)
        self.report.resumeRequested.connect(controller.after.resume_sortie)
        self.report.logRequested.connect(lambda: controller.request(Request.LOG))
        controller.stateChanged.connect(self._state_changed)
        controller.aircraftSelected.connect(self._show_selected)
        controller.fleetChanged.connect(self._show_fleet)
        self.fleet.selected.connect(controller.select)
        self.fleet.returnAllRequested.connect(controller.return_all)
        controller.viewChanged.connect(self._show_view)
        self.overlay.camera.videoAccepted.connect(self.settings.take_video)
        controller.photoCounted.connect(self._show_photo)
        controller.linkChanged.connect(self._show_link)
        controller.flightEnded.connect(self._show_end)
        controller.simulation.effectsChanged.connect(self.simulation.set_effects)
        controller.noted.connect(self._note)
        context.documentChanged.connect(self._document_changed)
        context.unitsChanged.connect(self._show_units)
        context.jobsChanged.connect(self._show_state)
        self._shared_view.closing.connect(self._window_closing)
        self.pictures.drawn.connect(self.overlay.draw)
        self.lists.toggled.connect(lambda _is_on: self._make_room())
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusWindowChanged.connect(self._focus_moved)

    def _focus_moved(self, _window: object) -> None:
        """Let the keys of Return and Land work in a dialog, too, while it keeps the window from being used."""
        dialog = QApplication.activeModalWidget()
        if dialog is not None and self.controller.is_any_connected:
            dialog.addActions(self.buttons.emergency_actions())

    def _make_room(self) -> None:
        """While connected the view has the room of the lists, unless these are wanted; what matters lies over it."""
        is_connected = self._is_shown and self.controller.is_any_connected
        self.lists.setVisible(is_connected)
        for action in self._view_actions:
            action.setEnabled(is_connected)
        self._shared_view.aloneRequested.emit(is_connected and not self.lists.isChecked())
        self.overlay.show(is_shown=is_connected, has_sides=not self.lists.isChecked())

    # What the user does

    def show_book(self) -> LogBookDialog:
        """Show the flights of this project, or of this user where there is none."""
        dialog = LogBookDialog(self._context, self._shared_view.window())
        dialog.open()
        return dialog

    def _rest_found(self, found: TopUp) -> None:
        if self.questions.confirm_closing_flight(self._shared_view.window(), found):
            self.controller.after.take(found)
        else:
            self.controller.after.leave_rest()

    def _request(self, request: Request) -> None:
        if request is not Request.START or self._may_start():
            self.controller.request(request)

    def _settings_chosen(self, settings: FlightSettings) -> None:
        self.controller.set_settings(settings)
        self._take_settings(settings)

    def _mute(self, is_muted: bool) -> None:
        settings = replace(self.settings.value(), speaks=not is_muted)
        self.settings.setValue(settings)
        self._settings_chosen(settings)

    def _joystick_pressed(self, action: JoystickAction) -> None:
        match action:
            case JoystickAction.PAUSE | JoystickAction.RESUME:
                request = Request.PAUSE if action is JoystickAction.PAUSE else Request.RESUME
                self.buttons.button(request).click()
            case JoystickAction.RETURN | JoystickAction.LAND:
                self.buttons.held(_HELD_BY[action]).hold()
            case JoystickAction.VIEW:
                is_map = self._shared_view.page() is SharedViewPage.MAP
                self._shared_view.show_page(SharedViewPage.SCENE if is_map else SharedViewPage.MAP)
            case JoystickAction.LISTS:
                self.lists.toggle()
            case JoystickAction.MUTE:
                self._mute(self.settings.value().speaks)

    def _joystick_released(self, action: JoystickAction) -> None:
        if action in _HELD_BY:
            self.buttons.held(_HELD_BY[action]).let_go()

    def _take_settings(self, settings: FlightSettings) -> None:
        self.overlay.set_video(settings.video)
        self._speaker.set_muted(is_muted=not settings.speaks)
        self.overlay.banner.set_muted(is_muted=not settings.speaks, has_voice=self._voice.is_there())

    def _mend(self, remedy: Remedy, check: PreflightCheck) -> None:
        """Do something about a check before take-off, once the pilot agrees."""
        controller, ask, window = self.controller, self.questions, self._shared_view.window()
        match remedy:
            case Remedy.SET_PARAMETERS:
                changes = controller.parameter_changes()
                if changes and ask.set_parameters(window, changes):
                    controller.set_parameters(changes)
            case Remedy.RAISE:
                by_m = -round(check.value or 0.0, 1)
                if ask.raise_flight(window, by_m, self._context.units):
                    controller.raise_flight(by_m)
            case Remedy.PLAN_FROM_HERE:
                if ask.plan_from_here(window):
                    controller.plan_from_here()
            case Remedy.OVERRULE:
                if ask.overrule(window, self._context.localized(check.text), check.code.upper()):
                    controller.overrule(check.code)

    def _connect_vehicle(self) -> None:
        found = self.controller.limit.exceeded(self.controller.choice)
        if found is None:
            self.controller.connect_vehicle()
        elif self.questions.share_out(self._shared_view.window(), found):
            self.controller.share_out(found)

    def _simulation_chosen(self) -> None:
        self.controller.simulation.choose(*self.simulation.value(), self.controller.plan, self.controller.number)

    def _may_start(self) -> bool:
        active = self.controller.active
        if active is None:
            return False
        autopilot = None if active.view is None else active.view.state.autopilot
        checks = () if active.view is None else active.view.checks
        take_off = take_off_of(active.sortie, autopilot, checks)
        wait_s = self.controller.wait_s(self.controller.selected)
        return self.questions.start(self._shared_view.window(), take_off, self._context.units, wait_s)

    def _disconnect(self) -> None:
        if not self.controller.is_in_flight or self.questions.leave_in_flight(self._shared_view.window()):
            self.controller.disconnect_vehicle()

    def _window_closing(self, event: QCloseEvent) -> None:
        if not event.isAccepted() or not self.controller.is_any_connected:
            return
        if self.controller.is_any_in_flight and not self.questions.leave_in_flight(self._shared_view.window()):
            event.ignore()
            return
        self.controller.close()
        self.overlay.close_view()
        self._voice.stop()
        self.joystick.close()

    def _go_to(self, view_id: str) -> None:
        self._context.jump_to(Item(ItemKind.VIEWPOINT, view_id))

    def _go_to_place(self, place: str) -> None:
        item = item_of_place(place, self._context.document)
        if item is not None:
            self._context.jump_to(item)

    # What changes

    def _document_changed(self, _before: Document, _after: Document) -> None:
        self._show_document()
        pictured = self._pictured()
        self.pictures.set_flight(pictured)
        self._show_fleet()
        self.overlay.set_sortie(None if pictured is None else pictured.sortie)

    def _pictured(self) -> ActiveFlight | None:
        """The flight, where it is over the site that is shown."""
        return self.controller.active if self._is_over_shown(self.controller.active) else None

    def _is_over_shown(self, active: ActiveFlight | None) -> bool:
        shown = self._context.document.site
        if active is None or shown is None:
            return False
        return is_same_place(active.sortie.case.site_model.site, shown.site)

    def _show_document(self) -> None:
        """Offer the sorties of the current plan, and the wind that it expects."""
        plan = self.controller.plan
        self.controller.simulation.expect_wind_of(plan)
        self.simulation.setValue(self.controller.simulation.conditions, self.controller.simulation.effect_settings)
        texts = [
            self.tr("Sortie {0}: photos: {1}, {2}").format(
                n, len(sortie.viewpoint_ids), minutes_text(sortie.duration_s)
            )
            + (
                ""
                if sortie.start_s is None
                else self.tr("; aircraft {0} starts at {1}").format(sortie.aircraft, minutes_text(sortie.start_s))
            )
            for n, sortie in enumerate(() if plan is None else plan.sorties, 1)
        ]
        if [self.sortie.itemText(i) for i in range(self.sortie.count())] != texts:
            self.sortie.clear()
            self.sortie.addItems(texts)
        self.sortie.setCurrentIndex(min(self.controller.number, len(texts)) - 1)
        active = self.controller.active
        if active is not None and active.view is not None:
            self._show_view(active.view)
        self._show_state()

    def _state_changed(self) -> None:
        self.lists.setChecked(False)
        self._show_all()

    def _show_selected(self) -> None:
        """Show another aircraft, with how it is reached and what was chosen for it."""
        controller = self.controller
        self.connection.setValue(controller.choice)
        self.settings.setValue(controller.settings)
        self._take_settings(controller.settings)
        controller.signing.look(controller.choice)
        self._show_document()
        self._show_all()
        self._show_fleet()

    def _show_fleet(self) -> None:
        """Show all aircraft beside the selected one, and warnings of any."""
        controller = self.controller
        found = controller.aircraft
        several = len(found) > 1
        self.fleet.set_rows(self._fleet_words.rows() if several else (), controller.selected.number)
        others = [each for each in found if each is not controller.selected and each.view is not None]
        number = controller.selected.number if several else None
        self.buttons.set_aircraft(number)
        shown = [(each.number, each.active) for each in others if each.active and self._is_over_shown(each.active)]
        self.pictures.set_others(number, tuple(shown))
        self._show_warnings()

    def _show_warnings(self) -> None:
        aged = self.controller.warnings()
        warnings = tuple(each.warning for each in aged)
        self.overlay.set_warnings(aged)
        self.warnings.set_warnings(warnings)
        if self.controller.is_any_connected:
            worded = {each.code: translated(each.text, self._context.units) for each in warnings}
            self._speaker.take(warnings, worded)
        self._show_band()

    def _show_band(self) -> None:
        """Say that a link is lost, whichever aircraft's it is; the selected one's first."""
        selected = self.controller.selected
        found = self.controller.aircraft
        lost = [each for each in found if each.view is not None and each.view.link is LinkState.LOST]
        first = next((each for each in lost if each is selected), lost[0] if lost else None)
        if first is not None and first.view is not None:
            self.band.show_lost(first.view.silent_s, first.number if len(found) > 1 else None)
        elif not self.band.isHidden():
            self.band.hide()

    def _show_all(self) -> None:
        """Show the active flight from its beginning: a new one, or this page is new."""
        active = self.controller.active
        self.notes.clear()
        pictured = self._pictured()
        self.overlay.set_sortie(None if pictured is None else pictured.sortie)
        for note in () if active is None else active.notes:
            self._note(*note)
        self.strip.set_photos({} if active is None else active.photos)
        self.readouts.set_counted(None if active is None else active.counted)
        self._show_report(None if active is None else active.ended)
        self.pictures.set_flight(self._pictured())
        if active is not None and active.view is not None:
            self._show_view(active.view)
        else:
            self._clear_view()
        self.sortie.setCurrentIndex(self.controller.number - 1)
        self._show_state()
        self._show_warnings()

    def _clear_view(self) -> None:
        self.readouts.set_view(None)
        self.overlay.set_view(None)
        self.strip.set_states(())
        self.checks.set_checks(())
        self.buttons.set_allowed(frozenset())

    def _show_state(self) -> None:
        """What can be done, and where things stand, in words."""
        controller = self.controller
        self.readouts.set_live(is_live=controller.is_connected)
        self._make_room()
        self.connection.set_connected(is_connected=controller.is_connected, says=self._words.connected_to())
        is_busy = controller.is_preparing or controller.signing.is_busy
        can_connect = controller.plan is not None and bool(controller.plan.sorties) and not is_busy
        self.connection.set_possible(is_possible=can_connect)
        set_enabled(
            self.sortie, controller.plan is not None and not controller.is_in_flight and not controller.is_preparing
        )
        if not controller.is_connected:
            self.buttons.set_allowed(frozenset())
            self.report.set_log(may_fetch=False, is_fetching=False)
            self.checks.set_checks(())
            self._show_band()
        self._phase.setText(self._words.where_it_stands())

    def _show_view(self, view: LiveView) -> None:
        self.readouts.set_view(view)
        self.overlay.set_view(view)
        self.overlay.camera.offer_video(view.video)
        self.settings.offer_video(view.video)
        self.strip.set_states(view.view_states)
        note = self.tr("In flight; the list comes back after the landing.") if view.state.is_armed else ""
        is_connected = self.controller.is_connected
        may = view.may if self.controller.is_for_shown_plan else view.may - frozenset(BEFORE_FLIGHT)
        if is_connected:
            self.checks.set_checks(view.checks, view.on_board, note)
        else:
            self.checks.set_checks(())
        self.buttons.set_allowed(may if is_connected else frozenset())
        may_fetch = is_connected and Request.LOG in view.may
        self.report.set_log(may_fetch=may_fetch, is_fetching=view.fetching is not None)
        text = self._words.where_it_stands()
        if self._phase.text() != text:
            self._phase.setText(text)
        set_enabled(self.sortie, not view.state.is_armed)
        self.pictures.take_view(view)

    def _note(self, time_s: float | None, severity: Severity, text: str) -> None:
        self.notes.add(time_s, severity, self._context.localized(text))

    def _show_photo(self, counted: PhotoCounted) -> None:
        active = self.controller.active
        self.readouts.set_counted(counted)
        if active is not None:
            self.strip.set_photos(active.photos)
        self.pictures.take_photo(counted)

    def _show_link(self, link: LinkState) -> None:
        if link is LinkState.LOST:
            selected, several = self.controller.selected, len(self.controller.aircraft) > 1
            self.band.show_lost(None, selected.number if several else None)
        self._show_state()

    def _show_end(self, ended: FlightEnded) -> None:
        self._show_report(ended)
        if ended.report is not None:
            self._lists.setCurrentWidget(self.report)
            self.lists.setChecked(True)

    def _show_report(self, ended: FlightEnded | None) -> None:
        self.report.set_ended(ended)
        findings = () if ended is None or ended.report is None else ended.report.findings
        self.findings.set_findings(findings)
        n_open = sum(finding.severity is not Severity.OK for finding in findings)
        text = self.tr("Findings ({0})").format(n_open) if findings else self.tr("Findings")
        self._lists.setTabText(self._lists.indexOf(self.findings), text)

    def _show_units(self, units: UnitSystem) -> None:
        shown = self.readouts, self.warnings, self.checks, self.strip, self.report, self.findings, self.simulation
        for widget in shown:
            widget.set_units(units)
        self.overlay.set_units(units)
