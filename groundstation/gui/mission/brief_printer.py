"""The flight brief on paper: the page of `brief_html` laid out by Qt, onto a PDF or a printer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QMarginsF, QRectF, QSizeF, Qt, QUrl
from PySide6.QtGui import (
    QAbstractTextDocumentLayout,
    QImage,
    QPagedPaintDevice,
    QPageLayout,
    QPageSize,
    QPainter,
    QPalette,
    QPdfWriter,
    QTextDocument,
)

from groundstation.gui.map.map_paint import (
    paint_landings,
    paint_north,
    paint_plan,
    paint_scale_bar,
    paint_site,
    paint_text_box,
    paint_tiles,
)
from groundstation.gui.map.tile_store import decode_tile
from groundstation.gui.map.viewport import Viewport
from groundstation.gui.widgets.theme import LIGHT
from groundstation.services.map.shapes import PlanShapes, SiteShapes
from groundstation.services.map.tiles import MapTiles
from groundstation.services.map.web_mercator import Tile
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError

MARGIN_MM = 15.0
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
    QT_TRANSLATE_NOOP("Brief", "Coverage of what can be covered"),
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
    QT_TRANSLATE_NOOP("Brief", "fly the mission to its end"),
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
    QT_TRANSLATE_NOOP("Brief", "Focus, exposure and white balance are fixed on the facade"),
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
        raise InputError(f"{name}: cannot be written; check the folder, or that no other program holds the file")
    n_pages = lay_out(document, painter, float(device.width()), float(device.height()))
    for page in range(n_pages):
        if page:
            device.newPage()
        paint_page(document, painter, page)
    painter.end()
    return n_pages


def lay_out(document: QTextDocument, painter: QPainter, width_px: float, height_px: float) -> int:
    """Break a document into pages of a size, with room for a footer; returns their number."""
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
    tiles = MapTiles(tiles_path)
    try:
        width, height = (round(size * PICTURE_SCALE) for size in MAP_PX)
        picture = QImage(width, height, QImage.Format.Format_RGB32)
        picture.setDevicePixelRatio(PICTURE_SCALE)
        picture.fill(Qt.GlobalColor.white)
        viewport = Viewport().resized(*MAP_PX).fitted(site.extent(), margin_px=30.0)
        decoded: dict[Tile, QImage | None] = {}

        def picture_of(tile: Tile) -> QImage | None:
            if tile not in decoded:
                decoded[tile] = decode_tile(tiles.image(tile))
            return decoded[tile]

        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        levels = tiles.info.min_zoom, tiles.info.max_zoom
        paint_tiles(painter, viewport, levels, picture_of, lambda _tile: True)
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
