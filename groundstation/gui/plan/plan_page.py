"""The Plan tab's widgets put together: signals go to the controller or the context, changes come back."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from dataclasses import replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QLabel, QPushButton, QTabWidget, QToolButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.application.translate import translated
from groundstation.gui.charts.axes import Line, LinesPlot
from groundstation.gui.charts.quality_chart import QualityChart
from groundstation.gui.plan.plan_controller import EffectsController, PlanController
from groundstation.gui.plan.plan_form import PlanForm
from groundstation.gui.plan.plan_lists import PlanLists
from groundstation.gui.plan.sun_panel import SunController, SunPanel
from groundstation.gui.plan.viewpoint_page import PanelDetail, ViewpointPage
from groundstation.gui.shared_view import SharedView
from groundstation.gui.view3d.hemispheres import OPEN, UNDECIDED, UNREACHABLE
from groundstation.gui.view3d.paint import ColourScale, ValueKind
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.effects_panel import EffectsPanel
from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.inputs import ChoiceBox, Form, NumberBox, QuantityBox
from groundstation.gui.widgets.parameter_form import add_rows, rows_of
from groundstation.gui.widgets.scrolling import WrappingRow, labelled, scrolled
from groundstation.gui.widgets.value_boxes import ErrorLine
from groundstation.services.jobs.runner import Job, JobBounded, JobImproved
from groundstation.services.mission.camera import CameraReport, report_of_findings, settable
from groundstation.services.mission.readiness import additional_findings
from groundstation.services.plan.places import item_of_place
from groundstation.services.plan.plan_cache import ActivePlan, worth_of
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.project.steps import Act
from groundstation.services.units import UnitSystem, distance_unit, length_unit, minutes_text, per_cent, sampling_unit
from planning.base.effects import EffectSetting
from planning.base.findings import Severity, is_flyable
from planning.base.parameters import declared, with_values
from planning.base.progress import QualityPoint
from planning.insight.sections import PlanInsight, SectionState
from planning.optics import CameraControls
from planning.parameters import CameraSettings
from planning.plan import FlightWorth
from planning.request import PlanRequest

FIRST_FOCUS_M = 20.0
"""Offered for a focus at a distance: twice the usual safety distance holds pane and infinity best."""


LIST_PX = 180
"""Height of the findings: two of them, of five."""


class CameraPage(QWidget):
    """`value()`, `setValue()` and `valueChanged` of camera settings, and what was found about them.

    Signals
    -------
    valueChanged(CameraSettings)
        After an edit that makes sense; while it makes none, the reason stands below the form.
    placePicked(str)
        The user wants to see the place of a finding.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    placePicked = Signal(str)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = CameraSettings()
        self._controls: CameraControls | None = None
        self._report: CameraReport | None = None
        self._units = UnitSystem.METRIC
        self.rows = rows_of(declared(CameraSettings))
        distance = self.rows["focus_distance_m"].widget
        assert isinstance(distance, QuantityBox)
        distance.setValue(FIRST_FOCUS_M)
        self._form = Form()
        add_rows(self._form, self.rows)
        self._wrong, self._steps, self.findings = ErrorLine(), QLabel(), FindingsList()
        self._steps.setWordWrap(True)
        self._steps.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.findings.set_placeholder(self.tr("What comes of these settings stands here, once there is a plan."))
        self.findings.setMinimumHeight(LIST_PX)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(self._form)
        layout.addWidget(self._wrong)
        layout.addWidget(self._steps)
        layout.addWidget(self.findings, 1)
        for row in self.rows.values():
            row.valueChanged.connect(self._edited)
        self.findings.placePicked.connect(self.placePicked)
        self.set_controls(None)

    def value(self) -> CameraSettings:
        """The last settings that made sense."""
        return self._value

    def setValue(self, settings: CameraSettings) -> None:  # noqa: N802
        """Show settings."""
        if settings == self._value and not self._wrong.text():
            return
        self._value = settings
        self._fill()

    def set_controls(self, controls: CameraControls | None) -> None:
        """Offer what a camera can do; all of it where that is not known."""
        self._controls = controls
        self._offer()
        self._fill()

    def set_report(self, report: CameraReport | None) -> None:
        """Show what comes of the settings; None takes it away."""
        self._report = report
        self.findings.set_findings(() if report is None else report.findings)
        self._say_steps()

    def set_units(self, system: UnitSystem) -> None:
        """Show distances in other units."""
        self._units = system
        for row in self.rows.values():
            row.set_units(system)
        self.findings.set_units(system)
        self._say_steps()

    def problem(self) -> str:
        """Why what stands in the boxes makes no sense; empty where it does."""
        return self._wrong.text()

    def steps_text(self) -> str:
        """Who sets what."""
        return self._steps.text()

    def _say_steps(self) -> None:
        lines = []
        if self._report is not None:
            steps = self._report.steps
            for text, found in (
                (self.tr("By hand: {0}"), steps.by_hand),
                (self.tr("By the mission: {0}"), steps.by_mission),
            ):
                if found:
                    lines.append(text.format("; ".join(translated(step, self._units) for step in found)))
            lines += [translated(self._report.cost, self._units)] if self._report.cost else []
        self._steps.setText("\n".join(lines))
        self._steps.setVisible(bool(lines))

    def _offer(self) -> None:
        """What lists hold: the camera's own range, and always what is set."""
        controls, known = self._controls, declared(CameraSettings)
        for name in ("shutter_s", "aperture", "iso", "white_balance", "focus", "shutter"):
            parameter = known[name].parameter
            offered = [choice.value for choice in parameter.choices] or [None, *parameter.suggested]
            if controls is not None:
                offered = [each for each in offered if self._can(controls, name, each)]
            with QSignalBlocker(self.rows[name]):
                self.rows[name].offer(offered)
        kelvin = self.rows["white_balance_k"].widget
        if controls is not None and controls.white_balance_k is not None and isinstance(kelvin, NumberBox):
            kelvin.setRange(*controls.white_balance_k)

    @staticmethod
    def _can(controls: CameraControls, name: str, value: Any) -> bool:
        if value is None:
            return True
        match name:
            case "shutter_s":
                times = (controls.mechanical_shutter_s, controls.electronic_shutter_s)
                return any(each is not None and each[0] * 0.99 <= value <= each[1] * 1.01 for each in times)
            case "aperture":
                return bool(controls.aperture[0] <= value <= controls.aperture[1])
            case "iso":
                return bool(controls.iso[0] <= value <= controls.iso[1])
            case "white_balance":
                return value in controls.white_balances and (value != "kelvin" or controls.white_balance_k is not None)
            case "focus":
                return value in controls.focus
            case _:
                return bool(controls.shutter_kind(value) == value)

    def _fill(self) -> None:
        """Show the settings in the boxes."""
        for name, row in self.rows.items():
            value = getattr(self._value, name)
            with QSignalBlocker(row):
                row.setValue(FIRST_FOCUS_M if name == "focus_distance_m" and value is None else value)
        self._wrong.show_error("")
        self._show_rows()

    def _show_rows(self) -> None:
        """Only what counts for what is chosen is shown, and only what the camera leaves to choose."""
        focus, balance = self.rows["focus"].value(), self.rows["white_balance"].value()
        controls = self._controls
        has_both = controls is None or (
            controls.mechanical_shutter_s is not None and controls.electronic_shutter_s is not None
        )
        is_fixed = controls is not None and controls.aperture[0] == controls.aperture[1]
        shown = {
            "focus_distance_m": focus == "distance",
            "white_balance_k": balance == "kelvin",
            "compensation_ev": self.rows["exposure"].value() != "manual",
            "aperture": not is_fixed or self._value.aperture is not None,
            "shutter": has_both,
        }
        for name, is_shown in shown.items():
            self._form.setRowVisible(self.rows[name].widget, is_shown)

    def _edited(self) -> None:
        self._show_rows()
        values: dict[tuple[str, ...], Any] = {(name,): row.value() for name, row in self.rows.items()}
        if values["focus",] != "distance":
            values["focus_distance_m",] = None
        try:
            settings = with_values(self._value, values)
        except ValueError as error:
            self._wrong.show_error(translated(str(error), self._units))
            return
        self._wrong.show_error("")
        if settings != self._value:
            self._value = settings
            self.valueChanged.emit(settings)


# What the 3-D view paints on panels and routes; a value of two choices.


class PanelPaint(StrEnum):
    """What panels show."""

    FACADE = "facade"
    SHARE = "share"
    GSD = "gsd"
    HEMISPHERES = "hemispheres"


class RoutePaint(StrEnum):
    """What routes show."""

    SORTIE = "sortie"
    CLEARANCE = "clearance"


class PaintBar(QWidget):
    """Two boxes beside the buttons of the shared view.

    Signals
    -------
    valueChanged(PanelPaint, RoutePaint)
    """

    valueChanged = Signal(object, object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._panels, self._routes = ChoiceBox(), ChoiceBox()
        for paint, text in (
            (PanelPaint.FACADE, self.tr("facade")),
            (PanelPaint.SHARE, self.tr("coverage")),
            (PanelPaint.HEMISPHERES, self.tr("hemispheres")),
            (PanelPaint.GSD, self.tr("GSD")),
        ):
            self._panels.addItem(text, paint)
        for route, text in ((RoutePaint.SORTIE, self.tr("sortie")), (RoutePaint.CLEARANCE, self.tr("clearance"))):
            self._routes.addItem(text, route)
        layout = WrappingRow(self)
        for text, box in ((self.tr("Panels by"), self._panels), (self.tr("Route by"), self._routes)):
            layout.addWidget(labelled(text, box))
            box.currentIndexChanged.connect(lambda _index: self.valueChanged.emit(*self.value()))

    def value(self) -> tuple[PanelPaint, RoutePaint]:
        """What is chosen."""
        return PanelPaint(self._panels.currentData()), RoutePaint(self._routes.currentData())

    def setValue(self, panels: PanelPaint, routes: RoutePaint) -> None:  # noqa: N802
        """Choose."""
        self._panels.setCurrentIndex(self._panels.findData(panels))
        self._routes.setCurrentIndex(self._routes.findData(routes))


# What the current plan paints in the 3-D view: coverage or pixel sizes on panels, clearance on routes.

WIDE_CLEARANCE = 3.0
"""Routes this many safety distances away from everything all look alike: far enough."""


def paint_plan(
    scene: SceneView, active: ActivePlan | None, panels: PanelPaint, routes: RoutePaint, units: UnitSystem
) -> None:
    """Paint a plan on a 3-D view, as chosen; without an active plan everything is plain."""
    if active is None or panels is not PanelPaint.HEMISPHERES:
        scene.paint_hemispheres(None)
    if active is None or panels not in (PanelPaint.SHARE, PanelPaint.GSD):
        scene.set_panel_values(None)
    if active is None:
        scene.set_route_values(None)
        return
    insight = active.insight
    match panels:
        case PanelPaint.SHARE:
            title = QCoreApplication.translate("PlanPictures", "Covered of what is possible")
            scene.set_panel_values(ColourScale(title, "%", 0.0, 100.0), 100.0 * insight.share_per_panel)
        case PanelPaint.GSD:
            scale, values = _sampling(insight, units)
            scene.set_panel_values(scale, values)
        case PanelPaint.HEMISPHERES:
            scene.paint_hemispheres(insight.grid, painted_states(insight))
        case PanelPaint.FACADE:
            pass
    if routes is RoutePaint.SORTIE:
        scene.set_route_values(None)
    else:
        scene.set_route_values(*_clearance(active, units))


def _sampling(insight: PlanInsight, units: UnitSystem) -> tuple[ColourScale | None, NDArray[np.float64]]:
    unit = sampling_unit(units)
    values = insight.sampling.best_m * unit.factor
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return None, values
    low, high = float(known.min()), float(known.max())
    # A plan whose panels are all alike still has a scale.
    title = QCoreApplication.translate("PlanPictures", "Finest pixel")
    return ColourScale(title, unit.symbol, low, max(high, 1.01 * low + 1e-9), ValueKind.LOW_IS_GOOD), values


def _clearance(active: ActivePlan, units: UnitSystem) -> tuple[ColourScale, list[NDArray[np.float64]]]:
    unit = length_unit(units)
    least_m = active.plan.constraints.min_distance_m
    far_m = max(WIDE_CLEARANCE * least_m, least_m + 5.0)
    title = QCoreApplication.translate("PlanPictures", "Clearance")
    scale = ColourScale(title, unit.symbol, unit.shown(least_m), unit.shown(far_m))
    legs = (active.revision.leg_clearances_m(sortie) for sortie in active.plan.sorties)
    return scale, [unit.factor * vertex_clearances_m(clearances_m) for clearances_m in legs]


def painted_states(insight: PlanInsight) -> NDArray[np.int64]:
    """Number of views of each section, or why there is none, as the 3-D view takes it; shape (m, n_sections)."""
    states = insight.counts.astype(np.int64)
    states[insight.states == SectionState.MISSED] = OPEN
    states[insight.states == SectionState.UNREACHABLE] = UNREACHABLE
    states[insight.states == SectionState.UNDECIDED] = UNDECIDED
    return states


UNTOUCHED_MS = 1000
"""After an edit, before something is measured that takes longer than it: the next edit may come at once."""


def vertex_clearances_m(legs_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """The lesser clearance of the legs at each vertex, shape (k,) from (k - 1,): none looks safer than its legs."""
    padded = [float("inf"), *legs_m.tolist(), float("inf")]
    return np.array([min(pair) for pair in itertools.pairwise(padded)])


def _is_for_model(entry: PlanEntry) -> bool:
    """Whether the views of a plan were chosen for the quality of the model, and it is known what they are worth."""
    asked = entry.request is not None and entry.request.is_for_least_error
    return asked and entry.plan.present_worth is not None


class PlanPage(GradualTab):
    """The tab."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView, *, at_once: bool = True) -> None:
        self._context, self._shared_view = context, shared_view
        super().__init__(shared_view, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        context, shared_view = self._context, self._shared_view
        self._planning_id: int | None = None
        self._camera_of: tuple[object, ...] = ()
        self._worth: tuple[ActivePlan | None, FlightWorth | None] = (None, None)
        self._measuring: Job[object] | None = None
        self._untouched = QTimer(self, singleShot=True, interval=UNTOUCHED_MS)
        self.controller = PlanController(context, self)
        self.form = PlanForm()
        yield
        self.chart, self.effects = QualityChart(time.perf_counter), EffectsPanel()
        yield
        self.panel, self.paint, self.sun = PanelDetail(), PaintBar(), SunPanel()
        yield
        self.camera = CameraPage()
        self.sun_controller = SunController(context, self.sun, lambda: self.controller.is_planning)
        self.effects_controller = EffectsController(
            context, self.effects.isVisible, lambda: self.controller.is_planning, self
        )
        yield
        self.lists = PlanLists(context, self.controller)
        yield
        self.viewpoint = ViewpointPage(context, self.controller, shared_view)
        self.worth = LinesPlot(
            self.tr("Minutes in the air"),
            self.tr("Expected PSNR [dB]"),
            self.tr("What this plan is worth is not known."),
        )
        yield
        # Below the shared view there is width, which a bar over a day needs.
        self.lists.addTab(self.sun, self.tr("Sun"))
        self._result, self._verdict = QLabel(), QLabel()
        self._plan_button, self.camera_button = QPushButton(self.tr("Plan")), QToolButton()
        self._make_actions()
        self.left = self._make_left()
        yield
        self.right: QWidget | None = self._make_right()
        self.bottom: QWidget | None = self.lists
        yield
        shared_view.add_overlay_bar(self.paint)
        self.paint.hide()
        self._connect()
        self._show_document(context.document)
        self._show_units(context.units)
        self._show_active(self.controller.active)
        yield

    def _make_actions(self) -> None:
        self._plan_action = QAction(self.tr("Plan the flight"), self)
        self._plan_action.setShortcut(QKeySequence("Ctrl+P"))
        self._plan_action.triggered.connect(self._plan)
        self._enough_action = QAction(self.tr("Stop and keep"), self)
        self._enough_action.setShortcut(QKeySequence("Ctrl+Return"))
        self._enough_action.triggered.connect(self.controller.stop_here)
        compare = QAction(self.tr("Compare plans"), self)
        compare.setShortcut(QKeySequence("Ctrl+Shift+P"))
        compare.triggered.connect(lambda _checked=False: self.lists.compare(self.lists.plans.selected()))
        self._actions = (self._plan_action, self._enough_action, *self.viewpoint.make_actions(), compare)

    def _make_left(self) -> QWidget:
        left = QWidget()
        layout = QVBoxLayout(left)
        layout.setContentsMargins(0, 0, 0, 4)
        self._plan_button.setProperty("primary", True)
        self._result.setWordWrap(True)
        self._verdict.setWordWrap(True)
        for label in (self._result, self._verdict):
            label.setContentsMargins(8, 0, 8, 0)
        self.camera_button.setCheckable(True)
        self.camera_button.setText(self.tr("Camera settings"))
        self.camera_button.setToolTip(self.tr("How photos are taken: of this plan at once, and of the next"))
        self.camera_button.toggled.connect(self.camera.setVisible)
        self.camera.hide()
        beside = QVBoxLayout()
        beside.setContentsMargins(8, 0, 8, 8)
        beside.addWidget(self.camera_button)
        beside.addWidget(self.camera)
        layout.addWidget(self.form)
        layout.addLayout(beside)
        for widget in (self._plan_button, self._verdict, self._result):
            layout.addWidget(widget)
        layout.addStretch(1)
        return left

    def _make_right(self) -> QTabWidget:
        self._detail = QTabWidget()
        self._detail.addTab(self.chart, self.tr("Quality"))
        self._detail.addTab(self.worth, self.tr("Worth"))
        # Cards of many effects are higher than a small screen.
        self.effects_area = scrolled(self.effects)
        self._detail.addTab(self.effects_area, self.tr("Effects"))
        self._detail.addTab(self.panel, self.tr("Panel"))
        self._detail.addTab(scrolled(self.viewpoint), self.tr("View"))
        return self._detail

    def _connect(self) -> None:
        controller, context = self.controller, self._context
        self.form.valueChanged.connect(controller.set_request)
        self._untouched.timeout.connect(self._measure_worth)
        self._plan_button.clicked.connect(self._plan)
        self.chart.enough.clicked.connect(controller.stop_here)
        self.effects.settingChanged.connect(self._setting_changed)
        self.camera.valueChanged.connect(controller.set_camera)
        self.camera.placePicked.connect(self._show_place)
        self.panel.viewpointPicked.connect(lambda viewpoint_id: context.jump_to(Item(ItemKind.VIEWPOINT, viewpoint_id)))
        self.lists.sectionPicked.connect(self._show_section)
        self.paint.valueChanged.connect(lambda *_: self._paint())
        controller.planningStarted.connect(self._planning_started)
        controller.planningEnded.connect(self._planning_ended)
        controller.planned.connect(self._planned)
        controller.activePlanChanged.connect(self._show_active)
        self.effects.lookedAt.connect(self.effects_controller.look)
        self.effects_controller.effectsChanged.connect(self.effects.set_effects)
        controller.refused.connect(lambda text: context.say(Severity.ERROR, text))
        context.bridge.improved.connect(self._improved)
        context.bridge.bounded.connect(self._bounded)
        context.jobsChanged.connect(controller.job_ended)
        context.documentChanged.connect(self._document_changed)
        context.selectionChanged.connect(self._show_selection)
        context.unitsChanged.connect(self._show_units)

    # A tab

    def shown(self) -> None:
        """Take the shared view over."""
        self.paint.show()
        self._paint()

    def hidden(self) -> None:
        """Give the shared view back as it was."""
        self.paint.hide()
        self.viewpoint.stop_moving()

    def actions(self) -> tuple[QAction, ...]:
        """For the tab's menu."""
        return self._actions

    def take_step(self, act: Act) -> None:
        """Plan, or keep what is there."""
        match act:
            case Act.PLAN:
                self._plan()
            case Act.KEEP_PLAN:
                self.controller.stop_here()
            case _:
                pass

    # What changes

    def _document_changed(self, _before: Document, after: Document) -> None:
        self._show_document(after)

    def _show_document(self, document: Document) -> None:
        if self.form.value() != document.request:
            self.form.setValue(document.request)
        self._show_camera(document)
        has_panels = document.site is not None and document.site.site.n_panels > 0
        can_plan = has_panels and not self.controller.is_planning
        self._plan_button.setEnabled(can_plan)
        self._plan_action.setEnabled(can_plan)
        entry = document.current
        if document.site is None:
            self._say_verdict(self.tr("Open or import a site first, on the Site tab."), "muted")
            self._result.clear()
        elif entry is None and not has_panels:
            self._say_verdict(
                self.tr("No panels yet: find them in photos (Photos tab), or draw them on the building (Site tab)."),
                "muted",
            )
            self._result.clear()
        elif entry is None:
            words = self.tr("Planning ...") if self.controller.is_planning else self.tr("No plan yet.")
            self._say_verdict(words, "muted")
            self._result.clear()
        if not self.controller.is_planning:
            self._show_history(entry)

    def _show_camera(self, document: Document) -> None:
        plan, request = None if document.current is None else document.current.plan, document.request
        for_camera = (plan, request.profile_id) if plan is None else (plan.camera, plan.camera_controls, plan.profile)
        if for_camera != self._camera_of:
            self._camera_of = for_camera
            self.camera.set_controls(settable(plan, request.profile_id))
        self.camera.setValue(self.controller.camera_settings)

    def _show_place(self, place: str) -> None:
        item = item_of_place(place, self._context.document)
        if item is not None:
            self._context.jump_to(item)

    def _show_history(self, entry: PlanEntry | None) -> None:
        if entry is None:
            self.chart.show_history((), None)
            return
        points = tuple(QualityPoint(point.t_s, float(point.covered)) for point in entry.plan.history)
        bound = float(entry.plan.coverage.reachable_upper_bound)
        self.chart.show_history(points, bound, is_for_model=_is_for_model(entry))

    def _show_active(self, active: ActivePlan | None) -> None:
        self.panel.set_plan(None if active is None else active.insight, None if active is None else active.plan)
        self.camera.set_report(None if active is None else report_of_findings(active.plan, active.revision.findings))
        self._paint()
        self._show_worth(active, None if active is None else active.plan.present_worth)
        if active is None:
            if self._context.document.current is not None:
                why = self.controller.why_not_active
                if why:
                    self._say_verdict(self.tr("This plan cannot be judged. {0}").format(why), "error")
                else:
                    self._say_verdict(self.tr("The plan is being looked at ..."), "muted")
                self._result.clear()
            return
        self._show_result(active)

    def _show_result(self, active: ActivePlan) -> None:
        # As many as the Mission tab counts, where nothing is said there of the day.
        revision, plan = active.revision, active.plan
        findings = (*revision.findings, *additional_findings(revision.case))
        wrong = [finding for finding in findings if finding.severity is Severity.ERROR]
        warned = sum(finding.severity is Severity.WARNING for finding in findings)
        if is_flyable(findings):
            self._say_verdict(self.tr("Ready to fly; warnings: {0}").format(warned), "warning" if warned else "ok")
        else:
            self._say_verdict(
                self.tr("NOT ready to fly; errors: {0}. {1}").format(
                    len(wrong), self._context.localized(wrong[0].message)
                ),
                "error",
            )
        coverage, units = plan.coverage, self._context.units
        finest = active.insight.sampling.best_m
        lines = [self.tr("Views: {0}, sorties: {1}").format(len(plan.viewpoints), len(plan.sorties))]
        _, worth = self._worth
        if worth is not None:
            lines.append(self.tr("Unseen views of its model: {0}").format(self._context.localized(worth.text)))
        lines += [
            self.tr("{0} of {1} sections covered ({2:.1f} % of the {3} that any flight could cover)").format(
                coverage.covered,
                coverage.total,
                per_cent(coverage.covered, coverage.reachable_upper_bound),
                coverage.reachable_upper_bound,
            ),
            self.tr("Time in the air {0}, distance {1}").format(
                minutes_text(plan.duration_s),
                distance_unit(units).text(sum(sortie.length_m for sortie in plan.sorties)),
            ),
        ]
        if plan.landed_s is not None:
            n_flying = len({sortie.aircraft for sortie in plan.sorties})
            text = self.tr("Aircraft at once: {0}, all landed after {1}")
            lines.append(text.format(n_flying, minutes_text(plan.landed_s)))
        gaps = [float(m) for sortie in plan.sorties for m in active.revision.leg_clearances_m(sortie)]
        if gaps:
            lines.append(self.tr("smallest clearance {0}").format(length_unit(units).text(min(gaps))))
        known = finest[finest == finest]
        if len(known):
            lines.append(self.tr("GSD from {0}").format(sampling_unit(units).text(float(known.min()))))
        self._result.setText("\n".join(lines))

    def _show_worth(self, active: ActivePlan | None, worth: FlightWorth | None) -> None:
        """Show what a plan is worth; where it does not say, that is measured once it is left alone for a while."""
        self._tell_worth(active, worth)
        if self._measuring is not None:
            self._context.cancel(self._measuring, quietly=True)
            self._measuring = None
        self._untouched.stop()
        if active is not None and worth is None:
            self._untouched.start()

    def _tell_worth(self, active: ActivePlan | None, worth: FlightWorth | None) -> None:
        self._worth = active, worth
        self.worth.set_lines(self._worth_lines(worth))

    def _measure_worth(self) -> None:
        active, _ = self._worth
        if active is None or active is not self.controller.active:
            return
        if self.controller.is_planning:
            self._untouched.start()
            return

        def done(found: FlightWorth | None) -> None:
            self._measuring = None
            if active is self.controller.active:
                self._tell_worth(active, found)
                self._show_result(active)

        self._measuring = self._context.start(
            self.tr("Estimate the model's quality"), lambda _context: worth_of(active), done
        )

    def _worth_lines(self, worth: FlightWorth | None) -> tuple[Line, ...]:
        """Expected quality against minutes in the air, battery by battery, and how wrong it may be."""
        if worth is None:
            return ()
        minutes = np.array([battery.minutes for battery in worth.batteries])
        decibels = np.array([battery.psnr_db for battery in worth.batteries])
        lines = [Line(self.tr("this plan, battery by battery"), minutes, decibels)]
        if worth.another is not None:
            x, y = np.array([minutes[-1], worth.another.minutes]), np.array([decibels[-1], worth.another.psnr_db])
            lines.append(Line(self.tr("one battery more"), x, y))
            minutes, decibels = np.append(minutes, x[1]), np.append(decibels, y[1])
        off = self.tr("{0:.1f} dB better"), self.tr("{0:.1f} dB worse")
        for text, sign in zip(off, (1.0, -1.0), strict=True):
            lines.append(Line(text.format(worth.deviation_db), minutes, decibels + sign * worth.deviation_db))
        return tuple(lines)

    def _say_verdict(self, text: str, role: str) -> None:
        self._verdict.setText(text)
        self._verdict.setProperty("role", role)
        self._verdict.style().polish(self._verdict)

    def verdict(self) -> str:
        """What is said of the current plan."""
        return f"{self._verdict.text()}\n{self._result.text()}"

    def _paint(self) -> None:
        scene = self._shared_view.scene()
        if scene is None:
            self._shared_view.with_scene(lambda _scene: self._paint())
            return
        if not self.paint.isHidden():
            paint_plan(scene, self.controller.active, *self.paint.value(), self._context.units)

    def _show_selection(self, item: Item | None) -> None:
        if item is None:
            return
        if item.kind is ItemKind.PANEL:
            self.panel.set_panel(item.id)
        # While a plan runs, its progress and "good enough" stay in sight.
        if self.controller.is_planning:
            return
        if item.kind is ItemKind.PANEL:
            self._detail.setCurrentWidget(self.panel)
        elif item.kind is ItemKind.VIEWPOINT:
            self._detail.setCurrentIndex(self._detail.count() - 1)

    def _show_section(self, panel_id: str, section: int) -> None:
        self._context.jump_to(Item(ItemKind.PANEL, panel_id))
        self.panel.set_panel(panel_id)
        self.panel.pick_section(section)
        self._detail.setCurrentWidget(self.panel)

    def _setting_changed(self, effect: str, setting: EffectSetting) -> None:
        request: PlanRequest = self._context.document.request
        if effect == "occlusion":
            self.controller.set_request(replace(request, constraints=replace(request.constraints, occlusion=setting)))

    def _show_units(self, units: UnitSystem) -> None:
        for widget in (self.form, self.panel, self.lists, self.effects, self.sun, self.camera):
            widget.set_units(units)
        if self.controller.active is not None:
            self._show_result(self.controller.active)
        self._paint()

    # While a plan runs

    def _plan(self) -> None:
        """Plan what the form says, where that makes sense: never what it said before."""
        if self.form.problem():
            self._context.say(Severity.ERROR, self.form.problem())
        else:
            self.controller.plan()

    def _planning_started(self, job: Job[object], budget_s: float) -> None:
        self._planning_id = job.id
        self.chart.start(budget_s)
        self._detail.setCurrentWidget(self.chart)
        self._enough_action.setEnabled(True)
        self._show_document(self._context.document)

    def _planning_ended(self) -> None:
        self._planning_id = None
        self.chart.finish()
        self._enough_action.setEnabled(False)
        self._show_document(self._context.document)

    def _planned(self, entry: PlanEntry) -> None:
        if _is_for_model(entry):
            self._detail.setCurrentWidget(self.worth)

    def _improved(self, event: JobImproved) -> None:
        if event.job_id == self._planning_id:
            self.chart.add_point(event.point)

    def _bounded(self, event: JobBounded) -> None:
        if event.job_id == self._planning_id:
            self.chart.set_bound(event.bound)
