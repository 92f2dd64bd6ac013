"""In which order Tab goes through a window: region by region as it is read, whatever was made first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget


def next_in_order(regions: Sequence[QWidget], current: QWidget | None, *, forward: bool) -> QWidget | None:
    """The widget that gets the focus after `current`; None where no region takes it.

    Within a region the order is Qt's own; after the last widget the first one follows. What is outside all regions is
    skipped; from a frame inside one it goes on beside it.

    Parameters
    ----------
    regions
        Of one window, none inside another.
    """
    stops = [widget for region in regions for widget in _stops_in(region)]
    if not stops:
        return None
    if current not in stops:
        is_inside = any(region is current or region.isAncestorOf(current) for region in regions if current is not None)
        neighbour = _beside(stops, current, forward) if is_inside else None
        return stops[0 if forward else -1] if neighbour is None else neighbour
    return stops[(stops.index(current) + (1 if forward else -1)) % len(stops)]


def first_in(region: QWidget) -> QWidget | None:
    """The first widget of a region that Tab reaches."""
    return next(_stops_in(region), None)


def set_enabled(widget: QWidget, is_enabled: bool) -> None:
    """Enable or disable a widget; where the keyboard was in it, it goes to the frame around.

    Qt would give it to the next widget: a key that is pressed again would press that one, and forms would scroll to it.
    """
    focus = widget.window().focusWidget()
    around = widget.parentWidget()
    if not is_enabled and around is not None and focus is not None and (focus is widget or widget.isAncestorOf(focus)):
        around.setFocus(Qt.FocusReason.OtherFocusReason)
    widget.setEnabled(is_enabled)


def _beside(stops: Sequence[QWidget], current: QWidget | None, forward: bool) -> QWidget | None:
    """The stop next to a widget that is none, where there is one."""
    widget = current
    while widget is not None:
        widget = widget.nextInFocusChain() if forward else widget.previousInFocusChain()
        if widget is current or widget in stops:
            return None if widget is current else widget
    return None


def _stops_in(region: QWidget) -> Iterator[QWidget]:
    widget: QWidget | None = region
    while widget is not None:
        if (region is widget or region.isAncestorOf(widget)) and _takes_tab(widget):
            yield widget
        widget = widget.nextInFocusChain()
        if widget is region:
            return


def _takes_tab(widget: QWidget) -> bool:
    is_reached = bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)
    return is_reached and widget.isVisible() and widget.isEnabled() and widget.focusProxy() is None
