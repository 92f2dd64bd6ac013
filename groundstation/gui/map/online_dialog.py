"""The dialog in which the user names a server of map tiles, and agrees that tiles are asked for."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QDialog, QDialogButtonBox, QLabel, QLineEdit, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.inputs import Form, WholeBox
from groundstation.gui.widgets.value_boxes import ErrorLine
from groundstation.services.map.online import EXAMPLE_URL, OnlineMap
from groundstation.services.map.web_mercator import MAX_ZOOM
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError

LEAST_CACHE_MB, MOST_CACHE_MB = 10, 10_000


class OnlineMapDialog(QDialog):
    """Edits an online map.

    Signals
    -------
    valueChanged(OnlineMap)
        The user has agreed to what stands in the dialog.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, online: OnlineMap, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Online map"))
        self._before, self._units = online, units
        self.url, self.attribution = QLineEdit(online.url), QLineEdit(online.attribution)
        self.url.setPlaceholderText(EXAMPLE_URL)
        self.attribution.setPlaceholderText(self.tr("© who owns the data, and its licence"))
        self.max_zoom = WholeBox(0, MAX_ZOOM)
        self.max_zoom.setValue(online.max_zoom)
        self.cache = WholeBox(LEAST_CACHE_MB, MOST_CACHE_MB)
        self.cache.setValue(online.cache_mb)
        self.is_on = QCheckBox(self.tr("Fetch tiles from this server"))
        self.is_on.setChecked(online.is_on)
        explained = QLabel(
            self.tr(
                "Reflight asks this server for the tiles that the map shows, and for nothing else. The server learns "
                "which area you look at. Use a server whose terms allow this, and enter the words that it asks for: "
                "they stand on the map. Tiles are kept on this computer, for a week where the server does not say "
                "otherwise, and are shown without network."
            )
        )
        explained.setWordWrap(True)
        self._error = ErrorLine()
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self._accept)
        buttons.rejected.connect(self.reject)
        form = Form()
        form.addRow(self.tr("Address of a tile"), self.url)
        form.addRow(self.tr("Licence"), self.attribution)
        form.addRow(self.tr("Deepest level"), self.max_zoom)
        form.addRow(self.tr("Room for tiles, MB"), self.cache)
        layout = QVBoxLayout(self)
        layout.addWidget(explained)
        layout.addLayout(form)
        layout.addWidget(self.is_on)
        layout.addWidget(self._error)
        layout.addWidget(buttons)
        self.setMinimumWidth(520)

    def value(self) -> OnlineMap:
        """What stands in the dialog."""
        return replace(
            self._before,
            url=self.url.text().strip(),
            attribution=self.attribution.text().strip(),
            max_zoom=int(self.max_zoom.value()),
            cache_mb=int(self.cache.value()),
            is_on=self.is_on.isChecked(),
        )

    def _accept(self) -> None:
        online = self.value()
        if online.is_on or online.url:
            try:
                online.check()
            except InputError as error:
                self._error.show_error(translated(str(error), self._units))
                return
        self.valueChanged.emit(online)
        self.accept()
