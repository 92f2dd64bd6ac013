"""The selected viewpoint: what it covers, and everything that can be done to it by hand."""

from __future__ import annotations

import math
from dataclasses import replace

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QCheckBox, QVBoxLayout, QWidget

from groundstation.gui.plan.plan_desk import PlanDesk
from groundstation.gui.plan.viewpoint_editor import ViewpointEditor
from groundstation.gui.stage import Stage
from groundstation.gui.workspace import Workspace
from groundstation.services.document import Document, Item, ItemKind
from groundstation.services.plan_editing import above_home, beside
from groundstation.services.units import UnitSystem
from planning.findings import Severity


class ViewpointPage(QWidget):
    """The editor, connected."""

    def __init__(self, workspace: Workspace, desk: PlanDesk, stage: Stage) -> None:
        super().__init__()
        self._workspace, self._desk, self._stage = workspace, desk, stage
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
        self._show_document(workspace.document)

    def _connect(self) -> None:
        desk, workspace = self._desk, self._workspace
        self.editor.valueChanged.connect(desk.set_viewpoint)
        self.editor.addWanted.connect(self.add_viewpoint)
        self.editor.deleteWanted.connect(self.delete_viewpoint)
        self.editor.aimWanted.connect(self._aim)
        self._move.toggled.connect(self._move_toggled)
        desk.inHandChanged.connect(lambda _in_hand: self._say_of_viewpoint())
        desk.refused.connect(self._refused)
        workspace.documentChanged.connect(self._document_changed)
        workspace.selectionChanged.connect(self._show_selection)
        workspace.unitsChanged.connect(self.set_units)
        self._stage.with_scene(
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
        self._show_selection(self._workspace.selection)

    def _show_selection(self, item: Item | None) -> None:
        entry = self._workspace.document.current
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
        self._show_selection(self._workspace.selection)
        self.editor.say(text, wrong=True)

    def _say_of_viewpoint(self) -> None:
        """What the selected viewpoint covers, or what is wrong with it."""
        in_hand, viewpoint = self._desk.in_hand, self.editor.value()
        if in_hand is None or viewpoint is None or viewpoint.id not in in_hand.insight.view_ids:
            return
        wrong = [
            self._workspace.words(finding.message)
            for finding in in_hand.revision.findings
            if finding.severity is Severity.ERROR and viewpoint.id in finding.place
        ]
        if wrong:
            self.editor.say(wrong[0], wrong=True)
            return
        row = in_hand.insight.sections[in_hand.insight.view_ids.index(viewpoint.id)]
        seen = row >= 0
        alone = int((in_hand.insight.counts[seen, row[seen]] == 1).sum())
        coverage = in_hand.plan.coverage
        self.editor.say(
            self.tr("Covers {0} panels, {1} sections that no other view covers. The plan covers {2}.").format(
                int(seen.sum()), alone, coverage.covered
            )
        )

    def add_viewpoint(self) -> None:
        """A new viewpoint, beside the selected one or above home."""
        in_hand, value = self._desk.in_hand, self.editor.value()
        site = self._workspace.document.site
        if in_hand is None or site is None:
            return
        self._desk.add_viewpoint(above_home(site.site) if value is None else beside(value, site.site.airspace))

    def delete_viewpoint(self) -> None:
        """The selected viewpoint away."""
        value = self.editor.value()
        if value is not None:
            self._desk.delete_viewpoint(value.id)

    def toggle_lock(self) -> None:
        """Keep the selected viewpoint when planning again, or no more."""
        value = self.editor.value()
        if value is not None:
            self._desk.set_viewpoint(replace(value, locked=not value.locked))

    def _aim(self) -> None:
        value = self.editor.value()
        if value is None:
            return
        if self._aim_panel:
            self._desk.aim(value.id, self._aim_panel)
        else:
            self.editor.say(self.tr("Click a panel first, then the viewpoint, then Aim."), wrong=True)

    def _move_toggled(self, checked: bool) -> None:
        if checked:
            self._start_tool()
        else:
            self.stop_moving()

    def _start_tool(self) -> None:
        """Take the selected viewpoint in the tool, in place of the one before; none where it cannot be moved."""
        scene, value = self._stage.scene(), self.editor.value()
        if scene is None:
            return
        from groundstation.gui.view3d.viewpoint_tool import ViewpointTool

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
        scene = self._stage.scene()
        if scene is not None:
            scene.cancel_tool()

    def _tool_ended(self) -> None:
        if not self._is_changing_tool:
            self._move.setChecked(False)

    def _moved_in_scene(self, result: object) -> None:
        from groundstation.gui.view3d.viewpoint_tool import MovedViewpoint

        value = self.editor.value()
        if isinstance(result, MovedViewpoint) and value is not None and value.id == result.id:
            self._desk.set_viewpoint(replace(value, position_enu_m=result.position_enu_m))
