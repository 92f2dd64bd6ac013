"""The form for what is wanted of a plan: edits one `PlanRequest`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QCheckBox, QLabel, QToolButton, QVBoxLayout, QWidget

from groundstation.gui.application.translate import own_words
from groundstation.gui.plan.method_names import method_name
from groundstation.gui.widgets.inputs import (
    ChoiceBox,
    Form,
    LengthBox,
    NumberBox,
    PercentBox,
    QuantityBox,
    SpeedBox,
    WholeBox,
)
from groundstation.gui.widgets.questions import choose_file
from groundstation.services.units import UnitSystem, length_unit, sampling_unit
from planning.aircraft.catalogue import Profile, profile, profiles
from planning.base.errors import GroundStationError
from planning.parameters import DEFAULT_SHARE, DEFAULT_VIEWS, LARGEST_SEED, Constraints
from planning.plan import usual_gsd_m
from planning.request import PlanRequest
from planning.viewpoints.methods import METHODS

# Chooses the aircraft and camera of a plan: one that the program knows, or one from a file of the user's own.


class AircraftBox(ChoiceBox):
    """`value()`, `setValue()` and `valueChanged` of a profile's identifier: its name in the catalogue, or its file.

    Signals
    -------
    valueChanged(str)
    refused(str)
        Why a file cannot be used; the aircraft before stays.
    """

    valueChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    refused = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        for identifier, found in sorted(profiles().items()):
            self.addItem(_text(found), identifier)
        self._value = str(self.itemData(0))
        self.addItem(self.tr("From a file ..."), None)
        self.currentIndexChanged.connect(self._chosen)

    def value(self) -> str:
        """Identifier of the profile."""
        return self._value

    def setValue(self, identifier: str) -> None:  # noqa: N802
        """Show a profile; raises `InputError` where it is a file that cannot be read."""
        index = self.findData(identifier)
        with QSignalBlocker(self):
            if index < 0:
                found = profile(identifier)
                index = self.count() - 1
                self.insertItem(index, _text(found), identifier)
            self.setCurrentIndex(index)
        self._value = identifier

    def use_file(self, path: Path | None) -> None:
        """Take an aircraft from a file; for None, or a file that is wrong, the one before stays."""
        before = self._value
        try:
            self.setValue(before if path is None else str(path))
        except GroundStationError as error:
            self.setValue(before)
            self.refused.emit(str(error))
            return
        if self._value != before:
            self.valueChanged.emit(self._value)

    def _chosen(self) -> None:
        if self.currentData() is None:
            self.use_file(choose_file(self, self.tr("Aircraft and camera"), self.tr("Aircraft (*.toml)")))
        elif self.currentData() != self._value:
            self._value = str(self.currentData())
            self.valueChanged.emit(self._value)


def _text(found: Profile) -> str:
    return " / ".join(dict.fromkeys([found.aircraft.name, found.camera.name]))


COVERAGE, VIEWS, BATTERIES = range(3)

SECTION_STEPS_DEG = (30, 15, 10, 5)

COARSEST_GSD_M = (0.0001, 0.5)
"""From microscopes to satellites: nobody asks for less or more."""

OFFERED_RANGE = 3.0
"""Where no pixel size is asked for, the one at so many safety distances is offered."""


class PlanForm(QWidget):
    """`value()`, `setValue()` and `valueChanged` of a plan request; what it does not show it keeps.

    Signals
    -------
    valueChanged(PlanRequest)
        After an edit that makes sense; while it makes none, the reason stands below the form.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = PlanRequest()
        self._shown_gsd: tuple[str, float] | None = None
        self._units = UnitSystem.METRIC
        self._make_boxes()
        self._wrong = QLabel()
        self._wrong.setProperty("role", "error")
        self._wrong.setWordWrap(True)
        self._wrong.setVisible(False)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        self._first = self._rows(self._first_rows())
        layout.addLayout(self._first)
        self._more = QToolButton()
        self._more.setCheckable(True)
        self._more.setText(self.tr("More settings"))
        layout.addWidget(self._more)
        self._further = QWidget()
        further = self._rows(self._further_rows())
        further.setContentsMargins(0, 0, 0, 0)
        self._further.setLayout(further)
        self._further.setVisible(False)
        self._more.toggled.connect(self._further.setVisible)
        layout.addWidget(self._further)
        layout.addWidget(self._wrong)
        self.setValue(self._value)
        self._connect()

    def _make_boxes(self) -> None:
        self.aircraft = AircraftBox()
        self._method = ChoiceBox()
        for method in METHODS:
            self._method.addItem(method_name(method), method)
        self._goal = ChoiceBox()
        self._goal.addItems([self.tr("coverage wanted"), self.tr("number of views"), self.tr("batteries at hand")])
        self._coverage = PercentBox(0.1, 1.0, 0.005)
        self._views = WholeBox(1, 20_000)
        self._batteries = WholeBox(1, 100)
        self._distance = LengthBox(0.0, 200.0)
        self._budget = NumberBox(1.0, 3600.0, 5.0, " s")
        self._wind = SpeedBox(0.0, 20.0)
        self._is_gsd_limited = QCheckBox(self.tr("Limit the pixel size"))
        self._gsd = QuantityBox(sampling_unit, *COARSEST_GSD_M, 0.5)
        self._sharp = QuantityBox(sampling_unit, 0.0, COARSEST_GSD_M[1], 0.5)
        self._sharp.box().setSpecialValueText(self.tr("any"))
        self._sharp.setToolTip(
            self.tr(
                "Each direction of view is wanted with pixels up to this size on the panel; those seen only more "
                "coarsely are counted and named"
            )
        )
        self._step = ChoiceBox()
        for step in SECTION_STEPS_DEG:
            self._step.addItem(_degrees(step), float(step))
        self._whole_panel = QCheckBox(self.tr("Count whole panels only"))
        self._whole_panel.setToolTip(self.tr("A view counts only when all four corners are in the picture"))
        self._solid_angle = QCheckBox(self.tr("Weight sections by solid angle"))
        self._reserve = PercentBox(0.0, 0.9, 0.05, 0)
        self._settle = NumberBox(0.0, 30.0, 0.5, " s")
        self._precision = ChoiceBox()
        self._precision.addItem(self.tr("single (fast)"), "f32")
        self._precision.addItem(self.tr("double (slower)"), "f64")
        self._seed = WholeBox(0, LARGEST_SEED)

    def _first_rows(self) -> tuple[tuple[str, QWidget], ...]:
        return (
            (self.tr("Aircraft"), self.aircraft),
            (self.tr("Plan for"), self._goal),
            (self.tr("Coverage"), self._coverage),
            (self.tr("Views"), self._views),
            (self.tr("Batteries"), self._batteries),
            (self.tr("Safety distance"), self._distance),
            (self.tr("Method"), self._method),
            (self.tr("Time to plan"), self._budget),
        )

    def _further_rows(self) -> tuple[tuple[str, QWidget], ...]:
        return (
            (self.tr("Wind"), self._wind),
            (self.tr("Battery reserve"), self._reserve),
            (self.tr("Hover before photo"), self._settle),
            ("", self._is_gsd_limited),
            (self.tr("Coarsest pixel"), self._gsd),
            (self.tr("Wanted pixel"), self._sharp),
            (self.tr("Section step"), self._step),
            ("", self._whole_panel),
            ("", self._solid_angle),
            (self.tr("Precision"), self._precision),
            (self.tr("Seed"), self._seed),
        )

    def _rows(self, rows: tuple[tuple[str, QWidget], ...]) -> Form:
        layout = Form()
        for label, widget in rows:
            if label:
                layout.addRow(label, widget)
            else:
                layout.addRow(widget)
        return layout

    def _connect(self) -> None:
        for box in (self._method, self._goal, self._step, self._precision):
            box.currentIndexChanged.connect(self._edited)
        self.aircraft.valueChanged.connect(self._edited)
        self.aircraft.refused.connect(lambda text: self._say_wrong(own_words(text, self._units)))
        for spin in (
            self._coverage,
            self._views,
            self._batteries,
            self._distance,
            self._budget,
            self._wind,
            self._gsd,
            self._sharp,
            self._reserve,
            self._settle,
            self._seed,
        ):
            spin.valueChanged.connect(self._edited)
        for check in (self._is_gsd_limited, self._whole_panel, self._solid_angle):
            check.toggled.connect(self._edited)

    def value(self) -> PlanRequest:
        """The last request that made sense."""
        return self._value

    def setValue(self, request: PlanRequest) -> None:  # noqa: N802
        """Show a request."""
        blockers = [QSignalBlocker(box) for box in self.findChildren(QWidget)]
        self._value = request
        wrong = self._show_aircraft(request)
        self._method.show_value(request.method, method_name(request.method))
        goal = VIEWS if request.n_views is not None else BATTERIES if request.n_batteries is not None else COVERAGE
        self._goal.setCurrentIndex(goal)
        self._coverage.setValue(DEFAULT_SHARE if request.share is None else request.share)
        self._views.setValue(DEFAULT_VIEWS if request.n_views is None else request.n_views)
        self._batteries.setValue(1 if request.n_batteries is None else request.n_batteries)
        constraints, rules = request.constraints, request.rules
        self._distance.setValue(constraints.min_distance_m)
        self._step.show_value(constraints.section_step_deg, _degrees(constraints.section_step_deg))
        self._whole_panel.setChecked(constraints.whole_panel)
        self._is_gsd_limited.setChecked(constraints.max_distance_m is not None)
        self._wind.setValue(rules.wind_m_s)
        self._reserve.setValue(rules.battery_reserve)
        self._settle.setValue(rules.settle_s)
        self._solid_angle.setChecked(request.greedy.solid_angle_weights)
        self._precision.show_value(request.precision)
        self._seed.setValue(request.seed)
        self._budget.setValue(request.time_budget_s)
        del blockers
        self._say_wrong(wrong)
        self._show_goal()

    def _show_aircraft(self, request: PlanRequest) -> str:
        """Show the aircraft and what depends on its camera; returns why not, where its file cannot be read."""
        constraints = request.constraints
        furthest_m = constraints.max_distance_m or OFFERED_RANGE * max(constraints.min_distance_m, 1.0)
        try:
            self.aircraft.setValue(request.profile_id)
        except GroundStationError as error:
            return own_words(str(error), self._units)
        self._gsd.setValue(profile(request.profile_id).camera.gsd_m(furthest_m))
        self._shown_gsd = request.profile_id, self._gsd.value()
        self._show_sharp(constraints)
        return ""

    def _show_sharp(self, constraints: Constraints) -> None:
        """Show the pixel wanted; where none is, the one that camera and safety distance make of that."""
        wanted_mm = constraints.wanted_gsd_mm
        camera, near_m = profile(self.aircraft.value()).camera, constraints.min_distance_m
        with QSignalBlocker(self._sharp):
            self._sharp.setValue(usual_gsd_m(camera, near_m) if wanted_mm is None else wanted_mm / 1000.0)
        self._shown_sharp_m = self._sharp.value()

    def problem(self) -> str:
        """Why what stands in the boxes makes no sense; empty where it does.

        Boxes have limits; only pixels that small can be asked for that they are not to be had so far away.
        """
        furthest_m, unit = self._furthest_m(), length_unit(self._units)
        if furthest_m is None or furthest_m > self._distance.value():
            return ""
        return self.tr(
            "Pixels of {0} need views within {1}, but the safety distance is {2}: allow coarser pixels, or come nearer."
        ).format(
            sampling_unit(self._units).text(self._gsd.value()),
            unit.text(furthest_m),
            unit.text(self._distance.value()),
        )

    def set_units(self, system: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        self._units = system
        for box in (self._distance, self._wind, self._gsd, self._sharp):
            box.set_units(system)

    def _request(self) -> PlanRequest:
        """What the boxes say."""
        goal, before = self._goal.currentIndex(), self._value
        share = self._coverage.value()
        has_goal = any(value is not None for value in (before.share, before.n_views, before.n_batteries))
        profile_id = self.aircraft.value()
        return replace(
            before,
            profile_id=profile_id,
            method=str(self._method.currentData()),
            # What was asked for without a goal is still so while the one that is offered stands.
            share=share if goal == COVERAGE and (has_goal or share != DEFAULT_SHARE) else None,
            n_views=self._views.value() if goal == VIEWS else None,
            n_batteries=self._batteries.value() if goal == BATTERIES else None,
            constraints=replace(
                before.constraints,
                min_distance_m=self._distance.value(),
                section_step_deg=float(self._step.currentData()),
                whole_panel=self._whole_panel.isChecked(),
                max_distance_m=self._furthest_m(),
                wanted_gsd_mm=self._wanted_gsd_mm(),
            ),
            rules=replace(
                before.rules,
                wind_m_s=self._wind.value(),
                battery_reserve=self._reserve.value(),
                settle_s=self._settle.value(),
            ),
            greedy=replace(before.greedy, solid_angle_weights=self._solid_angle.isChecked()),
            precision=self._precision.currentData(),
            seed=self._seed.value(),
            time_budget_s=self._budget.value(),
        )

    def _furthest_m(self) -> float | None:
        if not self._is_gsd_limited.isChecked():
            return None
        asked_m = self._value.constraints.max_distance_m
        if asked_m is not None and self._shown_gsd == (self.aircraft.value(), self._gsd.value()):
            return asked_m  # as it was: there and back it would be rounded
        return profile(self.aircraft.value()).camera.distance_for_gsd_m(self._gsd.value())

    def _wanted_gsd_mm(self) -> float | None:
        if self._sharp.value() == self._shown_sharp_m:
            return self._value.constraints.wanted_gsd_mm
        return round(1000.0 * self._sharp.value(), 6)

    def _edited(self) -> None:
        self._show_goal()
        self._say_wrong(self.problem())
        if self.problem():
            return
        request = self._request()
        if request != self._value:
            self._value = request
            self._show_sharp(request.constraints)
            self.valueChanged.emit(request)

    def _say_wrong(self, text: str) -> None:
        self._wrong.setText(text)
        self._wrong.setVisible(bool(text))

    def _show_goal(self) -> None:
        """Only the goal chosen is shown, and only what its limit needs."""
        for goal, widget in ((COVERAGE, self._coverage), (VIEWS, self._views), (BATTERIES, self._batteries)):
            self._first.setRowVisible(widget, self._goal.currentIndex() == goal)
        self._gsd.setEnabled(self._is_gsd_limited.isChecked())


def _degrees(step_deg: float) -> str:
    return f"{step_deg:.4g}°"
