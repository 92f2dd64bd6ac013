"""The photos of a flight: all of them small in the order of time, and the chosen one large with its grids."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QLabel, QPushButton, QStackedWidget, QVBoxLayout, QWidget

from groundstation.gui.photos.coverage_display import CoverageScene
from groundstation.gui.photos.grid_view import GridView
from groundstation.gui.photos.photo_store import LargePicture, PhotoStore
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.photo_strip import PhotoStrip
from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.found_panels import GridPlace, PanelDraft
from groundstation.services.photos.intake import PhotoCard, PhotoMark

# Small pictures of all photos in the order of time, with signs for what is wrong with them.

CELL = QSize(124, 100)
FOOT_PX = 20

SIGNS = {
    PhotoMark.UNREADABLE: "\u2717",
    PhotoMark.CUT_OFF: "\u2702",
    PhotoMark.BLURRED: "\u2248",
    PhotoMark.DARK: "\u25cf",
    PhotoMark.BRIGHT: "\u25cb",
    PhotoMark.ALIKE: "=",
    PhotoMark.UNPOSED: "?",
}
"""No state is told by colour alone."""

SEARCHED = "\u25a6"
"""A photo in which a grid was found."""

NO_USE = frozenset({PhotoMark.UNREADABLE, PhotoMark.CUT_OFF, PhotoMark.UNPOSED})


class ThumbnailStrip(PhotoStrip[PhotoCard]):
    """Shows photos beside each other.

    Signals
    -------
    chosen(int)
        Number of a photo.
    """

    chosen = Signal(int)

    def __init__(self, store: PhotoStore, parent: QWidget | None = None) -> None:
        super().__init__(CELL, FOOT_PX, lambda card: card.path, parent)
        self._store = store
        self._searched: frozenset[Path] = frozenset()
        self.setAccessibleName(self.tr("Photos in the order of time"))
        self.selectionModel().currentChanged.connect(lambda now, _before: self.chosen.emit(now.row()))
        store.thumbnailReady.connect(self.repaint_path)

    def set_cards(self, cards: tuple[PhotoCard, ...]) -> None:
        """Show other photos."""
        self.show_photos(cards)

    def set_searched(self, paths: frozenset[Path]) -> None:
        """Show in which photos grids were found."""
        self._searched = paths
        self.viewport().update()

    def choose(self, number: int) -> None:
        """Bring a photo to the front."""
        self.choose_row(number)

    def picture(self, card: PhotoCard) -> QImage | None:
        """Its picture; None where there is none yet, or the file is damaged."""
        return self._store.thumbnail(card.metadata)

    def paint_foot(self, painter: QPainter, foot: QRect, row: int, card: PhotoCard) -> None:
        """Number and signs."""
        look, line = colours(), foot.adjusted(2, 0, -2, 0)
        number = f"{row + 1} {SEARCHED}" if card.path in self._searched else str(row + 1)
        painter.drawText(line, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, number)
        if card.marks:
            painter.setPen(QColor(look.error if NO_USE.intersection(card.marks) else look.warning))
            signs = " ".join(SIGNS[mark] for mark in card.marks)
            painter.drawText(line, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, signs)

    def words(self, card: PhotoCard) -> str:
        """What is known of a photo."""
        texts = {
            PhotoMark.UNREADABLE: self.tr("cannot be decoded"),
            PhotoMark.CUT_OFF: self.tr("the file was cut off"),
            PhotoMark.BLURRED: self.tr("blurred"),
            PhotoMark.DARK: self.tr("too dark"),
            PhotoMark.BRIGHT: self.tr("too bright"),
            PhotoMark.ALIKE: self.tr("shows the same as another one"),
            PhotoMark.UNPOSED: self.tr("does not say where it was taken"),
        }
        return "\n".join([card.path.name, *(f"{SIGNS[mark]} {texts[mark]}" for mark in card.marks)])


class PhotoPane(QWidget):
    """Shows one photo of a draft.

    Signals
    -------
    refused(Message)
        The photo cannot be shown, and why.
    placeChanged()
        Another grid is active, or none.
    coverageShown(bool)
        The coverage in 3-D came into the place of the photo, or went.
    """

    refused = Signal(object)
    placeChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    coverageShown = Signal(bool)  # noqa: N815

    def __init__(self, store: PhotoStore, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._card: PhotoCard | None = None
        self._draft: PanelDraft | None = None
        self.view, self.scene, self.facade, self._name = GridView(), CoverageScene(), ChoiceBox(), QLabel()
        self.photo, self.rectified = QPushButton(self.tr("Photo")), QPushButton(self.tr("Rectified"))
        self.coverage = QPushButton(self.tr("Coverage in 3-D"))
        self.coverage.setToolTip(self.tr("The panels coloured by what the photos show of them; a click tells which"))
        self.whole = QPushButton(self.tr("Fit"))
        self.whole.setToolTip(self.tr("Show all of the picture (0)"))
        self.facade.setAccessibleName(self.tr("Facade whose grid is corrected"))
        group = QButtonGroup(self)
        for button in (self.photo, self.rectified, self.coverage):
            button.setCheckable(True)
            group.addButton(button)
            button.clicked.connect(self._show)
        self.photo.setChecked(True)
        self.facade.activated.connect(self._show)
        self.whole.clicked.connect(self.view.show_whole)
        bar = QHBoxLayout()
        bar.addWidget(self._name, 1)
        for widget in (self.facade, self.photo, self.rectified, self.coverage, self.whole):
            bar.addWidget(widget)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addLayout(bar)
        self._pictures = QStackedWidget()
        self._pictures.addWidget(self.view)
        self._pictures.addWidget(self.scene)
        layout.addWidget(self._pictures, 1)
        store.largeReady.connect(self._take)
        self.set_text(self.tr("Photos are shown here once they have been read."))
        self._show()

    def set_text(self, text: str) -> None:
        """Say something while there is no picture."""
        self.view.set_text(text)

    def set_card(self, card: PhotoCard | None) -> None:
        """Show another photo."""
        if card is not self._card:
            self._card = card
            self._show()

    def set_outlines(self, outlines: tuple[NDArray[np.float64], ...]) -> None:
        """Draw panels that were not looked for in the photo; see `GridPicture`."""
        self.view.set_outlines(outlines)

    def is_coverage_shown(self) -> bool:
        """Whether the coverage stands in the place of the photo."""
        return self._pictures.currentWidget() is self.scene

    def show_photo(self) -> None:
        """Show the photo, where the coverage stands in its place."""
        if self.coverage.isChecked():
            self.photo.setChecked(True)
            self._show()

    def set_draft(self, draft: PanelDraft | None) -> None:
        """Show other grids."""
        self._draft = draft
        self._show()

    def card(self) -> PhotoCard | None:
        """The photo that is shown."""
        return self._card

    def place(self) -> GridPlace | None:
        """Where a correction would be made."""
        found = self._places()
        index = self.facade.currentIndex()
        return found[index] if 0 <= index < len(found) else None

    def show_facade(self, facade_id: str) -> None:
        """Make the grid of this facade active, where the photo has one."""
        names = [place.facade for place in self._places()]
        if facade_id in names:
            self.facade.setCurrentIndex(names.index(facade_id))
            self._show()

    def _places(self) -> tuple[GridPlace, ...]:
        draft, card = self._draft, self._card
        if draft is None or card is None:
            return ()
        return tuple(place for place in draft.places() if draft.photos[place.photo].path == card.path)

    def _show(self) -> None:
        """Bring everything up to date; a picture that is there already is not decoded again."""
        places, card = self._places(), self._card
        names = [self.tr("Facade {0}").format(place.facade) for place in places]
        if [self.facade.itemText(k) for k in range(self.facade.count())] != names:
            self.facade.clear()
            self.facade.addItems(names)
        self.facade.setVisible(len(names) > 1 and not self.coverage.isChecked())
        place, has_coverage = self.place(), self.coverage.isChecked()
        self._name.setText("" if card is None or has_coverage else card.path.name)
        self.rectified.setEnabled(place is not None)
        if place is None and not has_coverage:
            self.photo.setChecked(True)
        self.whole.setEnabled(not has_coverage)
        if has_coverage is not self.is_coverage_shown():
            self._pictures.setCurrentWidget(self.scene if has_coverage else self.view)
            self.coverageShown.emit(has_coverage)
        grids = () if self._draft is None else tuple(self._draft.grid(one) for one in places)
        grid = None if place is None or self._draft is None else self._draft.grid(place)
        is_rectified = self.rectified.isChecked()
        view = grid.rectification if is_rectified and grid is not None else None
        shown = self.view.picture()
        if card is None:
            self.view.set_picture(None)
        elif shown is None or shown.path != card.path or shown.view is not view:
            self.view.set_picture(None)
            self.set_text(self.tr("The photo is being decoded ..."))
            self._store.ask_large(card.metadata, view)
        self.view.set_grids(grids, grid, is_rectified=is_rectified)
        self.placeChanged.emit()

    def _take(self, picture: LargePicture) -> None:
        if self._card is None or picture.path != self._card.path:
            return
        self.view.set_picture(picture)
        if picture.problem:
            self.set_text(self.tr("This photo cannot be shown."))
            self.refused.emit(picture.problem)
