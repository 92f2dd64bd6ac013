"""The first window: open a site, see it in 3-D, plan with progress and cancel, check, export.

It holds no domain decisions: every action calls a use case of `groundstation.services` on a job, and shows its events.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QCloseEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QFileDialog,
    QLabel,
    QMainWindow,
    QPlainTextEdit,
    QProgressBar,
    QPushButton,
    QToolBar,
)

from groundstation.gui.job_bridge import JobBridge
from groundstation.gui.plan_form import PlanForm
from groundstation.gui.quality_chart import QualityChart
from groundstation.gui.site_view import SiteView
from groundstation.services.jobs import (
    Job,
    JobContext,
    JobImproved,
    JobProgress,
    JobRunner,
    JobState,
    JobStateChanged,
)
from groundstation.services.missions import export_plan
from groundstation.services.planning import check_files, plan_site
from missions.model import FileFormat
from planning.findings import Severity, is_flyable
from planning.planner import Planned
from planning.scenes import SCENES, write_scene
from planning.site_file import read_site

MISSION_FILTERS = {
    "DJI (*.kmz)": FileFormat.DJI_KMZ,
    "QGroundControl (*.plan)": FileFormat.MAVLINK_PLAN,
    "Waypoints (*.waypoints)": FileFormat.MAVLINK_WPL,
    "KML (*.kml)": FileFormat.KML,
    "CSV (*.csv)": FileFormat.CSV,
}


SIDE_WIDTH_PX = 380
"""Widest that the form and the chart become: the rest of the width is for the site."""


class MainWindow(QMainWindow):
    """One site, one plan, one job at a time."""

    def __init__(self, runner: JobRunner) -> None:
        super().__init__()
        self.setWindowTitle("Reflight")
        self._runner = runner
        self._bridge = JobBridge(runner, self)
        self._scratch = tempfile.TemporaryDirectory(prefix="reflight-")
        self._site_path: Path | None = None
        self._plan_path: Path | None = None
        self._job: Job[Any] | None = None
        self._when_done: Callable[[Any], None] | None = None
        self._view = SiteView(self)
        self.setCentralWidget(self._view)
        self._form = PlanForm()
        self._chart = QualityChart()
        self._messages = QPlainTextEdit()
        self._messages.setReadOnly(True)
        self._messages.setMaximumBlockCount(2000)
        self._make_actions()
        self._make_docks()
        self._make_job_bar()
        self._bridge.state_changed.connect(self._show_state)
        self._bridge.progressed.connect(self._show_progress)
        self._bridge.improved.connect(self._show_improvement)
        self._update_actions()

    def _make_actions(self) -> None:
        bar = QToolBar(self.tr("Main"), self)
        bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self.addToolBar(bar)

        def action(text: str, shortcut: str, slot: Callable[[], None]) -> QAction:
            made = QAction(text, self)
            made.setShortcut(shortcut)
            made.triggered.connect(lambda _checked=False: slot())
            bar.addAction(made)
            return made

        action(self.tr("Open site..."), "Ctrl+O", self._choose_site)
        action(self.tr("Bundled site"), "Ctrl+B", self._open_bundled)
        self._plan_action = action(self.tr("Plan"), "Ctrl+P", self.plan)
        self._check_action = action(self.tr("Check"), "Ctrl+K", self.check)
        self._export_action = action(self.tr("Export..."), "Ctrl+E", self._choose_export)

    def _make_docks(self) -> None:
        left, bottom = Qt.DockWidgetArea.LeftDockWidgetArea, Qt.DockWidgetArea.BottomDockWidgetArea
        docks = []
        for title, widget, area in (
            (self.tr("Plan for"), self._form, left),
            (self.tr("Quality against time"), self._chart, left),
            (self.tr("Messages"), self._messages, bottom),
        ):
            dock = QDockWidget(title, self)
            dock.setObjectName(title)
            dock.setWidget(widget)
            self.addDockWidget(area, dock)
            docks.append(dock)
        self.setCorner(Qt.Corner.BottomLeftCorner, left)
        for widget in (self._form, self._chart):
            widget.setMaximumWidth(SIDE_WIDTH_PX)
        self.resizeDocks(docks[2:], [150], Qt.Orientation.Vertical)

    def _make_job_bar(self) -> None:
        self._stage, self._bar = QLabel(), QProgressBar()
        self._enough = QPushButton(self.tr("Good enough, stop here"))
        self._cancel = QPushButton(self.tr("Cancel"))
        self._enough.clicked.connect(self._stop_here)
        self._cancel.clicked.connect(self._cancel_job)
        for widget in (self._stage, self._bar, self._enough, self._cancel):
            self.statusBar().addPermanentWidget(widget)

    def open_site(self, path: Path) -> None:
        """Read a site and show it."""

        def opened(model: Any) -> None:
            self._site_path, self._plan_path = path, None
            self._view.show_site(model)
            site = model.site
            self._say(self.tr("{0}: {1} panels on {2} facades").format(site.name, site.n_panels, len(site.facades)))

        self._start(self.tr("Open site"), lambda _context: read_site(path), opened)

    def plan(self) -> None:
        """Plan the site that is open, with what the form says."""
        if self._site_path is None:
            return
        site_path, request = self._site_path, self._form.value()
        out = Path(self._scratch.name) / "window.plan.json"
        self._chart.clear_points()

        def work(context: JobContext) -> Planned:
            return plan_site(site_path, request, out, stop=context.stop, trace=context.trace, monitor=context)

        def planned(result: Planned) -> None:
            self._plan_path = out
            self._view.show_plan(result.plan)
            self._chart.set_bound(result.plan.coverage.reachable_upper_bound)
            self._say_plan(result)

        self._start(self.tr("Plan"), work, planned)

    def check(self) -> None:
        """Check the plan at hand."""
        if self._site_path is None or self._plan_path is None:
            return
        site_path, plan_path = self._site_path, self._plan_path

        def checked(findings: Any) -> None:
            for finding in findings:
                if finding.severity is not Severity.OK:
                    self._say(f"{finding.severity}: {finding.message}")
            kept = sum(finding.severity is Severity.OK for finding in findings)
            verdict = self.tr("ready to fly") if is_flyable(findings) else self.tr("NOT ready to fly")
            self._say(self.tr("{0} of {1} rules kept: {2}").format(kept, len(findings), verdict))

        self._start(self.tr("Check"), lambda context: check_files(plan_path, site_path, context), checked)

    def export(self, path: Path, file_format: FileFormat) -> None:
        """Write the plan at hand as mission files."""
        if self._site_path is None or self._plan_path is None:
            return
        site_path, plan_path = self._site_path, self._plan_path

        def exported(result: Any) -> None:
            paths, findings = result
            for finding in findings:
                if finding.severity is not Severity.OK:
                    self._say(f"{finding.severity}: {finding.message}")
            self._say(self.tr("written: {0}").format(", ".join(str(written) for written in paths)))

        self._start(self.tr("Export"), lambda _context: export_plan(plan_path, file_format, path, site_path), exported)

    def messages(self) -> str:
        """All messages so far."""
        return self._messages.toPlainText()

    def form(self) -> PlanForm:
        """The form for what is wanted."""
        return self._form

    def view(self) -> SiteView:
        """The 3-D view."""
        return self._view

    def is_busy(self) -> bool:
        """Whether a job is running."""
        return self._job is not None

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Cancel what runs, then go."""
        self._cancel_job()
        if self._job is not None:
            self._job.wait(10.0)
        self._bridge.close()
        self._view.close_view()
        self._scratch.cleanup()
        super().closeEvent(event)

    def _choose_site(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, self.tr("Open site"), "", self.tr("Sites (*.json)"))
        if name:
            self.open_site(Path(name))

    def _open_bundled(self) -> None:
        from PySide6.QtWidgets import QInputDialog

        name, ok = QInputDialog.getItem(self, self.tr("Bundled site"), self.tr("Site"), list(SCENES), 0, False)
        if ok:
            self.open_site(write_scene(name, Path(self._scratch.name)))

    def _choose_export(self) -> None:
        name, chosen = QFileDialog.getSaveFileName(self, self.tr("Export"), "", ";;".join(MISSION_FILTERS))
        if name:
            self.export(Path(name), MISSION_FILTERS[chosen])

    def _start(self, name: str, work: Callable[[JobContext], Any], when_done: Callable[[Any], None]) -> None:
        if self._job is not None:
            self._say(self.tr("Wait for the running job, or cancel it first."))
            return
        self._when_done = when_done
        self._job = self._runner.submit(name, work)
        self._update_actions()

    def _stop_here(self) -> None:
        if self._job is not None:
            self._job.stop()

    def _cancel_job(self) -> None:
        if self._job is not None:
            self._runner.cancel(self._job)

    def _show_state(self, event: JobStateChanged) -> None:
        if self._job is None or event.job_id != self._job.id:
            return
        if event.state in (JobState.QUEUED, JobState.RUNNING):
            return
        done, self._job, self._when_done = self._when_done, None, None
        self._stage.clear()
        self._bar.setRange(0, 1)
        self._bar.setValue(0)
        if event.state is JobState.SUCCEEDED and done is not None:
            done(event.result)
        elif event.state is JobState.FAILED:
            self._say(self.tr("{0} failed: {1}").format(event.name, event.error))
        elif event.state is JobState.CANCELLED:
            self._say(self.tr("{0} cancelled").format(event.name))
        self._update_actions()

    def _show_progress(self, event: JobProgress) -> None:
        left = "" if event.remaining_s is None else self.tr(", {0:.0f} s left").format(event.remaining_s)
        self._stage.setText(f"{event.name}: {event.stage}{left}")
        self._bar.setRange(0, 1000 if event.total > 0 else 0)
        if event.total > 0:
            self._bar.setValue(int(1000 * min(1.0, event.done / event.total)))

    def _show_improvement(self, event: JobImproved) -> None:
        self._chart.add_point(event.point)

    def _say_plan(self, planned: Planned) -> None:
        plan, coverage = planned.plan, planned.plan.coverage
        self._say(
            self.tr("{0} views, sorties: {1}, {2:.1f} min; covered {3} of at most {4} reachable sections").format(
                len(plan.viewpoints),
                len(plan.sorties),
                plan.duration_s / 60.0,
                coverage.covered,
                coverage.reachable_upper_bound,
            )
        )
        for decision in plan.effects:
            self._say(str(decision))
        for finding in planned.findings:
            self._say(f"{finding.severity}: {finding.message}")

    def _say(self, text: str) -> None:
        self._messages.appendPlainText(text)

    def _update_actions(self) -> None:
        idle = self._job is None
        self._plan_action.setEnabled(idle and self._site_path is not None)
        self._check_action.setEnabled(idle and self._plan_path is not None)
        self._export_action.setEnabled(idle and self._plan_path is not None)
        for widget in (self._bar, self._enough, self._cancel):
            widget.setVisible(not idle)
