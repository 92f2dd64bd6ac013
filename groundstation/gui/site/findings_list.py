"""What the check of the site found, one line each; a click shows the place."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QLabel, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.theme import colours
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity


def item_of(finding: Finding) -> Item | None:
    """What a finding of `site_findings` is about: "home", "facade/A"."""
    kind, _, name = finding.place.partition("/")
    return Item(ItemKind(kind), name) if kind in set(ItemKind) else None


class FindingsList(QWidget):
    """Shows findings.

    Signals
    -------
    chosen(Item)
        The user wants to see what a finding is about.
    """

    chosen = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._title, self._list = QLabel(), QListWidget()
        self._title.setWordWrap(True)
        self._list.setWordWrap(True)
        self._list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.itemClicked.connect(self._choose)
        self._findings: tuple[Finding, ...] = ()
        self._units = UnitSystem.METRIC
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._title)
        layout.addWidget(self._list)
        self.set_findings(None)

    def set_findings(self, findings: tuple[Finding, ...] | None) -> None:
        """Show findings; None while there are none of the site as it is."""
        self._shown, self._findings = findings, findings or ()
        self._list.clear()
        self._list.setVisible(bool(findings))
        worst = {finding.severity for finding in self._findings}
        role = "muted" if findings is None else "ok"
        if worst:
            role = "error" if Severity.ERROR in worst else "warning"
        self._title.setProperty("role", role)
        self._title.style().unpolish(self._title)
        self._title.style().polish(self._title)
        if findings is None:
            self._title.setText(self.tr("The site is being checked ..."))
        elif not findings:
            self._title.setText(self.tr("Home, airspace and facades: nothing wrong found."))
        else:
            self._title.setText(self.tr("The site's check found: {0}").format(len(findings)))
        look = {Severity.ERROR: colours().error, Severity.WARNING: colours().warning}
        words = {Severity.ERROR: self.tr("Error"), Severity.WARNING: self.tr("Warning"), Severity.NOTE: self.tr("Note")}
        for finding in self._findings:
            row = QListWidgetItem(f"{words.get(finding.severity, '')}: {translated(finding.message, self._units)}")
            row.setForeground(QColor(look.get(finding.severity, colours().text)))
            row.setSizeHint(QSize(0, self._height(row.text())))
            self._list.addItem(row)
        # As tall as its rows: the column that it stands in scrolls.
        self._list.setFixedHeight(sum(self._list.item(k).sizeHint().height() for k in range(self._list.count())) + 6)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        if units is not self._units:
            self._units = units
            self.set_findings(self._shown)

    def findings(self) -> tuple[Finding, ...]:
        """What is shown."""
        return self._findings

    def _height(self, text: str) -> int:
        """Height of a wrapped row; the list itself reckons with one line."""
        width = max(200, self.width() - 40)
        flags = Qt.TextFlag.TextWordWrap
        return int(self.fontMetrics().boundingRect(0, 0, width, 4000, flags, text).height()) + 14

    def _choose(self, row: QListWidgetItem) -> None:
        item = item_of(self._findings[self._list.row(row)])
        if item is not None:
            self.chosen.emit(item)
