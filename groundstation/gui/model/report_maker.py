"""A report of panels as a PDF file: each from the front as the model shows it, with what its records say."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QPointF, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF, QTextDocument

from groundstation.gui.brief_printer import BriefDocument, write_pdf
from groundstation.gui.model.model_desk import ModelDesk
from groundstation.gui.model.picture_places import places_in
from groundstation.gui.model.record_side import KIND_TITLES, line_of
from groundstation.gui.reconstruct.looks import NUMBERS, image_of
from groundstation.services.reconstruct_camera import sized
from groundstation.services.reconstruct_messages import Look, Seen, Subject
from groundstation.services.scene_card import PanelRow, view_of
from groundstation.services.units import UnitSystem, area_unit, length_unit
from planning.errors import InputError
from reconstruction.records.entries import Defect

WIDTH_PX, HEIGHT_PX = 640, 480
"""Of the pictures."""

SHOWN_PX = 380
"""Width of them on the page, of 680."""

REPORT = "report"

MARK_PX = 9.0


class ReportMaker(QObject):
    """Asks for the pictures one after the other, then writes the file.

    Signals
    -------
    done(Path), failed(str)
    """

    done = Signal(object)
    failed = Signal(str)

    def __init__(self, desk: ModelDesk, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._desk = desk
        self._left: list[PanelRow] = []
        self._panels: tuple[PanelRow, ...] = ()
        self._pictures: dict[str, str | QImage] = {}
        self._path, self._number, self._is_letter = Path(), 0, False
        self._units = UnitSystem.METRIC
        desk.seen.connect(self._take)

    @property
    def is_busy(self) -> bool:
        """Whether pictures are waited for."""
        return bool(self._number)

    def make(self, panels: Sequence[PanelRow], path: Path, units: UnitSystem, is_letter: bool = False) -> None:
        """Begin a report; one that is being made is called off."""
        self._panels, self._left, self._pictures = tuple(panels), list(panels), {}
        self._path, self._units, self._is_letter = path, units, is_letter
        self._next()

    def _next(self) -> None:
        card = self._desk.card
        if card is None or not self._left:
            self._number = 0
            if card is not None:
                self._write()
            return
        panel = self._left[0]
        self._number = next(NUMBERS)
        camera = sized(view_of((panel,)), WIDTH_PX, HEIGHT_PX)
        self._desk.look(Look(REPORT, self._number, Subject("model", card.folder), camera))

    def _take(self, seen: Seen | None) -> None:
        if not self.is_busy:
            return
        if seen is None:
            self._number = 0
            self.failed.emit(self.tr("the process that shows models has ended; try again"))
        elif seen.look.place == REPORT and seen.look.number == self._number:
            panel = self._left.pop(0)
            if seen.picture is not None:
                defects = self._desk.entries_of(Defect, panel.global_id)
                self._pictures[panel.global_id] = marked(image_of(seen.picture), seen, panel, defects)
            self._next()

    def _write(self) -> None:
        document = BriefDocument(self.html(), self._pictures)
        card = self._desk.card
        document.setMetaInformation(QTextDocument.MetaInformation.DocumentTitle, "" if card is None else card.name)
        try:
            write_pdf(document, self._path, self._is_letter)
        except InputError as error:
            self.failed.emit(str(error))
        else:
            self.done.emit(self._path)

    def html(self) -> str:
        """The page; all that somebody wrote is text in it, and no markup."""
        card = self._desk.card
        assert card is not None
        heading = escape(self.tr("Panels of {0}").format(card.name or card.folder.name))
        when = escape(self.tr("Model of {0}").format(card.written_at.date().isoformat()))
        parts = [f"<h1>{heading}</h1><p>{when}</p>"]
        for number, panel in enumerate(self._panels):
            parts.append(self._panel_html(panel, is_first=number == 0))
        return f"<html><body style='font-family:sans-serif'>{''.join(parts)}</body></html>"

    def _panel_html(self, panel: PanelRow, is_first: bool) -> str:
        width_m, height_m = panel.size_m
        unit, area = length_unit(self._units), area_unit(self._units)
        size = f"{unit.text(width_m)} x {unit.text(height_m)}, {area.text(width_m * height_m)}"
        facts = (
            (self.tr("Facade"), panel.facade),
            (self.tr("Size"), size),
            (self.tr("GlobalId"), panel.global_id),
        )
        rows = "".join(f"<tr><td>{escape(name)}&nbsp;</td><td>{escape(value)}</td></tr>" for name, value in facts)
        style = "" if is_first else " style='page-break-before:always'"
        parts = [f"<h2{style}>{escape(panel.name)}</h2><table>{rows}</table>"]
        if panel.global_id in self._pictures:
            parts.append(f"<p><img src='{escape(panel.global_id, quote=True)}' width='{SHOWN_PX}'></p>")
        for kind, title in KIND_TITLES.items():
            entries: tuple[Any, ...] = self._desk.entries_of(kind, panel.global_id)
            if entries:
                lines = "".join(f"<li>{escape(line_of(entry))}</li>" for entry in entries)
                parts.append(f"<h3>{escape(title())}</h3><ul>{lines}</ul>")
        return "".join(parts)


def marked(picture: QImage, seen: Seen, panel: PanelRow, defects: Sequence[Defect]) -> QImage:
    """A picture with the panel outlined, and its open defects where they are on it."""
    c0, c1, _, c3 = panel.element.corners_enu_m
    found = picture.copy()
    painter = QPainter(found)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    outline = places_in(seen.look.camera, panel.element.corners_enu_m)
    if outline is not None:
        painter.setPen(QPen(QColor("#e69f00"), 2.5))
        painter.drawPolygon(QPolygonF(outline))
    painter.setPen(QPen(QColor("#ffffff"), 2.5))
    for number, defect in enumerate(defects, 1):
        if defect.u is None or defect.v is None or defect.status != "open":
            continue
        u, v = defect.u, defect.v
        point = tuple(a + u * (b - a) + v * (d - a) for a, b, d in zip(c0, c1, c3, strict=True))
        place = places_in(seen.look.camera, [point])
        if place is not None:
            painter.setBrush(QColor("#b3261e"))
            painter.drawEllipse(place[0], MARK_PX, MARK_PX)
            painter.drawText(place[0] + QPointF(MARK_PX + 3.0, 4.0), str(number))
    painter.end()
    return found
