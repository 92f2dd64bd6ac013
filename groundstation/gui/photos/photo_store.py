"""Pictures of photos: small ones of many, and a large one that is seen closely."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QSize, Qt, Signal
from PySide6.QtGui import QImage

from groundstation.gui.widgets.picture_decoder import PictureDecoder, qimage_of
from planning.base.errors import InputError
from planning.photos.record import PhotoMetadata
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import warp
from reconstruction.photos.decode import colour_picture

THUMBNAIL_PX = 144
"""Longest side of a small picture; 1/8 of a photo is four times that, and is shrunk before it is kept."""

LEAST_LEVEL_PX = 600
"""Shorter pictures need no smaller copy for being seen whole."""


@dataclass(frozen=True, slots=True, eq=False)
class LargePicture:
    """A picture for looking at closely, or what is wrong with its file.

    Parameters
    ----------
    levels
        The picture, then copies of half the size each, which are painted where they suffice.
    """

    path: Path
    view: Rectification | None
    levels: tuple[QImage, ...]
    problem: str = ""


class PhotoStore(QObject):
    """Small pictures of many photos, and one large one.

    Signals
    -------
    thumbnailReady(Path)
    largeReady(LargePicture)
        The one that was asked for last.
    """

    thumbnailReady = Signal(object)  # noqa: N815  (Qt's own way of naming)
    largeReady = Signal(object)  # noqa: N815

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._decoder = PictureDecoder(_thumbnail, self.thumbnailReady.emit, self)
        self._last: tuple[Path, NDArray[np.uint8]] | None = None
        self._asked: tuple[Path, Rectification | None] | None = None

    def thumbnail(self, photo: PhotoMetadata) -> QImage | None:
        """A small picture; None while it is decoded, and where the file is damaged."""
        return self._decoder.picture(photo.path, photo)

    def ask_large(self, photo: PhotoMetadata, view: Rectification | None = None) -> None:
        """Decode a photo whole, seen through a rectified view where one is given; it comes before small pictures."""
        self._asked = photo.path, view
        self._decoder.work_first(lambda: partial(self._pass_on, self._decode_large(photo, view)))

    def is_busy(self) -> bool:
        """Whether pictures are being decoded, or wait to be taken."""
        return self._decoder.is_busy()

    def close(self) -> None:
        """Decode nothing more, and wait for the picture that is being decoded."""
        self._decoder.close()

    def _decode_large(self, photo: PhotoMetadata, view: Rectification | None) -> LargePicture:
        try:
            if self._last is None or self._last[0] != photo.path:
                self._last = photo.path, colour_picture(photo)
            picture = self._last[1] if view is None else warp(self._last[1], view)[0]
        except InputError as error:
            return LargePicture(photo.path, view, (), str(error))
        return LargePicture(photo.path, view, _levels(picture))

    def _pass_on(self, picture: LargePicture) -> None:
        if self._asked is not None and self._asked[0] == picture.path and self._asked[1] is picture.view:
            self.largeReady.emit(picture)


def _thumbnail(photo: PhotoMetadata) -> QImage | None:
    try:
        picture = qimage_of(colour_picture(photo, 8))
    except InputError:
        return None
    side = QSize(THUMBNAIL_PX, THUMBNAIL_PX)
    return picture.scaled(side, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation)


def _levels(picture: NDArray[np.uint8]) -> tuple[QImage, ...]:
    levels = [qimage_of(picture)]
    while min(levels[-1].width(), levels[-1].height()) > 2 * LEAST_LEVEL_PX:
        half = levels[-1].size() / 2
        levels.append(
            levels[-1].scaled(half, Qt.AspectRatioMode.IgnoreAspectRatio, Qt.TransformationMode.SmoothTransformation)
        )
    return tuple(levels)
