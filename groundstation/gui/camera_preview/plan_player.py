"""A bar below the 3-D view that flies the plan: a time slider over all sorties, and play."""

from __future__ import annotations

import time

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSlider, QWidget

from groundstation.gui.camera_preview.flight import CameraFlight, camera_flight
from groundstation.gui.view3d.scene_picture import FlownPose
from groundstation.gui.widgets.inputs import ChoiceBox
from planning.base.errors import InfeasibleError
from planning.plan import Plan

TICK_MS = 40

STEPS_PER_S = 10
"""Of the slider."""

SPEEDS = (1, 5, 20, 60)
DEFAULT_SPEED = 20


class PlanPlayer(QWidget):
    """Edits the time in a plan's flight.

    Signals
    -------
    poseChanged(FlownPose or None)
        Where the aircraft is at the time; None where nothing is flown.
    """

    poseChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plan: Plan | None = None
        self._flights: tuple[CameraFlight | None, ...] | None = None
        self._ends_s = np.zeros(0)
        self._t_s, self._last_s = 0.0, 0.0
        self._timer = QTimer(self, interval=TICK_MS)
        self._timer.timeout.connect(self._tick)
        self.play = QPushButton(self.tr("Fly"))
        self.play.setCheckable(True)
        self.play.setToolTip(self.tr("Let the aircraft fly the plan in the view"))
        self.play.toggled.connect(self._play)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setAccessibleName(self.tr("Time in the flight"))
        self.slider.setToolTip(self.tr("Time in the flight, over all sorties"))
        self.slider.valueChanged.connect(self._slid)
        self._label = QLabel()
        self._label.setTextFormat(Qt.TextFormat.PlainText)
        self.speed = ChoiceBox()
        for speed in SPEEDS:
            self.speed.addItem(f"{speed} x", speed)
        self.speed.setToolTip(self.tr("How much faster than the flight"))
        self.speed.setCurrentIndex(self.speed.findData(DEFAULT_SPEED))
        self.stop = QPushButton("×")
        self.stop.setToolTip(self.tr("Show the plan without the aircraft"))
        self.stop.clicked.connect(self.rewind)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 0, 4, 0)
        for widget, stretch in ((self.play, 0), (self.slider, 1), (self._label, 0), (self.speed, 0), (self.stop, 0)):
            layout.addWidget(widget, stretch)

    def set_plan(self, plan: Plan | None) -> None:
        """Fly another plan, from its start. How it is flown is computed when it is first wanted: plans change often."""
        self._plan, self._flights = plan, None
        lengths = [] if plan is None else [max(sortie.duration_s, 0.0) for sortie in plan.sorties]
        self._set_lengths(lengths)
        self.rewind()

    def _set_lengths(self, lengths_s: list[float]) -> None:
        self._ends_s = np.cumsum(lengths_s)
        self.slider.blockSignals(True)
        self.slider.setRange(0, round(STEPS_PER_S * self.duration_s))
        self.slider.setPageStep(60 * STEPS_PER_S)
        self.slider.blockSignals(False)

    def _prepared(self) -> tuple[CameraFlight | None, ...]:
        """The sorties as they are flown; from now on their times are exact."""
        if self._flights is None:
            plan = self._plan
            self._flights = () if plan is None else tuple(_flight(plan, number) for number in range(len(plan.sorties)))
            self._set_lengths([0.0 if flight is None else flight.duration_s for flight in self._flights])
        return self._flights

    @property
    def duration_s(self) -> float:
        """Of all sorties, one after the other."""
        return float(self._ends_s[-1]) if len(self._ends_s) else 0.0

    def value(self) -> float:
        """Time since the start of the first sortie, s."""
        return self._t_s

    def setValue(self, t_s: float) -> None:  # noqa: N802
        """Go to a time."""
        self._prepared()
        self._t_s = min(max(t_s, 0.0), self.duration_s)
        self.slider.blockSignals(True)
        self.slider.setValue(round(STEPS_PER_S * self._t_s))
        self.slider.blockSignals(False)
        pose = self.pose()
        self._label.setText("" if pose is None else self._text(pose))
        self.poseChanged.emit(pose)

    def text(self) -> str:
        """Which sortie is flown, and at what time."""
        return self._label.text()

    def rewind(self) -> None:
        """Back to the start, and nothing is flown."""
        self.play.setChecked(False)
        self._t_s = 0.0
        self.slider.blockSignals(True)
        self.slider.setValue(0)
        self.slider.blockSignals(False)
        self._label.setText("")
        self.poseChanged.emit(None)

    def pose(self) -> FlownPose | None:
        """Where the aircraft is, and where its camera looks."""
        flights, (number, t_s) = self._prepared(), self._place()
        flight = flights[number] if number >= 0 else None
        if flight is None:
            return None
        pose = flight.pose_at(t_s)
        return FlownPose(number, pose.position_enu_m, pose.heading_rad, pose.pitch_rad)

    def _place(self) -> tuple[int, float]:
        """Sortie, counted from 0, and time in it; -1 for none."""
        flights = self._prepared()
        if not flights or self.duration_s <= 0.0:
            return -1, 0.0
        number = min(int(np.searchsorted(self._ends_s, self._t_s, side="right")), len(self._ends_s) - 1)
        # The end of the last sortie is its own; a sortie that cannot be flown has no time.
        while flights[number] is None and number > 0:
            number -= 1
        return number, self._t_s - (float(self._ends_s[number - 1]) if number else 0.0)

    def _text(self, pose: FlownPose) -> str:
        _, t_s = self._place()
        flight = self._prepared()[pose.sortie]
        assert flight is not None
        n_photos = len(flight.photos_between(-1.0, t_s))
        return self.tr("Sortie {0}: {1} of {2}, photo {3}").format(
            pose.sortie + 1, _minutes(t_s), _minutes(flight.duration_s), n_photos
        )

    def _play(self, is_on: bool) -> None:
        self.play.setText(self.tr("Pause") if is_on else self.tr("Fly"))
        if not is_on:
            self._timer.stop()
            return
        if self._t_s >= self.duration_s:
            self._t_s = 0.0
        self._last_s = time.monotonic()
        self._timer.start()

    def _tick(self) -> None:
        if self.window().isVisible() and not self.isVisible():
            # Another tab or page is in front: the flight waits.
            self.play.setChecked(False)
            return
        now_s = time.monotonic()
        elapsed_s, self._last_s = now_s - self._last_s, now_s
        self.setValue(self._t_s + elapsed_s * float(self.speed.currentData()))
        if self._t_s >= self.duration_s:
            self.play.setChecked(False)

    def _slid(self, step: int) -> None:
        self.setValue(step / STEPS_PER_S)


def _flight(plan: Plan, number: int) -> CameraFlight | None:
    """A sortie as it is flown; None where it cannot be."""
    try:
        return camera_flight(plan, plan.sorties[number])
    except InfeasibleError:
        return None


def _minutes(t_s: float) -> str:
    """Minutes and seconds."""
    return f"{int(t_s) // 60}:{int(t_s) % 60:02d}"
