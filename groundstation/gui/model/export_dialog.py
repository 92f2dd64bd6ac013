"""What a model is written as for other programs: format, part, and how finely."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QVBoxLayout, QWidget

from groundstation.gui.widgets.inputs import ChoiceBox, Form
from groundstation.services.model.export import (
    EXPORTERS,
    ModelExport,
    ModelFormat,
    Preset,
    model_exporter,
    model_exporters,
)

PRESETS = get_args(Preset)

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
        self.format, self.part, self.colours, self.preset = (ChoiceBox() for _ in range(4))
        self.about = QLabel()
        self.about.setWordWrap(True)
        self.about.setProperty("role", "muted")
        for name, (title, _) in format_words().items():
            self.format.addItem(title, name)
        self.part.addItem(self.tr("the whole model"), None)
        for facade in facades:
            self.part.addItem(facade, facade)
        self.colours.addItem(self.tr("with what panels mirror"), True)
        self.colours.addItem(self.tr("panels' own colours"), False)
        for preset, title in zip(PRESETS, (self.tr("small"), self.tr("balanced"), self.tr("fine")), strict=True):
            self.preset.addItem(title, preset)
        self.preset.setCurrentIndex(PRESETS.index("balanced"))
        form = Form()
        form.addRow(self.tr("Format"), self.format)
        form.addRow(self.about)
        form.addRow(self.tr("Part"), self.part)
        form.addRow(self.tr("Colours"), self.colours)
        form.addRow(self.tr("File size"), self.preset)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.button(QDialogButtonBox.StandardButton.Ok).setText(self.tr("Choose a place ..."))
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(buttons)
        self.setMinimumWidth(LEAST_WIDTH_PX)
        self.format.currentIndexChanged.connect(self._show_format)
        self._show_format()

    def wanted(self) -> ModelExport:
        """What is chosen; what the format does not ask for is left as it usually is."""
        kind = self._kind()
        exporter = model_exporter(kind)
        facade = self.part.currentData() if exporter.has_parts else None
        is_baked = bool(self.colours.currentData()) or not exporter.has_colours
        preset = self.preset.currentData() if exporter.has_presets else "balanced"
        return ModelExport(kind, is_baked, None, preset, None if facade is None else (str(facade),))

    def _kind(self) -> str:
        return str(self.format.currentData())

    def _show_format(self) -> None:
        exporter = model_exporter(self._kind())
        self.about.setText(format_words()[self._kind()][1])
        self.part.setEnabled(exporter.has_parts)
        self.colours.setEnabled(exporter.has_colours)
        self.preset.setEnabled(exporter.has_presets)


def format_words() -> dict[str, tuple[str, str]]:
    """What formats are called, and what they are for, in the order in which they are offered.

    Those of plug-ins are last; they have words of their own in whatever language.
    """
    translate = QCoreApplication.translate
    of_plugins = {name: (each.title, each.about) for name, each in model_exporters().items() if name not in EXPORTERS}
    return {
        ModelFormat.WEB: (
            translate("ModelFormats", "Web page"),
            translate(
                "ModelFormats",
                "A folder with one page that shows the model and all records in any browser, without a network.",
            ),
        ),
        ModelFormat.GLTF: (
            "glTF",
            translate("ModelFormats", "Splats, and panels to pick with their GlobalIds and attributes, in one file."),
        ),
        ModelFormat.TILES: (
            "3D Tiles",
            translate(
                "ModelFormats", "A folder with splats and panels in tiles, placed on Earth, as CesiumJS shows them."
            ),
        ),
        ModelFormat.USD: ("USD", translate("ModelFormats", "Splats and panels for film and simulation programs.")),
        ModelFormat.PLY: (
            "PLY",
            translate("ModelFormats", "Splats as ellipsoids: SuperSplat and nearly all viewers open it. Large."),
        ),
        ModelFormat.PLY_2DGS: ("PLY (2DGS)", translate("ModelFormats", "Splats as flat discs, as they were learned.")),
        ModelFormat.SOG: (
            "SOG",
            translate("ModelFormats", "Splats, compressed most: for SuperSplat and PlayCanvas."),
        ),
        ModelFormat.SPZ: ("SPZ", translate("ModelFormats", "Splats, compressed: most viewers of splats open it.")),
        ModelFormat.SPZ_4: (
            "SPZ 4",
            translate("ModelFormats", "The newer version of SPZ: smaller, for the newest programs."),
        ),
        ModelFormat.MESH: (
            translate("ModelFormats", "Mesh (glTF)"),
            translate("ModelFormats", "Panels with pictures of their fronts, for programs that know no splats."),
        ),
        ModelFormat.CITYJSON: (
            "CityJSON",
            translate("ModelFormats", "The panels alone, as windows of the building, with their attributes."),
        ),
        ModelFormat.IFC: (
            "IFC",
            translate("ModelFormats", "The panels alone, as plates of curtain walls, with their property sets."),
        ),
        **of_plugins,
    }
