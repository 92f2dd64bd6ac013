"""What is selected, in detail: a viewpoint with all that can be done to it by hand, or a panel with its hemisphere."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QCheckBox, QLabel, QListWidget, QListWidgetItem, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import translated
from groundstation.gui.charts.hemisphere_view import HemisphereView, ShownSection
from groundstation.gui.plan.plan_controller import PlanController
from groundstation.gui.shared_view import SharedView
from groundstation.gui.widgets.inputs import Form, LengthBox, NumberBox
from groundstation.gui.widgets.scrolling import ButtonGrid
from groundstation.services.plan.editing import above_home, viewpoint_beside
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.units import UnitSystem, sampling_unit
from planning.base.findings import Severity
from planning.geo.mesh import MAX_COORDINATE_M
from planning.insight.sections import PlanInsight, SectionState
from planning.plan import ANGLE_DECIMALS, Camera, Plan, Viewpoint

# One panel in detail: its hemisphere, and for the section that is picked the views that see it or why none can.


class PanelDetail(QWidget):
    """Draws what it gets of one panel.

    Signals
    -------
    viewpointPicked(str)
        Identifier of a viewpoint in the list.
    """

    viewpointPicked = Signal(str)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._insight: PlanInsight | None = None
        self._plan: Plan | None = None
        self._panel_id: str | None = None
        self._section: int | None = None
        self._units = UnitSystem.METRIC
        self._title, self._words, self._section_words = QLabel(), QLabel(), QLabel()
        self._title.setProperty("role", "heading")
        for label in (self._words, self._section_words):
            label.setWordWrap(True)
        self._hemisphere = HemisphereView()
        self._views = QListWidget()
        self._views.setAccessibleName(self.tr("Views of the section"))
        self._views.setMinimumHeight(40)
        self._views.setMaximumHeight(130)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        for widget, stretch in (
            (self._title, 0),
            (self._words, 0),
            (self._hemisphere, 3),
            (self._section_words, 0),
            (self._views, 1),
        ):
            layout.addWidget(widget, stretch)
        self._hemisphere.sectionPicked.connect(self.pick_section)
        self._views.itemClicked.connect(lambda row: self.viewpointPicked.emit(row.data(Qt.ItemDataRole.UserRole)))
        self._show()

    def set_plan(self, insight: PlanInsight | None, plan: Plan | None) -> None:
        """Show the panel as another plan sees it."""
        if insight is not None and self._insight is not None and insight.grid != self._insight.grid:
            self._section = None
        self._insight, self._plan = insight, plan
        self._show()

    def set_panel(self, panel_id: str | None) -> None:
        """Show another panel, also once a plan that sees it is given; None for none."""
        if panel_id != self._panel_id:
            self._panel_id, self._section = panel_id, None
            self._show()

    def set_units(self, units: UnitSystem) -> None:
        """Show pixel sizes in other units."""
        self._units = units
        self._show()

    def panel_id(self) -> str | None:
        """The panel that is shown."""
        return None if self._panel is None else self._panel_id

    @property
    def _panel(self) -> int | None:
        """Number of the panel in the insight."""
        insight = self._insight
        if insight is None or self._panel_id is None or self._panel_id not in insight.panel_ids:
            return None
        return insight.panel_ids.index(self._panel_id)

    def pick_section(self, section: int | None) -> None:
        """Say who sees a section, or why nobody can."""
        self._section = section
        self._hemisphere.set_picked(section)
        self._show_section()

    def text(self) -> str:
        """Everything that is said."""
        return "\n".join(label.text() for label in (self._title, self._words, self._section_words))

    def _show(self) -> None:
        insight, panel = self._insight, self._panel
        if insight is None or panel is None:
            is_waiting = insight is None and self._panel_id is not None
            title = self.tr("Panel {0}").format(self._panel_id) if is_waiting else self.tr("No panel selected")
            self._title.setText(title)
            self._words.setText(self.tr("What a plan covers of it stands here.") if is_waiting else "")
            self._hemisphere.set_sections(30.0, ())
            self._show_section()
            return
        self._title.setText(self.tr("Panel {0}").format(self._panel_id))
        finest_m = float(insight.sampling.best_m[panel])
        covered, possible = int(insight.covered_per_panel[panel]), int(insight.possible_per_panel[panel])
        words = self.tr("{0} of {1} sections covered, {2} possible").format(covered, insight.grid.n_sections, possible)
        if np.isfinite(finest_m):
            words += self.tr("; finest pixel {0}").format(sampling_unit(self._units).text(finest_m))
        self._words.setText(words)
        sections = tuple(self._shown(panel, section) for section in range(insight.grid.n_sections))
        self._hemisphere.set_sections(insight.grid.step_deg, sections)
        self._hemisphere.set_marks(self._marks(panel))
        if self._section is not None and self._section < len(sections):
            self._hemisphere.set_picked(self._section)
        else:
            self._section = None
        self._show_section()

    def _marks(self, panel: int) -> tuple[tuple[float, float], ...]:
        """Directions of the views that cover the panel, (theta, phi) in degrees."""
        insight, plan = self._insight, self._plan
        assert insight is not None
        assert plan is not None
        seen = np.flatnonzero(insight.sections[:, panel] >= 0)
        if len(seen) == 0:
            return ()
        positions = np.array([plan.viewpoints[view].position_enu_m for view in seen])
        rays = positions - insight.frames.centroids[panel]
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        axes = (insight.frames.normals[panel], insight.frames.tangents[panel], insight.frames.bitangents[panel])
        up, right, high = (rays @ axis for axis in axes)
        theta = np.degrees(np.arccos(np.clip(up, -1.0, 1.0)))
        phi = np.degrees(np.arctan2(high, right)) % 360.0
        return tuple(zip(theta.tolist(), phi.tolist(), strict=True))

    def _shown(self, panel: int, section: int) -> ShownSection:
        insight = self._insight
        assert insight is not None
        state, n_views = insight.state(panel, section), int(insight.counts[panel, section])
        ring, sector = divmod(section, insight.grid.n_sectors)
        step = insight.grid.step_deg
        place = self.tr("{0:g} to {1:g}° from the normal, {2:g} to {3:g}° around").format(
            ring * step, (ring + 1) * step, sector * step, (sector + 1) * step
        )
        return ShownSection(state, n_views, f"{place}\n{self._state_text(state, n_views)}")

    def _state_text(self, state: SectionState, n_views: int) -> str:
        match state:
            case SectionState.COVERED:
                return self.tr("covered; views that see it: {0}").format(n_views)
            case SectionState.MISSED:
                return self.tr("could be covered, but no view of this plan does")
            case SectionState.UNREACHABLE:
                return self.tr("cannot be covered from anywhere allowed")
            case SectionState.UNDECIDED:
                return self.tr("not covered; whether it could be is not known")

    def _show_section(self) -> None:
        insight, panel, section = self._insight, self._panel, self._section
        self._views.clear()
        if insight is None or panel is None or section is None:
            has_panel = insight is not None and panel is not None
            self._section_words.setText(self.tr("Click a section to see its views.") if has_panel else "")
            return
        state = insight.state(panel, section)
        words = self._state_text(state, int(insight.counts[panel, section]))
        reasons = insight.reasons.of(panel, section)
        if state is not SectionState.COVERED and reasons:
            words += ": " + self.tr("; or ").join(translated(str(reason), self._units) for reason in reasons)
        self._section_words.setText(words)
        for view in insight.views_of(panel, section):
            row = QListWidgetItem(insight.view_ids[view])
            row.setData(Qt.ItemDataRole.UserRole, insight.view_ids[view])
            self._views.addItem(row)


# Editing one viewpoint by hand: where it is, where it looks, and whether a new plan must keep it.

NUDGE_M = 0.5


class ViewpointEditor(QWidget):
    """`value()`, `setValue()` and `valueChanged` of a viewpoint, and buttons for what concerns it as a whole.

    Signals
    -------
    valueChanged(Viewpoint)
    addRequested(), deleteRequested(), aimRequested()
        A new viewpoint beside this one; this one away; this one turned towards the selected panel.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    addRequested = Signal()  # noqa: N815
    deleteRequested = Signal()  # noqa: N815
    aimRequested = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value: Viewpoint | None = None
        self._name, self._says = QLabel(), QLabel()
        self._name.setProperty("role", "heading")
        self._name.setWordWrap(True)
        self._says.setWordWrap(True)
        self._position = tuple(LengthBox(-MAX_COORDINATE_M, MAX_COORDINATE_M, NUDGE_M, decimals=2) for _ in range(3))
        self._heading = NumberBox(-180.0, 180.0, 5.0, "°")
        self._heading.setWrapping(True)
        self._pitch = NumberBox(-90.0, 90.0, 5.0, "°")
        self._locked = QCheckBox(self.tr("Keep in the next plan"))
        self._locked.setToolTip(self.tr("Keep this viewpoint as it is when planning again"))
        self._add = QPushButton(self.tr("Add"))
        self._add.setToolTip(self.tr("A new viewpoint beside this one"))
        self._delete = QPushButton(self.tr("Delete"))
        self._aim = QPushButton(self.tr("Aim at panel"))
        self._aim.setToolTip(self.tr("Turn towards the panel that was selected last"))
        self._lay_out()
        for box in self._position:
            box.valueChanged.connect(self._edited)
        for angle in (self._heading, self._pitch):
            angle.valueChanged.connect(self._edited)
        self._locked.toggled.connect(self._edited)
        for button, signal in (
            (self._add, self.addRequested),
            (self._delete, self.deleteRequested),
            (self._aim, self.aimRequested),
        ):
            button.clicked.connect(lambda _checked=False, signal=signal: signal.emit())
        self.setValue(None)

    def _lay_out(self) -> None:
        form = Form()
        names = (self.tr("East"), self.tr("North"), self.tr("Up"), self.tr("Heading"), self.tr("Pitch"))
        for name, box in zip(names, (*self._position, self._heading, self._pitch), strict=True):
            form.addRow(name, box)
        buttons = ButtonGrid(3)
        for button in (self._aim, self._add, self._delete):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 0)
        # What an edit did must be seen without scrolling.
        for widget in (self._name, self._says):
            layout.addWidget(widget)
        layout.addLayout(form)
        layout.addLayout(buttons)
        layout.addWidget(self._locked)

    def value(self) -> Viewpoint | None:
        """The viewpoint as it is edited; None where none is shown."""
        return self._value

    def setValue(self, viewpoint: Viewpoint | None) -> None:  # noqa: N802
        """Show a viewpoint, or none."""
        self._value = viewpoint
        self._locked.setEnabled(viewpoint is not None)
        for widget in (*self._position, self._heading, self._pitch, self._delete, self._aim):
            widget.setEnabled(viewpoint is not None and not viewpoint.locked)
        self._name.setText(self.tr("No viewpoint selected") if viewpoint is None else viewpoint.id)
        if viewpoint is None:
            self._says.clear()
            return
        blockers = [QSignalBlocker(box) for box in (self._heading, self._pitch, self._locked)]
        for box, coordinate in zip(self._position, viewpoint.position_enu_m, strict=True):
            box.setValue(coordinate)
        self._heading.setValue(viewpoint.heading_deg)
        self._pitch.setValue(viewpoint.gimbal_pitch_deg)
        self._locked.setChecked(viewpoint.locked)
        del blockers

    def set_camera(self, camera: Camera) -> None:
        """Only pitches that the gimbal can do can be entered."""
        with QSignalBlocker(self._pitch):
            self._pitch.setRange(*camera.gimbal_pitch_deg)

    def set_units(self, system: UnitSystem) -> None:
        """Show positions in other units."""
        for box in self._position:
            box.set_units(system)

    def say(self, text: str, *, wrong: bool = False) -> None:
        """What the last edit did, or what is wrong with this viewpoint."""
        self._says.setText(text)
        self._says.setProperty("role", "error" if wrong else "muted")
        self._says.style().polish(self._says)

    def _edited(self) -> None:
        before = self._value
        if before is None:
            return
        x, y, z = (box.value() for box in self._position)
        heading, pitch = (
            old if box.value() == old else round(box.value(), ANGLE_DECIMALS)
            for box, old in ((self._heading, before.heading_deg), (self._pitch, before.gimbal_pitch_deg))
        )
        edited = replace(
            before,
            position_enu_m=(x, y, z),
            heading_deg=heading,
            gimbal_pitch_deg=pitch,
            locked=self._locked.isChecked(),
        )
        if edited != before:
            self._value = edited
            self.valueChanged.emit(edited)


class ViewpointPage(QWidget):
    """The editor, connected."""

    def __init__(self, context: ApplicationContext, controller: PlanController, shared_view: SharedView) -> None:
        super().__init__()
        self._context, self._controller, self._shared_view = context, controller, shared_view
        self._aim_panel = ""
        self._is_changing_tool = False
        self.editor = ViewpointEditor()
        self._move = QCheckBox(self.tr("Move in the 3-D view"))
        self._move.setToolTip(self.tr("Drag the selected viewpoint; with Shift along its line of sight; or arrow keys"))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.editor)
        layout.addWidget(self._move)
        layout.addStretch(1)
        self._connect()
        self._show_document(context.document)

    def _connect(self) -> None:
        controller, context = self._controller, self._context
        self.editor.valueChanged.connect(controller.set_viewpoint)
        self.editor.addRequested.connect(self.add_viewpoint)
        self.editor.deleteRequested.connect(self.delete_viewpoint)
        self.editor.aimRequested.connect(self._aim)
        self._move.toggled.connect(self._move_toggled)
        controller.activePlanChanged.connect(lambda _active: self._say_of_viewpoint())
        controller.refused.connect(self._refused)
        context.documentChanged.connect(self._document_changed)
        context.selectionChanged.connect(self._show_selection)
        context.unitsChanged.connect(self.set_units)
        self._shared_view.with_scene(
            lambda scene: (scene.toolFinished.connect(self._moved_in_scene), scene.toolEnded.connect(self._tool_ended))
        )

    def make_actions(self) -> tuple[QAction, ...]:
        """For the tab's menu."""
        found = []
        for text, key, slot in (
            (self.tr("Add viewpoint"), "Ctrl+Shift+A", self.add_viewpoint),
            (self.tr("Delete viewpoint"), "Ctrl+Del", self.delete_viewpoint),
            (self.tr("Keep viewpoint when planning again"), "Ctrl+L", self.toggle_lock),
            (self.tr("Move viewpoint in the 3-D view"), "Ctrl+M", self._move.toggle),
        ):
            action = QAction(text, self)
            action.setShortcut(QKeySequence(key))
            action.triggered.connect(lambda _checked=False, slot=slot: slot())
            found.append(action)
        return tuple(found)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self.editor.set_units(units)

    def _document_changed(self, _before: Document, after: Document) -> None:
        self._show_document(after)

    def _show_document(self, document: Document) -> None:
        if document.current is not None:
            self.editor.set_camera(document.current.plan.camera)
        self._show_selection(self._context.selection)

    def _show_selection(self, item: Item | None) -> None:
        entry = self._context.document.current
        if item is not None and item.kind is ItemKind.PANEL:
            self._aim_panel = item.id
            return
        viewpoint = None
        if item is not None and item.kind is ItemKind.VIEWPOINT and entry is not None:
            viewpoint = entry.viewpoint(item.id)
        if viewpoint != self.editor.value():
            self.editor.setValue(viewpoint)
        self._say_of_viewpoint()
        if self._move.isChecked():
            self._start_tool()

    def _refused(self, text: str) -> None:
        """The viewpoint is still as it was, and so are the boxes."""
        self._show_selection(self._context.selection)
        self.editor.say(text, wrong=True)

    def _say_of_viewpoint(self) -> None:
        """What the selected viewpoint covers, or what is wrong with it."""
        active, viewpoint = self._controller.active, self.editor.value()
        if active is None or viewpoint is None or viewpoint.id not in active.insight.view_ids:
            return
        wrong = [
            self._context.localized(finding.message)
            for finding in active.revision.findings
            if finding.severity is Severity.ERROR and viewpoint.id in finding.place
        ]
        if wrong:
            self.editor.say(wrong[0], wrong=True)
            return
        row = active.insight.sections[active.insight.view_ids.index(viewpoint.id)]
        seen = row >= 0
        alone = int((active.insight.counts[seen, row[seen]] == 1).sum())
        coverage = active.plan.coverage
        self.editor.say(
            self.tr("Covers {0} panels, {1} sections that no other view covers. The plan covers {2}.").format(
                int(seen.sum()), alone, coverage.covered
            )
        )

    def add_viewpoint(self) -> None:
        """A new viewpoint, beside the selected one or above home."""
        active, value = self._controller.active, self.editor.value()
        site = self._context.document.site
        if active is None or site is None:
            return
        self._controller.add_viewpoint(
            above_home(site.site) if value is None else viewpoint_beside(value, site.site.airspace)
        )

    def delete_viewpoint(self) -> None:
        """The selected viewpoint away."""
        value = self.editor.value()
        if value is not None:
            self._controller.delete_viewpoint(value.id)

    def toggle_lock(self) -> None:
        """Keep the selected viewpoint when planning again, or no more."""
        value = self.editor.value()
        if value is not None:
            self._controller.set_viewpoint(replace(value, locked=not value.locked))

    def _aim(self) -> None:
        value = self.editor.value()
        if value is None:
            return
        if self._aim_panel:
            self._controller.aim(value.id, self._aim_panel)
        else:
            self.editor.say(self.tr("Click a panel first, then the viewpoint, then Aim."), wrong=True)

    def _move_toggled(self, checked: bool) -> None:
        if checked:
            self._start_tool()
        else:
            self.stop_moving()

    def _start_tool(self) -> None:
        """Take the selected viewpoint in the tool, in place of the one before; none where it cannot be moved."""
        scene, value = self._shared_view.scene(), self.editor.value()
        if scene is None:
            return
        from groundstation.gui.view3d.tools import ViewpointTool

        # The tool before ends with this, but moving goes on.
        self._is_changing_tool = True
        if value is None or value.locked:
            scene.cancel_tool()
        else:
            angles = math.radians(value.heading_deg), math.radians(value.gimbal_pitch_deg)
            scene.start_tool(ViewpointTool(value.id, value.position_enu_m, *angles))
        self._is_changing_tool = False

    def stop_moving(self) -> None:
        """Put the tool away."""
        self._move.setChecked(False)
        scene = self._shared_view.scene()
        if scene is not None:
            scene.cancel_tool()

    def _tool_ended(self) -> None:
        if not self._is_changing_tool:
            self._move.setChecked(False)

    def _moved_in_scene(self, result: object) -> None:
        from groundstation.gui.view3d.tools import MovedViewpoint

        value = self.editor.value()
        if isinstance(result, MovedViewpoint) and value is not None and value.id == result.id:
            self._controller.set_viewpoint(replace(value, position_enu_m=result.position_enu_m))
