"""What a model is written as for other programs: format, part, and how finely."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.inputs import ChoiceBox, Form
from groundstation.gui.widgets.parameter_form import add_rows, rows_of
from groundstation.services.model.export import ModelExport, model_exporter, model_exporters
from groundstation.services.units import UnitSystem
from planning.base.parameters import declared

LEAST_WIDTH_PX = 440


class ExportDialog(QDialog):
    """Asks for all but the place.

    Parameters
    ----------
    facades
        Names of those that can be written alone.
    """

    def __init__(self, facades: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export the model"))
        self.format, self.part = ChoiceBox(), ChoiceBox()
        self.rows = rows_of(declared(ModelExport))
        self.about = QLabel()
        self.about.setWordWrap(True)
        self.about.setProperty("role", "muted")
        for name, exporter in model_exporters().items():
            self.format.addItem(translated(exporter.title, UnitSystem.METRIC), name)
        self.part.addItem(self.tr("the whole model"), None)
        for facade in facades:
            self.part.addItem(facade, facade)
        form = Form()
        form.addRow(self.tr("Format"), self.format)
        form.addRow(self.about)
        form.addRow(self.tr("Part"), self.part)
        add_rows(form, self.rows)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.button(QDialogButtonBox.StandardButton.Ok).setText(self.tr("Choose a place ..."))
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(buttons)
        self.setMinimumWidth(LEAST_WIDTH_PX)
        self.format.currentIndexChanged.connect(self._show_format)
        self.rows["gaussians"].valueChanged.connect(self._show_format)
        self._show_format()

    def wanted(self) -> ModelExport:
        """What is chosen; what the format does not ask for is left as it usually is."""
        facade = self.part.currentData() if self.part.isEnabled() else None
        chosen = {name: row.value() for name, row in self.rows.items() if row.widget.isEnabled()}
        return ModelExport(self._kind(), components=None if facade is None else (str(facade),), **chosen)

    def _kind(self) -> str:
        return str(self.format.currentData())

    def _show_format(self) -> None:
        exporter = model_exporter(self._kind())
        self.about.setText(translated(exporter.about, UnitSystem.METRIC))
        gaussians = self.rows["gaussians"].value()
        self.part.setEnabled(exporter.takes("components", gaussians))
        for name, row in self.rows.items():
            row.widget.setEnabled(exporter.takes(name, gaussians))
