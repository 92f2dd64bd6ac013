"""What the Reconstruct tab works on: a data set, the training on it, and the process that trains and shows models."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum, auto
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.reconstruct.folder_controller import FolderController
from groundstation.services.jobs.channel import Lost
from groundstation.services.reconstruct.curves import ThinCurve
from groundstation.services.reconstruct.messages import (
    AskScene,
    BreakOff,
    Chosen,
    Devices,
    Ended,
    Look,
    Measured,
    ModelProcess,
    Pause,
    PhotoError,
    Seen,
    Stage,
    Stepped,
    Stop,
    Subject,
    Train,
    WatchErrors,
)
from planning.base.effects import Decision
from planning.base.errors import GroundStationError
from planning.base.findings import Severity

# What is known of the training that runs, or ran last.


@dataclass(slots=True, eq=False)
class ActiveTraining:
    """A training.

    Parameters
    ----------
    dataset, out
        Folders of what is learned from, and of the model.
    quality
        PSNR, dB, of unseen views by seconds.
    terms
        Of the loss by seconds.
    """

    dataset: Path = field(default_factory=Path)
    out: Path = field(default_factory=Path)
    stage: Stage | None = None
    stepped: Stepped | None = None
    ended: Ended | None = None
    quality: ThinCurve = field(default_factory=ThinCurve)
    terms: dict[str, ThinCurve] = field(default_factory=dict)

    @property
    def has_model(self) -> bool:
        """Whether there is a model of it to look at."""
        return self.stepped is not None or (self.ended is not None and self.ended.outcome == "done")

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
    IDLE -> PREPARING -> TRAINING -> (SETTLING ->) IDLE       a training, to its end or stopped
    PREPARING, TRAINING, SETTLING -> ENDING -> IDLE           broken off; its state is kept
    """

    IDLE = auto()
    ASKING = auto()
    PREPARING = auto()
    TRAINING = auto()
    SETTLING = auto()
    ENDING = auto()


BUSY = frozenset({Phase.PREPARING, Phase.TRAINING, Phase.SETTLING, Phase.ENDING})


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
    seen(Seen)
        A picture came.
    """

    progressed = Signal()
    lightChanged = Signal()  # noqa: N815
    errorsChanged = Signal()  # noqa: N815
    seen = Signal(object)
    _came = Signal(object)

    def __init__(self, workspace: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(workspace, parent)
        self._process = ModelProcess(self._came.emit)
        self._came.connect(self._take)
        self.dataSetChanged.connect(self._forget_scene)
        self.cuda: tuple[str, ...] | None = None
        self.phase, self.is_paused = Phase.IDLE, False
        self.training = ActiveTraining()
        self.light, self.decisions = "", tuple[Decision, ...]()
        self.errors: dict[str, float] = {}
        self.errors_of: Subject | None = None
        workspace.count_as_busy(lambda: self.is_busy)

    @classmethod
    def of(cls, workspace: ApplicationContext) -> ReconstructController:
        """The one of a workspace: it stays when the window is made anew."""
        found = workspace.findChild(ReconstructController)
        return cls(workspace, workspace) if found is None else found

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
        wish = self.choice.wish(known.limit_bytes if known.is_reduced else None)
        self.training, self.is_paused = ActiveTraining(card.folder, self.out), False
        if not resume:
            self.light, self.decisions = "", ()
        self._to(Phase.PREPARING)
        self._process.send(Train(card.folder, self.out, wish, resume))
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
        self._process.send(AskScene(card.folder, replace(self.choice, light="auto").wish(known.limit_bytes)))

    def pause(self, is_on: bool) -> None:
        """Let the training wait, or go on."""
        if self.phase in (Phase.PREPARING, Phase.TRAINING):
            self.is_paused = is_on
            self._process.send(Pause(is_on))
            self.stateChanged.emit()

    def stop(self) -> None:
        """Good enough: settle, and write the model."""
        if self.phase in (Phase.PREPARING, Phase.TRAINING):
            self.is_paused = False
            self._process.send(Stop())
            self._to(Phase.SETTLING)

    def break_off(self) -> None:
        """End now; the state is kept."""
        if self.phase in BUSY or self.phase is Phase.ASKING:
            self.is_paused = False
            self._process.send(BreakOff())
            self._to(Phase.ENDING if self.phase in BUSY else Phase.ASKING)

    def look(self, look: Look) -> None:
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
            case Seen():
                self.seen.emit(message)
            case Stage():
                self.training.stage = message
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
            case Devices(cuda):
                self.cuda = cuda
                self.stateChanged.emit()
            case Ended():
                self._take_end(message)
            case Lost():
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
        self.look_at_out()
        if ended.outcome == "kept" and was in BUSY:
            words = (
                self.tr("The training was cancelled; resume it whenever you like.")
                if self.standing.is_interrupted
                else self.tr("The training was cancelled before there was anything to keep.")
            )
            self._workspace.say(Severity.NOTE, words)
        elif ended.outcome == "done" and was in BUSY:
            self._workspace.say(Severity.NOTE, self.tr("The model is written: {0}").format(self.out))
            self.watch_errors(TRAINING)
        self.placeChanged.emit()
        self.stateChanged.emit()
        self.progressed.emit()

    def _take_loss(self, lost: Lost) -> None:
        was, self.phase, self.is_paused = self.phase, Phase.IDLE, False
        self.training.stepped, self.cuda = None, None
        if was in BUSY:
            self.training.ended = Ended("failed")
        self.look_at_out()
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
            self._workspace.say(
                Severity.ERROR, self.tr("The process that trains has ended ({0}). {1}").format(why, advice)
            )
        self.placeChanged.emit()
        self.stateChanged.emit()
        self.seen.emit(None)

    def _say_error(self, error: BaseException) -> None:
        if isinstance(error, (GroundStationError, OSError)):
            self._workspace.say(Severity.ERROR, self._workspace.words(str(error)))
        else:
            text = self.tr("Training: Reflight failed where it should not ({0}: {1}); please report it")
            self._workspace.say(Severity.ERROR, text.format(type(error).__name__, error))
