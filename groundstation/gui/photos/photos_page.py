"""The Photos tab's widgets put together: signals go to the controller, what it finds comes back here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSplitter,
    QTableWidget,
    QTableWidgetItem,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.charts.quality_chart import TrialChart
from groundstation.gui.map.place_map import PlaceMap
from groundstation.gui.photos.coverage_display import CoverageDisplay, PanelSightings
from groundstation.gui.photos.flight_entry import EnterFlightDialog
from groundstation.gui.photos.grid_view import Tool, ToolBox
from groundstation.gui.photos.photo_pane import PhotoPane, ThumbnailStrip
from groundstation.gui.photos.photo_store import PhotoStore
from groundstation.gui.photos.photos_controller import FlightOfPhotos, PhotosController
from groundstation.gui.shared_view import SharedView
from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.inputs import ChoiceBox, Form, LengthBox
from groundstation.gui.widgets.questions import Answer, Questions
from groundstation.gui.widgets.scrolling import scrolled, split
from groundstation.services.jobs.runner import JobContext
from groundstation.services.photos.coarse import begun_coarse, photo_names
from groundstation.services.photos.found_panels import PanelDraft
from groundstation.services.photos.grid_edits import (
    add_line,
    known_panels,
    move_line,
    panel_outlines,
    remove_line,
    set_panel,
)
from groundstation.services.photos.intake import card_of_place
from groundstation.services.photos.poses import ChosenPoses, RefinedOutcome, RefineRequest, refined_poses
from groundstation.services.photos.tradeoff import corner_sigma_m
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.project.steps import Act
from groundstation.services.units import UnitSystem, length_unit, sampling_unit
from planning.base.findings import Severity
from reconstruction.panels.solving.record import Axis

# The facades that were found, one line each, with how good they are.


class FacadeTable(QTableWidget):
    """Shows a draft.

    Signals
    -------
    chosen(str)
        Identifier of a facade.
    """

    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(0, 4, parent)
        self._units = UnitSystem.METRIC
        self._draft: PanelDraft | None = None
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.verticalHeader().hide()
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.horizontalHeader().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        self.setAccessibleName(self.tr("Facades found"))
        self.cellClicked.connect(self._choose)
        self._fill()

    def set_draft(self, draft: PanelDraft | None) -> None:
        """Show other facades."""
        self._draft = draft
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def _choose(self, row: int, _column: int) -> None:
        if self._draft is not None:
            self.chosen.emit(self._draft.found.facades[row].id)

    def _fill(self) -> None:
        unit = sampling_unit(self._units)
        self.setHorizontalHeaderLabels(
            [self.tr("Facade"), self.tr("Panels"), self.tr("Photos"), f"\u00b1 {unit.symbol}"]
        )
        facades = () if self._draft is None else self._draft.found.facades
        self.setRowCount(len(facades))
        for row, facade in enumerate(facades):
            is_old = self._draft is not None and facade.id in self._draft.unsolved
            sigma_m = corner_sigma_m(facade)
            texts = (
                facade.id,
                "\u2026"
                if is_old
                else f"{len(facade.panels)} ({len(facade.rows) - 1} \u00d7 {len(facade.columns) - 1})",
                str(len(facade.pose_changes)),
                "\u2026" if is_old else "\u2013" if sigma_m is None else f"{unit.shown(sigma_m):.3g}",
            )
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                item.setTextAlignment(Qt.AlignmentFlag.AlignCenter)
                self.setItem(row, column, item)


RENDERED_FOLDER = "rendered-photos"

WIDTHS_PX, USUAL_WIDTH_PX = (512, 1024, 2048), 1024
"""Of rendered photos, beside that of the camera."""

# Corrections made by hand over a photo, given to the controller as steps that can be undone.


class Corrections(QObject):
    """Turns what a pane's view says into edits of the active grid."""

    def __init__(self, controller: PhotosController, pane: PhotoPane, parent: QObject) -> None:
        super().__init__(parent)
        self._controller, self._pane = controller, pane
        view = pane.view
        view.lineMoved.connect(self._move_line)
        view.lineAdded.connect(self._add_line)
        view.lineRemoved.connect(self._remove_line)
        view.panelSwitched.connect(self._switch_panel)

    def _move_line(self, axis: Axis, index: int, position_px: float) -> None:
        place = self._pane.place()
        if place is not None:
            self._controller.edit(self.tr("Move line"), lambda draft: move_line(draft, place, axis, index, position_px))

    def _add_line(self, axis: Axis, position_px: float) -> None:
        place = self._pane.place()
        if place is not None:
            self._controller.edit(self.tr("Add line"), lambda draft: add_line(draft, place, axis, position_px))

    def _remove_line(self, axis: Axis, index: int) -> None:
        place = self._pane.place()
        if place is not None:
            self._controller.edit(self.tr("Delete line"), lambda draft: remove_line(draft, place, axis, index))

    def _switch_panel(self, row: int, column: int, is_panel: bool) -> None:
        place = self._pane.place()
        if place is not None:
            label = self.tr("Restore panel") if is_panel else self.tr("Delete panel")
            self._controller.edit(label, lambda draft: set_panel(draft, place, row, column, is_panel=is_panel))


# Refining the poses of the photos: the button, what it has brought, and the way back.


class PoseBox(QWidget):
    """Buttons for the photos of a controller, and a line about their poses."""

    def __init__(self, controller: PhotosController, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._controller, self._units = controller, UnitSystem.METRIC
        self.refine, self.back = QPushButton(self.tr("Refine poses")), QPushButton(self.tr("Own poses"))
        self.outcome = QLabel()
        self.refine.setToolTip(
            self.tr("Match the photos with each other and adjust all rays; computed once and kept beside the photos")
        )
        self.back.setToolTip(self.tr("Go back to the poses that the photos themselves have"))
        self.outcome.setWordWrap(True)
        self.outcome.setProperty("role", "muted")
        self.outcome.setToolTip(
            self.tr("By how much poses differ from the photos' own, and how well the photos fit each other; more below")
        )
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.refine, 0, 0)
        layout.addWidget(self.back, 0, 1)
        layout.addWidget(self.outcome, 1, 0, 1, 2)
        self.refine.clicked.connect(self._refine)
        self.back.clicked.connect(self._back)
        for signal in (controller.photosChanged, controller.stateChanged):
            signal.connect(self._show)
        self._show()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._show()

    def _refine(self) -> None:
        intake = self._controller.intake
        if intake is None:
            return

        def poses(context: JobContext) -> ChosenPoses:
            return refined_poses(intake.posed.photos, intake.folder, RefineRequest(), context)

        self._controller.change_poses(self.tr("Refine poses"), poses)

    def _back(self) -> None:
        intake = self._controller.intake
        if intake is not None:
            own = ChosenPoses(intake.posed.photos)
            self._controller.change_poses(self.tr("Own poses"), lambda _context: own)

    def _show(self) -> None:
        intake, is_free = self._controller.intake, not self._controller.is_busy
        refined = None if intake is None else intake.better.refined
        self.refine.setEnabled(is_free and intake is not None and bool(intake.photos) and refined is None)
        self.back.setEnabled(is_free and refined is not None)
        self.outcome.setText("" if refined is None else self._words(refined))
        self.outcome.setVisible(refined is not None)

    def _words(self, refined: RefinedOutcome) -> str:
        """What a refinement has brought; findings say what was refused, and why."""
        parts = [self.tr("Refined: {0} of {1} photos.").format(refined.n_refined, refined.n_photos)]
        if refined.n_refined:
            unit = replace(length_unit(self._units), decimals=3)
            moves = self.tr("Moved {0}, at most {1}; turned {2:.2f}\u00b0, at most {3:.2f}\u00b0; {4:.2f} px.")
            moved = (unit.text(m) for m in refined.moved_m)
            parts.append(moves.format(*moved, *refined.turned_deg, refined.reprojection_px))
        if refined.not_joined:
            parts.append(self.tr("{0} found no place.").format(len(refined.not_joined)))
        return " ".join(parts)


LEAST_APART_M, MOST_APART_M = 0.1, 5000.0
"""That two photos are taken from each other."""


class DistanceDialog(QDialog):
    """Asks how far apart two photos were taken."""

    def __init__(self, names: Sequence[str], units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("State a distance"))
        about = QLabel(
            self.tr("Two photos that were taken far apart, and their distance: it says how large the building is.")
        )
        about.setWordWrap(True)
        self.one, self.other = ChoiceBox(), ChoiceBox()
        self.length = LengthBox(LEAST_APART_M, MOST_APART_M, 0.5, units, 2)
        for box in (self.one, self.other):
            for name in names:
                box.addItem(name, name)
        self.other.setCurrentIndex(len(names) - 1)
        self.length.setValue(10.0)
        form = Form()
        form.addRow(about)
        form.addRow(self.tr("From photo"), self.one)
        form.addRow(self.tr("To photo"), self.other)
        form.addRow(self.tr("Distance"), self.length)
        self._buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self._buttons.accepted.connect(self.accept)
        self._buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(self._buttons)
        self.one.currentIndexChanged.connect(self._show_state)
        self.other.currentIndexChanged.connect(self._show_state)
        self._show_state()

    def value(self) -> tuple[str, str, float]:
        """Names of the photos, and metres."""
        return str(self.one.currentData()), str(self.other.currentData()), self.length.value()

    def _show_state(self) -> None:
        is_possible = self.one.currentIndex() != self.other.currentIndex()
        self._buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(is_possible)


SIDE_PX, DETAIL_PX = 250, 320
"""First widths beside the photo, at 1280 pixels."""


class PhotosPage(GradualTab):
    """The tab."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView, *, at_once: bool = True) -> None:
        self._context, self._shared_view = context, shared_view
        super().__init__(shared_view, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        context = self._context
        self.controller, self.questions = PhotosController.of(context), Questions()
        self.store = PhotoStore(self)
        self.strip, self.map, self.pane = ThumbnailStrip(self.store), PlaceMap(), PhotoPane(self.store)
        yield
        self.findings, self.table, self.tools = FindingsList(), FacadeTable(), ToolBox()
        self.trials, self.sightings, self.poses = TrialChart(), PanelSightings(), PoseBox(self.controller)
        self.read, self.choose = QPushButton(self.tr("Read photos")), QPushButton(self.tr("Choose folder ..."))
        self.coarse = QPushButton(self.tr("From photos alone ..."))
        self.distance = QPushButton(self.tr("State a distance ..."))
        self.find, self.use = QPushButton(self.tr("Find panels")), QPushButton(self.tr("Use these panels"))
        self.data_set = QPushButton(self.tr("Make data set ..."))
        self.next_battery = QPushButton(self.tr("Plan the next battery"))
        self.log_book = QPushButton(self.tr("Enter in log book ..."))
        self.render, self.width = QPushButton(self.tr("Render these photos ...")), ChoiceBox()
        self.folder, self.coverage, self.state = QLabel(), QLabel(), QLabel()
        self.coverage_shown = CoverageDisplay(context, self.controller, self.pane.scene, self.sightings, self)
        yield
        self.left = self._make_page()
        self.right: QWidget | None = None
        self.bottom: QWidget | None = None
        yield
        self._connect()
        self._units_changed(context.units)
        self._show_trials()
        self._show_photos()
        yield

    # A tab

    def shown(self) -> None:
        """Count what has changed meanwhile."""
        self.coverage_shown.set_in_front(True)
        self._show_state()

    def hidden(self) -> None:
        """Jobs go on."""
        self.coverage_shown.set_in_front(False)

    def actions(self) -> tuple[QAction, ...]:
        """There are none."""
        return ()

    def take_step(self, act: Act) -> None:
        """Make a site of photos, read them, find panels in them, or make a data set: each as its button does."""
        if self.controller.is_busy:
            self._context.say(Severity.NOTE, self.tr("The photos are being worked on; wait for its end, or cancel it."))
            return
        match act:
            case Act.FROM_PHOTOS:
                self._make_coarse()
            case Act.READ_PHOTOS:
                folder = self.controller.usual_folder()
                if folder is not None and any(folder.glob("*")):
                    self._read()
                else:
                    self._choose_folder()
            case Act.RENDER_PHOTOS:
                self._render()
            case Act.FIND_PANELS:
                self.controller.find()
            case Act.MAKE_DATA_SET:
                self._make_data_set()
            case _:
                pass

    # How it is put together

    def _make_page(self) -> QWidget:
        page = QWidget()
        layout = QVBoxLayout(page)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.setSpacing(6)
        top = QHBoxLayout()
        self.read.setProperty("primary", "true")
        self.read.setToolTip(self.tr("Poses, sharpness, exposure and the coverage that was achieved"))
        self.folder.setProperty("role", "muted")
        self.coverage.setWordWrap(True)
        self.coarse.setToolTip(
            self.tr("Make a coarse model and a site of the photos of a first flight: poses, walls, roofs and ground")
        )
        self.distance.setToolTip(
            self.tr("How far apart two photos were taken: the coarse model, whose size is a guess, gets its true one")
        )
        self.render.setToolTip(
            self.tr("Make the photos that the simulated flight took, with what its panes mirror; wide ones take hours")
        )
        for width_px in WIDTHS_PX:
            self.width.addItem(self.tr("{0} px wide").format(width_px), width_px)
        self.width.addItem(self.tr("as the camera"), None)
        self.width.setCurrentIndex(self.width.findData(USUAL_WIDTH_PX))
        self.width.setAccessibleName(self.tr("Width of rendered photos"))
        top.addWidget(self.coarse)
        top.addWidget(self.distance)
        top.addWidget(self.render)
        top.addWidget(self.width)
        top.addWidget(self.choose)
        top.addWidget(self.read)
        top.addWidget(self.find)
        top.addWidget(self.folder, 1)
        top.addWidget(self.coverage, 2)
        parts = self._make_side(), self.pane, self._make_detail()
        self.splitter = split(parts, (SIDE_PX, 1280 - SIDE_PX - DETAIL_PX, DETAIL_PX), 1)
        layout.addLayout(top)
        layout.addWidget(self.splitter, 1)
        layout.addWidget(self.strip)
        return page

    def _make_side(self) -> QWidget:
        side = QSplitter(Qt.Orientation.Vertical)
        self.findings.set_placeholder(self.tr("Photo issues are listed here."))
        below = QWidget()
        layout = QVBoxLayout(below)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.poses)
        layout.addWidget(self.findings, 1)
        side.addWidget(self.map)
        side.addWidget(below)
        side.setSizes([160, 300])
        return side

    def _make_detail(self) -> QWidget:
        detail = QWidget()
        layout = QVBoxLayout(detail)
        layout.setContentsMargins(0, 4, 0, 0)
        self.find.setToolTip(self.tr("Find the grid of every facade in the photos and put it into 3-D"))
        self.use.setToolTip(self.tr("Put these panels into the site in the place of its own; undo takes it back"))
        self.use.setProperty("primary", "true")
        self.state.setWordWrap(True)
        self.state.setProperty("role", "muted")
        self.table.setMinimumHeight(80)
        self.data_set.setToolTip(self.tr("Photos, poses and the site's panels together: what a model is trained on"))
        self.next_battery.setToolTip(
            self.tr("Looks at what the panes mirror in these photos, and plans the flight that adds most to them")
        )
        self.log_book.setToolTip(
            self.tr("For a flight of the active plan that was not watched here: the times are those of its photos")
        )
        shown = self.table, self.tools, self.state, self.use, self.data_set, self.next_battery, self.log_book
        for widget in shown:
            layout.addWidget(widget, int(widget is self.table))
        self.details = QTabWidget()
        self.details.addTab(scrolled(detail), self.tr("Panels"))
        self.details.addTab(self.sightings, self.tr("Coverage"))
        self.details.addTab(scrolled(self.trials), self.tr("Accuracy"))
        self.details.setTabToolTip(2, self.tr("What accuracy costs in time"))
        return self.details

    def _connect(self) -> None:
        controller, context, view = self.controller, self._context, self.pane.view
        self.coarse.clicked.connect(self._make_coarse)
        self.distance.clicked.connect(self._state_distance)
        self.choose.clicked.connect(self._choose_folder)
        self.read.clicked.connect(self._read)
        self.render.clicked.connect(self._render)
        context.milestonesChanged.connect(self._show_state)
        self.find.clicked.connect(controller.find)
        self.use.clicked.connect(self._use)
        self.data_set.clicked.connect(self._make_data_set)
        self.next_battery.clicked.connect(controller.plan_next_battery)
        self.log_book.clicked.connect(controller.state_flight)
        controller.flightStated.connect(self._enter_flight)
        self.strip.chosen.connect(self._show_photo)
        self.map.chosen.connect(self.strip.choose)
        self.findings.placePicked.connect(self._go_to_place)
        self.table.chosen.connect(self._go_to_facade)
        self.tools.valueChanged.connect(view.set_tool)
        self.tools.valueChanged.connect(lambda _tool: self._show_state())
        self.tools.nudged.connect(view.nudge)
        self.sightings.photoPicked.connect(self._go_to_photo)
        self.pane.coverageShown.connect(self._coverage_shown)
        controller.coverageChanged.connect(self._show_findings)
        controller.coverageChanged.connect(self._show_state)
        self.trials.measure.clicked.connect(self._measure)
        controller.trialsChanged.connect(self._show_trials)
        self.tools.undo.clicked.connect(controller.undo)
        self.tools.redo.clicked.connect(controller.redo)
        self.pane.refused.connect(lambda text: context.say(Severity.ERROR, context.localized(text)))
        self.pane.placeChanged.connect(self._show_state)
        self.corrections = Corrections(controller, self.pane, self)
        controller.photosChanged.connect(self._show_photos)
        controller.draftChanged.connect(self._show_draft)
        controller.stateChanged.connect(self._show_state)
        context.unitsChanged.connect(self._units_changed)
        context.documentChanged.connect(self._document_changed)
        self._shared_view.with_scene(lambda _scene: self.pane.scene.allow_opening())
        self._shared_view.with_scene(lambda scene: scene.photosWanted.connect(self._show_on_panels))
        self._shared_view.closing.connect(self._window_closing)

    # What the user does

    def _choose_folder(self) -> None:
        places = (self.controller.usual_folder(), self._context.session.folder)
        folder = self.questions.folder(self._shared_view.window(), self.tr("Folder of photos"), *places)
        if folder is not None:
            self.controller.read(folder)

    def _make_coarse(self) -> None:
        window, project = self._shared_view.window(), self._context.session.folder
        photos = self.questions.folder(window, self.tr("Photos of the first flight"), project)
        if photos is None:
            return
        proposed = photos.with_name(f"{photos.name}-coarse") if project is None else project / "coarse"
        begun = begun_coarse(photos, proposed)
        if begun is not None:
            text = self.tr("A coarse model of these photos was begun in {0}, and not finished. What was found is kept.")
            title, anew = self.tr("Make a coarse model"), self.tr("Begin anew ...")
            answer = self.questions.go_on(window, title, text.format(begun), anew)
            if answer is Answer.YES:
                self.controller.make_coarse(photos, begun)
            if answer is not Answer.NO:
                return
        out = self.questions.new_folder(window, self.tr("Folder for the coarse model"), proposed)
        if out is not None:
            self.controller.make_coarse(photos, out)

    def _state_distance(self) -> None:
        """Ask how far apart two photos were taken, and make the coarse model anew with what was found."""
        unsized = self.controller.unsized
        if unsized is None:
            return
        dialog = DistanceDialog(photo_names(unsized.photos), self._context.units, self._shared_view.window())
        is_stated = dialog.exec() == QDialog.DialogCode.Accepted
        dialog.deleteLater()
        if is_stated:
            self.controller.make_coarse(unsized.photos, unsized.out, (dialog.value(),))

    def _read(self) -> None:
        folder = self.controller.usual_folder()
        if folder is not None:
            self.controller.read(folder)

    def _render(self) -> None:
        """Ask where the photos of the simulated flight are to lie, and have them rendered."""
        flight, project = self._context.milestones.simulated, self._context.session.folder
        if flight is None or self.controller.is_busy:
            return
        proposed = (Path.home() if project is None else project) / RENDERED_FOLDER
        begun = self.controller.begun_rendering(flight, proposed)
        if begun is not None:
            text = self.tr("Of the photos of this flight, {0} of {1} were rendered into {2}, before it was cancelled.")
            answer = self.questions.go_on(
                self._shared_view.window(),
                self.tr("Render the photos"),
                text.format(begun.n_done, begun.n_photos, begun.folder),
                self.tr("Render anew ..."),
            )
            if answer is Answer.YES:
                self.controller.render(flight, begun.folder, begun.width_px)
            if answer is not Answer.NO:
                return
        title = self.tr("Folder for the rendered photos")
        folder = self.questions.new_folder(self._shared_view.window(), title, proposed)
        if folder is not None:
            self.controller.render(flight, folder, self.width.currentData())

    def _use(self) -> None:
        """Take the panels over, and show them in the shared view."""
        draft = self.controller.draft
        if self.controller.use() and draft is not None:
            self._shared_view.tabRequested.emit("site")
            first = next(facade.id for facade in draft.found.facades if facade.panels)
            self._context.jump_to(Item(ItemKind.FACADE, first))

    def _make_data_set(self) -> None:
        photos, project = self.controller.usual_folder(), self._context.session.folder
        if photos is None:
            return
        proposed = photos.with_name(f"{photos.name}-dataset") if project is None else project / "dataset"
        title = self.tr("Folder for the data set")
        folder = self.questions.new_folder(self._shared_view.window(), title, proposed)
        if folder is not None:
            self.controller.make_data_set(folder)

    def _enter_flight(self, flight: FlightOfPhotos) -> None:
        """Offer to enter a flight in the log book."""
        stated, findings = flight.sorties, flight.findings
        dialog = EnterFlightDialog(
            self._context, flight.plan, flight.site, stated, findings, self._shared_view.window()
        )
        dialog.open()

    def _measure(self) -> None:
        place = self.pane.place()
        if place is not None:
            self.controller.measure(place.facade)

    def _go_to_place(self, place: str) -> None:
        number = card_of_place(self.controller.cards, place)
        if number is not None:
            self.strip.choose(number)

    def _go_to_photo(self, path: str) -> None:
        self._go_to_place(path)
        self.pane.show_photo()

    def _show_on_panels(self) -> None:
        """Let the shared view draw the panels as the photos show them."""
        scene = self._shared_view.scene()
        if scene is not None:
            self.controller.take_panels(scene.set_panel_photos)

    def _coverage_shown(self, is_shown: bool) -> None:
        if is_shown:
            self.details.setCurrentWidget(self.sightings)
        self._show_state()

    def _go_to_facade(self, facade_id: str) -> None:
        """Show the first photo with a grid of a facade."""
        draft = self.controller.draft
        place = None if draft is None else next((one for one in draft.places() if one.facade == facade_id), None)
        if draft is None or place is None:
            return
        number = card_of_place(self.controller.cards, str(draft.photos[place.photo].path))
        if number is not None:
            self.strip.choose(number)
            self.pane.show_facade(facade_id)

    def _window_closing(self, event: QCloseEvent) -> None:
        if event.isAccepted():
            self.store.close()

    # What is shown

    def _show_photos(self) -> None:
        controller, model = self.controller, self._context.document.site
        self.strip.set_cards(controller.cards)
        has_photos = controller.intake is not None and bool(controller.intake.photos)
        self._shared_view.with_scene(lambda scene: scene.offer_photos(has_photos))
        self.map.set_photos(controller.cards)
        self.map.set_site(None if model is None else model.site)
        self._show_findings()
        self.pane.set_card(None)
        if controller.cards:
            self.strip.choose(0)
        self._show_draft()

    def _show_findings(self) -> None:
        self.findings.set_findings(() if self.controller.intake is None else self.controller.intake.findings)
        self._show_outlines()

    def _show_photo(self, number: int) -> None:
        self.map.choose(number)
        self.pane.set_card(self.controller.cards[number] if 0 <= number < len(self.controller.cards) else None)
        self._show_outlines()

    def _show_outlines(self) -> None:
        """Draw the panels that are known into a photo in which they were not looked for."""
        card, intake, model = self.pane.card(), self.controller.intake, self._context.document.site
        outlines: tuple[NDArray[np.float64], ...] = ()
        if card is not None and card.posed is not None and intake is not None and model is not None:
            known = known_panels(self.controller.draft, model.site, card.posed)
            outlines = panel_outlines(card.posed, known, None if intake.counted is None else intake.counted.sight)
        self.pane.set_outlines(outlines)

    def _show_draft(self) -> None:
        draft = self.controller.draft
        places = () if draft is None else draft.places()
        self.table.set_draft(draft)
        self.strip.set_searched(frozenset(draft.photos[place.photo].path for place in places) if draft else frozenset())
        self.pane.set_draft(draft)
        self._show_outlines()
        if draft is not None and self.pane.place() is None and places:
            self._go_to_facade(places[0].facade)
        self._show_state()

    def _show_trials(self) -> None:
        self.trials.set_trials(self.controller.trials)

    def _show_state(self) -> None:
        controller, has_site = self.controller, self._context.document.site is not None
        folder = controller.usual_folder()
        self.folder.setText("" if folder is None else self.tr("Folder: {0}").format(_short(folder)))
        self.folder.setToolTip("" if folder is None else str(folder))
        self.coarse.setEnabled(not controller.is_busy)
        self.distance.setVisible(controller.unsized is not None)
        self.distance.setEnabled(not controller.is_busy)
        for widget in (self.render, self.width):
            widget.setVisible(self._context.milestones.simulated is not None)
            widget.setEnabled(not controller.is_busy)
        self.choose.setEnabled(has_site and not controller.is_busy)
        self.read.setEnabled(has_site and folder is not None and not controller.is_busy)
        self.find.setEnabled(
            controller.intake is not None and bool(controller.intake.photos) and not controller.is_busy
        )
        self.tools.set_possible(
            can_edit=self.pane.place() is not None, undo_label=controller.undo_label, redo_label=controller.redo_label
        )
        self.trials.measure.setEnabled(self.pane.place() is not None and not controller.is_busy)
        draft = controller.draft
        self.data_set.setEnabled(self.find.isEnabled())
        document = self._context.document
        can_plan = document.current is not None and document.site is not None and document.site.site.n_panels > 0
        self.next_battery.setEnabled(self.find.isEnabled() and can_plan)
        self.log_book.setEnabled(controller.may_state_flight and not controller.is_busy)
        self.use.setEnabled(draft is not None and not draft.unsolved)
        self.state.setText(self._where_it_stands())
        self.coverage.setText(self.coverage_shown.words())

    def _where_it_stands(self) -> str:
        controller = self.controller
        if self._context.document.site is None:
            return self.tr(
                "Open or import a site first: photos are placed on it. “From photos alone” makes one. Photos with a "
                "COLMAP or nerfstudio model are trained without one, on the Reconstruct tab."
            )
        if controller.intake is None:
            return self.tr("Read the photos of the flight.")
        if controller.draft is None:
            return self.tr("Find the panels in these photos.")
        if controller.draft.unsolved:
            return self.tr("The corrected panels are being solved ...")
        if self.pane.place() is None:
            return self.tr("No grid was looked for in this photo; photos with one have the sign \u25a6.")
        if self.tools.value() is Tool.PANEL:
            return self.tr("Press a panel, or choose it with arrows; the space bar takes it out or puts it back.")
        return self.tr("Press a line, or choose it with Tab; arrows move it, Delete takes it out, Insert adds one.")

    def _units_changed(self, units: UnitSystem) -> None:
        self.findings.set_units(units)
        self.poses.set_units(units)
        self.table.set_units(units)
        self.trials.set_units(units)

    def _document_changed(self, before: Document, after: Document) -> None:
        if before.site is not after.site:
            self.map.set_site(None if after.site is None else after.site.site)
            self._show_outlines()
        self._show_state()


def _short(folder: Path) -> str:
    """The last two parts of a path."""
    return str(Path(*folder.parts[-2:]))
