"""The form for what is wanted of a plan: edits one `PlanRequest`."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QFormLayout, QSpinBox, QWidget

from planning.catalogue import profiles
from planning.methods import METHODS
from planning.planner import PlanRequest

COVERAGE, VIEWS, BATTERIES = range(3)


class PlanForm(QWidget):
    """`value()`, `setValue()` and `valueChanged` of a plan request; what it does not show it keeps."""

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = PlanRequest()
        self._profile = QComboBox()
        for identifier, profile in sorted(profiles().items()):
            names = dict.fromkeys([profile.aircraft.name, profile.camera.name])
            self._profile.addItem(" / ".join(names), identifier)
        self._method = QComboBox()
        self._method.addItems(list(METHODS))
        self._goal = QComboBox()
        self._goal.addItems([self.tr("coverage"), self.tr("number of views"), self.tr("batteries")])
        self._coverage = _number(10.0, 100.0, 0.5, " %")
        self._views = _whole(1, 20_000)
        self._batteries = _whole(1, 20)
        self._distance = _number(1.0, 200.0, 0.5, " m")
        self._step = QComboBox()
        for step in (30, 15, 10, 5):
            self._step.addItem(f"{step}°", float(step))
        self._occlusion = QComboBox()
        self._occlusion.addItems(["auto", "on", "off"])
        self._wind = _number(0.0, 20.0, 0.5, " m/s")
        self._budget = _number(1.0, 3600.0, 5.0, " s")
        layout = QFormLayout(self)
        for label, widget in (
            (self.tr("Aircraft"), self._profile),
            (self.tr("Method"), self._method),
            (self.tr("Plan for"), self._goal),
            (self.tr("Coverage"), self._coverage),
            (self.tr("Views"), self._views),
            (self.tr("Batteries"), self._batteries),
            (self.tr("Safety distance"), self._distance),
            (self.tr("Section step"), self._step),
            (self.tr("Occlusion"), self._occlusion),
            (self.tr("Wind"), self._wind),
            (self.tr("Time budget"), self._budget),
        ):
            layout.addRow(label, widget)
        self.setValue(self._value)
        for box in (self._profile, self._method, self._goal, self._step, self._occlusion):
            box.currentIndexChanged.connect(self._edited)
        for spin in (self._coverage, self._views, self._batteries, self._distance, self._wind, self._budget):
            spin.valueChanged.connect(self._edited)

    def value(self) -> PlanRequest:
        """What the form shows."""
        goal = self._goal.currentIndex()
        return replace(
            self._value,
            profile_id=str(self._profile.currentData()),
            method=self._method.currentText(),
            share=self._coverage.value() / 100.0 if goal == COVERAGE else None,
            n_views=self._views.value() if goal == VIEWS else None,
            n_batteries=self._batteries.value() if goal == BATTERIES else None,
            constraints=replace(
                self._value.constraints,
                min_distance_m=self._distance.value(),
                section_step_deg=float(self._step.currentData()),
                occlusion=self._occlusion.currentText(),
            ),
            rules=replace(self._value.rules, wind_m_s=self._wind.value()),
            time_budget_s=self._budget.value(),
        )

    def setValue(self, request: PlanRequest) -> None:  # noqa: N802
        """Show a request."""
        self._value = request
        self._profile.setCurrentIndex(self._profile.findData(request.profile_id))
        self._method.setCurrentText(request.method)
        goal = VIEWS if request.n_views is not None else BATTERIES if request.n_batteries is not None else COVERAGE
        self._goal.setCurrentIndex(goal)
        self._coverage.setValue(100.0 * (0.99 if request.share is None else request.share))
        self._views.setValue(560 if request.n_views is None else request.n_views)
        self._batteries.setValue(1 if request.n_batteries is None else request.n_batteries)
        self._distance.setValue(request.constraints.min_distance_m)
        self._step.setCurrentIndex(max(0, self._step.findData(request.constraints.section_step_deg)))
        self._occlusion.setCurrentText(request.constraints.occlusion)
        self._wind.setValue(request.rules.wind_m_s)
        self._budget.setValue(request.time_budget_s)
        self._show_goal()

    def _edited(self) -> None:
        self._show_goal()
        self.valueChanged.emit(self.value())

    def _show_goal(self) -> None:
        """Only the goal chosen can be edited."""
        for goal, widget in ((COVERAGE, self._coverage), (VIEWS, self._views), (BATTERIES, self._batteries)):
            widget.setEnabled(self._goal.currentIndex() == goal)


def _number(low: float, high: float, step: float, suffix: str) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setRange(low, high)
    spin.setSingleStep(step)
    spin.setDecimals(1)
    spin.setSuffix(suffix)
    return spin


def _whole(low: int, high: int) -> QSpinBox:
    spin = QSpinBox()
    spin.setRange(low, high)
    return spin
