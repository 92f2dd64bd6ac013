"""What the Reconstruct tab works on: a data set, the training on it, and the process that trains and shows models."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from groundstation.gui.application.context import ApplicationContext, Ongoing
from groundstation.services.jobs.channel import ProcessEnded
from groundstation.services.jobs.runner import JobContext
from groundstation.services.reconstruct.choices import Forecast, Machine, TrainChoice, forecast, this_machine
from groundstation.services.reconstruct.curves import ThinCurve
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
from groundstation.services.reconstruct.messages import (
    AskScene,
    CancelTraining,
    Chosen,
    Devices,
    Ended,
    FirstLook,
    Measured,
    ModelProcess,
    Pause,
    PhotoError,
    Stage,
    Stepped,
    Stop,
    Subject,
    Train,
    ViewAnswer,
    ViewRequest,
    WatchErrors,
)
from planning.base.effects import Decision
from planning.base.errors import GroundStationError
from planning.base.files import real_path
from planning.base.findings import Finding, Severity
from reconstruction.light.photo_set import held_out_names
from reconstruction.training.method_registry import PLAIN_METHOD, method_named

# Which data set is learned from, how, and where the model goes: what the Reconstruct tab has before it trains.

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

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._context = context
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
        return None if self.card is None else forecast(self.card, self.machine, self.choice)

    def unseen(self) -> frozenset[str]:
        """Names of photos that are not learned from."""
        if self.card is None or len(self.card.source.photos) < 2:
            return frozenset()
        return frozenset(held_out_names([photo.name for photo in self.card.source.photos], HELD_OUT, SEED))

    def usual_data_set(self) -> Path | None:
        """That of the project."""
        return usual_data_set(self._context.session.folder)

    # What is chosen

    def read(self, folder: Path) -> None:
        """Take a data set folder, or one that a data set can be made of without a site."""
        if self._is_reading:
            return

        found: list[Finding] = []

        def work(context: JobContext) -> DataSetCard:
            from groundstation.services.photos.coarse import data_set_of

            return read_data_set(data_set_of(folder, context, found), context)

        def done(card: DataSetCard) -> None:
            if real_path(card.folder) != real_path(folder):
                for each in found:
                    self._context.say(each.severity, self._context.localized(each.message))
                text = self.tr("A data set for plain splats was made of {0}: {1}")
                self._context.say(Severity.OK, text.format(folder, card.folder))
            self._read(card)

        self._is_reading = True
        self._context.start(self.tr("Read the data set"), work, done, self._not_read)
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
        self.check_output_folder()
        dataset = noted_data_set(folder) if self.standing.is_interrupted else None
        if dataset is not None and (self.card is None or real_path(self.card.folder) != real_path(dataset)):
            self.read(dataset)
        self.placeChanged.emit()
        self.stateChanged.emit()

    def check_folders(self) -> None:
        """See what has changed on the disk, and what memory is free."""
        self.machine = this_machine()
        self.check_output_folder()
        self.placeChanged.emit()
        self.stateChanged.emit()

    def _read(self, card: DataSetCard) -> None:
        self._is_reading, self.card = False, card
        if not card.source.has_panels and method_named(self.choice.method).knows_panels:
            self.choice = replace(self.choice, method=PLAIN_METHOD)
        noted = noted_data_set(self.out)
        if not self.standing.is_interrupted or (noted is not None and real_path(noted) != real_path(card.folder)):
            self._propose()
        site = self._context.document.site
        self._context.withdraw("training.data")
        if site is not None and site.site.n_panels > 0 and not card.shows(site.site):
            self._context.say(
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
            project = self._context.session.folder
            self.out = proposed_folder(self.card.folder, self.choice.method, project)
            self.check_output_folder()
            self.placeChanged.emit()

    def check_output_folder(self) -> None:
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

        self._context.start(self.tr("Look for models"), work, done)


# What is known of the training that runs, or ran last.


@dataclass(slots=True, eq=False)
class ActiveTraining:
    """A training.

    Parameters
    ----------
    dataset, out
        Folders of what is learned from, and of the model.
    begun_s
        When it began, of `time.monotonic`; as much later as it waited since.
    longest_s
        That it may take; None where that is not known, or part of it was spent before.
    waits_since_s
        Of `time.monotonic`; None where it does not wait.
    n_first_looks
        Models that there were to look at before the first step.
    quality
        PSNR, dB, of unseen views by seconds.
    terms
        Of the loss by seconds.
    """

    dataset: Path = field(default_factory=Path)
    out: Path = field(default_factory=Path)
    begun_s: float = 0.0
    longest_s: float | None = None
    waits_since_s: float | None = None
    stage: Stage | None = None
    n_first_looks: int = 0
    stepped: Stepped | None = None
    ended: Ended | None = None
    quality: ThinCurve = field(default_factory=ThinCurve)
    terms: dict[str, ThinCurve] = field(default_factory=dict)

    @property
    def has_model(self) -> bool:
        """Whether there is a model of it to look at."""
        if self.ended is None and self.n_first_looks > 0:
            return True
        return self.stepped is not None or (self.ended is not None and self.ended.outcome == "done")

    @property
    def elapsed_s(self) -> float:
        """What it has taken, but for the time that it waited."""
        now_s = time.monotonic() if self.waits_since_s is None else self.waits_since_s
        return now_s - self.begun_s

    def wait(self, *, is_on: bool) -> None:
        """It waits from now on, or goes on."""
        now_s = time.monotonic()
        if self.waits_since_s is not None:
            self.begun_s += now_s - self.waits_since_s
        self.waits_since_s = now_s if is_on else None

    def take_step(self, stepped: Stepped) -> None:
        """It has gone on."""
        self.stepped = stepped
        if stepped.phase != "paused":
            for name, value in stepped.terms.items():
                self.terms.setdefault(name, ThinCurve()).add(stepped.seconds, value)


TRAINING = Subject("training")


class Phase(Enum):
    """What the process does.

    IDLE -> ASKING -> IDLE                                    the scene is asked which light it calls for
    IDLE -> PREPARING -> TRAINING -> (COOLING_DOWN ->) IDLE       a training, to its end or stopped
    PREPARING, TRAINING, COOLING_DOWN -> ENDING -> IDLE           broken off; its state is kept
    """

    IDLE = auto()
    ASKING = auto()
    PREPARING = auto()
    TRAINING = auto()
    COOLING_DOWN = auto()
    ENDING = auto()


BUSY = frozenset({Phase.PREPARING, Phase.TRAINING, Phase.COOLING_DOWN, Phase.ENDING})


class ReconstructController(FolderController):
    """Keeps what is known, and passes on what the user wants.

    Signals
    -------
    progressed()
        Stage, steps or quality went on.
    lightChanged()
        It is known which light the scene calls for.
    errorsChanged()
        It is known how well the model shows another photo.
    viewAnswered(ViewAnswer)
        A picture came.
    """

    progressed = Signal()
    lightChanged = Signal()  # noqa: N815
    errorsChanged = Signal()  # noqa: N815
    viewAnswered = Signal(object)  # noqa: N815
    _came = Signal(object)

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(context, parent)
        self._process = ModelProcess(self._came.emit)
        self._came.connect(self._take)
        self.dataSetChanged.connect(self._forget_scene)
        self.cuda: tuple[str, ...] | None = None
        self.cards: tuple[str, ...] = ()
        self.phase, self.is_paused = Phase.IDLE, False
        self.training = ActiveTraining()
        self.light, self.decisions = "", tuple[Decision, ...]()
        self.errors: dict[str, float] = {}
        self.errors_of: Subject | None = None
        context.count_as_busy(lambda: self.is_busy)
        self.stateChanged.connect(lambda: context.note(is_training=self.is_busy))
        self.dataSetChanged.connect(self._tell_data_set)
        self.progressed.connect(self._tell_progress)

    @classmethod
    def of(cls, context: ApplicationContext) -> ReconstructController:
        """The one of a context: it stays when the window is made anew."""
        found = context.findChild(ReconstructController)
        return cls(context, context) if found is None else found

    # What is known

    @property
    def is_busy(self) -> bool:
        """Whether a model is being trained."""
        return self.phase in BUSY

    @property
    def has_model(self) -> bool:
        """Whether there is a model of this data set in the process: in training, or trained last."""
        return self.training.has_model and self.card is not None and self.training.dataset == self.card.folder

    # What is done

    def warm_up(self) -> None:
        """Start the process, so that the first picture need not wait for it."""
        if self.cuda is None and not self._process.is_running:
            self._process.send(WatchErrors(None, Path()))

    def train(self) -> None:
        """Begin a training, or go on with the one that was interrupted in the folder."""
        card, known = self.card, self.forecast()
        if card is None or known is None or self.phase is not Phase.IDLE:
            return
        resume = self.standing.is_interrupted
        request = self.choice.request(known.limit_bytes if known.is_reduced else None)
        longest_s = None if resume else self.choice.longest_s
        self.training = ActiveTraining(card.folder, self.out, time.monotonic(), longest_s)
        self.is_paused = False
        if not resume:
            self.light, self.decisions = "", ()
        self._to(Phase.PREPARING)
        self._process.send(Train(card.folder, self.out, request, resume))
        self.watch_errors(TRAINING)
        self.lightChanged.emit()
        self.errorsChanged.emit()
        self.progressed.emit()

    def ask_scene(self) -> None:
        """Find out which model of mirrored light the photos call for."""
        card, known = self.card, self.forecast()
        if card is None or known is None or self.phase is not Phase.IDLE:
            return
        self.training.stage = None
        self._to(Phase.ASKING)
        self._process.send(AskScene(card.folder, replace(self.choice, light="auto").request(known.limit_bytes)))

    def pause(self, is_on: bool) -> None:
        """Let the training wait, or go on."""
        if self.phase in (Phase.PREPARING, Phase.TRAINING) and is_on != self.is_paused:
            self.is_paused = is_on
            self.training.wait(is_on=is_on)
            self._process.send(Pause(is_on))
            self.stateChanged.emit()

    def stop(self) -> None:
        """Good enough: settle, and write the model."""
        if self.phase in (Phase.PREPARING, Phase.TRAINING):
            self.is_paused = False
            self.training.wait(is_on=False)
            self._process.send(Stop())
            self._to(Phase.COOLING_DOWN)

    def cancel_training(self) -> None:
        """End now; the state is kept."""
        if self.phase in BUSY or self.phase is Phase.ASKING:
            self.is_paused = False
            self._process.send(CancelTraining())
            self._to(Phase.ENDING if self.phase in BUSY else Phase.ASKING)

    def request_view(self, look: ViewRequest) -> None:
        """Ask for a picture."""
        self._process.send(look)

    def watch_errors(self, subject: Subject | None) -> None:
        """Have the photos judged as a model shows them."""
        if self.card is not None:
            self.errors_of, self.errors = subject, {}
            self._process.send(WatchErrors(subject, self.card.folder))
            self.errorsChanged.emit()

    def close(self) -> None:
        """The window goes: a training keeps its state by itself."""
        self._process.close()

    # What comes

    def _forget_scene(self) -> None:
        self.light, self.decisions = "", ()
        self.errors, self.errors_of = {}, None
        self.lightChanged.emit()

    def _to(self, phase: Phase) -> None:
        self.phase = phase
        self.stateChanged.emit()

    def _take(self, message: Any) -> None:
        match message:
            case ViewAnswer():
                self.viewAnswered.emit(message)
            case Stage():
                self.training.stage = message
                self.progressed.emit()
            case FirstLook():
                self.training.n_first_looks += 1
                self.progressed.emit()
            case Stepped():
                self._take_step(message)
            case Measured(seconds, psnr_db):
                self.training.quality.add(seconds, psnr_db)
                self.progressed.emit()
            case PhotoError(subject, name, psnr_db):
                if subject == self.errors_of:
                    self.errors[name] = psnr_db
                    self.errorsChanged.emit()
            case Chosen(light, decisions):
                self.light, self.decisions = light or "harmonics", decisions
                self.lightChanged.emit()
            case Devices(cuda, cards):
                self.cuda, self.cards = cuda, cards
                self.stateChanged.emit()
            case Ended():
                self._take_end(message)
            case ProcessEnded():
                self._take_loss(message)

    def _take_step(self, stepped: Stepped) -> None:
        self.training.take_step(stepped)
        if self.phase is Phase.PREPARING:
            self._to(Phase.TRAINING)
        self.progressed.emit()

    def _take_end(self, ended: Ended) -> None:
        was, self.phase, self.is_paused = self.phase, Phase.IDLE, False
        if was is not Phase.ASKING:
            self.training.ended = ended
        if ended.error is not None:
            self._say_error(ended.error)
        self.check_output_folder()
        if ended.outcome == "kept" and was in BUSY:
            words = (
                self.tr("The training was cancelled; resume it whenever you like.")
                if self.standing.is_interrupted
                else self.tr("The training was cancelled before there was anything to keep.")
            )
            self._context.say(Severity.NOTE, words)
        elif ended.outcome == "done" and was in BUSY:
            self._context.say(Severity.NOTE, self.tr("The model is written: {0}").format(self.out))
            self.watch_errors(TRAINING)
            self._context.note(model=self.out, is_model_open=False)  # one that is open is of before
        self.placeChanged.emit()
        self.stateChanged.emit()
        self.progressed.emit()

    def _tell_progress(self) -> None:
        """Let every tab show how far the training is."""
        stepped, stage = self.training.stepped, self.training.stage
        if not self.is_busy:
            self._context.ongoingChanged.emit(None)
        elif stepped is not None:
            text, left_s = self.tr("Training: {0} steps").format(stepped.step), stepped.left_s
            share: float | None = stepped.progress
            if left_s is not None:
                share = stepped.seconds / max(1e-9, stepped.seconds + left_s)
            self._context.ongoingChanged.emit(Ongoing(text, share, stepped.seconds, left_s))
        elif stage is not None:
            text = self.tr("Training: {0}").format(self._context.localized(stage.stage))
            elapsed_s, longest_s = self.training.elapsed_s, self.training.longest_s
            share, left_s = stage.done / stage.total if stage.total > 0 else None, None
            if longest_s is not None:  # one bar for all stages: each has its own on the page
                share, left_s = min(1.0, elapsed_s / longest_s), max(0.0, longest_s - elapsed_s)
            self._context.ongoingChanged.emit(Ongoing(text, share, elapsed_s, left_s))

    def _tell_data_set(self) -> None:
        if self.card is not None:
            self._context.note(data_set=self.card.folder)

    def _take_loss(self, lost: ProcessEnded) -> None:
        was, self.phase, self.is_paused = self.phase, Phase.IDLE, False
        self.training.n_first_looks, self.training.stepped, self.cuda = 0, None, None
        if was in BUSY:
            self.training.ended = Ended("failed")
        self.check_output_folder()
        if was is not Phase.IDLE:
            why = (
                self.tr("the system ended it, mostly because memory ran out")
                if lost.is_killed
                else self.tr("exit status {0}").format(lost.status)
            )
            advice = (
                self.tr("Close other programs, and go on from the last state.")
                if self.standing.is_interrupted
                else self.tr("Close other programs, or ask for less, and try again.")
            )
            self._context.say(
                Severity.ERROR, self.tr("The process that trains has ended ({0}). {1}").format(why, advice)
            )
        self.placeChanged.emit()
        self.stateChanged.emit()
        self.viewAnswered.emit(None)

    def _say_error(self, error: BaseException) -> None:
        if isinstance(error, (GroundStationError, OSError)):
            self._context.say(Severity.ERROR, self._context.localized(str(error)))
        else:
            text = self.tr("Training: Reflight failed where it should not ({0}: {1}); please report it")
            self._context.say(Severity.ERROR, text.format(type(error).__name__, error))
