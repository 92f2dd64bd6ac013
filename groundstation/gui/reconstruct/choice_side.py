"""The left side: data set, what to train and on what computer, where the model goes, and the buttons of a training."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.reconstruct.reconstruct_controller import BUSY, Phase, ReconstructController
from groundstation.gui.widgets.inputs import ChoiceBox, Form, NumberBox
from groundstation.gui.widgets.parameter_form import choice_text, title_of
from groundstation.gui.widgets.scrolling import ButtonGrid, WrappingRow
from groundstation.services.reconstruct.choices import (
    LONGEST_MIN,
    PROGRAM_BYTES,
    Forecast,
    Machine,
    TrainChoice,
    method_rows,
    preset_rows,
)
from groundstation.services.reconstruct.folders import LEAST_FREE_BYTES, DataSetCard, Standing
from groundstation.services.units import UnitSystem
from planning.base.parameters import declared
from reconstruction.training.parameters import PRESETS, TrainRequest

# What this computer has, and what follows for a training, in words.

StatusLine = tuple[str, str]
"""Role of a label ("", warning, error), and text."""


class MachineTexts(QObject):
    """Says it."""

    def lines(self, controller: ReconstructController) -> list[StatusLine]:
        """Lines, what is most in the way first."""
        machine, forecast = controller.machine, controller.forecast()
        lines = self._lacking(machine, forecast, controller.standing)
        lines += self._computer(machine, controller.cuda, controller.cards, controller.choice)
        if controller.card is not None and forecast is not None:
            lines += self._photos(controller.card, forecast)
        return lines

    def _lacking(self, machine: Machine, forecast: Forecast | None, standing: Standing) -> list[StatusLine]:
        lines: list[StatusLine] = []
        if forecast is not None and machine.free_bytes is not None and forecast.needed_bytes > machine.free_bytes:
            lines.append(
                (
                    "error",
                    self.tr(
                        "Memory is short: up to {0} are needed, and {1} are free. The system may end the training; its "
                        "last state is kept. Close other programs, or prepare the data set with smaller photos."
                    ).format(size_text(forecast.needed_bytes), size_text(machine.free_bytes)),
                )
            )
        if standing.free_bytes is not None and standing.free_bytes < LEAST_FREE_BYTES:
            lines.append(
                (
                    "error",
                    self.tr(
                        "Only {0} are free on the disk. States and models are written beside the old ones; make room, "
                        "or choose another folder."
                    ).format(size_text(standing.free_bytes)),
                )
            )
        return lines

    def _computer(
        self, machine: Machine, cuda: tuple[str, ...] | None, cards: tuple[str, ...], choice: TrainChoice
    ) -> list[StatusLine]:
        words = self.tr("{0} cores").format(machine.cores)
        if machine.memory_bytes is not None:
            words += self.tr(", {0} of memory").format(size_text(machine.memory_bytes))
        if machine.free_bytes is not None:
            words += self.tr(", {0} of it free").format(size_text(machine.free_bytes))
        lines: list[StatusLine] = [("", words)]
        if cuda is None:
            lines.append(("", self.tr("Looking for a graphics card ...")))
        elif cards and not cuda:
            lines.append(
                (
                    "",
                    self.tr("Graphics card: {0}. It draws splats where a step takes less time.").format(
                        "; ".join(cards)
                    ),
                )
            )
        elif not cuda:
            lines.append(
                (
                    "warning",
                    self.tr("No graphics card: models are learned by one core of the processor."),
                )
            )
            lines.append(
                (
                    "",
                    self.tr(
                        "The times to choose from are meant for that. A step of splats alone, 20 000 of them on 256 x "
                        "192 pixels, takes about 75 ms; with mirrored light or more pixels it takes longer."
                    ),
                )
            )
        else:
            lines.append(("", self.tr("CUDA device: {0}").format("; ".join(cuda))))
            if not choice.on_cuda:
                lines.append(("", self.tr("It is not used, since it is not chosen.")))
        return lines

    def _photos(self, card: DataSetCard, forecast: Forecast) -> list[StatusLine]:
        lens, reduce = card.source.photos[0].intrinsics, forecast.reduce
        n_photos, size = len(card.source.photos), size_text(forecast.photos_bytes)
        wide, high = lens.width_px, lens.height_px
        said = (
            self.tr("{0} photos of {1} x {2} pixels take {3} of memory when they are decoded.").format(
                n_photos, wide, high, size
            )
            if reduce == 1
            else self.tr(
                "{0} photos of {1} x {2} pixels are learned from at {3} x {4}; decoded, they take {5} of memory."
            ).format(n_photos, wide, high, wide // reduce, high // reduce, size)
        )
        lines: list[StatusLine] = [("", said)]
        if forecast.all_fit:
            lines.append(("", self.tr("All of them fit, and each is read once.")))
        else:
            lines.append(
                (
                    "",
                    self.tr(
                        "They are streamed through at most {0}: each is looked at four times while it is at hand, then "
                        "others take its place."
                    ).format(size_text(forecast.limit_bytes)),
                )
            )
        if forecast.is_reduced:
            lines.append(
                (
                    "warning",
                    self.tr("Less memory is taken than usual ({0}), for little is free.").format(
                        size_text(forecast.limit_bytes)
                    ),
                )
            )
        lines.append(
            (
                "",
                self.tr("All in all a training takes up to {0}; {1} of it are the program's.").format(
                    size_text(forecast.needed_bytes), size_text(PROGRAM_BYTES)
                ),
            )
        )
        return lines


def size_text(n_bytes: int) -> str:
    """Bytes as people read them."""
    return f"{n_bytes / 2**30:.1f} GiB" if n_bytes >= 1 << 30 else f"{n_bytes / 2**20:.0f} MiB"


# How a model is to be trained: method, time, and what to compute on.

OWN = "own"
"""Of the list of times."""


class ChoiceForm(QWidget):
    """Edits a `TrainChoice`, but for its light.

    Signals
    -------
    valueChanged(TrainChoice)
        By the user.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = TrainChoice()
        self._methods = {row.name: row for row in method_rows()}
        self.method, self.time, self.device = ChoiceBox(), ChoiceBox(), ChoiceBox()
        self.minutes = NumberBox(1.0, float(LONGEST_MIN), 5.0, self.tr(" min"), 0)
        self.about = QLabel()
        self._make()
        self._fill()
        self.setValue(self._value)
        self.method.currentIndexChanged.connect(self._changed)
        self.time.currentIndexChanged.connect(self._changed)
        self.device.currentIndexChanged.connect(self._changed)
        self.minutes.valueChanged.connect(self._changed)

    def value(self) -> TrainChoice:
        """What is chosen."""
        return self._value

    def setValue(self, value: TrainChoice) -> None:  # noqa: N802
        """Show another choice."""
        self._value = value
        blockers = [QSignalBlocker(each) for each in (self.method, self.time, self.device, self.minutes)]
        self.method.show_value(value.method)
        self.time.show_value(value.preset if value.minutes is None else OWN)
        if value.minutes is not None:
            self.minutes.setValue(value.minutes)
        self.device.setCurrentIndex(int(value.on_cuda and self.device.count() > 1))
        del blockers
        self._show()

    def set_cuda(self, devices: tuple[str, ...]) -> None:
        """Offer devices besides the processor; without any there is nothing to choose."""
        with QSignalBlocker(self.device):
            while self.device.count() > 1:
                self.device.removeItem(1)
            if devices:
                self.device.addItem(devices[0])
        self._show()

    def set_light(self, light: str) -> None:
        """Another light is chosen, elsewhere."""
        self._value = replace(self._value, light=light)

    def _make(self) -> None:
        self.minutes.setValue(30.0)
        for box in (self.method, self.time, self.device):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(10)
            box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.about.setWordWrap(True)
        self.about.setProperty("role", "muted")
        self._form = Form()
        known = declared(TrainRequest)
        self._form.addRow(title_of(known["method"].parameter), self.method)
        self._form.addRow(self.about)
        self._form.addRow(title_of(known["preset"].parameter), self.time)
        self._form.addRow(self.tr("At most"), self.minutes)
        self._form.addRow(title_of(known["device"].parameter), self.device)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(self._form)

    def _fill(self) -> None:
        for number, row in enumerate(self._methods.values()):
            self.method.addItem(row.title, row.name)
            self.method.setItemData(number, translated(row.what, UnitSystem.METRIC), Qt.ItemDataRole.ToolTipRole)
        known = declared(TrainRequest)["preset"].parameter
        for number, preset in enumerate(preset_rows()):
            self.time.addItem(choice_text(known, preset), preset)
            tip = translated(PRESETS[preset].what, UnitSystem.METRIC)
            self.time.setItemData(number, tip, Qt.ItemDataRole.ToolTipRole)
        self.time.addItem(self.tr("Custom time"), OWN)
        self.device.addItem(choice_text(declared(TrainRequest)["device"].parameter, "auto"))

    def _changed(self) -> None:
        preset = str(self.time.currentData())
        own = preset == OWN
        self._value = replace(
            self._value,
            method=str(self.method.currentData()),
            preset=self._value.preset if own else preset,
            minutes=self.minutes.value() if own else None,
            on_cuda=self.device.currentIndex() > 0,
        )
        self._show()
        self.valueChanged.emit(self._value)

    def _show(self) -> None:
        row = self._methods[self._value.method]
        self.about.setText(translated(row.what, UnitSystem.METRIC))
        self._form.setRowVisible(self.minutes, self._value.minutes is not None)
        self._form.setRowVisible(self.device, self.device.count() > 1)


class ChoiceSide(QWidget):
    """Shows the controller's choices and what can be done."""

    def __init__(self, controller: ReconstructController, words: MachineTexts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._controller, self._words = controller, words
        self.form = ChoiceForm()
        self.choose, self.choose_out = QPushButton(self.tr("Choose ...")), QPushButton(self.tr("Choose ..."))
        self.train, self.pause = QPushButton(self.tr("Train")), QPushButton(self.tr("Pause"))
        self.stop, self.cancel_training = QPushButton(self.tr("Stop and keep")), QPushButton(self.tr("Cancel"))
        self.data_set, self.out, self.there, self.wrong = QLabel(), QLabel(), QLabel(), QLabel()
        self._make()

    def show_state(self) -> None:
        """Show what is chosen, and enable what can be done."""
        controller = self._controller
        is_idle = controller.phase is Phase.IDLE and not controller.is_reading
        self._show_data_set()
        self.out.setText(_short(controller.out))
        self.out.setToolTip(str(controller.out))
        self.there.setText(self._standing())
        for widget in (self.choose, self.choose_out):
            widget.setEnabled(is_idle)
        self.form.setEnabled(is_idle and not controller.standing.is_interrupted)
        goes_on = controller.standing.is_interrupted and not controller.is_busy
        self.train.setText(self.tr("Resume") if goes_on else self.tr("Train"))
        self.train.setEnabled(is_idle and controller.card is not None and bool(controller.out.name))
        can_stop = controller.phase in (Phase.PREPARING, Phase.TRAINING)
        self.pause.setEnabled(can_stop)
        self.pause.setText(self.tr("Resume") if controller.is_paused else self.tr("Pause"))
        self.stop.setEnabled(can_stop)
        self.cancel_training.setEnabled(controller.phase in (BUSY | {Phase.ASKING}) - {Phase.ENDING})
        lines = self._words.lines(controller)
        self.wrong.setText("\n".join(text for role, text in lines if role == "error"))
        self.wrong.setVisible(bool(self.wrong.text()) and is_idle)

    def _show_data_set(self) -> None:
        controller = self._controller
        if controller.is_reading:
            self.data_set.setText(self.tr("The data set is being read ..."))
        elif controller.card is None:
            self.data_set.setText(self.tr("None is chosen."))
        else:
            n_photos, n_panels = len(controller.card.source.photos), len(controller.card.source.panels.corners_enu_m)
            self.data_set.setText(
                self.tr("{0}: {1} photos, {2} panels").format(_short(controller.card.folder), n_photos, n_panels)
            )
            self.data_set.setToolTip(str(controller.card.folder))

    def _standing(self) -> str:
        found = self._controller.standing
        if self._controller.is_busy or not self._controller.out.name:
            return ""
        if found.is_interrupted:
            return self.tr("A training was cancelled there: it can be resumed, as it was begun.")
        if found.has_model:
            return self.tr("A finished model stands there. It stays until the new one is whole, and is replaced then.")
        if found.is_foreign:
            return self.tr("There is something else in this folder; it is left alone.")
        return ""

    def _make(self) -> None:
        self.train.setProperty("primary", "true")
        self.wrong.setProperty("role", "error")
        for label in (self.data_set, self.out, self.there):
            label.setProperty("role", "muted")
        for label in (self.data_set, self.out, self.there, self.wrong):
            label.setWordWrap(True)
        self.pause.setToolTip(self.tr("Let the training wait; the model can be looked at meanwhile"))
        self.stop.setToolTip(
            self.tr(
                "Let the rates fall within a twentieth of the time so far, a minute at most, and write the model: it "
                "is better than it is now"
            )
        )
        self.cancel_training.setToolTip(self.tr("End now and keep the state; the training can be gone on with later"))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 6, 0)
        layout.addLayout(_headed(self.tr("Data set"), self.choose))
        layout.addWidget(self.data_set)
        layout.addWidget(self.form)
        layout.addLayout(_headed(self.tr("Model goes to"), self.choose_out))
        layout.addWidget(self.out)
        layout.addWidget(self.there)
        layout.addWidget(self.wrong)
        layout.addWidget(self.train)
        grid = ButtonGrid()
        for button in (self.pause, self.cancel_training, self.stop):
            grid.addWidget(button)
        layout.addLayout(grid)
        layout.addStretch(1)


def _headed(text: str, button: QPushButton) -> WrappingRow:
    heading = QLabel(text)
    heading.setProperty("role", "heading")
    row = WrappingRow(first_grows=True)
    row.addWidget(heading)
    row.addWidget(button)
    button.setAccessibleName(f"{text}: {button.text()}")
    return row


def _short(folder: Path) -> str:
    """The last two parts of a path."""
    return str(Path(*folder.parts[-2:])) if folder.name else ""
