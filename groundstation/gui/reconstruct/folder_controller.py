"""Which data set is learned from, how, and where the model goes: what the Reconstruct tab has before it trains."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.services.jobs.runner import JobContext
from groundstation.services.reconstruct.choices import Forecast, Machine, TrainChoice, forecast, this_machine
from groundstation.services.reconstruct.folders import (
    DataSetCard,
    ModelCard,
    Standing,
    models_beside,
    noted_data_set,
    proposed_folder,
    read_data_set,
    standing,
    usual_data_set,
)
from planning.base.files import real_path
from planning.base.findings import Severity
from reconstruction.light.photo_set import held_out_names
from reconstruction.training.method_registry import method_named

HELD_OUT, SEED = 0.15, 0
"""Share and seed that trainings hold views out by unless their settings say otherwise."""


class FolderController(QObject):
    """Keeps what is chosen, and looks at what stands there.

    Signals
    -------
    dataSetChanged()
        Another one was read.
    placeChanged()
        Another folder for the model, or something else stands there.
    stateChanged()
        What can be done is different.
    """

    dataSetChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    placeChanged = Signal()  # noqa: N815
    stateChanged = Signal()  # noqa: N815

    def __init__(self, workspace: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._workspace = workspace
        self.choice, self.out = TrainChoice(), Path()
        self.card: DataSetCard | None = None
        self.machine: Machine = this_machine()
        self.standing = Standing()
        self.others: tuple[ModelCard, ...] = ()
        self._is_reading = False

    @property
    def is_busy(self) -> bool:
        """Whether a model is being trained, so that its folder stays."""
        return False

    @property
    def is_reading(self) -> bool:
        """Whether a data set is being read."""
        return self._is_reading

    def forecast(self) -> Forecast | None:
        """What memory the training would ask for."""
        knows = method_named(self.choice.method).knows_panels
        return None if self.card is None else forecast(self.card, self.machine, knows)

    def unseen(self) -> frozenset[str]:
        """Names of photos that are not learned from."""
        if self.card is None or len(self.card.source.photos) < 2:
            return frozenset()
        return frozenset(held_out_names([photo.name for photo in self.card.source.photos], HELD_OUT, SEED))

    def usual_data_set(self) -> Path | None:
        """That of the project."""
        return usual_data_set(self._workspace.session.folder)

    # What is chosen

    def read(self, folder: Path) -> None:
        """Take a data set folder."""
        if self._is_reading:
            return

        def work(context: JobContext) -> DataSetCard:
            return read_data_set(folder, context)

        self._is_reading = True
        self._workspace.start(self.tr("Read the data set"), work, self._read, self._not_read)
        self.stateChanged.emit()

    def choose(self, choice: TrainChoice) -> None:
        """Ask for another training; the folder follows the method, where the user has chosen none."""
        before, self.choice = self.choice, choice
        if before.method != choice.method:
            self._propose()
        self.stateChanged.emit()

    def choose_out(self, folder: Path) -> None:
        """Take a folder for the model; an interrupted training's own data set is taken with it."""
        self.out = folder
        self.look_at_out()
        dataset = noted_data_set(folder) if self.standing.is_interrupted else None
        if dataset is not None and (self.card is None or real_path(self.card.folder) != real_path(dataset)):
            self.read(dataset)
        self.placeChanged.emit()
        self.stateChanged.emit()

    def look_around(self) -> None:
        """See what has changed on the disk, and what memory is free."""
        self.machine = this_machine()
        self.look_at_out()
        self.placeChanged.emit()
        self.stateChanged.emit()

    def _read(self, card: DataSetCard) -> None:
        self._is_reading, self.card = False, card
        noted = noted_data_set(self.out)
        if not self.standing.is_interrupted or (noted is not None and real_path(noted) != real_path(card.folder)):
            self._propose()
        site = self._workspace.document.site
        self._workspace.settle("training.data")
        if site is not None and site.site.n_panels > 0 and not card.shows(site.site):
            self._workspace.say(
                Severity.WARNING,
                self.tr(
                    "This data set shows other panels than the site that is open ({0} against {1}). It can be trained "
                    "on all the same; is it the right one?"
                ).format(len(card.source.panels.corners_enu_m), site.site.n_panels),
                about="training.data",
            )
        self.dataSetChanged.emit()
        self.stateChanged.emit()

    def _not_read(self, _error: BaseException) -> None:
        self._is_reading = False
        self.stateChanged.emit()

    def _propose(self) -> None:
        if self.card is not None and not self.is_busy:
            project = self._workspace.session.folder
            self.out = proposed_folder(self.card.folder, self.choice.method, project)
            self.look_at_out()
            self.placeChanged.emit()

    def look_at_out(self) -> None:
        """See what stands in the folder, and beside it."""
        self.standing = standing(self.out) if self.out.name else Standing()
        self._look_for_others()

    def _look_for_others(self) -> None:
        """Find the finished models beside the folder; their descriptions can be long."""
        card, out = self.card, self.out
        if card is None or not out.name:
            self.others = ()
            return

        def work(_context: JobContext) -> tuple[ModelCard, ...]:
            return models_beside(out, card)

        def done(found: tuple[ModelCard, ...]) -> None:
            if self.card is card and self.out == out:
                self.others = found
                self.placeChanged.emit()

        self._workspace.start(self.tr("Look for models"), work, done)
