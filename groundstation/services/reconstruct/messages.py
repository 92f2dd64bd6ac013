"""The process of models as the window sees it, and what they say to each other; all of that is pickled."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from groundstation.services.jobs.channel import NICENESS, Listener, Process
from planning.base.effects import Decision
from reconstruction.base.cameras import PosedPhoto
from reconstruction.training.parameters import TrainRequest

# The process that trains a model and shows models, as the window sees it: torch never touches the window's own.
#
# It is asked and answers by the messages below, through `jobs/channel.py`. A model in training is shown by
# the process that trains it, between two steps, so that it need not be copied; memory that runs out ends that process
# and not the window. Where nobody writes to it any more, a training breaks off, keeps its state on the disk, and it
# ends.

SERVER = "groundstation.services.reconstruct.server"


class ModelProcess:
    """The process, seen from here; it starts with the first message.

    Parameters
    ----------
    listener
        Called with every message that comes, on a thread that reads them; where the process ends, with `ProcessEnded`.
    niceness
        By which it leaves the processor to others, the window first of all; not on Windows.
    """

    def __init__(self, listener: Listener, niceness: int = NICENESS) -> None:
        self._listener = listener
        self._niceness = niceness
        self._process: Process | None = None
        self._lock = threading.Lock()
        self._is_closed = False

    @property
    def is_running(self) -> bool:
        """Whether it has been started, and has not ended."""
        return self._process is not None and self._process.is_running

    def send(self, message: Any) -> None:
        """Send a message; where the process has ended, which `ProcessEnded` says, a new one is started."""
        if self._is_closed:
            return
        with self._lock:
            if self._process is None or not self._process.is_running:
                self._let_go()
                self._process = Process(SERVER, self._tell, self._niceness)
            self._process.send(message)

    def close(self) -> None:
        """Send and hear nothing more. A training that runs keeps its state by itself; nobody waits for it."""
        self._is_closed = True
        self._let_go()

    def end(self) -> None:
        """End it at once, whatever it does."""
        process = self._process
        self.close()
        if process is not None:
            process.end()

    def _let_go(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.close_input()

    def _tell(self, message: Any) -> None:
        if not self._is_closed:
            self._listener(message)


SubjectKind = Literal["training", "photo", "model"]

Phase = Literal["preparing", "training", "paused", "settling"]
"""Of a training: what comes before the joint one, that, a pause of either, and the end of one that was stopped."""

Outcome = Literal["done", "kept", "failed"]
"""Of a training: there is a model; it was broken off and can be gone on with; an error ended it."""


@dataclass(frozen=True, slots=True)
class Subject:
    """What is looked at.

    Parameters
    ----------
    kind
        The model in training (or trained last), a photo, or a finished model.
    folder
        Of the finished model, or of the photo's data set.
    name
        Of the photo.
    """

    kind: SubjectKind
    folder: Path | None = None
    name: str = ""


@dataclass(frozen=True, slots=True)
class Section:
    """A plane that cuts a model: what lies beyond it is not shown.

    Parameters
    ----------
    axis
        0: towards the east, 1: the north, 2: upwards.
    at_m
        Where on that axis, ENU.
    is_above
        Whether what is further along the axis is left out; else what is before.
    """

    axis: int
    at_m: float
    is_above: bool = True


Tints = tuple[tuple[int, tuple[int, int, int]], ...]
"""Colours of panels, red, green, blue, by their numbers."""


# To the process


@dataclass(frozen=True, slots=True)
class Train:
    """Train a model of a data set into a folder, or go on with what was interrupted there."""

    dataset: Path
    out: Path
    request: TrainRequest
    resume: bool = False


@dataclass(frozen=True, slots=True)
class AskScene:
    """Which model of mirrored light the photos call for."""

    dataset: Path
    request: TrainRequest


@dataclass(frozen=True, slots=True)
class Pause:
    """Wait, or go on."""

    is_on: bool


@dataclass(frozen=True, slots=True)
class Stop:
    """It is good enough: settle, and keep what it is then."""


@dataclass(frozen=True, slots=True)
class CancelTraining:
    """End now; what was reached can be gone on with."""


@dataclass(frozen=True, slots=True, eq=False)
class ViewRequest:
    """Show something from somewhere. Of two with one `place`, only the newer is answered where neither was yet.

    Parameters
    ----------
    place
        Of the window, that the picture is for.
    number
        Rises from look to look.
    camera
        Straight, of the picture's size.
    layer
        `picture`, or one of `LAYERS`.
    exposed_as
        Name of a photo whose exposure the picture shall have; "" for that of no photo.
    tints
        Of panels of a finished model.
    section
        That cuts a finished model.
    is_quick
        Whether splats of a large finished model that are finer than pixels may be drawn as one.
    drawn_by
        The graphics card or the processor; `auto` for what is faster.
    """

    place: str
    number: int
    subject: Subject
    camera: PosedPhoto
    layer: str = "picture"
    exposed_as: str = ""
    tints: Tints = ()
    section: Section | None = None
    is_quick: bool = False
    drawn_by: Literal["auto", "cpu", "gpu"] = "auto"


@dataclass(frozen=True, slots=True, eq=False)
class Probe:
    """What is at a place in a picture of a finished model; of two with one `place`, the newer alone is answered.

    Parameters
    ----------
    at_px
        Column and row, continuous, in the picture of `camera`.
    """

    place: str
    number: int
    subject: Subject
    camera: PosedPhoto
    at_px: tuple[float, float]
    section: Section | None = None


@dataclass(frozen=True, slots=True)
class Organise:
    """Make a scene of objects of the trained model in a folder, beside it, where there is none yet or an older one."""

    folder: Path


@dataclass(frozen=True, slots=True)
class WatchErrors:
    """Tell how well a model shows each photo of a data set, in turn; None: tell no more."""

    subject: Subject | None
    dataset: Path


# From the process


@dataclass(frozen=True, slots=True)
class Devices:
    """What there is to compute on besides the processor: what torch finds, and graphics cards by WebGPU."""

    cuda: tuple[str, ...]
    cards: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Stage:
    """`done` of `total` parts of a stage are finished; `total` 0: not known."""

    stage: str
    done: float
    total: float


@dataclass(frozen=True, slots=True)
class FirstLook:
    """There is a model to look at before the first step, or another one that shows more."""


@dataclass(frozen=True, slots=True)
class Stepped:
    """Where a training is; `terms` of the last step's loss, `left_s` None where nobody knows yet."""

    phase: Phase
    step: int
    seconds: float
    progress: float
    left_s: float | None
    n_splats: int
    terms: dict[str, float]


@dataclass(frozen=True, slots=True)
class Measured:
    """PSNR, dB, of held-out views after so many seconds."""

    seconds: float
    psnr_db: float


@dataclass(frozen=True, slots=True)
class Chosen:
    """The model of mirrored light, and why; "" where light is the splats' own."""

    light: str
    decisions: tuple[Decision, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ViewAnswer:
    """The answer to a look.

    Parameters
    ----------
    picture
        Red, green, blue, shape (h, w, 3); None where `problem` says why.
    scale
        Values that the ends of a layer's colours stand for; None where its colours are its values.
    depth_m
        Of what is in the picture's middle, along the optical axis; None where nothing is, or that is not known.
    seconds
        That it took.
    by_card
        Whether the graphics card drew it; None for photos.
    drawn_by
        Why that, or the processor; "" where it is not decided yet.
    lost
        What became of the graphics card while it drew this; "" where it did, or did not draw.
    """

    look: ViewRequest
    picture: NDArray[np.uint8] | None
    scale: tuple[float, float] | None = None
    depth_m: float | None = None
    seconds: float = 0.0
    problem: str = ""
    by_card: bool | None = None
    drawn_by: str = ""
    lost: str = ""


@dataclass(frozen=True, slots=True)
class Probed:
    """The answer to a probe.

    Parameters
    ----------
    panel
        Its number in the model; None where there is none.
    point_enu_m
        None where nothing is.
    """

    probe: Probe
    panel: int | None
    point_enu_m: tuple[float, float, float] | None
    problem: str = ""


@dataclass(frozen=True, slots=True)
class SceneMade:
    """The answer to `Organise`: where the scene is; or a problem."""

    asked: Organise
    folder: Path | None
    problem: str = ""


@dataclass(frozen=True, slots=True)
class PhotoError:
    """PSNR, dB, of one photo's facades as a model shows it now."""

    subject: Subject
    name: str
    psnr_db: float


@dataclass(frozen=True, slots=True)
class Ended:
    """A training ended, or asking the scene did.

    Parameters
    ----------
    summary
        As `train_summary` has it; empty where there is no model.
    """

    outcome: Outcome
    error: BaseException | None = None
    summary: dict[str, Any] | None = None
