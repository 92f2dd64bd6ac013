"""The job bar: what runs, how far it is, how long it will take, and a button to cancel; what waits behind it."""

from __future__ import annotations

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

from groundstation.gui.application.context import ApplicationContext, Message
from groundstation.gui.widgets.scrolling import ShortText, severity_words
from groundstation.services.jobs.runner import JobProgress

SHOW_AFTER_MS = 150
"""Shorter jobs come and go without the bar flashing up."""


class JobBar(QWidget):
    """Progress of the running job; hidden while nothing runs."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
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
        context.jobsChanged.connect(self._update)
        context.bridge.progressed.connect(self._show_progress)
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
            self._show_contents(False)
            return
        self._label.setText(jobs[0].name)
        self._bar.setRange(0, 0)
        self._left.clear()
        self._queue.setText(self.tr("{0} waiting").format(len(jobs) - 1))
        if not self._delay.isActive() and self.isHidden():
            self._delay.start()
        else:
            self._queue.setVisible(len(jobs) > 1)

    def _show_now(self) -> None:
        self._show_contents(bool(self._context.jobs()))

    def _show_contents(self, visible: bool) -> None:
        for widget in (self._label, self._bar, self._left, self._cancel):
            widget.setVisible(visible)
        self._queue.setVisible(visible and len(self._context.jobs()) > 1)
        self.setVisible(visible)

    def _show_progress(self, event: JobProgress) -> None:
        jobs = self._context.jobs()
        if not jobs or jobs[0].id != event.job_id or jobs[0].cancel_requested:
            return
        self._label.setText(f"{event.name}: {self._context.localized(event.stage)}")
        self._bar.setRange(0, 1000 if event.total > 0 else 0)
        if event.total > 0:
            self._bar.setValue(int(1000 * min(1.0, event.done / event.total)))
        # How long the whole takes, nobody knows; of a step it can be estimated.
        if event.remaining_s is None:
            self._left.setText(self.tr("{0:.0f} s so far").format(event.elapsed_s))
        else:
            self._left.setText(self.tr("this step: {0:.0f} s left").format(event.remaining_s))

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
        context.messageShown.connect(self._show)

    def text(self) -> str:
        """What was told last since the dialog has been open."""
        return self._text.text()

    def _show(self, message: Message) -> None:
        self._text.setText(f"{severity_words()[message.severity]}: {message.text}")
