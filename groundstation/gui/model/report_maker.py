"""A report of panels as a PDF file: each from the front as the model shows it, and all that is known of it.

What is known of a panel is what its records say, with the photos that they hold, and what is said of its facade and of
the building.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from PySide6.QtCore import QLocale, QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF, QTextDocument

from groundstation.gui.mission.brief_printer import BriefDocument, write_pdf
from groundstation.gui.model.model_controller import ModelController
from groundstation.gui.model.picture_places import places_in
from groundstation.gui.model.record_side import KIND_TITLES, line_of
from groundstation.gui.reconstruct.view_pictures import NUMBERS, image_of
from groundstation.services.model.facility_records import Attachment
from groundstation.services.model.scene_card import PanelRow, SceneCard, view_of
from groundstation.services.reconstruct.guided_camera import sized
from groundstation.services.reconstruct.messages import Subject, ViewAnswer, ViewRequest
from groundstation.services.units import UnitSystem, area_unit, length_unit
from planning.base.errors import InputError
from reconstruction.records.entries import Defect, Document, Entry

WIDTH_PX, HEIGHT_PX = 640, 480
"""Of the pictures of the model."""

SHOWN_PX = 380
"""Width of them on the page, of 680."""

PHOTO_PX = 300
"""Of photos that records hold, width and height at most on the page."""

PHOTO_SCALE = 3
"""Pixels for each of those: some 300 to the inch."""

REPORT = "report"

MARK_PX, SMALL_MARK_PX = 11.0, 4.0
"""Radius of marks of defects: of one panel, and of several."""

Pictured = tuple[str, tuple[PanelRow, ...]]
"""GlobalId of a facade or panel, and the panels that its picture shows."""

Entries = dict[type[Any], tuple[Any, ...]]
"""Records of an object by kind."""


class ReportMaker(QObject):
    """Asks for the pictures one after the other, reads what is attached to records, then writes the file.

    Signals
    -------
    done(Path), failed(Message)
    """

    done = Signal(object)
    failed = Signal(object)

    def __init__(self, controller: ModelController, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._controller = controller
        self._card: SceneCard | None = None
        self._left: list[Pictured] = []
        self._panels: tuple[PanelRow, ...] = ()
        self._facades: dict[str, str] = {}
        self._pictures: dict[str, str | QImage] = {}
        self._entries: dict[str, Entries] = {}
        self._attached: dict[str, Attachment] = {}
        self._path, self._is_letter = Path(), False
        self._number = self._reading = 0
        self._units = UnitSystem.METRIC
        controller.viewAnswered.connect(self._take)

    @property
    def is_busy(self) -> bool:
        """Whether pictures are waited for, or what is attached."""
        return bool(self._number or self._reading)

    def make(
        self,
        panels: Sequence[PanelRow],
        path: Path,
        units: UnitSystem,
        is_letter: bool = False,
        facades: Sequence[PanelRow] = (),
    ) -> None:
        """Begin a report; one that is being made is called off.

        Parameters
        ----------
        facades
            All panels of facades that are shown as a whole.
        """
        self._card, self._panels, self._pictures = self._controller.card, tuple(panels), {}
        whole: dict[str, list[PanelRow]] = {}
        for panel in facades:
            whole.setdefault(panel.facade_id, []).append(panel)
        self._facades = {panel.facade_id: panel.facade for panel in (*facades, *panels)}
        self._left = [(facade_id, tuple(each)) for facade_id, each in whole.items()]
        self._left += [(panel.global_id, (panel,)) for panel in panels]
        self._path, self._units, self._is_letter, self._reading = path, units, is_letter, 0
        if self._card is not None:
            subjects = (
                self._card.global_id,
                *self._facades,
                *(each.global_id for _, group in self._left for each in group),
            )
            self._entries = self._controller.entries_of_all(dict.fromkeys(subjects))
        self._next()

    def _next(self) -> None:
        card = self._controller.card
        if card is None or card is not self._card or not self._left:
            self._number = 0
            if card is not None and card is self._card:
                self._read()
            return
        self._number = next(NUMBERS)
        camera = sized(view_of(self._left[0][1]), WIDTH_PX, HEIGHT_PX)
        self._controller.request_view(ViewRequest(REPORT, self._number, Subject("model", card.folder), camera))

    def _read(self) -> None:
        """Read the files that records name."""
        entries = [entry for kinds in self._entries.values() for each in kinds.values() for entry in each]
        self._reading = number = next(NUMBERS)

        def read(attached: dict[str, Attachment]) -> None:
            if self._reading == number:
                self._reading, self._attached = 0, attached
                self._write()

        self._controller.read_attached(entries, PHOTO_SCALE * PHOTO_PX, read, self._not_read)

    def _not_read(self, _error: BaseException | None) -> None:
        self._reading = 0

    def _take(self, answer: ViewAnswer | None) -> None:
        if not self._number:
            return
        if answer is None:
            self._number = 0
            self.failed.emit(self.tr("the process that shows models has ended; try again"))
        elif answer.look.place == REPORT and answer.look.number == self._number:
            global_id, panels = self._left.pop(0)
            if answer.picture is not None:
                defects = {panel: self._entries[panel.global_id].get(Defect, ()) for panel in panels}
                self._pictures[global_id] = marked(image_of(answer.picture), answer, defects)
            self._next()

    def _write(self) -> None:
        photos = {
            name: QImage.fromData(each.picture) for name, each in self._attached.items() if each.picture is not None
        }
        document = BriefDocument(self.html(), self._pictures | photos)
        name = "" if self._card is None else self._card.name
        document.setMetaInformation(QTextDocument.MetaInformation.DocumentTitle, name)
        try:
            write_pdf(document, self._path, self._is_letter)
        except InputError as error:
            self.failed.emit(str(error))
        else:
            self.done.emit(self._path)

    def html(self) -> str:
        """The page; all that somebody wrote is text in it, and no markup."""
        card = self._card
        assert card is not None
        name = card.name or card.folder.name
        heading = escape(self.tr("Panels of {0}").format(name))
        when = escape(self.tr("Model of {0}").format(card.written_at.date().isoformat()))
        parts = [f"<h1>{heading}</h1><p>{when}</p>"]
        about = [(card.global_id, self.tr("The building: {0}").format(name))]
        about += [(facade_id, self.tr("Facade {0}").format(facade)) for facade_id, facade in self._facades.items()]
        for global_id, title in about:
            if known := self._picture_html(global_id) + self._records_html(global_id):
                parts.append(f"<h2>{escape(title)}</h2>{known}")
        has_page = len(parts) > 1
        for panel in self._panels:
            parts.append(self._panel_html(panel, is_first=not has_page))
            has_page = True
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
        parts += [self._picture_html(panel.global_id), self._records_html(panel.global_id)]
        return "".join(parts)

    def _picture_html(self, global_id: str) -> str:
        if global_id not in self._pictures:
            return ""
        return f"<p><img src='{escape(global_id, quote=True)}' width='{SHOWN_PX}'></p>"

    def _records_html(self, global_id: str) -> str:
        """Records of an object by kind; "" where there are none. Defects have the numbers that the picture has."""
        parts = []
        for kind, entries in self._entries.get(global_id, {}).items():
            lines = "".join(f"<li>{self._entry_html(entry)}</li>" for entry in entries)
            tag = "ol" if kind is Defect else "ul"
            parts.append(f"<h3>{escape(KIND_TITLES[kind]())}</h3><{tag}>{lines}</{tag}>")
        return "".join(parts)

    def _entry_html(self, entry: Entry) -> str:
        text = escape(line_of(entry)).replace("\n", "<br>")
        name = entry.picture if isinstance(entry, Defect) else entry.place if isinstance(entry, Document) else ""
        attached = self._attached.get(name)
        if attached is None:
            return text
        if attached.picture is not None:
            photo = f"<img src='{escape(name, quote=True)}' {_fitted(attached.picture)}>"
            return f"{text}<p style='margin-top:8px; margin-bottom:8px'>{photo}</p>"
        if attached.n_bytes and isinstance(entry, Document):
            size = QLocale().formattedDataSize(attached.n_bytes, 1, QLocale.DataSizeFormat.DataSizeSIFormat)
            return f"{text}, {escape(size)}"
        unread = self.tr("The picture cannot be read: {0}")
        missing = self.tr("The file is missing or not the one that was attached: {0}")
        return f"{text}<br><i>{escape((unread if attached.n_bytes else missing).format(name))}</i>"


def _fitted(picture: bytes) -> str:
    """Width and height of a photo on the page, as attributes."""
    size = QImage.fromData(picture).size().scaled(PHOTO_PX, PHOTO_PX, Qt.AspectRatioMode.KeepAspectRatio)
    return f"width='{size.width()}' height='{size.height()}'"


def marked(picture: QImage, answer: ViewAnswer, defects: Mapping[PanelRow, Sequence[Defect]]) -> QImage:
    """A picture with panels outlined, and their open defects where they are.

    Those of one panel have their numbers. Of several, what has no place on its panel is in the panel's middle.
    """
    is_one = len(defects) == 1
    found = picture.copy()
    painter = QPainter(found)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    font = painter.font()
    font.setBold(True)
    font.setPixelSize(round(1.2 * MARK_PX))
    painter.setFont(font)
    for panel in defects:
        outline = places_in(answer.look.camera, panel.element.corners_enu_m)
        if outline is not None:
            painter.setPen(QPen(QColor("#e69f00"), 2.5 if is_one else 1.0))
            painter.drawPolygon(QPolygonF(outline))
    painter.setPen(QPen(QColor("#ffffff"), 2.5 if is_one else 1.5))
    painter.setBrush(QColor("#b3261e"))
    radius = MARK_PX if is_one else SMALL_MARK_PX
    for panel, of_panel in defects.items():
        c0, c1, _, c3 = panel.element.corners_enu_m
        for number, defect in enumerate(of_panel, 1):
            if defect.status != "open" or (is_one and defect.u is None):
                continue
            u, v = 0.5 if defect.u is None else defect.u, 0.5 if defect.v is None else defect.v
            point = tuple(a + u * (b - a) + v * (d - a) for a, b, d in zip(c0, c1, c3, strict=True))
            place = places_in(answer.look.camera, [point])
            if place is None:
                continue
            painter.drawEllipse(place[0], radius, radius)
            if is_one:
                box = QRectF(place[0] - QPointF(radius, radius), place[0] + QPointF(radius, radius))
                painter.drawText(box, Qt.AlignmentFlag.AlignCenter, str(number))
    painter.end()
    return found
