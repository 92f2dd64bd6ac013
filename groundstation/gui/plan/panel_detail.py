"""One panel in detail: its hemisphere, and for the section that is picked the views that see it or why none can."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QLabel, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.charts.hemisphere_view import HemisphereView, ShownSection
from groundstation.services.units import UnitSystem, sampling_unit
from planning.insight.sections import PlanInsight, SectionState
from planning.plan import Plan


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

    def hemisphere(self) -> HemisphereView:
        """The picture."""
        return self._hemisphere

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
