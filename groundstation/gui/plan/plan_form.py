"""The form for what is wanted of a plan: edits one `PlanRequest`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QLabel, QToolButton, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.plan.plan_controller import method_name
from groundstation.gui.widgets.inputs import ChoiceBox, Form, QuantityBox
from groundstation.gui.widgets.parameter_form import ParameterRow, add_rows, rows_of, tip_of, title_of
from groundstation.gui.widgets.questions import choose_file
from groundstation.gui.widgets.scrolling import scroll_to
from groundstation.services.units import UnitSystem, length_unit, sampling_unit
from planning.aircraft.catalogue import Profile, profile, profiles
from planning.base.errors import GroundStationError
from planning.base.parameters import declared, with_values
from planning.parameters import (
    DEFAULT_SHARE,
    DEFAULT_VIEWS,
    CameraSettings,
    Constraints,
    PlanParameters,
)
from planning.plan import usual_gsd_m
from planning.request import PlanRequest

# Chooses the aircraft and camera of a plan: one that the program knows, or one from a file of the user's own.


class AircraftBox(ChoiceBox):
    """`value()`, `setValue()` and `valueChanged` of a profile's identifier: its name in the catalogue, or its file.

    Signals
    -------
    valueChanged(str)
    refused(Message)
        Why a file cannot be used; the aircraft before stays.
    """

    valueChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    refused = Signal(object)

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


MODEL, VIEWS, BATTERIES, GOOD_ENOUGH, COVERAGE = range(5)

GOALS = {COVERAGE: "share", VIEWS: "n_views", BATTERIES: "n_batteries", GOOD_ENOUGH: "least_gain_db"}
"""What each goal is the value of; a model as good as it gets, with as many photos as are usual, is that of none."""

USUAL = {"share": DEFAULT_SHARE, "n_views": DEFAULT_VIEWS, "n_batteries": 1, "least_gain_db": 0.5}
"""Offered for each; half a decibel is what eyes begin to see."""

OWN = ("profile_id", "method", "constraints.wanted_gsd_mm")
"""Parameters whose boxes depend on more than themselves."""

ELSEWHERE = tuple(f"camera.{name}" for name in declared(CameraSettings))
"""Parameters with a form of their own."""

FIRST = (
    *("profile_id", "goal", "share", "n_views", "n_batteries", "least_gain_db"),
    *("constraints.min_distance_m", "method"),
    "time_budget_s",
)
FURTHER = (
    *("rules.wind_m_s", "rules.battery_reserve", "rules.settle_s", "gsd_limit", "gsd", "constraints.wanted_gsd_mm"),
    *("constraints.section_step_deg", "constraints.whole_panel", "greedy.solid_angle_weights", "precision", "seed"),
)
"""Rows in order; any other parameter that is declared with a row comes behind them."""

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
        self._first = Form()
        add_rows(self._first, self._placed("first"), FIRST)
        layout.addLayout(self._first)
        self._more = QToolButton()
        self._more.setCheckable(True)
        self._more.setText(self.tr("More settings"))
        layout.addWidget(self._more)
        self._further = QWidget()
        further = Form()
        add_rows(further, self._placed("more"), FURTHER)
        further.setContentsMargins(0, 0, 0, 0)
        self._further.setLayout(further)
        self._further.setVisible(False)
        self._more.toggled.connect(self._further.setVisible)
        layout.addWidget(self._further)
        layout.addWidget(self._wrong)
        self.setValue(self._value)
        self._connect()

    def _make_boxes(self) -> None:
        known = declared(PlanParameters)
        self.rows = rows_of(known, but=(*OWN, *ELSEWHERE))
        self._method = ParameterRow(known["method"], method_name)
        self.aircraft = AircraftBox()
        self.aircraft.setToolTip(tip_of(known["profile_id"].parameter))
        self._goal = ChoiceBox()
        goals = self.tr("the model (recommended)"), self.tr("number of views"), self.tr("batteries at hand")
        self._goal.addItems([*goals, self.tr("a model that is good enough"), self.tr("target coverage")])
        self._goal.setItemData(
            MODEL,
            self.tr("As many photos as would cover nearly all sections, placed where the model gains most."),
            Qt.ItemDataRole.ToolTipRole,
        )
        self._is_gsd_limited = QCheckBox(self.tr("Limit the GSD"))
        self._gsd = QuantityBox(sampling_unit, *COARSEST_GSD_M, 0.5)
        self._sharp = ParameterRow(known["constraints.wanted_gsd_mm"])
        self.box("constraints.wanted_gsd_mm").box().setSpecialValueText(self.tr("any"))

    def box(self, name: str) -> Any:
        """The box of a parameter, by its name as settings files have it."""
        own = {"method": self._method, "constraints.wanted_gsd_mm": self._sharp}
        return (own.get(name) or self.rows[name]).widget

    def _placed(self, where: str) -> dict[str, ParameterRow | tuple[str, QWidget]]:
        """Rows that stand at once, or further below."""
        rows: dict[str, ParameterRow | tuple[str, QWidget]] = {
            name: row for name, row in self.rows.items() if row.declared.parameter.row == where
        }
        if where == "first":
            title = title_of(declared(PlanParameters)["profile_id"].parameter)
            own = {"profile_id": (title, self.aircraft), "goal": (self.tr("Plan for"), self._goal)}
            return {**rows, **own, "method": self._method}
        rows["gsd_limit"], rows["gsd"] = ("", self._is_gsd_limited), (self.tr("Coarsest GSD"), self._gsd)
        return {**rows, "constraints.wanted_gsd_mm": self._sharp}

    def _connect(self) -> None:
        self._goal.currentIndexChanged.connect(self._edited)
        self._is_gsd_limited.toggled.connect(self._edited)
        self._gsd.valueChanged.connect(self._edited)
        self.aircraft.valueChanged.connect(self._edited)
        self.aircraft.refused.connect(lambda text: self._say_wrong(translated(text, self._units)))
        for row in (*self.rows.values(), self._method, self._sharp):
            row.valueChanged.connect(self._edited)

    def value(self) -> PlanRequest:
        """The last request that made sense."""
        return self._value

    def setValue(self, request: PlanRequest) -> None:  # noqa: N802
        """Show a request."""
        blockers = [QSignalBlocker(box) for box in self.findChildren(QWidget)]
        self._value = request
        wrong = self._show_aircraft(request)
        self._method.setValue(request.method)
        asked = [goal for goal, name in GOALS.items() if getattr(request, name) is not None]
        usual = COVERAGE if request.greedy.objective == "sections" else MODEL
        self._goal.setCurrentIndex(asked[0] if asked else usual)
        for name, row in self.rows.items():
            value = row.declared.value_in(request)
            row.setValue(USUAL.get(name) if value is None else value)
        self._is_gsd_limited.setChecked(request.constraints.max_distance_m is not None)
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
            return translated(str(error), self._units)
        self._gsd.setValue(profile(request.profile_id).camera.gsd_m(furthest_m))
        self._shown_gsd = request.profile_id, self._gsd.value()
        self._show_sharp(constraints)
        return ""

    def _show_sharp(self, constraints: Constraints) -> None:
        """Show the pixel wanted; where none is, the one that camera and safety distance make of that."""
        wanted_mm = constraints.wanted_gsd_mm
        camera, near_m = profile(self.aircraft.value()).camera, constraints.min_distance_m
        with QSignalBlocker(self._sharp.widget):
            self._sharp.setValue(1000.0 * usual_gsd_m(camera, near_m) if wanted_mm is None else wanted_mm)
        self._shown_sharp_mm = self._sharp.value()

    def problem(self) -> str:
        """Why what stands in the boxes makes no sense; empty where it does.

        Boxes have limits; only pixels that small can be asked for that they are not to be had so far away.
        """
        furthest_m, unit = self._furthest_m(), length_unit(self._units)
        nearest_m = self.rows["constraints.min_distance_m"].value()
        if furthest_m is None or furthest_m > nearest_m:
            return ""
        return self.tr(
            "Pixels of {0} need views within {1}, but the safety distance is {2}: allow coarser pixels, or come nearer."
        ).format(
            sampling_unit(self._units).text(self._gsd.value()),
            unit.text(furthest_m),
            unit.text(nearest_m),
        )

    def set_units(self, system: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        self._units = system
        self._gsd.set_units(system)
        for row in (*self.rows.values(), self._sharp):
            row.set_units(system)

    def _request(self) -> PlanRequest:
        """What the boxes say."""
        goal, before = self._goal.currentIndex(), self._value
        values = {row.declared.path: row.value() for row in self.rows.values()}
        has_goal = any(getattr(before, name) is not None for name in GOALS.values())
        # What was asked for without a goal is still so while the one that is offered stands.
        is_for_sections = goal == COVERAGE and values["greedy", "objective"] == "sections"
        is_offered = is_for_sections and not has_goal and values["share",] == DEFAULT_SHARE
        for number, name in GOALS.items():
            if number != goal or is_offered:
                values[name,] = None
        return with_values(
            before,
            {
                **values,
                ("profile_id",): self.aircraft.value(),
                ("method",): self._method.value(),
                ("constraints", "max_distance_m"): self._furthest_m(),
                ("constraints", "wanted_gsd_mm"): self._wanted_gsd_mm(),
            },
        )

    def _furthest_m(self) -> float | None:
        if not self._is_gsd_limited.isChecked():
            return None
        asked_m = self._value.constraints.max_distance_m
        if asked_m is not None and self._shown_gsd == (self.aircraft.value(), self._gsd.value()):
            return asked_m  # as it was: there and back it would be rounded
        return profile(self.aircraft.value()).camera.distance_for_gsd_m(self._gsd.value())

    def _wanted_gsd_mm(self) -> float | None:
        shown_mm: float = self._sharp.value()
        return self._value.constraints.wanted_gsd_mm if shown_mm == self._shown_sharp_mm else shown_mm

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
        is_new = bool(text) and not self._wrong.text()
        self._wrong.setText(text)
        self._wrong.setVisible(bool(text))
        if is_new:
            scroll_to(self._wrong)

    def _show_goal(self) -> None:
        """Only the goal chosen is shown, and only what its limit needs."""
        for goal, name in GOALS.items():
            self._first.setRowVisible(self.box(name), self._goal.currentIndex() == goal)
        self.box("greedy.objective").setEnabled(self._goal.currentIndex() != COVERAGE)  # a share is one of sections
        self._gsd.setEnabled(self._is_gsd_limited.isChecked())
