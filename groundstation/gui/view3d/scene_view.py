"""The 3-D view: the picture of a site and a plan, moved by hand, pointed at, and drawn on with tools."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QMargins, QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QToolButton, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.view3d.drawables import ON_TOP, Drawable, Layer, joined, polyline
from groundstation.gui.view3d.navigator import Drag, Gestures
from groundstation.gui.view3d.overlay import Tip
from groundstation.gui.view3d.paint import flat
from groundstation.gui.view3d.picking import SEE_THROUGH
from groundstation.gui.view3d.scene_picture import SMOOTH_FRAME_S, TEXTURED, ScenePicture, StandardView
from groundstation.gui.view3d.tools import Hint, Key, Pointer, Preview, Tool, ViewpointTool
from groundstation.gui.widgets.layer_list import LayerPanel, LayerRow
from groundstation.gui.widgets.theme import SORTIES, Colours, colours
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, length_unit

# Lets the user work with one tool at a time: feeds it pointers and keys, draws its preview, tells its results.

MOVED_MS = 50
"""Results on the way are told at most this often: whoever follows may count coverage anew each time."""

KEYS = {
    Qt.Key.Key_Return: Key.CONFIRM,
    Qt.Key.Key_Enter: Key.CONFIRM,
    Qt.Key.Key_Backspace: Key.BACK,
    Qt.Key.Key_Left: Key.LEFT,
    Qt.Key.Key_Right: Key.RIGHT,
    Qt.Key.Key_Up: Key.UP,
    Qt.Key.Key_Down: Key.DOWN,
    Qt.Key.Key_PageUp: Key.NEARER,
    Qt.Key.Key_PageDown: Key.FARTHER,
}


class ToolDriver(QObject):
    """One tool at a time.

    Signals
    -------
    moved(object)
        Result as it would be now, throttled.
    finished(object)
        A result; the tool has ended, but for `ViewpointTool`, which goes on.
    ended()
        No tool is in use any more, whether one finished or was cancelled.
    changed()
        Preview or hint are different.
    """

    moved = Signal(object)
    finished = Signal(object)
    ended = Signal()
    changed = Signal()

    def __init__(self, pointer_at: Callable[[float, float, bool], Pointer], parent: QObject) -> None:
        super().__init__(parent)
        self._pointer_at = pointer_at
        self._tool: Tool | None = None
        self._holds = False
        self._throttle = QTimer(self)
        self._throttle.setSingleShot(True)
        self._throttle.timeout.connect(self._tell_moved)

    @property
    def tool(self) -> Tool | None:
        """The tool in use."""
        return self._tool

    def start(self, tool: Tool) -> None:
        """Use a tool, in place of the one in use."""
        self.cancel()
        self._tool = tool
        self.changed.emit()

    def cancel(self) -> None:
        """Put the tool away; nothing comes of it."""
        if self._tool is not None:
            self._end()

    def hover(self, x_px: float, y_px: float, shift: bool) -> None:
        """The pointer moves without a button."""
        if self._tool is not None:
            self._tool.move(self._pointer_at(x_px, y_px, shift))
            self._moved()

    def click(self, x_px: float, y_px: float, shift: bool) -> bool:
        """A click; True where a tool took it."""
        if self._tool is None:
            return False
        self._take(self._tool.click(self._pointer_at(x_px, y_px, shift)))
        return True

    def double_click(self) -> bool:
        """The second click of a pair; True where a tool took it."""
        if self._tool is None:
            return False
        self._take(self._tool.press_key(Key.CONFIRM, False))
        return True

    def start_drag(self, x_px: float, y_px: float, shift: bool) -> bool:
        """A drag starts; True where it is the tool's."""
        self._holds = self._tool is not None and self._tool.grabs(self._pointer_at(x_px, y_px, shift))
        return self._holds

    def drag(self, x_px: float, y_px: float, shift: bool) -> None:
        """A drag of the tool's goes on."""
        if self._tool is not None and self._holds:
            self._tool.move(self._pointer_at(x_px, y_px, shift))
            self._moved()

    def end_drag(self, x_px: float, y_px: float, shift: bool) -> None:
        """A drag of the tool's ends."""
        if self._tool is not None and self._holds:
            self._holds = False
            self._take(self._tool.release(self._pointer_at(x_px, y_px, shift)))

    def key(self, event: QKeyEvent) -> bool:
        """A key; True where a tool took it."""
        if self._tool is None:
            return False
        if event.key() == Qt.Key.Key_Escape:
            self._escape(self._tool)
            return True
        key = KEYS.get(Qt.Key(event.key()))
        if key is None:
            return False
        has_steps = isinstance(self._tool, ViewpointTool)
        if not has_steps and key not in (Key.CONFIRM, Key.BACK):
            return False
        self._take(self._tool.press_key(key, bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)))
        return True

    def _escape(self, tool: Tool) -> None:
        """Let go what is held; with nothing held, put the tool away."""
        if isinstance(tool, ViewpointTool) and self._holds:
            self._holds = False
            tool.cancel()
            self.moved.emit(tool.value)
            self.changed.emit()
        else:
            self._end()

    def _take(self, result: object | None) -> None:
        if result is None:
            self.changed.emit()
            return
        self._throttle.stop()
        if isinstance(self._tool, ViewpointTool):
            self.changed.emit()
            self.finished.emit(result)
        else:
            self._tool = None
            self.changed.emit()
            self.finished.emit(result)
            if self._tool is None:
                self.ended.emit()

    def _end(self) -> None:
        self._tool, self._holds = None, False
        self._throttle.stop()
        self.changed.emit()
        self.ended.emit()

    def _moved(self) -> None:
        self.changed.emit()
        if not self._throttle.isActive():
            self._throttle.start(MOVED_MS)

    def _tell_moved(self) -> None:
        if self._tool is not None and self._tool.value is not None:
            self.moved.emit(self._tool.value)

    def hint_text(self, units: UnitSystem) -> str:
        """What is to be done next, with the sizes drawn so far."""
        if self._tool is None:
            return ""
        text = {
            Hint.CLICK_POINT: self.tr("Click a point. Esc cancels."),
            Hint.CLICK_LOWER_LEFT: self.tr("Click the lower left corner, as seen from outside. Esc cancels."),
            Hint.CLICK_LOWER_RIGHT: self.tr("Click the lower right corner. Shift keeps a slope, Backspace goes back."),
            Hint.CLICK_UPPER_LEFT: self.tr("Click the upper edge. Backspace goes back, Esc cancels."),
            Hint.CLICK_CORNER: self.tr("Click a corner on the ground. Esc cancels."),
            Hint.CLICK_MORE_CORNERS: self.tr("Click more corners; Enter, a double click or the first corner ends."),
            Hint.POLYGON_CROSSES: self.tr("This side would cross another: click elsewhere, or Backspace to go back."),
            Hint.CLICK_OPPOSITE_CORNER: self.tr("Click the opposite corner. Backspace goes back."),
            Hint.CLICK_HEIGHT: self.tr("Move up to the height and click. Backspace goes back."),
            Hint.CLICK_HOME: self.tr("Click where the aircraft takes off and lands. Esc cancels."),
            Hint.CLICK_RALLY: self.tr("Click where the aircraft may land when it returns. Esc cancels."),
            Hint.DRAG_VIEWPOINT: self.tr(
                "Drag the viewpoint; Shift moves it along its line of sight. Arrow and Page keys move it by 1 m, "
                "with Shift by 0.1 m. Esc ends."
            ),
            Hint.NOTHING_THERE: self.tr("There is nothing at this place. Click on the building or on the ground."),
        }[self._tool.hint]
        unit = length_unit(units)
        lengths = self.tr(" x ").join(unit.text(length) for length in self._tool.preview.lengths_m)
        return f"{text}\n{lengths}" if lengths else text


def preview_drawables(preview: Preview, look: Colours) -> tuple[Drawable, ...]:
    """What is drawn of a preview, over everything: red where it would be refused."""
    colour = look.error if preview.is_refused else look.accent
    parts = []
    if preview.lines:
        points, cells = joined([polyline(line) for line in preview.lines])
        # A light line below a dark one is seen on glass, wall and sky alike.
        for line_colour, width_px in ((look.base, 5.0), (colour, 2.5)):
            parts.append(Drawable(points, cells, flat(line_colour, len(cells)), width_px=width_px, depth_shift=ON_TOP))
    if preview.dots:
        n = len(preview.dots)
        cells = np.arange(n)[:, None]
        parts.append(Drawable(np.stack(preview.dots), cells, flat(colour, n), width_px=10.0, depth_shift=ON_TOP))
    return tuple(parts)


EDGE_PX, BELOW_PANEL_PX = 8, 60
"""Of the list of layers: from the edges, and above the scale."""

UNFADED = frozenset({Layer.LABELS})
"""Layers without an opacity of their own."""


__all__ = ["SceneView", "StandardView"]


class SceneView(ScenePicture):
    """A site and a plan in three dimensions.

    Drag turns, right drag or two fingers shift, wheel or pinch zoom at the pointer, a double click brings a place to
    the middle; arrow keys turn, + and - zoom, F shows everything, Esc puts a tool away.

    Signals
    -------
    hovered(Item or None)
    picked(Item or None, KeyboardModifiers)
        A click; None on nothing.
    orbitChanged(Orbit)
        The view was moved by the user or by `look_at`; not by `set_orbit`.
    toolMoved(object), toolFinished(object), toolEnded()
        See `ToolDriver`; the objects are the records of the tools, such as `PickedRectangle`.
    """

    hovered = Signal(object)
    picked = Signal(object, object)
    toolMoved = Signal(object)  # noqa: N815  (Qt's own way of naming)
    toolFinished = Signal(object)  # noqa: N815
    toolEnded = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._drag: Drag | None = None
        self._tip_text = ""
        self._insets = QMargins()
        self._panel = LayerPanel(self.tr("Layers"), self)
        self._panel.list.changed.connect(self._layer_edited)
        self._panel.hide()
        self._layers_button = QToolButton(self)
        self._layers_button.setText(self.tr("Layers"))
        self._layers_button.setToolTip(self.tr("What is shown in the view, and how strongly, sortie by sortie"))
        self._layers_button.setCheckable(True)
        self._layers_button.toggled.connect(self._show_panel)
        self._canvas.framesTimed.connect(self._list_anew, Qt.ConnectionType.QueuedConnection)
        self._gestures = Gestures(self._canvas)
        self._tools = ToolDriver(self._pointer, self)
        gestures, tools = self._gestures, self._tools
        gestures.hovered.connect(self._hover_at)
        gestures.left.connect(self._pointer_left)
        gestures.clicked.connect(self._click)
        gestures.double_clicked.connect(self._double_click)
        gestures.drag_started.connect(self._start_drag)
        gestures.dragged.connect(self._go_on_dragging)
        gestures.drag_ended.connect(self._end_drag)
        gestures.zoomed.connect(self._zoom)
        gestures.shifted.connect(self._navigator.drag_shift)
        gestures.keyed.connect(self._key)
        gestures.keysTaken.connect(self._overlay.set_frame)
        tools.changed.connect(self._show_tool)
        tools.moved.connect(self.toolMoved)
        tools.finished.connect(self.toolFinished)
        tools.ended.connect(self.toolEnded)

    # Layers

    def layer_panel(self) -> LayerPanel:
        """The list of layers; hidden until "Layers" is pressed."""
        return self._panel

    def set_insets(self, insets: QMargins) -> None:
        """Keep marks and buttons away from the edges, where something else lies over them."""
        super().set_insets(insets)
        self._insets = insets
        self._place_panel()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the list of layers in its corner."""
        super().resizeEvent(event)
        self._place_panel()

    def _show_panel(self, is_shown: bool) -> None:
        self._panel.setVisible(is_shown)
        if is_shown:
            self._show_rows()

    def _place_panel(self) -> None:
        left, top = EDGE_PX + self._insets.left(), EDGE_PX + self._insets.top()
        self._layers_button.adjustSize()
        self._layers_button.move(left, top)
        self._layers_button.raise_()
        top += self._layers_button.height() + 4
        room = self.height() - top - self._insets.bottom() - BELOW_PANEL_PX
        self._panel.setGeometry(left, top, self._panel.width(), max(60, min(self._panel.wanted_px(), room)))
        self._panel.raise_()

    def _show_rows(self) -> None:
        """List what there is: sorties first, then what stands on the site."""
        rows = []
        for number in range(1, (0 if self._plan is None else len(self._plan.paths)) + 1):
            is_shown, opacity = self.sortie_state(number)
            colour = SORTIES[(number - 1) % len(SORTIES)]
            rows.append(LayerRow(f"{number}", self.tr("Sortie {0}").format(number), is_shown, opacity, colour))
        for layer, title in self._layer_titles().items():
            is_shown, can_fade = self.is_layer_visible(layer), layer not in UNFADED
            note = self._note(layer) if is_shown else ""
            rows.append(LayerRow(layer.value, title, is_shown, self.layer_opacity(layer), can_fade=can_fade, note=note))
        self._panel.setValue(rows)
        self._place_panel()

    def _note(self, layer: Layer) -> str:
        """When a textured layer is drawn, and why."""
        if layer is Layer.PHOTOS and self.is_painted():
            return self.tr("not drawn: panels show values")
        frame_s = self.canvas().moving_frame_s
        if layer not in TEXTURED or frame_s is None:
            return ""
        if frame_s > SMOOTH_FRAME_S:
            text = self.tr("drawn at rest only: a frame takes {0} ms, turning smoothly allows {1} ms")
        else:
            text = self.tr("drawn always: a frame takes {0} ms, turning smoothly allows {1} ms")
        return text.format(round(1e3 * frame_s), round(1e3 * SMOOTH_FRAME_S))

    def _layer_titles(self) -> dict[Layer, str]:
        titles: dict[Layer, str] = {}
        if self._plan is not None:
            titles |= {
                Layer.ROUTES: self.tr("Routes"),
                Layer.VIEWPOINTS: self.tr("Viewpoints"),
                Layer.FRUSTA: self.tr("All pyramids"),
            }
        if self._site is not None:
            model = self._site.model
            titles |= {Layer.PANELS: self.tr("Panels"), Layer.BUILDING: self.tr("Building")}
            if model.obstacles:
                titles[Layer.OBSTACLES] = self.tr("Obstacles")
            if model.site.airspace.no_fly:
                titles[Layer.NO_FLY] = self.tr("No-fly zones")
            if self._site.zones:
                titles[Layer.ZONES] = self.tr("Geo-zones")
            titles |= {
                Layer.AIRSPACE: self.tr("Airspace"),
                Layer.HOME: self.tr("Home"),
                Layer.SHADOWS: self.tr("Shadows"),
                Layer.GROUND: self.tr("Ground"),
                Layer.SURROUNDINGS: self.tr("Simulated surroundings"),
                **({Layer.PHOTOS: self.tr("Photos on the building")} if self._has_photos else {}),
                Layer.LABELS: self.tr("Names"),
            }
        return titles

    def _layer_edited(self, key: str, is_visible: bool, opacity: float) -> None:
        if key.isdecimal():
            self.set_sortie(int(key), is_visible, opacity)
        else:
            self.set_layer_visible(Layer(key), is_visible)
            self.set_layer_opacity(Layer(key), opacity)

    def offer_photos(self, is_there: bool) -> None:
        """See `ScenePicture`; the list of layers follows."""
        super().offer_photos(is_there)
        self._list_anew()

    def _draw_site(self) -> None:
        super()._draw_site()
        self._list_anew()

    def _draw_plan(self) -> None:
        super()._draw_plan()
        self._list_anew()

    def _list_anew(self) -> None:
        if self._layers_button.isChecked():
            self._show_rows()

    def set_units(self, units: UnitSystem) -> None:
        """Units of lengths on screen."""
        super().set_units(units)
        self._show_tool()

    def turn_by_hand(self, right_deg: float, up_deg: float) -> None:
        """Turn as a drag does, with a signal."""
        self._navigator.turn(right_deg, up_deg)

    def bring_in_viewpoints(self) -> None:
        """As the picture does, but not under the user's hand: while the view is dragged or a tool is in use."""
        if self._drag is None and self._tools.tool is None:
            super().bring_in_viewpoints()

    # Tools

    def start_tool(self, tool: Tool) -> None:
        """Let the user work with a tool; one that was in use is cancelled."""
        self._tools.start(tool)
        self._canvas.setCursor(Qt.CursorShape.CrossCursor)
        self._canvas.setFocus()

    def cancel_tool(self) -> None:
        """Put the tool away, if there is one."""
        self._tools.cancel()

    def tool(self) -> Tool | None:
        """The tool in use."""
        return self._tools.tool

    def _show_tool(self) -> None:
        tool = self._tools.tool
        self._canvas.draw("tool", () if tool is None else preview_drawables(tool.preview, colours()))
        self._overlay.set_hint(self._tools.hint_text(self._units))
        if tool is None:
            self._canvas.unsetCursor()

    # Pointer and keys

    def _pointer(self, x_px: float, y_px: float, shift: bool) -> Pointer:
        view, index = self._navigator.pinhole(), self._pick_index()
        ray = view.ray(x_px, y_px)
        if index is None:
            return Pointer(view, x_px, y_px, ray, shift=shift)
        # No-fly volumes, geo-zones and home are in the way of nothing that is drawn.
        see_through = self._hidden | SEE_THROUGH | {Layer.HOME}
        hit = index.surface(view.eye_enu_m, ray, see_through)
        return Pointer(view, x_px, y_px, ray, hit, index.ground(view.eye_enu_m, ray), shift)

    def _hover_at(self, place: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        if self._tools.tool is not None:
            self._tools.hover(place.x(), place.y(), _has_shift(modifiers))
            return
        self._make_index()
        if self._index is not None and not self._index.done():
            return
        hit = self.pick_at(place.x(), place.y())
        item = None if hit is None else hit.item
        if item != self._hover:
            self.set_hover(item)
            self._tip_text = "" if item is None else self._tip_of(item)
            self.hovered.emit(item)
        self._overlay.set_tip(None if item is None else Tip(self._tip_text, place.x(), place.y()))

    def _tip_of(self, item: Item) -> str:
        is_counted = item.kind is ItemKind.PANEL and self._plan is not None
        n_views = len(self.views_of_panel(item.id)) if is_counted else None
        zones = () if self._site is None else self._site.zones
        if (zone := next((zone for zone in zones if zone.item == item), None)) is not None:
            return "\n".join(translated(line, self._units) for line in zone.lines)
        return self._texts.name(item, self._plan, n_views)

    def _pointer_left(self) -> None:
        self._overlay.set_tip(None)
        if self._hover is not None:
            self.set_hover(None)
            self.hovered.emit(None)

    def _click(self, place: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        if not self._tools.click(place.x(), place.y(), _has_shift(modifiers)):
            hit = self.pick_at(place.x(), place.y())
            self.picked.emit(None if hit is None else hit.item, modifiers)

    def _double_click(self, place: QPointF, _modifiers: Qt.KeyboardModifier) -> None:
        if self._tools.double_click():
            return
        hit = self.pick_at(place.x(), place.y(), SEE_THROUGH)
        if hit is not None:
            self._navigator.go(self._navigator.orbit.towards_point(hit.point_enu_m).zoomed(1.5))

    def _start_drag(self, place: QPointF, drag: Drag, modifiers: Qt.KeyboardModifier) -> None:
        self._overlay.set_tip(None)
        is_tools = drag is Drag.TURN and self._tools.start_drag(place.x(), place.y(), _has_shift(modifiers))
        self._drag = None if is_tools else drag
        if drag is Drag.TURN and not is_tools and _has_shift(modifiers):
            self._drag = Drag.SHIFT

    def _go_on_dragging(self, place: QPointF, step: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        if self._drag is None:
            self._tools.drag(place.x(), place.y(), _has_shift(modifiers))
        elif self._drag is Drag.TURN:
            self._navigator.drag_turn(step)
        else:
            self._navigator.drag_shift(step)

    def _end_drag(self, place: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        if self._drag is None:
            self._tools.end_drag(place.x(), place.y(), _has_shift(modifiers))
        self._drag = None

    def _zoom(self, factor: float, place: QPointF) -> None:
        hit = self.pick_at(place.x(), place.y(), SEE_THROUGH)
        self._navigator.zoom(factor, None if hit is None else hit.point_enu_m)

    def _key(self, event: QKeyEvent) -> None:
        if self._tools.key(event) or self._navigator.key(event):
            event.accept()
        elif event.key() == Qt.Key.Key_F and not event.modifiers():
            self.look_at_all()
            event.accept()


def _has_shift(modifiers: Qt.KeyboardModifier) -> bool:
    return bool(modifiers & Qt.KeyboardModifier.ShiftModifier)
