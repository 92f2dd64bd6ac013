"""The 3-D view: the picture of a site and a plan, moved by hand, pointed at, and drawn on with tools."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QWidget

from groundstation.gui.view3d.layers import Layer
from groundstation.gui.view3d.navigator import Drag, Gestures
from groundstation.gui.view3d.overlay import Tip
from groundstation.gui.view3d.scene_picture import ScenePicture, StandardView
from groundstation.gui.view3d.tool_driver import ToolDriver, preview_drawables
from groundstation.gui.view3d.tools import Pointer, Tool
from groundstation.gui.widgets.theme import colours
from groundstation.services.units import UnitSystem

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
        # No-fly volumes and home are in the way of nothing that is drawn.
        see_through = self._hidden | {Layer.NO_FLY, Layer.HOME}
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
        self._overlay.set_tip(None if item is None else Tip(self._texts.name(item), place.x(), place.y()))
        if item != self._hover:
            self.set_hover(item)
            self.hovered.emit(item)

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
        hit = self.pick_at(place.x(), place.y())
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
        hit = self.pick_at(place.x(), place.y())
        self._navigator.zoom(factor, None if hit is None else hit.point_enu_m)

    def _key(self, event: QKeyEvent) -> None:
        if self._tools.key(event) or self._navigator.key(event):
            event.accept()
        elif event.key() == Qt.Key.Key_F and not event.modifiers():
            self.look_at_all()
            event.accept()


def _has_shift(modifiers: Qt.KeyboardModifier) -> bool:
    return bool(modifiers & Qt.KeyboardModifier.ShiftModifier)
