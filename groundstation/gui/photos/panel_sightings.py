"""One panel as the photos show it: its hemisphere, the sections that are missing, and the photos that see it."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QLabel, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from groundstation.gui.charts.hemisphere_view import HemisphereView, ShownSection
from groundstation.services.photos.intake import PhotoCoverage
from planning.insight.sections import SectionState

MAX_NAMED = 6
"""Missing sections that are named; the hemisphere shows them all."""


class PanelSightings(QWidget):
    """Draws what it gets of one panel.

    Signals
    -------
    photoPicked(str)
        Path of a photo in the list.
    """

    photoPicked = Signal(str)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._coverage: PhotoCoverage | None = None
        self._panel_id: str | None = None
        self._section: int | None = None
        self._title, self._words = QLabel(), QLabel(wordWrap=True)
        self._title.setProperty("role", "heading")
        self._hemisphere = HemisphereView()
        self.photos = QListWidget()
        self.photos.setAccessibleName(self.tr("Photos that show the panel"))
        self.photos.setMinimumHeight(60)
        self.photos.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 4, 0, 0)
        for widget, stretch in ((self._title, 0), (self._words, 0), (self._hemisphere, 3), (self.photos, 2)):
            layout.addWidget(widget, stretch)
        self._hemisphere.sectionPicked.connect(self.pick_section)
        self.photos.itemClicked.connect(self._pick_photo)
        self.photos.itemActivated.connect(self._pick_photo)
        self._show()

    def set_coverage(self, coverage: PhotoCoverage | None) -> None:
        """Show the panel as other photos see it."""
        if coverage is not self._coverage:
            self._coverage, self._section = coverage, None
            self._show()

    def set_panel(self, panel_id: str | None) -> None:
        """Show another panel; None for none."""
        if panel_id != self._panel_id:
            self._panel_id, self._section = panel_id, None
            self._show()

    def pick_section(self, section: int | None) -> None:
        """List the photos that show one section; all of the panel's where it is picked again."""
        self._section = None if section == self._section else section
        self._show()

    def text(self) -> str:
        """Everything that is said."""
        return f"{self._title.text()}\n{self._words.text()}"

    def _pick_photo(self, row: QListWidgetItem) -> None:
        self.photoPicked.emit(row.data(Qt.ItemDataRole.UserRole))

    def _show(self) -> None:
        coverage = self._coverage
        panel = None if coverage is None or self._panel_id is None else coverage.number(self._panel_id)
        self.photos.clear()
        if coverage is None or panel is None:
            self._title.setText(self.tr("No panel selected"))
            self._words.setText(self.tr("Click a panel in 3-D to see which photos show it."))
            self._hemisphere.set_sections(30.0, ())
            return
        self._title.setText(self.tr("Panel {0}").format(self._panel_id))
        self._words.setText(self._words_of(coverage, panel))
        sections = tuple(
            self._shown(coverage, panel, section, state) for section, state in enumerate(coverage.states(panel))
        )
        self._hemisphere.set_sections(coverage.grid.step_deg, sections)
        self._hemisphere.set_marks(coverage.directions_deg(panel))
        self._hemisphere.set_picked(self._section)
        for sighting in coverage.sightings(panel, self._section):
            row = QListWidgetItem(self.tr("section {0}: {1}").format(sighting.section, sighting.photo.path.name))
            row.setData(Qt.ItemDataRole.UserRole, str(sighting.photo.path))
            self.photos.addItem(row)

    def _words_of(self, coverage: PhotoCoverage, panel: int) -> str:
        n_photos, n_seen = len(coverage.sightings(panel)), int(coverage.seen_per_panel[panel])
        lines = [self.tr("Photos that show it: {0}; sections: {1}").format(n_photos, n_seen)]
        missing = coverage.missing(panel).tolist()
        named = ", ".join(str(section) for section in missing[:MAX_NAMED]) + (" …" if len(missing) > MAX_NAMED else "")
        if not coverage.has_promise:
            lines.append(self.tr("Sections that no photo shows: {0}").format(len(missing)))
        elif missing:
            lines.append(self.tr("Promised and on no photo: {0} ({1})").format(len(missing), named))
        else:
            lines.append(self.tr("Everything that the plan promised is on photos."))
        if self._section is not None:
            lines.append(
                self.tr("Only photos of section {0} are listed; press it again for all.").format(self._section)
            )
        return "\n".join(lines)

    def _shown(self, coverage: PhotoCoverage, panel: int, section: int, state: SectionState) -> ShownSection:
        count = int(coverage.achieved.counts[panel, section])
        said = {
            SectionState.COVERED: self.tr("photos that show it: {0}").format(count),
            SectionState.MISSED: self.tr("promised by the plan, but on no photo"),
            SectionState.UNDECIDED: self.tr("on no photo"),
        }
        return ShownSection(state, count, self.tr("section {0}: {1}").format(section, said[state]))
