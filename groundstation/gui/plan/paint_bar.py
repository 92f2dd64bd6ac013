"""What the 3-D view paints on panels and routes; a value of two choices."""

from __future__ import annotations

from enum import StrEnum

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.scrolling import WrappingRow, labelled


class PanelPaint(StrEnum):
    """What panels show."""

    FACADE = "facade"
    SHARE = "share"
    GSD = "gsd"
    HEMISPHERES = "hemispheres"


class RoutePaint(StrEnum):
    """What routes show."""

    SORTIE = "sortie"
    CLEARANCE = "clearance"


class PaintBar(QWidget):
    """Two boxes beside the buttons of the stage.

    Signals
    -------
    valueChanged(PanelPaint, RoutePaint)
    """

    valueChanged = Signal(object, object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._panels, self._routes = ChoiceBox(), ChoiceBox()
        for paint, text in (
            (PanelPaint.FACADE, self.tr("facade")),
            (PanelPaint.SHARE, self.tr("coverage")),
            (PanelPaint.HEMISPHERES, self.tr("hemispheres")),
            (PanelPaint.GSD, self.tr("pixel size")),
        ):
            self._panels.addItem(text, paint)
        for route, text in ((RoutePaint.SORTIE, self.tr("sortie")), (RoutePaint.CLEARANCE, self.tr("clearance"))):
            self._routes.addItem(text, route)
        layout = WrappingRow(self)
        for text, box in ((self.tr("Panels by"), self._panels), (self.tr("Route by"), self._routes)):
            layout.addWidget(labelled(text, box))
            box.currentIndexChanged.connect(lambda _index: self.valueChanged.emit(*self.value()))

    def value(self) -> tuple[PanelPaint, RoutePaint]:
        """What is chosen."""
        return PanelPaint(self._panels.currentData()), RoutePaint(self._routes.currentData())

    def setValue(self, panels: PanelPaint, routes: RoutePaint) -> None:  # noqa: N802
        """Choose."""
        self._panels.setCurrentIndex(self._panels.findData(panels))
        self._routes.setCurrentIndex(self._routes.findData(routes))
