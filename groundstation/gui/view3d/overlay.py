"""What lies over the picture: labels, north arrow, scale, colour bar, the next step of a tool.

Painted by Qt, so that texts are as sharp and as readable as elsewhere in the window.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QMargins, QObject, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QLinearGradient, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from groundstation.gui.view3d.drawables import Label, Layer
from groundstation.gui.view3d.orbit import Pinhole
from groundstation.gui.view3d.paint import NO_VALUE, SCALE_STOPS, ColourScale, ValueKind
from groundstation.gui.view3d.site_scene import HOME, LANDING_LABEL_M, PlanScene, SiteScene, ends_of_sorties
from groundstation.gui.widgets.theme import SORTIES, colours
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, length_unit

# The texts of the 3-D view: labels in the scene, names under the pointer, and what colours mean.

SORTIE_LABEL_M = 3.0
"""Height of labels above the ends of sorties, which are where home is labelled, too."""


class SceneTexts(QObject):
    """Words things in the user's language."""

    def labels(self, site: SiteScene | None, plan: PlanScene | None, hidden: frozenset[Layer]) -> list[Label]:
        """Labels of home, obstacles, zones, and where sorties start and land, as far as their layers are shown."""
        if Layer.LABELS in hidden:
            return []
        labels: list[Label] = []
        if site is not None:
            x, y, z = site.model.site.home_enu_m
            labels.append(Label(self.tr("Home"), (x, y, z + LANDING_LABEL_M), Layer.HOME, HOME))
            labels.extend(site.labels)
        if plan is not None:
            labels.extend(self._sortie_labels(plan))
        return [label for label in labels if label.layer not in hidden]

    def name(self, item: Item, plan: PlanScene | None = None, n_views: int | None = None) -> str:
        """What an item is called beside the pointer, and where it stands in the plan.

        Parameters
        ----------
        n_views
            Of a panel: how many of the plan's views cover it.
        """
        if item.kind is ItemKind.PANEL and n_views is not None:
            return self.tr("Panel {0}: in {1} views").format(item.id, n_views)
        if item.kind is ItemKind.VIEWPOINT and plan is not None and item.id in plan.viewpoint_index:
            number = int(plan.sortie[plan.viewpoint_index[item.id]])
            if number >= 0:
                ids = plan.plan.sorties[number].viewpoint_ids
                return self.tr("Viewpoint {0}: photo {1} of {2} of sortie {3}").format(
                    item.id, ids.index(item.id) + 1, len(ids), number + 1
                )
        match item.kind:
            case ItemKind.BUILDING:
                return self.tr("Building")
            case ItemKind.HOME:
                return self.tr("Home")
            case ItemKind.LEG:
                sortie, _, leg = item.id.partition("/")
                return self.tr("Sortie {0}, leg {1}").format(sortie, leg)
            case ItemKind.PANEL:
                return self.tr("Panel {0}").format(item.id)
            case ItemKind.VIEWPOINT:
                return self.tr("Viewpoint {0}").format(item.id)
            case _:
                return item.id

    def coverage_legend(self) -> list[tuple[str, str]]:
        """Colours of sections and what they mean."""
        look = colours()
        return [
            (look.covered, self.tr("covered; darker: by more views")),
            (look.open, self.tr("open: could be covered")),
            (look.unreachable, self.tr("unreachable")),
            (look.undecided, self.tr("undecided")),
        ]

    def _sortie_labels(self, plan: PlanScene) -> list[Label]:
        labels = []
        for point, starts, landings in ends_of_sorties(plan.paths):
            numbers = starts or landings
            names = ", ".join(map(str, numbers))
            if starts == landings:
                text = self.tr("Start and landing {0}").format(names)
            elif starts and landings:
                text = self.tr("Start {0}, landing {1}").format(names, ", ".join(map(str, landings)))
            else:
                text = (self.tr("Start {0}") if starts else self.tr("Landing {0}")).format(names)
            x, y, z = (float(value) for value in point)
            colour = SORTIES[(numbers[0] - 1) % len(SORTIES)]
            labels.append(Label(text, (x, y, z + SORTIE_LABEL_M), Layer.ROUTES, colour))
        return labels


MARGIN_PX, GAP_PX = 12.0, 6.0
NORTH_PX = 26.0
BAR_WIDTH_PX = 160.0
"""Longest that the scale becomes, and length of the colour bar."""

WIDEST_PART = 0.4
"""Of what is free between things that lie over the view: a wider colour bar would hide what it explains."""

TIP_PX = 420.0
"""Longest line beside the pointer: what a geo-zone asks for is some lines."""

MAX_LABELS = 60
"""More are unreadable anyway."""

MAX_STACKED = 4
"""Labels that would overlap are put above one another, this many at most."""


@dataclass(frozen=True, slots=True)
class Tip:
    """A text beside a pixel."""

    text: str
    x_px: float
    y_px: float


def round_length(at_most: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is not above a positive number."""
    power = 10.0 ** np.floor(np.log10(at_most))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= at_most * (1.0 + 1e-9)))


class Overlay(QWidget):
    """Transparent for the mouse; drawn anew whenever the view moves."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self._view: Pinhole | None = None
        self._focus_depth_m = 1.0
        self._labels: Sequence[Label] = ()
        self._scales: Sequence[ColourScale] = ()
        self._legend: Sequence[tuple[str, str]] = ()
        self._hint = ""
        self._tip: Tip | None = None
        self._has_frame = False
        self._insets = QMargins()
        self._units = UnitSystem.METRIC

    def set_view(self, view: Pinhole, focus_depth_m: float) -> None:
        """Follow the view."""
        self._view, self._focus_depth_m = view, focus_depth_m
        self.update()

    def set_labels(self, labels: Sequence[Label]) -> None:
        """Texts at points of the scene; the first come first where there is no room for all."""
        self._labels = labels
        self.update()

    def set_scales(self, scales: Sequence[ColourScale]) -> None:
        """Show colour bars, one above the other."""
        self._scales = scales
        self.update()

    def set_legend(self, legend: Sequence[tuple[str, str]]) -> None:
        """Show what colours mean: pairs of colour and text."""
        self._legend = legend
        self.update()

    def set_hint(self, text: str) -> None:
        """What is to be done next; empty for nothing."""
        if text != self._hint:
            self._hint = text
            self.update()

    def set_tip(self, tip: Tip | None) -> None:
        """A text beside the pointer."""
        if tip != self._tip:
            self._tip = tip
            self.update()

    def set_frame(self, is_shown: bool) -> None:
        """A frame, as other widgets have one when keys go to them."""
        self._has_frame = is_shown
        self.update()

    def set_insets(self, insets: QMargins) -> None:
        """Leave so much free at the edges."""
        self._insets = insets
        self.update()

    def set_units(self, units: UnitSystem) -> None:
        """Units of the scale."""
        self._units = units
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw everything."""
        if self._view is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_labels(painter, self._view)
        self._paint_north(painter, self._view)
        self._paint_length(painter, self._view)
        bottom_px = self.height() - self._insets.bottom() - MARGIN_PX
        for scale in self._scales:
            bottom_px = self._paint_scale(painter, scale, bottom_px) - GAP_PX
        if self._legend:
            self._paint_legend(painter, bottom_px)
        if self._hint:
            width = self.width() / 2.0
            self._paint_box(painter, self._hint, QPointF(width, MARGIN_PX), Qt.AlignmentFlag.AlignHCenter)
        if self._tip is not None:
            self._paint_tip(painter, self._tip)
        if self._has_frame:
            painter.setPen(QPen(QColor(colours().accent), 2.0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self.rect()).adjusted(1.0, 1.0, -1.0, -1.0))
        painter.end()

    def _right_px(self) -> float:
        """Where marks at the right end."""
        return self.width() - self._insets.right() - MARGIN_PX

    def _paint_labels(self, painter: QPainter, view: Pinhole) -> None:
        if not self._labels:
            return
        pixels, _ = view.project(np.array([label.point_enu_m for label in self._labels]))
        taken: list[QRectF] = []
        metrics = QFontMetricsF(self.font())
        for label, (x, y) in zip(self._labels, pixels, strict=True):
            if len(taken) >= MAX_LABELS:
                break
            if not (0.0 <= x <= self.width() and 0.0 <= y <= self.height()):
                continue
            width = metrics.horizontalAdvance(label.text) + (22.0 if label.colour else 12.0)
            box = QRectF(x - width / 2.0, y - metrics.height() - 12.0, width, metrics.height() + 4.0)
            for _ in range(MAX_STACKED):
                if not any(box.intersects(other) for other in taken):
                    break
                box.translate(0.0, -box.height() - 2.0)
            else:
                continue
            taken.append(box)
            painter.setPen(QPen(QColor(colours().muted), 1.0))
            painter.drawLine(QPointF(x, y), QPointF(x, box.bottom()))
            self._paint_plate(painter, box)
            text = box.adjusted(6.0, 0.0, -6.0, 0.0)
            if label.colour:
                dot = QRectF(box.left() + 6.0, box.center().y() - 4.0, 8.0, 8.0)
                painter.fillRect(dot, QColor(label.colour))
                text.setLeft(dot.right() + 4.0)
            painter.setPen(QColor(colours().text))
            painter.drawText(text, Qt.AlignmentFlag.AlignCenter, label.text)

    def _paint_north(self, painter: QPainter, view: Pinhole) -> None:
        """Needle to the north as the view lies; it shortens as the view comes level with the horizon."""
        centre = QPointF(self._right_px() - NORTH_PX, self._insets.top() + MARGIN_PX + NORTH_PX)
        north = QPointF(view.right[1], -view.up[1] if abs(view.forward[2]) > 0.05 else -view.forward[1] * 0.3)
        east = QPointF(view.right[0], -view.up[0] if abs(view.forward[2]) > 0.05 else -view.forward[0] * 0.3)
        painter.setPen(QPen(QColor(colours().line), 1.0))
        plate = QColor(colours().base)
        plate.setAlpha(215)
        painter.setBrush(plate)
        painter.drawEllipse(centre, NORTH_PX, NORTH_PX)
        tip, tail = centre + north * 0.62 * NORTH_PX, centre - north * 0.62 * NORTH_PX
        side = east * 0.24 * NORTH_PX
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colours().error))
        painter.drawPolygon(QPolygonF([tip, centre + side, centre - side]))
        painter.setBrush(QColor(colours().muted))
        painter.drawPolygon(QPolygonF([tail, centre + side, centre - side]))
        painter.setPen(QColor(colours().text))
        letter = centre + north * 0.80 * NORTH_PX
        painter.drawText(QRectF(letter.x() - 10, letter.y() - 10, 20, 20), Qt.AlignmentFlag.AlignCenter, self.tr("N"))

    def _paint_length(self, painter: QPainter, view: Pinhole) -> None:
        """Scale that holds in the middle of the picture, at the depth that is orbited."""
        unit = length_unit(self._units)
        metres_per_px = view.metres_per_px(self._focus_depth_m)
        shown = round_length(unit.shown(metres_per_px * BAR_WIDTH_PX))
        length_px = unit.metric(shown) / metres_per_px
        left, y = self._insets.left() + MARGIN_PX + 6.0, self.height() - self._insets.bottom() - MARGIN_PX - 8.0
        text = self.tr("{0:g} {1} in the middle").format(shown, unit.symbol)
        metrics = QFontMetricsF(self.font())
        width = max(length_px, metrics.horizontalAdvance(text))
        self._paint_plate(
            painter, QRectF(left - 6.0, y - metrics.height() - 8.0, width + 12.0, metrics.height() + 16.0)
        )
        painter.setPen(QPen(QColor(colours().text), 2.0))
        painter.drawLine(QPointF(left, y), QPointF(left + length_px, y))
        for x in (left, left + length_px):
            painter.drawLine(QPointF(x, y - 4.0), QPointF(x, y + 4.0))
        painter.drawText(QPointF(left, y - 7.0), text)

    def _paint_scale(self, painter: QPainter, scale: ColourScale, bottom_px: float) -> float:
        """A colour bar that ends at a height; returns where it begins."""
        metrics = QFontMetricsF(self.font())
        row = metrics.height()
        title = f"{scale.title} [{scale.unit}]" if scale.unit else scale.title
        low, high = f"{scale.low:.4g}", f"{scale.high:.4g}"
        width = max(BAR_WIDTH_PX, metrics.horizontalAdvance(title))
        box = QRectF(0.0, 0.0, width + 16.0, 3.0 * row + 34.0)
        if not self._insets.isNull() and box.width() > WIDEST_PART * (self._right_px() - self._insets.left()):
            return bottom_px
        box.moveBottomRight(QPointF(self._right_px(), bottom_px))
        self._paint_plate(painter, box)
        inner = box.adjusted(8.0, 4.0, -8.0, -4.0)
        painter.setPen(QColor(colours().text))
        painter.drawText(QRectF(inner.left(), inner.top(), inner.width(), row), Qt.AlignmentFlag.AlignLeft, title)
        bar = QRectF(inner.left(), inner.top() + row + 3.0, inner.width(), 14.0)
        gradient = QLinearGradient(bar.topLeft(), bar.topRight())
        for place, colour in SCALE_STOPS:
            gradient.setColorAt(1.0 - place if scale.kind is ValueKind.LOW_IS_GOOD else place, QColor(colour))
        painter.fillRect(bar, gradient)
        ends = QRectF(inner.left(), bar.bottom() + 2.0, inner.width(), row)
        painter.drawText(ends, Qt.AlignmentFlag.AlignLeft, low)
        painter.drawText(ends, Qt.AlignmentFlag.AlignRight, high)
        grey = QRectF(inner.left(), ends.bottom() + 3.0, 10.0, 10.0)
        painter.fillRect(grey, QColor(NO_VALUE))
        painter.drawText(QPointF(grey.right() + 5.0, grey.bottom()), self.tr("no value"))
        return box.top()

    def _paint_legend(self, painter: QPainter, bottom_px: float) -> None:
        metrics = QFontMetricsF(self.font())
        row = metrics.height() + 3.0
        width = max(metrics.horizontalAdvance(text) for _, text in self._legend) + 34.0
        box = QRectF(0.0, 0.0, width, row * len(self._legend) + 10.0)
        box.moveBottomRight(QPointF(self._right_px(), bottom_px))
        self._paint_plate(painter, box)
        for i, (colour, text) in enumerate(self._legend):
            top = box.top() + 5.0 + i * row
            painter.fillRect(QRectF(box.left() + 8.0, top + 3.0, 12.0, 12.0), QColor(colour))
            painter.setPen(QColor(colours().text))
            line = QRectF(box.left() + 26.0, top, width, row)
            painter.drawText(line, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, text)

    def _paint_tip(self, painter: QPainter, tip: Tip) -> None:
        limit, wrap = QRectF(0.0, 0.0, TIP_PX, self.height()), Qt.TextFlag.TextWordWrap
        size = QFontMetricsF(self.font()).boundingRect(limit, wrap, tip.text).size()
        x = tip.x_px + 16.0 if tip.x_px + size.width() + 40.0 < self.width() else tip.x_px - size.width() - 28.0
        y = min(max(0.0, tip.y_px + 14.0), self.height() - size.height() - 10.0)
        self._paint_box(painter, tip.text, QPointF(max(0.0, x), y), Qt.AlignmentFlag.AlignLeft, TIP_PX)

    def _paint_box(
        self, painter: QPainter, text: str, top: QPointF, align: Qt.AlignmentFlag, width_px: float = math.inf
    ) -> None:
        """A text on a plate; `top` is its upper left corner, or the middle of its upper edge."""
        limit = QRectF(0.0, 0.0, min(width_px, self.width() - 2.0 * MARGIN_PX), self.height())
        size = QFontMetricsF(self.font()).boundingRect(limit, Qt.TextFlag.TextWordWrap, text).size()
        box = QRectF(0.0, 0.0, size.width() + 14.0, size.height() + 8.0)
        box.moveTopLeft(top)
        if align & Qt.AlignmentFlag.AlignHCenter:
            box.moveLeft(top.x() - box.width() / 2.0)
        self._paint_plate(painter, box)
        painter.setPen(QColor(colours().text))
        inner = box.adjusted(7.0, 4.0, -7.0, -4.0)
        painter.drawText(inner, Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap, text)

    @staticmethod
    def _paint_plate(painter: QPainter, box: QRectF) -> None:
        """Nearly opaque ground under a text: readable on whatever the scene shows there."""
        plate = QColor(colours().base)
        plate.setAlpha(225)
        painter.setPen(QPen(QColor(colours().line), 1.0))
        painter.setBrush(plate)
        painter.drawRoundedRect(box, 3.0, 3.0)
