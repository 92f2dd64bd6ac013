"""Above the picture: the layer that is shown, what it is compared with, and the way back to the photo."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QComboBox, QPushButton, QWidget

from groundstation.gui.inputs import ChoiceBox
from groundstation.gui.reconstruct.names import layer_names
from groundstation.gui.scrolling import WrappingRow, labelled
from groundstation.services.reconstruct_places import ModelCard
from reconstruction.modelling.layer_names import PICTURE
from reconstruction.modelling.methods import METHODS

NOTHING, PHOTO = "", "photo"
"""What is compared with, besides folders of models."""


class ViewBar(QWidget):
    """Edits layer, model and comparison.

    Signals
    -------
    valueChanged()
        Another layer, model or comparison was chosen.
    homeAsked()
    """

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    homeAsked = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model, self.layer, self.compare = ChoiceBox(), ChoiceBox(), ChoiceBox()
        self.home = QPushButton(self.tr("To the photo"))
        for name, text in layer_names().items():
            self.layer.addItem(text, name)
        self.home.setToolTip(self.tr("Show the view from where the photo was taken (0)"))
        self.layer.setToolTip(self.tr("What the picture is made of"))
        layout = WrappingRow(self)
        for title, box, least in (
            (self.tr("Model"), self.model, 8),
            (self.tr("Layer"), self.layer, 7),
            (self.tr("Beside it"), self.compare, 8),
        ):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(least)
            layout.addWidget(labelled(title, box))
        layout.addWidget(self.home)
        self.set_models((), "")
        for box in (self.model, self.layer, self.compare):
            box.currentIndexChanged.connect(self._changed)
        self.home.clicked.connect(self._home)

    def value(self) -> tuple[str, str, str]:
        """Model ("" for the one in training, else a folder), layer, and what is beside it (see `NOTHING`, `PHOTO`)."""
        return (
            str(self.model.currentData() or ""),
            str(self.layer.currentData() or PICTURE),
            str(self.compare.currentData() or NOTHING),
        )

    def setValue(self, model: str, layer: str, compare: str) -> None:  # noqa: N802
        """Choose others, where they are there."""
        for box, name in ((self.model, model), (self.layer, layer), (self.compare, compare)):
            with QSignalBlocker(box):
                box.setCurrentIndex(max(0, box.findData(name)))
        self._changed()

    def title(self, model: str) -> str:
        """What a model is called."""
        return self.model.itemText(self.model.findData(model))

    def set_models(self, models: tuple[ModelCard, ...], own: str) -> None:
        """Offer finished models, and one without a folder that is called `own`; "" where there is none."""
        before = self.value()
        with QSignalBlocker(self.model), QSignalBlocker(self.compare):
            self.model.clear()
            self.compare.clear()
            if own or not models:
                self.model.addItem(own or self.tr("none yet"), "")
            self.compare.addItem(self.tr("nothing"), NOTHING)
            self.compare.addItem(self.tr("the photo"), PHOTO)
            for card in models:
                for box in (self.model, self.compare):
                    box.addItem(_title(card), str(card.folder))
            for box, name in ((self.model, before[0]), (self.compare, before[2])):
                box.setCurrentIndex(max(0, box.findData(name)))
        if self.value() != before:
            self._changed()

    def _changed(self) -> None:
        self.valueChanged.emit()

    def _home(self) -> None:
        self.homeAsked.emit()


def _title(card: ModelCard) -> str:
    """Of a finished model: its folder, and its method."""
    method = METHODS[card.method].title if card.method in METHODS else card.method
    return f"{Path(card.folder).name} ({method})"
