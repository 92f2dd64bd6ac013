"""The flight brief: the page of `brief_html` laid out by Qt, on screen, onto a PDF or a printer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QDate, QLocale, QMarginsF, QRectF, QSizeF, Qt, QUrl
from PySide6.QtGui import (
    QAbstractTextDocumentLayout,
    QFont,
    QImage,
    QPagedPaintDevice,
    QPageLayout,
    QPageSize,
    QPainter,
    QPalette,
    QPdfWriter,
    QTextDocument,
)
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import QT_TRANSLATE_NOOP, printed, translated
from groundstation.gui.map.map_paint import (
    paint_landings,
    paint_north,
    paint_plan,
    paint_scale_bar,
    paint_site,
    paint_text_box,
    paint_tiles,
)
from groundstation.gui.map.tile_store import TileReader
from groundstation.gui.map.viewport import Viewport
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.questions import choose_new_file, file_name
from groundstation.gui.widgets.theme import LIGHT
from groundstation.services.jobs.runner import JobContext
from groundstation.services.map.shapes import PlanShapes, SiteShapes, plan_shapes, site_shapes
from groundstation.services.map.tiles import open_map_file
from groundstation.services.map.web_mercator import Tile
from groundstation.services.mission.brief import flight_brief
from groundstation.services.mission.brief_html import MAP, brief_html, brief_pictures
from groundstation.services.mission.readiness import Preflight
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.base.messages import say
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.plan import Plan
from planning.site.records import SiteModel

MARGIN_MM = 15.0
LETTERS_PT = 9
"""Of paper, whatever size the letters of the window have; the style's `body` does not reach tables."""
RESOLUTION_DPI = 300

PICTURE_SCALE = 3.0
"""Pixels for each of 1/96 inch: about 300 to the inch."""

MAP_PX = 720, 520
"""Size of a painted map, before `PICTURE_SCALE`."""

WORDS = (
    QT_TRANSLATE_NOOP("Brief", "Page {0} of {1}"),
    QT_TRANSLATE_NOOP("Brief", "height above take-off [{0}]"),
    QT_TRANSLATE_NOOP("Brief", "time [min]"),
    QT_TRANSLATE_NOOP("Brief", "Flight brief: {0}"),
    QT_TRANSLATE_NOOP("Brief", "Take-off and landing"),
    QT_TRANSLATE_NOOP("Brief", "Sorties"),
    QT_TRANSLATE_NOOP("Brief", "Set on the remote controller"),
    QT_TRANSLATE_NOOP("Brief", "Findings"),
    QT_TRANSLATE_NOOP("Brief", "Before take-off"),
    QT_TRANSLATE_NOOP("Brief", "Map"),
    QT_TRANSLATE_NOOP("Brief", "Sun"),
    QT_TRANSLATE_NOOP(
        "Brief", "Tall, half, low: facades in the sun, in part, in shade; take-offs that spoil no, few, many photos"
    ),
    QT_TRANSLATE_NOOP("Brief", "Height of sortie {0}"),
    QT_TRANSLATE_NOOP("Brief", "All pre-flight rules are kept: ready to fly."),
    QT_TRANSLATE_NOOP("Brief", "Ready to fly, but read the warnings."),
    QT_TRANSLATE_NOOP("Brief", "NOT ready to fly: see the findings."),
    QT_TRANSLATE_NOOP("Brief", "Date"),
    QT_TRANSLATE_NOOP("Brief", "Planned for"),
    QT_TRANSLATE_NOOP("Brief", "Temperature"),
    QT_TRANSLATE_NOOP("Brief", "Plan"),
    QT_TRANSLATE_NOOP("Brief", "Aircraft and camera"),
    QT_TRANSLATE_NOOP("Brief", "Photos"),
    QT_TRANSLATE_NOOP("Brief", "Batteries needed"),
    QT_TRANSLATE_NOOP("Brief", "Flight time, all sorties"),
    QT_TRANSLATE_NOOP("Brief", "Directions of view seen, of those possible"),
    QT_TRANSLATE_NOOP("Brief", "Unseen views of the model, expected, by batteries"),
    QT_TRANSLATE_NOOP("Brief", "Another battery would bring"),
    QT_TRANSLATE_NOOP("Brief", "Pixel on the panel"),
    QT_TRANSLATE_NOOP("Brief", "{0} of what is covered with up to {1}, the coarsest with {2}"),
    QT_TRANSLATE_NOOP("Brief", "at most {0}"),
    QT_TRANSLATE_NOOP("Brief", "{0} to {1}, at least {2} to be kept but at take-off"),
    QT_TRANSLATE_NOOP("Brief", "{0}; {1} below {2}"),
    QT_TRANSLATE_NOOP(
        "Brief", "Nobody walks and nothing stands or hangs where the paths come down to {0} above the ground"
    ),
    QT_TRANSLATE_NOOP("Brief", "{0} along the paths, {1} to be kept"),
    QT_TRANSLATE_NOOP("Brief", "not measured"),
    QT_TRANSLATE_NOOP("Brief", "Smallest distance to building and obstacles"),
    QT_TRANSLATE_NOOP("Brief", "planned for {0}, the aircraft may fly below {1}"),
    QT_TRANSLATE_NOOP("Brief", "Wind"),
    QT_TRANSLATE_NOOP("Brief", "Ground risk (SORA 2.5, a draft)"),
    QT_TRANSLATE_NOOP("Brief", "Uninvolved people inside the buffer"),
    QT_TRANSLATE_NOOP(
        "Brief", "contingency volume {0} to each side, up to {1} above ground; ground-risk buffer {2} beyond"
    ),
    QT_TRANSLATE_NOOP("Brief", "{0}: {1} [{2}]"),
    QT_TRANSLATE_NOOP("Brief", "Intrinsic ground risk class"),
    QT_TRANSLATE_NOOP("Brief", "Final ground risk class"),
    QT_TRANSLATE_NOOP("Brief", "not stated how many: keep everybody out"),
    QT_TRANSLATE_NOOP("Brief", "none: controlled ground area"),
    QT_TRANSLATE_NOOP("Brief", "an assembly of people"),
    QT_TRANSLATE_NOOP("Brief", "fewer than {0} per square kilometre"),
    QT_TRANSLATE_NOOP("Brief", "Position (WGS 84)"),
    QT_TRANSLATE_NOOP("Brief", "Height above sea level (EGM96)"),
    QT_TRANSLATE_NOOP("Brief", "Height above the ellipsoid (WGS 84)"),
    QT_TRANSLATE_NOOP("Brief", "Height above ground"),
    QT_TRANSLATE_NOOP("Brief", "Sortie"),
    QT_TRANSLATE_NOOP("Brief", "Time [min]"),
    QT_TRANSLATE_NOOP("Brief", "Length"),
    QT_TRANSLATE_NOOP("Brief", "Battery used"),
    QT_TRANSLATE_NOOP("Brief", "Highest above take-off"),
    QT_TRANSLATE_NOOP("Brief", "Highest above sea (EGM96)"),
    QT_TRANSLATE_NOOP("Brief", "Smallest distance"),
    QT_TRANSLATE_NOOP("Brief", "The plan has no sorties."),
    QT_TRANSLATE_NOOP("Brief", "Return height, above take-off"),
    QT_TRANSLATE_NOOP("Brief", "not known"),
    QT_TRANSLATE_NOOP("Brief", "continue mission"),
    QT_TRANSLATE_NOOP("Brief", "return home straight, at the return height"),
    QT_TRANSLATE_NOOP("Brief", "Without radio link"),
    QT_TRANSLATE_NOOP("Brief", "Battery reserve at landing"),
    QT_TRANSLATE_NOOP("Brief", "Highest speed"),
    QT_TRANSLATE_NOOP("Brief", "Hover before each photo"),
    QT_TRANSLATE_NOOP("Brief", "None: every rule is kept."),
    QT_TRANSLATE_NOOP("Brief", "ERROR"),
    QT_TRANSLATE_NOOP("Brief", "Warning"),
    QT_TRANSLATE_NOOP("Brief", "Note"),
    QT_TRANSLATE_NOOP("Brief", "Severity"),
    QT_TRANSLATE_NOOP("Brief", "Finding"),
    QT_TRANSLATE_NOOP("Brief", "Measured"),
    QT_TRANSLATE_NOOP("Brief", "Place"),
    QT_TRANSLATE_NOOP("Brief", "Permission for this place and height is at hand; nobody is below the paths"),
    QT_TRANSLATE_NOOP("Brief", "No-fly zones known to everybody: {0}"),
    QT_TRANSLATE_NOOP("Brief", "none"),
    QT_TRANSLATE_NOOP(
        "Brief", "Nothing stands within {0} of the paths but what the site knows (building; obstacles: {1})"
    ),
    QT_TRANSLATE_NOOP("Brief", "Fully charged batteries: {0}; free space for photos: {1}"),
    QT_TRANSLATE_NOOP(
        "Brief", "Aircraft stands on the take-off point; GNSS (RTK where there is one) has a fix, compass is calibrated"
    ),
    QT_TRANSLATE_NOOP("Brief", "Return height on the remote controller is at least {0} above take-off"),
    QT_TRANSLATE_NOOP("Brief", "Wind at flight height is below {0}"),
    QT_TRANSLATE_NOOP("Brief", "The mission on the remote controller is this plan (photos: {0})"),
    QT_TRANSLATE_NOOP("Brief", "The camera is set as listed, its focus on the facade"),
    QT_TRANSLATE_NOOP("Brief", "Camera, by hand"),
    QT_TRANSLATE_NOOP("Brief", "Camera, by the mission"),
    QT_TRANSLATE_NOOP(
        "Brief",
        "Sortie {0}: before any photo the aircraft stops {1}. Where it does not, land: it took off from another height "
        "than planned",
    ),
    QT_TRANSLATE_NOOP("Brief", "{0} above take-off"),
    QT_TRANSLATE_NOOP("Brief", "{0} above {1}"),
    QT_TRANSLATE_NOOP("Brief", "{0} below {1}"),
    QT_TRANSLATE_NOOP("Brief", "the upper edge of facade {0}"),
    QT_TRANSLATE_NOOP("Brief", "the lower edge of facade {0}"),
)
"""All that a brief says, for the translators; `brief_html` holds the same texts."""


def translate(text: str) -> str:
    """A text of the brief in the user's language."""
    return QCoreApplication.translate("Brief", text)


class BriefDocument(QTextDocument):
    """A brief with its pictures: SVG text, or images that were painted."""

    def __init__(self, html: str, pictures: Mapping[str, str | QImage]) -> None:
        super().__init__()
        for name, picture in pictures.items():
            image = _drawn(picture) if isinstance(picture, str) else picture
            self.addResource(QTextDocument.ResourceType.ImageResource.value, QUrl(name), image)
        self.setDocumentMargin(0.0)
        self.setDefaultFont(QFont(QApplication.font().family(), LETTERS_PT))
        self.setHtml(html)


def page_size(is_letter: bool) -> QPageSize:
    """US Letter or A4."""
    return QPageSize(QPageSize.PageSizeId.Letter if is_letter else QPageSize.PageSizeId.A4)


def write_pdf(document: QTextDocument, path: Path, is_letter: bool) -> int:
    """Write a PDF; returns the number of its pages.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    writer = QPdfWriter(str(path))
    writer.setResolution(RESOLUTION_DPI)
    writer.setPageSize(page_size(is_letter))
    writer.setTitle(document.metaInformation(QTextDocument.MetaInformation.DocumentTitle))
    return print_pages(document, writer, str(path))


def print_pages(document: QTextDocument, device: QPagedPaintDevice, name: str) -> int:
    """Paint all pages, numbered, onto a PDF or printer called `name`; returns their number.

    Raises
    ------
    InputError
        The device does not begin: the file cannot be written, or the printer is gone.
    """
    device.setPageMargins(QMarginsF(MARGIN_MM, MARGIN_MM, MARGIN_MM, MARGIN_MM), QPageLayout.Unit.Millimeter)
    painter = QPainter()
    if not painter.begin(device):
        raise InputError(
            say("cannot be written; check the folder, or that no other program holds the file", place=name)
        )
    n_pages = lay_out(document, painter, float(device.width()), float(device.height()))
    for page in range(n_pages):
        if page:
            device.newPage()
        paint_page(document, painter, page)
    painter.end()
    return n_pages


def lay_out(document: QTextDocument, painter: QPainter, width_px: float, height_px: float) -> int:
    """Break a document into pages of a size, with room for a footer; returns their number."""
    painter.setFont(document.defaultFont())
    document.documentLayout().setPaintDevice(painter.device())
    document.setPageSize(QSizeF(width_px, height_px - _footer_px(painter)))
    return document.pageCount()


def paint_page(document: QTextDocument, painter: QPainter, page: int) -> None:
    """Paint one page of a document that is laid out, and its number below it; pages count from 0."""
    width, height = document.pageSize().width(), document.pageSize().height()
    painter.save()
    painter.translate(0.0, -page * height)
    context = QAbstractTextDocumentLayout.PaintContext()
    # But for the last rows: there, the first of a picture at the top of the next page would stand, too.
    context.clip = QRectF(0.0, page * height, width, height - 2.0)
    painter.setClipRect(context.clip)
    # Paper is white in every theme.
    context.palette.setColor(QPalette.ColorRole.Text, Qt.GlobalColor.black)
    document.documentLayout().draw(painter, context)
    painter.restore()
    painter.setPen(Qt.GlobalColor.black)
    number = translate("Page {0} of {1}").format(page + 1, document.pageCount())
    painter.drawText(QRectF(0.0, height, width, _footer_px(painter)), Qt.AlignmentFlag.AlignRight, number)


def _footer_px(painter: QPainter) -> float:
    return painter.fontMetrics().height() * 1.5


def painted_map(site: SiteShapes, plan: PlanShapes, tiles_path: Path, units: UnitSystem) -> QImage:
    """The map of a brief with the tiles of a map file under it.

    Raises
    ------
    InputError
        The map file cannot be used.
    """
    tiles = open_map_file(tiles_path)
    reader = TileReader(tiles)
    try:
        width, height = (round(size * PICTURE_SCALE) for size in MAP_PX)
        picture = QImage(width, height, QImage.Format.Format_RGB32)
        picture.setDevicePixelRatio(PICTURE_SCALE)
        picture.fill(Qt.GlobalColor.white)
        viewport = Viewport().resized(*MAP_PX).fitted(site.extent(), margin_px=30.0)
        decoded: dict[Tile, QImage | None] = {}

        def picture_of(tile: Tile) -> QImage | None:
            if tile not in decoded:
                decoded[tile] = reader.picture(tile)
            return decoded[tile]

        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        paint_tiles(painter, viewport, tiles.info, picture_of, lambda _tile: True)
        paint_site(painter, viewport, site, LIGHT)
        paint_plan(painter, viewport, plan)
        paint_landings(painter, viewport.screen(site.landings()), LIGHT)
        paint_scale_bar(painter, viewport, units, LIGHT)
        paint_north(painter, QRectF(10, 10, 36, 36).center(), LIGHT)
        corner = QRectF(0, 0, *MAP_PX).bottomRight()
        paint_text_box(painter, corner, tiles.info.attribution, LIGHT, is_right=True)
        painter.end()
        return picture
    finally:
        tiles.close()


def _drawn(svg: str) -> QImage:
    from PySide6.QtSvg import QSvgRenderer

    renderer = QSvgRenderer(svg.encode())
    image = QImage((renderer.defaultSize().toSizeF() * PICTURE_SCALE).toSize(), QImage.Format.Format_RGB32)
    image.fill(Qt.GlobalColor.white)
    painter = QPainter(image)
    renderer.render(painter)
    painter.end()
    return image


# The flight brief on screen, to be printed or saved as PDF.


class BriefDialog(QDialog):
    """The brief of a plan that was checked; `tiles` is the map file that lies under its map."""

    def __init__(
        self,
        context: ApplicationContext,
        checked: Preflight,
        tiles: Path | None,
        folder: Path,
        parent: QWidget | None = None,
        ground_risk: GroundRiskRequest | None = None,
    ) -> None:
        super().__init__(parent)
        self._is_closed = False
        self.finished.connect(self._let_go)
        self.setWindowTitle(self.tr("Flight brief"))
        plan, site_model = checked.plan, checked.site_model
        self._context, self._folder, self._name = context, folder, site_model.site.name
        self._units = context.units
        self._html = ""
        self._pictures: dict[str, str | QImage] = {}
        self._document: BriefDocument | None = None
        entry = context.document.current
        today = QLocale().toString(QDate.currentDate(), QLocale.FormatType.LongFormat)
        title = entry.title if entry is not None and entry.plan is plan else ""
        found = flight_brief(
            site_model, plan, checked.findings, today, title, day=checked.day, sun=checked.sun, ground_risk=ground_risk
        )
        self._sun = checked.sun
        self._brief = found.in_words(lambda line: printed(line, self._units))
        self._page, self._paper = QTextBrowser(), ChoiceBox()
        # Paper is white in every theme.
        self._page.setStyleSheet("QTextBrowser { background: #ffffff; color: #000000; }")
        self._paper.addItem(self.tr("A4"), False)
        self._paper.addItem(self.tr("US Letter"), True)
        self._paper.setCurrentIndex(int(is_letter_usual(context.units)))
        self._save = QPushButton(self.tr("Save as PDF ..."))
        self._save.setDefault(True)
        self._save.setProperty("primary", True)
        self._print = QPushButton(self.tr("Print ..."))
        close = QPushButton(self.tr("Close"))
        bar = QHBoxLayout()
        bar.addWidget(QLabel(self.tr("Paper")))
        bar.addWidget(self._paper)
        bar.addStretch(1)
        for button in (close, self._print, self._save):
            bar.addWidget(button)
        layout = QVBoxLayout(self)
        layout.addWidget(self._page, 1)
        layout.addWidget(DialogFoot(context))
        layout.addLayout(bar)
        self.resize(760, 620)
        self._paper.currentIndexChanged.connect(self._lay_out)
        self._save.clicked.connect(self._choose_pdf)
        self._print.clicked.connect(self._choose_printer)
        close.clicked.connect(self.reject)
        self._set_ready(False)
        self._page.setPlainText(self.tr("Drawing the map and the profiles ..."))
        self._draw(site_model, plan, tiles)

    def is_ready(self) -> bool:
        """Whether the brief is laid out."""
        return self._document is not None

    def page_text(self) -> str:
        """What the page says."""
        return self._page.toPlainText()

    def save_pdf(self, path: Path) -> bool:
        """Write the brief; False where that is not possible, which is told."""
        try:
            write_pdf(self._fresh(), path, bool(self._paper.currentData()))
        except InputError as error:
            self._context.say(Severity.ERROR, self._context.localized(str(error)))
            return False
        self._context.say(Severity.OK, self.tr("Written: {0}").format(path))
        return True

    def _draw(self, site_model: SiteModel, plan: Plan, tiles: Path | None) -> None:
        units, sun = self._units, self._sun

        def localize(text: str) -> str:
            return translated(text, units)

        def work(_context: JobContext) -> tuple[dict[str, str | QImage], str]:
            drawn = brief_pictures(site_model, plan, units, translate, sun, localize)
            pictures: dict[str, str | QImage] = {**drawn}
            try:
                if tiles is not None:
                    shapes = site_shapes(site_model), plan_shapes(plan, site_model.site.origin)
                    pictures[MAP] = painted_map(*shapes, tiles, units)
            except InputError as error:
                return pictures, str(error)
            return pictures, ""

        self._context.start(self.tr("Flight brief"), work, self._when_drawn)

    def _when_drawn(self, result: tuple[dict[str, str | QImage], str]) -> None:
        if self._is_closed:
            return
        self._pictures, objection = result
        if objection:
            self._context.say(Severity.WARNING, self._context.localized(objection))
        self._lay_out()

    def _let_go(self) -> None:
        """Closed: nothing more is drawn, and nothing is left in the window."""
        self._is_closed = True
        self.deleteLater()

    def _lay_out(self) -> None:
        if not self._pictures:
            return
        names = {name: name for name in self._pictures}
        is_letter = bool(self._paper.currentData())
        self._html = brief_html(self._brief, self._units, names, translate, is_letter=is_letter)
        self._document = self._fresh()
        self._document.setDocumentMargin(12.0)
        self._page.setDocument(self._document)
        self._set_ready(True)

    def _fresh(self) -> BriefDocument:
        """A document for one device: a layout for paper does not fit the screen."""
        return BriefDocument(self._html, self._pictures)

    def _set_ready(self, is_ready: bool) -> None:
        for button in (self._save, self._print):
            button.setEnabled(is_ready)

    def _choose_pdf(self) -> None:
        proposed, kinds = self._folder / f"{file_name(self._name)}.pdf", self.tr("PDF (*.pdf)")
        path = choose_new_file(self, self.tr("Save the flight brief"), proposed, kinds, ".pdf")
        if path is not None:
            self.save_pdf(path)

    def _choose_printer(self) -> None:
        from PySide6.QtPrintSupport import QPrintDialog, QPrinter

        printer = QPrinter(QPrinter.PrinterMode.HighResolution)
        printer.setPageSize(page_size(bool(self._paper.currentData())))
        if QPrintDialog(printer, self).exec() == QDialog.DialogCode.Accepted:
            try:
                print_pages(self._fresh(), printer, printer.printerName())
            except InputError as error:
                self._context.say(Severity.ERROR, self._context.localized(str(error)))


def is_letter_usual(units: UnitSystem) -> bool:
    """Whether people who read these units here print on US Letter."""
    usual = QLocale().measurementSystem() == QLocale.MeasurementSystem.ImperialUSSystem
    return usual or units is UnitSystem.IMPERIAL
