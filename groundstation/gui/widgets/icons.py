"""The icons of the window: one set of SVG files in `data`, drawn for Reflight under its own licence.

Each is drawn in `currentColor`, which becomes a colour of the theme here. Buttons that were given an icon by `set_icon`
get it in other colours from `tint_all`, once another theme is applied.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from PySide6.QtCore import QByteArray, QSize, Qt
from PySide6.QtGui import QIcon, QImage, QPainter, QPixmap
from PySide6.QtWidgets import QAbstractButton, QApplication

from groundstation.gui.widgets.theme import colours
from planning.base.files import ANY_FILE, read_input_file

FOLDER = Path(__file__).with_name("data")

ICON_PX = 20

NAME = "icon-name"
"""Property of a button that has one of these icons."""


def icon_names() -> tuple[str, ...]:
    """All icons there are."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.svg")))


def icon(name: str, colour: str = "", size_px: int = ICON_PX) -> QIcon:
    """An icon in a colour, in that of texts where none is given; what is disabled is muted."""
    found, look = QIcon(), colours()
    for mode, tint in ((QIcon.Mode.Normal, colour or look.text), (QIcon.Mode.Disabled, look.muted)):
        # Twice as large: for screens of high resolution.
        found.addPixmap(picture(name, tint, size_px, 2.0), mode)
    return found


def picture(name: str, colour: str, size_px: int = ICON_PX, ratio: float = 1.0) -> QPixmap:
    """An icon as a picture of a size, for a screen with so many pixels for one."""
    found = QPixmap.fromImage(_drawn(name, colour, round(size_px * ratio)))
    found.setDevicePixelRatio(ratio)
    return found


@lru_cache(maxsize=512)
def _drawn(name: str, colour: str, size_px: int) -> QImage:
    """An image and no pixmap: it may outlive the application."""
    from PySide6.QtSvg import QSvgRenderer

    drawn = QImage(QSize(size_px, size_px), QImage.Format.Format_ARGB32_Premultiplied)
    drawn.fill(Qt.GlobalColor.transparent)
    painter = QPainter(drawn)
    QSvgRenderer(QByteArray(_source(name).replace(b"currentColor", colour.encode()))).render(painter)
    painter.end()
    return drawn


@lru_cache(maxsize=64)
def _source(name: str) -> bytes:
    return read_input_file(FOLDER / f"{name}.svg", ANY_FILE)


def set_icon(button: QAbstractButton, name: str) -> None:
    """Give a button an icon that follows the theme."""
    button.setProperty(NAME, name)
    button.setIconSize(QSize(ICON_PX, ICON_PX))
    tint(button)


def tint(button: QAbstractButton) -> None:
    """Draw a button's icon in the colours of the theme that was applied last."""
    look, is_primary = colours(), str(button.property("primary")).lower() == "true"
    button.setIcon(icon(str(button.property(NAME)), look.accent_text if is_primary else look.text))


def tint_all(application: QApplication) -> None:
    """Draw the icons of all buttons in the colours of the theme that was applied last."""
    for widget in application.allWidgets():
        if isinstance(widget, QAbstractButton) and widget.property(NAME):
            tint(widget)
