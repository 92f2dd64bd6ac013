"""What all parts of the window share: the session as Qt signals, the thing that is selected, jobs, and messages.

Lives in the window's thread. Widgets read `document`, change it through `change`, and hear of changes through signals;
work that takes longer than a blink is given to `start`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from PySide6.QtCore import QObject, Signal

from groundstation.gui.application.translate import translated, with_fields
from groundstation.services.jobs.runner import (
    ENDED,
    Job,
    JobBounded,
    JobContext,
    JobEvent,
    JobImproved,
    JobProgress,
    JobRunner,
    JobState,
    JobStateChanged,
)
from groundstation.services.project.document import Document, Item, exists
from groundstation.services.project.session import Session
from groundstation.services.project.steps import Milestones, undone
from groundstation.services.settings import DrawnBy
from groundstation.services.units import UnitSystem
from planning.base.errors import GroundStationError, shortened
from planning.base.findings import Severity
from planning.base.messages import Message as Template
from planning.base.plugins import new_plugin_problems

# Brings job events from worker threads to the window's thread as Qt signals.


class JobBridge(QObject):
    """Signals with the events of a job runner; they arrive in the thread this object lives in."""

    state_changed = Signal(object)
    progressed = Signal(object)
    improved = Signal(object)
    bounded = Signal(object)

    def __init__(self, runner: JobRunner, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._unsubscribe = runner.subscribe(self._forward)

    def close(self) -> None:
        """Hear nothing more."""
        self._unsubscribe()

    def _forward(self, event: JobEvent) -> None:
        # Emitted on the worker's thread: Qt queues the call for receivers that live in another one.
        if isinstance(event, JobStateChanged):
            self.state_changed.emit(event)
        elif isinstance(event, JobProgress):
            self.progressed.emit(event)
        elif isinstance(event, JobImproved):
            self.improved.emit(event)
        elif isinstance(event, JobBounded):
            self.bounded.emit(event)


Work = Callable[[JobContext], Any]
Done = Callable[[Any], None]
Failed = Callable[[BaseException], None]


@dataclass(frozen=True, slots=True)
class Message:
    """Something the user is told; with the thing it is about, where there is one.

    Parameters
    ----------
    text
        In the window's language, or what a part without Qt says: `ApplicationContext.localized` puts it into the
        language of when it is shown.
    about
        Topic of something that holds until it is settled, with dots from wide to narrow: `job.Plan`, `flight.battery`.
        Empty for what just happened.
    """

    severity: Severity
    text: str
    item: Item | None = None
    about: str = ""


@dataclass(frozen=True, slots=True)
class Ongoing:
    """Work that is no job, such as a training in its own process: the job bar shows it while no job runs.

    Parameters
    ----------
    share
        Of the whole that is done; None where that is not known.
    remaining_s
        Until its end; None where nothing says it.
    """

    text: str
    share: float | None
    elapsed_s: float
    remaining_s: float | None


@dataclass(frozen=True, slots=True)
class _Waiting:
    """What happens in the window when a job ends."""

    job: Job[Any]
    done: Done | None
    failed: Failed | None


class ApplicationContext(QObject):
    """The session for widgets.

    Signals
    -------
    documentChanged(Document, Document)
        As it was and as it is.
    selectionChanged(Item or None), lookAtRequested(Item)
        What is selected; what the 3-D view and the map should show now.
    unitsChanged(UnitSystem)
    drawnByChanged()
        What draws pictures of models was chosen anew.
    messageShown(Message), messageWithdrawn(str)
        Something was told; what was said about a topic holds no more.
    jobsChanged()
        A job was queued or ended.
    ongoingChanged(Ongoing or None)
        Work that is no job went on, or is over.
    milestonesChanged(Milestones)
        Something was done, or an edit took it back.
    takeOffPlanned(datetime)
        A time for the flight was chosen, with its zone.
    """

    documentChanged = Signal(object, object)  # noqa: N815  (Qt's own way of naming)
    selectionChanged = Signal(object)  # noqa: N815
    lookAtRequested = Signal(object)  # noqa: N815
    unitsChanged = Signal(object)  # noqa: N815
    drawnByChanged = Signal()  # noqa: N815
    messageShown = Signal(object)  # noqa: N815
    messageWithdrawn = Signal(str)  # noqa: N815
    jobsChanged = Signal()  # noqa: N815
    ongoingChanged = Signal(object)  # noqa: N815
    milestonesChanged = Signal(object)  # noqa: N815
    takeOffPlanned = Signal(object)  # noqa: N815

    def __init__(self, session: Session, runner: JobRunner, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session, self._runner = session, runner
        self._selection: Item | None = None
        self._units = UnitSystem.METRIC
        self._models_drawn_by = DrawnBy.AUTO
        self._milestones = undone(Milestones(), session.document, session.document)
        self._waiting: dict[int, _Waiting] = {}
        self._quiet: set[int] = set()
        self._busy: list[Callable[[], bool]] = []
        self.bridge = JobBridge(runner, self)
        self.bridge.state_changed.connect(self._job_changed)
        session.subscribe(self._document_changed)

    @property
    def session(self) -> Session:
        """Undo, redo, and where the project is kept."""
        return self._session

    @property
    def document(self) -> Document:
        """As it is now."""
        return self._session.document

    @property
    def selection(self) -> Item | None:
        """What is selected."""
        return self._selection

    @property
    def units(self) -> UnitSystem:
        """What lengths and speeds are shown in."""
        return self._units

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        if units is not self._units:
            self._units = units
            self.unitsChanged.emit(units)

    @property
    def models_drawn_by(self) -> DrawnBy:
        """What draws pictures of models."""
        return self._models_drawn_by

    def set_models_drawn_by(self, drawn_by: DrawnBy) -> None:
        """Let pictures of models be drawn by something else."""
        if drawn_by is not self._models_drawn_by:
            self._models_drawn_by = drawn_by
            self.drawnByChanged.emit()

    @property
    def milestones(self) -> Milestones:
        """What has happened on the way from a building to a model."""
        return self._milestones

    def note(self, **changes: Any) -> None:
        """Something happened on that way: fields of `Milestones` by name."""
        self._set_milestones(replace(self._milestones, **changes))

    def begin_anew(self) -> None:
        """Another project is open: what happened before belongs to the one before."""
        document = self.document
        self._set_milestones(undone(Milestones(flight=self._milestones.flight), document, document))

    def _set_milestones(self, milestones: Milestones) -> None:
        if milestones != self._milestones:
            self._milestones = milestones
            self.milestonesChanged.emit(milestones)

    def change(self, label: str, document: Document) -> None:
        """Take over an edit as one step that can be undone; `label` says what the user did."""
        self._session.change(label, document)

    def amend(self, document: Document) -> None:
        """Take over what is no step of its own, such as which plan is looked at."""
        self._session.amend(document)

    def select(self, item: Item | None) -> None:
        """Select a thing, or nothing."""
        if item != self._selection:
            self._selection = item
            self.selectionChanged.emit(item)

    def jump_to(self, item: Item) -> None:
        """Select a thing and bring it into view."""
        self.select(item)
        self.lookAtRequested.emit(item)

    def say(self, severity: Severity, text: str, item: Item | None = None, about: str = "") -> None:
        """Tell the user something; with a topic, it is shown until it is settled or said otherwise."""
        worded = text if isinstance(text, Template) else with_fields(text)
        self.messageShown.emit(Message(severity, shortened(worded), item, about))

    def withdraw(self, about: str) -> None:
        """What was said about a topic does not hold any more; one that ends in a dot stands for all below it."""
        self.messageWithdrawn.emit(about)

    def localized(self, text: str) -> str:
        """What a part without Qt says, an error or a finding, in the user's language and units."""
        return translated(shortened(text), self._units)

    def report_plugin_problems(self) -> None:
        """Say which plug-ins are left out of a list that was just filled, each once."""
        for problem in new_plugin_problems():
            self.say(Severity.WARNING, self.localized(str(problem)))

    def start(
        self, name: str, work: Work, when_done: Done | None = None, when_failed: Failed | None = None
    ) -> Job[Any]:
        """Queue long work.

        `work` runs on another thread and must touch neither widgets nor the session. `when_done` gets its result, in
        the window's thread. An error is shown as a message, and passed to `when_failed`; a cancelled job calls neither.
        """
        self.withdraw(f"job.{name}")
        job = self._runner.submit(name, work)
        self._waiting[job.id] = _Waiting(job, when_done, when_failed)
        self.jobsChanged.emit()
        return job

    def jobs(self) -> tuple[Job[Any], ...]:
        """Jobs that have not ended, in the order in which they run."""
        return tuple(waiting.job for waiting in self._waiting.values())

    def count_as_busy(self, is_busy: Callable[[], bool]) -> None:
        """Ask this, too, whether anything goes on: for work that is no job, and lasts as long as the context."""
        self._busy.append(is_busy)

    @property
    def is_busy(self) -> bool:
        """Whether a job has not ended, or other work goes on; nothing of the window's own may hold it up then."""
        return bool(self._waiting) or any(is_busy() for is_busy in self._busy)

    def cancel(self, job: Job[Any], *, quietly: bool = False) -> None:
        """Throw a job away, whether it runs or waits; `quietly` where the user has no part in it."""
        if quietly:
            self._quiet.add(job.id)
        self._runner.cancel(job)

    def close(self, timeout_s: float = 10.0) -> bool:
        """Cancel everything and hear nothing more; True where all jobs ended in time."""
        jobs = self.jobs()
        for job in reversed(jobs):
            self.cancel(job)
        self.bridge.close()
        # Events that Qt has queued already would reach widgets that are going.
        self._waiting.clear()
        return all(job.wait(timeout_s) for job in jobs)

    def _document_changed(self, before: Document, after: Document) -> None:
        if self._selection is not None and not exists(after, self._selection):
            self.select(None)
        self._set_milestones(undone(self._milestones, before, after))
        self.documentChanged.emit(before, after)

    def _job_changed(self, event: JobStateChanged) -> None:
        if event.state not in ENDED:
            return
        # Jobs end on another thread, so that Qt brings the event after `start` has noted the job.
        waiting = self._waiting.pop(event.job_id, None)
        if waiting is None:
            return
        self.jobsChanged.emit()
        if event.state is JobState.SUCCEEDED:
            if waiting.done is not None:
                waiting.done(event.result)
        elif event.state is JobState.CANCELLED:
            if event.job_id not in self._quiet:
                self.say(Severity.NOTE, self.tr("{0}: cancelled").format(event.name))
        elif event.error is not None:
            self._say_error(event.name, event.error)
            if waiting.failed is not None:
                waiting.failed(event.error)

    def _say_error(self, name: str, error: BaseException) -> None:
        if isinstance(error, (GroundStationError, OSError)):
            text = self.tr("{0}: {1}").format(name, self.localized(str(error)))
        else:
            text = self.tr("{0}: Reflight failed where it should not ({1}: {2}); please report it").format(
                name, type(error).__name__, error
            )
        self.say(Severity.ERROR, text, about=f"job.{name}")
