"""The effects of a rendered photo: what is simulated, what is not, how large each would be, and why."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QHeaderView, QLabel, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.services.scenes.preview import LEFT_OUT, SeenPhoto
from groundstation.services.units import UnitSystem
from planning.base.effects import Decision


class EffectsWindow(QDialog):
    """A table of decisions beside the window, which follows the photo that is shown."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Effects of the photo"))
        self.resize(1000, 560)
        self._units = UnitSystem.METRIC
        self._photo: SeenPhoto | None = None
        self._words = QLabel()
        self._words.setWordWrap(True)
        self.model: RowModel[Decision] = RowModel(self._columns(), self)
        self._table = table_of(self.model, self.tr("Effects of the photo"), self)
        self._table.setWordWrap(True)
        self._table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        layout = QVBoxLayout(self)
        layout.addWidget(self._words)
        layout.addWidget(self._table, 1)
        self.set_photo(None)

    def _columns(self) -> tuple[Column[Decision], ...]:
        return (
            Column(self.tr("Effect"), lambda found: translated(found.effect, self._units)),
            Column(self.tr("Simulated"), lambda found: self.tr("on") if found.on else self.tr("off")),
            Column(self.tr("Size"), self._size_text, is_number=True),
            Column(self.tr("Off below"), lambda found: f"{found.tolerance:.3g}", is_number=True),
            Column(self.tr("Why"), lambda found: translated(found.reason, self._units)),
        )

    def _size_text(self, found: Decision) -> str:
        return self.tr("{0:.3g} {1}").format(found.size, translated(found.unit, self._units))

    def set_photo(self, photo: SeenPhoto | None) -> None:
        """Show the decisions of a photo; a quick one has none yet."""
        self._photo = photo
        self.model.set_rows(() if photo is None else photo.decisions)
        if photo is None:
            self._words.setText(self.tr("No photo is shown."))
        elif photo.wish.is_quick:
            self._words.setText(
                self.tr("The coarse picture has all effects of light; the scene is asked for the fine one.")
            )
        else:
            self._words.setText(
                self.tr(
                    "An effect is simulated where the picture would change by more than its limit without it: here a "
                    "picture of {0} x {1} pixels. Not in previews, because it takes long: {2}."
                ).format(
                    photo.picture.shape[1],
                    photo.picture.shape[0],
                    ", ".join(translated(name, self._units) for name in LEFT_OUT),
                )
            )
        self._table.resizeColumnsToContents()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self.set_photo(self._photo)

    def text(self) -> str:
        """Everything the table says."""
        columns = range(self.model.columnCount())
        rows = range(self.model.rowCount())
        cells = [[str(self.model.data(self.model.index(row, column))) for column in columns] for row in rows]
        return "\n".join(" | ".join(row) for row in cells)

    def show_beside(self) -> None:
        """Open it, or bring it to the front."""
        self.show()
        self.raise_()
        self.activateWindow()
        self._table.setFocus(Qt.FocusReason.OtherFocusReason)
