"""The dialog in which the user names a server of map tiles, and agrees that tiles are asked for."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QDialog, QDialogButtonBox, QLabel, QLineEdit, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.inputs import ChoiceBox, Form, WholeBox
from groundstation.gui.widgets.value_boxes import ErrorLine
from groundstation.services.map.online import EXAMPLE_URL, OSM_ATTRIBUTION, OSM_POLICY, OSM_URL, OnlineMap
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
        url, attribution = (online.url, online.attribution) if online.url else (OSM_URL, OSM_ATTRIBUTION)
        self.url, self.attribution, self.server = QLineEdit(url), QLineEdit(attribution), ChoiceBox()
        self.server.addItem(self.tr("OpenStreetMap, standard tiles"), True)
        self.server.addItem(self.tr("Another server"), False)
        self.server.setCurrentIndex(0 if url == OSM_URL else 1)
        self.server.currentIndexChanged.connect(self._choose)
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
        self._policy = QLabel(
            self.tr(
                "OpenStreetMap gives its tiles away, with no promise, on <a href='{0}'>conditions</a> that Reflight "
                "keeps: a name in each request, tiles kept for a week, only what is looked at, its licence on the map. "
                "Do not load areas in advance."
            ).format(OSM_POLICY)
        )
        self._policy.setWordWrap(True)
        self._policy.setOpenExternalLinks(True)
        self._policy.setVisible(url == OSM_URL)
        self._error = ErrorLine()
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self._accept)
        buttons.rejected.connect(self.reject)
        form = Form()
        form.addRow(self.tr("Server"), self.server)
        form.addRow(self.tr("Address of a tile"), self.url)
        form.addRow(self.tr("Licence"), self.attribution)
        form.addRow(self.tr("Deepest level"), self.max_zoom)
        form.addRow(self.tr("Room for tiles, MB"), self.cache)
        layout = QVBoxLayout(self)
        layout.addWidget(explained)
        layout.addWidget(self._policy)
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

    def _choose(self) -> None:
        """Fill in OpenStreetMap's server, or make room for another."""
        is_osm = bool(self.server.currentData())
        self._policy.setVisible(is_osm)
        if is_osm:
            self.url.setText(OSM_URL)
            self.attribution.setText(OSM_ATTRIBUTION)
            self.max_zoom.setValue(OnlineMap().max_zoom)
        elif self.url.text().strip() == OSM_URL:
            self.url.clear()
            self.attribution.clear()

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
