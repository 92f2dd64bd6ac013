"""The Fly tab's widgets put together: signals go to the desk, what the flight tells comes back here."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QCloseEvent
from PySide6.QtWidgets import QComboBox, QLabel, QTabWidget, QVBoxLayout, QWidget

from groundstation.gui.fly.connection_box import ConnectionBox
from groundstation.gui.fly.flight_buttons import FlightButtons
from groundstation.gui.fly.fly_desk import BEFORE_FLIGHT, FlyDesk
from groundstation.gui.fly.link_band import LinkBand
from groundstation.gui.fly.live_pictures import LivePictures
from groundstation.gui.fly.photo_strip import PhotoStrip
from groundstation.gui.fly.preflight_list import PreflightList
from groundstation.gui.fly.questions import FlightQuestions
from groundstation.gui.fly.readouts_view import ReadoutsView
from groundstation.gui.fly.report_view import ReportView
from groundstation.gui.fly.simulation_page import SimulationPage
from groundstation.gui.fly.warnings_view import FlightNotes, WarningsView
from groundstation.gui.main_window import MainWindow
from groundstation.gui.scrolling import scrolled
from groundstation.gui.stage import Stage
from groundstation.gui.workspace import Workspace
from groundstation.services.document import Document, Item, ItemKind
from groundstation.services.live_events import FlightEnded, LinkState, LiveView, PhotoCounted, Request
from groundstation.services.live_sortie import take_off_of
from groundstation.services.units import UnitSystem, minutes_text
from groundstation.vehicle.run_records import Phase


class FlyPage(QObject):
    """The tab."""

    def __init__(self, workspace: Workspace, stage: Stage) -> None:
        super().__init__(stage)
        self._workspace, self._stage = workspace, stage
        self.desk, self.questions = FlyDesk.of(workspace), FlightQuestions()
        self.connection, self.sortie = ConnectionBox(), QComboBox()
        self.buttons, self.checks = FlightButtons(), PreflightList()
        self.readouts, self.warnings = ReadoutsView(), WarningsView()
        self.simulation, self.strip = SimulationPage(), PhotoStrip()
        self.notes, self.report, self.band = FlightNotes(), ReportView(), LinkBand()
        self.pictures = LivePictures(stage, self)
        self._phase = QLabel()
        self._phase.setWordWrap(True)
        self._phase.setProperty("role", "heading")
        self.left = self._make_left()
        self.right: QWidget | None = self._make_right()
        self.bottom: QWidget | None = self._make_bottom()
        self.band.put_into(stage.window())
        self._connect()
        self.connection.setValue(self.desk.choice)
        self.simulation.setValue(self.desk.conditions, self.desk.wishes)
        self._show_units(workspace.units)
        self._show_document(workspace.document)
        self._show_all()

    # A tab

    def shown(self) -> None:
        """Draw the flight into the shared view."""
        self.pictures.show(self.desk.in_hand)
        self.desk.look_at_effects()

    def hidden(self) -> None:
        """Give the shared view back; the flight goes on."""
        self.pictures.hide()

    def actions(self) -> tuple[QAction, ...]:
        """For the tab's menu."""
        return tuple(self.buttons.flight_actions())

    def n_photos(self) -> int:
        """Views of the sortie that have a photo."""
        return 0 if self.desk.in_hand is None else len(self.desk.in_hand.photos)

    # How it is put together

    def _make_left(self) -> QWidget:
        left = QWidget()
        layout = QVBoxLayout(left)
        layout.setContentsMargins(6, 6, 6, 6)
        self.sortie.setAccessibleName(self.tr("Sortie to be flown"))
        for widget in (self.sortie, self.connection, self._phase, self.buttons, self.checks):
            layout.addWidget(widget)
        layout.addStretch(1)
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
        return detail

    def _make_bottom(self) -> QWidget:
        flight = QWidget()
        layout = QVBoxLayout(flight)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addWidget(self.strip)
        layout.addWidget(self.notes, 1)
        self._lists = QTabWidget()
        self._lists.addTab(flight, self.tr("Photos"))
        self._lists.addTab(self.report, self.tr("Report"))
        return self._lists

    def _connect(self) -> None:
        desk, workspace = self.desk, self._workspace
        self.connection.valueChanged.connect(desk.set_choice)
        self.connection.connectRequested.connect(desk.connect_vehicle)
        self.connection.disconnectRequested.connect(self._disconnect)
        self.sortie.activated.connect(lambda index: desk.set_sortie(index + 1))
        self.buttons.requested.connect(self._request)
        self.simulation.valueChanged.connect(lambda: desk.set_simulation(*self.simulation.value()))
        self.strip.picked.connect(self._go_to)
        self.report.picked.connect(self._go_to)
        self.report.topUpRequested.connect(desk.after.top_up)
        self.report.resumeRequested.connect(desk.after.resume_sortie)
        desk.stateChanged.connect(self._show_all)
        desk.viewChanged.connect(self._show_view)
        desk.photoCounted.connect(self._show_photo)
        desk.linkChanged.connect(self._show_link)
        desk.flightEnded.connect(self._show_end)
        desk.effectsChanged.connect(self.simulation.set_effects)
        desk.noted.connect(self.notes.add)
        workspace.documentChanged.connect(lambda _before, after: self._show_document(after))
        workspace.unitsChanged.connect(self._show_units)
        workspace.jobsChanged.connect(self._show_state)
        window = self._stage.window()
        if isinstance(window, MainWindow):
            window.closing.connect(self._window_closing)

    # What the user does

    def _request(self, request: Request) -> None:
        if request is not Request.START or self._may_start():
            self.desk.request(request)

    def _may_start(self) -> bool:
        in_hand = self.desk.in_hand
        return in_hand is not None and self.questions.start(
            self._stage.window(), take_off_of(in_hand.sortie), self._workspace.units
        )

    def _disconnect(self) -> None:
        if not self.desk.is_in_flight or self.questions.leave_in_flight(self._stage.window()):
            self.desk.disconnect_vehicle()

    def _window_closing(self, event: QCloseEvent) -> None:
        if not event.isAccepted() or not self.desk.is_connected:
            return
        if self.desk.is_in_flight and not self.questions.leave_in_flight(self._stage.window()):
            event.ignore()
            return
        self.desk.close()

    def _go_to(self, view_id: str) -> None:
        self._workspace.jump_to(Item(ItemKind.VIEWPOINT, view_id))

    # What changes

    def _show_document(self, _document: Document) -> None:
        """Offer the sorties of the current plan."""
        plan = self.desk.plan
        texts = [
            self.tr("Sortie {0}: photos: {1}, {2}").format(
                n, len(sortie.viewpoint_ids), minutes_text(sortie.duration_s)
            )
            for n, sortie in enumerate(() if plan is None else plan.sorties, 1)
        ]
        if [self.sortie.itemText(i) for i in range(self.sortie.count())] != texts:
            self.sortie.clear()
            self.sortie.addItems(texts)
            if self.desk.number > len(texts):
                self.desk.number = 1
        self.sortie.setCurrentIndex(min(self.desk.number, len(texts)) - 1)
        in_hand = self.desk.in_hand
        if in_hand is not None and in_hand.view is not None:
            self._show_view(in_hand.view)
        self._show_state()

    def _show_all(self) -> None:
        """Show the flight in hand from its beginning: a new one, or this page is new."""
        in_hand = self.desk.in_hand
        self.notes.clear()
        for note in () if in_hand is None else in_hand.notes:
            self.notes.add(*note)
        self.strip.set_photos({} if in_hand is None else in_hand.photos)
        self.readouts.set_counted(None if in_hand is None else in_hand.counted)
        self.report.set_ended(None if in_hand is None else in_hand.ended)
        self.pictures.set_flight(in_hand)
        if in_hand is not None and in_hand.view is not None:
            self._show_view(in_hand.view)
        else:
            self._clear_view()
        self._show_state()

    def _clear_view(self) -> None:
        self.readouts.set_view(None)
        self.warnings.set_warnings(())
        self.strip.set_states(())
        self.checks.set_checks(())
        self.buttons.set_allowed(frozenset())
        self.band.hide()

    def _show_state(self) -> None:
        """What can be done, and where things stand, in words."""
        desk = self.desk
        self.connection.set_connected(is_connected=desk.is_connected, says=self._connected_to())
        can_connect = desk.plan is not None and bool(desk.plan.sorties) and not desk.is_preparing
        self.connection.set_possible(is_possible=can_connect)
        self.sortie.setEnabled(desk.plan is not None and not desk.is_in_flight and not desk.is_preparing)
        if not desk.is_connected:
            self.buttons.set_allowed(frozenset())
            self.checks.set_checks(())
            self.band.hide()
        self._phase.setText(self._where_it_stands())

    def _connected_to(self) -> str:
        desk = self.desk
        if not desk.is_connected:
            return ""
        if desk.choice.url:
            return desk.choice.url
        return self.tr("Simulation, {0:g} times as fast").format(desk.choice.speed_up)

    def _where_it_stands(self) -> str:
        desk, in_hand = self.desk, self.desk.in_hand
        if self._workspace.document.site is None:
            return self.tr("Open or import a site first, on the Site tab.")
        if desk.plan is None or not desk.plan.sorties:
            return self.tr("Plan a flight first, on the Plan tab.")
        if desk.is_preparing:
            return self.tr("The flight is being prepared ...")
        if not desk.is_connected or in_hand is None:
            return self.tr("Not connected.")
        if in_hand.link is LinkState.OPENING or in_hand.view is None:
            return self.tr("The link is being opened ...")
        if in_hand.link is LinkState.SILENT:
            return self.tr("The link is open; no vehicle was heard yet.")
        return self._phase_text(in_hand.view)

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
        if not self.desk.is_for_shown_plan and not view.state.is_armed:
            return self.tr("This connection is for another plan. Disconnect, and connect for the plan that is shown.")
        if view.phase is Phase.READY and Request.START not in view.may:
            return texts[Phase.CHECKING]
        what, done, total = view.doing
        if view.phase is Phase.UPLOADING and total > 0.0:
            return self.tr("{0} {1} ({2:.0f} of {3:.0f})").format(text, self._workspace.words(what), done, total)
        if view.phase is Phase.FLYING and view.state.mode is not None:
            return self.tr("{0} Mode: {1}").format(text, view.state.mode.value)
        return text

    def _show_view(self, view: LiveView) -> None:
        self.readouts.set_view(view)
        self.warnings.set_warnings(view.warnings)
        self.strip.set_states(view.view_states)
        note = self.tr("In flight; the list comes back after the landing.") if view.state.is_armed else ""
        is_connected = self.desk.is_connected
        may = view.may if self.desk.is_for_shown_plan else view.may - frozenset(BEFORE_FLIGHT)
        self.checks.set_checks(view.checks if is_connected else (), note if is_connected else "")
        self.buttons.set_allowed(may if is_connected else frozenset())
        text = self._where_it_stands()
        if self._phase.text() != text:
            self._phase.setText(text)
        self.sortie.setEnabled(not view.state.is_armed)
        if view.link is LinkState.LOST and self.desk.is_connected:
            self.band.show_lost(view.silent_s)
        elif not self.band.isHidden():
            self.band.hide()
        self.pictures.take_view(view)

    def _show_photo(self, counted: PhotoCounted) -> None:
        in_hand = self.desk.in_hand
        self.readouts.set_counted(counted)
        if in_hand is not None:
            self.strip.set_photos(in_hand.photos)
        self.pictures.take_photo(counted)

    def _show_link(self, link: LinkState) -> None:
        if link is LinkState.LOST:
            self.band.show_lost(None)
        self._show_state()

    def _show_end(self, ended: FlightEnded) -> None:
        self.report.set_ended(ended)
        if ended.report is not None:
            self._lists.setCurrentWidget(self.report)

    def _show_units(self, units: UnitSystem) -> None:
        for widget in (self.readouts, self.warnings, self.checks, self.strip, self.report, self.simulation):
            widget.set_units(units)
