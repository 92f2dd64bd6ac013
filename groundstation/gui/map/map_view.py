"""The 2-D map: tiles or a metric grid, overlays, the site's footprint, and the plan's routes and viewpoints.

Site and plan are painted into a picture of their own (`MapLayer`): panning and zooming only move it, and once the map
rests it is painted sharp again.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QMargins, QPoint, QPointF, QRect, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QPaintEvent, QPen, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QToolButton, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.map.map_layers import SITE, ZONES, MapLayers
from groundstation.gui.map.map_paint import (
    paint_grid,
    paint_landings,
    paint_legend,
    paint_north,
    paint_note,
    paint_plan,
    paint_ring,
    paint_scale_bar,
    paint_site,
    paint_text_box,
    paint_volumes,
    paint_zones,
)
from groundstation.gui.map.online_dialog import OnlineMapDialog
from groundstation.gui.map.viewport import MapCanvas, Viewport
from groundstation.gui.widgets.layer_list import LayerPanel
from groundstation.gui.widgets.questions import agrees, choose_file
from groundstation.gui.widgets.theme import colours, zone_colour
from groundstation.services.map.coordinates import parse_place
from groundstation.services.map.online import OnlineMap
from groundstation.services.map.overlays import FAR_M, OVERLAY_SUFFIXES, distance_m
from groundstation.services.map.shapes import Area, PlanShapes, SiteShapes, airspace_outline, plan_shapes, site_shapes
from groundstation.services.map.web_mercator import MAX_LAT_DEG, geodetic_from_world, world_from_geodetic
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.settings import data_folder
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Origin
from planning.plan import Plan
from planning.site.records import SiteModel
from planning.site.zones.records import RESTRICTIONS, Restriction

# Site and plan painted once into a picture larger than the map, so that panning and zooming only move that picture.

MARGIN = 0.5
"""Part of its width and height by which the picture reaches beyond the map on each side."""

SAME_ZOOM = 1e-6


class MapLayer:
    """The picture, and the viewport that it was painted for."""

    def __init__(self) -> None:
        self._picture: QImage | None = None
        self._made_for = Viewport()

    def forget(self) -> None:
        """What it shows has changed."""
        self._picture = None

    def is_usable(self) -> bool:
        """Whether there is a picture at all."""
        return self._picture is not None

    def is_sharp(self, viewport: Viewport) -> bool:
        """Whether the picture has the zoom of what is in sight and reaches all of it."""
        if self._picture is None or abs(viewport.zoom - self._made_for.zoom) > SAME_ZOOM:
            return False
        return self._target(viewport).contains(QRectF(0.0, 0.0, viewport.width_px, viewport.height_px))

    def make(
        self, viewport: Viewport, paint: Callable[[QPainter, Viewport], None], font: QFont, pixel_ratio: float
    ) -> None:
        """Paint shapes for what is in sight and its margin."""
        width, height = (round(size * (1.0 + 2.0 * MARGIN)) for size in (viewport.width_px, viewport.height_px))
        wide = viewport.resized(width, height)
        picture = QImage(
            round(width * pixel_ratio), round(height * pixel_ratio), QImage.Format.Format_ARGB32_Premultiplied
        )
        picture.setDevicePixelRatio(pixel_ratio)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setFont(font)
        paint(painter, wide)
        painter.end()
        self._picture, self._made_for = picture, wide

    def paint(self, painter: QPainter, viewport: Viewport) -> None:
        """Put the picture where it belongs in what is in sight, stretched where the zoom has changed since."""
        if self._picture is None:
            return
        target = self._target(viewport)
        if abs(viewport.zoom - self._made_for.zoom) <= SAME_ZOOM:
            painter.drawImage(QPointF(round(target.x()), round(target.y())), self._picture)
        else:
            painter.drawImage(target, self._picture, QRectF(self._picture.rect()))

    def _target(self, viewport: Viewport) -> QRectF:
        drawn_for = self._made_for
        stretch = viewport.scale / drawn_for.scale
        width, height = drawn_for.width_px * stretch, drawn_for.height_px * stretch
        x = (drawn_for.centre[0] - viewport.centre[0]) * viewport.scale + (viewport.width_px - width) / 2.0
        y = (drawn_for.centre[1] - viewport.centre[1]) * viewport.scale + (viewport.height_px - height) / 2.0
        return QRectF(x, y, width, height)


# What is where on the map: from a pixel to the thing drawn there, and from a thing to its place.

REACH_PX = 14.0
"""How far from a point a finger or mouse may be to mean it."""

LINE_REACH_PX = 7.0


def find_item(
    at_px: NDArray[np.float64], viewport: Viewport, site: SiteShapes | None, plan: PlanShapes | None
) -> Item | None:
    """The thing at a pixel, shape (2,): points first, then panels, then what covers ground."""
    if plan is not None and len(plan.viewpoints):
        away = np.linalg.norm(viewport.screen(plan.viewpoints) - at_px, axis=1)
        nearest = int(np.argmin(away))
        if away[nearest] <= REACH_PX:
            return Item(ItemKind.VIEWPOINT, plan.viewpoint_ids[nearest])
    if site is None:
        return None
    landings = np.linalg.norm(viewport.screen(site.landings()) - at_px, axis=1)
    nearest = int(np.argmin(landings))
    if landings[nearest] <= REACH_PX:
        return site.rally[nearest - 1][0] if nearest else Item(ItemKind.HOME)
    for item, panels in site.facades:
        corners = viewport.screen(panels.reshape(-1, 2)).reshape(-1, 4, 2)
        if _distance_px(corners, np.roll(corners, -1, axis=1), at_px) <= LINE_REACH_PX:
            return item
    areas = (*site.no_fly, *reversed(site.solids), *site.zones)
    return next((area.item for area in areas if _is_inside(area, viewport, at_px)), None)


def place_of(item: Item, site: SiteShapes | None, plan: PlanShapes | None) -> NDArray[np.float64] | None:
    """World coordinates of a thing, shape (n, 2), n >= 1; None where the map does not show it."""
    if plan is not None:
        if item.kind is ItemKind.VIEWPOINT and item.id in plan.viewpoint_ids:
            place: NDArray[np.float64] = plan.viewpoints[plan.viewpoint_ids.index(item.id)][None]
            return place
        if item.kind in (ItemKind.SORTIE, ItemKind.LEG):
            return _place_on_route(item, plan)
    if site is None:
        return None
    if item.kind is ItemKind.HOME:
        return site.home[None]
    if item.kind is ItemKind.AIRSPACE:
        return site.airspace.rings[0]
    if item.kind is ItemKind.RALLY:
        return next((place[None] for point, place in site.rally if point == item), None)
    areas = (*site.no_fly, *site.solids, *site.zones)
    found = next((area for area in areas if area.item == item), None)
    if found is not None and found.rings:
        return np.concatenate(found.rings)
    return next((panels.reshape(-1, 2) for facade, panels in site.facades if facade == item), None)


def _place_on_route(item: Item, plan: PlanShapes) -> NDArray[np.float64] | None:
    number, _, leg = item.id.partition("/")
    if not number.isdecimal() or not 1 <= int(number) <= len(plan.routes):
        return None
    route = plan.routes[int(number) - 1]
    if item.kind is ItemKind.SORTIE:
        return route if len(route) else None
    end = int(leg) if leg.isdecimal() else 0
    return route[end - 1 : end + 1] if 1 <= end < len(route) else None


def _distance_px(starts: NDArray[np.float64], ends: NDArray[np.float64], at_px: NDArray[np.float64]) -> float:
    """Distance of a pixel to the nearest of many segments, shapes (..., 2)."""
    legs, rays = ends - starts, at_px - starts
    along = np.clip((rays * legs).sum(axis=-1) / np.maximum((legs**2).sum(axis=-1), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(rays - along[..., None] * legs, axis=-1).min())


def _is_inside(area: Area, viewport: Viewport, at_px: NDArray[np.float64]) -> bool:
    """Even-odd rule over all rings."""
    inside = False
    for ring in area.rings:
        a = viewport.screen(ring) - at_px
        b = np.roll(a, -1, axis=0)
        crosses = (a[:, 1] > 0.0) != (b[:, 1] > 0.0)
        a, b = a[crosses], b[crosses]
        right = (b[:, 0] - a[:, 0]) * -a[:, 1] / (b[:, 1] - a[:, 1]) + a[:, 0] > 0.0
        inside ^= bool(np.count_nonzero(right) % 2)
    return inside


MARGIN_PX = 64.0
"""Around the site when all of it is shown: room for the scale bar and the note above it."""

FOUND_ZOOM = 17.0
"""How near a place that was searched for is looked at, at least."""

SEARCH_PX = 250

EDGES = QMargins(56, 8, 8, 42)
"""Around the buttons: room for the north arrow and the scale bar."""

ONLINE_FOLDER = "map-tiles"
"""Where tiles of online maps are kept, in the folder for data."""

FOCUS_PX = 2.0
"""Of the line around a map that has the keyboard, as around a button."""

REST_MS = 60
"""Without zooming for so long, the stretched picture is painted anew."""


class MapView(MapCanvas):
    """Shows what it is given; north is up.

    Signals
    -------
    picked(Item or None)
        The user clicked a thing, or nothing.
    hovered(Item or None)
    mapChanged(Path)
        Another map file was opened.
    refused(str)
        A map file or an overlay could not be opened, and why, in the window's language.
    placePicked(float, float), pickEnded()
        Latitude and longitude that the user clicked after `start_pick`; that has ended, picked or not.
    onlineChanged(OnlineMap), overlaysChanged(tuple of Path)
        The user has set the online map up otherwise; there are other overlays.
    """

    picked = Signal(object)
    hovered = Signal(object)
    mapChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    refused = Signal(object)
    placePicked = Signal(float, float)  # noqa: N815
    pickEnded = Signal()  # noqa: N815
    onlineChanged = Signal(object)  # noqa: N815
    overlaysChanged = Signal(object)  # noqa: N815
    _shapesReady = Signal(object, object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._model: SiteModel | None = None
        self._plan: Plan | None = None
        self._site: SiteShapes | None = None
        self._plan_shapes: PlanShapes | None = None
        self._volumes: tuple[tuple[QColor, tuple[NDArray[np.float64], ...]], ...] = ()
        self._selection: Item | None = None
        self._hover: Item | None = None
        self._pointer: QPointF | None = None
        self._units = UnitSystem.METRIC
        self._refusal = ""
        self._insets = QMargins()
        self._was_fitted = False
        self._layer = MapLayer()
        self._sharpen_soon = QTimer(self, interval=REST_MS, singleShot=True)
        self._sharpen_soon.timeout.connect(self._sharpen)
        self._pick_hint = ""
        self._found: tuple[float, float] | None = None
        self._not_found = ""
        self.layers = MapLayers(self)
        self.layers.changed.connect(self.update)
        self.layers.shapesChanged.connect(self._draw_anew)
        self.layers.rowsChanged.connect(self._show_rows)
        self.layers.refused.connect(self._refuse)
        self.layers.overlayAdded.connect(self._bring_in_overlay)
        self.layers.overlaysChanged.connect(self.overlaysChanged)
        self._shapesReady.connect(self._take_shapes)
        self.clicked.connect(self._clicked)
        self.pointed.connect(self._pointed)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMinimumSize(200, 150)
        self.setAccessibleName(self.tr("Map"))
        self._add_buttons()

    def set_document(self, document: Document) -> None:
        """Show the site and the current plan of a document."""
        self.set_site(document.site)
        self.set_plan(None if document.current is None else document.current.plan)

    def set_site(self, model: SiteModel | None) -> None:
        """Show a site; its outlines come when they are computed. Another place is brought into view."""
        if model is self._model:
            return
        is_elsewhere = model is None or self._model is None or model.site.origin != self._model.site.origin
        self._model, self._was_fitted = model, self._was_fitted and not is_elsewhere
        if is_elsewhere:
            self._site = None
        self._fit_once()
        self._draw_plan_anew()
        if model is None:
            self._shapesReady.emit(None, None)
        else:
            threading.Thread(target=self._compute_shapes, args=(model,), name="map-shapes", daemon=True).start()

    def set_plan(self, plan: Plan | None) -> None:
        """Show a plan, or none."""
        if plan is not self._plan:
            self._plan = plan
            self._draw_plan_anew()

    def set_volumes(self, volumes: Sequence[tuple[QColor, tuple[NDArray[np.float64], ...]]]) -> None:
        """Show areas below site and plan, such as those of ground risk: colour and rings in world coordinates."""
        self._volumes = tuple(volumes)
        self._draw_anew()

    def look_at_volumes(self) -> None:
        """Bring all areas that are shown into view."""
        rings = [ring for _colour, rings in self._volumes for ring in rings]
        if rings:
            self.set_viewport(self._viewport.fitted(np.concatenate(rings), MARGIN_PX))

    def set_selection(self, item: Item | None) -> None:
        """Mark a thing."""
        if item != self._selection:
            before, self._selection = self._focus(), item
            if self._focus() != before:
                self._draw_anew()
            self.update()

    def _focus(self) -> int:
        """Sortie that is looked at, counted from 1; 0 for none."""
        item, plan = self._selection, self._plan_shapes
        if item is None or plan is None:
            return 0
        if item.kind in (ItemKind.SORTIE, ItemKind.LEG):
            number = item.id.partition("/")[0]
            return int(number) if number.isdecimal() and int(number) <= len(plan.routes) else 0
        if item.kind is ItemKind.VIEWPOINT and item.id in plan.viewpoint_ids:
            return int(plan.sortie_of[plan.viewpoint_ids.index(item.id)])
        return 0

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self.update()

    def set_insets(self, insets: QMargins) -> None:
        """Keep buttons and marks away from the edges, where something else lies over them."""
        self._insets = insets
        self._row.setContentsMargins(EDGES + insets)
        self.update()

    def open_map(self, path: Path) -> bool:
        """Put tiles of a file under the site; False where it cannot be used, which `refused` tells."""
        try:
            self.layers.open_file(path)
        except InputError as error:
            self._refuse(str(error))
            return False
        self._refusal = ""
        self.mapChanged.emit(path)
        if self._model is None:
            self._look_at_map()
        self.update()
        return True

    def map_file(self) -> Path | None:
        """The map that is shown."""
        source = self.layers.file.source()
        return None if source is None else source.info.path

    def set_online(self, online: OnlineMap) -> None:
        """Set the online map up; one that cannot be used is told."""
        try:
            self.layers.set_online(online, data_folder() / ONLINE_FOLDER)
        except InputError as error:
            self._refuse(str(error))

    def add_overlay(self, path: Path) -> None:
        """Put an overlay on the map, once it is read."""
        self._refusal = ""
        self.layers.add_overlay(path)

    def find_place(self, text: str) -> bool:
        """Bring the place of a text to the middle and mark it; False where it is none, which the map says."""
        try:
            lat, lon = parse_place(text)
        except InputError as error:
            self._not_found, self._found = translated(str(error), self._units), None
            self.update()
            return False
        self._not_found, self._found = "", (lat, lon)
        if abs(lat) >= MAX_LAT_DEG:
            self._not_found = self.tr("This place lies beyond the end of web maps (85.05 degrees).")
        place = world_from_geodetic(lat, lon)
        self.set_viewport(self._viewport.fitted(place, max_zoom=max(self._viewport.zoom, FOUND_ZOOM)))
        return True

    def start_pick(self, hint: str) -> None:
        """Let the user click a place; `hint` says what for."""
        self._pick_hint = hint
        self.setCursor(Qt.CursorShape.CrossCursor)
        self.setFocus()
        self.update()

    def is_picking(self) -> bool:
        """Whether a place is waited for."""
        return bool(self._pick_hint)

    def cancel_pick(self) -> None:
        """Wait for a place no longer."""
        if self._pick_hint:
            self._pick_hint = ""
            self.unsetCursor()
            self.update()
            self.pickEnded.emit()

    def look_at(self, item: Item) -> None:
        """Bring a thing to the middle; near enough to see it."""
        place = place_of(item, self._site, self._plan_shapes)
        if place is not None:
            fitted = self._viewport.fitted(place, margin_px=80.0, max_zoom=max(self._viewport.zoom, 19.0))
            self.set_viewport(fitted)

    def look_at_all(self) -> None:
        """Bring the whole site into view."""
        extent = self._site.extent() if self._site is not None else self.layers.extent()
        if extent is not None:
            self.set_viewport(self._viewport.fitted(extent, MARGIN_PX))
        else:
            self._look_at_map()

    def is_complete(self) -> bool:
        """Whether everything that is in sight is drawn: outlines are there, and no tile is waited for."""
        return (self._model is None) == (self._site is None) and not self.layers.is_busy()

    def is_sharp(self) -> bool:
        """Whether shapes are painted for what is in sight, rather than moved and stretched."""
        return self._layer.is_sharp(self._viewport)

    def note(self) -> str:
        """What is to be done, or stands in the way of a map: a file that was refused, none, or one of another place."""
        if self._pick_hint or self._not_found or self._refusal:
            return self._pick_hint or self._not_found or self._refusal
        if self._site is not None and not self._site.is_on_map:
            return self.tr("This site lies beyond the end of web maps (85.05 degrees); use the 3-D view.")
        source = self.layers.file.source()
        if self.layers.online().is_on:
            return translated(self.layers.problem(), self._units)
        if source is None and self._model is None:
            return self.tr("Open or import a site on the Site tab, or a map with “Map file”; no network is used.")
        if source is None:
            return self.tr('No map is loaded. "Map file" opens one (MBTiles, PMTiles); no network is used.')
        if self._site is not None and not _covers(source.info.bounds_deg, self._viewport):
            return self.tr('The map "{0}" does not cover this place.').format(source.info.name)
        return ""

    def close_view(self) -> None:
        """End reading tiles; call before the widget goes away."""
        self.layers.close()

    def sizeHint(self) -> QSize:  # noqa: N802
        """Room for a site."""
        return QSize(500, 400)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint tiles or grid, the layers, and the marks of every map."""
        found, viewport = colours(), self._viewport
        painter = QPainter(self)
        painter.fillRect(event.rect(), QColor(found.scene))
        self.layers.paint_tiles(painter, viewport)
        if self._site is not None and not self._has_ground():
            paint_grid(painter, viewport, self._site.home, self._units, found.line)
        self._paint_layer(painter)
        self._paint_marks(painter)
        if self.hasFocus():
            painter.setPen(QPen(QColor(found.accent), FOCUS_PX))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self.rect()).adjusted(1.0, 1.0, -1.0, -1.0))
        painter.end()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the centre; the first size shows the whole site."""
        super().resizeEvent(event)
        self._fit_once()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Paint in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._draw_anew()

    def item_at(self, at: QPointF) -> Item | None:
        """What is drawn at a point of the widget; the nearest of what is small comes before what is large."""
        site = self._site if self.layers.state(SITE).is_visible else None
        if site is not None and not self.layers.state(ZONES).is_visible:
            site = replace(site, zones=())
        plan = self._plan_shapes
        if plan is not None:
            strengths = self.layers.sortie_strengths(len(plan.routes))
            plan = plan.without({number for number, strength in strengths.items() if not strength})
        return find_item(np.array([at.x(), at.y()]), self._viewport, site, plan)

    def pointer_text(self) -> str:
        """Latitude and longitude under the pointer (WGS 84); empty where there is none."""
        if self._pointer is None:
            return ""
        lat, lon = geodetic_from_world(*self._viewport.world(self._pointer.x(), self._pointer.y()))
        return coordinates_text(lat, lon)

    def search(self) -> QLineEdit:
        """The line for coordinates."""
        return self._search

    def layer_panel(self) -> LayerPanel:
        """The list of layers; hidden until "Layers" is pressed."""
        return self._panel

    def _add_buttons(self) -> None:
        self._search = QLineEdit()
        self._search.setPlaceholderText(self.tr("Find coordinates, UTM, MGRS"))
        self._search.setAccessibleName(self.tr("Find a place by its coordinates"))
        self._search.setToolTip(self.tr("Coordinates of a place (WGS 84), then Enter"))
        self._search.setClearButtonEnabled(True)
        self._search.setFixedWidth(SEARCH_PX)
        self._search.returnPressed.connect(lambda: self.find_place(self._search.text()))
        self._search.textEdited.connect(self._search_edited)
        self._panel = LayerPanel(self.tr("Layers"), self)
        self._panel.list.changed.connect(self.layers.set_state)
        self._panel.list.removed.connect(self.layers.remove)
        for text, tip, slot in (
            (self.tr("Overlay ..."), self.tr("Put GeoJSON, KML, KMZ or GeoTIFF on the map"), self._choose_overlay),
            (self.tr("Online map ..."), self.tr("A server for map tiles; off until you agree"), self.set_online_up),
        ):
            below = QPushButton(text)
            below.setToolTip(tip)
            below.clicked.connect(lambda _checked=False, slot=slot: slot())
            self._panel.add(below)
        self._panel.hide()
        column = self._column = QVBoxLayout()
        for text, tip, slot in (
            ("+", self.tr("Nearer (+)"), lambda: self.zoom_by(1.0)),
            ("−", self.tr("Further away (-)"), lambda: self.zoom_by(-1.0)),
            (self.tr("Fit"), self.tr("Show the whole site (F)"), self.look_at_all),
            (
                self.tr("Map file"),
                self.tr("Open a map file (MBTiles or PMTiles) to put under the site"),
                self._choose_map,
            ),
        ):
            button = QToolButton(self)
            button.setText(text)
            button.setToolTip(tip)
            button.setCursor(Qt.CursorShape.ArrowCursor)
            button.clicked.connect(lambda _checked=False, slot=slot: slot())
            column.addWidget(button, 0, Qt.AlignmentFlag.AlignRight)
        shown = QToolButton(self)
        shown.setText(self.tr("Layers"))
        shown.setToolTip(self.tr("What is shown on the map, and how strongly; overlays and the online map"))
        shown.setCheckable(True)
        shown.setCursor(Qt.CursorShape.ArrowCursor)
        shown.toggled.connect(self._panel.setVisible)
        column.addWidget(shown, 0, Qt.AlignmentFlag.AlignRight)
        column.addStretch(1)
        row = self._row = QHBoxLayout(self)
        row.setContentsMargins(EDGES)
        row.addWidget(self._search, 0, Qt.AlignmentFlag.AlignTop)
        row.addStretch(1)
        row.addWidget(self._panel, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(column)
        self._show_rows()

    def _show_rows(self) -> None:
        has_zones = self._site is not None and len(self._site.zones) > 0
        n_sorties = 0 if self._plan is None else len(self._plan.sorties)
        rows = self.layers.rows(has_site=self._model is not None, n_sorties=n_sorties, has_zones=has_zones)
        self._panel.setValue(rows)

    def _search_edited(self, text: str) -> None:
        self._not_found = ""
        if not text:
            self._found = None
        self.update()

    def _refuse(self, text: str) -> None:
        self._refusal = translated(text, self._units)
        self.update()
        self.refused.emit(self._refusal)

    def _choose_overlay(self) -> None:
        kinds = " ".join(f"*{suffix}" for suffix in OVERLAY_SUFFIXES)
        path = choose_file(self, self.tr("Overlay for the map"), self.tr("Overlays ({0})").format(kinds))
        if path is not None:
            self.add_overlay(path)

    def set_online_up(self) -> None:
        """Ask for the server of an online map, and whether it may be used."""
        dialog = OnlineMapDialog(self.layers.online(), self._units, self)
        dialog.valueChanged.connect(self._online_edited)
        dialog.exec()
        dialog.deleteLater()

    def _online_edited(self, online: OnlineMap) -> None:
        self._refusal = ""
        self.set_online(online)
        self.onlineChanged.emit(online)

    def _bring_in_overlay(self, key: str) -> None:
        """Show where a new overlay lies, where nothing of it is in sight; far from the site only after a question."""
        if self._model is not None and not self._is_placed(key, self._model.site.origin):
            return
        extent = self.layers.overlay(key).extent()
        points = self._viewport.screen(extent)
        size = (self._viewport.width_px, self._viewport.height_px)
        is_in_sight = (points.max(axis=0) >= 0.0).all() and (points.min(axis=0) <= size).all()
        if not is_in_sight or self._model is None:
            self.set_viewport(self._viewport.fitted(extent, MARGIN_PX))

    def _is_placed(self, key: str, site: Origin) -> bool:
        """Whether an overlay lies at the site, as it is or with its axes swapped once the user says so."""
        overlay = self.layers.overlay(key)
        away_m = distance_m(overlay.extent(), site.lat_deg, site.lon_deg)
        if overlay.is_swapped:
            text = self.tr(
                "In {0} latitudes stand where longitudes have to: as it is, it has no place on earth. Show it with "
                "both swapped?"
            ).format(overlay.name)
            if not agrees(self, self.tr("Swapped coordinates?"), text):
                self.layers.remove(key)
                return False
        elif away_m > FAR_M and overlay.picture is None:
            swapped_m = distance_m(overlay.swapped().extent(), site.lat_deg, site.lon_deg)
            text = self.tr(
                "{0} lies {1} km from the site. With latitude and longitude swapped it lies at the site. Swap them on "
                "the map? The file stays as it is."
            ).format(overlay.name, round(away_m / 1e3))
            if swapped_m <= FAR_M and agrees(self, self.tr("Swapped coordinates?"), text):
                self.layers.swap_axes(key)
                return True
        if away_m > FAR_M:
            self._refuse(
                say(
                    "overlay {} lies {:.0f} km from the site, and the map stays where it is; remove it in Layers where "
                    "it is the wrong file",
                    overlay.name,
                    away_m / 1e3,
                )
            )
        return away_m <= FAR_M

    def _has_ground(self) -> bool:
        """Whether a map lies under what is in sight."""
        if not self.layers.has_tiles():
            return False
        source = self.layers.file.source()
        return self.layers.online().is_on or source is None or _covers(source.info.bounds_deg, self._viewport)

    def _clicked(self, at: QPointF) -> None:
        if self._pick_hint:
            lat, lon = geodetic_from_world(*self._viewport.world(at.x(), at.y()))
            self._pick_hint = ""
            self.unsetCursor()
            self.update()
            self.placePicked.emit(lat, lon)
            self.pickEnded.emit()
            return
        self.picked.emit(self.item_at(at))

    def _pointed(self, at: QPointF | None) -> None:
        self._pointer = at
        item = None if at is None else self.item_at(at)
        if item != self._hover:
            self._hover = item
            self.setToolTip(self._name_of(item, is_long=True))
            self.hovered.emit(item)
        self.update()

    def _name_of(self, item: Item | None, *, is_long: bool = False) -> str:
        """What a thing is called on the map; of a geo-zone also what it asks for, where `is_long`."""
        if item is None:
            return ""
        zones = () if self._site is None else self._site.zones
        zone = next((area for area in zones if area.item == item), None)
        if zone is None:
            return item.id
        return translated(zone.what, self._units) if is_long else zone.name

    def legend(self) -> list[tuple[QColor, bool, str]]:
        """Colours of the geo-zones that are shown, whether flights keep out of them, and what they mean."""
        rows: dict[tuple[Restriction, bool], tuple[QColor, bool, str]] = {}
        is_shown = self.layers.state(ZONES).is_visible
        for zone in self._site.zones if self._site is not None and is_shown else ():
            text = translated(RESTRICTIONS[zone.restriction], self._units)
            if not zone.is_kept:
                text = self.tr("{0}: not kept out of").format(text)
            rows[zone.restriction, zone.is_kept] = QColor(zone_colour(zone.restriction, colours())), zone.is_kept, text
        return [rows[key] for key in sorted(rows, key=lambda key: (list(Restriction).index(key[0]), not key[1]))]

    def _choose_map(self) -> None:
        path = choose_file(self, self.tr("Open map"), self.tr("Offline maps (*.mbtiles *.pmtiles);;All files (*)"))
        if path is not None:
            self.open_map(path)

    def _compute_shapes(self, model: SiteModel) -> None:
        self._shapesReady.emit(model, site_shapes(model))

    def _take_shapes(self, model: SiteModel | None, shapes: SiteShapes | None) -> None:
        if model is self._model:
            self._site = shapes
            self._show_rows()
            self._fit_once()
            self._draw_anew()

    def _draw_plan_anew(self) -> None:
        self._plan_shapes = None
        if self._plan is not None and self._model is not None:
            self._plan_shapes = plan_shapes(self._plan, self._model.site.origin)
        self._show_rows()
        self._draw_anew()

    def _draw_anew(self) -> None:
        self._layer.forget()
        self.update()

    def _fit_once(self) -> None:
        """Bring a new site into view, once the widget has its size."""
        if self._was_fitted or self._model is None or not self.isVisible():
            return
        site = self._model.site
        if self._site is not None:
            self._was_fitted = True
            self._viewport = self._viewport.fitted(self._site.extent(), MARGIN_PX)
        elif abs(site.origin.lat_deg) < MAX_LAT_DEG:
            # Outlines take a moment; the place is known at once.
            self._viewport = self._viewport.fitted(airspace_outline(site), MARGIN_PX)

    def showEvent(self, event: QEvent) -> None:  # noqa: N802
        """The size is known now."""
        super().showEvent(event)  # type: ignore[arg-type]
        self._fit_once()

    def _look_at_map(self) -> None:
        source = self.layers.file.source()
        if source is not None and source.info.bounds_deg is not None:
            west, south, east, north = source.info.bounds_deg
            self.set_viewport(self._viewport.fitted(world_from_geodetic([south, north], [west, east])))

    def _paint_layer(self, painter: QPainter) -> None:
        if not self._has_site_to_paint() and self.layers.extent() is None:
            return
        if not self._layer.is_usable():
            self._sharpen()
        elif not self._layer.is_sharp(self._viewport):
            self._sharpen_soon.start()
        self._layer.paint(painter, self._viewport)

    def _sharpen(self) -> None:
        self._layer.make(self._viewport, self._paint_shapes, self.font(), self.devicePixelRatioF())
        self.update()

    def _has_site_to_paint(self) -> bool:
        return self._site is not None and self._site.is_on_map

    def _paint_shapes(self, painter: QPainter, viewport: Viewport) -> None:
        """Overlays, site and plan, each as strongly as its layer is shown."""
        found, site, plan = colours(), self._site, self._plan_shapes
        self.layers.paint_overlays(painter, viewport, found)
        if site is None or not site.is_on_map:
            return
        paint_volumes(painter, viewport, self._volumes)
        of_site = self.layers.state(SITE)
        of_zones = self.layers.state(ZONES)
        if of_zones.is_visible:
            painter.setOpacity(of_zones.opacity)
            paint_zones(painter, viewport, site.zones, found)
        painter.setOpacity(of_site.opacity)
        if of_site.is_visible:
            paint_site(painter, viewport, site, found)
        if plan is not None:
            paint_plan(painter, viewport, plan, self.layers.sortie_strengths(len(plan.routes), self._focus()))
            painter.setOpacity(of_site.opacity)
        if of_site.is_visible:
            paint_landings(painter, viewport.screen(site.landings()), found)
        painter.setOpacity(1.0)

    def _paint_marks(self, painter: QPainter) -> None:
        found, viewport = colours(), self._viewport
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._selection is not None and self._site is not None and self._site.is_on_map:
            place = place_of(self._selection, self._site, self._plan_shapes)
            if place is not None:
                name = self._name_of(self._selection)
                paint_ring(painter, viewport.screen(place.mean(axis=0)[None])[0], name, found)
        if self._found is not None:
            lat, lon = self._found
            place = world_from_geodetic(lat, lon)
            place[:, 0] += round(viewport.centre[0] - place[0, 0])
            paint_ring(painter, viewport.screen(place)[0], coordinates_text(lat, lon), found)
        insets = self._insets
        # Marks stand at the edges of what nothing lies over.
        painter.translate(insets.left(), insets.top())
        wide, high = insets.left() + insets.right(), insets.top() + insets.bottom()
        viewport = viewport.resized(viewport.width_px - wide, viewport.height_px - high)
        if self._model is not None or self.layers.has_tiles() or self.layers.extent() is not None:
            paint_scale_bar(painter, viewport, self._units, found)
            paint_north(painter, QPointF(28, 28), found)
        corner = QPointF(viewport.width_px, viewport.height_px)
        paint_text_box(painter, corner, self.layers.attribution(), found, is_right=True)
        paint_text_box(painter, QPointF(56, 72), self.pointer_text(), found)
        paint_legend(painter, viewport, self.legend(), found)
        buttons = QRectF(QRect(QPoint(), self._column.sizeHint()))
        buttons.moveTopRight(QPointF(viewport.width_px - EDGES.right(), EDGES.top()))
        paint_note(painter, viewport, self.note(), found, buttons)


def coordinates_text(lat_deg: float, lon_deg: float) -> str:
    """Latitude and longitude to 10 cm."""
    return f"{abs(lat_deg):.6f}° {'N' if lat_deg >= 0 else 'S'}  {abs(lon_deg):.6f}° {'E' if lon_deg >= 0 else 'W'}"


def _covers(bounds_deg: tuple[float, float, float, float] | None, viewport: Viewport) -> bool:
    """Whether a map reaches the centre of what is in sight; True where its bounds are not known."""
    if bounds_deg is None:
        return True
    west, south, east, north = bounds_deg
    lat, lon = geodetic_from_world(*viewport.centre)
    return south <= lat <= north and west <= lon <= east
