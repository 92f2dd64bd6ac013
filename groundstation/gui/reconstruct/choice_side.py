"""The left side: data set, what to train, where the model goes, and the buttons of a training."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.reconstruct.choice_form import ChoiceForm
from groundstation.gui.reconstruct.machine_words import MachineWords
from groundstation.gui.reconstruct.reconstruct_desk import BUSY, Phase, ReconstructDesk
from groundstation.gui.scrolling import ButtonGrid, WrappingRow


class ChoiceSide(QWidget):
    """Shows the desk's choices and what can be done."""

    def __init__(self, desk: ReconstructDesk, words: MachineWords, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._desk, self._words = desk, words
        self.form = ChoiceForm()
        self.choose, self.choose_out = QPushButton(self.tr("Choose ...")), QPushButton(self.tr("Choose ..."))
        self.train, self.pause = QPushButton(self.tr("Train")), QPushButton(self.tr("Pause"))
        self.stop, self.break_off = QPushButton(self.tr("Good enough, stop")), QPushButton(self.tr("Break off"))
        self.data_set, self.out, self.there, self.wrong = QLabel(), QLabel(), QLabel(), QLabel()
        self._make()

    def show_state(self) -> None:
        """Show what is chosen, and enable what can be done."""
        desk = self._desk
        is_idle = desk.phase is Phase.IDLE and not desk.is_reading
        self._show_data_set()
        self.out.setText(_short(desk.out))
        self.out.setToolTip(str(desk.out))
        self.there.setText(self._standing())
        for widget in (self.choose, self.choose_out):
            widget.setEnabled(is_idle)
        self.form.setEnabled(is_idle and not desk.standing.is_interrupted)
        goes_on = desk.standing.is_interrupted and not desk.is_busy
        self.train.setText(self.tr("Go on") if goes_on else self.tr("Train"))
        self.train.setEnabled(is_idle and desk.card is not None and bool(desk.out.name))
        can_stop = desk.phase in (Phase.PREPARING, Phase.TRAINING)
        self.pause.setEnabled(can_stop)
        self.pause.setText(self.tr("Resume") if desk.is_paused else self.tr("Pause"))
        self.stop.setEnabled(can_stop)
        self.break_off.setEnabled(desk.phase in (BUSY | {Phase.ASKING}) - {Phase.ENDING})
        told = self._words.told(desk.machine, desk.cuda, desk.choice, desk.card, desk.forecast(), desk.standing)
        self.wrong.setText("\n".join(text for role, text in told if role == "error"))
        self.wrong.setVisible(bool(self.wrong.text()) and is_idle)

    def _show_data_set(self) -> None:
        desk = self._desk
        if desk.is_reading:
            self.data_set.setText(self.tr("The data set is being read ..."))
        elif desk.card is None:
            self.data_set.setText(self.tr("None is chosen."))
        else:
            n_photos, n_panels = len(desk.card.source.photos), len(desk.card.source.panels.corners_enu_m)
            self.data_set.setText(
                self.tr("{0}: {1} photos, {2} panels").format(_short(desk.card.folder), n_photos, n_panels)
            )
            self.data_set.setToolTip(str(desk.card.folder))

    def _standing(self) -> str:
        found = self._desk.standing
        if self._desk.is_busy or not self._desk.out.name:
            return ""
        if found.is_interrupted:
            return self.tr("A training was broken off there: it can be gone on with, as it was begun.")
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
        self.break_off.setToolTip(self.tr("End now and keep the state; the training can be gone on with later"))
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
        for button in (self.pause, self.break_off, self.stop):
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
