"""The job bar: what runs, how far it is, one time, and a button to cancel; what waits behind it."""

from __future__ import annotations

import time

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QMenu,
    QProgressBar,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext, Message, Ongoing
from groundstation.gui.widgets.scrolling import ShortText, severity_words
from groundstation.services.jobs.runner import JobProgress
from groundstation.services.units import minutes_text

SHOW_AFTER_MS = 150
"""Shorter jobs come and go without the bar flashing up."""

CLOCK_MS = 1000
"""Its time goes on by itself: a job that is silent for a minute has not stood still at its first second."""


class JobBar(QWidget):
    """Progress of the running job; hidden while nothing runs."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._ongoing: Ongoing | None = None
        self._event: JobProgress | None = None
        self._heard_s = 0.0
        self._label, self._bar, self._left = ShortText(), QProgressBar(), QLabel()
        self._queue = QToolButton()
        self._queue.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self._queue.setMenu(QMenu(self))
        self._queue.menu().aboutToShow.connect(self._list_queue)
        self._cancel = QPushButton(self.tr("Cancel"))
        self._cancel.setToolTip(self.tr("Throw the running job away"))
        self._cancel.clicked.connect(self.cancel_running)
        self._bar.setMinimumWidth(60)
        self._label.setMinimumWidth(120)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 2, 6, 2)
        for widget, stretch in ((self._label, 2), (self._bar, 3), (self._left, 1), (self._queue, 0), (self._cancel, 0)):
            layout.addWidget(widget, stretch)
        self._delay = QTimer(self)
        self._delay.setSingleShot(True)
        self._delay.setInterval(SHOW_AFTER_MS)
        self._delay.timeout.connect(self._show_now)
        self._clock = QTimer(self)
        self._clock.setInterval(CLOCK_MS)
        self._clock.timeout.connect(self._show_time)
        context.jobsChanged.connect(self._update)
        context.bridge.progressed.connect(self._show_progress)
        context.ongoingChanged.connect(self._ongoing_changed)
        self._show_contents(False)

    def cancel_running(self) -> None:
        """Cancel the job that runs."""
        jobs = self._context.jobs()
        if jobs:
            self._label.setText(self.tr("{0}: cancelling ...").format(jobs[0].name))
            self._context.cancel(jobs[0])

    def _update(self) -> None:
        jobs = self._context.jobs()
        if not jobs:
            self._delay.stop()
            self._clock.stop()
            self._show_contents(False)
            self._show_ongoing()
            return
        self._queue.setText(self.tr("{0} waiting").format(len(jobs) - 1))
        if self._shows_job:
            self._queue.setVisible(len(jobs) > 1)
            self._show_job()
        elif not self._delay.isActive():
            self._delay.start()

    @property
    def _shows_job(self) -> bool:
        """Whether a job stands in the bar, which alone can be cancelled there."""
        return not self._cancel.isHidden()

    def _show_job(self) -> None:
        """Show the job that runs, as far as it has told of itself."""
        job, event = self._context.jobs()[0], self._event
        if event is not None and event.job_id == job.id:
            self._show_event(event)
            return
        self._label.setText(job.name)
        self._bar.setRange(0, 0)
        self._left.clear()

    def _ongoing_changed(self, ongoing: Ongoing | None) -> None:
        """Keep what goes on beside the jobs, and show it while there are none."""
        was_shown, self._ongoing = self._ongoing is not None, ongoing
        if not self._shows_job:
            if was_shown and ongoing is None:
                self._show_contents(False)
            self._show_ongoing()

    def _show_ongoing(self) -> None:
        ongoing = self._ongoing
        if ongoing is None:
            return
        self._label.setText(ongoing.text)
        self._bar.setRange(0, 1000 if ongoing.share is not None else 0)
        self._bar.setValue(round(1000 * (ongoing.share or 0.0)))
        self._say_time(ongoing.elapsed_s, ongoing.remaining_s, self.tr("{0} left"))
        for widget in (self._label, self._bar, self._left):
            widget.setVisible(True)
        self._hide_cancel()
        self.setVisible(True)

    def _hide_cancel(self) -> None:
        """Hide it, and let nothing have the keyboard: Qt would hand that on to Undo, which the next Space presses."""
        self._cancel.clearFocus()
        self._cancel.hide()

    def _say_time(self, elapsed_s: float, remaining_s: float | None, left: str) -> None:
        """One time: how long it will take, or, where nobody knows that, how long it has taken."""
        if remaining_s is None:
            self._left.setText(self.tr("{0} so far").format(minutes_text(elapsed_s)))
        else:
            self._left.setText(left.format(minutes_text(remaining_s)))

    def _show_now(self) -> None:
        if self._context.jobs():
            self._show_job()
            self._show_contents(True)
            self._clock.start()

    def _show_contents(self, visible: bool) -> None:
        if not visible:
            self._hide_cancel()
        for widget in (self._label, self._bar, self._left, self._cancel):
            widget.setVisible(visible)
        self._queue.setVisible(visible and len(self._context.jobs()) > 1)
        self.setVisible(visible)

    def _show_progress(self, event: JobProgress) -> None:
        jobs = self._context.jobs()
        if not jobs or jobs[0].id != event.job_id or jobs[0].cancel_requested:
            return
        self._event, self._heard_s = event, time.perf_counter()
        if self._shows_job:
            self._show_event(event)

    def _show_event(self, event: JobProgress) -> None:
        self._label.setText(f"{event.name}: {self._context.localized(event.stage)}")
        self._bar.setRange(0, 1000 if event.total > 0 else 0)
        if event.total > 0:
            self._bar.setValue(int(1000 * min(1.0, event.done / event.total)))
        self._show_time()

    def _show_time(self) -> None:
        """How long the whole takes, nobody knows; of a step it can be estimated."""
        event, jobs = self._event, self._context.jobs()
        if event is None or not jobs or event.job_id != jobs[0].id:
            return
        since_s = time.perf_counter() - self._heard_s
        # An estimate that has run out says nothing.
        has_estimate = event.remaining_s is not None and event.remaining_s >= since_s
        remaining_s = event.remaining_s - since_s if event.remaining_s is not None and has_estimate else None
        self._say_time(event.elapsed_s + since_s, remaining_s, self.tr("this step: {0} left"))

    def _list_queue(self) -> None:
        menu = self._queue.menu()
        menu.clear()
        for job in self._context.jobs()[1:]:
            action = menu.addAction(self.tr("Cancel: {0}").format(job.name))
            action.triggered.connect(lambda _checked=False, job=job: self._context.cancel(job))


class DialogFoot(QWidget):
    """The job bar and the last message, for dialogs that lie over those of the window."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.job_bar, self._text = JobBar(context), ShortText()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._text)
        layout.addWidget(self.job_bar)
        self._context = context
        context.messageShown.connect(self._show)

    def text(self) -> str:
        """What was told last since the dialog has been open."""
        return self._text.text()

    def _show(self, message: Message) -> None:
        self._text.setText(f"{severity_words()[message.severity]}: {self._context.localized(message.text)}")
